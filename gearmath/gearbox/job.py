"""One job of a machine: exact ratio, rates against the limits, and whether it is carried; threads on a lathe."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

from derivations import notation as q
from derivations.quantity import Quantity
from gearmath.errors import InputError
from gearmath.gearbox.helix import SIGNS, JobRatio, one_term
from gearmath.gearbox.kernels import evaluate, exactly
from gearmath.gearbox.motion import MotorMotion, check_run_up, motion
from gearmath.specs.hobbing import NARROW, Hand, HobbingMachine

#: Largest N and D of the int32 step rule; gearmath.gearbox.proof shows that this bound is tight.
WIDEST = NARROW
#: The same of the int64 rule.
WIDEST_64 = 2**62
#: The firmware trips where the hob is so much faster than the highest speed, which keeps the step rate even then.
TRIP = Fraction(101, 100)
#: Most whole steps of one edge.
LARGEST_BASE = int(q.base_step.domain[1])


#: The speed that is proposed, as part of the highest: a load or a supply that is off must not stop the job.
PROPOSED = 0.9


@dataclass(frozen=True)
class GearboxJob:
    """One job. N/D motor steps per encoder count, reduced if the hob leads alone; R = D/N encoder counts per step.

    ``feed_numerator`` is that of the feed encoder over the same denominator. Ratio k of :func:`gearmath.export.host`
    is base_steps[k] + increments[k]/steps_denominator, for hob and feed. Numbers in signs of (9.2).
    """

    machine: str
    steps_numerator: int
    steps_denominator: int
    feed_numerator: int
    base_steps: tuple[int, int]
    increments: tuple[int, int]
    first_remainder: int
    pulse_ratio: float
    rpm: float
    highest_rpm: float
    edge_rate_hz: float
    step_rate_hz: float
    hob_rpm_percent: float
    edge_rate_percent: float
    step_rate_percent: float
    carried_at_every_speed: bool
    """Whether the steps keep their limit up to limits.hob_rpm; the firmware refuses a gear otherwise."""
    motion: MotorMotion

    @property
    def exact_pulse_ratio(self) -> Fraction:
        """R as a fraction."""
        return Fraction(self.steps_denominator, self.steps_numerator)

    @property
    def ratio(self) -> JobRatio:
        """The ratio as one value."""
        return JobRatio(self.steps_denominator, (self.steps_numerator, self.feed_numerator))


@dataclass(frozen=True)
class ThreadPlan(GearboxJob):
    """A thread on a lathe: pitch and lead [mm], exactly."""

    pitch: Fraction
    lead: Fraction
    starts: int
    hand: Hand
    count_um: float
    """Way of the carriage per encoder count [um]."""
    step_um: float
    """And per motor step."""


def job_values(
    machine: HobbingMachine, ratio: JobRatio, rpm: float | None, what: str, run_up: float | None = None
) -> dict[str, object]:
    """The fields of a Job, by name. ``what`` is cut, in a message: "10 teeth"; ``run_up`` is that of the hob [s].

    Raises InputError where the ratio or the speed cannot be carried.
    """
    hob, feed = ratio.numerators
    exact = Fraction(hob, ratio.denominator)
    highest = _highest_rpm(machine, abs(exact))
    speed = PROPOSED * highest if rpm is None else rpm
    _check_speed(machine, what, speed, highest)
    moved = motion(machine, exact, speed)
    check_run_up(machine, moved, speed, run_up, what)
    edge_rate = speed / 60.0 * float(machine.encoder_counts)
    pulse_ratio = float(1 / exact)
    (step_rate,) = evaluate("desired_position", edge_rate, abs(pulse_ratio))
    return {
        "machine": machine.name,
        "steps_numerator": hob,
        "steps_denominator": ratio.denominator,
        "feed_numerator": feed,
        "base_steps": ratio.base,
        "increments": ratio.increment,
        "first_remainder": ratio.first_remainder,
        "pulse_ratio": pulse_ratio,
        "rpm": speed,
        "highest_rpm": highest,
        "edge_rate_hz": edge_rate,
        "step_rate_hz": step_rate,
        "hob_rpm_percent": 100.0 * speed / machine.limits.hob_rpm,
        "edge_rate_percent": 100.0 * edge_rate / machine.edge_rate_limit,
        "step_rate_percent": 100.0 * step_rate / machine.limits.step_rate_hz,
        "carried_at_every_speed": highest == machine.limits.hob_rpm,
        "motion": moved,
    }


def plan_thread(
    machine: HobbingMachine,
    pitch: Fraction,
    starts: int = 1,
    hand: Hand = "right",
    rpm: float | None = None,
    run_up: float | None = None,
) -> ThreadPlan:
    """The job of cutting a thread of ``pitch`` mm on a lathe, whose spindle takes ``run_up`` seconds to its speed.

    Raises InputError where the machine is none, or cannot carry it.
    """
    if machine.profile != "lathe":
        raise InputError(f"pitch: {machine.name} is a hobbing machine, give the number of teeth instead")
    check_range("starts", starts, q.thread_starts)
    ratio = thread_ratio(machine, pitch, starts, hand)
    what = f"a pitch of {pitch} mm with {starts} start{'s' * (starts > 1)}"
    reason = refusal(machine, ratio)
    if reason:
        raise InputError(f"{machine.name}: {what}: {reason}")
    values = job_values(machine, ratio, rpm, what, run_up)
    lead = starts * pitch
    per_count = float(1000 * lead / machine.encoder_counts)
    per_step = float(1000 * machine.lead_screw_pitch / machine.motor_steps)
    return ThreadPlan(
        **values,  # type: ignore[arg-type]
        pitch=pitch,
        lead=lead,
        starts=starts,
        hand=hand,
        count_um=per_count,
        step_um=per_step,
    )


def thread_ratio(machine: HobbingMachine, pitch: Fraction, starts: int, hand: Hand) -> JobRatio:
    """κ_t of (9.14), exactly."""
    train = (machine.lead_screw_pitch, machine.encoder_counts, machine.motor_steps)
    exact = exactly("lead_screw_ratio", SIGNS[hand], starts, pitch, *train)
    return one_term(exact, machine.encoder_counts.denominator)


def refusal(machine: HobbingMachine, ratio: JobRatio) -> str | None:
    """Why this machine cannot carry a ratio, or None if it can."""
    most, what = min(
        (LARGEST_BASE, "the most that the rule gives"),
        (machine.limits.lag_steps, "all that limits.lag_steps lets wait"),
    )
    steepest = max(abs(numerator) for numerator in ratio.numerators)
    if ratio.steps_per_edge > most:
        return (
            f"{Fraction(steepest, ratio.denominator)} motor steps per encoder count are up to {ratio.steps_per_edge} "
            f"at once, {what} is {most}"
        )
    if ratio.denominator > (WIDEST_64 if machine.wide else WIDEST):
        bits = 64 if machine.wide else 32
        limit = WIDEST_64 if machine.wide else WIDEST
        return (
            f"the ratio {steepest}/{ratio.denominator} needs more than {limit}, the limit of {bits}-bit arithmetic on "
            "this machine"
        )
    return None


def nearest(key: str, wanted: int, quantity: Quantity, carried: Callable[[int], bool]) -> str:
    """The whole number next to ``wanted`` that is carried, as half a sentence."""
    low, high = (int(bound) for bound in quantity.domain)
    for other in sorted(range(low, high + 1), key=lambda count: abs(count - wanted)):
        if carried(other):
            return f"the nearest {key} that can be cut is {other}"
    return f"no {key} from {low} to {high} can be cut with this drive train"


def check_range(key: str, value: int, quantity: Quantity) -> None:
    """Raises InputError where a whole number leaves the domain of its quantity."""
    low, high = (int(bound) for bound in quantity.domain)
    if not low <= value <= high:
        raise InputError(f"{key} = {value}: must lie between {low} and {high}")


def _highest_rpm(machine: HobbingMachine, ratio: Fraction) -> float:
    by_steps = machine.limits.step_rate_hz * 60.0 / float(machine.encoder_counts * ratio * TRIP)
    return min(machine.limits.hob_rpm, by_steps)


def _check_speed(machine: HobbingMachine, what: str, rpm: float, highest: float) -> None:
    if not 0.0 < rpm < float("inf"):
        raise InputError(
            f"rpm = {rpm:g}: must be a positive speed, at most {machine.speed_key} = {machine.limits.hob_rpm:g}"
        )
    if rpm <= highest:
        return
    limits = machine.limits
    limit = (
        f"{machine.speed_key} = {limits.hob_rpm:g}"
        if highest == limits.hob_rpm
        else f"limits.step_rate_hz = {limits.step_rate_hz:g}"
    )
    raise InputError(f"rpm = {rpm:g}: with {what} {machine.name} reaches {highest:.1f} rpm within {limit}")

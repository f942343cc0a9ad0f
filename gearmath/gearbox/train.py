"""From a hobbing machine and a tooth count to one job: exact ratio, rates against the limits, blank and depth."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cache

from derivations import gearbox as chapter
from derivations import notation as q
from derivations.expression import Expression, Quantity
from gearmath.errors import InputError
from gearmath.lowering import Kernel, lower
from gearmath.specs.hobbing import Hob, HobbingMachine

#: Largest N and D of the int32 step rule; gearmath.gearbox.proof shows that this bound is tight.
WIDEST = int(q.steps_denominator.domain[1])


@dataclass(frozen=True)
class HobbedBlank:
    """Blank of one hob: outside diameter and whole depth [mm]."""

    hob: str
    depth_rule: str
    blank_diameter: float
    cut_depth: float


@dataclass(frozen=True)
class GearboxPlan:
    """One job. N/D motor steps per encoder count, reduced; R = D/N encoder counts per motor step."""

    machine: str
    teeth: int
    hob_starts: int
    steps_numerator: int
    steps_denominator: int
    first_remainder: int
    pulse_ratio: float
    rpm: float
    highest_rpm: float
    edge_rate_hz: float
    step_rate_hz: float
    hob_rpm_percent: float
    step_rate_percent: float
    blanks: tuple[HobbedBlank, ...]

    @property
    def exact_pulse_ratio(self) -> Fraction:
        """R as a fraction."""
        return Fraction(self.steps_denominator, self.steps_numerator)


@cache
def _kernel(name: str) -> Kernel:
    expression: Expression = getattr(chapter, name)()
    return lower(expression)


def evaluate(name: str, *arguments: float) -> tuple[float, ...]:
    """The outputs of one expression of the gearbox chapter at one point, through its kernel."""
    return tuple(float(output) for output in _kernel(name)(*arguments))


def plan(
    machine: HobbingMachine,
    teeth: int,
    starts: int | None = None,
    hob: str | None = None,
    rpm: float | None = None,
) -> GearboxPlan:
    """The job of cutting ``teeth`` teeth.

    ``starts`` are those of the machine file if not given; ``hob`` is a name of its list (all of them if not given);
    ``rpm`` is the hob speed, by default the highest that keeps both limits.
    Raises InputError where the ratio or the speed cannot be carried, with the nearest choice that can.
    """
    starts = machine.hob_starts if starts is None else starts
    _check_range("teeth", teeth, q.teeth)
    _check_range("starts", starts, q.hob_starts)
    reason = refusal(machine, teeth, starts)
    if reason:
        raise InputError(f"{machine.name}: teeth = {teeth}: {reason}; {_nearest(machine, teeth, starts)}")
    ratio = steps_per_count(machine, teeth, starts)
    highest = _highest_rpm(machine, ratio)
    speed = highest if rpm is None else rpm
    _check_speed(machine, teeth, speed, highest)
    edge_rate = speed / 60.0 * machine.encoder_counts
    (pulse_ratio,) = evaluate("gearbox_ratio", *_train(machine, teeth, starts))
    (step_rate,) = evaluate("desired_position", edge_rate, pulse_ratio)
    (first_remainder,) = evaluate("gearbox_start", ratio.denominator)
    return GearboxPlan(
        machine=machine.name,
        teeth=teeth,
        hob_starts=starts,
        steps_numerator=ratio.numerator,
        steps_denominator=ratio.denominator,
        first_remainder=int(first_remainder),
        pulse_ratio=pulse_ratio,
        rpm=speed,
        highest_rpm=highest,
        edge_rate_hz=edge_rate,
        step_rate_hz=step_rate,
        hob_rpm_percent=100.0 * speed / machine.limits.hob_rpm,
        step_rate_percent=100.0 * step_rate / machine.limits.step_rate_hz,
        blanks=tuple(_blank(teeth, chosen) for chosen in _hobs(machine, hob)),
    )


def steps_per_count(machine: HobbingMachine, teeth: int, starts: int) -> Fraction:
    """N/D, motor steps per encoder count, reduced."""
    numerator, denominator = evaluate("gearbox_terms", *_train(machine, teeth, starts))
    return Fraction(int(numerator), int(denominator))


def refusal(machine: HobbingMachine, teeth: int, starts: int) -> str | None:
    """Why the int32 step rule cannot carry this ratio, or None if it can."""
    ratio = steps_per_count(machine, teeth, starts)
    if ratio > 1:
        return (
            f"{ratio.numerator}/{ratio.denominator} motor steps per encoder count is more than the one step that "
            "an edge can deliver"
        )
    if ratio.denominator > WIDEST:
        return (
            f"the ratio {ratio.numerator}/{ratio.denominator} needs more than {WIDEST}, the limit of 32-bit arithmetic"
        )
    return None


def _nearest(machine: HobbingMachine, teeth: int, starts: int) -> str:
    """The feasible tooth count next to ``teeth``, as half a sentence."""
    low, high = (int(bound) for bound in q.teeth.domain)
    for other in sorted(range(low, high + 1), key=lambda count: abs(count - teeth)):
        if refusal(machine, other, starts) is None:
            return f"the nearest tooth count that can be cut is {other}"
    return f"no tooth count from {low} to {high} can be cut with this drive train"


def _check_range(key: str, value: int, quantity: Quantity) -> None:
    low, high = (int(bound) for bound in quantity.domain)
    if not low <= value <= high:
        raise InputError(f"{key} = {value}: must lie between {low} and {high}")


def _highest_rpm(machine: HobbingMachine, ratio: Fraction) -> float:
    by_steps = machine.limits.step_rate_hz * 60.0 / (machine.encoder_counts * float(ratio))
    return min(machine.limits.hob_rpm, by_steps)


def _check_speed(machine: HobbingMachine, teeth: int, rpm: float, highest: float) -> None:
    if not 0.0 < rpm < float("inf"):
        raise InputError(f"rpm = {rpm:g}: must be a positive hob speed")
    if rpm <= highest:
        return
    limits = machine.limits
    limit = (
        f"limits.hob_rpm = {limits.hob_rpm:g}"
        if highest == limits.hob_rpm
        else f"limits.step_rate_hz = {limits.step_rate_hz:g}"
    )
    raise InputError(f"rpm = {rpm:g}: with {teeth} teeth {machine.name} reaches {highest:.1f} rpm within {limit}")


def _train(machine: HobbingMachine, teeth: int, starts: int) -> tuple[int, int, int, int]:
    return teeth, starts, machine.encoder_counts, machine.motor_steps


def _hobs(machine: HobbingMachine, name: str | None) -> tuple[Hob, ...]:
    if name is None:
        return machine.hobs
    for hob in machine.hobs:
        if hob.name == name.strip().lower():
            return (hob,)
    raise InputError(f"hob = {name!r}: {machine.name} has {', '.join(hob.name for hob in machine.hobs)}")


def _blank(teeth: int, hob: Hob) -> HobbedBlank:
    blank_diameter, cut_depth = evaluate("hobbed_blank", teeth, hob.module_mm, *hob.depth_terms)
    return HobbedBlank(hob.name, hob.depth_rule, blank_diameter, cut_depth)

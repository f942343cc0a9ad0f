"""Planning a gear on a hobbing machine: its ratio, and blank, depth and check dimensions for every hob."""

from __future__ import annotations

import math
from dataclasses import dataclass

from derivations import notation as q
from gearmath.errors import InputError
from gearmath.gearbox.dimensions import (
    PIN,
    Chord,
    Gear,
    OverPins,
    Span,
    Swivel,
    Undercut,
    blank_diameter,
    chord,
    over_pins,
    span,
    straight_height,
    swivel,
    undercut,
)
from gearmath.gearbox.helix import SIGNS, TRAVEL, JobRatio, Rounding, helical_ratio, hob_ratio, one_term
from gearmath.gearbox.job import WIDEST, GearboxJob, check_range, job_values, nearest, refusal
from gearmath.gearbox.kernels import evaluate
from gearmath.specs.helix import FeedSense, Helix
from gearmath.specs.hobbing import Hand, Hob, HobbingMachine

__all__ = ["WIDEST", "GearboxPlan", "HelixPlan", "HobbedBlank", "plan"]


@dataclass(frozen=True)
class HobbedBlank:
    """A gear cut by one hob: outside diameter and whole depth [mm], and the dimensions that check it.

    Span or measurement over pins is None where none lies on the flanks, the swivel where the hob's diameter is unknown.
    Where the depth reaches the axis of the blank there is no gear, and all three and the chord are None.
    """

    hob: str
    depth_rule: str
    blank_diameter: float
    cut_depth: float
    swivel: Swivel | None
    span: Span | None
    chord: Chord | None
    over_pins: OverPins | None
    undercut: Undercut | None
    """None where the hob leaves the whole involute."""
    count_um: float
    """Way of the pitch circle per encoder count [um]."""
    step_um: float
    """And per motor step."""

    @property
    def reaches_axis(self) -> bool:
        """Whether the depth takes the whole blank away."""
        return self.cut_depth >= self.blank_diameter / 2


@dataclass(frozen=True)
class HelixPlan:
    """A helix: lead [mm], and what the rounded ratio costs at most, and really, over ``travel`` mm [steps]."""

    helix_deg: float
    hand: Hand
    cut: FeedSense
    feed_mm: float | None
    lead: float
    travel: float
    error_bound_steps: float
    error_steps: float


@dataclass(frozen=True)
class GearboxPlan(GearboxJob):
    """A gear on a hobbing machine."""

    teeth: int
    hob_starts: int
    hob_hand: Hand
    profile_shift: float
    helix: HelixPlan | None
    blanks: tuple[HobbedBlank, ...]


def plan(
    machine: HobbingMachine,
    teeth: int,
    starts: int | None = None,
    hob: str | None = None,
    rpm: float | None = None,
    helix: Helix | None = None,
    shift: float = 0.0,
    pin: float | None = None,
    run_up: float | None = None,
) -> GearboxPlan:
    """The job of cutting ``teeth`` teeth.

    ``starts`` are those of the machine file if not given; ``hob`` is a name of its list (all of them if not given, but
    a helix needs one); ``rpm`` is the hob speed, by default the highest that keeps the limits; ``shift`` is the profile
    shift in modules; ``pin`` the diameter of measuring pins [mm]; ``run_up`` the time of the hob from rest to its
    speed, or back [s].
    Raises InputError where the ratio or the speed cannot be carried, with the nearest choice that can.
    """
    if machine.profile != "hobbing":
        raise InputError(f"teeth = {teeth}: {machine.name} is a lathe, give the pitch of a thread instead")
    starts = machine.hob_starts if starts is None else starts
    check_range("teeth", teeth, q.teeth)
    check_range("starts", starts, q.hob_starts)
    _check_shift(shift, pin)
    hobs = _hobs(machine, hob)
    ratio, rounding = _ratio(machine, teeth, starts, hobs, helix)
    reason = refusal(machine, ratio)
    if reason:
        other = nearest(
            "tooth count",
            teeth,
            q.teeth,
            lambda count: refusal(machine, _ratio(machine, count, starts, hobs, helix)[0]) is None,
        )
        raise InputError(f"{machine.name}: teeth = {teeth}: {reason}; {other}")
    blanks = tuple(_blank(machine, teeth, starts, chosen, helix, shift, pin) for chosen in hobs)
    if pin is not None and all(blank.over_pins is None for blank in blanks):
        usual = ", ".join(f"{PIN * chosen.module_mm:.4g} mm ({chosen.name})" for chosen in hobs)
        raise InputError(f"pin = {pin:g}: does not lie on the flanks of {teeth} teeth; usual are {usual}")
    return GearboxPlan(
        **job_values(machine, ratio, rpm, f"{teeth} teeth", run_up),  # type: ignore[arg-type]
        teeth=teeth,
        hob_starts=starts,
        hob_hand=machine.hob_hand,
        profile_shift=shift,
        helix=_helix_plan(teeth, hobs[0], helix, rounding),
        blanks=blanks,
    )


def _ratio(
    machine: HobbingMachine, teeth: int, starts: int, hobs: tuple[Hob, ...], helix: Helix | None
) -> tuple[JobRatio, Rounding | None]:
    if helix is None:
        return one_term(hob_ratio(machine, teeth, starts), machine.encoder_counts.denominator), None
    if len(hobs) > 1:
        names = ", ".join(hob.name for hob in hobs)
        raise InputError(f"helix = {helix.angle:g}: the lead depends on the hob, choose one of {names}")
    return helical_ratio(machine, teeth, starts, hobs[0].module_mm, helix)


def _helix_plan(teeth: int, hob: Hob, helix: Helix | None, rounding: Rounding | None) -> HelixPlan | None:
    if helix is None or rounding is None:
        return None
    (lead,) = evaluate("helical_lead", teeth, hob.module_mm, helix.beta)
    feed = None if helix.feed is None else float(helix.feed)
    return HelixPlan(helix.angle, helix.hand, helix.cut, feed, lead, float(TRAVEL), rounding.bound, rounding.error)


def _check_shift(shift: float, pin: float | None) -> None:
    low, high = q.profile_shift.domain
    if not low <= shift <= high:
        raise InputError(f"shift = {shift:g}: must lie between {low:g} and {high:g} modules")
    if pin is not None and not 0.0 < pin < math.inf:
        raise InputError(f"pin = {pin:g}: must be a positive diameter in mm")


def _hobs(machine: HobbingMachine, name: str | None) -> tuple[Hob, ...]:
    if name is None:
        return machine.hobs
    for hob in machine.hobs:
        if hob.name == name.strip().lower():
            return (hob,)
    raise InputError(f"hob = {name!r}: {machine.name} has {', '.join(hob.name for hob in machine.hobs)}")


def _blank(
    machine: HobbingMachine, teeth: int, starts: int, hob: Hob, helix: Helix | None, shift: float, pin: float | None
) -> HobbedBlank:
    gear = Gear(teeth, hob.module_mm, hob.alpha, 0.0 if helix is None else helix.beta, shift)
    _, depth = evaluate("hobbed_blank", teeth, hob.module_mm, *hob.depth_terms)
    stands = None
    if hob.diameter is not None:
        hand = 1 if helix is None else helix.sign
        stands = swivel(gear, SIGNS[machine.hob_hand], hand, starts, hob.diameter)
    pitch_diameter = teeth * hob.module_mm / math.cos(gear.beta)
    train = (float(machine.encoder_counts), float(machine.motor_steps))
    arcs = evaluate("resolution", pitch_diameter, teeth, starts, *train)
    outside = blank_diameter(gear)
    solid = depth < outside / 2
    protruding = hob.protuberance * hob.module_mm
    height = straight_height(
        hob.module_mm, hob.alpha, hob.addendum, hob.tip_rounding, protruding, hob.alpha_protuberance
    )
    return HobbedBlank(
        hob.name,
        hob.depth_rule,
        outside,
        depth,
        stands if solid else None,
        span(gear) if solid else None,
        chord(gear) if solid else None,
        over_pins(gear, pin) if solid else None,
        undercut(gear, height),
        *arcs,
    )

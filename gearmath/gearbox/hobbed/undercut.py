"""What cannot be measured on a gear that its hob undercuts: a plan without it."""

from __future__ import annotations

from dataclasses import replace

from gearmath.gearbox.dimensions import Gear, over_pins, span
from gearmath.gearbox.helix import SIGNS
from gearmath.gearbox.hobbed.job import HobbingJob, HobTool
from gearmath.gearbox.hobbed.root import undercut_radius
from gearmath.gearbox.train import GearboxPlan, HobbedBlank
from gearmath.specs.hob import Hob
from gearmath.specs.hobbing import HobbingMachine


def measurable(plan: GearboxPlan, machine: HobbingMachine, beta: float) -> GearboxPlan:
    """The plan without span and pins that would touch where the involute is cut away; helix angle ``beta`` [rad]."""
    hobs = {hob.name: hob for hob in machine.hobs}
    return replace(plan, blanks=tuple(_blank(plan, machine, one, hobs[one.hob], beta) for one in plan.blanks))


def _blank(plan: GearboxPlan, machine: HobbingMachine, blank: HobbedBlank, hob: Hob, beta: float) -> HobbedBlank:
    if blank.undercut is None or blank.reaches_axis:
        return blank
    gear = Gear(plan.teeth, hob.module_mm, hob.alpha, beta, plan.profile_shift)
    protruding = hob.protuberance * hob.module_mm
    tip = (hob.addendum, hob.tip_rounding, protruding, hob.alpha_protuberance if protruding else 0.0)
    # the diameter matters to the swivel alone
    diameter = max(hob.reference_diameter, 6.0 * hob.module_mm * plan.hob_starts)
    tool = HobTool(plan.hob_starts, SIGNS[machine.hob_hand], hob.gashes, diameter, *tip)
    hand = 1 if plan.helix is None else SIGNS[plan.helix.hand]
    job = HobbingJob(gear, hand, tool, gear.module, gear.module)
    involute_from = undercut_radius(job, blank.blank_diameter / 2) or 0.0
    pins = None if blank.over_pins is None else over_pins(gear, blank.over_pins.pin, involute_from)
    return replace(blank, span=span(gear, involute_from), over_pins=pins)

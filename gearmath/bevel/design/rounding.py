"""The steps to which a shop sets machine and cutter: the gear first, then the pinion that goes with the rounded gear.

Of the pinion, blade angle and point radius are rounded one after the other, and what is still free is fitted again to
each; the rest is rounded as it is. What the numbers then give is told by the contact analysis of the rounded set.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearmath.bevel.design import both_system
from gearmath.bevel.design.completing import CompletingPinion
from gearmath.bevel.design.local_settings import NAMES
from gearmath.bevel.design.pinion import PinionFlank, refitted, roll_rows
from gearmath.specs.bevel_set import FLANKS, MACHINE_SETTINGS, SETTINGS, Member
from gearmath.specs.cut import ANGULAR, RATIO
from gearmath.specs.design import Shop
from gearmath.specs.shop_steps import angle_to_step, to_step
from gearmath.specs.toml import checked

_BLADE = {"blade_pressure_angle": "blade_angle_step", "blade_point_radius": "blade_radius_step"}


def step_of(name: str, shop: Shop) -> float:
    """The step of a setting [mm, degree]."""
    if name in _BLADE:
        return float(getattr(shop, _BLADE[name]))
    if name == RATIO:
        return shop.ratio_step
    return shop.angle_step if name in ANGULAR else shop.length_step


def rounded_gear(gear: Member, shop: Shop) -> Member:
    """The gear with all of its settings in steps."""
    values = gear.model_dump()
    for flank in FLANKS:
        for name in SETTINGS:
            values[flank][name] = to_step(values[flank][name], step_of(name, shop))
    return checked(values, Member, "gear").named("gear")


def rounded_pinion(flank: PinionFlank, shop: Shop) -> PinionFlank:
    """A flank of the pinion with all of its settings in steps but the work rotation offset, which sets the backlash."""
    found = flank
    for name in _BLADE:
        if step := step_of(name, shop):
            found = refitted(found, name, _to_step(found, name, step))
    x = found.x.copy()
    for name in SETTINGS:
        step = step_of(name, shop)
        if step and name != "work_rotation_offset":
            x[NAMES.index(name)] = _to_step(found, name, step)
    _round_roll(x, NAMES, shop)
    if (x == found.x).all():
        return found
    local = replace(found.fitted.local, x=x)
    return replace(found, fitted=replace(found.fitted, local=local))


def rounded_completing(pinion: CompletingPinion, shop: Shop) -> CompletingPinion:
    """Both flanks of a pinion that is cut completing with all settings in steps but the work rotation offset."""
    x, steps = pinion.fitted.x, {name: step_of(name, shop) for name in _BLADE}
    own = [f"{flank}.{name}" for flank in FLANKS for name, step in steps.items() if step]
    places = [both_system.NAMES.index(name) for name in own]
    stepped = [_stepped(x[k], name, steps[name.rpartition(".")[2]]) for k, name in zip(places, own, strict=True)]
    found = pinion.refitted(own, stepped) if own else pinion
    values = {}
    for name in MACHINE_SETTINGS:
        if name != "work_rotation_offset" and (step := step_of(name, shop)):
            values[name] = _stepped(found.fitted.x[both_system.NAMES.index(name)], name, step)
    rounded = found.with_settings(values)
    _round_roll(rounded.fitted.x, both_system.NAMES, shop)
    return rounded


def _round_roll(x: np.ndarray, names: Sequence[str], shop: Shop) -> None:
    """Set 2C and 6D of a vector with these names to steps, at its ratio of roll (10.7)."""
    if not shop.modified_roll_step:
        return
    rows = roll_rows(float(x[names.index("ratio_of_roll")]), (1.0, 1.0))
    for name, row in zip(("modified_roll_2", "modified_roll_3"), rows, strict=True):
        k = names.index(name)
        x[k] = to_step(float(x[k] / row), shop.modified_roll_step) * row


def _stepped(value: float, name: str, step: float) -> float:
    angular = name.rpartition(".")[2] in ANGULAR
    return angle_to_step(value, step) if angular else to_step(float(value), step)


def _to_step(flank: PinionFlank, name: str, step: float) -> float:
    return _stepped(float(flank.x[NAMES.index(name)]), name, step)

"""Tooth thickness on request: settings that leave every tooth thicker or thinner by so much at its reference point.

Thickness is what both flanks have more, along their normals. It comes from the work rotation of each flank where each
has its own settings, or from the depth; the backlash of the pair falls by what both members gain.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from gearmath.bevel.flank import Grid, blank_grid, solve_flank
from gearmath.bevel.identify.flank_target import FlankTarget, predicted
from gearmath.bevel.identify.variables import whole
from gearmath.errors import ComputationError, InputError
from gearmath.quality.correction.target import target_of
from gearmath.specs.bevel_set import FLANKS, SETTINGS, Member

By = Literal["work_rotation_offset", "sliding_base"]

_STEPS = 20
_CLOSE = 1e-10
#: Most that a tooth is made thicker or thinner. [mm]
MOST = 0.5


def with_thickness(
    member: Member, settings: dict[str, np.ndarray], change: float, by: By = "work_rotation_offset"
) -> dict[str, np.ndarray]:
    """Settings (12,) of both flanks that leave the teeth thicker by ``change`` [mm] than ``settings`` do.

    Along the normals at the middle of the flanks, half of it on each. By ``work_rotation_offset`` each flank is turned;
    by ``sliding_base`` the cut is less deep, alike on both flanks. Raises InputError where the cut does not allow it.
    """
    if not abs(change) <= MOST:
        raise InputError(f"thickness = {change:g} mm: must lie between -{MOST} and {MOST} mm")
    if by == "work_rotation_offset" and member.cutting == "completing":
        raise InputError(
            f"{member.name}: one cut makes both flanks, so that thickness can only come from the sliding_base"
        )
    targets = {flank: _reference(member, flank) for flank in FLANKS}
    row = SETTINGS.index(by)
    groups = [(flank,) for flank in FLANKS] if by == "work_rotation_offset" else [FLANKS]
    found = dict(settings)
    for group in groups:
        shift, wanted = 0.0, change * len(group) / len(FLANKS)
        for _ in range(_STEPS):
            gained, rate = 0.0, 0.0
            for flank in group:
                moved = settings[flank].copy()
                moved[row] += shift
                before, _ = predicted(targets[flank], _vector(targets[flank], settings[flank]))
                after, gradient = predicted(targets[flank], _vector(targets[flank], moved))
                gained += float((after - before)[0])
                rate += float(gradient[0, row])
            if abs(gained - wanted) <= _CLOSE:
                break
            shift += (wanted - gained) / rate
        else:
            raise ComputationError(f"{member.name}: no {by} makes the teeth thicker by {change * 1000:g} um")
        for flank in group:
            found[flank] = settings[flank].copy()
            found[flank][row] += shift
    return found


def _reference(member: Member, flank: str) -> FlankTarget:
    """The middle of a flank as a target of one point."""
    grid = blank_grid(member, 3, 3)
    middle = Grid(grid.axial[1:2, 1:2], grid.radial[1:2, 1:2])
    return replace(target_of(member, flank, solve_flank(member, flank, middle)), root=None)


def _vector(target: FlankTarget, settings: np.ndarray) -> np.ndarray:
    return whole(settings, target.how.motion, target.curvature)

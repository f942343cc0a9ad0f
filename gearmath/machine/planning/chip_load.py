"""What each blade of a planned cut takes: advance from blade to blade, and the chip, in the plunge and in the roll."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.turning import turned
from gearmath.kernels import kernel
from gearmath.machine.planning.passes import Pass
from gearmath.machine.planning.path import Cut, axis_positions, flank_points
from gearmath.specs.bevel_set import SIDES, Member
from gearmath.specs.milling_machine import MillingMachine


@dataclass(frozen=True)
class Bite:
    """The most that one blade gets [mm]: advance of the work from blade to blade, and the chip square to the flank."""

    advance: float
    chip: float


@dataclass(frozen=True)
class ChipLoad:
    """What a blade takes of one flank in the plunge, and in the roll past its mean point, None where nothing rolls.

    ``blades`` that cut the flank in a turn of the cutter, in face hobbing of the work. Where the set does not say, it
    is None, and the bites are those of one blade alone: they are to be divided by the number of blades.
    """

    flank: str
    blades: int | None
    plunge: Bite
    roll: Bite | None


def chip_loads(
    member: Member, machine: MillingMachine, passes: Sequence[Pass], rpm: float, plunge_feed: float
) -> tuple[ChipLoad, ...]:
    """The chips (29.2) of every flank in the last pass of its cutter, at their thickest.

    ``plunge_feed`` [mm/min] is that of an approach down to the first point of a roll: there it is taken as if all of it
    went through metal. Of a Formate cut and in face hobbing the plunge is the one that is planned.
    """
    last = {one.tool: one.in_straight_parts() for one in passes}
    cuts = [(cut, flank) for cut in Cut.of(member) for flank in cut.flanks if cut.tool in last]
    return tuple(_load(member, flank, machine, last[cut.tool], rpm, plunge_feed) for cut, flank in cuts)


def _load(member: Member, flank: str, machine: MillingMachine, one: Pass, rpm: float, plunge_feed: float) -> ChipLoad:
    spec, index = member.flank(flank), member.indexing_sign * (member.blade_groups or 0) / member.teeth
    blades = 1 if member.process == "face_hobbing" else spec.blade_count
    speeds = np.full(len(one.seconds), rpm)
    if one.axes.shape[1] == 6:
        speeds = np.abs(np.diff(one.axes[:, 5])) / one.seconds * 60 / (2 * math.pi)
    (period,) = kernel("blade_period")(speeds, abs(index) if member.blade_groups else blades or 1)
    rolling = np.diff(one.theta) != 0.0
    down = np.zeros((len(one.seconds), 3))
    down[:, 2] = np.diff(one.axes[:, 2]) / one.seconds
    if rolling.all():
        down, period_down = np.array([[0.0, 0.0, plunge_feed / 60]]), period[:1]
    else:
        down, period_down = down[~rolling], period[~rolling]
    angle, side = spec.alpha, SIDES[flank]
    roll = None
    if rolling.any():
        passing = _passing(member, flank, machine, one, index)
        roll = _bite(passing[rolling], period[rolling], angle, side)
    return ChipLoad(flank, blades, _bite(down, period_down, angle, side), roll)


def _bite(passing: np.ndarray, period: np.ndarray, angle: float, side: int) -> Bite:
    """The largest advance and chip of speeds (n,3) [mm/s] and periods (n,) [s]."""
    advance, thickness = kernel("chip")(passing, period, angle, side)
    return Bite(float(np.max(advance)), float(np.max(thickness)))


def _passing(member: Member, flank: str, machine: MillingMachine, one: Pass, index: float) -> np.ndarray:
    """Speed (n-1,3) [mm/s] of the mean point past the cutter: radial, along the cut, along k; the indexing left out."""
    middle = flank_points(member, flank, blank_grid(member, 1, 1))
    point = turned(middle.point[0], index * middle.contact[0, 1])  # as if cutter and work stood still at its contact
    axes = axis_positions(member.flank(flank), one.theta, machine.pivot_height, machine.pivot)
    (seen,) = kernel("seen_from_tool")(axes, point, machine.pivot_height, machine.pivot)
    speed, place = np.diff(seen, axis=0) / one.seconds[:, None], (seen[1:, :2] + seen[:-1, :2]) / 2
    out = place / np.linalg.norm(place, axis=1, keepdims=True)
    radial = np.einsum("ij,ij->i", speed[:, :2], out)
    along = speed[:, 1] * out[:, 0] - speed[:, 0] * out[:, 1]
    return np.column_stack([radial, along, -speed[:, 2]])  # the tool points down: k is -Z

"""Which single setting of a flank, given another value, would put right what the flank is found wrong in.

Other values are those of the usual slips (a sign, inches, a place of the decimal point, degrees and radians), that of
the other flank and that of the crown gear. Every one is tried: the mean point and the root are solved with it, all of
them in one call. So a setting is not blamed for being unusual, only for what changing it alone would put right.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from operator import ge, gt, le, lt

import numpy as np

from gearmath.bevel.check_flank import OFF_CENTER, ROOT
from gearmath.bevel.generation import Generation
from gearmath.bevel.generation_kernels import generation_point
from gearmath.bevel.method import generation_of
from gearmath.bevel.newton import TOLERANCE
from gearmath.bevel.root import CORNER, mean_place
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import FLANKS, SETTINGS, Member, Settings
from gearmath.specs.cut import RATIO
from gearmath.specs.ratio import DEGREE, RADIAN

#: What counts as one: spiral and pressure angle off those wanted. [rad]
_SPIRAL, _PRESSURE = math.radians(2), math.radians(5)
#: A point that is not there at all.
_NONE = 100.0
_CALLS = 4
_SLIPS = (-1.0, 25.4, 1 / 25.4, 10.0, 0.1, DEGREE, RADIAN, -10.0, -25.4)
_STEP = {"ratio_of_roll": 1e-3}  # else in mm or degrees
_PHASE = "work_rotation_offset"  # moves mean point and root around the axis alone


@dataclass(frozen=True)
class Wanted:
    """Spiral angle (signed) and pressure angle that a flank should have at its mean point [rad]."""

    spiral: float
    pressure: float


def misfit(member: Member, flank: str, settings: np.ndarray, index: np.ndarray, wanted: Wanted) -> np.ndarray:
    """What is wrong (6,n) of a flank with settings (n,12) and indexing N_b/z (n,): beyond 1 it is refused for it."""
    how, blank, n = generation_of(member, flank), member.blank, len(settings)
    axial, radial = (np.full(n, value[0]) for value in mean_place(member))
    conditions = np.zeros((n, 2, 4))
    conditions[:, 0, 1], conditions[:, 0, 3] = 1.0, axial
    conditions[:, 1, 2], conditions[:, 1, 3] = 1.0, radial
    (start,) = kernel("contact_start")(settings, how.side, axial, radial)
    if not how.rolling:
        start[:, 2] = 0.0
    contact, point, normal, solved = _solve(how, settings, index, np.nan_to_num(start), conditions)
    pressure, spiral, _, _ = kernel("flank_angles")(blank.delta, point, normal)
    parts = [
        contact[:, 2] / math.radians(OFF_CENTER),
        (spiral - wanted.spiral) / _SPIRAL,
        (pressure - wanted.pressure) / _PRESSURE,
        *_root_off(member, flank, how, settings, index, contact),
    ]
    off = np.stack(parts)
    off = np.where(np.isfinite(off), np.clip(off, -_NONE, _NONE), _NONE)
    return np.where(solved, off, 2 * _NONE)


def _solve(
    how: Generation,
    settings: np.ndarray,
    index: np.ndarray,
    contact: np.ndarray,
    conditions: np.ndarray,
    arc: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    blade = () if arc is None else (arc,)
    for _ in range(_CALLS):
        contact, point, normal, residual, _ = generation_point(arc is not None)(
            contact, settings, how.motion, index, how.blade_offset_angle, *blade, how.side, how.rolling, conditions
        )
        contact = np.nan_to_num(contact)
    return contact, point, normal, residual <= TOLERANCE


def _root_off(
    member: Member, flank: str, how: Generation, settings: np.ndarray, index: np.ndarray, mean: np.ndarray
) -> list[np.ndarray]:
    """How far the tip of the blade leaves the root beside that of the blank, toe to heel, over what it may (3 of n)."""
    blank, delta = member.blank, member.blank.delta
    height, off = member.flank(flank).blade_tip_height, []
    # the lowest point of a vanishing round, whose tangent is the tip plane
    (radius,) = kernel("blade_tip")(settings[:, -2], settings[:, -1], height, how.side)
    corner = np.full((len(settings), 3), [0.0, height + CORNER, CORNER])
    corner[:, 0] = radius
    for across, share in zip((0.0, 0.5, 1.0), ROOT, strict=True):
        (axial,), (radial,) = kernel("flank_place")(blank.vector, np.array([across]), np.array([0.0]))
        distance = axial * math.cos(delta) + radial * math.sin(delta)
        root = radial * math.cos(delta) - axial * math.sin(delta) - blank.clearance
        conditions = np.zeros((len(settings), 2, 4))
        conditions[:, 0, 0], conditions[:, 0, 3] = 1.0, math.pi / 2
        conditions[:, 1, 1:] = math.cos(delta), math.sin(delta), distance
        start = np.column_stack([np.full(len(settings), math.pi / 2), mean[:, 1:]])
        _, point, _, solved = _solve(how, settings, index, start, conditions, corner)
        left = np.hypot(point[:, 0], point[:, 1]) * math.cos(delta) - point[:, 2] * math.sin(delta)
        off.append(np.where(solved, (left - root) / (share * blank.clearance), np.nan))
    return off


@dataclass(frozen=True)
class Repair:
    """A value of a setting (as in the file) that puts a flank right: how wrong it was, and how wrong it is then;
    ``solved`` where it is no usual slip but the value that leaves least."""

    key: str
    value: float
    other: float
    before: float
    after: float
    solved: bool = False


def allowed(key: str, value: float) -> bool:
    """Whether a set file may give a setting this value."""
    limits = Settings.model_fields[key].metadata
    return math.isfinite(value) and all(
        holds(value, getattr(limit, name))
        for limit in limits
        for name, holds in (("gt", gt), ("ge", ge), ("lt", lt), ("le", le))
        if getattr(limit, name, None) is not None
    )


def repairs(member: Member, flank: str, expected: Mapping[str, float], wanted: Wanted) -> list[Repair]:
    """Every trial of every setting of a flank; ``expected`` holds the crown gear's values."""
    spec, beside = member.flank(flank).nominal, member.flank(FLANKS[1 - FLANKS.index(flank)]).nominal
    rows, trials = [spec.vector], []
    for key in SETTINGS:
        if key == _PHASE:
            continue
        value = getattr(spec, key)
        slips = {value * slip for slip in _SLIPS} | ({1 / value} if key == RATIO else set())
        for other in slips | {expected.get(key, value), getattr(beside, key)} - {value}:
            if allowed(key, other) and other != value:
                trials.append((key, value, other))
                rows.append(spec.model_copy(update={key: other}).vector)
    slipped = len(trials)
    for key, value, other in _solved(member, flank, wanted):
        if not allowed(key, other):
            continue
        trials.append((key, value, other))
        rows.append(spec.model_copy(update={key: other}).vector)
    solved = range(slipped, len(trials))
    index = np.full(len(rows) + 1, member.indexing_sign * (member.blade_groups or 0) / member.teeth)
    index[-1] *= -1
    size = np.linalg.norm(misfit(member, flank, np.array([*rows, spec.vector]), index, wanted), axis=0)
    if member.blade_groups:
        trials.append(("indexing_sign", member.indexing_sign, -member.indexing_sign))
    return [
        Repair(*trial, before=float(size[0]), after=float(after), solved=k in solved)
        for k, (trial, after) in enumerate(zip(trials, size[1:], strict=False))
    ]


def _solved(member: Member, flank: str, wanted: Wanted) -> list[tuple[str, float, float]]:
    """Setting, value, and the value that a linear step gives: it leaves least of what is wrong."""
    spec, keys = member.flank(flank).nominal, [key for key in SETTINGS if key != _PHASE]
    steps = {key: _STEP.get(key, 0.05) for key in keys}
    rows = [spec.vector] + [
        spec.model_copy(update={key: getattr(spec, key) + step}).vector for key, step in steps.items()
    ]
    index = np.full(len(rows), member.indexing_sign * (member.blade_groups or 0) / member.teeth)
    off = misfit(member, flank, np.array(rows), index, wanted)
    if not (np.abs(off) < _NONE).all():
        return []
    found = []
    for key, change in zip(keys, (off[:, 1:] - off[:, :1]).T, strict=True):
        size = float(change @ change)
        if size > 0:
            value = getattr(spec, key)
            found.append((key, value, value - steps[key] * float(change @ off[:, 0]) / size))
    return found

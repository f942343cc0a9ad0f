"""A flank file out of the points of another measuring machine: one turning for all of them, and rows and columns."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.grid import blank_fractions
from gearmath.bevel.nominal_file import flank_header
from gearmath.bevel.turning import half_turn, turned
from gearmath.errors import InputError, counted
from gearmath.kernels import kernel
from gearmath.quality.evaluation.digits import resolution, rounded_words
from gearmath.quality.evaluation.file_checks import SAME_POINT
from gearmath.quality.foreign.gaps import (
    fractions,
    gap_words,
    lost_words,
    noticeable,
    only,
    outlier_words,
    repeated_words,
    standing_out,
    unlike_words,
)
from gearmath.quality.foreign.lattice import Lattice, find_lattice
from gearmath.quality.foreign.misplaced import check_placed, kept_words
from gearmath.quality.foreign.points import (
    LEAST_FIT,
    SAME_TOOTH,
    Frame,
    Laid,
    Phase,
    PointPart,
    axial_hint,
    check_normals,
    lay,
    turn_of,
)
from gearmath.specs.bevel_set import BevelSet, Member
from gearmath.specs.flank_csv import OWN, PLANNED, FlankFile, flank_file, join

#: Where points form no grid, deviations are interpolated on this one: its rows, columns and margins, widest first.
_ROWS, _COLUMNS, _MARGINS = 5, 9, (0.1, 0.15, 0.2, 0.25, 0.3)
#: Fewer points tell neither a rotation nor a surface.
_LEAST_POINTS = 6
#: A place of that grid was measured if a point lies this near, in steps of the grid.
_NEAR_STEPS = 0.8
#: Turning until the reference points stand still. [rad]
_STEPS, _STILL = 8, 1e-13
#: A surface of third degree is taken through so many of the nearest points, where there are enough.
_NEAREST, _CUBIC, _QUADRATIC, _PLANE = 30, 10, 6, 3
#: A step of the depth counts like this part of the face width.
_TALL = 0.4
#: A margin that the places of a grid share is even; its digits. [mm]
_EVEN, _DIGITS = SAME_POINT / 2, 6


@dataclass(frozen=True)
class Foreign:
    """The flank file, the turning [rad] of every part that was taken out, and what was found, in sentences.

    ``doubts`` are those of the sentences that say that the points may not stand as the options have them, ``gaps`` of
    these the ones that say that points are bad or missing.
    """

    file: FlankFile
    turns: tuple[float, ...]
    remarks: tuple[str, ...]
    doubts: tuple[str, ...] = ()
    gaps: tuple[str, ...] = ()


def foreign_file(
    parts: Sequence[PointPart],
    frame: Frame,
    gear_set: BevelSet,
    name: str,
    phase: Phase = "common",
    progress: Callable[[int], object] = lambda _: None,
    leave_out: bool = False,
) -> Foreign:
    """The measured file of a member out of parts, each of them one flank of one tooth.

    ``phase``: all parts share one turning ("common"), each has its own ("each"), or they stand as the set has them
    ("kept"). A turning is such that the deviation at the reference point is zero, in the mean of the parts, where there
    are both flanks of a common turning in the mean of the flanks: thickness and pitch stay. ``leave_out`` leaves out
    points of a grid that stand out from the others, as those of no grid always are. Raises InputError where points are
    not of their flank, or parts not of their tooth.
    """
    member = gear_set.member(name)
    kept: list[str] = []
    for part in parts:
        if len(part.point) < _LEAST_POINTS:
            raise InputError(
                f"{part.name}: holds {counted(len(part.point), 'point')}, at least {_LEAST_POINTS} are needed"
            )
    turns = []
    for part in parts:
        turns.append(turn_of(part, frame, gear_set, name))
        progress(1)
    if phase == "kept":
        told = [kept_words(part, turn, frame, member) for part, turn in zip(parts, turns, strict=True)]
        kept = [words for words in told if words]
        turns = [0.0] * len(parts)
    elif phase == "common":
        turns = [_common(parts, turns, member)] * len(parts)
    laid = [lay(part, frame, member, turn) for part, turn in zip(parts, turns, strict=True)]
    lattices = _lattices(laid, member)
    if phase != "kept":
        turns, laid = _zeroed(laid, lattices, turns, frame, member, phase == "common")
        lattices = _lattices(laid, member)
    off = [standing_out(one, member) for one in laid]
    steps = {part.name: resolution(part.point.ravel()) for part in parts}
    gaps, doubts = [], [*kept, *(f"{name}: x, y, z are {rounded_words(step)}" for name, step in steps.items() if step)]
    for one, lattice, far in zip(laid, lattices, off, strict=True):
        said = np.zeros(0) if lattice is None else np.where(far, far, noticeable(one, lattice, member))
        bad, less = outlier_words(one, said)
        gaps += [*bad, *gap_words(one, lattice, member)]
        doubts += [*less, *lost_words(one), *repeated_words(one, member)]
    if len(parts) > 1 and not any(lattices):
        doubts += unlike_words(laid, member)
    if leave_out:
        laid = [only(one, far == 0.0) for one, far in zip(laid, off, strict=True)]
        lattices = _lattices(laid, member)
    single = [replace(part, point=part.point[far == 0.0], normal=None) for part, far in zip(parts, off, strict=True)]
    doubts += [hint] if (hint := axial_hint(parts[0], frame, member, turns[0])) else []
    if not hint:
        groups = [[k] for k in range(len(parts))] if phase == "each" else [list(range(len(parts)))]
        told = [check_placed([single[k] for k in group], [turns[k] for k in group], frame, member) for group in groups]
        doubts += [one for one in told if one]
    files, remarks = [], []
    for one, lattice, turn in zip(laid, lattices, turns, strict=True):
        file, found = _file(one, lattice, member)
        files.append(file)
        words = (*found, check_normals(one, frame, member, turn))
        remarks += [f"{one.part.name}: {each}" for each in words if each]
        progress(1)
    zeroed = phase == "each" or (phase == "common" and len({part.flank for part in parts}) == 1)
    header = _header(member, files, frame, zeroed)
    joined = join([replace(file, header=header) for file in files])
    doubts[:0] = gaps
    return Foreign(joined, tuple(turns), (*doubts, *remarks), tuple(doubts), tuple(gaps))


def _common(parts: Sequence[PointPart], turns: Sequence[float], member: Member) -> float:
    """The median turning. Raises InputError where a part is not of its tooth."""
    pitch = 2 * math.pi / member.teeth
    apart = half_turn(np.array(turns) - turns[0])
    for part, angle in zip(parts, apart, strict=True):
        if abs(angle) > SAME_TOOTH * pitch:
            teeth = round(angle / pitch)
            off = angle - teeth * pitch
            other = f"tooth {(part.tooth + teeth) % member.teeth}"
            is_other = teeth and abs(off) <= SAME_TOOTH * pitch
            raise InputError(
                f"{part.name}: its {part.flank} flank is turned by {math.degrees(angle):.3f} degrees against that of "
                f"{parts[0].name}, the pitch is {math.degrees(pitch):.3f}: "
                + (f"it would be of {other}, counted as the set counts" if is_other else "was it clamped anew?")
                + "; --phase each turns every file by itself"
            )
    return turns[0] + float(np.median(apart))


def _lattices(laid: Sequence[Laid], member: Member) -> list[Lattice | None]:
    """The grid of each part; None for all where one has none, or where they are not alike."""
    found = []
    for one in laid:
        if len(one.kept) < LEAST_FIT * len(one.part.point):
            raise InputError(
                f"{one.part.name}: {len(one.part.point) - len(one.kept)} of {len(one.part.point)} points lie beyond "
                "the flank, in the fillet or on the tip"
            )
        found.append(find_lattice(*fractions(one, member)))
    shapes = {None if one is None else (one.rows, one.columns) for one in found}
    return found if len(shapes) == 1 else [None] * len(found)


def _zeroed(
    laid: Sequence[Laid],
    lattices: Sequence[Lattice | None],
    turns: Sequence[float],
    frame: Frame,
    member: Member,
    together: bool,
) -> tuple[list[float], list[Laid]]:
    """Turnings and points at which the deviation at the reference points is zero, or in the mean of the flanks."""
    found, turns = list(laid), list(turns)
    flanks = [one.part.flank for one in laid]
    bad = [standing_out(one, member) != 0.0 for one in laid]
    for _ in range(_STEPS):
        angles = np.array([_reference_turn(*each, member) for each in zip(found, lattices, bad, strict=True)])
        if together:
            means = [angles[[each == flank for each in flanks]].mean() for flank in sorted(set(flanks))]
            angles[:] = np.mean(means)
        turns = [turn + float(angle) for turn, angle in zip(turns, angles, strict=True)]
        found = [lay(one.part, frame, member, turn) for one, turn in zip(found, turns, strict=True)]
        if np.abs(angles).max() <= _STILL:
            break
    return turns, found


def _reference_turn(one: Laid, lattice: Lattice | None, bad: np.ndarray, member: Member) -> float:
    """Angle [rad] by which the work must be turned so that the deviation at the reference point of a part is zero.

    Where that point is missing or stands out from the others, what they say of its place counts.
    """
    across, up = fractions(one, member)
    at, off = np.zeros(len(one.kept), dtype=bool), bad[one.kept]
    place = np.array([0.5, 0.5])
    if lattice is not None and len(lattice.row) == len(one.kept):
        row, col = lattice.rows // 2, lattice.columns // 2
        at = (lattice.row == row) & (lattice.col == col)
        lines = (across[lattice.col == col], up[lattice.row == row])  # a part of a grid may lack its middle
        place = np.array([line.mean() if len(line) else middle for line, middle in zip(lines, place, strict=True)])
    # a surface says nothing of what lies beyond its points
    place = np.clip(place, (across.min(), up.min()), (across.max(), up.max()))
    if at.any() and not off[at].any():
        return float(one.deviation[at][0] / one.lever[at][0])
    nearest = int(np.argmin(np.hypot(across - place[0], up - place[1])))
    return _smooth(across[~off], up[~off], one.deviation[~off], place) / float(one.lever[nearest])


def _smooth(across: np.ndarray, up: np.ndarray, deviation: np.ndarray, place: np.ndarray) -> float:
    """The deviation at a place, out of a surface of up to third degree through the nearest points."""
    x, y = across - place[0], _TALL * (up - place[1])
    away = np.hypot(x, y)
    near = np.argsort(away)[: _NEAREST + 1]
    weight = (1 - (away[near] / away[near].max()) ** 3) ** 1.5  # roots of the tricube weights; the farthest has none
    _, terms = kernel("deviation_surface")(x[near], y[near], np.zeros(_CUBIC))
    enough = [count for count in (_CUBIC, _QUADRATIC, _PLANE) if len(near) >= 1.5 * count]
    used = terms[:, : enough[0] if enough else 1]
    scaled = used / np.abs(used).max(axis=0) * weight[:, None]
    return float(np.linalg.lstsq(scaled, deviation[near] * weight, rcond=1e-9)[0][0])


def _file(one: Laid, lattice: Lattice | None, member: Member) -> tuple[FlankFile, list[str]]:
    """The file of one part without its header, and how it came by its grid."""
    part, angle = one.part, 2 * math.pi * one.part.tooth / member.teeth
    found: list[str] = []
    if lattice is None:
        row, col, foot, normal, deviation, found = _on_grid(one, member)
    else:
        order = np.lexsort((lattice.col, lattice.row))
        row, col = lattice.row[order], lattice.col[order]
        foot, normal, deviation = one.foot[order], one.normal[order], one.deviation[order]
    point = turned(foot + deviation[:, None] * normal, angle)
    return flank_file({}, member.name, part.flank, part.tooth, row, col, point, turned(normal, angle), deviation), found


def _on_grid(one: Laid, member: Member) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, list[str]]:
    """Rows, columns, feet, normals and deviations on a grid of even margins, between the points of a part."""
    across, up = fractions(one, member)
    off = standing_out(one, member)[one.kept] != 0.0
    for margin in _MARGINS:
        place = np.stack(np.meshgrid(np.linspace(margin, 1 - margin, _COLUMNS), np.linspace(margin, 1 - margin, _ROWS)))
        place = place.reshape(2, -1).T
        step = (1 - 2 * margin) / np.array([_COLUMNS - 1, _ROWS - 1])
        away = (np.stack([across[~off], up[~off]], axis=1)[None] - place[:, None]) / step
        if (np.linalg.norm(away, axis=2).min(axis=1) <= _NEAR_STEPS).all():
            break
    else:
        raise InputError(
            f"{one.part.name}: its {len(across)} points form no grid, and cover too little of the {one.part.flank} "
            f"flank for one of {_ROWS}x{_COLUMNS} between them"
        )
    nominal = solve_flank(member, one.part.flank, blank_grid(member, _ROWS, _COLUMNS, margin))
    deviation = np.array([_smooth(across[~off], up[~off], one.deviation[~off], each) for each in place])
    row, col = (each.ravel() for each in np.indices((_ROWS, _COLUMNS)))
    words = f"{len(across)} points form no grid that all share: deviations on {_ROWS}x{_COLUMNS}, margins {margin:g}"
    lost = [f"{counted(int(off.sum()), 'point')} left out, off the others"] if off.any() else []
    return row, col, nominal.point, nominal.normal, deviation, [words, *lost]


def _header(member: Member, files: Sequence[FlankFile], frame: Frame, zeroed: bool) -> dict[str, str]:
    rows, columns = (int(max(getattr(file, index).max() for file in files)) + 1 for index in ("row", "col"))
    return flank_header(member, (rows, columns)) | {
        "margins": _margins(member, files, rows, columns),
        "phase_zeroed": "true" if zeroed else "false",
        "tip_radius_mm": f"{frame.tip_radius:g}",
        PLANNED: f"{sum(map(len, files))} points",
    }


def _margins(member: Member, files: Sequence[FlankFile], rows: int, columns: int) -> str:
    """The even margins of the grid where the points have them, or that each has its own place."""
    margin = None
    for file in files:
        angle = 2 * math.pi * file.tooth[0] / member.teeth
        foot = turned(file.point - file.deviation[:, None] * file.normal, -angle)
        across, _ = blank_fractions(member, foot[:, 2], np.hypot(foot[:, 0], foot[:, 1]))
        if margin is None:
            margin = round(float((across.min() + 1 - across.max()) / 2), _DIGITS)
        if not 0 <= margin < 0.5:
            return OWN
        nominal = solve_flank(member, str(file.flank[0]), blank_grid(member, rows, columns, margin))
        apart = np.linalg.norm(nominal.point[file.row * columns + file.col] - foot, axis=1)
        if apart.max() > _EVEN:
            return OWN
    return f"{margin:g},{margin:g}"

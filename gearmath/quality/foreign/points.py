"""Points of another measuring machine laid onto the nominal flank: how far they are turned, and how far they lie off.

Such a file knows the axis of the work, and perhaps where the apex is, but its rotation about the axis is its own. A
place (z_w, radius) does not change when the work turns, so that each point says by itself how far it is turned from the
nominal flank, and the median of all is not moved by single bad points. The deviation is the distance along the normal
at the foot of the point: point - deviation · normal lies on the surface, to 1e-10 mm.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import product
from typing import Literal

import numpy as np

from gearmath.bevel.flank import Grid, nominal_points
from gearmath.bevel.grid import blank_fractions
from gearmath.bevel.newton import TOLERANCE
from gearmath.bevel.turning import half_turn, turned
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, BevelSet, Member
from gearmath.specs.ratio import INCH

Phase = Literal["common", "each", "kept"]
AXES = ("+x", "-x", "+y", "-y", "+z", "-z")
#: Part of the points that must lie on the flank.
LEAST_FIT = 0.8
#: A point is of the flank within this part of the depth of the tooth. On the blank it may lie these parts of face width
#: and depth beyond toe or heel, the tip, and the lowest point of contact.
_NEAR, _BESIDE, _ABOVE, _BELOW = 0.05, 0.05, 0.1, 0.35
#: The foot of a point: steps, and how still it must stand. [mm]
_STEPS, _STILL = 30, 1e-10
#: Newton steps to the turning at which the median deviation is zero.
_TURNING_STEPS = 20
#: Normals of a file agree with those of the flank within this. [rad]
_NORMAL_WITHIN = math.radians(15)
#: Another apex offset is worth a word where it takes the median deviation from this [mm] to this part of it, and is
#: demanded where that is larger than the form of a flank is [mm].
_WORTH_A_HINT, _MUCH_LESS, LARGEST_FORM = 0.02, 5.0, 0.1
_AXIAL_STEPS = 6
#: Flanks further apart than this part of a pitch are of different teeth.
SAME_TOOTH = 0.25
#: Apex offsets that are tried over two face widths.
_TRIED = 81


@dataclass(frozen=True)
class Frame:
    """How the axes of a file stand: the direction of the work axis, apex to back, its origin along it, the probe tip.

    ``apex_offset`` is where the origin lies, from the pitch apex towards the back [mm]; ``tip_radius`` [mm] is not zero
    where the points are centers of the probe tip.
    """

    axis: str = "+z"
    apex_offset: float = 0.0
    tip_radius: float = 0.0

    def in_work(self, vector: np.ndarray) -> np.ndarray:
        """Directions (n,3) in frame w, but for a rotation about z_w."""
        k = "xyz".index(self.axis[1])
        cyclic = np.roll(vector, 2 - k, axis=1)  # no mirror image: x y z in their order
        return cyclic * ([1, -1, -1] if self.axis[0] == "-" else [1, 1, 1])

    def placed(self, point: np.ndarray) -> np.ndarray:
        """Points (n,3) in frame w, but for a rotation about z_w."""
        return self.in_work(point) + np.array([0.0, 0.0, self.apex_offset])


@dataclass(frozen=True)
class PointPart:
    """One flank of one tooth in a file: points (n,3) [mm] and normals (n,3) or None, in the axes of the file.

    ``line`` (n,) are the lines of the file in which they stand, None where there is no file.
    """

    name: str
    flank: str
    tooth: int
    point: np.ndarray
    normal: np.ndarray | None = None
    line: np.ndarray | None = None


@dataclass(frozen=True)
class Laid:
    """Points of a part on the nominal flank of tooth 0: feet and normals (n,3), deviations (n,) [mm].

    ``kept`` are the rows of the part that have a foot. ``lever`` (n,) is the change of the deviation with the rotation
    of the work [mm per rad].
    """

    part: PointPart
    kept: np.ndarray
    foot: np.ndarray
    normal: np.ndarray
    deviation: np.ndarray

    @property
    def lever(self) -> np.ndarray:
        return lever(self.foot, self.normal)


def lever(point: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Change (n,) of the distance along the normal as points (n,3) are turned about z_w [mm per rad]."""
    return point[:, 0] * normal[:, 1] - point[:, 1] * normal[:, 0]


def turn_of(part: PointPart, frame: Frame, gear_set: BevelSet, name: str) -> float:
    """Angle [rad], within half a turn, by which a part is turned against the nominal flank of its tooth.

    Raises InputError, with what would make most of the points fit, where they are not of the flank.
    """
    member = gear_set.member(name)
    turn, fits = _turn(member, part.flank, frame.placed(part.point), frame.tip_radius)
    if fits.mean() < LEAST_FIT:
        raise InputError(
            f"{part.name}: {int(fits.sum())} of {len(fits)} points lie within {_near(member):.2f} mm of the {name}'s "
            f"{part.flank} flank, however it is turned; {_likeliest_cause(part, frame, gear_set, name)}"
        )
    return half_turn(turn - 2 * math.pi * part.tooth / member.teeth)


def lay(part: PointPart, frame: Frame, member: Member, turn: float) -> Laid:
    """The feet of the points of a part that is turned by ``turn`` [rad], in the frame of the nominal flank of tooth 0.

    Points without a foot, far off the flank or beyond its edge, are left out.
    """
    point = turned(frame.placed(part.point), -turn - 2 * math.pi * part.tooth / member.teeth)
    foot, normal, there = point.copy(), np.zeros_like(point), np.ones(len(point), dtype=bool)
    moved = np.full(len(point), np.inf)
    for _ in range(_STEPS):
        surface, normal, there = _nominal(member, part.flank, foot)
        distance = np.sum((point - surface) * normal, axis=1)
        next_foot = point - distance[:, None] * normal
        moved = np.where(there, np.linalg.norm(next_foot - foot, axis=1), np.inf)
        foot = np.where(there[:, None], next_foot, foot)
        if (moved[there] <= _STILL).all():
            break
    kept = np.flatnonzero(there & (moved <= _STILL))
    distance = np.sum((point - foot) * normal, axis=1) - frame.tip_radius
    return Laid(part, kept, foot[kept], normal[kept], distance[kept])


def check_normals(laid: Laid, frame: Frame, member: Member, turn: float) -> str:
    """Which way the normals of a part point. Raises InputError where they are not those of the flank."""
    part = laid.part
    if part.normal is None:
        return ""
    given = turned(frame.in_work(part.normal[laid.kept]), -turn - 2 * math.pi * part.tooth / member.teeth)
    along = np.sum(given * laid.normal, axis=1)
    sign = 1 if np.median(along) > 0 else -1
    agree = sign * along > math.cos(_NORMAL_WITHIN)
    if agree.mean() < LEAST_FIT:
        raise InputError(
            f"{part.name}: {int(agree.sum())} of {len(agree)} normals lie within {math.degrees(_NORMAL_WITHIN):.0f} "
            f"degrees of those of the {part.flank} flank, out of the metal or all into it: are they i j k of the same "
            "axes?"
        )
    others = int((~agree).sum())
    return f"normals point {'out of' if sign > 0 else 'into'} the metal" + (
        f"; {others} of {len(agree)} are not those of the flank" if others else ""
    )


def axial_hint(part: PointPart, frame: Frame, member: Member, turn: float) -> str:
    """What another apex offset would do, in words; empty where it would not lessen the deviations much.

    Raises InputError where deviations are larger than those of a flank, and another apex offset explains them.
    """
    offset, before, after = _axial_fit(part, frame, member, turn)
    moved = abs(offset - frame.apex_offset)
    if not (before > _WORTH_A_HINT and after < before / _MUCH_LESS and moved < member.blank.face_width):
        return ""
    words = (
        f"{part.name}: half of the points lie more than {before * 1000:.1f} um off the {part.flank} flank, with "
        f"--apex-offset {_plain(offset)} more than {after * 1000:.1f} um"
    )
    if before > LARGEST_FORM:
        raise InputError(f"{words}: where does the origin of the file lie on the axis?")
    return f"{words}; if the offset given is right, the member was cut or clamped so far off"


def _axial_fit(part: PointPart, frame: Frame, member: Member, turn: float) -> tuple[float, float, float]:
    """The apex offset at which the points fit best, and the median of their distances before and after [mm]."""
    tried, angle, medians = frame, turn, []
    for _ in range(_AXIAL_STEPS):
        laid = lay(part, tried, member, angle)
        arm, off = laid.lever, laid.deviation
        columns, weight = np.stack([arm, laid.normal[:, 2]], axis=1), np.ones(len(off))
        for _ in range(_AXIAL_STEPS):  # least absolute values: single bad points do not count
            change = np.linalg.lstsq(columns * weight[:, None], off * weight, rcond=None)[0]
            left = np.abs(off - columns @ change)
            weight = 1 / np.sqrt(np.maximum(left, 1e-6))
        medians += [float(np.median(np.abs(off - np.median(off / arm) * arm))), float(np.median(left))]
        tried = replace(tried, apex_offset=tried.apex_offset - float(change[1]))
        angle += float(change[0])
    return tried.apex_offset, medians[0], medians[-1]


def _plain(offset: float) -> str:
    return f"{round(offset, 1) + 0.0:.1f}"


def _nominal(member: Member, flank: str, point: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nominal points and normals (n,3) at the places of points (n,3), and whether there is one on the blank (n,)."""
    axial, radial = point[:, 2], np.hypot(point[:, 0], point[:, 1])
    across, up = blank_fractions(member, axial, radial)
    there = (np.abs(across - 0.5) < 0.5 + _BESIDE) & (up > -_BELOW) & (up < 1 + _ABOVE) & (radial > 0)
    surface, normal = np.zeros_like(point), np.zeros_like(point)
    if there.any():
        found, residual = nominal_points(member, flank, Grid(axial[None, there], radial[None, there]))
        surface[there], normal[there] = found.point, found.normal
        there[there] = residual <= TOLERANCE
    return surface, normal, there


def _turn(member: Member, flank: str, point: np.ndarray, tip_radius: float) -> tuple[float, np.ndarray]:
    """The rotation [rad] at which the median distance is the radius of the tip, and which points (n,) fit then."""
    surface, normal, there = _nominal(member, flank, point)
    fits = np.zeros(len(point), dtype=bool)
    if not there.any():
        return 0.0, fits
    p, s, n = point[there], surface[there], normal[there]
    each = np.arctan2(p[:, 1], p[:, 0]) - np.arctan2(s[:, 1], s[:, 0])
    start = math.atan2(np.median(np.sin(each)), np.median(np.cos(each)))
    turn = start + float(np.median(half_turn(each - start)))
    arm = lever(s, n)
    for _ in range(_TURNING_STEPS):
        off = np.sum((turned(p, -turn) - s) * n, axis=1) - tip_radius
        step = float(np.median(off / arm))
        turn += step
        if abs(step) < 1e-12:
            break
    off = np.sum((turned(p, -turn) - s) * n, axis=1) - tip_radius
    fits[there] = np.abs(off) < _near(member)
    return turn, fits


def _near(member: Member) -> float:
    return _NEAR * (member.blank.mean_addendum + member.blank.mean_dedendum)


def _likeliest_cause(part: PointPart, frame: Frame, gear_set: BevelSet, name: str) -> str:
    """What would make most of the points fit: the fewest other options."""
    other_flank, others = FLANKS[1 - FLANKS.index(part.flank)], [each for each in gear_set.members if each != name]
    mirror = np.array([-1, 1, 1]) if frame.axis[1] != "x" else np.array([1, -1, 1])
    choices: list[list[tuple[str, object]]] = [
        [("", part.flank), (f"--flank {other_flank}", other_flank)],
        [("", 1.0), ("--unit inch", INCH), ("--unit mm", 1 / INCH), ("lengths times 1000: the file is in m", 1000.0)],
        [("", frame.axis), *((f"--axis {axis}", axis) for axis in AXES if axis != frame.axis)],
        [("", name), *((f"--member {other}", other) for other in others)],
        [("", 1), ("the mirror image: the file is of the other hand, or two of its columns are exchanged", mirror)],
    ]

    def fit(flank: str, scale: float, axis: str, which: str, hand: np.ndarray) -> float:
        tried = replace(frame, axis=axis)
        point = tried.placed(part.point * scale * hand)
        return float(_turn(gear_set.member(which), flank, point, frame.tip_radius)[1].mean())

    ways = sorted(product(*choices), key=lambda way: sum(bool(words) for words, _ in way))
    for way in ways[1:]:
        words = [each for each, _ in way if each]
        if len(words) > 2:
            break
        if fit(*(value for _, value in way)) >= LEAST_FIT:  # type: ignore[arg-type]
            return f"most would fit with {' and '.join(words)}"
    halves = np.array_split(frame.placed(part.point), 2)
    for flanks in (FLANKS, FLANKS[::-1]):
        shares = [
            _turn(gear_set.member(name), flank, half, frame.tip_radius)[1].mean()
            for flank, half in zip(flanks, halves, strict=True)
        ]
        if min(shares) >= LEAST_FIT:
            return "it holds the points of both flanks: give each flank a file of its own"
    offset = _likely_offset(part, frame, gear_set.member(name))
    if offset is not None:
        return f"most would fit with --apex-offset {_plain(offset)}"
    return "is the file of this set, member and flank, and are --unit, --axis and --apex-offset those of the file?"


def _likely_offset(part: PointPart, frame: Frame, member: Member) -> float | None:
    """The apex offset [mm] at which the points lie on the blank and fit the flank best, None where they fit nowhere."""
    height = member.blank.mean_cone_distance * math.cos(member.blank.delta)
    point = replace(frame, apex_offset=0.0).placed(part.point)
    reach = member.blank.face_width
    start = height - float(np.median(point[:, 2]))

    tried = start + np.linspace(-reach, reach, _TRIED)
    turns = [_turn(member, part.flank, point + np.array([0.0, 0.0, each]), frame.tip_radius) for each in tried]
    share = np.array([fits.mean() for _, fits in turns])
    if share.max() < LEAST_FIT:
        return None
    best = np.flatnonzero(share == share.max())
    middle = int(best[len(best) // 2])
    turn = turns[middle][0] - 2 * math.pi * part.tooth / member.teeth
    return _axial_fit(part, replace(frame, apex_offset=float(tried[middle])), member, turn)[0]

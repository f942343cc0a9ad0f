"""Whether touches lie on the lines along which their program searches: a wrong work offset or tool length shows there.

A program searches every point along the normal of the nominal flank, from clear of it to beyond it, with A and B
standing still. Wherever the metal is, the touch lies on that line: what deviates from it is not of the work. Where all
touches deviate alike, it is the place of the work or of the probe, as set-up or machine file have it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from gearmath.bevel.flank import Grid
from gearmath.errors import InputError
from gearmath.machine.planning.targets import targets_of_space
from gearmath.quality.evaluation.file_checks import SAME_POINT, WRONG_SET_UP
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.calibration import Calibration
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.touch_csv import Touches

#: A touch may lie this far beside its line, and before its begin or beyond its end: the tip may have been calibrated
#: anew since the program was written. [mm]
BESIDE = 0.2
#: The same for A and B. [rad]
_TURNED = math.radians(0.05)
#: A or B off alike by more than this are worth a word: a control rounds to less. [rad]
_TURNED_WORD = math.radians(0.002)
#: All touches beside their lines alike by more than this are worth a word: a control rounds each to less. [mm]
_WORTH_A_WORD = 0.004
#: Touches are off alike where so much of them is, and so many of them are there.
_MOST, _LEAST_TOUCHES = 0.8, 4
#: A component of less than this part of the whole is not named.
_NAMED = 0.1
_FITS, _SMALL = 30, 1e-6


def check_search_lines(
    touches: Touches, member: Member, grid: Grid, machine: MillingMachine, calibration: Calibration
) -> str:
    """What to say of touches that lie beside their lines all alike, but not far; or nothing.

    Raises InputError where they are far off alike, with the offset, or where a single one is.
    """
    touches = touches.pick(touches.triggered)
    start, end = _lines(touches, member, grid, machine, calibration)
    turned = touches.axes[:, 3:] - start[:, 3:]
    turned -= 2 * math.pi * np.round(turned / (2 * math.pi))
    said = _check_turned(touches, turned)
    way = end[:, :3] - start[:, :3]
    length = np.linalg.norm(way, axis=1)
    along = way / length[:, None]
    off = touches.axes[:, :3] - start[:, :3]
    run = np.sum(off * along, axis=1)
    beside = off - run[:, None] * along
    common = _common(along, beside)
    explained = np.linalg.norm(beside - _beside(along, common), axis=1) <= BESIDE
    distance = np.hypot(np.linalg.norm(beside, axis=1), np.maximum(0.0, np.maximum(-run, run - length)))
    alike = len(touches) >= _LEAST_TOUCHES and explained.mean() >= _MOST
    size = np.linalg.norm(_beside(along, common), axis=1).max()
    if alike and size > BESIDE:
        where = f"{_who(explained)} lie {_words(common)} from the planned lines"
        raise InputError(f"{where}, the limit is {BESIDE} mm: {_causes(common)}")
    if (distance > BESIDE).any():
        k = int(np.argmax(distance > BESIDE))
        raise InputError(
            f"{touches.name_of(k)}: the touch lies {distance[k]:.3f} mm from the line along which it was searched, "
            f"the limit is {BESIDE} mm"
        )
    if alike and size > _WORTH_A_WORD:
        # of an offset this small, those that have more than half of it
        has_it = np.linalg.norm(beside - _beside(along, common), axis=1) <= np.linalg.norm(beside, axis=1)
        felt = np.linalg.norm(_beside(along, common), axis=1) > size / 2
        are = has_it | ~felt
        said = f"{_who(are)} lie {_words(common)} from the planned lines{_since(are)}: {_causes(common)}"
        said += f"; evaluate takes points up to {SAME_POINT} mm beside their normals only" if size > SAME_POINT else ""
    return said


def _lines(
    touches: Touches, member: Member, grid: Grid, machine: MillingMachine, calibration: Calibration
) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n,5) at which the search for each touch begins and ends, A as in the space of its tooth."""
    start, end = np.empty((2, len(touches), 5))
    place = touches.row * grid.shape[1] + touches.col
    for flank in (flank for flank in FLANKS if (touches.flank == flank).any()):
        here = touches.flank == flank
        planned = targets_of_space(member, flank, grid, machine, calibration)
        start[here], end[here] = planned.start[place[here]], planned.end[place[here]]
    turn = 2 * math.pi * touches.tooth / member.teeth
    start[:, 3] += turn
    end[:, 3] += turn
    return start, end


def _check_turned(touches: Touches, turned: np.ndarray) -> str:
    """What to say of A or B that stand beside the plan all alike, by little; or nothing.

    Raises InputError where they are far off alike, or one touch is.
    """
    said = ""
    for axis, off in zip("AB", turned.T, strict=True):
        middle = float(np.median(off))
        alike = np.abs(off - middle) <= _TURNED
        by = f"stand {math.degrees(middle):+.4f} degrees in {axis} from the planned positions"
        cause = "a work offset, or another set or --machine than that of the program"
        if abs(middle) > _TURNED and len(off) >= _LEAST_TOUCHES and alike.mean() >= _MOST:
            raise InputError(f"{_who(alike)} {by}, the limit is {math.degrees(_TURNED):.2f} degrees: {cause}")
        if not (far := np.abs(off) > _TURNED).any():
            if abs(middle) > _TURNED_WORD and len(off) >= _LEAST_TOUCHES:
                are = np.abs(off - middle) <= np.abs(off)
                said = f"{_who(are)} {by}{_since(are)}: {cause}"
            continue
        k = int(np.argmax(far))
        raise InputError(
            f"{touches.name_of(k)}: {axis} stands {math.degrees(off[k]):+.4f} degrees from where the program searches, "
            f"the limit is {math.degrees(_TURNED):.2f} degrees"
        )
    return said


def _who(are: np.ndarray) -> str:
    """All touches, or how many of them (n,)."""
    return "all touches" if are.all() else f"{int(are.sum())} of {len(are)} touches"


def _since(are: np.ndarray) -> str:
    """That not all touches (n,) are so; it has changed while they were made."""
    return "" if are.all() else ", the others do not, so it changed while they were measured"


def _beside(along: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Components (n,3) of a vector square to directions (n,3)."""
    return vector - (along @ vector)[:, None] * along


def _common(along: np.ndarray, beside: np.ndarray) -> np.ndarray:
    """The offset (3,) that leaves the least of all distances from the lines: single wrong touches do not count."""
    projectors = np.eye(3) - along[:, :, None] * along[:, None, :]
    weight = np.ones(len(along))
    for _ in range(_FITS):
        left_side = np.einsum("n,nij->ij", weight, projectors)
        found = np.linalg.lstsq(left_side, weight @ beside, rcond=1e-9)[0]
        weight = 1 / np.maximum(np.linalg.norm(beside - _beside(along, found), axis=1), _SMALL)
    return np.asarray(found)


def _named(offset: np.ndarray) -> Iterator[tuple[str, float]]:
    size = float(np.linalg.norm(offset))
    return ((axis, float(value)) for axis, value in zip("XYZ", offset, strict=True) if abs(value) >= _NAMED * size)


def _words(offset: np.ndarray) -> str:
    return " and ".join(f"{value:+.3f} mm in {axis}" for axis, value in _named(offset))


def _causes(offset: np.ndarray) -> str:
    if any(axis == "Z" for axis, _ in _named(offset)):
        return WRONG_SET_UP
    return WRONG_SET_UP.replace(" or tool length", "")

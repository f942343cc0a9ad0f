"""What is wrong with single points of another measuring machine, and what its files do not have, in sentences."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from gearmath.bevel.grid import blank_fractions
from gearmath.errors import InputError, counted
from gearmath.quality.evaluation.outliers import flag_outliers, noticed
from gearmath.quality.foreign.lattice import Lattice, find_lattice
from gearmath.quality.foreign.points import LARGEST_FORM, Laid, PointPart
from gearmath.specs.bevel_set import Member

#: A file whose points cover less than this part of face width or depth may have been cut off.
_LEAST_COVERED = 0.6
#: So many points tell whether places were measured twice.
_LEAST_TO_COMPARE = 30
#: Points are at one place within this part of the mean step from point to point; of more points nobody made two grids.
_SAME_PLACE, _MOST_TO_COMPARE = 0.05, 2000


def fractions(one: Laid, member: Member) -> tuple[np.ndarray, np.ndarray]:
    """Parts of face width and working depth (n,) at the feet of the points."""
    return blank_fractions(member, one.foot[:, 2], np.hypot(one.foot[:, 0], one.foot[:, 1]))


def standing_out(one: Laid, member: Member) -> np.ndarray:
    """How far the points (n,) of a part stand out from a smooth surface through the others [mm].

    Zero where they do not, and where many do: those are no single bad points, and the evaluation says so.
    """
    across, up = fractions(one, member)
    found = np.zeros(len(one.part.point))
    with suppress(InputError):
        flags, off = flag_outliers(across - across.mean(), up - up.mean(), one.deviation)
        found[one.kept[flags]] = off[flags]
    return found


def noticeable(one: Laid, lattice: Lattice, member: Member) -> np.ndarray:
    """How far points (n,) of a grid are off the surface of fourth degree through the others, by their noise [mm].

    They are said, and kept: less than a form is never left out.
    """
    found = np.zeros(len(one.part.point))
    across, up = (2 * part - 1 for part in fractions(one, member))
    found[one.kept] = noticed(across, up, one.deviation, lattice.row, lattice.col)
    return found


def only(one: Laid, keep: np.ndarray) -> Laid:
    """The points of a part for which ``keep`` (points of the part,) is true."""
    here = keep[one.kept]
    return replace(
        one, kept=one.kept[here], foot=one.foot[here], normal=one.normal[here], deviation=one.deviation[here]
    )


def outlier_words(one: Laid, off: np.ndarray) -> tuple[list[str], list[str]]:
    """Sentences on the points that stand out by ``off`` (n,) [mm]: farther than a form does, or less."""
    far: list[str] = []
    near: list[str] = []
    for k in np.flatnonzero(off):
        words = f"{_row(one.part, int(k))}: the point is {abs(off[k]) * 1000:.1f} um off the surface through the others"
        (far if abs(off[k]) > LARGEST_FORM else near).append(words)
    return far, near


def lost_words(one: Laid) -> Iterator[str]:
    """What to say of points that have no foot on the flank."""
    lost = np.setdiff1d(np.arange(len(one.part.point)), one.kept)
    if len(lost):
        lines = "" if one.part.line is None else f" (first of them line {one.part.line[lost[0]]})"
        yield f"{one.part.name}: {counted(len(lost), 'point')} beyond the flank or far off it{lines}, left out"


def gap_words(one: Laid, lattice: Lattice | None, member: Member) -> Iterator[str]:
    """What to say of points that leave places of their grid empty, or much of the flank: the file may not be whole."""
    if lattice is not None and (empty := lattice.rows * lattice.columns - len(lattice.row)):
        there = set(zip(lattice.row.tolist(), lattice.col.tolist(), strict=True))
        row, col = next(place for place in np.ndindex(lattice.rows, lattice.columns) if place not in there)
        yield (
            f"{one.part.name}: its {len(lattice.row)} points leave {empty} of {lattice.rows}x{lattice.columns} places "
            f"of the grid empty, the first of them row {row}, col {col}: is the file whole?"
        )
    for part, what in zip(fractions(one, member), ("face width", "working depth"), strict=True):
        if np.ptp(part) < _LEAST_COVERED:
            low, high = 100 * part.min(), 100 * part.max()
            where = f"from {low:.0f} to {high:.0f} % only"
            yield f"{one.part.name}: its points cover the {what} {where}: is the file whole?"


def unlike_words(laid: Sequence[Laid], member: Member) -> Iterator[str]:
    """What to say of parts whose points form grids, but not of one size: one of them may not be whole."""
    found = {one.part.name: find_lattice(*fractions(one, member)) for one in laid}
    sizes = {name: f"{grid.rows}x{grid.columns}" for name, grid in found.items() if grid is not None}
    if len(set(sizes.values())) > 1:
        (first, size), *others = sizes.items()
        other, unlike = next(each for each in others if each[1] != size)
        yield f"{first} holds a grid of {size}, {other} one of {unlike}: are both whole?"


def repeated_words(one: Laid, member: Member) -> Iterator[str]:
    """What to say of points half of which and more have another one at their place: two runs in one file."""
    n = len(one.kept)
    if not _LEAST_TO_COMPARE <= n <= _MOST_TO_COMPARE:
        return
    place = np.stack(fractions(one, member), axis=1)
    apart = np.linalg.norm(place[:, None] - place, axis=2) + np.diag(np.full(n, np.inf))
    nearest = np.argmin(apart, axis=1)
    mine = np.arange(n)
    pairs = (nearest[nearest] == mine) & (apart[mine, nearest] < _SAME_PLACE / np.sqrt(n)) & (mine < nearest)
    if 2 * pairs.sum() < n / 2:
        return
    off = (one.deviation[nearest] - one.deviation)[pairs] * 1000
    yield (
        f"{one.part.name}: {int(pairs.sum())} places were measured twice, the later points {off.mean():+.1f} um off "
        f"the earlier ones on average, {np.abs(off).max():.1f} um at most: two runs in one file?"
    )


def _row(part: PointPart, k: int) -> str:
    return f"{part.name}, " + (f"point {k + 1}" if part.line is None else f"line {part.line[k]}")

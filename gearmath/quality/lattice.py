"""Rows and columns of points whose order is not known: a grid found again in their places on the flank."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

#: Columns may lean by so much of the face width over the working depth; tried from upright on.
_SLANTS = sorted(np.linspace(-0.4, 0.4, 81), key=abs)
#: The least gap between two columns against the largest within one.
_CLEAR = 2.5
#: Gaps below this part of the whole are none.
_NO_GAP = 1e-4
#: Part of the grid that must be there, and how far from even lines its points may lie, in steps of the grid.
_LEAST_FULL, _EVEN = 0.8, 0.2


@dataclass(frozen=True)
class Lattice:
    """Row, root to tip, and column, toe to heel, of n points, and how many there are of each."""

    rows: int
    columns: int
    row: np.ndarray
    col: np.ndarray


def find_lattice(across: np.ndarray, up: np.ndarray) -> Lattice | None:
    """The grid that points at places (n,) form, as parts of face width and depth; None where they form none.

    Columns may lean and rows may run askew, and a fifth of the points may be missing. At least two rows and columns.
    """
    for first, second, swapped in ((across, up, False), (up, across, True)):
        for lines in _lines(first, second):
            rank = _ranks(lines, second)
            if rank is None:
                continue
            row, col = (lines, rank) if swapped else (rank, lines)
            rows, columns = int(row.max()) + 1, int(col.max()) + 1
            full = len(across) >= _LEAST_FULL * rows * columns
            if full and _even(across, col, row) and _even(up, row, col):
                return Lattice(rows, columns, row, col)
    return None


def _lines(first: np.ndarray, second: np.ndarray) -> Iterator[np.ndarray]:
    """Ways to part points (n,) into lines of nearly equal ``first``, upright ones before those that lean."""
    for slant in _SLANTS:
        leaning = first + slant * second
        order = np.argsort(leaning)
        gaps = np.diff(leaning[order])
        sizes = np.sort(np.maximum(gaps, _NO_GAP * np.ptp(leaning)))[::-1]
        if len(sizes) < 2:
            return
        ratio = sizes[:-1] / np.maximum(sizes[1:], 1e-300)
        cut = int(np.argmax(ratio))
        if ratio[cut] < _CLEAR:
            continue
        label = np.empty(len(first), dtype=int)
        label[order] = np.concatenate([[0], np.cumsum(gaps > np.sqrt(sizes[cut] * sizes[cut + 1]))])
        yield label


def _ranks(lines: np.ndarray, second: np.ndarray) -> np.ndarray | None:
    """The place of every point in its line, counted from the lowest; None where lines do not agree on the places."""
    counts = np.bincount(lines)
    most = int(counts.max())
    full = np.flatnonzero(counts == most)
    if most < 2 or len(full) < 2 or 2 * len(full) < len(counts):
        return None
    rank = np.empty(len(lines), dtype=int)
    levels = np.empty((len(full), most))
    for k, line in enumerate(full):
        here = np.flatnonzero(lines == line)
        rank[here] = np.argsort(np.argsort(second[here]))
        levels[k] = np.sort(second[here])
    terms = np.vander(np.arange(len(counts)), min(3, len(full)))
    expected = terms @ np.linalg.lstsq(terms[full], levels, rcond=None)[0]
    for line in np.flatnonzero(counts < most):
        here = np.flatnonzero(lines == line)
        rank[here] = np.argmin(np.abs(second[here][:, None] - expected[line]), axis=1)
        if len(np.unique(rank[here])) < len(here):
            return None
    return rank


def _even(place: np.ndarray, line: np.ndarray, along: np.ndarray) -> bool:
    """Whether points (n,) of a line share one place, but for lines that lean and bow together."""
    count = int(line.max()) + 1
    middle = along - along.mean()
    base = (line[:, None] == np.arange(count)).astype(float)
    terms = np.column_stack([base, middle, middle * line, middle**2, middle**2 * line])
    fitted = terms @ np.linalg.lstsq(terms, place, rcond=None)[0]
    step = np.ptp(fitted) / max(count - 1, 1)
    return bool(np.sqrt(np.mean((place - fitted) ** 2)) < _EVEN * step)

"""Rows and columns of points whose order is not known: a grid found again in their places on the flank."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

#: Columns may lean by so much of the face width over the working depth.
_SLANTS = np.linspace(-0.4, 0.4, 81)
#: The least gap between two columns against the largest within one.
_CLEAR = 2.5
#: Gaps below this part of the whole are none.
_NO_GAP = 1e-4
#: Part of the grid that may be missing, and how far from even lines its points may lie, in steps of the grid.
_MOST_MISSING, _EVEN = 0.2, 0.15
#: More points than this are a scan.
_MOST = 2000


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
    found: list[tuple[float, float, Lattice]] = []
    ways = ((across, up, False), (up, across, True)) if len(across) <= _MOST else ()
    for first, second, swapped in ways:
        for lines in _lines(first, second):
            rank = _ranks(lines, second)
            if rank is None:
                continue
            row, col = (lines, rank) if swapped else (rank, lines)
            rows, columns = int(row.max()) + 1, int(col.max()) + 1
            missing = 1 - len(across) / (rows * columns)
            off = max(_off_even(across, col, row), _off_even(up, row, col))
            if missing <= _MOST_MISSING and off < _EVEN:
                found.append((missing, off, Lattice(rows, columns, row, col)))
    return min(found, key=lambda one: one[:2])[2] if found else None


def _lines(first: np.ndarray, second: np.ndarray) -> Iterator[np.ndarray]:
    """Ways to part points (n,) into lines of nearly equal ``first``, upright or leaning, each of them once."""
    seen = set()
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
        if label.tobytes() not in seen:
            seen.add(label.tobytes())
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


def _off_even(place: np.ndarray, line: np.ndarray, along: np.ndarray) -> float:
    """How far the points (n,) of a line are from one place, but for lines that lean, fan out and bow, in steps."""
    count = int(line.max()) + 1
    middle = along - along.mean()
    base = (line[:, None] == np.arange(count)).astype(float)
    terms = np.column_stack([base, middle, middle * line, middle**2])
    solution, _, rank, _ = np.linalg.lstsq(terms, place, rcond=None)
    spare = len(place) - int(rank)
    step = np.ptp(solution[:count]) / (count - 1)
    if spare < 1 or step <= 0:
        return np.inf
    return float(np.linalg.norm(place - terms @ solution) / np.sqrt(spare) / step)

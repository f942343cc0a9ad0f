"""Neighboring teeth that are indexed wrong by the same arc.

Where they are many, a quarter of all teeth, they shift mean and first harmonic, and none of them shows as an outlier.
So a step over each run of neighbors is fitted together with mean and harmonic; no tooth is left out.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gearmath.kernels import kernel
from gearmath.quality.evaluation.robust import SIGMAS
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import FlankFile

#: Teeth that mean, harmonic and step need, with some to spare.
_LEAST_TEETH = 8
#: Of an indexing error, what is opposite on the two flanks is less than this part of what is common.
_COMMON = 0.5
#: Up to so many teeth are named one by one.
_LISTED = 4


def indexed_together(file: FlankFile, teeth: int, least: float) -> tuple[tuple[int, ...], float] | None:
    """The run of neighbors that is turned against the other teeth on both flanks alike, and the arc [mm].

    None where no run of two teeth or more, and at most half of them, is off by ``least`` and by far more than what mean
    and first harmonic leave of the others.
    """
    arcs = [_arcs(file, flank, teeth) for flank in FLANKS]
    if not all(np.isfinite(arc).all() for arc in arcs) or teeth < _LEAST_TEETH:
        return None
    common, opposite = (arcs[0] + arcs[1]) / 2, (arcs[0] - arcs[1]) / 2
    turn = 2 * np.pi * np.arange(teeth) / teeth
    basis = np.linalg.qr(np.stack([np.ones(teeth), np.cos(turn), np.sin(turn)], axis=1))[0]
    runs = list(_runs(teeth))
    steps = np.array([np.isin(np.arange(teeth), run) for run in runs], dtype=float)
    apart = steps - steps @ basis @ basis.T
    left = common - basis @ (basis.T @ common)
    size = (apart @ left) / np.sum(apart**2, axis=1)
    rest = np.sum(left**2) - size**2 * np.sum(apart**2, axis=1)
    best = int(np.argmin(rest))
    noise = float(np.sqrt(max(rest[best], 0.0) / (teeth - 4)))
    other = float(apart[best] @ (opposite - basis @ (basis.T @ opposite)) / np.sum(apart[best] ** 2))
    step = float(size[best])
    if abs(step) < max(least, SIGMAS * noise) or abs(other) > _COMMON * abs(step):
        return None
    return runs[best], step


def in_words(run: tuple[int, ...], step: float) -> str:
    """What is said of such a run."""
    names = ", ".join(map(str, run)) if len(run) <= _LISTED else f"{run[0]} to {run[-1]}"
    return (
        f"teeth {names}: both flanks are off the other teeth by an arc of {abs(step) * 1000:.1f} um, the same way: "
        "an indexing error; kept"
    )


def _runs(teeth: int) -> Iterator[tuple[int, ...]]:
    """Neighbors around the turn, two to half of the teeth."""
    for length in range(2, teeth // 2 + 1):
        for first in range(teeth if 2 * length < teeth else teeth // 2):
            yield tuple((first + k) % teeth for k in range(length))


def _arcs(file: FlankFile, flank: str, teeth: int) -> np.ndarray:
    """Arcs (teeth,) [mm] by which a flank is turned at the place that most teeth have; NaN where a tooth lacks it.

    At the radius that half of all points lie within.
    """
    found = np.full(teeth, np.nan)
    (rows,) = np.nonzero((file.flank == flank) & np.isfinite(file.deviation) & (file.tooth < teeth))
    if not len(rows):
        return found
    place = file.row[rows] * (int(file.col.max()) + 1) + file.col[rows]
    here = rows[place == np.bincount(place).argmax()]
    _, arc = kernel("flank_turning")(1.0, file.point[here], file.normal[here])
    radius = np.hypot(file.point[:, 0], file.point[:, 1])
    found[file.tooth[here]] = file.deviation[here] * arc * np.median(radius) / radius[here]
    return found

"""Teeth that are off the others: an indexing error, which is kept whatever its size, or a point that missed.

Every place that many teeth have is fitted over the teeth by its mean and first harmonic. What a point is off that fit,
counted as a turning of its flank (6.5), is compared within its tooth:

* points of one flank that agree, two or more, are the flank's own error, of index or of thickness: kept;
* a point that does not agree with the others of its flank has missed: left out. Since all of them share the pitch of
  their tooth, a single point is told by how much points differ within the teeth; two or more may be form, and are told
  by the differences between teeth;
* a flank with a single point is confirmed by the other flank of the space where that moved at least half as much: the
  same way it is an indexing error, the other way a space too wide or too narrow; kept;
* a single point that its other flank does not confirm may be dirt as well as an error of the flank. It is left out as
  doubtful, so that neither goes into the figures, and these are withheld until it is measured again.

Tooth 0 measured again at the end counts as another point of tooth 0.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from gearmath.kernels import kernel
from gearmath.quality.evaluation.indexed_together import in_words, indexed_together
from gearmath.quality.evaluation.robust import limit_of, off_the_fit
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import FlankFile

#: How far off the other teeth a point must be at least. [mm]
LEAST_BETWEEN_TEETH = 0.05
#: The same of the only point of its flank, and how far off the others of its flank a single point must be. [mm]
_LEAST_ALONE, _LEAST_WITHIN_TOOTH = 0.02, 0.01
#: Teeth that a mean and a harmonic need to tell one tooth from the others.
_LEAST_TEETH = 6
#: Points of a flank agree where they differ by no more than this part of their size: a large turning is not linear.
_ALIKE = 0.1
#: The other flank confirms a single point where it moved at least this part of it.
CONFIRMS = 0.5
#: Where more than this part of the single points of a flank is off, it is not single points that missed.
_MOST = 0.2


@dataclass(frozen=True)
class Shifts:
    """Rows to leave out, with the arc [mm] that each is off: ``misses`` for certain, ``doubtful`` not.

    ``kept`` are sentences on teeth that are off the others, and stay.
    """

    misses: dict[int, float] = field(default_factory=dict)
    doubtful: dict[int, float] = field(default_factory=dict)
    kept: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Limits:
    """From where on a row (n,) is off [mm]: the other teeth, the same as the only point of its flank, its own tooth."""

    between: np.ndarray
    alone: np.ndarray
    within: np.ndarray


@dataclass(frozen=True)
class _Flank:
    """What the points of one flank of a tooth agree on: rows, shift [mm], and the limit [mm] from which it is off."""

    rows: np.ndarray
    shift: float
    limit: float


def tooth_shifts(file: FlankFile, teeth: int, single: np.ndarray) -> Shifts:
    """What is off between the teeth of a file. ``single`` (n,) marks the rows that may be left out."""
    turned, limits = _off_the_other_teeth(file, teeth, single)
    turned, limits = _within_the_teeth(file, teeth, turned, limits)
    misses: dict[int, float] = {}
    lone: dict[int, float] = {}
    kept = []
    for tooth in range(teeth):
        flanks = dict(_flanks(file, tooth, teeth, turned, limits, misses))
        for flank, found in flanks.items():
            if abs(found.shift) <= found.limit:
                continue
            other = flanks.get(FLANKS[1 - FLANKS.index(flank)])
            confirmed = other is not None and abs(other.shift) >= CONFIRMS * abs(found.shift)
            if len(found.rows) == 1 and not confirmed and single[found.rows[0]]:
                lone[int(found.rows[0])] = abs(found.shift)
            elif abs(found.shift) > limits.between[found.rows].max():
                kept.append(_kept(tooth, flank, found, other if confirmed else None))
    misses = {k: off for k, off in misses.items() if single[k]}
    for flank in FLANKS:
        here = [k for k in lone if file.flank[k] == flank]
        of_all = int(np.sum(single & (file.flank == flank) & np.isfinite(turned)))
        if len(here) > max(1, _MOST * of_all):
            what = f"{len(here)} of {of_all} single points are off the other teeth, too many to be misses"
            kept.append(f"{flank} flank: {what}; kept")
            lone = {k: off for k, off in lone.items() if k not in here}
    together = indexed_together(file, teeth, LEAST_BETWEEN_TEETH)
    if together is not None and not kept and not np.isin(file.tooth[[*misses, *lone]] % teeth, together[0]).any():
        kept.append(in_words(*together))
    return Shifts(misses, lone, tuple(dict.fromkeys(kept)))


def _off_the_other_teeth(file: FlankFile, teeth: int, single: np.ndarray) -> tuple[np.ndarray, _Limits]:
    """How far each row (n,) is off the same place of the other teeth, and the limits of that place, as arcs [mm].

    Positive where the flank is turned right-handed about z_w (6.5). NaN where too few teeth tell, and at places that no
    single point has.
    """
    turned, between, alone = (np.full(len(file), np.nan) for _ in range(3))
    _, arc = kernel("flank_turning")(1.0, file.point, file.normal)
    radius = np.hypot(file.point[:, 0], file.point[:, 1])
    arc = arc * np.median(radius) / radius  # at one radius, so that points that turned together agree
    for flank in FLANKS:
        of_flank = (file.flank == flank) & np.isfinite(file.deviation)
        for row, col in sorted(set(zip(file.row[of_flank].tolist(), file.col[of_flank].tolist(), strict=True))):
            (here,) = np.nonzero(of_flank & (file.row == row) & (file.col == col))
            if len(here) < _LEAST_TEETH or not single[here].any():
                continue
            off = off_the_fit(_harmonic(file.tooth[here], teeth), file.deviation[here], _LEAST_ALONE)
            turned[here] = off * arc[here]
            between[here] = limit_of(off, LEAST_BETWEEN_TEETH) * np.abs(arc[here])
            alone[here] = _of_few(off, _LEAST_ALONE) * np.abs(arc[here])
    return turned, _Limits(between, alone, between)


def _within_the_teeth(file: FlankFile, teeth: int, turned: np.ndarray, limits: _Limits) -> tuple[np.ndarray, _Limits]:
    """The same arcs (n,) without what a place has from tooth to tooth beside its tooth, and the limits within a tooth.

    Not every place is measured on the same teeth. Its mean and first harmonic beside the mean of each tooth are taken
    off again, so that uneven pitch does not tell points of one tooth apart.
    """
    turned, within = turned.copy(), limits.within.copy()
    for flank in FLANKS:
        (rows,) = np.nonzero((file.flank == flank) & np.isfinite(turned) & (file.tooth < teeth))
        tooth, count = np.unique(file.tooth[rows], return_counts=True)
        rows = rows[np.isin(file.tooth[rows], tooth[count > 1])]
        beside = np.full(len(file), np.nan)
        for each in tooth[count > 1]:
            here = rows[file.tooth[rows] == each]
            beside[here] = turned[here] - turned[here].mean()  # linear, so that harmonics stay harmonics
        found = []
        for place in np.unique(np.stack([file.row[rows], file.col[rows]], axis=1), axis=0):
            here = rows[(file.row[rows] == place[0]) & (file.col[rows] == place[1])]
            if len(here) >= _LEAST_TEETH:
                off = off_the_fit(_harmonic(file.tooth[here], teeth), beside[here], _LEAST_WITHIN_TOOTH)
                turned[here] += off - beside[here]
                found.append((here, off))
        if found:
            limit = _of_few(np.concatenate([off for _, off in found]), _LEAST_WITHIN_TOOTH, len(found))
            here = np.concatenate([here for here, _ in found])
            within[here] = np.minimum(limit, within[here])
    return turned, replace(limits, within=within)


def _harmonic(tooth: np.ndarray, teeth: int) -> np.ndarray:
    turn = 2 * np.pi * tooth / teeth
    return np.stack([np.ones(len(turn)), np.cos(turn), np.sin(turn)], axis=1)


def _of_few(off: np.ndarray, least: float, fits: int = 1) -> float:
    """The limit by distances (n,) from fits of three terms, which few values follow closer than their noise."""
    return limit_of(off * np.sqrt(len(off) / (len(off) - 3 * fits)), least)


def _flanks(
    file: FlankFile, tooth: int, teeth: int, turned: np.ndarray, limits: _Limits, misses: dict[int, float]
) -> Iterator[tuple[str, _Flank]]:
    """What the points of each flank of a tooth agree on; those that do not are entered among the misses."""
    of_tooth = (file.tooth % teeth == tooth) & np.isfinite(turned)
    for flank in FLANKS:
        (rows,) = np.nonzero(of_tooth & (file.flank == flank))
        if not len(rows):
            continue
        level = float(np.median(turned[rows]))
        if len(rows) == 2 and abs(np.diff(turned[rows])[0]) > _tolerance(turned[rows], limits.within[rows]).max():
            (others,) = np.nonzero(of_tooth & (file.flank != flank))
            expected = float(np.median(turned[others])) if len(others) else 0.0
            level = float(turned[rows][np.argmin(np.abs(turned[rows] - expected))])
        away = np.abs(turned[rows] - level)
        agree = away <= _tolerance(np.array([level]), limits.within[rows])
        if np.sum(~agree) > 1:  # together they may be form
            agree = away <= _tolerance(np.array([level]), limits.between[rows])
        misses.update({int(k): float(off) for k, off in zip(rows[~agree], away[~agree], strict=True)})
        limit = limits.alone if len(rows) == 1 else limits.between
        yield flank, _Flank(rows[agree], level, float(limit[rows].max()))


def _tolerance(shift: np.ndarray, limit: np.ndarray) -> np.ndarray:
    return np.maximum(limit, _ALIKE * np.abs(shift).max())


def _kept(tooth: int, flank: str, found: _Flank, other: _Flank | None) -> str:
    """What a tooth that is off the others is taken for."""
    if other is None:
        what = f"all {len(found.rows)} points" if len(found.rows) > 1 else "the tooth measured in full"
        size = f"an arc of {found.shift * 1000:+.1f} um off the other teeth"
        return f"{flank} flank, tooth {tooth}: {what} agree on {size}; kept"
    sizes = sorted((found.shift, other.shift), key=abs)
    alike = found.shift * other.shift > 0
    meaning = "an indexing error" if alike else "a space too wide or too narrow"
    return (
        f"tooth {tooth}: both flanks are off the other teeth by arcs of {abs(sizes[1]) * 1000:.1f} and "
        f"{abs(sizes[0]) * 1000:.1f} um, {'the same way' if alike else 'opposite ways'}: {meaning}; kept"
    )

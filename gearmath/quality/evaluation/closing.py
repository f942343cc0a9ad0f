"""How a measurement closes: tooth 0 measured again at the end, and whether work or machine drifted or slipped between.

What both measurements of tooth 0 differ by is the return value. Where it exceeds its uncertainty on both flanks, or at
several points of one, the work or the machine has moved: such points are no misses. How it moved in between, the teeth
tell where they are even enough. A steady drift and a step at some moment are both taken off the reference points, and
what remains of every flank beyond its mean and first harmonic is compared. A steady drift is taken out evenly. After a
step, or where neither is told and the pitch depends on it by more than a grade, the pitch is not known. A step inside
the tooth that was measured in full, on one of its flanks (module ``slips``) or between them, or beside it, leaves
neither thickness nor topography; nor does a motion of which it is not told when it was.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.quality.evaluation.drift import evenly, measured_twice, moved_by
from gearmath.quality.evaluation.pitch import reference_point
from gearmath.quality.evaluation.registration import stated_noise
from gearmath.quality.evaluation.robust import limit_of, off_the_fit
from gearmath.quality.evaluation.slips import Slip, find_slip, slip_between
from gearmath.quality.evaluation.tooth_shifts import CONFIRMS, LEAST_BETWEEN_TEETH
from gearmath.quality.evaluation.topography import evaluate_topography, teeth_in_full
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import FlankFile

#: A return value counts from so many standard uncertainties; those of a point whose uncertainty is not known. [mm]
_SIGNIFICANT, _UNKNOWN = 3.0, 1e-3
#: Teeth of a flank that tell a step from a drift.
_LEAST_TEETH = 6
#: What is left of the reference points is never taken for less than this. [mm]
_FLOOR = 1e-4
#: Logarithm of the ratio of likelihoods from which one course counts as told, 50 to 1.
_TOLD = 4.0
#: F_p that differs by more than this part between courses may be of another grade.
_ONE_GRADE = math.sqrt(2) - 1
#: A flank does not feel a motion that changes it by less than this part of what it changes the other.
_UNFELT = 0.15
#: A slip between the flanks of a tooth counts from so many standard uncertainties of the width of a space; those are
#: told by the median of the distances of the others from theirs.
_BETWEEN, _MAD = 4.0, 1.4826
#: A point that is farther off than so many return values says nothing of the course.
_NOT_A_COURSE = 1.5

Kind = Literal["not measured", "still", "small", "steady", "step", "not told"]


@dataclass(frozen=True)
class Closing:
    """What tooth 0, measured again, says.

    ``kind`` is "still" where it does not differ beyond its uncertainty, or by single points that missed; "small" where
    it does, but the pitch depends on how it moved by less than a grade. ``course``
    (n,) is the part of the return value that every row of the file has, ``taken`` (n,) [mm] what it makes of its
    deviation. ``arcs`` [mm] are those by which each flank of tooth 0 is turned at the end, right-handed about z_w, with
    the standard ``uncertainty`` [mm] of one. ``teeth`` are those before and after a step. ``of_spaces`` says that the
    spaces themselves do not depend on when it moved: their two flanks were measured one after the other, turned alike.
    ``slip`` is one inside a tooth that was measured in full; ``beside`` says that a step was beside such a tooth.
    """

    kind: Kind
    course: np.ndarray
    taken: np.ndarray
    arcs: dict[str, float]
    uncertainty: float
    teeth: tuple[int, int] | None = None
    of_spaces: bool = True
    slip: Slip | None = None
    beside: bool = False

    def straightened(self, file: FlankFile) -> FlankFile:
        """The file in which single points that missed are to be looked for: without the motion, where there was one."""
        moved = self.taken if self.moved else np.zeros(len(file))
        return replace(file, deviation=file.deviation - moved, point=file.point - moved[:, None] * file.normal)

    @property
    def moved(self) -> bool:
        """Whether the work or the machine moved for certain."""
        return self.kind in ("steady", "step", "not told")

    @property
    def arc(self) -> float:
        """The largest of the arcs [mm], without its sign."""
        return max(map(abs, self.arcs.values()), default=0.0)

    @property
    def withheld(self) -> str | None:
        """Why pitch is not known; None where it is."""
        if self.slip is not None:
            return f"the work or the machine slipped by {self._size} {self.slip.where}"
        if self.kind == "step":
            return f"the work or the machine slipped by {self._size} while it was measured"
        if self.kind == "not told":
            return f"work or machine moved by {self._size} while it was measured, and it is not told when"
        return None

    @property
    def spaces_withheld(self) -> str | None:
        """Why runout and range of the thickness are not known; None where they are."""
        if self.topography_withheld is not None:
            return self.topography_withheld
        return self.withheld if self.kind == "not told" and not self.of_spaces else None

    @property
    def topography_withheld(self) -> str | None:
        """Why thickness, topography and corrections are not known; None where they are."""
        if self.slip is None and self.kind == "step" and self.beside:
            return f"the work or the machine slipped by {self._size} {self._between}, beside a tooth measured in full"
        return self.withheld if self.slip is not None or self.kind == "not told" else None

    def check_topography(self) -> None:
        """Raises InputError where the topography is not known, and so no correction: what to measure again."""
        why = self.topography_withheld
        if why is None:
            return
        which = ""
        if self.slip is not None:
            which = f"; point {self.slip.row + 1} of the file and all after it do not go with those before"
        raise InputError(f"{why}: no settings can be corrected from it{which}; clamp the work and measure it again")

    @property
    def said(self) -> tuple[str, ...]:
        """One sentence on a motion; empty where there was none."""
        if self.slip is not None:
            u = self.slip.uncertainty * 1000
            return (f"{self.withheld}, u {u:.1f} um; pitch, thickness and topography are withheld",)
        if self.kind in ("not measured", "still"):
            return ()
        flanks = " and ".join(f"{arc * 1000:+.1f} um ({flank})" for flank, arc in self.arcs.items())
        measured = (
            f"tooth 0 measured again at the end is turned by arcs of {flanks}, u {self.uncertainty * 1000:.1f} um"
        )
        how = {
            "small": f"the work or the machine moved by {self._size}: {measured}; taken out as an even drift",
            "steady": f"the work or the machine drifted by {self._size}: {measured}; steady over the teeth, taken out",
            "step": f"the work or the machine slipped by {self._size} {self._between}: {measured}; pitch is withheld",
            "not told": f"the work or the machine moved by {self._size}: {measured}; the teeth do not tell whether it "
            "drifted or slipped; pitch is withheld",
        }
        return (how[self.kind],)

    @property
    def _size(self) -> str:
        return f"{(self.arc if self.slip is None else abs(self.slip.size)) * 1000:.1f} um"

    @property
    def _between(self) -> str:
        if self.teeth is None:
            return ""
        before, after = self.teeth
        return f"between tooth {before} and tooth {after}" if after else f"after tooth {before}, the last one"

    def as_dict(self) -> dict[str, Any]:
        """For people and programs: µm."""
        return {
            "kind": self.kind,
            "arc_um": {flank: arc * 1000 for flank, arc in self.arcs.items()},
            "u_arc_um": self.uncertainty * 1000 if self.arcs else None,
            "between_teeth": list(self.teeth) if self.teeth else None,
            "slip": self.slip.as_dict() if self.slip else None,
        }


def close_run(file: FlankFile, teeth: int) -> Closing:
    """Whether work or machine moved during a measurement, and how."""
    closing = _closed(file, teeth)
    slip = find_slip(file, teeth)
    if slip is None and closing.kind in ("still", "step", "small", "not told"):
        slip = _between_flanks(file, teeth, closing)
    if slip is not None:
        course = (np.arange(len(file)) >= slip.row).astype(float)
        taken = moved_by(file, *measured_twice(file, teeth), course) if closing.arcs else np.zeros(len(file))
        return replace(closing, kind="step", course=course, taken=taken, teeth=None, slip=slip)
    full = {tooth for flank in FLANKS for tooth in teeth_in_full(file, flank)}
    before, after = closing.teeth or (-1, -1)
    return replace(closing, beside=before in full or (after > 0 and after in full))


def _between_flanks(file: FlankFile, teeth: int, closing: Closing) -> Slip | None:
    """A slip between the two flanks of tooth 0: only the first of them has changed at the end, and its space with it.

    A motion that only one flank feels would be by chance along the other. Where the width of space 0 is that of the
    other spaces, tooth 0 was measured well.
    """
    rows = [np.flatnonzero((file.flank == flank) & (file.tooth == 0) & np.isfinite(file.deviation)) for flank in FLANKS]
    if closing.teeth not in (None, (0, 1)) or set(closing.arcs) != set(FLANKS) or not all(map(len, rows)):
        return None
    early, late = (0, 1) if rows[0].max() < rows[1].min() else (1, 0)
    arc, other = (closing.arcs[FLANKS[each]] for each in (early, late))
    if rows[early].max() > rows[late].min() or abs(other) > max(closing.uncertainty, _UNFELT * abs(arc)):
        return None
    (_, lever) = kernel("flank_turning")(1.0, file.point, file.normal)
    arcs = [
        dict(zip(file.tooth[each], (file.deviation * lever)[each], strict=True))
        for each in _by_flank(file, _references(file, teeth))
    ]
    widths = {tooth: arcs[early][tooth] - arcs[late][tooth] for tooth in arcs[0].keys() & arcs[1].keys()}
    others = np.array([width for tooth, width in widths.items() if tooth])
    u = closing.uncertainty
    if 0 in widths and len(others) >= _LEAST_TEETH:
        middle = float(np.median(others))
        u = max(u, float(np.median(np.abs(others - middle))) * _MAD)
        if abs(middle - widths[0] - arc) > abs(arc) / 2:
            return None
    if abs(arc) <= _BETWEEN * u or _has_missed(file, FLANKS[early], arc):
        return None
    return slip_between(file, int(rows[early].max()), int(rows[late].min()), arc, closing.uncertainty)


def _has_missed(file: FlankFile, flank: str, arc: float) -> bool:
    """Whether the reference point of tooth 0 is off its flank's smooth surface by a quarter of an arc."""
    if 0 not in teeth_in_full(file, flank):
        return False
    residual = evaluate_topography(file, flank, 0).residual[reference_point(file)]
    return bool(abs(residual) > abs(arc) / 4)


def _closed(file: FlankFile, teeth: int) -> Closing:
    """What tooth 0 measured again tells, by both flanks."""
    course = evenly(file)
    first, again = measured_twice(file, teeth)
    if not len(first):
        return Closing("not measured", course, np.zeros(len(file)), {}, math.nan)
    noise = stated_noise(file)
    noise = noise if math.isfinite(noise) else _UNKNOWN
    (_, levers) = kernel("flank_turning")(1.0, file.point[first], file.normal[first])
    change = (file.deviation[again] - file.deviation[first]) * levers
    arcs, points = {}, {}
    for flank in (flank for flank in FLANKS if (file.flank[first] == flank).any()):
        here = file.flank[first] == flank
        arcs[flank], points[flank] = float(np.median(change[here])), int(here.sum())
    u = noise * float(np.abs(levers).max()) * math.sqrt(2 / min(points.values()))
    pairs = _together(change, file.flank[first], arcs)
    first, again = first[pairs], again[pairs]
    one, other = (arcs.get(flank, 0.0) for flank in FLANKS)
    alike = abs(one + other) >= 2 * abs(one - other)
    together = alike and _flanks_together(file, teeth, course)
    even = Closing("still", course, moved_by(file, first, again, course), arcs, u, of_spaces=together)
    if not _has_moved(arcs, points, u) or not len(first):
        return even
    return _told(file, teeth, first, again, even, noise)


def _flanks_together(file: FlankFile, teeth: int, course: np.ndarray) -> bool:
    """Whether the two flanks of a space were measured one after the other, and not flank by flank."""
    rows = _references(file, teeth)
    at = [dict(zip(file.tooth[each], course[each], strict=True)) for each in _by_flank(file, rows)]
    apart = [abs(at[0][tooth] - at[1][tooth]) for tooth in at[0].keys() & at[1].keys()]
    return bool(apart) and float(np.median(apart)) <= 1 / teeth


def _by_flank(file: FlankFile, rows: np.ndarray) -> list[np.ndarray]:
    return [rows[file.flank[rows] == flank] for flank in FLANKS]


def _together(change: np.ndarray, flank: np.ndarray, arcs: dict[str, float]) -> np.ndarray:
    """Which of the pairs of points (m,) agree with their flank: a miss among several is none of the motion."""
    off = np.abs(change - np.array([arcs[each] for each in flank]))
    return off <= np.maximum(LEAST_BETWEEN_TEETH, 0.1 * np.abs(change).max(initial=0.0))


def _has_moved(arcs: dict[str, float], points: dict[str, int], u: float) -> bool:
    """Whether the return value is beyond its uncertainty, and not only at a single point that missed."""
    largest = max(arcs, key=lambda flank: abs(arcs[flank]))
    if abs(arcs[largest]) <= _SIGNIFICANT * u:
        return False
    if abs(arcs[largest]) <= LEAST_BETWEEN_TEETH or points[largest] > 1:
        return True
    others = [abs(arc) for flank, arc in arcs.items() if flank != largest]
    return any(arc >= CONFIRMS * abs(arcs[largest]) for arc in others)


def _told(file: FlankFile, teeth: int, first: np.ndarray, again: np.ndarray, even: Closing, noise: float) -> Closing:
    """The course that the reference points tell: steady, a step between two of them, or neither."""
    rows = _references(file, teeth)
    series = [each for each in _by_flank(file, rows) if len(each) >= _LEAST_TEETH]
    if not series:
        return replace(even, kind="not told")
    _, of_both = np.unique(np.concatenate([file.tooth[each] for each in series]), return_counts=True)
    if (of_both == len(series)).sum() < _LEAST_TEETH:
        return replace(even, kind="not told")
    size = float(np.abs(file.deviation[again] - file.deviation[first]).max())
    series = [
        each[_on_course(file.deviation[each] - even.taken[each], file.tooth[each], teeth, size)] for each in series
    ]
    steps = list(_steps(file, rows, first, again))
    unlikely = np.array([_unlikely(file, series, taken, teeth, noise) for *_, taken in steps]) + math.log(len(steps))
    best = int(np.argmin(unlikely))
    evidence = float(unlikely[best]) - _unlikely(file, series, even.taken, teeth, noise)  # for a steady drift
    at, course, taken = steps[best]
    step = replace(even, kind="step", course=course, taken=taken, teeth=at)
    if evidence < -_TOLD:
        return step
    if evidence > _TOLD:
        return replace(even, kind="steady")
    depends = max(
        abs(one - other)
        for one, other in zip(*(_ranges(file, series, each.taken) for each in (even, step)), strict=True)
    )
    matters = depends > _ONE_GRADE * max(*_ranges(file, series, even.taken), _FLOOR)
    return replace(even, kind="not told" if matters else "small")


def _references(file: FlankFile, teeth: int) -> np.ndarray:
    """Rows of the reference points that have a reading, without tooth 0 again."""
    row, col = reference_point(file)
    known = np.isfinite(file.deviation) & (file.tooth < teeth)
    return np.flatnonzero(known & (file.row == row) & (file.col == col))


def _on_course(deviation: np.ndarray, tooth: np.ndarray, teeth: int, size: float) -> np.ndarray:
    """Which deviations (n,) of a flank are near enough to the others to tell a motion of this size."""
    off = off_the_fit(_harmonic(tooth, teeth), deviation, LEAST_BETWEEN_TEETH)
    return np.abs(off) <= max(limit_of(off, 0.0), _NOT_A_COURSE * size)


def _harmonic(tooth: np.ndarray, teeth: int) -> np.ndarray:
    turn = 2 * np.pi * tooth / teeth
    return np.stack([np.ones(len(turn)), np.cos(turn), np.sin(turn)], axis=1)


def _unlikely(file: FlankFile, series: list[np.ndarray], taken: np.ndarray, teeth: int, noise: float) -> float:
    """Minus the logarithm of the likelihood of what a course leaves beyond mean and first harmonic of the teeth.

    Where both flanks of a tooth were measured, of its place and its width, which are uneven by different amounts; as
    uneven as they are.
    """
    (_, lever) = kernel("flank_turning")(1.0, file.point, file.normal)
    arcs = [dict(zip(file.tooth[rows], ((file.deviation - taken) * lever)[rows], strict=True)) for rows in series]
    numbers = sorted(set.intersection(*(set(one) for one in arcs)))
    values = np.array([[one[tooth] for tooth in numbers] for one in arcs])
    modes = values if len(values) == 1 else np.array([values[0] + values[1], values[0] - values[1]]) / 2
    columns = _harmonic(np.array(numbers), teeth)
    spare = len(numbers) - columns.shape[1]
    total = 0.0
    for mode in modes:
        left = mode - columns @ np.linalg.lstsq(columns, mode, rcond=None)[0]
        total += spare / 2 * math.log(float(left @ left) / spare + max(_FLOOR, noise / 2) ** 2)
    return total


def _steps(
    file: FlankFile, rows: np.ndarray, first: np.ndarray, again: np.ndarray
) -> Iterator[tuple[tuple[int, int], np.ndarray, np.ndarray]]:
    """Every place for a step between two teeth: the teeth before and after, its course and what it takes off."""
    ordered = np.sort(rows[rows > first.max()])
    before = int(file.tooth[first[0]])
    starts = [*(int(k) for k in ordered), int(again.min())]
    for k in starts:
        after = int(file.tooth[k])
        if after == before:
            continue
        course = (np.arange(len(file)) >= k).astype(float)
        teeth = (before, 0 if k == starts[-1] else after)
        yield teeth, course, moved_by(file, first, again, course)
        before = after


def _ranges(file: FlankFile, series: list[np.ndarray], taken: np.ndarray) -> list[float]:
    """Ranges [mm] of the reference points of every flank after a course was taken off."""
    return [float(np.ptp((file.deviation - taken)[rows])) for rows in series]

"""How work or machine moved while teeth were measured, told by the teeth: a steady drift, an uneven one, or a slip.

Tooth 0 measured again tells by how much, the reference points of the teeth when. Each course is taken off them, and
what is left of every flank beyond its mean and first harmonic is compared. An uneven drift begins late, ends early, or
both: a machine that warms up, a clamping that gives way at last.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from gearmath.kernels import kernel
from gearmath.quality.evaluation.drift import in_space, moved_by
from gearmath.quality.evaluation.pitch import reference_point
from gearmath.quality.evaluation.robust import limit_of, off_the_fit
from gearmath.quality.evaluation.tooth_shifts import LEAST_BETWEEN_TEETH
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import FlankFile

#: Teeth of a flank that tell a step from a drift.
LEAST_TEETH = 6
#: What is left of the reference points is never taken for less than this. [mm]
_FLOOR = 1e-4
#: Logarithm of the ratio of likelihoods from which one course counts as told, 50 to 1.
_TOLD = 4.0
#: F_p and F_r that differ by more than this part between courses may be of another grade; widths of spaces that are
#: more even than the last [mm] are of the finest.
_ONE_GRADE, _FINEST = math.sqrt(2) - 1, 5e-3
#: Parts of the teeth at which a drift may begin or end; and what it must move tooth 0 by, of itself.
_PARTS, _FELT = (0.0, 0.25, 0.5, 0.75), 0.1
#: A point that is farther off than so many return values says nothing of the course.
_NOT_A_COURSE = 1.5
#: So many teeth tell what a place of the grid differs by from the reference point.
_LEAST_BESIDE = 3

Told = Literal["small", "steady", "step", "uneven", "not told"]


@dataclass(frozen=True)
class Course:
    """The part (n,) of the return value that every row has, and what that takes off its deviation (n,) [mm].

    ``teeth`` are those before and after a step, the same tooth twice where it was inside one.
    """

    part: np.ndarray
    taken: np.ndarray
    teeth: tuple[int, int] | None = None


def tell_course(
    file: FlankFile, teeth: int, first: np.ndarray, again: np.ndarray, even: np.ndarray, noise: float
) -> tuple[Told, Course | None, np.ndarray | None]:
    """What kind of course the reference points tell, the course where it is not the even one, and the doubt in it.

    ``even`` (n,) [mm] is what an even drift takes off. The doubt (n,2) [mm] is how the deviations would differ by the
    likeliest step and by the likeliest uneven drift, after a step by any motion then (n,4); None where the teeth are
    too few to tell anything.
    """
    rows = references(file, teeth)
    series = [each for each in by_flank(file, rows) if len(each) >= LEAST_TEETH]
    if not series:
        return "not told", None, None
    _, of_both = np.unique(np.concatenate([file.tooth[each] for each in series]), return_counts=True)
    if (of_both == len(series)).sum() < LEAST_TEETH:
        return "not told", None, None
    size = float(np.abs(file.deviation[again] - file.deviation[first]).max())
    series = [each[_on_course(file.deviation[each] - even[each], file.tooth[each], teeth, size)] for each in series]
    steady = _unlikely(file, series, even, teeth, noise)
    step, of_step = _likeliest(file, series, list(_steps(file, rows, first, again)), teeth, noise)
    ramp, of_ramp = _likeliest(file, series, list(_ramps(file, rows, first, again)), teeth, noise)
    step = _placed(file, rows, teeth, step)
    doubt = np.stack([even - step.taken, even - ramp.taken], axis=1)
    if of_step - steady < -_TOLD and of_step - of_ramp <= _TOLD:
        return "step", step, slip_patterns(file, step.part)
    if of_ramp - steady < -_TOLD:
        return "uneven", ramp, doubt
    likely = [even]
    likely += [step.taken] if of_step - steady <= _TOLD else []
    likely += [ramp.taken] if of_ramp < steady else []
    if _depend(file, series, likely):
        return "not told", None, doubt
    return ("steady" if of_step - steady > _TOLD else "small"), None, doubt


def slip_patterns(file: FlankFile, part: np.ndarray) -> np.ndarray:
    """What a slip in an unknown direction makes of the deviations (n,4) after it: a shift, or a turn of the work."""
    turn = np.cross(file.point, file.normal)[:, 2:] / np.hypot(*file.point[:, :2].T).mean()
    return part[:, None] * np.hstack([in_space(file), turn])


def _likeliest(
    file: FlankFile, series: list[np.ndarray], courses: list[Course], teeth: int, noise: float
) -> tuple[Course, float]:
    """The likeliest of several courses, and how unlikely it is: each of them more so for being one of many."""
    unlikely = [_unlikely(file, series, each.taken, teeth, noise) for each in courses]
    best = int(np.argmin(unlikely))
    return courses[best], unlikely[best] + math.log(len(courses))


def _depend(file: FlankFile, series: list[np.ndarray], likely: Sequence[np.ndarray]) -> bool:
    """Whether the range of a flank, or of the widths of the spaces, is of another grade after another course."""
    ranges = np.array([_ranges(file, series, taken) for taken in likely])
    # F_p is that of the worse flank, F_r is of the widths
    of_pitch, of_width = ranges[0, : len(series)].max(), ranges[0, len(series) :].max(initial=0.0)
    most = [max(of_pitch, _FLOOR)] * len(series) + [max(of_width, _FINEST)] * (ranges.shape[1] - len(series))
    return bool((np.abs(ranges - ranges[0]) > _ONE_GRADE * np.array(most)).any())


def references(file: FlankFile, teeth: int) -> np.ndarray:
    """Rows of the reference points that have a reading, without tooth 0 again."""
    row, col = reference_point(file)
    known = np.isfinite(file.deviation) & (file.tooth < teeth)
    return np.flatnonzero(known & (file.row == row) & (file.col == col))


def by_flank(file: FlankFile, rows: np.ndarray) -> list[np.ndarray]:
    return [rows[file.flank[rows] == flank] for flank in FLANKS]


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


def _steps(file: FlankFile, rows: np.ndarray, first: np.ndarray, again: np.ndarray) -> Iterator[Course]:
    """Every place for a step between two reference points, and before tooth 0 again."""
    before = int(file.tooth[first[0]])
    for k in [*np.sort(rows[rows > first.max()]).tolist(), int(again.min())]:
        after = int(file.tooth[k]) if k < again.min() else 0
        course = (np.arange(len(file)) >= k).astype(float)
        yield Course(course, moved_by(file, first, again, course), (before, after))
        before = after


def _placed(file: FlankFile, rows: np.ndarray, teeth: int, step: Course) -> Course:
    """A step at the place that the other points tell, those between the last reference point before it and the next.

    What such a point should have, its tooth and the same place of the other teeth tell.
    """
    start = int(np.argmax(step.part > 0))
    earlier = rows[rows < start]
    between = np.arange(int(earlier.max(initial=-1)) + 1, start)
    between = between[(file.tooth[between] < teeth) & np.isfinite(file.deviation[between])]
    (_, lever) = kernel("flank_turning")(1.0, file.point, file.normal)
    size = float(np.median((step.taken * lever)[start:]))
    off = np.array([_off_its_tooth(file, (file.deviation - step.taken) * lever, int(k), rows) for k in between])
    between, off = between[np.isfinite(off)], off[np.isfinite(off)]
    if not len(between):
        return step
    # the points from the start on have moved, those before it have not
    cost = [float(np.sum(off[:k] ** 2) + np.sum((off[k:] - size) ** 2)) for k in range(len(between) + 1)]
    begin = int([*between, start][int(np.argmin(cost))])
    part = (np.arange(len(file)) >= begin).astype(float)
    taken = np.where((part > 0) & (step.part == 0), size / lever, step.taken)
    return Course(part, taken, (int(file.tooth[begin - 1]), int(file.tooth[begin]) % teeth))


def _off_its_tooth(file: FlankFile, arc: np.ndarray, at: int, rows: np.ndarray) -> float:
    """How far a point's arc [mm] is off what its tooth and the same place of the other teeth ask for; NaN if untold."""
    same = (file.flank == file.flank[at]) & np.isfinite(arc)
    of_tooth = {int(file.tooth[k]): arc[k] for k in rows if same[k]}
    place = np.flatnonzero(same & (file.row == file.row[at]) & (file.col == file.col[at]))
    tooth = int(file.tooth[at])
    beside = [arc[k] - of_tooth[int(file.tooth[k])] for k in place if int(file.tooth[k]) in of_tooth and k != at]
    if tooth not in of_tooth or len(beside) < _LEAST_BESIDE:
        return math.nan
    return float(arc[at] - of_tooth[tooth] - np.median(beside))


def _ramps(file: FlankFile, rows: np.ndarray, first: np.ndarray, again: np.ndarray) -> Iterator[Course]:
    """Drifts that begin late, end early or both.

    They begin and end with the measurement, with its second tooth, or at the quarters of the teeth.
    """
    later = np.sort(rows[rows > first.max()])
    parts = [int(later[round(share * (len(later) - 1))]) for share in _PARTS]
    ends = sorted({0, *parts, len(file) - 1})
    clock = np.arange(len(file))
    for start, end in itertools.combinations(ends, 2):
        part = np.clip((clock - start) / (end - start), 0.0, 1.0)
        is_even = (start, end) == (ends[0], ends[-1])
        if not is_even and np.abs(part[again] - part[first]).max() > _FELT:
            yield Course(part, moved_by(file, first, again, part))


def _ranges(file: FlankFile, series: list[np.ndarray], taken: np.ndarray) -> list[float]:
    """Ranges [mm] of the reference points of every flank after a course was taken off, and of the widths of spaces."""
    left = file.deviation - taken
    ranges = [float(np.ptp(left[rows])) for rows in series]
    if len(series) == len(FLANKS):
        at = [dict(zip(file.tooth[rows], left[rows], strict=True)) for rows in series]
        ranges.append(float(np.ptp([at[0][tooth] + at[1][tooth] for tooth in at[0].keys() & at[1].keys()])))
    return ranges

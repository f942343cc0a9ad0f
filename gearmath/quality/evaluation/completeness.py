"""Whether a measurement is whole: what an aborted run, or a file that is cut off, does not have.

A member is measured in full grids, or by the reference point of every tooth for pitch, some teeth with the corners of
the grid or all of it; both flanks at the same places. What departs from that is missing, and is named.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

import numpy as np

from gearmath.errors import counted
from gearmath.machine.planning.artefact_targets import axis_touches, calibration_touches
from gearmath.machine.planning.targets import landmarks
from gearmath.quality.evaluation.nominal import MOST_MISSING
from gearmath.quality.evaluation.pitch import reference_point
from gearmath.quality.evaluation.topography import grid_shape
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.calibration import Calibration
from gearmath.specs.flank_csv import FlankFile
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.touch_csv import WORK_SPHERE, CalibrationTouches, Touches

#: So many points of a flank without a deviation are named.
_NAMED = 6

#: Places (row, col) by flank and tooth.
_Places = dict[tuple[str, int], set[tuple[int, int]]]


def cut_off(file: FlankFile) -> str | None:
    """That a file holds fewer points than its program plans, in words; None where it does not, or does not say it."""
    if file.planned is None or len(file) >= file.planned:
        return None
    return f"the file holds {len(file)} of {file.planned} points that were planned"


def silent_points(file: FlankFile) -> tuple[str, ...]:
    """Sentences on the points that a file has without a deviation: the probe missed them. Many of a flank are counted.

    Of a nominal file, where all are silent, nothing is said.
    """
    silent = np.isnan(file.deviation)
    if silent.all():
        return ()
    found = []
    for flank in FLANKS:
        here = np.flatnonzero(silent & (file.flank == flank))
        found += [
            f"{flank} flank, tooth {file.tooth[k]}, row {file.row[k]}, col {file.col[k]}: no deviation; left out"
            for k in here[:_NAMED]
        ]
        if len(here) > _NAMED:
            found.append(f"{flank} flank: {len(here) - _NAMED} more points have no deviation; left out")
    return tuple(found)


def missing_points(file: FlankFile, teeth: int) -> tuple[str, ...]:
    """What a flank file of a member does not have, in sentences; empty where it is whole.

    A grid of which no more than a fifth is missing is not named here: ``nominal.completed`` names its points.
    """
    places = _places(file.flank, file.tooth, file.row, file.col)
    missing = _missing(places, teeth, grid_shape(file), reference_point(file), MOST_MISSING)
    cut = cut_off(file)
    return tuple(f"not whole: {one}" for one in (*([cut] if cut else []), *missing))


def missing_touches(touches: Touches, teeth: int, shape: tuple[int, int]) -> tuple[str, ...]:
    """What a run of touches on a grid of this shape does not have, as probing programs make them.

    Where pitch is measured, tooth 0 is touched again at the end, and every point as often as the first one. A run that
    says how many touches were planned has as many.
    """
    places = _places(touches.flank, touches.tooth, touches.row, touches.col)
    found = [*_unplanned(touches), *_missing(places, teeth, shape, (shape[0] // 2, shape[1] // 2), 0.0)]
    again = [places.get((flank, teeth), set()) for flank in FLANKS]
    if not found and not _in_full(places, shape) and not (again[0] and again[0] == again[1]):
        found.append(
            f"tooth 0 was touched again at the end at {len(again[0])} concave and {len(again[1])} convex points"
        )
    count = Counter(zip(*(getattr(touches, name).tolist() for name in ("flank", "tooth", "row", "col")), strict=True))
    last, often = list(count.items())[-1], max(count.values())
    if last[1] != often:
        found.append(f"the last point was touched {last[1]} times, others {often} times")
    return tuple(found)


def missed_points(touches: Touches) -> tuple[str, ...]:
    """Sentences on the points at which the probe touched nothing, every time or some of the times."""
    tried: Counter[tuple] = Counter()
    met: Counter[tuple] = Counter()
    first: dict[tuple, int] = {}
    for k, place in enumerate(zip(touches.flank, touches.tooth, touches.row, touches.col, strict=True)):
        tried[place] += 1
        met[place] += bool(touches.triggered[k])
        first.setdefault(place, k)
    return tuple(
        f"{touches.name_of(first[place])}: triggered = 0: the probe touched nothing"
        + (f", {count - met[place]} of {count} times" if met[place] else "; the point is left out")
        for place, count in tried.items()
        if met[place] < count
    )


def taken_for(touches: Touches, shape: tuple[int, int]) -> str:
    """What a run that does not say what was planned is taken for: it may have been aborted between two parts."""
    places = _places(touches.flank, touches.tooth, touches.row, touches.col)
    numbers = {tooth for _, tooth in places}
    grids = {tooth for (_, tooth), here in places.items() if len(here) == shape[0] * shape[1]}
    parts = [f"the grid{'s' * (len(grids) > 1)} of {counted(len(grids), 'tooth')}"] if grids else []
    parts += [f"single points of {counted(len(numbers - grids), 'tooth')}"] if numbers - grids else ["no pitch"]
    return f"its file does not say how many touches were planned: taken for a whole run of {', '.join(parts)}"


def _unplanned(touches: Touches | CalibrationTouches) -> Iterable[str]:
    count = len(touches.axes)
    if touches.planned is not None and count != touches.planned:
        yield f"it has {counted(count, 'touch')}, its program makes {touches.planned}"


def missing_calibration(
    touches: CalibrationTouches, calibration: Calibration, machine: MillingMachine
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """What a run on ring and sphere does not have of the touches that its program makes: parts, and whole targets."""
    if (touches.target == WORK_SPHERE).any() and calibration.work_sphere is not None:
        wanted = {WORK_SPHERE: axis_touches(machine, calibration)}
    else:
        wanted = calibration_touches(calibration)
    there = Counter(touches.target.tolist())
    lacking = {target: count for target, count in wanted.items() if there[target] < count}
    parts = tuple(
        f"{name} was touched {there[name]} of {count} times" for name, count in lacking.items() if there[name]
    )
    parts = (*_unplanned(touches), *parts)
    return parts, tuple(f"{name} was not touched" for name in lacking if not there[name])


def _places(flank: np.ndarray, tooth: np.ndarray, row: np.ndarray, col: np.ndarray) -> _Places:
    places: _Places = {}
    for one, number, r, c in zip(flank.tolist(), tooth.tolist(), row.tolist(), col.tolist(), strict=True):
        places.setdefault((one, number), set()).add((r, c))
    return places


def _in_full(places: _Places, shape: tuple[int, int]) -> bool:
    return all(len(one) == shape[0] * shape[1] for one in places.values())


def _missing(
    places: _Places, teeth: int, shape: tuple[int, int], reference: tuple[int, int], most: float
) -> Iterable[str]:
    """Sentences, flank by flank; of a grid more than the part ``most`` must be missing."""
    absent = [flank for flank in FLANKS if not any(one == flank for one, _ in places)]
    if absent:
        yield f"{absent[0]} flank: not measured at all"
        return
    row, col = (index.ravel() for index in np.indices(shape))
    corners = int(landmarks(row, col, shape, corners=True).sum())
    for (flank, tooth), here in places.items():
        if corners < len(here) < (1 - most) * len(row):
            yield f"{flank} flank, tooth {tooth}: {len(here)} of {len(row)} points of the grid were measured"
    pitch = any(len(here) <= corners and len(here) < len(row) for here in places.values())
    numbers = range(teeth) if pitch else sorted({tooth for _, tooth in places})
    for flank in FLANKS:
        lacking = [tooth for tooth in numbers if reference not in places.get((flank, tooth), set())]
        if lacking:
            yield (
                f"{flank} flank: {len(lacking)} of {len(numbers)} teeth were not measured at the reference point, the "
                f"first of them is tooth {lacking[0]}"
            )
    for tooth in sorted({tooth for _, tooth in places}):
        one, other = (places.get((flank, tooth), set()) for flank in FLANKS)
        if reference in one and reference in other and max(len(one), len(other)) <= corners and one != other:
            yield (
                f"tooth {tooth}: {counted(len(one), 'point')} of the concave and {len(other)} of the convex flank were "
                "measured"
            )

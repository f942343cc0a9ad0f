"""What a run of a store touched, as the file of touches that the control would have written."""

from __future__ import annotations

from collections.abc import Iterator
from decimal import Decimal

from gearmath.control.interface import Touch
from gearmath.control.store_run import StoredRun
from gearmath.specs.touch_csv import PLANNED


def first_of(run: StoredRun) -> StoredRun:
    """The run that all others refer to, of which points were probed again; the run itself where it refers to none."""
    while run.start.refers_to is not None:
        run = run.store.run(run.start.refers_to)
    return run


def whole_touches(run: StoredRun) -> dict[int, tuple[int, Touch]]:
    """Run and touch of every point: those of this run, and what it did not touch again of those it refers to."""
    found = {point: (run.id, touch) for point, touch in run.touches().items()}
    if run.start.refers_to is not None:
        found = whole_touches(run.store.run(run.start.refers_to)) | found
    return dict(sorted(found.items()))


def missing_points(run: StoredRun) -> list[int]:
    """The points that neither this run nor one that it refers to has touched."""
    touched = whole_touches(run)
    return [point for point in first_of(run).start.points if point not in touched]


def touch_csv(run: StoredRun) -> str:
    """The touches of a run as ``gearmath touches`` and ``gearmath calibrate`` read them, every number in full.

    Points that were probed again stand in place of the old ones, all under the number of this run.
    """
    return "\n".join(_lines(run)) + "\n"


def _lines(run: StoredRun) -> Iterator[str]:
    first, touched = first_of(run), whole_touches(run)
    yield f"# {PLANNED}: {len(first.start.points)} touches"
    earlier = {origin for origin, _ in touched.values() if origin != run.id}
    for origin in sorted(earlier):
        kept = sum(1 for other, _ in touched.values() if other == origin)
        yield f"# of run {origin}: {kept} touches; the others were probed again"
    yield ",".join(run.start.columns)
    for point, (_, touch) in touched.items():
        numbers = (*(_plain(value) for value in touch[1:6]), str(int(touch.triggered)))
        yield ",".join((str(run.id), str(point), *first.start.points[point], *numbers))


def _plain(value: float) -> str:
    """The shortest text that reads back as the same number, without an exponent."""
    return format(Decimal(repr(value)), "f")

"""Stored runs judged once for all pages: evaluation at once, uncertainties when they are asked for."""

from __future__ import annotations

import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from gearmath.control.run_start import CALIBRATION, MACHINE, SET
from gearmath.control.store import MeasurementStore
from gearmath.control.store_evaluation import EvaluatedRun, evaluate_run
from gearmath.control.store_summary import RunSummary, summaries
from gearmath.hmi.drawing import PENCIL
from gearmath.quality.uncertainty.corrected import point_covariance
from gearmath.quality.uncertainty.touch_model import touch_covariance
from gearmath.report import ReportedMeasurement, inspection_sheet
from gearmath.report.judged import reported
from gearmath.specs.calibration import load_calibration
from gearmath.specs.measurement import load_measurement
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled

#: So many runs are kept in memory, the last ones used.
_KEPT = 12
#: How long the list of runs is taken for that of now. [s]
_FRESH = 1.0
#: How well a machine measures, where a run does not say it.
_ASSUMED = "measurement.toml"

Progress = Callable[[int], object]


class JudgedRuns:
    """The runs of a store as they are asked for; a complete run does not change, so it is judged once.

    What is found of a run is kept when its store is closed again: ``run.start`` may be read, the store not.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._evaluated: OrderedDict[int, EvaluatedRun] = OrderedDict()
        self._judged: OrderedDict[int, ReportedMeasurement] = OrderedDict()
        self._lock = threading.Lock()
        self._listed: tuple[float, list[RunSummary]] = (-_FRESH, [])

    def summaries(self) -> list[RunSummary]:
        """All runs, the oldest first; none where there is no store yet. A list of a moment ago will do."""
        at, listed = self._listed
        if time.monotonic() - at < _FRESH:
            return listed
        found: list[RunSummary] = []
        if self.path.exists():
            with self.opened() as store:
                found = summaries(store)
        self._listed = (time.monotonic(), found)
        return found

    def of_members(self) -> list[RunSummary]:
        """The runs that touched every point of a member, or, with the run that they refer to, did so again."""
        return [run for run in self.summaries() if run.member is not None and run.is_complete]

    def whole(self) -> list[RunSummary]:
        """Those of them that touched every point themselves: of the others most points are those of an older run."""
        return [run for run in self.of_members() if run.refers_to is None]

    def evaluated(self, run: int, progress: Progress = lambda _: None) -> EvaluatedRun:
        """A run evaluated by set, machine and probe as stored. Raises InputError as :func:`evaluate_run`."""
        with self._lock:
            if run in self._evaluated:
                self._evaluated.move_to_end(run)
                return self._evaluated[run]
        with self.opened() as store:
            found = evaluate_run(store.run(run), progress)
            is_complete = found.run.is_complete
        if is_complete:
            self._keep(self._evaluated, run, found)
        return found

    def judged(self, run: int, progress: Progress = lambda _: None) -> ReportedMeasurement:
        """What the inspection sheet says of a run, with uncertainties and correction: some seconds."""
        with self._lock:
            if run in self._judged:
                self._judged.move_to_end(run)
                return self._judged[run]
        evaluated = self.evaluated(run, progress)
        file, member = evaluated.file, evaluated.member
        covariance, source = point_covariance(file, None), "u_um of the file"
        if covariance is None:
            how = load_measurement(bundled(_ASSUMED))
            with stored_files(evaluated) as folder:
                at = load_milling_machine(folder / MACHINE), load_calibration(folder / CALIBRATION)
            covariance, source = touch_covariance(file, member, how, *at), f"{_ASSUMED}: {how.title} (assumed)"
        head, title = self._head(run)
        found = reported(
            evaluated.gear_set,
            title,
            file,
            evaluated.found,
            covariance,
            source,
            head,
            drawn=lambda _: progress(0),  # nothing but whether to go on
        )
        if self.is_complete(run):
            self._keep(self._judged, run, found)
        return found

    def sheet(self, run: int, progress: Progress = lambda _: None) -> str:
        """The inspection sheet of a run, as ``gearmath report`` writes it."""
        found = self.judged(run, progress)
        with PENCIL:
            return inspection_sheet([found], progress).html

    def is_complete(self, run: int) -> bool:
        """Whether a run takes no more touches."""
        return any(one.run == run and one.is_complete for one in self.summaries())

    def _head(self, run: int) -> tuple[dict[str, str], str]:
        """What the store knows for the head of the sheet, and what the run is called there."""
        one = next(one for one in self.summaries() if one.run == run)
        return {"date": one.begun, "operator": one.operator, "machine": one.control}, f"run {run}, {one.program}"

    @contextmanager
    def opened(self) -> Iterator[MeasurementStore]:
        """The store by a connection of one's own."""
        with MeasurementStore.open(self.path, create=False) as store:
            yield store

    def _keep(self, kept: OrderedDict, run: int, found: object) -> None:
        with self._lock:
            kept[run] = found
            while len(kept) > _KEPT:
                kept.popitem(last=False)


@contextmanager
def stored_files(evaluated: EvaluatedRun) -> Iterator[Path]:
    """A folder with set, machine and probe as they were stored with a run."""
    with TemporaryDirectory() as name:
        for each in (SET, MACHINE, CALIBRATION):
            (Path(name) / each).write_bytes(evaluated.run.start.files[each])
        yield Path(name)

"""What a stored run says of the member: its touches evaluated with set, machine and probe as they were then."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from gearmath.arguments.call import checked_call
from gearmath.arguments.kinds import Record
from gearmath.bevel.pair import load_pair
from gearmath.control.run_start import CALIBRATION, MACHINE, SET
from gearmath.control.store_run import StoredRun
from gearmath.control.store_touches import first_of, missing_points, touch_csv
from gearmath.errors import InputError
from gearmath.quality.evaluation.member import MemberEvaluation, evaluate_member
from gearmath.quality.evaluation.touches import measured_member
from gearmath.shown import Shown, Shows
from gearmath.specs.bevel_set import BevelSet, Member
from gearmath.specs.calibration import load_calibration
from gearmath.specs.flank_csv import FlankFile, read_flank_csv, write_flank_csv
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.touch_csv import read_touch_csv

#: What is kept of its evaluation.
MEASURED, FIGURES = "measured.csv", "evaluation.json"


@dataclass(frozen=True, repr=False)
class EvaluatedRun(Shown):
    """A run of a member, its measured points and its figures. ``file`` is as it was measured, before any correction."""

    run: StoredRun
    gear_set: BevelSet
    name: str
    file: FlankFile
    found: MemberEvaluation

    @property
    def member(self) -> Member:
        return self.gear_set.member(self.name)

    def _shown(self) -> tuple[str, list[Shows]]:
        return f"evaluated run {self.run.id}, {self.name}", [("points", len(self.file), "")]


@checked_call(run=Record("gearmath.control.store_run", "StoredRun", "a run of a store, such as store.run(1)"))
def evaluate_run(run: StoredRun, progress: Callable[[int], object] = lambda _: None) -> EvaluatedRun:
    """Evaluate a run by what is stored with it, as ``gearmath touches`` and ``gearmath evaluate`` would.

    Raises InputError for a run on ring and spheres, for one that is not whole, and for one stored without set, machine
    or calibration.
    """
    where = f"{run.store.path}: run {run.id}"
    if run.start.columns[2] != "member":
        raise InputError(
            f"{where}: touches ring and spheres, not a member: 'gearmath runs show {run.id} --evaluate' calibrates"
        )
    for whose in dict.fromkeys((run, first_of(run))):
        missing = run.missing() if whose is run else missing_points(run)
        if missing:
            raise InputError(
                f"{where}: is not whole: {len(missing)} of {len(whose.start.points)} points have no touch, the first "
                f"is {missing[0]}"
            )
    with stored_files(run, (SET, MACHINE, CALIBRATION)) as folder, of_run(where, folder):
        pair = load_pair(folder / SET)
        at = load_milling_machine(folder / MACHINE), load_calibration(folder / CALIBRATION)
        touches = read_touch_csv(folder / "touches.csv")
        name = touches.member
        member = pair.member(name)
        # as it is written: what is kept is what was evaluated
        write_flank_csv(folder / MEASURED, measured_member(touches, member, *at))
        measured = read_flank_csv(folder / MEASURED)
        found = evaluate_member(measured, member, progress=progress)
    return EvaluatedRun(run, pair, name, measured, found)


def keep_results(evaluated: EvaluatedRun) -> None:
    """Keep the measured flanks and the figures with the run: ``measured.csv`` and ``evaluation.json``."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / MEASURED
        write_flank_csv(path, evaluated.file)
        evaluated.run.add_result(MEASURED, path.read_bytes())
    text = json.dumps(evaluated.found.as_dict(), indent=2)
    evaluated.run.add_result(FIGURES, f"{text}\n".encode())


@contextmanager
def stored_files(run: StoredRun, roles: tuple[str, ...]) -> Iterator[Path]:
    """A folder with these files of a run and its touches, for what reads files."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        for each in roles:
            if each not in run.start.files:
                raise InputError(f"{run.store.path}: run {run.id}: was stored without {each}: it cannot be evaluated")
            (folder / each).write_bytes(run.start.files[each])
        (folder / "touches.csv").write_text(touch_csv(run), "utf-8")
        yield folder


@contextmanager
def of_run(where: str, folder: Path) -> Iterator[None]:
    """Names the run, and not the folder for a moment, in the message of an error."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{where}: {str(error).replace(f'{folder}/', '')}") from error

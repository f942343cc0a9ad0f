"""``gearmath runs`` of a run on ring and spheres: the new calibration beside the one that the run was begun with."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path

import pytest

from gearmath.control.interface import RunStart, Touch
from gearmath.control.store import MeasurementStore
from gearmath.machine.control.executor import run_program
from gearmath.machine.control.state import Setup
from gearmath.machine.measuring.artefacts import Artefacts
from gearmath.machine.writing.calibrating import calibration_program
from gearmath.specs.calibration import load_calibration
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.toml import bundled

Command = Callable[..., tuple[int, str, str]]
Refused = Callable[..., None]
#: Radius of the tip that touches [mm], 4 µm less than in the file.
WORN = 0.746


@pytest.fixture(scope="module")
def path(vertical: MillingMachine, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A store with one calibration run, by a tip that is worn."""
    known = load_calibration(bundled("probe.toml"))
    text = calibration_program(vertical, known, "CAL")
    worn = Artefacts(vertical, known.model_copy(update={"tip_radius": WORN}))
    done = run_program(text, "CAL.MPF", worn, setup=Setup.of(vertical, known.length))
    (written,) = done.files.values()
    columns, *rows = csv.reader(line for line in written.splitlines() if not line.startswith("#"))
    files = {"machine.toml": bundled("vertical_5axis.toml"), "calibration.toml": bundled("probe.toml")}
    content = {name: file.read_bytes() for name, file in files.items()}
    places = {int(row[1]): tuple(row[2:-6]) for row in rows}
    store_file = tmp_path_factory.mktemp("runs") / "runs.db"
    with MeasurementStore.open(store_file) as store:
        run = store.begin_run(RunStart("sim", "CAL.MPF", text.encode(), tuple(columns), places, content))
        for row in rows:
            run.commit_touch(int(row[1]), Touch(1, *map(float, row[-6:-1]), float(row[-1])))
        run.finish("complete")
    return store_file


def test_new_calibration_has_the_worn_tip_and_a_name_of_its_own(path: Path, tmp_path: Path, command: Command) -> None:
    status, text, error = command("runs", "show", 1, "--evaluate", "--store", path)
    assert status == 0, error
    assert "CAL.MPF of ring and spheres on sim" in text
    folder = tmp_path / "run1"
    status, _, error = command("runs", "export", 1, "--store", path, "-o", folder)
    assert status == 0, error
    assert (folder / "calibration.toml").read_bytes() == bundled("probe.toml").read_bytes()
    assert load_calibration(folder / "new_calibration.toml").tip_radius == pytest.approx(WORN, abs=1e-4)


def test_picture_of_a_calibration_run_is_refused_as_there_is_none(path: Path, refused: Refused) -> None:
    refused("--plot: run 1 touches ring and spheres", "runs", "show", 1, "--store", path, "--plot", "p.png")

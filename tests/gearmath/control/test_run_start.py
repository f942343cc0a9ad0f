"""What a run of a calibration program begins with, and what becomes of its touches in the store."""

from __future__ import annotations

from pathlib import Path

import pytest

from gearmath.control.interface import RunStart, Touch
from gearmath.control.parts import base_of
from gearmath.control.run_start import begun, files_of
from gearmath.control.store import MeasurementStore
from gearmath.control.store_touches import touch_csv


@pytest.mark.parametrize(("cycle", "touches"), [("tip", 35), ("axes", 81)])
def test_calibration_run_is_planned_kept_and_calibrates_as_the_file_of_the_control(
    command, tmp_path: Path, cycle: str, touches: int
) -> None:
    """A calibration program refuses a run in which it touches nothing: it is planned with the artefacts on the machine.

    The touches are those of a machine and a probe with errors, and the numbers are those that 'nc calibrate' says.
    """
    program, raw, kept = tmp_path / "CAL.MPF", tmp_path / "raw.csv", tmp_path / "kept.csv"
    status, out, _ = command("nc", "calibrate", "--cycle", cycle, "-o", program)
    assert status == 0
    assert f"{touches} touches" in out
    assert command("probe", program, "--errors", "simulated_shop.toml", "-o", raw)[0] == 0
    rows = [line.split(",") for line in raw.read_text("utf-8").splitlines() if line[:1].isdigit()]
    start, parts = begun("control", program, None, "vertical_5axis.toml", "probe.toml")
    assert parts == [(0, 0)]
    assert start.points == {int(row[1]): (row[2],) for row in rows}
    with MeasurementStore.open(tmp_path / "runs.db") as store:
        run = store.begin_run(start)
        for row in rows:
            run.commit_touch(int(row[1]), Touch(1, *map(float, row[3:9])))
        kept.write_text(touch_csv(run), "utf-8")
        status, shown, err = command("runs", "show", run.id, "--evaluate", "--store", tmp_path / "runs.db")
        assert status == 0, err
        (result,) = store.run(run.id).results().values()
    said = []
    for one in (raw, kept):
        status, out, err = command("calibrate", one, "-o", tmp_path / "found.toml")
        assert status == 0, err
        said.append((out, (tmp_path / "found.toml").read_text("utf-8")))
    assert said[0] == said[1]
    # what 'gearmath calibrate' says of the raw file, but for the line that names the file it wrote
    lines, file = said[0]
    assert "\n".join(lines.splitlines()[:-1]) in shown
    assert result.decode() == file


def test_points_of_a_calibration_are_made_by_the_sections_that_hold_them(command, tmp_path: Path) -> None:
    """Nine touches of the sphere on the work side at each position of the axes: points 12 to 17 are of the second."""
    program = tmp_path / "AXES.MPF"
    assert command("nc", "calibrate", "--cycle", "axes", "-o", program)[0] == 0
    start, parts = begun("control", program, None, "vertical_5axis.toml", "probe.toml", points="12-17")
    assert parts == [(2, 2)]
    assert list(start.points) == list(range(10, 19))
    text = start.program_text.decode()
    assert [base_of(start.points, text, list(range(k, 19))) for k in (10, 12, 18)] == [9, 9, 9]


@pytest.mark.parametrize(("first", "base"), [(1, 0), (2, 0), (4, 3), (6, 3), (10, 9), (11, 9)])
def test_a_start_in_mid_part_begins_with_its_first_touch(first: int, base: int) -> None:
    """Three touches a point; those of the third point are not of the run."""
    points = {k: (f"{(k - 1) // 3}",) for k in range(1, 13) if k not in (7, 8, 9)}
    assert base_of(points, "", [k for k in points if k >= first]) == base


def test_a_run_that_touches_points_again_takes_the_files_of_the_first_unless_others_are_given(tmp_path: Path) -> None:
    mine = {"set.toml": b"of run 1, set", "machine.toml": b"of run 1, machine"}
    old = RunStart("control", "P", b"", ("run",), {}, mine, {"set.toml": "gears.toml", "machine.toml": "mill.toml"})
    with files_of(old, None, None, "other.toml") as (gear_set, machine, calibration):
        assert (Path(gear_set).name, Path(gear_set).read_bytes()) == ("gears.toml", mine["set.toml"])
        assert (Path(machine).name, Path(machine).read_bytes()) == ("mill.toml", mine["machine.toml"])
        assert calibration == "other.toml"
    assert not Path(gear_set).exists()
    with files_of(old, "gears_2.toml", "mill_2.toml", None) as files:
        assert files == ("gears_2.toml", "mill_2.toml", "probe.toml")
    with files_of(None, None, None, None) as files:
        assert files == (None, "vertical_5axis.toml", "probe.toml")

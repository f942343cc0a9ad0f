"""``gearmath runs``: stored runs of the NASA pinion, probed on the machine model with the errors of a shop."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from gearmath.control.interface import Alarm, RunStart, Touch
from gearmath.control.store import MeasurementStore
from gearmath.machine.control.state import Setup
from gearmath.machine.measuring.probe import ProbeMachine
from gearmath.machine.measuring.probe_run import run_touches
from gearmath.machine.writing.probing import probing_program
from gearmath.specs.bevel_set import BevelSet
from gearmath.specs.calibration import load_calibration
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.simulated_machine import SimulatedMachine
from gearmath.specs.toml import bundled

SET = "nasa_tp3096_12x36.toml"
#: What the touches of the second run are turned about the work axis, beyond those of the first [degrees].
TURNED = 0.01
#: How much higher the probe stands at the points that are probed again [mm].
RAISED = 0.004
#: By what teeth 4 to 8 are turned in the last run [degrees]: 9.5 µm on the circle of 27.1 mm through the mean point.
INDEXED = 0.02
Command = Callable[..., tuple[int, str, str]]
Refused = Callable[..., None]


@pytest.fixture(scope="module")
def raw(gear_set: BevelSet, vertical: MillingMachine, shop: SimulatedMachine) -> tuple[str, str]:
    """A probing program of the pinion, and the touches that it writes."""
    probe = load_calibration(bundled("probe.toml"))
    program = probing_program(gear_set, "pinion", vertical, probe, "PROBE")
    there = ProbeMachine(gear_set.member("pinion"), vertical, probe, seat=shop.measuring_clamp("pinion"))
    return program, run_touches(program, "PROBE.MPF", there, shop, 122, setup=Setup.of(vertical, probe.length))


@pytest.fixture(scope="module")
def template(raw: tuple[str, str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Run 1: whole. Run 2: the same touches with A turned on, by another operator and on another machine file. Run 3:
    the first 70, then an alarm. Run 4: points 3 and 5 of run 1 probed again, RAISED. Run 5: teeth 4 to 8 INDEXED."""
    program, text = raw
    columns, *rows = csv.reader(line for line in text.splitlines() if not line.startswith("#"))
    places = {int(row[1]): tuple(row[2:7]) for row in rows}
    touches = {int(row[1]): Touch(1, *map(float, row[7:12]), float(row[12])) for row in rows}
    files = {
        "set.toml": bundled(SET),
        "machine.toml": bundled("vertical_5axis.toml"),
        "calibration.toml": bundled("probe.toml"),
    }
    content = {name: path.read_bytes() for name, path in files.items()}
    start = RunStart("simulated control", "PROBE.MPF", program.encode(), tuple(columns), places, content, {}, "Ann")
    path = tmp_path_factory.mktemp("store") / "runs.db"
    with MeasurementStore.open(path) as store:
        first = store.begin_run(start)
        other = content | {"machine.toml": content["machine.toml"].replace(b"Vertical 5-axis", b"Other")}
        second = store.begin_run(replace(start, operator="Bob", files=other))
        third = store.begin_run(start)
        fourth = store.begin_run(replace(start, points={k: places[k] for k in (3, 5)}, refers_to=first.id))
        fifth = store.begin_run(start)
        for point, touch in touches.items():
            turned = INDEXED if 4 <= int(places[point][2]) <= 8 else 0.0
            fifth.commit_touch(point, touch._replace(A=touch.A + turned))
            first.commit_touch(point, touch)
            second.commit_touch(point, touch._replace(A=touch.A + TURNED))
            if point <= 70:
                third.commit_touch(point, touch)
            if point in (3, 5):
                fourth.commit_touch(point, touch._replace(Z=touch.Z + RAISED))
        third.add_alarm(Alarm("65001#1", "65001", "point 71: touched nothing", 1000, True))
        third.finish("alarm 65001: point 71: touched nothing")
        for run in (first, second, fourth, fifth):
            run.finish("complete")
        store.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    return path


@pytest.fixture
def path(template: Path, tmp_path: Path) -> Path:
    """A store of the test's own."""
    (tmp_path / "runs.db").write_bytes(template.read_bytes())
    return tmp_path / "runs.db"


def test_list_says_how_every_run_stands(path: Path, command: Command) -> None:
    status, out, _ = command("runs", "list", "--store", path)
    lines = [re.split(r"\s{2,}", line.strip()) for line in out.splitlines()]
    assert status == 0
    assert [line[0] for line in lines[1:]] == ["1", "2", "3", "4", "5"]
    assert [line[5] for line in lines] == ["touches", "122/122", "122/122", "70/122", "2/2", "122/122"]
    assert lines[3][-1] == "alarm 65001: point 71: touched nothing"
    _, out, _ = command("runs", "list", "--store", path, "--json")
    found = json.loads(out)
    assert [each["state"] for each in found[:2]] == ["complete", "complete"]
    assert [each["refers_to"] for each in found] == [None, None, None, 1, None]
    assert [each["alarms"] for each in found] == [0, 0, 1, 0, 0]


def test_show_says_what_a_run_was_begun_with_and_what_it_lacks(path: Path, command: Command) -> None:
    _, out, _ = command("runs", "show", 3, "--store", path, "--json")
    found = json.loads(out)
    assert found["missing"] == list(range(71, 123))
    assert [each["name"] for each in found["files"]] == ["PROBE.MPF", "calibration.toml", "machine.toml", "set.toml"]
    assert found["alarm_list"][0]["text"] == "point 71: touched nothing"
    _, out, _ = command("runs", "show", 3, "--store", path)
    assert "70 of 122 points touched; 52 missing, the first is point 71" in out
    assert "begun by Ann" in out


def test_exported_touches_are_those_that_the_control_wrote(
    path: Path, raw: tuple[str, str], tmp_path: Path, command: Command
) -> None:
    """All cells but the number of the run, as numbers, to the last digit."""
    target = tmp_path / "raw.csv"
    assert command("runs", "export", 1, "--store", path, "-o", target)[0] == 0
    tables = [
        [[float(cell) if cell[:1] in "-0123456789" else cell for cell in row[1:]] for row in csv.reader(lines)]
        for lines in (
            [line for line in text.splitlines() if not line.startswith("#")]
            for text in (raw[1], target.read_text("utf-8"))
        )
    ]
    assert len(tables[0]) == 123
    assert tables[0] == tables[1]
    status, out, _ = command("touches", target, "--set", SET, "-o", tmp_path / "measured.csv")
    assert status == 0
    assert "122 points of run 1" in out


def test_points_that_were_probed_again_replace_the_old_ones(path: Path, tmp_path: Path, command: Command) -> None:
    targets = [tmp_path / f"{run}.csv" for run in (1, 4)]
    for run, target in zip((1, 4), targets, strict=True):
        command("runs", "export", run, "--store", path, "-o", target)
    old, new = (
        {int(row[1]): row[2:] for row in csv.reader(target.read_text("utf-8").splitlines()) if row[0].isdigit()}
        for target in targets
    )
    assert [point for point in old if old[point] != new[point]] == [3, 5]
    assert float(new[3][7]) - float(old[3][7]) == pytest.approx(RAISED, abs=1e-9)
    assert command("touches", targets[1], "--set", SET, "-o", tmp_path / "measured.csv")[0] == 0


def test_compare_finds_the_turn_of_the_work_and_what_was_not_the_same(path: Path, command: Command) -> None:
    """Turning the work turns both flanks: what their deviations share is taken out, and no figure changes."""
    status, out, err = command("runs", "compare", 1, 2, "--store", path, "--json")
    assert status == 0, err
    found = json.loads(out)
    assert found["differs"] == [
        "runs 1 and 2: machine.toml: name Vertical 5-axis machine -> Other machine",
        "runs 1 and 2: operator Ann, then Bob",
    ]
    names = {(row["flank"], row["name"]) for row in found["figures"]}
    assert {("concave", "F_p_um"), ("convex", "rms_um"), ("both", "F_r_um")} <= names
    for row in found["figures"]:
        assert row["change"] == pytest.approx(0.0, abs=0.01), row
    for change in found["changes"]:
        assert change["rms_um"] < 0.01


def test_compare_tells_a_change_of_pitch_from_noise(path: Path, command: Command) -> None:
    """Five teeth indexed by 9.5 µm: pitch changes on both flanks, and where tooth 0 lies from the mean of all teeth.

    Neither its form does, nor the thickness, nor the runout.
    """
    _, out, _ = command("runs", "compare", 1, 5, "--store", path, "--json")
    rows = {(row["flank"], row["name"]): row for row in json.loads(out)["figures"]}
    changed = {place for place, row in rows.items() if row["beyond_noise"]}
    assert changed == {
        (flank, name)
        for flank in ("concave", "convex")
        for name in ("F_p_um", "max_f_pt_um", "mean_um", "max_deviation_um")
    }
    for flank in ("concave", "convex"):
        assert rows[flank, "max_f_pt_um"]["values"][1] == pytest.approx(9.5, abs=3 * 0.7)  # noise of a touch 0.7 um


def test_compare_shows_where_two_touches_changed(path: Path, tmp_path: Path, command: Command) -> None:
    """Points 3 and 5 are of the concave flank of tooth 0; a tip that stands higher touches elsewhere."""
    picture = tmp_path / "compare.png"
    _, out, _ = command("runs", "compare", 1, 4, "--store", path, "--plot", picture, "--json")
    changes = {change["flank"]: change for change in json.loads(out)["changes"]}
    assert (changes["concave"]["row"], changes["concave"]["col"]) in [(0, 2), (0, 4)]
    assert 1 < abs(changes["concave"]["largest_um"]) < 1000 * RAISED
    assert changes["convex"]["rms_um"] < changes["concave"]["rms_um"]
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_compare_draws_the_course_of_more_than_two_runs(path: Path, tmp_path: Path, command: Command) -> None:
    picture = tmp_path / "course.png"
    status, out, err = command("runs", "compare", 1, 2, 5, "--store", path, "--plot", picture)
    assert status == 0, err
    assert re.search(r"figure / um +run 1 +run 2 +run 5 +change", out)
    starred = [line.split()[:2] for line in out.splitlines() if line.endswith("*")]
    assert ["concave", "F_p"] in starred
    assert ["concave", "twist"] not in starred
    assert "not the same: runs 1 and 2: operator Ann, then Bob" in out
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_evaluation_is_that_of_the_commands_and_is_kept(path: Path, tmp_path: Path, command: Command) -> None:
    command("runs", "export", 1, "--store", path, "-o", tmp_path / "raw.csv")
    command("touches", tmp_path / "raw.csv", "--set", SET, "-o", tmp_path / "measured.csv")
    _, direct, _ = command("evaluate", tmp_path / "measured.csv", "--set", SET, "--json")
    status, out, _ = command("runs", "show", 1, "--evaluate", "--store", path)
    assert status == 0
    assert "runout F_r" in out
    command("runs", "export", 1, "--store", path, "-o", tmp_path / "all")
    kept = json.loads((tmp_path / "all" / "evaluation.json").read_text("utf-8"))
    assert kept == json.loads(direct)
    assert (tmp_path / "all" / "measured.csv").read_text("utf-8") == (tmp_path / "measured.csv").read_text("utf-8")


def test_dfq_has_a_part_a_run_and_the_tolerances_of_the_grade(path: Path, tmp_path: Path, command: Command) -> None:
    """Grade 6 of the pinion, m_mn 3.5 mm and d_T 54.2 mm: f_pt 12 µm, F_p 43 µm, as ``evaluate`` judges them."""
    target = tmp_path / "runs.dfq"
    status, _, _ = command("runs", "export", 1, 2, "--store", path, "--grade", 6, "-o", target)
    lines = target.read_bytes().decode("cp1252").split("\r\n")
    assert status == 0
    assert sum("\x0f" in line for line in lines) == 2
    names = dict(re.fullmatch(r"K2001/(\d+) (.*)", line).groups() for line in lines if line.startswith("K2001/"))
    limits = dict(re.fullmatch(r"K2111/(\d+) (.*)", line).groups() for line in lines if line.startswith("K2111/"))
    assert {names[k] for k in limits} == {
        f"{flank} {name}" for flank in ("concave", "convex") for name in ("F_p", "max_f_pt")
    } | {"both F_r"}
    assert {names[k]: limits[k] for k in limits}["concave max_f_pt"] == "12.000"
    assert len(lines[-2].split("\x0f")) == int(lines[0].removeprefix("K0100 ")) == len(names)


def test_all_files_of_a_run_are_written_under_names_that_stay_in_the_folder(tmp_path: Path, command: Command) -> None:
    path = tmp_path / "runs.db"
    names = ["../escape.toml", "/etc/x", "run.json", "TOUCHES.CSV", "CON", "ok.toml"]
    with MeasurementStore.open(path) as store:
        store.begin_run(
            RunStart(
                "control",
                "..\\..\\EVIL.MPF",
                b"M30\n",
                ("run", "point", "target", "X", "Y", "Z", "A", "B", "triggered"),
                {1: ("sphere",)},
                {name: name.encode() for name in names},
            )
        )
    folder = tmp_path / "new" / "all"
    folder.parent.mkdir()
    assert command("runs", "export", 1, "--store", path, "-o", folder)[0] == 0
    written = {file.name for file in folder.iterdir()}
    assert {"ok.toml", "run.json", "touches.csv"} < written
    assert len(written) == len(names) + 3
    assert [file.name for file in folder.parent.iterdir()] == ["all"]
    listed = {each["name"]: each["file"] for each in json.loads((folder / "run.json").read_text("utf-8"))["files"]}
    for name in names:
        assert (folder / listed[name]).read_bytes() == name.encode()
    status, _, err = command("runs", "export", 1, "--store", path, "-o", folder)
    assert (status, "cannot be made: File exists" in err) == (2, True)


def test_resume_says_where_the_program_goes_on(
    path: Path, tmp_path: Path, raw: tuple[str, str], command: Command
) -> None:
    program = tmp_path / "PROBE.MPF"
    _, out, _ = command("runs", "resume", 3, "--store", path, "-o", program, "--json")
    found = json.loads(out)
    assert (found["missing"][0], found["stretches"]) == (71, [[71, 122]])
    assert program.read_text("utf-8") == raw[0]


def test_chosen_points_are_probed_again_in_one_start_a_stretch(path: Path, command: Command) -> None:
    _, out, _ = command("runs", "resume", 1, "--again", "17-20, 3", "--store", path)
    assert "run 6: begun, to probe 5 points of run 1 again" in out
    assert re.findall(r"R90=(\d+) R91=(\d+)", out) == [("3", "3"), ("17", "20")]
    _, out, _ = command("runs", "show", 6, "--store", path, "--json")
    assert (json.loads(out)["refers_to"], json.loads(out)["missing"]) == (1, [3, 17, 18, 19, 20])


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("list", "--store", "none.db"), r"none\.db: there is no such measurement store"),
        (("show", 9), r"runs\.db: there is no run 9: it has 1 to 5"),
        (("compare", 1), "runs 1: must be two different runs, or more"),
        (("compare", 1, 1), "must be two different runs"),
        (("compare", 1, 3), r"run 3: is not whole: 52 of 122 points have no touch, the first is 71"),
        (("export", 3, "-o", "x.dfq"), r"run 3: is not whole: 52 of 122"),
        (("export", 1, 2, "-o", "x.csv"), "runs 1, 2: csv takes one run, dfq several"),
        (("export", 1, "--grade", 5, "-o", "x.csv"), r"--grade 5: is for dfq; x\.csv is written as csv"),
        (("export", 1, "-o", "x.txt"), r"x\.txt: --format is missing"),
        (("export", 1, "-o", "nowhere/x.csv"), "nowhere/x.csv: cannot be written: there is no folder nowhere"),
        (("resume", 1), r"run 1 is complete: --again probes points of it once more"),
        (("resume", 1, "--again", "0"), r"--again 0: 0: must be within 1 to 122"),
        (("resume", 1, "--again", "7-5"), "--again 7-5: 7-5: must be within 1 to 122"),
        (("resume", 1, "--again", "x"), "must be numbers and stretches"),
        (("resume", 1, "--again", "1;DROP"), "must be numbers and stretches"),
    ],
)
def test_what_cannot_be_is_refused_in_one_sentence(
    path: Path, monkeypatch: pytest.MonkeyPatch, refused: Refused, arguments: tuple, sentence: str
) -> None:
    monkeypatch.chdir(path.parent)
    refused(sentence, "runs", *arguments)
    assert sorted(file.name for file in path.parent.iterdir() if "-" not in file.name) == ["runs.db"]

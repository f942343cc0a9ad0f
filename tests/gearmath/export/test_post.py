"""gm-post: the C program writes what the Python writer writes, and refuses in one sentence what is no settings file."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from gearmath.bevel.pair import load_pair
from gearmath.cli import main
from gearmath.export.cnc import export_cnc
from gearmath.export.post import post_file
from gearmath.machine.control.executor import execute
from gearmath.machine.judging.dialects import LINUXCNC, SINUMERIK, ControlDialect
from gearmath.machine.planning.cut_plan import CuttingJob, CuttingPlan, cutting_plan
from gearmath.machine.planning.path import axis_positions
from gearmath.machine.writing.cutting import program_of
from gearmath.machine.writing.linuxcnc.cutting import program_of as linuxcnc_program
from gearmath.specs.bevel_set import BevelSet
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.toml import bundled

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-ffp-contract=off", "-O1")
ASAN = ("-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
SETS = (
    "nasa_tp3096_12x36",
    "spiral_7x43",
    "crown_gear_formate_14x39",
    "crown_gear_universal_14x39",
)
#: Mutations of each kind of file, unless GEARMATH_FUZZED says how many.
FUZZED = 2_000


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("post") / "lib"
    export_cnc(place)
    return place


@pytest.fixture(scope="module")
def gm_post(folder: Path, gcc: str) -> Path:
    """The program under ASan and UBSan, warnings being errors."""
    flags = " ".join((*STRICT[1:], *ASAN))
    subprocess.run(["make", "-s", f"CC={gcc}", f"CFLAGS={flags}", "gm-post"], cwd=folder, check=True)
    return folder / "gm-post"


def post(gm_post: Path, settings: str, place: Path, status: int = 0, name: str = "CUT.MPF") -> tuple[str, str]:
    """Program and message of one run; a run that is refused leaves nothing behind."""
    (place / "some.settings").write_bytes(settings.encode())
    before = set(place.iterdir())
    done = subprocess.run([gm_post, "some.settings", "-o", name], cwd=place, capture_output=True, text=True)
    assert done.returncode == status, done.stderr
    if status:
        assert done.stderr.count("\n") == 1
        assert set(place.iterdir()) == before
        return "", done.stderr
    return (place / name).read_text(), done.stderr


def planned(gear_set: BevelSet, member: str, machine: MillingMachine, **job: object) -> CuttingPlan:
    spaces = tuple(range(gear_set.member(member).teeth))
    return cutting_plan(gear_set, member, machine, CuttingJob(**{"spaces": spaces, **job}))  # type: ignore[arg-type]


@pytest.mark.parametrize("name", SETS)
def test_program_is_that_of_the_python_writer_byte_for_byte(
    name: str, vertical: MillingMachine, gm_post: Path, tmp_path: Path
) -> None:
    gear_set = load_pair(bundled(f"{name}.toml"))
    for member in gear_set.members:
        plan = planned(gear_set, member, vertical)
        for control in (SINUMERIK, LINUXCNC):
            assert post(gm_post, post_file(plan, control), tmp_path) == (control.cutting(plan, "CUT"), "")


@pytest.mark.parametrize("control", [SINUMERIK, LINUXCNC], ids=lambda one: one.name)
def test_face_hobbed_members_are_written_alike_for_both_controls(
    control: ControlDialect, vertical: MillingMachine, gm_post: Path, tmp_path: Path
) -> None:
    gear_set = load_pair(bundled("crown_gear_hobbed_14x39.toml"))
    for member in gear_set.members:
        plan = planned(gear_set, member, vertical, tolerance=5e-3)
        text = post_file(plan, control)
        assert "\nto " in text
        assert "\nnode " not in text
        assert post(gm_post, text, tmp_path) == (control.cutting(plan, "CUT"), "")


def counting(machine: MillingMachine, values: int) -> MillingMachine:
    """The machine with A and C as axes that count on, and polynomial blocks of so many values."""
    axes = {
        axis: getattr(machine.axes, axis).model_copy(update={"modulo": False, "travel": (-720.0, 1e6)}) for axis in "AC"
    }
    control = machine.control.model_copy(update={"polynomial_values": values})
    return machine.model_copy(update={"axes": machine.axes.model_copy(update=axes), "control": control})


@pytest.mark.parametrize("values", [18, 30])
def test_polynomials_of_hobbed_members_are_written_alike(
    values: int, vertical: MillingMachine, gm_post: Path, tmp_path: Path
) -> None:
    """Cubic and quintic blocks of six axes, A and C counting through all turns, in two stages, Z of the tip."""
    machine = counting(vertical, values).model_copy(update={"z_reference": "tip"})
    gear_set = load_pair(bundled("crown_gear_hobbed_14x39.toml"))
    for member in gear_set.members:
        plan = planned(gear_set, member, machine, blocks="poly", tolerance=5e-4, roughing_stock=0.3)
        text = post_file(plan)
        assert f"\ndegree {values // 6}\nto " in text
        assert post(gm_post, text, tmp_path) == (program_of(plan, "CUT"), "")


@pytest.mark.parametrize(("name", "values"), [*((name, 15) for name in SETS), (SETS[0], 25)])
def test_polynomial_programs_are_written_alike(
    name: str, values: int, vertical: MillingMachine, gm_post: Path, tmp_path: Path
) -> None:
    """Cubic and quintic blocks computed from the settings, with two stages; a Formate gear has straight ones."""
    control = vertical.control.model_copy(update={"polynomial_values": values})
    machine, gear_set = vertical.model_copy(update={"control": control}), load_pair(bundled(f"{name}.toml"))
    for member in gear_set.members:
        plan = planned(gear_set, member, machine, blocks="poly", spaces=(0, 5, 3), roughing_stock=0.3)
        text = post_file(plan)
        formate = gear_set.member(member).generation == "formate"
        assert (f"\ndegree {values // 5}\n" in text) is not formate
        assert "\nto " not in text
        assert post(gm_post, text, tmp_path) == (program_of(plan, "CUT"), "")


def test_polynomials_of_a_counting_axis_and_of_the_tip_are_written_alike(
    gear_set: BevelSet, vertical: MillingMachine, gm_post: Path, tmp_path: Path
) -> None:
    turning = vertical.axes.A.model_copy(update={"modulo": False, "travel": (-200.0, 260.0)})
    axes = vertical.axes.model_copy(update={"A": turning})
    machine = vertical.model_copy(update={"axes": axes, "z_reference": "tip"})
    plan = planned(gear_set, "pinion", machine, blocks="poly", dry_run=True)
    assert post(gm_post, post_file(plan), tmp_path) == (program_of(plan, "CUT"), "")


def test_every_kind_of_machine_and_job_is_written_alike(
    gear_set: BevelSet, vertical: MillingMachine, gm_post: Path, tmp_path: Path
) -> None:
    """A that counts, with little travel; slow axes; the tip as reference of Z; coarse increments; stocks; a dry run."""
    turning = vertical.axes.A.model_copy(
        update={"modulo": False, "travel": (-200.0, 260.0), "max_speed_per_min": 100.0, "max_acceleration": 5.0}
    )
    update = {
        "axes": vertical.axes.model_copy(update={"A": turning}),
        "z_reference": "tip",
        "pivot_offset": (0.3, -0.2, 0.1),
        "control": vertical.control.model_copy(
            update={"increments_per_mm": 1000, "increments_per_degree": 10000, "path_mode": "G60"}
        ),
    }
    machine = vertical.model_copy(update=update)
    for job in (
        {"spaces": (0, 7, 3), "roughing_stock": 0.4, "finishing_stock": 0.05, "tolerance": 2e-3},
        {"spaces": (11,), "dry_run": True, "feed": 6000.0, "spindle_rpm": 77.0, "tolerance": 1e-2},
    ):
        plan = planned(gear_set, "pinion", machine, **job)
        assert post(gm_post, post_file(plan), tmp_path) == (program_of(plan, "CUT"), "")


@pytest.mark.parametrize(("name", "member"), [("nasa_tp3096_12x36", "pinion"), ("crown_gear_formate_14x39", "gear")])
def test_program_for_linuxcnc_is_that_of_its_python_writer(
    name: str, member: str, vertical: MillingMachine, gm_post: Path, tmp_path: Path
) -> None:
    """No numbers of blocks, A counts on, and Z of the tip: the words come from the settings file."""
    machine = vertical.model_copy(update={"z_reference": "tip"})
    plan = planned(load_pair(bundled(f"{name}.toml")), member, machine, spaces=(0, 3), roughing_stock=0.2)
    text = post_file(plan, LINUXCNC)
    assert post(gm_post, text, tmp_path, name="CUT.ngc") == (linuxcnc_program(plan, "CUT"), "")


def test_command_writes_a_settings_file_for_each_member(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    main(["export", "cnc", "crown_gear_formate_14x39.toml", "-o", str(tmp_path / "lib")])
    for member in ("pinion", "gear"):
        assert (tmp_path / "lib" / f"{member}.settings").read_text().startswith("gm-post 3\nsum ")
        assert f"{member}.settings: {member}, for gm-post" in capsys.readouterr().out or member == "gear"
    with pytest.raises(SystemExit) as ended:
        main(
            [
                "export",
                "cnc",
                SETS[0] + ".toml",
                *("--control", "linuxcnc", "--blocks", "poly", "-o"),
                str(tmp_path / "no"),
            ]
        )
    assert ended.value.code == 2
    assert "LinuxCNC has no polynomials" in capsys.readouterr().err
    assert not (tmp_path / "no").exists()


def test_edited_settings_move_the_axes_as_the_set_would_and_the_head_says_so(
    gear_set: BevelSet, vertical: MillingMachine, altered: Callable, gm_post: Path, tmp_path: Path
) -> None:
    plan = planned(gear_set, "pinion", vertical, spaces=(0,))
    text = post_file(plan)
    nominal = repr(float(plan.member.concave.vector[0]))
    wrong = float(plan.member.concave.vector[0]) + 0.05
    program, said = post(gm_post, text.replace(f"settings {nominal} ", f"settings {wrong!r} ", 1), tmp_path)
    assert "was edited after the export" in said
    assert "machine settings sha256" not in program
    assert "edited in the settings file" in program
    concave = altered(gear_set, "pinion", "concave", radial_distance=wrong).member("pinion").concave
    wanted = axis_positions(concave, plan.passes[0].theta, vertical.pivot_height, vertical.pivot)
    path = execute(program, "CUT.MPF")
    concave_cut = path.axes[(path.tool == 0) & ~path.rapid]
    assert len(concave_cut) == len(wanted)
    assert np.abs(concave_cut[:, :3] - wanted[:, :3]).max() < 1e-5
    assert np.abs(concave_cut - axis_positions(plan.member.concave, plan.passes[0].theta, 500.0)).max() > 0.01


def test_edited_feed_of_polynomials_is_that_of_a_job_with_this_feed(
    gear_set: BevelSet, vertical: MillingMachine, gm_post: Path, tmp_path: Path
) -> None:
    """All but the head of the program."""
    slow, fast = (
        planned(gear_set, "pinion", vertical, blocks="poly", spaces=(0,), feed=feed) for feed in (300.0, 900.0)
    )
    program, _ = post(gm_post, post_file(slow).replace("\nfeed 300.0\n", "\nfeed 900.0\n"), tmp_path)
    written, wanted, before = (
        [line for line in text.splitlines() if not line.startswith(";")]
        for text in (program, program_of(fast, "CUT"), program_of(slow, "CUT"))
    )
    assert written == wanted
    assert written != before


def test_carriage_returns_of_a_transfer_do_not_count_as_an_edit(
    gear_set: BevelSet, vertical: MillingMachine, gm_post: Path, tmp_path: Path
) -> None:
    plan = planned(gear_set, "gear", vertical, spaces=(0,), tolerance=1e-2)
    program, said = post(gm_post, post_file(plan).replace("\n", "\r\n"), tmp_path)
    assert (program, said) == (program_of(plan, "CUT"), "")


@pytest.fixture(scope="module")
def small(gear_set: BevelSet, vertical: MillingMachine) -> str:
    return post_file(planned(gear_set, "pinion", vertical, spaces=(0,), tolerance=5e-2))


@pytest.mark.parametrize(
    ("pattern", "replacement", "words"),
    [
        (r"\Agm-post 3", "gm-past 3", "line 1: must read 'gm-post 3'"),
        (r"\Agm-post 3", "gm-post 2", "line 1: is of form 2, this gm-post reads form 3: export settings"),
        (r"^feed .*", "feed -3", r"line \d+: feed = -3: must be 0.001 to 1e\+06"),
        (r"^feed .*\n", "", r"line \d+: feed: is missing"),
        (r"^(feed .*)", r"\1\n\1", "feed: stands twice"),
        (r"^feed .*", "feed 300,0", "feed: number 1: '300,0' is no number: digits, a point"),
        (r"^feed .*", "feed 0x10", "feed: number 1: '0x10' is no number"),
        (r"^feed .*", "speeed 1", "speeed: no such key"),
        (r"^settings (.*)", r"to 1 2 3 4 5 6 0\nsettings \1", "settings: stands in a roll that was planned"),
        (
            r"^settings (.*)",
            r"settings \1\nto 1 2 3 4 5 6 0",
            "to: stands in a roll that is computed",
        ),
        (r"^settings (.*)", r"to 1 2 3 4 5", "to: has 5 numbers, must have 7"),
        (r"^settings (.*)", r"degree 3\nto 1 2 3 4 5 6 0", "to: has 7 numbers, must have 19"),
        (r"^settings (.*)", r"to 1 2 3 4 5 6 0\ndegree 3", "degree: stands in a roll that was planned"),
        (r"^settings (.*)", r"to 1 2 3 4 1e6 6 0", r"to: number 5 = 1e\+06: must be -1e5 to 1e5"),
        (r"^settings (.*)", r"to 1 2 3 4 5 6 0\nto 1 2 3 4 5 6 0", r"to: time = 0 s: must be 0.0001 to 100000"),
        (r"^tooth (.*)", r"tooth \1\ndegree 2", "degree = 2: must be 1, 3 or 5"),
        (r"^tooth (.*)", r"tooth \1\ndegree 3\ndegree 3", "degree: stands twice in one roll"),
        (r"^jerk .*", "jerk 1 2 3 0 5", "jerk: number 4 = 0: must be at least 1e-9"),
        (r"\{X\}", "{C}", r"\{C\}: no such slot here"),
        (r"\{X\}", "{PX}", r"\{PX\}: no such slot here"),
        (r"^decimals .*", "decimals 5 6.5", "decimals: number 2 = 6.5: must be a whole number from 1 to 9"),
        (r"^speed .*", "speed 1 2 3", "speed: has 3 numbers, must have 5"),
        (r"^speed .*", "speed 1 2 3 0 5", "speed: number 4 = 0: must be at least 1e-9"),
        (r"^settings \S+", "settings nan", "settings: number 1: 'nan' is no number"),
        (
            r"^settings \S+",
            "settings 5000",
            r"roll 0: axis positions \(gm_axis_transform.h\) at node 0: an input is",
        ),
        (r"^travel X .*", "travel X -1 1", r"pass 0: axis X = -\d+.\d+ mm at node 0: travel is -1 to 1"),
        (r"^travel X .*", "travel Q -1 1", "travel: must name one of the axes"),
        (r"^travel Z .*", "travel Z -100 501", r"Z = 540.00000 mm between the passes: travel is -100 to 501"),
        (r"^pass \d+", "pass 9", "pass: number 1 = 9: must be a whole number from 0 to 1"),
        (r"^node .*\n", "", "roll 0: has 0 nodes, must have at least 2"),
        (r"\{X\}", "{W}", r"\{W\}: no such slot here"),
        (r"\{X\}", "{X", r"\{X Y\{Y\}: no such slot here"),
        (r"^n G17", "q G17", "q: must be one of c n r b s e pass"),
        (r"^pass .*\n", "", r"b: stands before the first pass|there is no pass to write"),
        (r"^c ; PART.*", "c \x01", "no settings file of gm-post"),
        (r"^# .*", "# \x80", "is not printable ASCII"),
    ],
)
def test_what_is_no_settings_file_is_refused_in_one_sentence(
    pattern: str, replacement: str, words: str, small: str, gm_post: Path, tmp_path: Path
) -> None:
    text = re.sub(pattern, replacement, small, flags=re.MULTILINE)
    if text == small:
        text = small + replacement + "\n"
    _, message = post(gm_post, text, tmp_path, status=2)
    assert re.search(words, message), message


@pytest.mark.parametrize(
    "name", ["1CUT.MPF", "C.MPF", "CON.MPF", "COM1.MPF", "MUCH_TOO_LONG_FOR_A_CONTROL.MPF", "A-B.MPF"]
)
def test_name_that_a_control_does_not_take_is_refused(name: str, small: str, gm_post: Path, tmp_path: Path) -> None:
    assert "the name of the program" in post(gm_post, small, tmp_path, 2, name)[1]


def test_settings_are_not_written_over_by_a_program(small: str, gm_post: Path, tmp_path: Path) -> None:
    """Neither their own, by another path to them, nor those of another member."""
    for name in ("PINION", "GEAR"):
        (tmp_path / f"{name}.settings").write_text(small, "ascii")
    for there in ("PINION.settings", "./PINION.settings", tmp_path / "PINION.settings", "GEAR.settings"):
        done = subprocess.run(
            [gm_post, "PINION.settings", "-o", there], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert (done.returncode, done.stderr.count("\n")) == (2, 1)
        assert "is a settings file, name another for the program" in done.stderr
    assert {path.name: path.read_text("ascii") for path in tmp_path.iterdir()} == {
        "PINION.settings": small,
        "GEAR.settings": small,
    }


def test_a_place_that_cannot_be_written_to_is_refused(small: str, gm_post: Path, tmp_path: Path) -> None:
    (tmp_path / "FOLDER.MPF").mkdir()
    assert "is a folder or a device" in post(gm_post, small, tmp_path, 2, "FOLDER.MPF")[1]
    assert "NOWHERE/CUT.MPF: No such file" in post(gm_post, small, tmp_path, 2, "NOWHERE/CUT.MPF")[1]
    os.mkfifo(tmp_path / "PIPE.MPF")
    assert "is a folder or a device" in post(gm_post, small, tmp_path, 2, "PIPE.MPF")[1]


@pytest.fixture(scope="module")
def fuzz(gm_post: Path, gcc: str) -> Path:
    """The mutator around gm-post, under ASan and UBSan."""
    harness, library = Path(__file__).with_name("fuzz_post.c"), gm_post.with_name("libgearmath.a")
    flags = ("-std=gnu99", "-O1", *ASAN)
    command = [gcc, *flags, "-I.", "-Ipost", str(harness), str(library), "-o", "fuzz", "-lm"]
    subprocess.run(command, cwd=library.parent, check=True)
    return library.with_name("fuzz")


@pytest.mark.parametrize(
    ("name", "job"),
    [
        ("nasa_tp3096_12x36", {"tolerance": 5e-2}),
        ("nasa_tp3096_12x36", {"tolerance": 5e-2, "blocks": "poly"}),
        ("crown_gear_hobbed_14x39", {"tolerance": 5e-2}),
        ("crown_gear_hobbed_14x39", {"tolerance": 5e-2, "blocks": "poly"}),
    ],
    ids=["straight", "polynomial", "hobbed", "hobbed polynomial"],
)
def test_fuzzed_settings_files_never_crash_and_say_one_sentence(
    name: str, job: dict, vertical: MillingMachine, fuzz: Path, tmp_path: Path
) -> None:
    """Under ASan and UBSan, mutations of a short file: FUZZED of each kind."""
    gear_set = load_pair(bundled(f"{name}.toml"))
    hobbed = gear_set.pinion.process == "face_hobbing"
    machine = counting(vertical, 18) if hobbed else vertical
    spaces = {} if hobbed else {"spaces": (0,)}
    lines = post_file(planned(gear_set, "pinion", machine, **job, **spaces)).splitlines(keepends=True)
    ends = [k for k, line in enumerate(lines) if line.startswith("to ")]  # of a long roll its beginning
    lines = [line for k, line in enumerate(lines) if k not in ends[12:]]
    starts = [k for k, line in enumerate(lines) if line.startswith("pass ")]
    (tmp_path / "small.settings").write_text("".join(lines[: starts[0] + 14]))
    count = int(os.environ.get("GEARMATH_FUZZED", FUZZED))
    command = [fuzz, "small.settings", str(count), "17"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    refused, written = map(int, re.findall(r"\d+", done.stdout))
    assert refused + written == count
    assert refused > count / 4
    assert written > count / 100

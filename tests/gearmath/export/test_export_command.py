"""``gearmath export``: the folders on disk, and one sentence on bad input."""

from __future__ import annotations

from pathlib import Path

import pytest

from gearmath.cli import main
from gearmath.errors import InputError
from gearmath.export.teensy import teensy_files
from gearmath.specs.hobbing import HobbingMachine, load_hobbing_machine
from gearmath.specs.toml import bundled


@pytest.fixture(scope="module")
def machine() -> HobbingMachine:
    return load_hobbing_machine(bundled("hobbing_plewes.toml"))


def test_what_a_machine_lacks_and_whose_sketch_is_replaced_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    for name in ("hobbing_default", "hobbing_minimum"):
        main(["export", "teensy", f"{name}.toml", "-o", str(tmp_path / "hobber")])
    first, second = capsys.readouterr().out.split("hobber: 25 files\n")[1:]
    assert "replace" not in first
    assert "they replace those of 'Hobbing machine with all its guards'" in second
    assert "No fail-safe output (pins.healthy): after a fault you must stop the hob yourself." in second


def test_teensy_folder_is_a_whole_sketch(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    for _ in range(2):  # a folder of ours is replaced
        main(["export", "teensy", str(bundled("hobbing_plewes.toml")), "-o", str(tmp_path / "hobber")])
    written = {path.name for path in (tmp_path / "hobber").iterdir()}
    assert {
        "hobber.ino",
        "gm_machine.h",
        "gm_core.h",
        "gm_core.c",
        "gm_gearbox_edge.h",
        "gm_encoder_hysteresis.h",
        "gm_counter.h",
        "gm_counter_motion.h",
        "gm_job.c",
        "gm_ui.c",
        "gm_store.c",
        "wiring.svg",
        "README.md",
        "manifest.json",
    } <= written
    constants = (tmp_path / "hobber" / "gm_machine.h").read_text()
    assert f"#define GM_ENCODER_COUNTS {1024 * 4} " in constants
    assert f"#define GM_MOTOR_STEPS {200 * 4 * 2 * 10} " in constants
    assert "#define GM_HOB_STARTS 1 " in constants
    assert f"{len(written) - 1} files" in capsys.readouterr().out


def test_cnc_folder_is_written_and_replaced(tmp_path: Path) -> None:
    for _ in range(2):
        main(["export", "cnc", "-o", str(tmp_path / "lib")])
    assert '#include "gm_axis_transform.h"' in (tmp_path / "lib" / "gearmath.h").read_text()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["export", "teensy", "absent.toml", "-o", "x"], "absent.toml: cannot be read"),
        (
            ["export", "teensy", "hobbing_plewes.toml", "-o", "{foreign}/my gears"],
            "the folder's name becomes the sketch's",
        ),
        (
            ["export", "teensy", "{foreign}/wrong.toml", "-o", "{foreign}/x"],
            "wrong.toml: pins.knob_b = 2: the pin is already",
        ),
        (["export", "cnc", "-o", "{foreign}"], "holds mine.txt"),
        (["export", "cnc"], "Missing option"),
    ],
)
def test_bad_input_is_one_sentence_and_status_2(
    arguments: list[str], words: str, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    (tmp_path / "wrong.toml").write_text(
        bundled("hobbing_plewes.toml").read_text().replace("[pins]", "[pins]\nknob_b = 2")
    )
    with pytest.raises(SystemExit) as ended:
        main([argument.format(foreign=tmp_path) for argument in arguments])
    assert ended.value.code == 2
    message = capsys.readouterr().err
    assert words in message
    assert message.count("\n") == 1
    assert {path.name for path in tmp_path.iterdir()} == {"mine.txt", "wrong.toml"}


def test_machine_beyond_the_domain_of_the_kernels_is_refused(machine: HobbingMachine) -> None:
    fine = machine.model_copy(update={"encoder": machine.encoder.model_copy(update={"lines": 20_000})})
    with pytest.raises(InputError, match="encoder_counts = 80000: the kernels take 1 to 40000"):
        teensy_files(fine)


def test_name_of_the_machine_cannot_break_the_comment(machine: HobbingMachine) -> None:
    header = teensy_files(machine.model_copy(update={"name": 'evil */ #error " \\'}))["gm_machine.h"]
    assert ' * evil * / #error " /\n' in header
    assert '#define GM_NAME "evil * / #error \' /"\n' in header

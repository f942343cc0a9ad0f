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


def test_teensy_folder_holds_kernels_constants_and_instructions(
    tmp_path: Path, machine: HobbingMachine, capsys: pytest.CaptureFixture
) -> None:
    main(["export", "teensy", str(bundled("hobbing_plewes.toml")), "-o", str(tmp_path / "fw")])
    assert {path.name for path in (tmp_path / "fw").iterdir()} == {
        "gm_gearbox_step.h", "gm_gearbox_step.c", "gm_gearbox_terms.h", "gm_gearbox_terms.c", "gm_machine.h",
        "README.md", "manifest.json",
    }  # fmt: skip
    constants = (tmp_path / "fw" / "gm_machine.h").read_text()
    assert f"#define GM_ENCODER_COUNTS {1024 * 4}\n" in constants
    assert f"#define GM_MOTOR_STEPS {200 * 4 * 2 * 10}\n" in constants
    assert "#define GM_HOB_STARTS 1\n" in constants
    assert "6 files" in capsys.readouterr().out


def test_cnc_folder_is_written_and_replaced(tmp_path: Path) -> None:
    for _ in range(2):
        main(["export", "cnc", "-o", str(tmp_path / "lib")])
    assert '#include "gm_axis_transform.h"' in (tmp_path / "lib" / "gearmath.h").read_text()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["export", "teensy", "absent.toml", "-o", "x"], "absent.toml: cannot be read"),
        (["export", "cnc", "-o", "{foreign}"], "holds mine.txt"),
        (["export", "cnc"], "Missing option"),
    ],
)
def test_bad_input_is_one_sentence_and_status_2(
    arguments: list[str], words: str, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(SystemExit) as ended:
        main([argument.format(foreign=tmp_path) for argument in arguments])
    assert ended.value.code == 2
    message = capsys.readouterr().err
    assert words in message
    assert message.count("\n") == 1


def test_machine_beyond_the_domain_of_the_kernels_is_refused(machine: HobbingMachine) -> None:
    fine = machine.model_copy(update={"encoder": machine.encoder.model_copy(update={"lines": 20_000})})
    with pytest.raises(InputError, match="encoder_counts = 80000: the kernels take 1 to 40000"):
        teensy_files(fine)


def test_name_of_the_machine_cannot_break_the_comment(machine: HobbingMachine) -> None:
    header = teensy_files(machine.model_copy(update={"name": "evil */ #error \\"}))["gm_machine.h"]
    assert " * evil * / #error /\n" in header

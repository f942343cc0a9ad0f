"""``--control linuxcnc``: which control a program is for, the example beside it, and what does not go together."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from gearmath.specs.toml import bundled

Command = Callable[..., tuple[int, str, str]]
Refused = Callable[..., None]
CUT = ("nc", "cut", "nasa_tp3096_12x36.toml", "--member", "gear", "--spaces", "0", "--tolerance-um", "1")


@pytest.fixture
def machine(tmp_path: Path) -> Callable[[str], Path]:
    """A machine file with more lines in its table of the control."""

    def write(lines: str) -> Path:
        text = bundled("vertical_5axis.toml").read_text("utf-8")
        target = tmp_path / "machine.toml"
        target.write_text(text.replace("[control] ", f"[control]\n{lines}\n#", 1), "utf-8")
        return target

    return write


def test_the_machine_file_says_which_control_it_has(command: Command, machine: Callable, tmp_path: Path) -> None:
    target = tmp_path / "GEAR.ngc"
    status, out, err = command(*CUT, "--machine", machine('kind = "linuxcnc"'), "-o", target)
    assert (status, err) == (0, "")
    assert "; control: LinuxCNC\n" in target.read_text("ascii")
    assert target.read_text("ascii").endswith("\nM2\n")
    status, out, err = command("mill", CUT[2], "--member", "gear", "--program", target, "-o", tmp_path / "M.csv")
    assert status == 0, err
    assert "passed: 1 of 36 spaces within 1 um" in out


@pytest.mark.parametrize(("kind", "asked"), [("linuxcnc", "sinumerik"), ("sinumerik", "linuxcnc")])
def test_an_option_that_disagrees_with_the_machine_is_refused(
    kind: str, asked: str, refused: Refused, machine: Callable, tmp_path: Path
) -> None:
    at = machine(f'kind = "{kind}"')
    sentence = f"--control {asked}: the machine has \\[control\\] kind = '{kind}'"
    refused(sentence, *CUT, "--machine", at, "--control", asked, "-o", tmp_path / "GEAR.MPF")
    refused(sentence, "nc", "calibrate", "--machine", at, "--control", asked, "-o", tmp_path / "CAL.MPF")
    assert [one.name for one in tmp_path.iterdir()] == ["machine.toml"]


def test_the_example_has_the_axes_and_tools_of_the_program(command: Command, machine: Callable, tmp_path: Path) -> None:
    at = machine("tool_numbers = { GEAR = 7 }")
    status, out, _ = command(
        *CUT, "--machine", at, "--control", "linuxcnc", "--configuration", "-o", tmp_path / "GEAR.ngc"
    )
    assert status == 0
    assert out.count("example, written") == 4
    ini = (tmp_path / "GEAR.ini").read_text()
    assert "KINEMATICS = trivkins coordinates=XYZABC" in ini
    assert "WRAPPED" not in ini
    assert "[AXIS_B]\nMIN_LIMIT = -10\nMAX_LIMIT = 100\nMAX_VELOCITY = 60\nMAX_ACCELERATION = 200\n" in ini
    assert (tmp_path / "GEAR.tbl").read_text() == "T7 P7 Z0.00000 ; GEAR\n"
    assert "T7 M6" in (tmp_path / "GEAR.ngc").read_text()


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--configuration",), "--configuration goes with --control linuxcnc"),
        (("--control", "linuxcnc", "--blocks", "poly"), "LinuxCNC has no polynomials"),
    ],
)
def test_what_does_not_go_together_is_refused_before_anything_is_written(
    options: tuple[str, ...], sentence: str, refused: Refused, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    refused(sentence, *CUT, *options, "-o", "GEAR.ngc")
    assert not list(tmp_path.iterdir())


def test_two_tools_with_one_number_are_refused(refused: Refused, machine: Callable, tmp_path: Path) -> None:
    at = machine("tool_numbers = { GEAR = 7, PROBE = 7 }")
    refused("tool_numbers must give every tool a number of its own", *CUT, "--machine", at, "-o", tmp_path / "GEAR.MPF")


def test_a_control_that_is_not_there_is_named(command: Command, refused: Refused, tmp_path: Path) -> None:
    refused("NO.ini: cannot be read", "control", "--linuxcnc", "status", tmp_path / "NO.ini")
    refused("a LinuxCNC has no connection file", "control", "--linuxcnc", "trust", tmp_path / "NO.ini")
    refused("must be like PROBE.ngc", "control", "--linuxcnc", "get", tmp_path / "NO.ini", "../PROBE.ngc")


def test_a_cutter_has_not_the_number_of_the_probe(
    command: Command, refused: Refused, machine: Callable, tmp_path: Path
) -> None:
    """The probe has 99 where the file says nothing: a program would fetch a cutter to touch with."""
    out = ("--control", "linuxcnc", "-o", tmp_path / "CAL.ngc")
    at = machine("tool_numbers = { GEAR = 99 }")
    refused("control: tool_numbers: 99 is that of the probe", "nc", "calibrate", "--machine", at, *out)
    at = machine("tool_numbers = { GEAR = 99, PROBE = 5 }")
    assert command("nc", "calibrate", "--machine", at, *out)[0] == 0
    assert "T5 M6" in (tmp_path / "CAL.ngc").read_text()


CALIBRATE = ("nc", "calibrate", "--control", "linuxcnc", "--configuration", "-o")


def test_a_changed_configuration_is_not_written_over(command: Command, tmp_path: Path) -> None:
    """Drives are connected in the HAL file, and LinuxCNC counts the runs in the parameter file."""
    assert command(*CALIBRATE, tmp_path / "CAL.ngc")[0] == 0
    (tmp_path / "CAL.hal").write_text("loadrt my_drive\n")
    (tmp_path / "CAL.ini").unlink()
    status, out, err = command(*CALIBRATE, tmp_path / "CAL.ngc")
    assert (status, err) == (0, "")
    assert (tmp_path / "CAL.hal").read_text() == "loadrt my_drive\n"
    assert f"{tmp_path / 'CAL.hal'}: is there already, left as it is" in out
    assert (tmp_path / "CAL.ini").read_text().startswith("[EMC]")


def test_a_configuration_that_cannot_be_written_stops_before_the_program(refused: Refused, tmp_path: Path) -> None:
    (tmp_path / "CAL.hal").mkdir()
    refused("CAL.hal: cannot be written: is a folder, name a file", *CALIBRATE, tmp_path / "CAL.ngc")
    refused("CAL.ini: --configuration writes that file", *CALIBRATE, tmp_path / "CAL.ini")
    assert [one.name for one in tmp_path.iterdir()] == ["CAL.hal"]

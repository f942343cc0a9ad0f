"""Set-up sheets for LinuxCNC: they say what the programs for it do, and nothing of another control."""

from __future__ import annotations

import re
from collections.abc import Callable
from html import unescape
from pathlib import Path

import pytest

from tests.gearmath.setup_sheet.test_setup_sheet import cells

SET = "nasa_tp3096_12x36.toml"
KINDS = {
    "cutting": ("nc", "cut", SET, "--member", "pinion", "--spaces", "0,1", "--tolerance-um", "2"),
    "probing": ("nc", "probe", SET, "--member", "pinion", "--topography", "none", "--no-registration"),
    "tip": ("nc", "calibrate"),
    "axes": ("nc", "calibrate", "--cycle", "axes"),
}
#: Words of a SINUMERIK that no other control has.
OF_ANOTHER = re.compile(r"SINUMERIK|\bR9[01]\b|\bR104\b|RESET|NC start|length 1 of|CTOL|OTOL|\$|\bD1\b|WRITE|MEAS|M70")


@pytest.fixture(params=KINDS)
def written(request: pytest.FixtureRequest, command: Callable, tmp_path: Path) -> tuple[str, str, str]:
    """Kind, program and sheet of a program for LinuxCNC."""
    program, sheet = tmp_path / "GEAR.ngc", tmp_path / "sheet.html"
    status, out, err = command(*KINDS[request.param], "--control", "linuxcnc", "--sheet", sheet, "-o", program)
    assert status == 0, err
    assert f"{sheet}: set-up sheet" in out
    return request.param, program.read_text("ascii"), unescape(sheet.read_text("utf-8"))


def test_sheet_says_what_the_program_for_linuxcnc_does_and_no_word_of_another_control(
    written: tuple[str, str, str],
) -> None:
    kind, program, sheet = written
    assert OF_ANOTHER.search(re.sub(r"<style.*?</style>", "", sheet, flags=re.DOTALL)) is None
    found = cells(sheet)
    assert found["G54 in machine coordinates"] == ["X0 Y0 Z0 A0 B0", "mm, °", "by the program"]
    assert "(ABORT, G54 must be X0 Y0 Z0 A0 B0)" in program
    decimals = found["decimals of positions in mm, in degrees"][0].split(", ")
    word = re.search(r"G0 X-?\d+\.(\d+) Y-?\d+\.\d+ A-?\d+\.(\d+)", program)
    if word:
        assert [str(len(part)) for part in word.groups()] == decimals
    for chosen in ("#3090", "#3091"):
        assert f"{chosen}=0" in program
        assert chosen in sheet
    for wrapped in ("AXIS_A must not be WRAPPED_ROTARY", "AXIS_B must not be WRAPPED_ROTARY"):
        assert wrapped in program
    assert "A or B is a WRAPPED_ROTARY axis" in sheet
    assert ("under the work" in sheet) is ("under the work" in program)
    if kind == "cutting":
        numbers = re.findall(r"^; tool T(\d+): (\w+)$", program, re.MULTILINE)
        assert [f"T{number}" for number, _ in numbers] == found["number in the tool table"]
        assert all(f"T{number} M6" in program for number, _ in numbers)
        adds = float(re.search(r"^; path mode G64 P\S+ adds up to (\S+) um$", program, re.MULTILINE)[1])
        assert adds - 1.01e-4 <= float(found["path mode G64, besides"][0]) <= adds
    else:
        assert "tool T99" in sheet
        assert "T99 M6" in program
        (file,) = set(re.findall(r"\(LOGOPEN,(\S+)\)", program))
        assert f"in the file {file}, in the folder of the INI file" in sheet
        assert "motion.digital-in-00, on before the start" in sheet
        assert "M66 P0 L0" in program


def test_exact_path_adds_nothing_and_numbers_of_the_machine_file_are_on_the_sheet(
    command: Callable, tmp_path: Path
) -> None:
    from gearmath.specs.toml import bundled

    numbers = "tool_numbers = { PINION_CONCAVE = 12, PINION_CONVEX = 7, PROBE = 30 }"
    text = bundled("vertical_5axis.toml").read_text("utf-8")
    text = re.sub(r"^(\[control\].*)$", rf'\1\nkind = "linuxcnc"\n{numbers}', text, flags=re.MULTILINE)
    machine, sheet = tmp_path / "machine.toml", tmp_path / "sheet.html"
    machine.write_text(re.sub(r'^path_mode = "\w+"', 'path_mode = "G60"', text, flags=re.MULTILINE), "utf-8")
    status, _, err = command(*KINDS["cutting"], "--machine", machine, "--sheet", sheet, "-o", tmp_path / "GEAR.ngc")
    assert status == 0, err
    found = cells(sheet.read_text("utf-8"))
    assert found["number in the tool table"] == ["T12", "T7"]
    assert found["path mode G61, besides"] == ["0.0000"]
    assert command(*KINDS["tip"], "--machine", machine, "--sheet", sheet, "-o", tmp_path / "TIP.ngc")[0] == 0
    assert "The probe is tool T30" in sheet.read_text("utf-8")

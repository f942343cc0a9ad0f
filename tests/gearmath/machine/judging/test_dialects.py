"""Dialects: a control that nobody knew writes every kind of program in the twenty lines of the page, and is judged."""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearmath.export.post import post_file
from gearmath.machine.control.executor import execute
from gearmath.machine.control.state import Setup
from gearmath.machine.control.text import program_text
from gearmath.machine.judging import dialects
from gearmath.machine.judging.dialects import LINUXCNC, SINUMERIK, ControlDialect, known, of_text, register
from gearmath.machine.planning.cut_plan import CuttingJob, cutting_plan
from gearmath.machine.writing.axis_cycle import axis_program
from gearmath.machine.writing.calibrating import calibration_program
from gearmath.machine.writing.probing import probing_program
from gearmath.specs.bevel_set import BevelSet
from gearmath.specs.calibration import load_calibration
from gearmath.specs.control import CONTROLS
from gearmath.specs.milling_machine import MillingMachine, load_milling_machine
from gearmath.specs.toml import bundled

PAGE = Path(__file__).parents[4] / "docs" / "how_to" / "another_machine.md"
SET, PROBE = "nasa_tp3096_12x36.toml", "probe.toml"
#: Of every program that these tests write; another member and another machine write the same words.
CUT = ("nc", "cut", SET, "--member", "pinion", "--spaces", "0", "--tolerance-um", "2")


@pytest.fixture
def mill5() -> Iterator[ControlDialect]:
    """The dialect of the page, known during one test."""
    source = textwrap.dedent(re.search(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)[1])
    keep = dict(CONTROLS)
    exec(source, {"__name__": "mill5"})
    yield dialects.named("mill5")
    CONTROLS.clear()
    CONTROLS.update(keep)


def unlike(text: str, other: str) -> list[tuple[str, str]]:
    """Lines of two programs that are not the same, without numbers of blocks and the % around."""
    lines = [re.sub(r"^N\d+ ", "", line) for line in text.splitlines() if line != "%"]
    return [pair for pair in zip(lines, other.splitlines(), strict=True) if pair[0] != pair[1]]


def test_dialect_of_the_page_has_about_twenty_lines() -> None:
    source = re.search(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)[1]
    code = [line for line in source.splitlines() if line.strip() and "import" not in line and "main" not in line]
    assert len(code) <= 20


def test_every_kind_of_program_is_written_in_the_words_of_a_new_dialect(
    gear_set: BevelSet, vertical: MillingMachine, mill5: ControlDialect
) -> None:
    plan, probe = cutting_plan(gear_set, "pinion", vertical, CuttingJob((0,), 2e-3)), load_calibration(bundled(PROBE))
    writers: dict[str, Callable[[ControlDialect], str]] = {
        "cutting": lambda one: one.cutting(plan, "GEAR"),
        "probing": lambda one: probing_program(
            gear_set, "pinion", vertical, probe, "GEAR", (), around=(0, 5), writer=one.probing
        ),
        "tip": lambda one: calibration_program(vertical, probe, "GEAR", one.blocks),
        "axes": lambda one: axis_program(vertical, probe, "GEAR", one.blocks),
    }
    for write in writers.values():
        mine, theirs = write(mill5), write(LINUXCNC)
        assert of_text(mine) is mill5
        assert mill5.block_count(mine) == LINUXCNC.block_count(theirs)
        assert mine.startswith("%\n")
        assert mine.endswith(" M30\n%\n")
        changed = unlike(mine, theirs)
        assert {one for one, _ in changed} <= {"; control: Mill 5", "M30", *(f"G43 H{k}" for k in (1, 2, 99))}
        assert ("; control: Mill 5", "; control: LinuxCNC") in changed


def test_commands_judge_a_program_of_a_new_dialect_and_write_its_sheet(
    command: Callable, mill5: ControlDialect, tmp_path: Path
) -> None:
    for name, arguments in {"CUT": CUT, "TIP": ("nc", "calibrate")}.items():
        program, sheet = tmp_path / f"{name}.nc", tmp_path / f"{name}.html"
        status, _, err = command(*arguments, "--control", "mill5", "-o", program, "--sheet", sheet)
        assert status == 0, err
        assert of_text(program.read_text("ascii")) is mill5
        assert f"{name}.nc" in sheet.read_text("utf-8")


def test_program_of_a_new_dialect_is_read_as_the_same_motion(
    command: Callable, mill5: ControlDialect, tmp_path: Path
) -> None:
    """In its own lines: one of % before them, as many as in the file."""
    machine, paths = load_milling_machine(bundled("vertical_5axis.toml")), []
    for control, file in (("mill5", tmp_path / "CUT.nc"), ("linuxcnc", tmp_path / "CUT.ngc")):
        assert command(*CUT, "--control", control, "-o", file)[0] == 0
        paths.append(execute(program_text(file), file.name, Setup.of(machine)))
    mine, theirs = paths
    np.testing.assert_array_equal(mine.axes, theirs.axes)
    np.testing.assert_array_equal(mine.seconds, theirs.seconds)
    np.testing.assert_array_equal(mine.line, theirs.line + 1)
    status, out, _ = command("nc", "time", tmp_path / "CUT.nc", "--json")
    assert (status, json.loads(out)["control"]) == (0, "linuxcnc")


def test_settings_file_of_gm_post_has_the_words_of_a_new_dialect(
    gear_set: BevelSet, vertical: MillingMachine, mill5: ControlDialect
) -> None:
    plan = cutting_plan(gear_set, "pinion", vertical, CuttingJob((0,), tolerance=2e-3))
    lines = post_file(plan, mill5).splitlines()
    assert lines.count("c %") == 2
    assert "n G43 H1" in lines
    assert any(re.fullmatch(r"b G1 X\{X\} Y\{Y\} Z\{Z\} A\{A\} B\{B\} F\{F\}", line) for line in lines)


def test_control_that_nobody_registered_is_refused_with_those_that_are_known(refused: Callable, tmp_path: Path) -> None:
    refused("'mill5' is not one of 'sinumerik', 'linuxcnc'", *CUT, "--control", "mill5", "-o", tmp_path / "CUT.nc")


def test_machine_file_names_a_registered_control(command: Callable, mill5: ControlDialect, tmp_path: Path) -> None:
    machine = tmp_path / "machine.toml"
    text = bundled("vertical_5axis.toml").read_text("utf-8")
    machine.write_text(re.sub(r"^\[control\]", '[control]\nkind = "mill5"', text, flags=re.MULTILINE), "utf-8")
    assert command(*CUT, "--machine", machine, "-o", tmp_path / "CUT.nc")[0] == 0
    assert "; control: Mill 5\n" in (tmp_path / "CUT.nc").read_text("ascii")


def test_dialect_that_cannot_be_read_back_or_has_the_name_of_another_is_not_registered() -> None:
    for wrong, words in (
        (replace(SINUMERIK, name="other"), "so that they are judged"),
        (replace(LINUXCNC, mark="; x", as_read=str), "is registered already"),
    ):
        with pytest.raises(ValueError, match=words):
            register(wrong)
    assert [one.name for one in known()] == ["sinumerik", "linuxcnc"]

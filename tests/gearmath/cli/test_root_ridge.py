"""A ridge that the stated point widths of a set leave is said before and after the cut, and is no fault."""

from __future__ import annotations

import re

from gearmath.specs.toml import bundled

RIDGE = re.compile(r"the root: a ridge of up to ([\d.]+) um stays between the cuts of both flanks")


def test_program_and_mill_say_the_ridge_of_stated_point_widths(command, tmp_path, host_compiler) -> None:
    narrow, program = tmp_path / "narrow.toml", tmp_path / "CUT.MPF"
    text = bundled("spiral_7x43.toml").read_text(encoding="utf-8")
    for radius, width in (("114.85", 1.115), ("113.7", 1.145)):
        text = text.replace(
            f"blade_point_radius = {radius}\n", f"blade_point_radius = {radius}\nblade_point_width = {width}\n"
        )
    narrow.write_text(text, encoding="utf-8")
    assert command("nc", "cut", narrow, "--member", "pinion", "--spaces", "0", "-o", program)[0] == 0
    (said,) = RIDGE.findall(program.read_text(encoding="ascii").replace("\n; ", " "))
    status, out, err = command("mill", narrow, "--program", program, "-o", tmp_path / "cut.csv")
    assert status == 0, err
    assert RIDGE.findall(out) == [said]
    assert 40.0 < float(said) < 50.0  # the height itself is tested in bevel/tooth/test_ridge.py

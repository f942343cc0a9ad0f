"""Drive trains that people have, each through plan, simulate and export: pulleys, change gears, worms, few teeth."""

from __future__ import annotations

import json
import re
from fractions import Fraction
from pathlib import Path

import pytest

from gearmath.cli import main
from gearmath.specs.toml import bundled

#: An inch, and pi as worms are cut with it.
INCH, PI = Fraction(254, 10), Fraction(355, 113)
SCREW = 4800 * 8 / INCH  # steps per mm of the example lathe

#: name -> base file, keys to change, job, steps per count worked out by hand
CASES = {
    "encoder on other pulleys": (
        "hobbing_plewes",
        {"lines": '1024\nbelt = "20/17"', "hob_rpm": "300.0"},
        ("--teeth", "53"),
        Fraction(16000 * 17, 53 * 4096 * 20),
    ),
    "4444.44 counts": (
        "hobbing_plewes",
        {"lines": '1000\nbelt = "10/9"', "hob_rpm": "300.0"},
        ("--teeth", "127"),
        Fraction(16000 * 9, 127 * 40_000),
    ),
    "gears 120:127 on the motor": (
        "hobbing_plewes",
        {"belt": '"127/120"', "worm": "3", "hob_rpm": "300.0"},
        ("--teeth", "24"),
        Fraction(800 * 127 * 3, 120 * 24 * 4096),
    ),
    "belt 20/17 and worm 90": (
        "hobbing_plewes",
        {"belt": '"20/17"', "worm": "90", "hob_rpm": "300.0"},
        ("--teeth", "60"),
        Fraction(800 * 20 * 90, 17 * 60 * 4096),
    ),
    "two teeth": ("hobbing_plewes", {"hob_rpm": "150.0"}, ("--teeth", "2"), Fraction(16000, 2 * 4096)),
    "five teeth": ("hobbing_plewes", {"hob_rpm": "300.0"}, ("--teeth", "5"), Fraction(16000, 5 * 4096)),
    "worm of module 1.5": ("lathe_example", {}, ("--pitch", "1.5m"), SCREW * PI * Fraction(3, 2) / 4000),
    "worm of 16 DP": ("lathe_example", {}, ("--pitch", "16dp"), SCREW * PI * INCH / 16 / 4000),
}


def _machine(folder: Path, base: str, changes: dict[str, str]) -> str:
    text = bundled(f"{base}.toml").read_text("utf-8")
    for key, value in changes.items():
        text, found = re.subn(rf"^{key} = .*$", f"{key} = {value}", text, count=1, flags=re.MULTILINE)
        assert found
    path = folder / "machine.toml"
    path.write_text(text, "utf-8")
    return str(path)


def _ran(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    try:
        main(arguments)
    except SystemExit as stop:
        if stop.code:
            raise AssertionError(capsys.readouterr().err) from stop
    return capsys.readouterr().out


@pytest.mark.parametrize("name", list(CASES))
def test_train_is_exact_in_plan_simulation_and_export(name: str, tmp_path: Path, capsys) -> None:
    base, changes, job, exact = CASES[name]
    path = _machine(tmp_path, base, changes)
    plan = json.loads(_ran(capsys, "gearbox", "plan", path, *job, "--json"))
    assert Fraction(plan["steps_numerator"], plan["steps_denominator"]) == exact
    run = ("--pattern", "reversals", "--edges", "300000", "--json")
    result = json.loads(_ran(capsys, "gearbox", "simulate", path, *job, *run))
    assert Fraction(result["worst_error_exact"]) <= Fraction(1, 2)
    assert abs(result["position"] - exact * result["encoder_position"]) <= Fraction(1, 2)
    _ran(capsys, "export", "teensy", path, "-o", str(tmp_path / "sketch"))
    header = (tmp_path / "sketch" / "gm_machine.h").read_text("utf-8")
    macros = {key: int(value) for key, value in re.findall(r"^#define (GM_\w+) (-?\d+)", header, flags=re.MULTILINE)}
    counts = Fraction(macros["GM_TURN_COUNTS"], macros["GM_TURN_COUNTS_DEN"])
    if base == "lathe_example":
        assert Fraction(macros["GM_SCREW_STEPS_NUM"], macros["GM_SCREW_STEPS_DEN"]) == SCREW
        assert counts == 4000
    else:
        steps = Fraction(macros["GM_MOTOR_STEPS"], macros["GM_MOTOR_STEPS_DEN"])
        assert steps / (int(job[1]) * counts) == exact

"""What is wrong with an option is said before any work is done."""

from __future__ import annotations

from pathlib import Path

import pytest

NASA = "nasa_tp3096_12x36.toml"
WRONG = {
    "folder of the program": (
        ("nc", "cut", NASA, "--member", "pinion", "-o", "{}/absent/P.MPF"),
        r"P\.MPF: cannot be written: there is no folder .*absent",
    ),
    "folder of the report": (
        ("mill", NASA, "--program", "P.MPF", "-o", "{}/m.csv", "--report", "{}/absent/r.json"),
        r"r\.json: cannot be written: there is no folder .*absent",
    ),
    "folder of the picture": (
        ("evaluate", "m.csv", "--set", NASA, "--plot", "{}/absent/p.png"),
        r"p\.png: cannot be written: there is no folder .*absent",
    ),
    "name of the program": (
        ("nc", "cut", NASA, "--member", "pinion", "-o", "{}/1-bad name.MPF"),
        r"name '1-bad name': must be letters",
    ),
}


CUT = ("nc", "cut", NASA, "--member", "pinion", "-o", "{}/PART.MPF")
CSV = ("--set", NASA, "-o", "{}/out.html")
for number in ("nan", "-1", "1e9"):
    for options, sentence in {
        (*CUT, "--tolerance-um"): "tolerance = .* um: must lie between 0.01 and 100 um",
        (*CUT, "--roughing-stock"): "roughing_stock = .* mm: must lie between 0 and 5 mm",
        (*CUT, "--rpm"): "spindle speed = .* rpm: .* has 20 to 3000 rpm",
        (
            "flank",
            NASA,
            "--member",
            "gear",
            "--flank",
            "convex",
            "-o",
            "{}/f.csv",
            "--margin-toe",
        ): "--margin-toe .*: must be",
        (
            "mill",
            NASA,
            "--program",
            "P.MPF",
            "-o",
            "{}/m.csv",
            "--report-tolerance-um",
        ): "--report-tolerance-um = .*: must lie between 0.01 and 1000 um",
        (
            "compensate",
            NASA,
            "--measured",
            "m.csv",
            "-o",
            "{}/n.toml",
            "--root-limit",
        ): "--root-limit = .*: must lie between 0.001 and 2 mm",
        ("compensate", NASA, "--measured", "m.csv", "-o", "{}/n.toml", "--noise"): "--noise = .* between 0 and 100 um",
        ("stock", "m.csv", "--set", NASA, "--least"): "--least = .*: must lie between 0 and 2000 um",
        ("report", "m.csv", *CSV, "--sigma-um"): "--sigma-um = .*: must be greater than 0 and at most 1000 um",
        ("evaluate", "m.csv", "--set", NASA, "--sigma-um"): "--sigma-um = .*: must be greater than 0 and at most 1000",
        ("uncertainty", "m.csv", "--set", NASA, "--sigma-um"): "--sigma-um = .*: must be greater than 0 and at most",
    }.items():
        WRONG[f"{options[0]} {options[-1]} {number}"] = ((*options, number), sentence)
WRONG |= {
    "no feed": ((*CUT, "--feed", "0"), "feed = 0.0 mm/min: must be greater than 0"),
    "finishing more than roughing": (
        (*CUT, "--roughing-stock", "0.1", "--finishing-stock", "0.2"),
        "roughing_stock = 0.1 mm: must be more than",
    ),
    "thickness": (
        ("compensate", NASA, "--measured", "m.csv", "-o", "{}/n.toml", "--thickness", "-501"),
        "--thickness = -501: must lie between -500 and 500 um",
    ),
    "grid": (
        ("flank", NASA, "--member", "gear", "--flank", "convex", "-o", "{}/f.csv", "--grid", "5x"),
        "--grid 5x: must read",
    ),
    "two sources": (
        ("uncertainty", "m.csv", "--set", NASA, "--sigma-um", "1", "--model", "m.toml"),
        "--sigma-um and --model: only one",
    ),
    "part numbers": (
        ("report", "m.csv", *CSV, "--part-number", "1", "--part-number", "2"),
        "--part-number: given 2 times, for 1 meas",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_option_is_refused_before_the_set_is_read(tmp_path: Path, refused, monkeypatch, case: str) -> None:
    def read(*_: object) -> None:
        raise AssertionError("work was done")

    for name in ("sets.load_set", "measured.load_measurement", "measured.measurement_of"):
        monkeypatch.setattr(f"gearmath.front.{name}", read)
    arguments, sentence = WRONG[case]
    refused(sentence, *(argument.format(tmp_path) for argument in arguments))
    assert list(tmp_path.iterdir()) == []

"""What is wrong with an option is said before any work is done."""

from __future__ import annotations

from pathlib import Path

import pytest

NASA = "nasa_tp3096_12x36.toml"
WRONG = {
    "folder of the program": (
        ("nc", "cut", NASA, "--member", "pinion", "-o", "{}/absent/P.MPF"), r"P\.MPF: cannot be written: No such file",
    ),
    "folder of the report": (
        ("mill", NASA, "--program", "P.MPF", "-o", "{}/m.csv", "--report", "{}/absent/r.json"),
        r"r\.json: cannot be written: No such file",
    ),
    "folder of the picture": (
        ("evaluate", "m.csv", "--set", NASA, "--plot", "{}/absent/p.png"), r"p\.png: cannot be written: No such file",
    ),
    "name of the program": (
        ("nc", "cut", NASA, "--member", "pinion", "-o", "{}/1-bad name.MPF"), r"name '1-bad name': must be letters",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_wrong_output_is_refused_before_the_set_is_read(tmp_path: Path, refused, monkeypatch, case: str) -> None:
    def read(*_: object) -> None:
        raise AssertionError("work was done")

    monkeypatch.setattr("gearmath.bevel.pair.load_pair", read)
    arguments, sentence = WRONG[case]
    refused(sentence, *(argument.format(tmp_path) for argument in arguments))
    assert list(tmp_path.iterdir()) == []

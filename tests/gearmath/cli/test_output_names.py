"""Names of files to write: a name whose end says another kind is refused before any work is done."""

from __future__ import annotations

from pathlib import Path

import pytest

SET = "spiral_7x43.toml"
CASES = {
    "tooth": (("tooth", SET, "-o"), ".stl"),
    "export stl": (("export", "stl", SET, "-o"), ".stl"),
    "export step": (("export", "step", SET, "-o"), ".step or .stp"),
    "export rexs": (("export", "rexs", SET, "-o"), ".rexs or .xml"),
    "flanks of a hobbed gear": (("gearbox", "cut", "hobbing_plewes.toml", "--teeth", "24", "--stl"), ".stl"),
    "picture": (("gearbox", "simulate", "hobbing_plewes.toml", "--teeth", "24", "--plot"), ".png"),
    "set-up sheet": (("nc", "calibrate", "-o", "CAL.MPF", "--sheet"), ".html or .htm"),
    "summary sheet": (("design", "design_7x43.toml", "-o", "set.toml", "--sheet"), ".html or .htm"),
    "inspection sheet": (("report", "m.csv", "--set", SET, "-o"), ".html or .htm"),
}


@pytest.mark.parametrize("name", list(CASES))
def test_wrong_end_of_a_name_is_refused_in_a_sentence_and_nothing_is_written(
    name: str, command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    arguments, ends = CASES[name]
    status, out, err = command(*arguments, "x.txt")
    assert (status, out) == (2, "")
    assert f"{arguments[-1]} x.txt: the name must end in {ends}" in err
    assert list(tmp_path.iterdir()) == []

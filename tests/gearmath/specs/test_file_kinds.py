"""A file of another kind than the one that is wanted is called what it is, from Python and the command line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import gearmath as gm
from gearmath.specs.file_kinds import kind_of
from gearmath.specs.toml import bundled

SET = "nasa_tp3096_12x36.toml"
#: What the bundled files describe, by the words that a refusal has for it, and what reads them.
KINDS = {
    "vertical_5axis.toml": ("a milling machine", gm.load_machine),
    SET: ("a gear set", gm.load_set),
    "probe.toml": ("a probe", gm.load_probe),
    "simulated_shop.toml": ("a simulated shop", gm.load_shop),
    "hobbing_plewes.toml": ("a hobbing machine or lathe", gm.hobbing.load_hobber),
    "blank_iso23509_sample1.toml": ("a blank", gm.load_blank),
    "design_7x43.toml": ("a pair to be designed", gm.design),
    "measurement.toml": ("the uncertainties of measuring", None),
}
#: A pair is designed from the data of its blank, too, where nothing more is wished.
TAKEN = [("blank_iso23509_sample1.toml", gm.design)]


@pytest.mark.parametrize("name", KINDS)
def test_a_file_of_another_kind_is_called_what_it_is(name: str, command: Callable, tmp_path: Path) -> None:
    described = KINDS[name][0]
    for wanted, load in KINDS.values():
        if load not in (None, KINDS[name][1]) and (name, load) not in TAKEN:
            with pytest.raises(gm.InputError, match=rf"{name}: describes {described}; the file of {wanted} is wanted"):
                load(name)
    if name != SET:
        status, _, said = command("tooth", name, "--member", "pinion", "-o", tmp_path / "tooth.stl")
        assert status == 2
        assert f"describes {described}; the file of a gear set is wanted" in said
    with pytest.raises(gm.InputError, match=f"is no flank file.*; it describes {described}"):
        gm.load_measurement(bundled(name), SET)


def test_a_set_with_a_slip_is_still_told_its_slip(tmp_path: Path) -> None:
    text = bundled(SET).read_text("utf-8").replace("shaft_angle", "shaft_angel", 1)
    (tmp_path / "set.toml").write_text(text)
    with pytest.raises(gm.InputError, match="shaft_angel: no such key; did you mean shaft_angle"):
        gm.load_set(tmp_path / "set.toml")


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("# member: pinion\nmember,flank,tooth,row,col,x\n", "points of flanks"),
        ("run,point,target,X\n1,1,ring,0\n", "raw touches"),
        ('<?xml version="1.0"?>\n', "something in XML, as REXS is"),
        ("; GEAR\nN10 G71 G90\n", "an NC program"),
        ("a = 1\n", None),
        ("", None),
        ("one, two\n", None),
    ],
)
def test_a_text_is_told_by_its_first_lines(text: str, kind: str | None) -> None:
    assert kind_of(text) == kind


def test_touches_and_points_are_not_taken_for_each_other_or_for_a_set(tmp_path: Path) -> None:
    points = gm.load_set(SET).pinion.deviations((2, 2)).to_csv(tmp_path / "points.csv")
    with pytest.raises(gm.InputError, match=r"points\.csv: holds no touch; it describes points of flanks"):
        gm.Measurement.from_touches(points, SET)
    with pytest.raises(gm.InputError, match=r"points\.csv: is no TOML: it describes points of flanks; the file"):
        gm.load_set(points)

"""A gear without its mate: every verb that needs no mate takes it, the others say what they lack."""

from __future__ import annotations

import re

import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, BevelSet, design_sha256, load_bevel_set
from gearmath.specs.flank_csv import join, write_flank_csv
from gearmath.specs.set_text import save_corrected, set_text
from gearmath.specs.toml import bundled, parse

SET = bundled("nasa_tp3096_12x36.toml")
TEXT = SET.read_text("utf-8")
ALONE = {
    "pinion": TEXT[: TEXT.index("[gear]")],
    "gear": TEXT[: TEXT.index("[pinion]")] + TEXT[TEXT.index("[gear]") :],
}


@pytest.fixture(params=ALONE)
def alone(request, tmp_path):
    path = tmp_path / "alone.toml"
    path.write_text(ALONE[request.param], "utf-8")
    return request.param, path


def test_member_alone_is_that_of_the_pair(alone, gear_set, tmp_path):
    name, path = alone
    ours = load_bevel_set(path)
    assert ours.members == {name: gear_set.member(name)}
    assert parse(set_text(ours), BevelSet, "text").member(name).teeth == gear_set.member(name).teeth
    settings = {flank: ours.member(name).flank(flank).vector for flank in FLANKS}
    save_corrected(path, tmp_path / "new.toml", name, settings)
    assert design_sha256(load_bevel_set(tmp_path / "new.toml").member(name)) == design_sha256(gear_set.member(name))


def test_absent_member_is_refused_by_name(alone):
    name, path = alone
    absent = "gear" if name == "pinion" else "pinion"
    with pytest.raises(InputError, match=rf"alone\.toml: has no {absent}, only a {name}$"):
        load_bevel_set(path).member(absent)


def test_set_with_neither_is_refused():
    with pytest.raises(InputError, match=r"^set\.toml: holds neither a pinion nor a gear$"):
        parse(TEXT[: TEXT.index("[pinion]")], BevelSet, "set.toml")


def test_flank_and_tooth_and_program_need_no_mate(alone, command, refused, tmp_path):
    name, path = alone
    absent = "gear" if name == "pinion" else "pinion"
    assert command("flank", path, "--member", name, "--flank", "convex", "-o", tmp_path / "f.csv")[0] == 0
    of_pair = tmp_path / "pair.csv"
    assert command("flank", SET.name, "--member", name, "--flank", "convex", "-o", of_pair)[0] == 0
    assert (tmp_path / "f.csv").read_text() == of_pair.read_text()
    assert command("tooth", path, "--member", name, "--columns", 5, "--space", "-o", tmp_path / "t.stl")[0] == 0
    sentence = rf"alone\.toml: has no {absent}, only a {name}"
    refused(sentence, "flank", path, "--member", absent, "--flank", "convex", "-o", tmp_path / "g.csv")
    refused(sentence, "tooth", path, "--member", absent, "-o", tmp_path / "g.stl")
    refused(sentence, "nc", "cut", path, "--member", absent, "-o", tmp_path / "GEAR.MPF")
    assert not list(tmp_path.glob("[gG].*"))


def test_correction_by_the_mate_says_that_there_is_none(alone, refused, tmp_path, gear_set):
    name, path = alone
    absent = "gear" if name == "pinion" else "pinion"
    measured = tmp_path / "m.csv"
    member = gear_set.member(name)
    write_flank_csv(measured, join([nominal_flank(member, flank, blank_grid(member)) for flank in FLANKS]))
    refused(
        rf"--from-mate: .*alone\.toml: has no {absent}",
        "compensate",
        path,
        "--member",
        name,
        "--measured",
        measured,
        "--from-mate",
        measured,
        "-o",
        tmp_path / "new.toml",
    )


def test_hands_are_compared_only_where_there_are_two():
    other = re.sub(r'hand = "left"', 'hand = "right"', ALONE["pinion"])
    assert parse(other, BevelSet, "set.toml").member("pinion").hand == "right"


@pytest.mark.parametrize(
    ("key", "value", "sentence"),
    [
        ("shaft_angle = 90.0", "shaft_angle = 80.0", "pinion.blank.pitch_angle = 18.4333: fits no mate, 12 teeth"),
        ("pitch_angle = 18.4333333", "pitch_angle = 18.3333333", "of 36 need 18.435 within 0.02 degree"),
    ],
)
def test_member_that_rolls_on_no_whole_number_of_teeth_is_refused(refused, tmp_path, key, value, sentence):
    text = ALONE["pinion"]
    assert key in text
    path = tmp_path / "alone.toml"
    path.write_text(text.replace(key, value, 1), "utf-8")
    refused(re.escape(sentence), "flank", path, "--flank", "concave", "-o", tmp_path / "f.csv")

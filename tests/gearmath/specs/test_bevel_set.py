"""The gear set: the bundled one, refusals by file, key, value and limit, and corrected sets that keep their design."""

from __future__ import annotations

import copy
import math
import pickle
import tomllib

import numpy as np
import pytest

from gearmath.errors import InputError
from gearmath.specs.bevel_set import (
    FLANKS,
    MACHINE_SETTINGS,
    MEMBERS,
    SETTINGS,
    BevelSet,
    Member,
    design_sha256,
    load_bevel_set,
    settings_sha256,
)
from gearmath.specs.set_text import save_corrected
from gearmath.specs.toml import bundled, checked, parse

SET = bundled("nasa_tp3096_12x36.toml")
TEXT = SET.read_text("utf-8")


def section(name: str) -> tuple[int, int]:
    """Where a table of the file begins and ends."""
    begin = TEXT.index(f"[{name}]\n")
    end = TEXT.find("\n[", begin)
    return begin, len(TEXT) if end < 0 else end


def changed(table: str, old: str, new: str) -> str:
    """The text with one line of one table changed."""
    begin, end = section(table)
    assert old in TEXT[begin:end]
    return TEXT[:begin] + TEXT[begin:end].replace(old, new, 1) + TEXT[end:]


def test_bundled_set_is_the_published_pair(gear_set):
    assert (gear_set.pinion.teeth, gear_set.gear.teeth) == (12, 36)
    assert (gear_set.pinion.hand, gear_set.gear.hand) == ("left", "right")
    assert gear_set.shaft_angle == 90
    # atan(12/36) to the printed digits, and the two pitch angles make the shaft angle
    assert gear_set.pinion.blank.pitch_angle == pytest.approx(math.degrees(math.atan2(12, 36)), abs=2e-3)
    assert gear_set.pinion.blank.pitch_angle + gear_set.gear.blank.pitch_angle == pytest.approx(90, abs=2e-7)
    # diametral pitch 5.141 at the heel: 36 / (2 * 5.141 * sin 71.5666°) in less half the face is 81.05 mm
    assert 36 / (2 * 5.141 * math.sin(math.radians(71.5666))) * 25.4 - 12.7 == pytest.approx(81.05, abs=0.01)


@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_tips_leave_their_clearance_in_the_root_of_the_mate(gear_set, member):
    """At the mean cone distance: addendum and clearance make the dedendum of the mate, measured along its root."""
    mine, mate = (gear_set.member(name).blank for name in (member, {"pinion": "gear", "gear": "pinion"}[member]))
    assert mine.mean_addendum + mate.clearance == pytest.approx(mate.mean_dedendum, abs=0.05)
    assert math.degrees(math.atan2(mine.mean_dedendum, mine.mean_cone_distance)) == pytest.approx(
        mine.pitch_angle - mine.root_angle, abs=1e-3
    )


def test_vectors_are_in_mm_and_rad_in_the_order_of_the_notation(gear_set):
    vector = dict(zip(SETTINGS, gear_set.pinion.convex.vector, strict=True))
    assert vector["radial_distance"] == 71.146656284
    assert vector["work_rotation_offset"] == pytest.approx(math.pi / 6, rel=1e-15)
    assert vector["cradle_angle"] == pytest.approx(-53.9259945467 * math.pi / 180, rel=1e-15)
    assert vector["ratio_of_roll"] == 3.1051768074384
    assert gear_set.gear.blank.vector == pytest.approx(
        [*np.radians([71.5666666, 73.1333332, 67.6833332667]), 81.0514, 25.4, 1.454495815568, 5.501844113793, 0.92964],
        rel=1e-15,
    )


@pytest.mark.parametrize(
    ("table", "old", "new", "sentence"),
    [
        (
            "pinion.concave",
            "radial_distance = 74.874171554126\n",
            "",
            "pinion.concave.radial_distance: the key is missing",
        ),
        ("pinion.concave", "cutter_tilt = 0.0", "tilt = 0.0", r"pinion\.concave\.tilt = 0\.0: no such key"),
        ("pinion.concave", "cutter_tilt = 0.0", "cutter_tilt = 0.0\ntool = 1", "pinion.concave.tool = 1: no such key"),
        ("gear.convex", "= 22.0", "= 95.0", "gear.convex.blade_pressure_angle = 95.0: must be at most"),
        ("gear.convex", "= 22.0", "= nan", "gear.convex.blade_pressure_angle = nan: must be a finite number"),
        ("gear.convex", "= 22.0", '= "22"', "gear.convex.blade_pressure_angle = '22': must be a number"),
        ("gear.convex", "= 75.3745", "= -75.3745", "gear.convex.blade_point_radius = -75.3745: must be greater"),
        ("gear.convex", "= 72.642731191514", "= inf", "gear.convex.radial_distance = inf: must be a finite number"),
        ("gear.convex", "= 1.0516744445003", "= 0.0", "gear.convex.ratio_of_roll = 0.0: must be greater than 0.1"),
        ("gear.concave", "= 12.0", "= 0.0", "gear.concave.blade_profile_height = 0.0: must be greater than 0"),
        ("pinion", "teeth = 12", "teeth = 2", "pinion.teeth = 2: must be at least 3"),
        ("pinion", "teeth = 12", "teeth = 12.0", "pinion.teeth = 12.0: must be a whole number"),
        ("pinion", '"left"', '"both"', "pinion.hand = 'both': must be 'left' or 'right'"),
        ("gear", '"completing"', '"shaping"', "gear.cutting = 'shaping': must be"),
        ("gear", "teeth = 36", "teeth = 36\nindex_correction = [0.0, 0.1]", "gear: index_correction has 2 values"),
        ("pinion", "teeth = 12", f"teeth = 12\nindex_correction = {[0.0] * 11 + [1.5]}", "pinion: .* between -1 and 1"),
        ("pinion", "teeth = 12", f"teeth = 12\nindex_correction = {[0.2, -0.2] * 6}", "pinion: .* 11 and 0 differ"),
        ("pinion.blank", "root_angle = 16.86666664", "root_angle = 20.0", "pinion.blank: root_angle 20.0 <= pitch_a"),
        ("pinion.blank", "face_angle = 22.3166667", "face_angle = 18.0", "pinion.blank: root_angle .* <= face_angle"),
        ("pinion.blank", "face_width = 25.4", "face_width = 81.06", "pinion.blank: face_width 81.06 must be less than"),
        ("pinion.blank", "clearance = 0.762", "clearance = 2.3", "pinion.blank: clearance 2.3 must be less than mean"),
        ("gear.convex", "sliding_base = 0.0", "sliding_base = 0.5", "gear: a completing cut has one sliding_base"),
    ],
)
def test_fault_is_refused_by_file_key_value_and_limit(table, old, new, sentence):
    with pytest.raises(InputError, match=r"^set\.toml: " + sentence):
        parse(changed(table, old, new), BevelSet, "set.toml")


@pytest.mark.parametrize("name", MACHINE_SETTINGS)
def test_every_machine_setting_of_a_completing_cut_is_one_for_both_flanks(gear_set, name):
    convex = gear_set.gear.convex.model_dump(exclude_none=True)
    other = {**convex, name: convex[name] + 0.125}
    values = gear_set.gear.model_dump(exclude_none=True) | {"convex": other}
    with pytest.raises(ValueError, match=f"a completing cut has one {name} for both flanks, not two"):
        type(gear_set.gear).model_validate(values)


def test_text_that_is_no_toml_is_refused_by_name():
    with pytest.raises(InputError, match=r"^set\.toml: is no TOML: "):
        parse("[pinion\n", BevelSet, "set.toml")


def test_unknown_member_is_refused(gear_set):
    with pytest.raises(InputError, match=r"^member = 'Pinion': must be pinion or gear$"):
        gear_set.member("Pinion")


@pytest.fixture
def new_settings(gear_set) -> dict[str, np.ndarray]:
    """The pinion's settings with some corrected."""
    settings = {flank: gear_set.pinion.flank(flank).vector.copy() for flank in FLANKS}
    settings["concave"][SETTINGS.index("radial_distance")] += 0.0171
    settings["convex"][SETTINGS.index("cradle_angle")] += math.radians(0.0123)
    return settings


def test_corrected_set_holds_the_new_settings_and_the_old_ones_as_design(gear_set, new_settings, tmp_path):
    save_corrected(SET, tmp_path / "new.toml", "pinion", new_settings)
    new = load_bevel_set(tmp_path / "new.toml")
    for flank in FLANKS:
        np.testing.assert_allclose(new.pinion.flank(flank).vector, new_settings[flank], rtol=0, atol=1e-9)
        np.testing.assert_array_equal(new.pinion.flank(flank).nominal.vector, gear_set.pinion.flank(flank).vector)
    assert new.pinion.convex.cradle_angle == pytest.approx(-53.9259945467 + 0.0123, abs=1e-9)
    assert new.pinion.concave.blade_profile_height == 12.0
    assert new.gear == gear_set.gear
    assert design_sha256(new.pinion) == design_sha256(gear_set.pinion)
    assert settings_sha256(new.pinion) != settings_sha256(gear_set.pinion)


def test_comments_and_everything_else_stay_as_they_are(new_settings, tmp_path):
    save_corrected(SET, tmp_path / "new.toml", "pinion", new_settings)
    text = (tmp_path / "new.toml").read_text("utf-8")
    comments = [line.partition("#")[2] for line in TEXT.splitlines() if "#" in line]
    assert comments
    kept = iter(line.partition("#")[2] for line in text.splitlines() if "#" in line)
    assert all(comment in kept for comment in comments)  # in their order
    old, new = tomllib.loads(TEXT), tomllib.loads(text)
    for flank in FLANKS:
        new["pinion"][flank].pop("design")
        for name in SETTINGS:
            new["pinion"][flank][name] = pytest.approx(old["pinion"][flank][name], abs=0.02)
    assert new == old


def test_second_correction_keeps_the_first_design(gear_set, new_settings, tmp_path):
    save_corrected(SET, tmp_path / "one.toml", "pinion", new_settings)
    twice = {flank: vector + 1e-4 for flank, vector in new_settings.items()}
    save_corrected(tmp_path / "one.toml", tmp_path / "two.toml", "pinion", twice)
    two = load_bevel_set(tmp_path / "two.toml")
    for flank in FLANKS:
        np.testing.assert_array_equal(two.pinion.flank(flank).nominal.vector, gear_set.pinion.flank(flank).vector)
        np.testing.assert_allclose(two.pinion.flank(flank).vector, twice[flank], rtol=0, atol=1e-9)
    assert (tmp_path / "two.toml").read_text().count("design") == 2


def test_index_correction_is_written_in_degrees_and_replaced_the_next_time(new_settings, tmp_path):
    first, second = np.radians(np.linspace(0, 0.0123, 12)), np.radians(np.linspace(0, -0.02, 12))
    save_corrected(SET, tmp_path / "one.toml", "pinion", new_settings, first)
    save_corrected(tmp_path / "one.toml", tmp_path / "two.toml", "pinion", new_settings, second)
    for name, angles in (("one", first), ("two", second)):
        written = load_bevel_set(tmp_path / f"{name}.toml").pinion.index_correction
        np.testing.assert_allclose(written, np.degrees(angles), rtol=0, atol=5.1e-8)


def test_correction_that_is_no_valid_set_is_refused_before_anything_is_written(gear_set, tmp_path):
    settings = {flank: gear_set.gear.flank(flank).vector.copy() for flank in FLANKS}
    settings["concave"][SETTINGS.index("sliding_base")] += 0.1  # of the completing gear, on one flank only
    with pytest.raises(InputError, match=r"new\.toml: gear: a completing cut has one sliding_base"):
        save_corrected(SET, tmp_path / "new.toml", "gear", settings)
    huge = np.full(36, math.radians(2.0))
    with pytest.raises(InputError, match=r"new\.toml: gear: index_correction must lie between -1 and 1"):
        save_corrected(SET, tmp_path / "new.toml", "gear", {}, huge)
    assert list(tmp_path.iterdir()) == []


def test_design_of_one_flank_does_not_give_a_completing_cut_a_second_machine():
    """The design of the concave flank alone, 0.2 mm further out than the settings of both."""
    values = tomllib.loads(bundled("nasa_tp3096_12x36.toml").read_text("utf-8"))
    concave = values["gear"]["concave"]
    concave["design"] = {key: concave[key] for key in SETTINGS} | {"radial_distance": concave["radial_distance"] + 0.2}
    with pytest.raises(InputError, match="gear: design: a completing cut has one radial_distance for both flanks"):
        checked(values, BevelSet, "set")


def test_members_of_a_set_know_which_one_they_are(gear_set):
    for name in MEMBERS:
        member = gear_set.member(name)
        copies = member.model_copy(update={"blank": member.blank}), copy.copy(member), copy.deepcopy(member)
        for same in (member, *copies, pickle.loads(pickle.dumps(gear_set)).member(name)):
            assert (same.name, same) == (name, member)


def test_name_of_a_member_stands_in_no_file_and_no_digest(gear_set):
    pinion = gear_set.pinion
    assert "name" not in {*pinion.model_dump(), *Member.keys(), *Member.model_json_schema()["properties"]}
    assert "name" not in repr(pinion) + pinion.model_dump_json()
    gear = pinion.named("gear")
    assert design_sha256(gear) == design_sha256(pinion)
    assert settings_sha256(gear) == settings_sha256(pinion)
    with pytest.raises(InputError, match=r"set: pinion\.name = 'pinion': no such key"):
        parse(changed("pinion", "[pinion]\n", '[pinion]\nname = "pinion"\n'), BevelSet, "set")


def test_member_that_was_in_no_set_has_no_name_until_it_is_given_one(gear_set):
    bare = Member.model_validate(gear_set.pinion.model_dump())
    with pytest.raises(LookupError, match="named"):
        bare.name  # noqa: B018
    assert bare.named("pinion") == gear_set.pinion
    values = {"title": "one", "source": "", "shaft_angle": 90.0}
    assert BevelSet(**values, gear=bare).gear.name == "gear"
    assert BevelSet(**values, pinion=bare.named("gear")).pinion.name == "pinion"
    with pytest.raises(LookupError, match="named"):  # a set leaves the one that it was made of as it was
        bare.name  # noqa: B018

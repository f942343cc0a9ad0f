"""A set file that is no physical pair is refused, by file, member, flank, key, value and limit, and by every way in."""

from __future__ import annotations

import ast
import itertools
import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
import tomlkit

import gearmath
from gearmath.bevel.check_flank import cut_flank
from gearmath.bevel.method import nominal_cut
from gearmath.bevel.pair import check_pair, load_pair
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, MEMBERS, SETTINGS, BevelSet, load_bevel_set
from gearmath.specs.set_text import save_corrected
from gearmath.specs.toml import bundled, checked

NASA, FORMATE, HOBBED = "nasa_tp3096_12x36", "crown_gear_formate_14x39", "crown_gear_hobbed_14x39"
UNIVERSAL, STEEP = "crown_gear_universal_14x39", "spiral_7x43"
BUNDLED = (NASA, STEEP, FORMATE, UNIVERSAL, HOBBED)


def changed(name: str, changes: dict[str, object]) -> dict:
    """The values of a bundled set with others at dotted places; None leaves the key out."""
    values = tomllib.loads(bundled(f"{name}.toml").read_text("utf-8"))
    for place, value in changes.items():
        *tables, key = place.split(".")
        table = values
        for part in tables:
            table = table.setdefault(part, {})
        table[key] = value
        if value is None:
            del table[key]
    return values


def scaled(name: str, table: str, keys: tuple[str, ...], factor: float) -> dict[str, object]:
    """Some keys of a table times a factor, as changes."""
    values = tomllib.loads(bundled(f"{name}.toml").read_text("utf-8"))
    for part in table.split("."):
        values = values[part]
    return {f"{table}.{key}": values[key] * factor for key in keys}


BLANK_LENGTHS = ("mean_cone_distance", "face_width", "mean_addendum", "mean_dedendum", "clearance")
FLANK_LENGTHS = (
    "radial_distance",
    "blank_offset",
    "sliding_base",
    "machine_center_to_crossing_point",
    "blade_point_radius",
    "blade_profile_height",
)
INCH, RADIAN = 1 / 25.4, math.pi / 180

REFUSED = {
    # 1. teeth, cones, and the figures of the blanks
    "one tooth more": (
        NASA,
        {"pinion.teeth": 13},
        r"pinion\.blank\.pitch_angle = 18\.4333: 13 and 36 teeth .* 19\.855",
    ),
    "teeth of both doubled": (NASA, {"pinion.teeth": 24, "gear.teeth": 72}, r"mean_addendum = 4\.57006, .*teeth = 24"),
    "pinion and gear exchanged": (
        NASA,
        {"pinion.teeth": 36, "gear.teeth": 12},
        r"pinion\.teeth = 36: .* at most gear\.teeth = 12",
    ),
    "another shaft angle": (NASA, {"shaft_angle": 80.0}, r"pitch_angle = 18\.4333: .* shaft_angle = 80 need 17\.2"),
    "pitch angle off by two minutes": (
        NASA,
        {"pinion.blank.pitch_angle": 18.4683},
        r"pinion\.blank\.pitch_angle = 18\.4683: .* 18\.435 within 0\.02",
    ),
    "face width of the cone distance": (
        NASA,
        {"pinion.blank.face_width": 80.0, "gear.blank.face_width": 80.0},
        r"pinion\.blank\.face_width = 80: must lie between 8\.53\d and 34\.3\d mm",
    ),
    "face as thin as a saw": (FORMATE, {"gear.blank.face_width": 2.54}, r"gear\.blank\.face_width = 2\.54: "),
    "cone distance of one member": (
        NASA,
        {"gear.blank.mean_cone_distance": 83.0},
        r"pinion\.blank\.mean_cone_distance = 81\.0514: the gear has 83",
    ),
    "face widths apart": (NASA, {"gear.blank.face_width": 20.0}, r"pinion\.blank\.face_width = 25\.4: the gear has 20"),
    "dedendum without room for the mate": (
        NASA,
        {"pinion.blank.mean_dedendum": 1.5, "pinion.blank.clearance": 0.3},
        r"pinion\.blank\.mean_dedendum = 1\.5: must be the mean_addendum of the gear, 1\.4545, and the own clearance",
    ),
    "clearance in inches": (NASA, {"gear.blank.clearance": 0.929 * INCH}, r"gear\.blank\.clearance = 0\.0365748: must"),
    "no clearance": (NASA, {"gear.blank.clearance": 0.0}, r"gear\.blank\.clearance = 0: must lie between"),
    "addendum of nothing at the toe": (
        STEEP,
        {"pinion.blank.face_angle": 9.246112746 + 19},
        r"pinion\.blank\.face_angle = 28\.2461: .* of -0\.\d+ mm",
    ),
    "root that is not parallel to the tip of the mate": (
        NASA,
        {"pinion.blank.root_angle": 16.0},
        r"pinion\.blank\.root_angle = 16: .* must be 16\.867 within 0\.5",
    ),
    "blank of a larger pair in inches": (
        FORMATE,
        scaled(FORMATE, "gear.blank", BLANK_LENGTHS, INCH),
        r"gear\.blank\.mean_cone_distance = 3\.\d+: ",
    ),
    "blank in radians": (
        FORMATE,
        scaled(FORMATE, "gear.blank", ("pitch_angle", "face_angle", "root_angle"), RADIAN),
        r"gear\.blank\.pitch_angle = 1\.226\d+: ",
    ),
    # 2. the hand
    "hands exchanged": (
        NASA,
        {"pinion.hand": "right", "gear.hand": "left"},
        r"pinion concave flank: hand = 'right' is stated, but .* -35\.25 degrees, which is left hand",
    ),
    "one flank of the other hand": (
        NASA,
        {"pinion.convex.cradle_angle": 53.926, "pinion.convex.blank_offset": 4.42624464},
        r"pinion convex flank: ",
    ),
    # 3. space, tooth, backlash, top land, point width
    "tooth in place of a space": (
        NASA,
        {"pinion.convex.work_rotation_offset": 0.0},
        r"pinion: concave\.work_rotation_offset = 0, convex\.work_rotation_offset = 0 leave a space of -.*by 30 deg",
    ),
    "two spaces and a tooth": (
        NASA,
        {"pinion.convex.work_rotation_offset": 60.0},
        r"a space of 16\.\d+ mm and a tooth of -5\.\d+ .* by 30 deg",
    ),
    "two pitches beside": (
        NASA,
        {"pinion.convex.work_rotation_offset": -30.0},
        r"leave a space of -.*turned by 60 degrees",
    ),
    "work rotation in radians": (
        FORMATE,
        {"pinion.concave.work_rotation_offset": 1.926909 * RADIAN},
        r"pinion concave\.work_rotation_offset = 0\.0336309, .* backlash of 1\.0\d+ mm .* between 0 and 0\.471",
    ),
    "too much backlash": (
        NASA,
        {"pinion.convex.work_rotation_offset": 32.0},
        r"pinion concave\.work_rotation_offset = 0, convex\.work_rotation_offset = 32; gear .* backlash of 1\.\d+ mm",
    ),
    "no backlash": (NASA, {"gear.concave.blade_point_radius": 76.8}, r"a transverse backlash of -0\.\d+ mm"),
    "inner blade outside": (
        NASA,
        {"gear.concave.blade_point_radius": 75.3745, "gear.convex.blade_point_radius": 77.0255},
        r"gear\.concave\.blade_point_radius = 75\.3745: one cutter cuts both .* point width would be -1\.651 mm",
    ),
    "point width that is not that of the radii": (
        NASA,
        {"gear.convex.blade_point_width": 2.5},
        r"gear\.convex\.blade_point_width = 2\.5: .* make it 1\.651 mm",
    ),
    "cutter wider than the slot": (
        NASA,
        {"pinion.convex.blade_point_width": 3.3},
        r"pinion\.convex\.blade_point_width = 3\.3: the slot is 3\.2\d mm wide at the toe",
    ),
    "edges wider than the tip": (
        NASA,
        {"gear.convex.blade_edge_radius": 1.4, "gear.concave.blade_edge_radius": 1.4},
        r"gear\.concave\.blade_edge_radius = 1\.4, .* take 1\.89 mm of the tip, the point width is 1\.651 mm",
    ),
    "flanks exchanged": (NASA, {}, r"pinion: concave\.work_rotation_offset = 30, .* a space of -"),
    # 4. blades and what they reach
    "blade that ends below the tip": (
        NASA,
        {"gear.convex.blade_profile_height": 7.0},
        r"gear convex flank: blade_profile_height = 7 does not reach the tip .* must be at least 8\.11",
    ),
    "edge higher than the blade": (
        NASA,
        {"gear.convex.blade_edge_radius": 9.9, "gear.convex.blade_profile_height": 9.0},
        r"gear\.convex\.blade_edge_radius = 9\.9: must be below blade_profile_height = 9",
    ),
    "edge higher than the Toprem": (
        NASA,
        {
            "pinion.convex.blade_edge_radius": 1.5,
            "pinion.convex.toprem_angle": 20.0,
            "pinion.convex.toprem_height": 0.3,
        },
        r"pinion\.convex\.blade_edge_radius = 1\.5: takes away all of the section above it, which ends at 0\.3 mm",
    ),
    "Toprem that leaves metal": (
        NASA,
        {"pinion.convex.toprem_angle": 30.0, "pinion.convex.toprem_height": 0.6},
        r"pinion\.convex\.toprem_angle = 30: must be less than blade_pressure_angle = 24\.3374",
    ),
    "edge that reaches above the clearance": (
        NASA,
        {"pinion.convex.blade_edge_radius": 2.0},
        r"pinion\.convex\.blade_edge_radius = 2: it rounds the blade up to 1\.18 mm, .* at most 1\.62 mm",
    ),
    "edges wider than the slot of a flank cut alone": (
        NASA,
        {f"pinion.{flank}.blade_edge_radius": 1.35 for flank in FLANKS} | {"pinion.convex.work_rotation_offset": 26.0},
        r"pinion\.concave\.blade_edge_radius = 1\.35: the rounded edges of both flanks take 1\.\d+ mm of the slot",
    ),
    "Toprem that digs under the flank": (
        NASA,
        {"pinion.convex.toprem_angle": 0.5, "pinion.convex.toprem_height": 1.0},
        r"pinion\.convex\.toprem_angle = 0\.5: must be at least 12\.34",
    ),
    "Toprem up to the pitch cone": (
        NASA,
        {"pinion.convex.toprem_angle": 20.0, "pinion.convex.toprem_height": 2.5},
        r"pinion\.convex\.toprem_height = 2\.5: must be at most 1\.9\d? mm, 2\.5 of the clearance",
    ),
    "Toprem higher than the blade": (
        NASA,
        {
            "pinion.convex.toprem_angle": 20.0,
            "pinion.convex.toprem_height": 9.5,
            "pinion.convex.blade_profile_height": 9.0,
        },
        r"pinion\.convex\.toprem_height = 9\.5: must be below blade_profile_height = 9",
    ),
    "arc that does not reach up the blade": (
        NASA,
        {"pinion.convex.blade_spheric_radius": -24.0, "pinion.convex.blade_pressure_angle": 33.0},
        r"pinion\.convex\.blade_spheric_radius = -24\.0: such an arc",
    ),
    "modified roll of a Formate flank": (
        FORMATE,
        {f"gear.{flank}.motion": {"modified_roll": [0.02]} for flank in FLANKS},
        r"gear\.concave\.motion\.modified_roll = \[0\.02\]: the cradle stands still in a Formate cut",
    ),
    "motion of a Formate flank": (
        FORMATE,
        {f"gear.{flank}.motion": {"sliding_base": [0.5]} for flank in FLANKS},
        r"gear\.concave\.motion\.sliding_base = \[0\.5\]: the cradle stands still in a Formate cut",
    ),
    "motion in degrees where radians are meant": (
        FORMATE,
        {"pinion.concave.motion": {"work_rotation_offset": [0.97, 63.9]}},
        r"pinion\.concave\.motion\.work_rotation_offset = \[0\.97, 63\.9\]: .* by 7\.786 degrees, .* at most 5 degrees",
    ),
    "motion that bends the flank": (
        NASA,
        {"gear": None, "pinion.concave.motion": {"radial_distance": [0.0, 60.0]}},
        r"pinion\.concave\.motion: it changes the form of the flank by [\d.]+ mm from end to end .* at most 0\.427 mm",
    ),
    "blade offset of a face mill": (
        NASA,
        {"gear.convex.blade_offset_angle": 4.0},
        r"gear\.convex\.blade_offset_angle = 4: belongs to face_hobbing",
    ),
    "machine root angle off": (
        NASA,
        {f"gear.{flank}.machine_root_angle": 66.0 for flank in FLANKS},
        r"gear concave flank: .* gear\.concave\.machine_root_angle = 66: 67\.6\d+ would fit",
    ),
    "sliding base of the wrong sign": (
        HOBBED,
        {f"pinion.{flank}.sliding_base": 3.052650382 for flank in FLANKS},
        r"leaves the root 6\.\d+ mm above .* pinion\.concave\.sliding_base = 3\.05265: -3\.05\d+ would fit",
    ),
    "pressure angles exchanged with the mate's": (
        NASA,
        {"gear.concave.blade_pressure_angle": 12.0},
        r"concave differ by \+9\.46 degrees, .* at most 1\.1.*gear\.concave\.blade_pressure_angle = 12: 21\.\d+ would",
    ),
    "opposite pressure angles of the flanks": (
        FORMATE,
        {"gear.concave.blade_pressure_angle": 14.0, "gear.convex.blade_pressure_angle": 26.0},
        r"pressure angle .* pinion concave and gear convex differ by -2\.\d+ degrees, which must be at most 1\.1;",
    ),
    "opposite spiral angles of the flanks": (
        NASA,
        {
            "pinion.concave.radial_distance": 73.374171554126,
            "pinion.convex.radial_distance": 72.646656284,
            "pinion.convex.work_rotation_offset": 28.0,
        },
        r"spiral angle .* differ by -1\.24 degrees on the first and .* the other way .* between -0\.5 and 0\.757",
    ),
    "opposite radial distances, thickness kept": (
        NASA,
        {
            "pinion.concave.radial_distance": 76.374171554126,
            "pinion.convex.radial_distance": 69.646656284,
            "pinion.convex.work_rotation_offset": 33.4,
        },
        r"spiral angle .* differ by \+1\.23 degrees on the first and .* the other way .* between -0\.5 and 0\.757",
    ),
    "edges wider than the tip of a cutter for one flank": (
        NASA,
        {
            f"pinion.{flank}.{key}": value
            for flank in FLANKS
            for key, value in (("blade_edge_radius", 1.3), ("blade_point_width", 0.5))
        },
        r"pinion\.concave\.blade_edge_radius = 1\.3: .* both sides take 1\.89 mm of the tip, blade_point_width = 0\.5",
    ),
    "pitch apex beyond the crossing point": (
        NASA,
        {"gear.blank.pitch_apex_beyond_crossing_point": 1.0},
        r"gear\.blank\.pitch_apex_beyond_crossing_point = 1: with 0 of .* lie 0\.949 mm in each other, .* 0\.085 mm",
    ),
    "teeth a little too thick for each other": (
        NASA,
        {"pinion.convex.work_rotation_offset": 29.6},
        r"backlash of -0\.0\d+ mm .* between 0 and 0\.513 mm",
    ),
    "blank offsets of the flanks with the wrong signs": (
        NASA,
        {"pinion.concave.blank_offset": -3.9262277584, "pinion.convex.blank_offset": 4.426244511222},
        r"-31\.2 degrees .* convex flank has -38\.47; they must agree within 4; it would be a pair with "
        r"pinion\.concave\.blank_offset = 3\.92623, not -3\.92623 and pinion\.convex\.blank_offset = -4\.42624, not",
    ),
    "blades of the other flank, mirrored on both members of uniform depth": (
        HOBBED,
        {
            f"{member}.{flank}.blade_pressure_angle": angle
            for member in ("pinion", "gear")
            for flank, angle in (("concave", 17.0), ("convex", 23.0))
        },
        r"pressure angle at the mean point 17 and 23 degrees .* differ by [+-]6 degrees",
    ),
    "tilt of the wrong sign": (
        UNIVERSAL,
        {f"pinion.{flank}.cutter_tilt": -4.010704566 for flank in FLANKS},
        r"concave flank: the tip of the blade leaves the root 16 mm below .* would be a pair with "
        r"pinion\.concave\.cutter_tilt and pinion\.convex\.cutter_tilt = 4\.0107, not -4\.0107",
    ),
    "teeth of another module": (
        NASA,
        {"pinion.teeth": 13, "gear.teeth": 39},
        r"transverse backlash of 1\.188 mm .* between 0 and 0\.473 mm",
    ),
    "cutters that leave a fin": (
        NASA,
        {f"pinion.{flank}.blade_point_width": 0.1 for flank in FLANKS},
        r"pinion\.concave\.blade_point_width = 0\.1: with 0\.1 mm .* a fin would stay .* is 3\.34 mm wide at the heel",
    ),
    "motion beyond all measure": (
        UNIVERSAL,
        {f"pinion.{flank}.motion": {"radial_distance": [1000.0]} for flank in FLANKS},
        r"pinion\.concave\.motion\.radial_distance = \[1000\.0\]: .* moves by 349\.1 mm, .* at most 8\.13 mm",
    ),
    "backlash of a fifth of the module": (
        NASA,
        {"pinion.convex.work_rotation_offset": 31.5},
        r"backlash of 0\.8\d* mm at the mean point, which must lie between 0 and 0\.513 mm, 0 and 0\.12 of",
    ),
    # keys without effect
    "reference height of a straight blade": (
        NASA,
        {"pinion.convex.blade_reference_height": 4.0},
        r"pinion\.convex\.blade_reference_height = 4: belongs to blade_spheric_radius, .* no effect",
    ),
    "ratio of roll of a Formate member": (
        FORMATE,
        {f"gear.{flank}.ratio_of_roll": 7.0 for flank in FLANKS},
        r"gear\.concave\.ratio_of_roll = 7: a Formate cut does not roll, .* no effect; .* 1\.0548 within 3%",
    ),
    "motion without coefficients": (
        NASA,
        {"pinion.convex.motion": {"radial_distance": []}},
        r"pinion\.convex\.motion\.radial_distance = \[\]: holds no coefficient, so it has no effect",
    ),
    "index correction without values": (
        NASA,
        {"gear.index_correction": []},
        r"gear\.index_correction = \[\]: .* no effect",
    ),
    # 5. settings that cut nothing
    "cradle angle of the wrong sign": (
        NASA,
        {f"gear.{flank}.cradle_angle": -59.234203 for flank in FLANKS},
        r"gear concave flank: .*alone explains it is gear\.concave\.cradle_angle = -59\.2342: 59\.\d+ would fit",
    ),
    "cradle angle in radians": (
        NASA,
        {f"gear.{flank}.cradle_angle": 59.234203 * RADIAN for flank in FLANKS},
        r"gear concave flank: .*alone explains it is gear\.concave\.cradle_angle = 1\.03383: 59\.\d+ would fit",
    ),
    "ratio of roll the other way": (
        NASA,
        {"pinion.concave.ratio_of_roll": 1 / 3.242698504951},
        r"is pinion\.concave\.ratio_of_roll = 0\.308385",
    ),
    "flank in inches": (
        FORMATE,
        scaled(FORMATE, "pinion.convex", FLANK_LENGTHS, INCH),
        r"pinion\.?convex\.",
    ),
    "cutter of another job": (
        FORMATE,
        {"pinion.convex.blade_point_radius": 152.4},
        r"pinion convex flank: .*most of it hangs on pinion\.convex\.blade_point_radius = 152\.4$",
    ),
    # 6. face hobbing
    "indexing left out": (
        HOBBED,
        {"gear.indexing_sign": None},
        r"gear: indexing_sign: the key is missing: face_hobbing",
    ),
    "indexing the other way": (HOBBED, {"gear.indexing_sign": 1}, r"pinion\.indexing_sign = -1: the gear has 1; both"),
    "indexing of both the other way": (
        HOBBED,
        {"pinion.indexing_sign": 1, "gear.indexing_sign": 1},
        r"is pinion\.indexing_sign = 1: -1 would fit",
    ),
    "hobbing blades turned the wrong way": (
        HOBBED,
        {f"gear.{flank}.blade_offset_angle": 0.0 for flank in FLANKS},
        r"gear\.concave\.blade_offset_angle = 0: the blade must stand square to its path, 15\.\d+ within 0.8 degrees",
    ),
    "mates cut by different processes": (
        HOBBED,
        {"pinion.process": "face_milling", "pinion.blade_groups": None, "pinion.indexing_sign": None},
        r"pinion\.process = 'face_milling': the gear has 'face_hobbing'",
    ),
    "one blade group less": (HOBBED, {"pinion.blade_groups": 12}, r"pinion\.blade_groups = 12: the gear has 13"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_set_that_is_no_physical_pair_is_refused_by_file_key_value_and_limit(tmp_path: Path, case: str) -> None:
    name, changes, sentence = REFUSED[case]
    values = changed(name, {})
    if case == "flanks exchanged":
        pinion = values["pinion"]
        pinion["concave"], pinion["convex"] = pinion["convex"], pinion["concave"]
    else:
        values = changed(name, changes)
    file = tmp_path / "set.toml"
    file.write_text(tomlkit.dumps(values), "utf-8")
    with pytest.raises(InputError, match=sentence) as caught:
        load_pair(file)
    assert str(caught.value).startswith(f"{file}: ")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", BUNDLED)
def test_bundled_pairs_pass_unless_a_member_of_another_pair_is_put_in(name: str) -> None:
    pair = load_pair(bundled(f"{name}.toml"))
    assert pair == load_bevel_set(bundled(f"{name}.toml"))
    other = load_bevel_set(bundled(f"{STEEP if name == NASA else NASA}.toml"))
    for member in MEMBERS:
        with pytest.raises(InputError, match="blank"):
            check_pair(pair.model_copy(update={member: other.member(member)}))


@pytest.mark.parametrize("name", BUNDLED)
def test_mirrored_pair_passes_and_its_spiral_angles_change_sign(name: str, moved_edge) -> None:
    """The machine of the other hand, key by key as the conventions have it, is as good a pair."""
    pair = load_bevel_set(bundled(f"{name}.toml"))
    mirrored = pair.model_copy(update={member: moved_edge.mirrored(pair.member(member)) for member in MEMBERS})
    check_pair(mirrored)
    for member in MEMBERS:
        for flank in FLANKS:
            one, two = (
                cut_flank(each.member(member), flank, nominal_cut(each.member(member), flank))
                for each in (pair, mirrored)
            )
            assert two.spiral_angle == pytest.approx(-one.spiral_angle, abs=1e-9)
            assert two.pressure_angle == pytest.approx(one.pressure_angle, abs=1e-9)


@pytest.mark.parametrize(
    ("member", "flank", "pressure", "spiral"),
    [
        ("pinion", "concave", 19.27384719, -35.24621333),
        ("pinion", "convex", 23.70769370, -34.71717186),
        ("gear", "concave", 24.24966429, 34.69525743),
        ("gear", "convex", 19.79546867, 35.20926128),
    ],
)
def test_angles_at_the_mean_point_are_those_of_the_published_closed_form(gear_set, member, flank, pressure, spiral):
    """The matrices and the closed form of NASA CR-191009 with its settings, solved by another program."""
    spec = gear_set.member(member)
    found = cut_flank(spec, flank, nominal_cut(spec, flank))
    assert math.degrees(found.pressure_angle) == pytest.approx(pressure, abs=1e-7)
    assert math.degrees(found.spiral_angle) == pytest.approx(spiral, abs=1e-7)


def corrected(tmp_path: Path, **changes: float) -> Path:
    """The NASA set with changed settings of the pinion's concave flank, the nominal ones under design."""
    gear_set, target = load_bevel_set(bundled(f"{NASA}.toml")), tmp_path / "corrected.toml"
    settings = gear_set.pinion.concave.vector.copy()
    for key, value in changes.items():
        settings[SETTINGS.index(key)] += value
    save_corrected(bundled(f"{NASA}.toml"), target, "pinion", {"concave": settings})
    return target


def test_formate_member_needs_no_ratio_of_roll(tmp_path: Path) -> None:
    """It is that of the crown gear then, as the bundled file has it, and no flank changes."""
    values = changed(FORMATE, {f"gear.{flank}.ratio_of_roll": None for flank in FLANKS})
    file = tmp_path / "set.toml"
    file.write_text(tomlkit.dumps(values), "utf-8")
    without, bundled_set = load_pair(file), load_pair(bundled(f"{FORMATE}.toml"))
    for flank in FLANKS:
        one, other = (each.gear.flank(flank).vector for each in (without, bundled_set))
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-9)


def test_formate_member_without_ratio_of_roll_is_corrected_as_any_other(tmp_path: Path) -> None:
    values = changed(FORMATE, {f"gear.{flank}.ratio_of_roll": None for flank in FLANKS})
    source, target = tmp_path / "set.toml", tmp_path / "corrected.toml"
    source.write_text(tomlkit.dumps(values), "utf-8")
    settings = {flank: load_pair(source).gear.flank(flank).vector + 1e-3 * (np.arange(12) == 0) for flank in FLANKS}
    save_corrected(source, target, "gear", settings, check=check_pair)
    gear = load_pair(target).gear
    assert "ratio_of_roll" not in target.read_text("utf-8").split("[gear]")[1]
    for flank in FLANKS:
        np.testing.assert_allclose(gear.flank(flank).vector, settings[flank], rtol=0, atol=1e-8)


@pytest.mark.parametrize("name", BUNDLED)
def test_bundled_pair_passes_with_half_of_what_mates_may_differ_by(name: str, monkeypatch) -> None:
    from gearmath.bevel import check_mates as check

    monkeypatch.setattr(check, "_SPIRAL", tuple(limit / 2 for limit in check._SPIRAL))
    monkeypatch.setattr(check, "_PRESSURE", check._PRESSURE / 2)
    check_pair(load_bevel_set(bundled(f"{name}.toml")))


#: What a shop corrects by, in mm and degrees; of the ratio of roll a part of it. Tilt and machine root angle turn the
#: tip plane: 0.3 degrees of either move the root of a 14 x 39 by 0.84 mm and more, beyond its clearance of 0.80 mm.
SHOP = {key: 0.3 for key in SETTINGS if not key.startswith("blade_")}
SHOP |= {"ratio_of_roll": 1e-3, "cutter_tilt": 0.2, "machine_root_angle": 0.2}


@pytest.mark.parametrize("name", dict.fromkeys((*BUNDLED, "spiral_7x43")))
def test_small_correction_of_any_setting_to_either_side_stays_accepted(name: str) -> None:
    """One setting at a time, on all flanks at once: each flank is compared with its own nominal one."""
    values = tomllib.loads(bundled(f"{name}.toml").read_text("utf-8"))
    tables = [values[member][flank] for member in MEMBERS for flank in FLANKS if flank in values.get(member, {})]
    nominal = [dict(table) for table in tables]
    for key, sign in itertools.product(SHOP, (1, -1)):
        for table, old in zip(tables, nominal, strict=True):
            table.clear()
            table |= {**old, "design": {one: old[one] for one in SETTINGS if one in old}}
            if "motion" in old:
                table["design"]["motion"] = old["motion"]
            if key in old:
                table[key] = old[key] + sign * SHOP[key] * (old[key] if key == "ratio_of_roll" else 1.0)
        check_pair(checked(values, BevelSet, f"{name}, {key} {sign:+d}"))


def test_corrected_set_passes_with_what_a_correction_changes(tmp_path: Path) -> None:
    load_pair(corrected(tmp_path, radial_distance=0.2, cradle_angle=math.radians(-0.2), ratio_of_roll=0.005))
    load_pair(corrected(tmp_path, sliding_base=0.4))
    load_pair(corrected(tmp_path, work_rotation_offset=math.radians(0.5)))


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        (
            {"radial_distance": 12.0},
            r"pinion concave flank: .* most is pinion\.concave\.radial_distance = 86\.8742 \(design: 74",
        ),
        (
            {"work_rotation_offset": math.radians(30)},
            r"pinion concave flank: the corrected settings move it by -?13\.\d",
        ),
        ({"sliding_base": 1.5}, r"pinion concave flank: the tip of the blade leaves the root 1\.\d+ mm above"),
        (
            {"blade_pressure_angle": math.radians(4)},
            r"the corrected settings change its pressure angle by 3\.9.*changed most is .*blade_pressure_angle = 22",
        ),
    ],
)
def test_corrected_settings_that_no_correction_makes_are_refused(tmp_path: Path, changes, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        load_pair(corrected(tmp_path, **changes))


def test_corrected_set_that_is_no_pair_is_not_written(tmp_path: Path) -> None:
    gear_set, target = load_bevel_set(bundled(f"{NASA}.toml")), tmp_path / "corrected.toml"
    settings = gear_set.pinion.concave.vector + np.eye(12)[SETTINGS.index("sliding_base")] * 3.0
    with pytest.raises(InputError, match=r"corrected\.toml: pinion concave flank: "):
        save_corrected(bundled(f"{NASA}.toml"), target, "pinion", {"concave": settings}, check=check_pair)
    assert not target.exists()


def test_zerol_pair_passes_and_its_hand_is_told_by_the_heel() -> None:
    """Spiral angle zero at the mean point: the trace turns with the cutter's circle beside it."""
    from gearmath.bevel.crown_gear import Method, crown_gear_set
    from gearmath.specs.blank_data import BlankData

    data = BlankData.model_validate(
        {
            "title": "Zerol",
            "source": "test",
            "shaft_angle": 90.0,
            "wheel_outer_pitch_diameter": 176.893,
            "face_width": 22.0,
            "pressure_angle_drive": 20.0,
            "pressure_angle_coast": 20.0,
            "pinion_teeth": 17,
            "wheel_teeth": 39,
            "mean_spiral_angle": 0.0,
            "cutter": {"process": "face_milling", "cutter_radius": 114.3},
            "taper": {"kind": "standard"},
            "data_type_1": {
                "crown_gear_addendum_factor": 1.0,
                "crown_gear_dedendum_factor": 1.25,
                "profile_shift_coefficient": 0.3,
                "thickness_modification": 0.03,
            },
            "backlash": {"outer_normal": 0.127},
        }
    )
    pair = crown_gear_set(data, Method("fixed_setting"), Method())
    check_pair(pair)
    other = {name: pair.member(mate) for name, mate in zip(MEMBERS, reversed(MEMBERS), strict=True)}
    exchanged = {name: pair.member(name).model_copy(update={"hand": other[name].hand}) for name in MEMBERS}
    with pytest.raises(InputError, match="which is left hand"):
        check_pair(pair.model_copy(update=exchanged))


def test_check_looks_at_values_as_they_are_written_in_the_file() -> None:
    """Values of a dictionary and of a file give the same refusal."""
    values = changed(NASA, {"pinion.teeth": 13})
    with pytest.raises(InputError, match=r"^pinion\.blank\.pitch_angle"):
        check_pair(checked(values, BevelSet, "set"))


def test_no_command_reads_a_set_but_through_the_check() -> None:
    """``load_bevel_set`` is known to nothing in the package but the check, and to where it is written.

    ``design --reverse`` looks only at the blank of a set, and checks the pair that it makes of it.
    """
    package = Path(gearmath.__file__).parent
    users = set()
    for file in package.rglob("*.py"):
        tree = ast.parse(file.read_text("utf-8"))
        names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
        names |= {alias.name for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) for alias in node.names}
        names |= {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
        reads = {"load_bevel_set"} <= names or {"load", "BevelSet"} <= names or {"parse", "BevelSet"} <= names
        if reads:
            users.add(str(file.relative_to(package)))
    assert users == {"bevel/design/reverse_route.py", "bevel/pair.py", "specs/bevel_set.py", "specs/set_text.py"}


@pytest.mark.parametrize(
    ("member", "start", "refused"),
    [
        # the pair has 0.157 mm of backlash: 0.351 degrees of the pinion, 0.117 of the gear at the mean point
        ("gear", (0.10,), False),
        ("gear", (0.13,), True),
        ("gear", (0.07, 0.14), True),  # three spaces in mesh, none of them far from the next
        ("gear", (0.03, 0.06, 0.09, 0.12, 0.15, 0.12, 0.09, 0.06, 0.03), False),  # apart, but never in mesh together
        ("pinion", (0.20,), False),
        ("pinion", (0.20, 0.40, 0.20), True),
    ],
)
def test_spaces_that_index_corrections_move_apart_by_more_than_the_backlash_are_refused(
    tmp_path: Path, member: str, start: tuple[float, ...], refused: bool
) -> None:
    file = tmp_path / "set.toml"
    teeth = {"pinion": 12, "gear": 36}[member]
    correction = [*start, *[0.0] * (teeth - len(start))]
    file.write_text(tomlkit.dumps(changed(NASA, {f"{member}.index_correction": correction})), "utf-8")
    if not refused:
        load_pair(file)
        return
    with pytest.raises(InputError, match=rf"{member}\.index_correction: the spaces .* the limit is 0\.15[67] mm"):
        load_pair(file)


def test_index_corrections_of_a_member_without_its_mate_stay_within_the_largest_backlash(tmp_path: Path) -> None:
    """0.12 of the module of 4.27 mm is 0.513 mm, 0.38 degrees of the gear."""
    file = tmp_path / "set.toml"
    for values, refused in (([0.24, 0.36] + [0.12] * 34, False), ([0.25, 0.5, 0.25] + [0.0] * 33, True)):
        given = changed(NASA, {"gear.index_correction": values})
        del given["pinion"]
        file.write_text(tomlkit.dumps(given), "utf-8")
        if refused:
            with pytest.raises(InputError, match=r"the limit is 0\.513 mm, the largest backlash of a set"):
                load_pair(file)
        else:
            load_pair(file)


def _exchanged(member: dict, keys: tuple[str, ...]) -> None:
    for key in keys:
        one, two = (member[flank].get(key) for flank in FLANKS)
        member["concave"][key], member["convex"][key] = two, one


ALONE = {
    "flanks exchanged": lambda member: member.update(concave=member["convex"], convex=member["concave"]),
    "hand of the mate": lambda member: member.update(hand={"left": "right", "right": "left"}[member["hand"]]),
    "blades exchanged": lambda member: _exchanged(member, ("blade_point_radius", "blade_pressure_angle")),
    "other hand but for the word": lambda member: [
        member[flank].update({key: -member[flank][key] for key in ("cradle_angle", "blank_offset")}) for flank in FLANKS
    ],
}


@pytest.mark.parametrize("case", ALONE)
@pytest.mark.parametrize("member", MEMBERS)
@pytest.mark.parametrize("name", BUNDLED)
def test_member_without_its_mate_is_refused_with_its_flanks_or_hand_exchanged(name: str, member: str, case: str):
    """Its own spiral, pressure angles, root and space tell; a whole machine of the other hand is another good gear."""
    values = changed(name, {})
    del values[MEMBERS[1 - MEMBERS.index(member)]]
    ALONE[case](values[member])
    with pytest.raises(InputError, match=member):
        check_pair(checked(values, BevelSet, name))

"""REXS: nothing is lost on the way there and back, the structure is that of the standard, and what is refused."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from gearmath.bevel.tooth import tooth_space
from gearmath.errors import InputError
from gearmath.exchange.rexs import read_rexs, write_rexs
from gearmath.exchange.rexs_names import OWN, right_flank
from gearmath.specs.bevel_set import FLANKS, BevelSet, load_bevel_set
from gearmath.specs.toml import bundled

SETS = ["nasa_tp3096_12x36", "crown_gear_formate_14x39", "crown_gear_hobbed_14x39", "crown_gear_universal_14x39"]
#: Attributes of REXS 2.0.0 that the data model allows in these components, as far as they are written.
ALLOWED = {
    "bevel_stage": {"shaft_angle"},
    "bevel_gear": {
        "number_of_teeth",
        "spiral_angle_pitch_direction",
        "pitch_angle",
        "face_angle",
        "root_angle",
        "mean_cone_distance",
        "face_width",
        "mean_addendum",
        "mean_dedendum",
        "clearance_iso_23509_2025",
        "pitch_apex_beyond_crossing_point",
    },
    "bevel_gear_flank": set(),
    "bevel_gear_tool": {
        "blade_point_radius",
        "blade_pressure_angle",
        "blade_profile_height",
        "blade_spheric_radius",
        "tool_edge_radius_bevel_gear_tool",
    },
    "bevel_gear_manufacturing_settings": {
        "radial_distance",
        "center_roll_position",
        "cutter_tilt",
        "cutter_swivel",
        "work_offset",
        "sliding_base",
        "machine_center_to_crossing_point",
        "machine_root_angle",
        "ratio_of_roll",
    },
}


@pytest.fixture
def written(tmp_path: Path, gear_set: BevelSet) -> Path:
    target = tmp_path / "nasa.rexs"
    write_rexs(target, gear_set)
    return target


@pytest.mark.parametrize("name", SETS)
def test_round_trip_is_exact(name: str, tmp_path: Path) -> None:
    pair = load_bevel_set(bundled(f"{name}.toml"))
    write_rexs(tmp_path / "set.rexs", pair)
    found, left_aside = read_rexs(tmp_path / "set.rexs")
    assert found == pair
    assert left_aside == ()


@pytest.mark.parametrize("name", SETS)
def test_structure_and_names_are_those_of_the_standard(name: str, tmp_path: Path) -> None:
    write_rexs(tmp_path / "set.rexs", load_bevel_set(bundled(f"{name}.toml")))
    model = ET.parse(tmp_path / "set.rexs").getroot()
    assert model.get("version") == "2.0.0"
    assert {"applicationId", "applicationVersion", "date"} <= set(model.keys())
    assert [child.tag for child in model] == ["relations", "components"]
    components = {item.get("id"): item.get("type") for item in model.iter("component")}
    assert len(components) == 15
    for item in model.iter("component"):
        foreign = {one.get("id") for one in item if not one.get("id").startswith(OWN)}
        assert foreign <= ALLOWED[item.get("type")]
        assert {one.get("unit") for one in item} <= {"mm", "deg", "none"}
    relations = [relation.get("type") for relation in model.iter("relation")]
    assert sorted(relations) == ["flank"] * 2 + ["manufacturing_step"] * 4 + ["stage"]
    roles = {
        "stage": ("bevel_stage", "bevel_gear", "bevel_gear"),
        "flank": ("bevel_gear", "bevel_gear_flank", "bevel_gear_flank"),
        "manufacturing_step": ("bevel_gear_flank", "bevel_gear_tool", "bevel_gear_manufacturing_settings"),
    }
    for relation in model.iter("relation"):
        assert tuple(components[ref.get("id")] for ref in relation) == roles[relation.get("type")]


@pytest.mark.parametrize("name", SETS)
def test_right_flank_faces_to_the_right_seen_from_the_apex(name: str) -> None:
    # seen along z_w, with the tip up, azimuths grow to the right; a space begins with the right flank of its tooth
    for member_name, member in load_bevel_set(bundled(f"{name}.toml")).members.items():
        low, _ = tooth_space(member, member_name, 3).ordered
        assert low.flank == right_flank(member.hand)
        assert np.isfinite(low.point).all()
        assert right_flank(member.hand) in FLANKS


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('version="2.0.0"', 'version="1.5"', r"version = '1\.5': must be 2\.0\.0"),
        ("<relations>", "<!DOCTYPE a><relations>", "has a document type or entities"),
        ("</model>", "", "is no XML"),
        ('type="bevel_stage"', 'type="worm_stage"', "has 0 components of type bevel_stage, must have one"),
        ('"radial_distance" unit="mm"', '"radial_distance" unit="m"', "radial_distance: unit = 'm': must be mm"),
        ('role="tool"', 'role="tools"', "the relation manufacturing_step of component 3 has no tool"),
        ('role="gear_2"', 'role="gear_3"', "the relation stage of component 1 has no gear_2"),
        (">concave<", ">convex<", "pinion: its left flank is said to be convex, but must be concave"),
        (">74.874171554126<", ">far<", "radial_distance = 'far': must be a number"),
        (">12.0<", ">900.0<", "blade_profile_height = 900"),
    ],
)
def test_files_that_are_wrong_are_refused(old: str, new: str, sentence: str, written: Path) -> None:
    text = written.read_text("utf-8")
    assert old in text
    written.write_text(text.replace(old, new, 1), "utf-8")
    with pytest.raises(InputError, match=rf"nasa\.rexs: .*{sentence}"):
        read_rexs(written)


def test_attributes_without_a_place_in_a_set_are_named(written: Path) -> None:
    text = written.read_text("utf-8")
    extra = '<attribute id="mean_spiral_angle" unit="deg">35.0</attribute><attribute id="number_of_teeth"'
    written.write_text(text.replace('<attribute id="number_of_teeth"', extra, 1), "utf-8")
    _, left_aside = read_rexs(written)
    assert left_aside == ("bevel_gear 2: mean_spiral_angle",)


def test_offset_is_refused(written: Path) -> None:
    text = written.read_text("utf-8")
    extra = '<attribute id="hypoid_offset" unit="mm">12.5</attribute><attribute id="shaft_angle"'
    written.write_text(text.replace('<attribute id="shaft_angle"', extra, 1), "utf-8")
    with pytest.raises(InputError, match=r"hypoid_offset = 12\.5: must be 0"):
        read_rexs(written)


def test_machine_center_counts_from_the_crossing_point(tmp_path: Path, gear_set: BevelSet) -> None:
    blank = gear_set.pinion.blank.model_copy(update={"pitch_apex_beyond_crossing_point": 2.0})
    pair = gear_set.model_copy(update={"pinion": gear_set.pinion.model_copy(update={"blank": blank})})
    write_rexs(tmp_path / "set.rexs", pair)
    model = ET.parse(tmp_path / "set.rexs").getroot()
    (said, *_) = (
        float(one.text) for one in model.iter("attribute") if one.get("id") == "machine_center_to_crossing_point"
    )
    assert said == pytest.approx(gear_set.pinion.concave.machine_center_to_crossing_point - 2.0, abs=1e-12)
    back, _ = read_rexs(tmp_path / "set.rexs")
    assert back.pinion.concave.vector == pytest.approx(pair.pinion.concave.vector, abs=1e-12)

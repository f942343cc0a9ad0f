"""REXS: nothing is lost on the way there and back, the structure is that of the standard, and what is refused."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from annotated_types import Ge, Gt

from gearmath.bevel.tooth import tooth_space
from gearmath.errors import InputError
from gearmath.exchange.rexs import read_rexs, write_rexs
from gearmath.exchange.rexs_names import GEAR, MACHINE, OWN, STAGE, TOOL, right_flank
from gearmath.specs.bevel_set import FLANKS, BevelSet, Blank, Flank, load_bevel_set
from gearmath.specs.toml import bundled

SETS = [
    "nasa_tp3096_12x36",
    "spiral_7x43",
    "crown_gear_formate_14x39",
    "crown_gear_hobbed_14x39",
    "crown_gear_universal_14x39",
]
#: Lower limits in the data model, and whether they are excluded.
ANY, POSITIVE, NOT_NEGATIVE = (-math.inf, True), (0.0, True), (0.0, False)
#: The data model of REXS 2.0.0 (rexs_schema_2.0.0.xml of 2026-03-10), as far as it is written: by component the
#: attributes that it maps to it, with unit, and lower limit (open or not), or the words of an enumeration.
MODEL = {
    "bevel_stage": {"shaft_angle": ("deg", POSITIVE)},  # and less than 180
    "bevel_gear": {
        "number_of_teeth": ("none", POSITIVE),
        "spiral_angle_pitch_direction": ("none", ("left", "right")),
        "pitch_angle": ("deg", POSITIVE),
        "face_angle": ("deg", POSITIVE),
        "root_angle": ("deg", POSITIVE),
        "mean_cone_distance": ("mm", POSITIVE),
        "face_width": ("mm", POSITIVE),
        "mean_addendum": ("mm", POSITIVE),
        "mean_dedendum": ("mm", POSITIVE),
        "clearance_iso_23509_2025": ("mm", NOT_NEGATIVE),
        "pitch_apex_beyond_crossing_point": ("mm", ANY),
    },
    "bevel_gear_flank": {},
    "bevel_gear_tool": {
        "blade_point_radius": ("mm", POSITIVE),
        "blade_pressure_angle": ("deg", NOT_NEGATIVE),
        "blade_profile_height": ("mm", POSITIVE),
        "blade_spheric_radius": ("mm", ANY),
        "tool_edge_radius_bevel_gear_tool": ("mm", POSITIVE),
    },
    "bevel_gear_manufacturing_settings": {
        "radial_distance": ("mm", ANY),
        "center_roll_position": ("deg", ANY),
        "cutter_tilt": ("deg", ANY),
        "cutter_swivel": ("deg", ANY),
        "work_offset": ("mm", ANY),
        "sliding_base": ("mm", ANY),
        "machine_center_to_crossing_point": ("mm", ANY),
        "machine_root_angle": ("deg", ANY),
        "ratio_of_roll": ("none", NOT_NEGATIVE),
    },
}
#: Its relations: roles and the components that may have them, and whether an order is required.
RELATIONS = {
    "stage": ({"stage": "bevel_stage", "gear_1": "bevel_gear", "gear_2": "bevel_gear"}, False),
    "flank": ({"gear": "bevel_gear", "left": "bevel_gear_flank", "right": "bevel_gear_flank"}, False),
    "manufacturing_step": (
        {
            "workpiece": "bevel_gear_flank",
            "tool": "bevel_gear_tool",
            "manufacturing_settings": "bevel_gear_manufacturing_settings",
        },
        True,
    ),
}
#: Its XSD (rexs-file.xsd): children of an element in their order, attributes that it requires, and what else it knows.
XSD = {
    "model": (["relations", "components"], {"version", "applicationId", "applicationVersion", "date"}, set()),
    "relations": (["relation"], set(), set()),
    "relation": (["ref"], {"id", "type"}, {"order"}),
    "ref": ([], {"id", "role"}, {"hint"}),
    "components": (["component"], set(), set()),
    "component": (["attribute"], {"id", "type"}, {"name"}),
    "attribute": (["array"], {"id"}, {"unit"}),
    "array": (["c"], set(), {"code"}),
    "c": ([], set(), set()),
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
def test_file_has_the_structure_that_the_xsd_asks_for(name: str, tmp_path: Path) -> None:
    write_rexs(tmp_path / "set.rexs", load_bevel_set(bundled(f"{name}.toml")))
    model = ET.parse(tmp_path / "set.rexs").getroot()
    assert model.tag == "model"
    for element in model.iter():
        order, required, optional = XSD[element.tag]
        places = [order.index(child.tag) for child in element]
        assert places == sorted(places)
        assert required <= set(element.keys()) <= required | optional
    assert all(len(item) == 0 or not item.text.strip() for item in model.iter("attribute"))
    for kind in ("relation", "component"):
        numbers = [int(item.get("id")) for item in model.iter(kind)]
        assert len(set(numbers)) == len(numbers)
    assert {ref.get("id") for ref in model.iter("ref")} <= {item.get("id") for item in model.iter("component")}


@pytest.mark.parametrize("name", SETS)
def test_names_units_and_values_are_those_of_the_data_model(name: str, tmp_path: Path) -> None:
    write_rexs(tmp_path / "set.rexs", load_bevel_set(bundled(f"{name}.toml")))
    model = ET.parse(tmp_path / "set.rexs").getroot()
    assert model.get("version") == "2.0.0"
    components = {item.get("id"): item.get("type") for item in model.iter("component")}
    assert len(components) == 15
    for item in model.iter("component"):
        attributes = [one for one in item if not one.get("id").startswith(OWN)]
        assert len({one.get("id") for one in item}) == len(item)
        for one in attributes:
            unit, allowed = MODEL[item.get("type")][one.get("id")]
            assert one.get("unit") == unit
            if isinstance(allowed[0], str):
                assert one.text in allowed
                continue
            least, is_open = allowed
            value = int(one.text) if one.get("id") == "number_of_teeth" else float(one.text)
            assert value > least if is_open else value >= least
        assert all(one.get("id").startswith("custom_") for one in item if one not in attributes)
    relations = [relation.get("type") for relation in model.iter("relation")]
    assert sorted(relations) == ["flank"] * 2 + ["manufacturing_step"] * 4 + ["stage"]
    for relation in model.iter("relation"):
        roles, ordered = RELATIONS[relation.get("type")]
        assert {ref.get("role"): components[ref.get("id")] for ref in relation} == roles
        assert (relation.get("order") is not None) == ordered


def test_every_value_that_a_set_may_have_is_one_of_the_data_model() -> None:
    tables = {
        "bevel_stage": (STAGE, BevelSet, ""),
        "bevel_gear": (GEAR, Blank, "blank."),
        "bevel_gear_manufacturing_settings": (MACHINE, Flank, ""),
        "bevel_gear_tool": (TOOL, Flank, ""),
    }
    compared = 0
    for component, (names, sheet, before) in tables.items():
        assert {attribute for attribute, _ in names.values()} == set(MODEL[component])
        for key, (attribute, unit) in names.items():
            assert MODEL[component][attribute][0] == unit
            field = sheet.model_fields.get(key.removeprefix(before))
            if field is None or key == "hand":
                continue
            least, is_open = MODEL[component][attribute][1]
            own = [
                (m.gt, True) if isinstance(m, Gt) else (m.ge, False) for m in field.metadata if isinstance(m, Gt | Ge)
            ]
            # what is its default is not written: zero stands for a sharp edge
            own = own or [(-math.inf, True)]
            assert own[0][0] >= least
            assert own[0][1] or own[0][0] > least or not is_open or field.default == own[0][0]
            compared += 1
    assert compared == 24


@pytest.mark.parametrize("name", SETS)
def test_right_flank_faces_to_the_right_seen_from_the_apex(name: str) -> None:
    # seen along z_w, with the tip up, azimuths grow to the right; a space begins with the right flank of its tooth
    for member in load_bevel_set(bundled(f"{name}.toml")).members.values():
        low, _ = tooth_space(member, 3).ordered
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

"""The design data of a blank: what is bundled, and what is refused."""

from __future__ import annotations

import math

import pytest

from gearmath.errors import InputError
from gearmath.specs.blank_data import BlankData, load_blank_data
from gearmath.specs.toml import bundled, parse

SAMPLE = bundled("blank_iso23509_sample1.toml").read_text("utf-8")


def test_bundled_data_are_those_of_the_sample() -> None:
    data = load_blank_data(bundled("blank_iso23509_sample1.toml"))
    assert (data.pinion_teeth, data.wheel_teeth) == (14, 39)
    values = data.values
    assert values["wheel_outer_pitch_diameter"] == 176.893
    assert values["shaft_angle"] == pytest.approx(math.pi / 2)
    assert (values["backlash"], values["backlash_kind"]) == (0.127, 0)
    assert values["mean_addendum_factor"] == 0.24737


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (
            "wheel_outer_pitch_diameter = 176.893",
            "outer_transverse_module = -4.5",
            ("outer_transverse_module", "-4.5", "0"),
        ),
        ("wheel_outer_pitch_diameter = 176.893", "", ("wheel_outer_pitch_diameter", "outer_transverse_module", "one")),
        ("face_width = 25.4", "face_width = nan", ("face_width", "nan", "finite")),
        ("face_width = 25.4", "", ("face_width", "missing")),
        ("mean_spiral_angle = 35.0", "mean_spiral_angle = 75.0", ("mean_spiral_angle", "75", "50")),
        ("pinion_teeth = 14", "pinion_teeth = 40", ("wheel_teeth", "39", "40")),
        ("wheel_addendum_angle = 2.1342", 'kind = "conical"', ("taper.kind", "conical", "tilted_root_line")),
        ("wheel_addendum_angle = 2.1342", "", ("taper", "kind", "both")),
        ("wheel_addendum_angle = 2.1342", 'kind = "duplex"', ("taper", "kind", "both")),
        ("wheel_addendum_angle = 2.1342", "wheel_addendum_angle = -1.0", ("wheel_addendum_angle", "-1", "0")),
        ('"face_milling"', '"face_hobbing"', ("cutter", "blade_groups", "face_hobbing")),
        ('"face_milling"', '"face_hobbing"\nblade_groups = 13', ("taper", "uniform", "face_hobbing")),
        ('"face_milling"', '"planing"', ("cutter.process", "planing", "face_milling")),
        ("cutter_radius = 114.3", "cutter_radius = 114.3\ntilt = 3.0", ("cutter.tilt", "3", "known")),
        ("outer_normal = 0.127", "outer_normal = 0.127\nmean_normal = 0.1", ("backlash", "exactly one")),
        ("outer_normal = 0.127", "outer_normal = -0.1", ("backlash.outer_normal", "-0.1", "0")),
        ("mean_addendum_factor = 0.24737", "mean_addendum_factor = 1.2", ("mean_addendum_factor", "1.2", "1")),
        ("[data_type_2]", "[data_type_3]", ("data_type_3: no such key; did you mean data_type_",)),
    ],
)
def test_bad_input_is_refused_in_one_sentence(old: str, new: str, words: tuple[str, ...]) -> None:
    assert old in SAMPLE
    with pytest.raises(InputError) as caught:
        parse(SAMPLE.replace(old, new, 1), BlankData, "blank.toml")
    message = str(caught.value)
    assert message.startswith("blank.toml: ")
    assert "\n" not in message
    assert [word for word in words if word not in message] == []


@pytest.mark.parametrize(
    ("factors", "words"),
    [
        ((1.0, 0.9, 0.4), ("crown_gear_dedendum_factor", "0.9", "1.0")),
        ((0.7, 1.25, 0.8), ("profile_shift_coefficient", "0.7")),
    ],
)
def test_a_crown_gear_without_clearance_or_addendum_is_refused(factors: tuple, words: tuple[str, ...]) -> None:
    names = ("crown_gear_addendum_factor", "crown_gear_dedendum_factor", "profile_shift_coefficient")
    table = "\n".join(f"{name} = {value}" for name, value in zip(names, factors, strict=True))
    start, end = SAMPLE.index("[data_type_2]"), SAMPLE.index("[backlash]")
    text = f"{SAMPLE[:start]}[data_type_1]\n{table}\nthickness_modification = 0.0\n\n{SAMPLE[end:]}"
    with pytest.raises(InputError) as caught:
        parse(text, BlankData, "blank.toml")
    assert [word for word in words if word not in str(caught.value)] == []

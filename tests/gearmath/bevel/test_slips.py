"""A refused set file is told the usual slip that was made in it, by the whole check and not by its likeness."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest
import tomlkit

from gearmath.bevel.misprints import exchanged_digits, minutes_as_decimals, wrong_digits
from gearmath.bevel.pair import load_pair
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, MEMBERS
from gearmath.specs.toml import bundled

NASA, SPIRAL, UNIVERSAL = "nasa_tp3096_12x36", "spiral_7x43", "crown_gear_universal_14x39"
MACHINE = (
    "radial_distance",
    "blank_offset",
    "sliding_base",
    "machine_center_to_crossing_point",
    "blade_point_radius",
)
BLANK = ("mean_cone_distance", "face_width", "mean_addendum", "mean_dedendum", "clearance")


def one(member: str, flank: str, key: str, change: Callable[[float], float]) -> Callable[[dict], None]:
    def apply(values: dict) -> None:
        values[member][flank][key] = change(values[member][flank][key])

    return apply


def exchange(*tables: tuple[str, str], key: str | None = None) -> Callable[[dict], None]:
    def apply(values: dict) -> None:
        (a, b), (c, d) = tables
        if not a:
            values[b], values[d] = values[d], values[b]
        elif key is None:
            values[a][b], values[c][d] = values[c][d], values[a][b]
        else:
            values[a][b][key], values[c][d][key] = values[c][d][key], values[a][b][key]

    return apply


def divided(
    by: float, tables: tuple[str, ...], keys: tuple[str, ...], members: tuple[str, ...] = MEMBERS
) -> Callable[[dict], None]:
    def apply(values: dict) -> None:
        for member in members:
            for table in tables:
                for key in keys:
                    values[member][table][key] /= by

    return apply


def hands(*members: str) -> Callable[[dict], None]:
    def apply(values: dict) -> None:
        for member in members:
            values[member]["hand"] = {"left": "right", "right": "left"}[values[member]["hand"]]

    return apply


def set_to(key: str, value: object, *place: str) -> Callable[[dict], None]:
    def apply(values: dict) -> None:
        table = values
        for part in place:
            table = table[part]
        table[key] = value

    return apply


def blanks(key: str, value: float) -> Callable[[dict], None]:
    def apply(values: dict) -> None:
        for member in MEMBERS:
            values[member]["blank"][key] = value

    return apply


def blank_angles(values: dict) -> None:
    blank = values["pinion"]["blank"]
    blank["face_angle"], blank["root_angle"] = blank["root_angle"], blank["face_angle"]


def completing(key: str, value: float) -> Callable[[dict], None]:
    def apply(values: dict) -> None:
        for flank in FLANKS:
            values["gear"][flank][key] = value

    return apply


def other_swivel(values: dict) -> None:
    for flank in FLANKS:
        values["pinion"][flank]["cutter_swivel"] = 180 - values["pinion"][flank]["cutter_swivel"]


#: Set, what is made wrong in it, and what the sentence must end with.
SLIPS = {
    "sign of the cradle angle": (
        NASA,
        one("pinion", "concave", "cradle_angle", lambda v: -v),
        "pinion.concave.cradle_angle = -63.942, not 63.942",
    ),
    "sign of an offset that shows in the space": (
        NASA,
        one("pinion", "concave", "blank_offset", lambda v: -v),
        "pinion.concave.blank_offset = 3.92623, not -3.92623",
    ),
    "radius ten times, refused by a limit": (
        NASA,
        one("pinion", "concave", "blade_point_radius", lambda v: 10 * v),
        "pinion.concave.blade_point_radius = 75.3268, not 753.268",
    ),
    "both hands": (SPIRAL, hands("pinion", "gear"), "pinion.hand = 'left' and gear.hand = 'right'"),
    "one hand": (NASA, hands("pinion"), "pinion.hand = 'left'"),
    "flanks of the pinion": (
        UNIVERSAL,
        exchange(("pinion", "concave"), ("pinion", "convex")),
        "pinion.concave and pinion.convex exchanged",
    ),
    "a key of both flanks": (
        UNIVERSAL,
        exchange(("pinion", "concave"), ("pinion", "convex"), key="radial_distance"),
        "radial_distance of pinion.concave and pinion.convex exchanged",
    ),
    "one flank of a completing cut": (
        NASA,
        one("gear", "concave", "cradle_angle", lambda v: -v),
        "gear.concave.cradle_angle = 59.2342, not -59.2342",
    ),
    "settings in inches": (NASA, divided(25.4, FLANKS, MACHINE), "times 25.4: they are in inches"),
    "blanks in inches": (
        NASA,
        divided(25.4, ("blank",), BLANK),
        "the lengths of the blanks times 25.4: they are in inches",
    ),
    "unit": (SPIRAL, set_to("unit", "inch"), "unit = 'mm'"),
    "a decimal place in a blank": (
        SPIRAL,
        set_to("face_width", 2.54, "pinion", "blank"),
        "pinion.blank.face_width = 25.4, not 2.54",
    ),
    "a decimal place, refused by a sum": (
        SPIRAL,
        set_to("clearance", 6.32676551, "gear", "blank"),
        "gear.blank.clearance = 0.632677, not 6.32677",
    ),
    "both blanks": (SPIRAL, blanks("face_width", 254.0), "face_width of both blanks = 25.4, not 254"),
    "two digits of a length that both have": (
        SPIRAL,
        set_to("mean_cone_distance", 67.91078879, "gear", "blank"),
        "gear.blank.mean_cone_distance = 76.9108, not 67.9108",
    ),
    "two digits of an angle of the blank": (
        SPIRAL,
        set_to("pitch_angle", 9.426112746, "pinion", "blank"),
        "pinion.blank.pitch_angle = 9.24611275, not 9.42611275",
    ),
    "two angles of a blank": (SPIRAL, blank_angles, "pinion.blank.face_angle and root_angle exchanged"),
    "one digit of a setting": (
        SPIRAL,
        one("pinion", "convex", "radial_distance", lambda v: v + 10),
        "pinion.convex.radial_distance = 88.558, not 98.558",
    ),
    "two digits of a setting": (
        SPIRAL,
        set_to("ratio_of_roll", 6.323208, "pinion", "concave"),
        "pinion.concave.ratio_of_roll = 6.233208, not 6.323208",
    ),
    "two digits of a setting of both flanks": (
        SPIRAL,
        completing("radial_distance", 95.422),
        "gear.concave.radial_distance and gear.convex.radial_distance = 94.522, not 95.422",
    ),
    "digits of a tooth count": (SPIRAL, set_to("teeth", 34, "gear"), "gear.teeth = 43, not 34"),
    "members": (SPIRAL, exchange(("", "pinion"), ("", "gear")), "the tables pinion and gear exchanged"),
    "teeth": (NASA, set_to("teeth", 13, "pinion"), "pinion.teeth = 12, not 13"),
    "settings of one member in inches": (
        NASA,
        divided(25.4, FLANKS, MACHINE, ("gear",)),
        "of the gear times 25.4: they are in inches",
    ),
    "angles of one blank in radians": (
        NASA,
        divided(180 / math.pi, ("blank",), ("pitch_angle", "face_angle", "root_angle"), ("gear",)),
        "the angles of the blank of the gear times 57.2958: they are in radians",
    ),
    "both flanks of a fixed-setting cut in radians": (
        NASA,
        divided(180 / math.pi, FLANKS, ("cradle_angle",), ("pinion",)),
        "pinion.concave.cradle_angle = -63.942, not -1.116 and pinion.convex.cradle_angle = -53.926, not -0.941186",
    ),
    "a phase in radians": (
        SPIRAL,
        set_to("work_rotation_offset", -0.39757, "pinion", "concave"),
        "pinion.concave.work_rotation_offset = -22.7791, not -0.39757",
    ),
    "a diameter for the radius": (
        NASA,
        one("pinion", "concave", "blade_point_radius", lambda v: 2 * v),
        "pinion.concave.blade_point_radius = 75.3268, not 150.654",
    ),
    "the outer cone distance": (
        NASA,
        blanks("mean_cone_distance", 93.7514),
        "pinion.blank.mean_cone_distance = 81.0514 and gear.blank.mean_cone_distance = 81.0514: "
        "what is given is the outer one",
    ),
    "the swivel of the other hand": (
        UNIVERSAL,
        other_swivel,
        "pinion.concave.cutter_swivel = 226.727, not -46.7274 and pinion.convex.cutter_swivel = 225.153, not -45.1528",
    ),
    "minutes and seconds after the point": (
        NASA,  # -63 degrees 56 minutes 31 seconds
        set_to("cradle_angle", -63.5631, "pinion", "concave"),
        "pinion.concave.cradle_angle = -63.9419, not -63.5631",
    ),
    "method": (NASA, set_to("generation", "formate", "pinion"), "pinion.generation = 'generated', not 'formate'"),
}


def refusal(name: str, change: Callable[[dict], None], folder: Path) -> str:
    values = tomllib.loads(bundled(f"{name}.toml").read_text("utf-8"))
    change(values)
    path = folder / "wrong.toml"
    path.write_text(tomlkit.dumps(values), "utf-8")
    with pytest.raises(InputError) as caught:
        load_pair(path)
    return str(caught.value)


@pytest.mark.parametrize("case", SLIPS)
def test_slip_that_was_made_is_named(case: str, tmp_path: Path) -> None:
    name, change, words = SLIPS[case]
    text = refusal(name, change, tmp_path)
    assert "; it would be a pair with " in text
    assert words in text.split("it would be a pair with ")[1]
    assert "no single setting" not in text


def several(values: dict) -> None:
    for flank in FLANKS:
        for key in ("radial_distance", "cradle_angle", "blade_point_radius"):
            values["pinion"][flank][key] *= 1.031


def test_no_slip_is_named_where_none_was_made(tmp_path: Path) -> None:
    """The space is too wide by a whole list of settings that are a little off."""
    text = refusal(NASA, several, tmp_path)
    assert "it would be a pair with" not in text


@pytest.mark.parametrize(
    "change",
    [
        set_to("hand", ["left"], "pinion"),
        set_to("teeth", 10**30, "gear"),
        set_to("shaft_angle", "90 degrees"),
        set_to("cradle_angle", 10**30, "pinion", "concave"),
        set_to("concave", 3.0, "pinion"),
    ],
)
def test_value_of_another_kind_or_size_is_refused_and_no_slip_fails_on_it(change, tmp_path: Path) -> None:
    assert refusal(NASA, change, tmp_path).startswith(str(tmp_path))


def test_file_that_is_no_toml_is_refused_as_such(tmp_path: Path) -> None:
    path = tmp_path / "broken.toml"
    path.write_text("[pinion\n", "utf-8")
    with pytest.raises(InputError, match="is no TOML"):
        load_pair(path)


def test_decimal_comma_is_named(tmp_path: Path) -> None:
    path = tmp_path / "comma.toml"
    path.write_text(bundled(f"{SPIRAL}.toml").read_text("utf-8").replace("= 94.728", "= 94,728"), "utf-8")
    with pytest.raises(InputError, match=r"94,728 has a decimal comma, TOML wants a point$"):
        load_pair(path)


def test_minutes_are_read_where_the_digits_can_be_minutes_and_seconds() -> None:
    """63 degrees 56 minutes, 63 56 31, 63 56 31.3; 94 minutes or 75 seconds there are none."""
    assert minutes_as_decimals(63.56) == [pytest.approx(63 + 56 / 60, abs=1e-12)]
    assert minutes_as_decimals(-63.5631) == [pytest.approx(-(63 + 56 / 60 + 31 / 3600), abs=1e-12)]
    assert minutes_as_decimals(63.56313) == [pytest.approx(63 + 56 / 60 + 31.3 / 3600, abs=1e-12)]
    assert minutes_as_decimals(63.94) == minutes_as_decimals(63.5675) == minutes_as_decimals(63.5) == []


def test_nothing_is_looked_for_where_the_refusal_says_what_to_do(tmp_path: Path) -> None:
    """The flanks bound a tooth: no setting is to be doubted beside the whole pitch that the sentence names."""
    text = refusal(NASA, set_to("work_rotation_offset", 0.0, "pinion", "convex"), tmp_path)
    assert text.endswith("the convex flank must be turned by 30 degrees, whole pitches")


def test_misprints_are_of_the_digits_as_they_are_written() -> None:
    assert list(exchanged_digits(-88.558)) == [-85.858, -88.585]
    assert list(exchanged_digits(10.05)) == [10.5]
    assert 88.558 in wrong_digits(98.558)
    assert 118.9 not in wrong_digits(18.9)
    assert list(wrong_digits(0.0)) == list(exchanged_digits(0.0)) == []
    assert list(exchanged_digits(float("nan"))) == list(wrong_digits(1e300)) == []


@pytest.mark.parametrize(
    ("key", "flank", "value"), [("blade_point_radius", "convex", 0.4), ("work_rotation_offset", "concave", 1.5)]
)
def test_small_change_that_shows_in_the_backlash_alone_gets_no_slip_of_another_setting(key, flank, value, tmp_path):
    """Hundredths of a dozen settings would do, by digits or signs of what is small: none of them is named."""

    def change(values: dict) -> None:
        values["pinion"][flank][key] = round(values["pinion"][flank][key] + value, 2)

    text = refusal(SPIRAL, change, tmp_path)
    assert "the pair has a transverse backlash of " in text
    assert "it would be a pair with" not in text

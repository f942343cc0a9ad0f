"""The setting that a refusal names is one that a set file may have, and the one that was made wrong."""

from __future__ import annotations

import re
import tomllib

import pytest

from gearmath.bevel.pair import check_pair
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, BevelSet
from gearmath.specs.toml import bundled, checked, parse

NASA, HOBBED = "nasa_tp3096_12x36", "crown_gear_hobbed_14x39"
#: What is changed, by how much, and the setting that the sentence must name, with the value that would fit.
WRONG = {
    "sliding base of one flank": (NASA, {"pinion.concave.sliding_base": -0.2965}, r"sliding_base = -0\.2965: 0\.2\d+"),
    "no sliding base": (NASA, {"pinion.convex.sliding_base": 0.0}, r"sliding_base = 0: -0\.[34]\d+"),
    "root angle of both flanks of the gear": (
        NASA,
        {f"gear.{flank}.machine_root_angle": 65.0 for flank in FLANKS},
        r"gear\.concave\.machine_root_angle = 65: 67\.",
    ),
    "radial distance in inches": (
        NASA,
        {"pinion.concave.radial_distance": 2.94780202969},
        r"pinion\.concave\.radial_distance = 2\.9478: 7\d\.",
    ),
    "blades of both flanks": (
        HOBBED,
        {f"gear.{flank}.blade_pressure_angle": 23.0 for flank in FLANKS},
        r"gear\.concave\.blade_pressure_angle = 23: (19\.[89]|20\.[01])\d* would fit on both flanks",
    ),
    "ratio of roll the other way": (
        NASA,
        {"pinion.concave.ratio_of_roll": 1 / 3.2426985355495},
        r"ratio_of_roll = 0\.308385: 3\.2427 would fit",
    ),
}


def changed(name: str, changes: dict[str, float]) -> dict:
    values = tomllib.loads(bundled(f"{name}.toml").read_text("utf-8"))
    for place, value in changes.items():
        member, table, key = place.split(".")
        values[member][table][key] = value
    return values


def refusal(name: str, changes: dict[str, float]) -> str:
    with pytest.raises(InputError) as caught:
        check_pair(checked(changed(name, changes), BevelSet, name))
    return str(caught.value)


@pytest.mark.parametrize("case", WRONG)
def test_setting_that_alone_puts_the_flank_right_is_named_with_the_value_that_would_fit(case: str) -> None:

    name, changes, sentence = WRONG[case]
    assert re.search(rf"the setting that alone explains it is .*{sentence}", refusal(name, changes))


def test_figures_that_no_single_setting_explains_are_said_to_be_so() -> None:
    text = refusal(
        NASA,
        {
            "pinion.concave.radial_distance": 113.8,
            "pinion.concave.blade_point_radius": 77.0,
            "pinion.concave.cradle_angle": -20.0,
            "pinion.concave.sliding_base": 5.0,
        },
    )
    assert re.search(r"no single setting was found that puts it right, farthest from .* pinion\.concave\.\w+ = ", text)
    assert "would fit" not in text


def test_setting_is_named_without_a_value_where_it_is_not_all_that_is_wrong() -> None:
    text = refusal(NASA, {"pinion.concave.cradle_angle": 63.9420304635, "pinion.concave.blank_offset": -3.9262})
    assert text.endswith(
        "no single setting was found that puts all of it right, most of it hangs on "
        "pinion.concave.cradle_angle = 63.942"
    )


ADVICE = re.compile(r"(pinion|gear)\.(?:(concave|convex)\.)?(\w+) = \S+: (\S+) would fit( on both flanks)?")


@pytest.mark.parametrize("case", WRONG)
def test_set_with_the_advised_value_passes(case: str) -> None:
    name, changes, _ = WRONG[case]
    advised = ADVICE.findall(refusal(name, changes))
    assert advised
    for member, flank, key, value, both in advised:
        places = {f"{member}.{each}.{key}": float(value) for each in (FLANKS if both else (flank,))}
        check_pair(checked(changed(name, changes | places), BevelSet, name))


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ('[pinion]\n"a\\nb" = 1\n', r"pinion\.'a\\nb' = 1: no such key"),
        (f"pinion = {[{'teeth': 12}] * 50}\n", r"\.\.\.: "),
    ],
)
def test_odd_key_or_long_value_keeps_the_sentence_to_one_short_line(line: str, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence) as caught:
        parse(f'title = "a"\nsource = "b"\nshaft_angle = 90.0\n{line}'.replace("'teeth': ", "teeth="), BevelSet, "set")
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize(
    ("key", "by", "flanks", "others"),
    [
        ("sliding_base", 2.0, ("convex",), {"blade_point_radius": 72.0}),
        ("machine_center_to_crossing_point", -2.0, FLANKS, {}),
    ],
)
def test_setting_that_was_changed_is_among_those_that_explain_most(key, by, flanks, others) -> None:
    """Work moved along its axis, cutter plunged: both lower the root, and others of them may explain it as well."""
    values = tomllib.loads(bundled(f"{NASA}.toml").read_text("utf-8"))["pinion"]
    changes = {f"pinion.{flank}.{key}": values[flank][key] + by for flank in flanks}
    text = refusal(NASA, changes | {f"pinion.convex.{other}": value for other, value in others.items()})
    assert f".{key} = " in text.split("most of it hangs on ")[1]


def test_refusal_of_the_backlash_names_the_cradle_angle_that_was_changed() -> None:
    """0.3 degrees of the cradle turn the work as 0.97 degrees of work_rotation_offset do: the teeth clamp or rattle."""
    value = tomllib.loads(bundled(f"{NASA}.toml").read_text("utf-8"))["pinion"]["convex"]["cradle_angle"]
    for change in (0.3, -0.3):
        text = refusal(NASA, {"pinion.convex.cradle_angle": value + change})
        assert "the pair has a transverse backlash of " in text
        assert "a cradle_angle of one flank of a fixed-setting cut, which acts as work_rotation_offset does" in text

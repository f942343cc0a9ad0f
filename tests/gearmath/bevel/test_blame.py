"""The setting that a refusal names is one that a set file may have, and the one that was made wrong."""

from __future__ import annotations

import re
import tomllib

import pytest

from gearmath.bevel.pair import check_pair
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, BevelSet
from gearmath.specs.toml import bundled, checked, parse

NASA = "nasa_tp3096_12x36"
#: What is changed, by how much, and the setting that the sentence must name, with the value that would fit.
WRONG = {
    "sliding base of one flank": (NASA, {"pinion.concave.sliding_base": -0.2965}, r"sliding_base = -0\.2965: 0\.2\d+"),
    "no sliding base": (NASA, {"pinion.convex.sliding_base": 0.0}, r"sliding_base = 0: -0\.[34]\d+"),
    "root angle of both flanks of the gear": (
        NASA, {f"gear.{flank}.machine_root_angle": 65.0 for flank in FLANKS},
        r"gear\.concave\.machine_root_angle = 65: 67\.",
    ),
    "radial distance in inches": (
        NASA, {"pinion.concave.radial_distance": 2.94780202969}, r"pinion\.concave\.radial_distance = 2\.9478: 7\d\.",
    ),
    "hand of one flank, where a roll backwards would do as well": (
        NASA, {"pinion.concave.cradle_angle": 63.9420304635, "pinion.concave.blank_offset": -3.9262},
        r"pinion\.concave\.cradle_angle = 63\.942: -",
    ),
}  # fmt: skip


def refusal(name: str, changes: dict[str, float]) -> str:
    values = tomllib.loads(bundled(f"{name}.toml").read_text("utf-8"))
    for place, value in changes.items():
        member, table, key = place.split(".")
        values[member][table][key] = value
    with pytest.raises(InputError) as caught:
        check_pair(checked(values, BevelSet, name))
    return str(caught.value)


@pytest.mark.parametrize("case", WRONG)
def test_setting_that_alone_puts_the_flank_right_is_named_with_the_value_that_would_fit(case: str) -> None:

    name, changes, sentence = WRONG[case]
    assert re.search(rf"the setting that alone explains it is .*{sentence}", refusal(name, changes))


def test_figures_that_no_single_setting_explains_are_said_to_be_so() -> None:
    text = refusal(NASA, {"pinion.concave.radial_distance": 113.8, "pinion.concave.blade_point_radius": 77.0,
                          "pinion.concave.cradle_angle": -20.0, "pinion.concave.sliding_base": 5.0})  # fmt: skip
    assert "no single setting explains it" in text


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

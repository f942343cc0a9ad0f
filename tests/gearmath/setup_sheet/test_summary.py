"""The summary sheet of a set: NASA's figures in inches and minutes as published, signs, and what it leaves empty."""

from __future__ import annotations

import math
import re
from html import unescape

import pytest

from gearmath.setup_sheet.summary import summary_sheet
from gearmath.specs.bevel_set import FLANKS, load_bevel_set
from gearmath.specs.toml import bundled


def tables(name: str) -> dict[str, dict[str, list[str]]]:
    """The tables of the page of a bundled set: by member and caption, the cells of a row by its first one."""
    text = summary_sheet(load_bevel_set(bundled(name)))
    found: dict[str, dict[str, list[str]]] = {}
    for part in re.split(r"<h2[^>]*>", text)[1:]:
        member = part[: part.index("<")].lower()
        for caption, body in re.findall(r"<caption>(.*?)</caption>(.*?)</table>", part, re.DOTALL):
            rows = [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in re.findall(r"<tr>(.*?)</tr>", body)]
            cells = [[unescape(cell) for cell in row] for row in rows if row]
            found[f"{member}: {unescape(caption)}"] = {row[0]: row[1:] for row in cells}
    return found


INCHES = "inches and degrees, minutes, seconds"


def test_nasa_gear_reads_in_inches_and_minutes_as_it_was_published():
    """CR-191009: face width 1 inch, root angle 67°41', a 6 inch cutter with a point width of 0.065 inch, blades 22°."""
    found = tables("nasa_tp3096_12x36.toml")
    blank, build = found[f"gear: Blank, from the pitch apex; {INCHES}"], found[f"gear: Cutter build; {INCHES}"]
    assert blank["face width"] == ["1.00000"]
    assert blank["root angle"][0].startswith("67°41'")
    assert build["point width"] == ["0.06500", "0.06500"]
    assert sum(float(one) for one in build["point diameter"]) / 2 == pytest.approx(6.0, abs=1e-5)
    assert build["pressure angle"] == ["22°00'00\""] * 2
    assert build["edge radius"] == ["", ""]


def test_nasa_pair_has_the_dimensions_that_were_published():
    """TP-3096: spiral angle 35 degrees, gear blades of 22; mean cone distance 3.191 in, 1 in of face width, 36 teeth.

    So the heel is at 3.691 in, and the module there 2 x 3.691 sin(71.565)/36 in. To the pitch cone the two sides lie by
    about the same angle off their blades, in opposite senses.
    """
    found = tables("nasa_tp3096_12x36.toml")
    for name in ("pinion", "gear"):
        metric, inch = (found[f"{name}: Dimensions of the teeth; {unit}"] for unit in ("mm and degrees", INCHES))
        assert float(metric["mean spiral angle"][0]) == pytest.approx(35.0, abs=0.3)
        angles = [float(metric[f"normal pressure angle, {flank}"][0]) for flank in FLANKS]
        assert sum(angles) / 2 == pytest.approx(22.0, abs=0.6)
        assert abs(angles[0] - angles[1]) > 1.0
        assert float(inch["outer cone distance"][0]) == pytest.approx(3.691, abs=5e-4)
        module = 2 * 3.691 * math.sin(math.atan(3)) / 36
        assert float(inch["outer transverse module"][0]) == pytest.approx(module, abs=1e-4)
        pitch = math.pi * float(metric["mean normal module"][0])
        assert 0.3 * pitch < float(metric["mean normal tooth thickness, arc"][0]) < 0.7 * pitch


def test_width_that_the_planner_takes_stands_on_the_sheet_of_a_set_that_states_none():
    text = summary_sheet(load_bevel_set(bundled("spiral_7x43.toml")))
    found = tables("spiral_7x43.toml")
    assert all(float(width) > 0 for width in found["pinion: Cutter build; mm and degrees"]["point width"])
    assert "The set states no point width for the outside blade and inside blade" in text


def test_both_tables_say_the_same_with_the_signs_of_the_file():
    found = tables("nasa_tp3096_12x36.toml")
    member = load_bevel_set(bundled("nasa_tp3096_12x36.toml")).member("pinion")
    metric, inch = (found[f"pinion: Machine settings; {unit}"] for unit in ("mm and degrees", INCHES))
    for row, key in (("blank offset (work offset), E_m", "blank_offset"), ("sliding base, X_b", "sliding_base")):
        for flank, mm, inches in zip(FLANKS, metric[row], inch[row], strict=False):
            assert float(mm) == pytest.approx(getattr(member.flank(flank), key), abs=5e-5)
            assert float(inches) * 25.4 == pytest.approx(float(mm), abs=2e-4)
    assert metric["cradle angle, q"][0] == "-63.94203"
    assert inch["cradle angle, q"][0] == "-63°56'31.3\""


def test_motions_of_a_universal_pinion_stand_there_and_nothing_that_is_still():
    found = tables("crown_gear_universal_14x39.toml")
    pinion = found["pinion: Machine settings; mm and degrees"]
    assert pinion["modified roll, 2C"][:2] == ["0.060000", "0.060000"]
    assert pinion["sliding base, X_b: order 1"][:2] == ["1.600000", "1.600000"]
    assert not any("order" in row or "modified" in row for row in found["gear: Machine settings; mm and degrees"])


def test_hobbed_member_has_blade_groups_and_a_formate_one_no_roll():
    assert tables("crown_gear_hobbed_14x39.toml")["gear: Cutter build; mm and degrees"]["blade groups"] == ["13", "13"]
    formate = tables("crown_gear_formate_14x39.toml")
    assert not any("roll" in row for row in formate["gear: Machine settings; mm and degrees"])
    assert any("roll" in row for row in formate["pinion: Machine settings; mm and degrees"])

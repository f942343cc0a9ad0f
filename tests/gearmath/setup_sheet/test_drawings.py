"""The drawings of the set-up sheet are to scale: dimension lines and places are where the numbers say."""

from __future__ import annotations

import math
import re
from xml.etree import ElementTree

import numpy as np
import pytest

from gearmath.bevel.root import Widths
from gearmath.bevel.tooth import SpaceFlank, ToothSpace
from gearmath.machine.bodies.cutter import cutter_of
from gearmath.machine.bodies.profiles import work_profiles
from gearmath.machine.planning.setup_facts import BlankSizes
from gearmath.machine.planning.tooling import PointWidth, tools_of
from gearmath.setup_sheet.machine_drawing import DrawnRing, machine_drawing
from gearmath.setup_sheet.point_drawing import point_drawing
from gearmath.setup_sheet.svg import LETTER, WIDTH
from gearmath.setup_sheet.work_drawing import work_drawing

TOOL = [DrawnRing("blade", 0.0, 12.0, 75.0, 79.0), DrawnRing("holder", 12.0, 150.0, 60.0, 60.0)]
SVG = "{http://www.w3.org/2000/svg}"


def parsed(svg):
    """Dimension lines by name as ends in mm (2,2), places by name in mm, and all words."""
    root = ElementTree.fromstring(svg)
    scale = float(root.attrib["data-scale"])
    dimensions = {}
    for group in root.iter(f"{SVG}g"):
        line = group.find(f"{SVG}line").attrib
        ends = [[float(line[key]) for key in pair] for pair in (("x1", "y1"), ("x2", "y2"))]
        dimensions[group.attrib["data-name"]] = np.array(ends) / scale
    places = {
        one.attrib["data-name"]: np.array([float(one.attrib["cx"]), float(one.attrib["cy"])]) / scale
        for one in root.iter(f"{SVG}circle")
    }
    return dimensions, places, [text.text for text in root.iter(f"{SVG}text")]


def length(ends):
    return float(np.linalg.norm(ends[1] - ends[0]))


def drawn(machine, member, b=0.3):
    profiles = work_profiles(member, machine.fixture)
    return parsed(machine_drawing(machine, profiles, TOOL, machine.tool_length, "blade tips", -20.0, b))


def placed_otherwise(vertical):
    """The machine of the sentence: its gauge line is 650 mm above the B axis at Z = 0, and Z travels below that."""
    z = vertical.axes.Z.model_copy(update={"travel": (-700.0, 0.0)})
    return vertical.model_copy(
        update={
            "gauge_line_height": -650.0,
            "tool_length": 120.0,
            "home_z": None,
            "axes": vertical.axes.model_copy(update={"Z": z}),
        }
    )


def test_lengths_of_the_machine_are_to_scale(gear_set, vertical):
    dimensions, _, words = drawn(vertical, gear_set.pinion)
    for name, expected in (("C_t", 150.0), ("R_d", 350.0), ("tips above the B axis", 400.0)):
        assert length(dimensions[name]) == pytest.approx(expected, abs=0.05)
    assert {"gauge line", "blade tips", "Z = 900, home", "Z = 350", "Z = 0", "C_t 150", "R_d 350"} <= set(words)


def test_machine_of_the_sentence_has_zero_of_z_650_mm_above_the_b_axis(gear_set, vertical):
    dimensions, places, words = drawn(placed_otherwise(vertical), gear_set.pinion)
    zero, level = dimensions["R_d"][:, 1]
    assert level - zero == pytest.approx(650.0, abs=0.05)  # pixels count downwards: zero is above
    assert level == pytest.approx(places["B axis"][1], abs=0.05)
    gauge = dimensions["C_t"][1, 1]
    assert gauge == pytest.approx(zero, abs=0.05)  # Z is at the top of its travel, where the gauge line reads 0
    assert length(dimensions["tips above the B axis"]) == pytest.approx(530.0, abs=0.05)
    assert "R_d -650" in words


def test_pitch_apex_is_off_the_b_axis_as_the_machine_file_says(gear_set, vertical):
    """With A = B = 0 the work's x, y, z point along Z, Y and -X, as the machine file says."""
    for offset, expected in (((10.0, 0.0, 0.0), (0.0, -10.0)), ((0.0, 0.0, 25.0), (-25.0, 0.0))):
        _, places, _ = drawn(vertical.model_copy(update={"pivot_offset": offset}), gear_set.pinion, b=0.0)
        np.testing.assert_allclose(places["pitch apex"] - places["B axis"], expected, atol=0.05)


def test_sizes_of_the_blank_are_those_of_a_hand_calculation_and_to_scale(gear_set, vertical):
    """Crown and toe tip from the pitch apex, along the pitch cone and square to it, by hand for the NASA pinion."""
    blank, half = gear_set.pinion.blank, 25.4 / 2
    delta, more = math.radians(18.4333333), math.tan(math.radians(22.3166667 - 18.4333333))
    ends = {}
    for end, along in (("crown", half), ("toe tip", -half)):
        distance, addendum = 81.0514 + along, 4.570064768422 + along * more
        ends[end] = (
            distance * math.cos(delta) - addendum * math.sin(delta),
            distance * math.sin(delta) + addendum * math.cos(delta),
        )
    sizes = BlankSizes.of(gear_set.pinion, vertical)
    assert (sizes.to_crown, sizes.outside_diameter / 2) == pytest.approx(ends["crown"], abs=1e-9)
    assert (sizes.to_front_crown, sizes.toe_diameter / 2) == pytest.approx(ends["toe tip"], abs=1e-9)
    beyond = blank.model_copy(update={"pitch_apex_beyond_crossing_point": 0.5})
    moved = BlankSizes.of(gear_set.pinion.model_copy(update={"blank": beyond}), vertical)
    assert moved.crossing_to_crown == pytest.approx(ends["crown"][0] - 0.5)  # the crossing point is nearer to the teeth

    dimensions, _, words = parsed(
        work_drawing(sizes, work_profiles(gear_set.pinion, vertical.fixture), vertical.fixture)
    )
    assert length(dimensions["outside diameter"]) == pytest.approx(2 * ends["crown"][1], abs=0.05)
    assert length(dimensions["pitch apex to crown"]) == pytest.approx(ends["crown"][0], abs=0.05)
    assert length(dimensions["pitch apex to toe tip"]) == pytest.approx(ends["toe tip"][0], abs=0.05)
    assert f"⌀ {2 * ends['crown'][1]:.3f}" in words


def test_point_of_a_completing_cutter_is_as_wide_as_its_blades_are_apart(gear_set):
    """The NASA gear: 3.0325 and 2.9675 in, 0.065 in apart."""
    (tool,) = tools_of(gear_set.gear, None)
    assert tool.point.width == pytest.approx(0.065 * 25.4, abs=1e-9)
    assert tool.point.fault is None
    dimensions, _, words = parsed(point_drawing(cutter_of(gear_set.gear, ("concave", "convex"), None)))
    assert length(dimensions["point width"]) == pytest.approx(0.065 * 25.4, abs=0.01)
    assert length(dimensions["blade height"]) == pytest.approx(gear_set.gear.concave.blade_profile_height, abs=0.02)
    assert {"point width 1.651", "r 77.0255", "r 75.3745", "22.000°"} <= set(words)


def test_point_of_a_cutter_for_one_flank_is_limited_by_the_slot_that_both_leave(gear_set):
    """A slot that is 3 mm wide at the toe and 5 mm at the heel: at least 2.5 mm, or a ridge stays, and at most 3 mm."""
    low, high = (np.array([[[50.0, sign * 1.5, 0.0], [60.0, sign * 2.5, 9.0]]]) for sign in (-1, 1))
    flanks = [SpaceFlank("any", points, points, ("main",), np.ones((1, 2))) for points in (low, high)]
    slot = Widths(3.0, 4.0, 5.0, 3.0, 5.0)
    space = ToothSpace(*flanks, 0.5, slot, dict.fromkeys(("concave", "convex"), slot))
    wanted = gear_set.pinion.concave.model_copy(update={"blade_point_width": 2.0})
    member = gear_set.pinion.model_copy(update={"concave": wanted})
    concave, convex = tools_of(member, space)
    assert (concave.point.least, concave.point.most) == pytest.approx((2.5, 3.0))
    assert concave.point.stated
    assert not convex.point.stated
    assert "may leave a ridge: it is less than 2.500 mm" in concave.point.fault
    assert "cuts the other flank: it is more than 3.000 mm" in PointWidth(3.1, True, 2.5, 3.0).fault
    assert PointWidth(2.7, True, 2.5, 3.0).fault is None


def test_words_of_a_drawing_stay_inside_and_are_escaped(gear_set, vertical):
    profiles = work_profiles(gear_set.gear, vertical.fixture)
    svg = machine_drawing(vertical, profiles, TOOL, 150.0, "<b>tips & more</b>", -20.0, 1.0)
    assert "<b>" not in svg
    height = float(re.search(r'viewBox="0 0 \d+ ([\d.]+)"', svg)[1])
    for text in ElementTree.fromstring(svg).iter(f"{SVG}text"):
        x, y, size = (float(text.attrib[key]) for key in ("x", "y", "font-size"))
        assert size == LETTER
        assert 0 <= x <= WIDTH
        assert size <= y <= height

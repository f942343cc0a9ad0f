"""The deepest line of a space, which settings of a design must keep: on the blank's root, with its derivatives."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.design.route import design
from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.generation import solve_section
from gearmath.bevel.identify.root_line import root_line
from gearmath.bevel.identify.variables import NAMES, whole
from gearmath.bevel.method import blade_sections, generation_of
from gearmath.bevel.root import cone_distances, mean_place, root_trace
from gearmath.specs.bevel_set import SIDES, load_bevel_set
from gearmath.specs.toml import bundled
from tests.gearmath.bevel.design.family import mixed


def deepest(name: str, member_name: str, flank: str):
    member = load_bevel_set(bundled(name)).member(member_name)
    how = generation_of(member, flank)
    line = root_line(member, flank, how, solve_flank(member, flank, blank_grid(member)))
    return member, replace(line, deepest=True), whole(how.settings, how.motion)


@pytest.mark.parametrize("name", ["spiral_7x43.toml", "crown_gear_universal_14x39.toml"])
@pytest.mark.parametrize("flank", ["concave", "convex"])
def test_deepest_line_of_a_crown_gear_cut_is_the_root_cone_of_the_blank(name, flank):
    """A generated one: the root of a Formate space is flat, and rises above the cone towards toe and heel."""
    member, line, vector = deepest(name, "gear", flank)
    blank = member.blank
    _, depth, _ = line.depth(vector)
    # dedendum at the mean point, and what the root cone falls away from the pitch cone from there
    fall = math.tan(math.radians(blank.pitch_angle - blank.root_angle))
    wanted = blank.mean_dedendum + (line.distances - blank.mean_cone_distance) * fall
    assert depth == pytest.approx(wanted, abs=0.002)


def test_deepest_line_of_a_tilted_hobbing_cutter_is_left_by_tips_that_stand_off_the_plane_of_its_radius():
    """16 x 45, tips some tenths off: against the trace of the corner, by the solver that every flank goes through."""
    member = design(mixed(33)).pair.member("pinion")
    for flank in ("concave", "convex"):
        spec, how = member.flank(flank), generation_of(member, flank)
        line = replace(root_line(member, flank, how, solve_flank(member, flank, blank_grid(member))), deepest=True)
        vector = whole(how.settings, how.motion)
        mean = solve_section(how, blade_sections(spec, SIDES[flank])["main"], *mean_place(member)).contact
        trace = root_trace(member, flank, how, mean).point
        _, places = cone_distances(member.blank)
        delta = member.blank.delta
        depth = trace[:, 2] * math.sin(delta) - np.hypot(trace[:, 0], trace[:, 1]) * math.cos(delta)
        _, found, gradient = line.depth(vector)
        assert found == pytest.approx(np.interp(line.distances, places, depth), abs=0.005)
        level = replace(line, tip_height=0.0).depth(vector)[1]
        assert found == pytest.approx(level - spec.blade_tip_height, abs=0.1 * abs(spec.blade_tip_height))
        assert abs(spec.blade_tip_height) > 0.1
        for name in ("blade_point_radius", "blade_pressure_angle", "cutter_tilt"):
            step = np.zeros(len(vector))
            step[NAMES.index(name)] = 1e-4
            high, low = (line.depth(vector + sign * step)[1] for sign in (1, -1))
            assert gradient[:, NAMES.index(name)] == pytest.approx((high - low) / 2e-4, rel=1e-5, abs=1e-7)


def test_derivatives_of_the_deepest_line_are_differences_and_it_has_no_pressure_angle():
    _, line, vector = deepest("nasa_tp3096_12x36.toml", "pinion", "concave")
    _, _, gradient = line.depth(vector)
    names = ("radial_distance", "sliding_base", "machine_root_angle", "blank_offset", "blade_point_radius")
    for name in (*names, "blade_pressure_angle"):
        step = np.zeros(len(vector))
        step[NAMES.index(name)] = 1e-4
        high, low = (line.depth(vector + sign * step)[1] for sign in (1, -1))
        assert gradient[:, NAMES.index(name)] == pytest.approx((high - low) / 2e-4, rel=1e-5, abs=1e-7)
    assert gradient[:, NAMES.index("blade_pressure_angle")] == pytest.approx([0, 0])

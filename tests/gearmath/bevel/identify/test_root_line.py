"""The deepest line of a space, which settings of a design must keep: on the blank's root, with its derivatives."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.identify.root_line import root_line
from gearmath.bevel.identify.variables import NAMES, whole
from gearmath.bevel.method import generation_of
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.toml import bundled


def deepest(name: str, member_name: str, flank: str):
    member = load_bevel_set(bundled(name)).member(member_name)
    how = generation_of(member, flank)
    line = root_line(member, flank, how, solve_flank(member, member_name, flank, blank_grid(member)))
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

"""Settings of the crown gear: the mean point comes out as asked for, and the bundled sets are what they say."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

from gearmath.bevel.blank import blank_of
from gearmath.bevel.crown_gear import Method
from gearmath.bevel.ease_off import ease_off
from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.generation import solve_section
from gearmath.bevel.method import blade_sections, generation_of
from gearmath.bevel.tooth import mean_backlash, space_figures, tooth_space
from gearmath.specs.bevel_set import FLANKS, MEMBERS, SIDES, BevelSet, load_bevel_set
from gearmath.specs.set_text import set_text
from gearmath.specs.toml import bundled, parse

ENTRIES = json.loads((Path(__file__).parent / "bundled_sets.json").read_text())
HOBBED = {"blade_groups": 13, "cutter_radius": 76.0}


def at_mean_point(member, flank):
    """Spiral and pressure angle [degree], and the sense of the trace, where the flank meets the pitch cone."""
    delta = np.radians(member.blank.pitch_angle)
    place = member.blank.mean_cone_distance * np.array([np.cos(delta), np.sin(delta)])
    section = blade_sections(member.flank(flank), SIDES[flank])["main"]
    points = solve_section(generation_of(member, flank), section, place[:1], place[1:])
    assert points.converged.all()
    n, polar = points.normal[0], np.arctan2(points.point[0, 1], points.point[0, 0])
    along = np.array([np.sin(delta) * np.cos(polar), np.sin(delta) * np.sin(polar), np.cos(delta)])
    around = np.array([-np.sin(polar), np.cos(polar), 0.0])
    out = np.cross(along, around)
    out *= np.sign(out[0] * np.cos(polar) + out[1] * np.sin(polar))
    trace = np.cross(n, out)
    return (
        np.degrees(np.arctan(abs((n @ along) / (n @ around)))),
        np.degrees(np.arcsin(n @ out)),
        np.sign((trace @ along) * (trace @ around)),
    )


@pytest.mark.parametrize("tilt", [0.0, 0.08])
@pytest.mark.parametrize("hand", ["left", "right"])
@pytest.mark.parametrize("flank", FLANKS)
def test_flank_cut_alone_has_spiral_and_pressure_angle_at_the_mean_point(pair, hand, tilt, flank):
    made = pair(Method("fixed_setting", tilt=tilt, tilt_direction=0.4), hand=hand, pressure_angle_drive=22.0)
    spiral, pressure, turn = at_mean_point(made.pinion, flank)
    assert pressure == pytest.approx(22.0 if flank == "concave" else 20.0, abs=1e-6)
    assert spiral == pytest.approx(35.0, abs=1e-6)
    assert turn == (1 if hand == "right" else -1)


@pytest.mark.parametrize("changes", [{}, HOBBED], ids=["milled", "hobbed"])
@pytest.mark.parametrize("member", MEMBERS)
@pytest.mark.parametrize("hand", ["left", "right"])
def test_flanks_cut_together_have_the_spiral_angle_between_them(pair, changes, member, hand):
    made = pair(hand=hand, **changes)
    spirals, pressures, turns = zip(*(at_mean_point(made.member(member), flank) for flank in FLANKS), strict=True)
    assert np.mean(spirals) == pytest.approx(35.0, abs=0.1)
    assert spirals == pytest.approx([35.0, 35.0], abs=2.0)
    # not of blades of one angle: the root line would take θ_f sin ψ from one flank and give it to the other
    assert pressures == pytest.approx([20.0, 20.0], abs=0.2)
    assert set(turns) == {1 if made.member(member).hand == "right" else -1}


@pytest.mark.parametrize("changes", [{}, HOBBED], ids=["milled", "hobbed"])
@pytest.mark.parametrize("gear", [Method(), Method(generation="formate")], ids=["generated", "Formate"])
def test_pair_has_the_backlash_of_the_blank(pair, design, changes, gear):
    """Spaces come from the thicknesses of ISO 23509; the flanks, found by root finding, give its backlash back."""
    wanted = blank_of(design(**changes)).mean_transverse_backlash
    made = pair(Method(), gear, **changes)
    assert mean_backlash(made.pinion, made.gear) == pytest.approx(wanted, abs=0.04)  # mm: pitch cone against plane


@pytest.mark.parametrize("name", ENTRIES)
def test_bundled_set_is_what_the_crown_gear_generates_but_for_the_flanks_of_a_fitted_pinion(pair, name):
    entry, bundled_set = ENTRIES[name], load_bevel_set(bundled(name))
    source = {"source": entry["source"]} if "source" in entry else {}
    made = pair(Method(**entry["pinion"]), Method(**entry["gear"]), title=entry["title"], **entry["data"], **source)
    if "fitted" in entry:
        flanks = {flank: bundled_set.pinion.flank(flank) for flank in FLANKS}
        made = made.model_copy(update={"pinion": made.pinion.model_copy(update=flanks)})
    text = re.sub(r"-?\d+\.\d+(e-\d+)?", lambda number: repr(round(float(number[0]), 9) + 0.0), set_text(made))
    assert text == bundled(name).read_text()  # nine decimals of a mm and of a degree
    assert "not published" in bundled_set.source
    assert parse(text, BevelSet, name) == bundled_set


@pytest.mark.parametrize("name", [name for name in ENTRIES if "fitted" in ENTRIES[name]])
def test_fitted_pinion_has_the_ease_off_and_the_backlash_that_its_set_states(pair, name):
    """Within 6 um at the 45 points, and the backlash of the crown gear's pinion within 0.1 um."""
    entry, bundled_set = ENTRIES[name], load_bevel_set(bundled(name))
    pinion, gear = bundled_set.pinion, bundled_set.gear
    y, x = np.meshgrid(np.linspace(-1, 1, 5), np.linspace(-1, 1, 9), indexing="ij")
    wanted = entry["fitted"]["crowning"] * x**2 + entry["fitted"]["profile_crowning"] * y**2
    for flank in FLANKS:
        assert np.abs(ease_off(pinion, gear, math.pi / 2, flank, blank_grid(gear)) - wanted).max() < 0.006
    made = pair(Method(**entry["pinion"]), Method(**entry["gear"]), **entry["data"])
    assert mean_backlash(pinion, gear) == pytest.approx(mean_backlash(made.pinion, made.gear), abs=1e-4)


@pytest.mark.parametrize("member", MEMBERS)
@pytest.mark.parametrize("name", ENTRIES)
def test_bundled_set_has_whole_teeth(name, member):
    """All 45 points of both flanks, no undercut, no pointed tooth, and the pair does not jam."""
    gear_set = load_bevel_set(bundled(name))
    spec = gear_set.member(member)
    for flank in FLANKS:
        solve_flank(spec, flank, blank_grid(spec))
    figures = space_figures(spec, tooth_space(spec))
    assert figures["undercut_points"] == figures["pointed_columns"] == 0
    assert figures["top_land_heel_mm"] > 0.3
    assert 0.05 < mean_backlash(gear_set.pinion, gear_set.gear) < 0.3  # mm

"""The root of a corrected fixed-setting member: two cuts moved apart, with the cutters that cut it before."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.tooth import SHARP_EDGE, tooth_space
from gearmath.machine.bodies.cutter import cutter_of
from gearmath.machine.control.executor import execute
from gearmath.machine.control.state import Setup
from gearmath.machine.judging.cut import as_cut, metal_left
from gearmath.machine.judging.stated import Stated
from gearmath.machine.milling.run import runs_of
from gearmath.machine.milling.surfaces import surface_states
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.machine.planning.path import Cut
from gearmath.machine.writing.cutting import cutting_program
from gearmath.specs.bevel_set import FLANKS, SETTINGS, load_bevel_set
from gearmath.specs.set_text import save_corrected
from gearmath.specs.toml import bundled

#: Designed by gearmath design; its cutters state no point width.
DESIGNED = "spiral_7x43.toml"
#: Away from the middle of the space for either flank [mm]: the root becomes 0.1 mm wider.
APART = {"concave": 0.05, "convex": -0.05}


@pytest.fixture(scope="module")
def widened(altered, nominal_settings):
    """``widened(flanks)``: the designed pinion with these flanks corrected, so that its root becomes wider."""

    def change(flanks):
        gear_set = load_bevel_set(bundled(DESIGNED))
        for flank in flanks:
            spec = gear_set.pinion.flank(flank)
            offset = spec.blank_offset + APART[flank]
            gear_set = altered(gear_set, "pinion", flank, design=nominal_settings(spec), blank_offset=offset)
        return gear_set

    return change


@pytest.fixture(scope="module")
def judged(widened, vertical):
    """A program of one corrected space, its tools, and ``judge(runs)``: the sentences, and what the root keeps [mm]."""
    gear_set = widened(FLANKS)
    spec = gear_set.pinion
    space = tooth_space(spec, 7)
    text = cutting_program(gear_set, "pinion", vertical, "CUT", CuttingJob((0,), 1e-4))
    runs = runs_of(execute(text, "CUT", Setup.of(vertical)), spec, vertical, None, space, SHARP_EDGE)
    made = as_cut(spec, space)
    own = tooth_space(made, 7)

    def judge(runs, made=made):
        faults = [str(one) for one in metal_left(runs, made, vertical, Stated.of(text), own).faults]
        *_, root = surface_states(None, made, vertical, None, (0,), runs=runs, space=own)
        return faults, root

    return made, runs, judge


@pytest.mark.parametrize("flanks", [FLANKS, ("concave",), ("convex",)])
def test_correction_changes_no_cutter(widened, flanks):
    """Of neither flank, though one alone was corrected: the root that both cut has another slot for each of them."""
    spec = widened(flanks).pinion
    space = tooth_space(spec, 3)
    made = as_cut(spec, space)
    own = tooth_space(made, 3)
    assert all(abs(own.slots[flank].most - space.slots[flank].most) > 0.01 for flank in FLANKS)  # mm
    for cut in Cut.of(spec):
        assert cutter_of(made, cut.flanks, own) == cutter_of(spec, cut.flanks, space)


def test_stated_point_width_and_a_member_that_was_not_corrected_stay_as_they_are(widened):
    spec = load_bevel_set(bundled(DESIGNED)).pinion
    space = tooth_space(spec, 3)
    assert as_cut(spec, space) == spec
    stated = widened(FLANKS).pinion
    stated = stated.model_copy(
        update={flank: stated.flank(flank).model_copy(update={"blade_point_width": 1.2}) for flank in FLANKS}
    )
    assert {as_cut(stated, space).flank(flank).blade_point_width for flank in FLANKS} == {1.2}


def test_right_program_of_two_corrected_cuts_keeps_its_tolerance_on_the_root(judged, host_compiler):
    _, runs, judge = judged
    faults, root = judge(runs)
    assert faults == []
    assert root.lowest >= -1e-4  # mm, as the program states
    assert root.highest <= 1e-4
    assert root.unmet == 0


@pytest.mark.parametrize(("wrong", "says"), [(-3e-3, "gouges the"), (3e-3, "the root of space 0 keeps")])
def test_one_of_two_cuts_at_the_wrong_depth_is_seen_on_the_root(judged, host_compiler, wrong, says):
    """By hand: Z is along the cutter axis, and the tip plane of the convex side's tool leaves the root as much off."""
    _, (concave, convex), judge = judged
    faults, root = judge([concave, replace(convex, axes=convex.axes + np.array([0.0, 0.0, wrong, 0.0, 0.0]))])
    assert any(says in one for one in faults), faults
    assert (root.lowest if wrong < 0 else root.highest) == pytest.approx(wrong, abs=2e-4)


def test_wider_cutters_than_those_of_the_set_are_seen_on_the_root(judged, host_compiler):
    """They take away the ridge that those of the set leave between the two cuts, here of 1.1 mm with edges of 0.5."""
    made, wider, judge = judged
    narrow = {flank: made.flank(flank).model_copy(update={"blade_point_width": 1.1}) for flank in FLANKS}
    faults, root = judge(wider, made.model_copy(update=narrow))
    assert any("gouges the root of space 0" in one for one in faults), faults
    assert root.lowest < -5e-3  # mm


@pytest.mark.parametrize("change", [APART["convex"], -APART["convex"]], ids=["wider", "narrower"])
def test_program_of_corrected_settings_is_passed_by_the_command(command, tmp_path, host_compiler, change):
    """One flank corrected by 0.05 mm, as compensate writes it: that far from its design, and nowhere from its own."""
    settings = load_bevel_set(bundled(DESIGNED)).pinion.convex.vector.copy()
    settings[SETTINGS.index("blank_offset")] += change
    corrected, program = tmp_path / "corrected.toml", tmp_path / "CUT2.MPF"
    save_corrected(bundled(DESIGNED), corrected, "pinion", {"convex": settings})
    status, _, err = command("nc", "cut", corrected, "--member", "pinion", "--spaces", "0", "-o", program)
    assert status == 0, err
    files = "--report", tmp_path / "report.json", "-o", tmp_path / "cut.csv"
    status, out, err = command("mill", corrected, "--program", program, *files)
    assert status == 0, err
    assert "passed: 1 of 7 spaces within 0.1 um" in out
    said = re.search(r"by up to (\S+) um from those of these settings, and by (\S+) um from the design", out)
    own, design = map(float, said.groups())
    assert own < 0.2
    assert 5.0 < design < 60.0
    report = json.loads((tmp_path / "report.json").read_text())
    worst = {
        key: max(max(-one["lowest"], one["highest"]) for one in report[key] if "flank" in one["surface"])
        for key in ("surfaces", "surfaces_of_settings")
    }
    assert worst["surfaces"] == pytest.approx(design / 1000, abs=1e-6)
    assert worst["surfaces_of_settings"] == pytest.approx(own / 1000, abs=1e-6)

"""Collisions worked by hand with a cutter that stands over the work axis, and on real programs that are bent."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.tooth import tooth_space
from gearmath.machine.bodies.profiles import work_profiles
from gearmath.machine.judging.collision import collisions
from gearmath.machine.judging.timing import timing
from gearmath.machine.milling.run import runs_of
from gearmath.specs.bevel_set import MEMBERS
from gearmath.specs.simulated_machine import CutterHead, Fixture


@pytest.fixture(scope="module")
def job(gear_set, program, vertical):
    path = program(gear_set, "gear", (0, 7))
    return path, runs_of(path, gear_set.gear, vertical, None)


@pytest.mark.parametrize("member", MEMBERS)
def test_bundled_programs_collide_with_nothing(gear_set, program, vertical, member):
    path = program(gear_set, member, (0, 3))
    spec = gear_set.member(member)
    runs = runs_of(path, spec, vertical, None, tooth_space(spec, 5))
    assert collisions(path, runs, gear_set.member(member), vertical) == []


def test_head_meets_the_teeth_when_the_blades_are_too_short(gear_set, vertical, job):
    path, runs = job
    short = [replace(run, cutter=replace(run.cutter, height=3.0)) for run in runs]
    found = collisions(path, short, gear_set.gear, vertical)
    assert {(one.cutter, one.work) for one in found} == {("head", "teeth")}
    (one,) = found
    assert 0 < one.depth < 12.0
    assert set(one.lines) <= set(path.line.tolist())


def test_fixture_as_wide_as_the_work_area_is_met_where_the_program_cuts(gear_set, vertical, job):
    path, runs = job
    wide = Fixture(shank_radius=50.0, shank_length=1.0, radius=300.0)
    found = collisions(path, runs, gear_set.gear, vertical, fixture=wide)
    assert "fixture" in {one.work for one in found}
    for one in found:
        assert set(one.lines) <= set(path.line.tolist())


def test_depth_is_that_of_the_cutter_below_the_face_by_hand(gear_set, vertical, job):
    """Cutter on the work axis, B = 90°: a head 2 mm too low over the highest point of the teeth's face cone."""
    path, (run, *_) = job
    heights = work_profiles(gear_set.gear, Fixture())["teeth"]
    wide = np.flatnonzero(heights[:, 1] < run.cutter.tip_radius)
    toe = heights[wide, 0].min()  # z_w: the tip stands on the side of small z_w and looks to large z_w
    tip = toe + run.cutter.height + 2.0
    position = [0.0, 0.0, vertical.pivot_height - tip, 0.0, math.pi / 2]
    standing = replace(
        run,
        axes=np.array([position, position]),
        cutting=np.array([False, True]),
        space=np.zeros(2, int),
        line=np.array([5, 6]),
    )
    found = {(c.cutter, c.work): c for c in collisions(path, [standing], gear_set.gear, vertical)}
    assert found["head", "teeth"].depth == pytest.approx(2.0, abs=1e-6)
    assert found["head", "teeth"].lines == (6,)
    narrow = CutterHead(beyond_tip=-40.0)
    assert ("head", "teeth") not in {
        (c.cutter, c.work) for c in collisions(path, [standing], gear_set.gear, vertical, narrow)
    }


def test_time_and_speeds_of_a_path_by_hand(vertical, job):
    """One block of 10 mm X in 2 s, one rapid of 100 mm Z at 15000 mm/min."""
    path, _ = job
    here = replace(
        path,
        axes=np.array([[0.0] * 5, [10.0, 0, 0, 0, 0], [10.0, 0, 100, 0, 0]]),
        rapid=np.array([True, False, True]),
        tool=np.zeros(3, int),
        line=np.array([3, 4, 5]),
        seconds=np.array([0.0, 2.0, 0.0]),
        rpm=np.full(3, 100.0),
        measuring=np.zeros(3, bool),
    )
    found = timing(here, vertical)
    assert found.feed_seconds == 2.0
    assert found.rapid_seconds == pytest.approx(100 / 15000 * 60)
    x = found.axes[0]
    assert (x.axis, x.speed_per_min, x.line) == ("X", pytest.approx(300.0), 4)
    assert [axis.speed_per_min for axis in found.axes[1:]] == [0.0] * 4

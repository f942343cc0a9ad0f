"""What a blade takes: by hand where the motion is plain, by distances from the cone of the blade where it is not."""

from __future__ import annotations

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.machine.planning.chip_load import chip_loads
from gearmath.machine.planning.cut_plan import PLUNGE_FEED, CuttingJob, cutting_plan
from gearmath.machine.planning.path import flank_points
from gearmath.specs.bevel_set import SIDES, load_bevel_set
from gearmath.specs.toml import bundled

RPM = 120.0


def planned(vertical, name, member, **job):
    return cutting_plan(load_bevel_set(bundled(name)), member, vertical, CuttingJob(spindle_rpm=RPM, **job))


def loads(plan, member=None):
    found = chip_loads(member or plan.member, plan.machine, plan.passes, RPM, PLUNGE_FEED)
    return {load.flank: load for load in found}


@pytest.fixture(scope="module")
def pinion(vertical):
    return planned(vertical, "nasa_tp3096_12x36.toml", "pinion")


def with_blades(member, count):
    return member.model_copy(
        update={name: member.flank(name).model_copy(update={"blade_count": count}) for name in ("concave", "convex")}
    )


def test_plunge_of_a_formate_cut_is_the_feed_of_a_turn_by_the_sine_of_the_blade(vertical):
    """30 mm/min at 120 turns a minute are 0.25 mm a turn; blades of 15.948 and 23.848 degrees make 0.25 sin α of it."""
    plan = planned(vertical, "crown_gear_formate_14x39.toml", "gear", feed=30.0)
    for flank, load in loads(plan).items():
        assert load.blades is None
        assert load.roll is None
        assert load.plunge.advance == pytest.approx(0.25, rel=1e-3)  # getting up to speed takes some of the way
        assert load.plunge.chip == pytest.approx({"concave": 0.068690, "convex": 0.101080}[flank], rel=1e-3)


def test_plunge_to_the_first_point_of_a_roll_is_taken_as_if_through_metal(pinion):
    """200 mm/min at 120 turns a minute: 1.6667 mm a turn; at 18.0457 and 24.3374 degrees 0.5163 and 0.6868 mm."""
    found = loads(pinion)
    assert found["concave"].plunge.chip == pytest.approx(200 / 120 * np.sin(np.radians(18.045669752)), rel=1e-9)
    assert found["convex"].plunge.chip == pytest.approx(200 / 120 * np.sin(np.radians(24.337423854)), rel=1e-9)


def test_roll_advances_by_the_feed_at_the_tooth(pinion):
    """The feed is that past the tooth, 300 mm/min: 2.5 mm a turn where no axis slows it down."""
    for load in loads(pinion).values():
        assert load.roll.advance == pytest.approx(2.5, rel=0.02)  # the tooth that the feed counts at is one of a flank


def test_blades_share_what_a_turn_takes(pinion):
    alone, shared = loads(pinion), loads(pinion, with_blades(pinion.member, 8))
    for flank, load in shared.items():
        assert load.blades == 8
        assert load.roll.chip == pytest.approx(alone[flank].roll.chip / 8, rel=1e-12)
        assert load.plunge.advance == pytest.approx(alone[flank].plunge.advance / 8, rel=1e-12)


def test_chip_of_a_roll_is_by_what_the_cone_of_the_blade_comes_nearer_in_a_turn(pinion, witness):
    """The distance of the mean point from the cone, out of the cradle machine in plain NumPy: its largest rate."""
    last = {one.tool: one for one in pinion.passes}
    for flank, load in loads(pinion).items():
        one, spec = last[f"PINION_{flank.upper()}"], pinion.member.flank(flank)
        point = flank_points(pinion.member, flank, blank_grid(pinion.member, 1, 1)).point[0]
        center, axis = witness.pose(spec.vector, one.theta)
        off = point - center
        height = -np.sum(off * axis, axis=1)
        radius = np.linalg.norm(off + height[:, None] * axis, axis=1)
        alpha = np.radians(spec.blade_pressure_angle)
        distance = SIDES[flank] * (radius - spec.blade_point_radius) * np.cos(alpha) - height * np.sin(alpha)
        assert np.abs(distance).min() < 0.02  # it is touched on the way
        rate = np.abs(np.diff(distance) / one.seconds).max()
        assert load.roll.chip == pytest.approx(rate * 60 / RPM, rel=0.01)


def test_face_hobbing_cuts_a_space_once_in_a_turn_of_the_work(vertical):
    """The plunge of the program by the turns of A that it takes, and the chip by the 20 degrees of its blades."""
    plan = planned(vertical, "crown_gear_hobbed_14x39.toml", "pinion", spaces=tuple(range(14)))
    (one,) = plan.passes
    down = np.flatnonzero(np.diff(one.theta) == 0.0)
    turns = np.abs(np.diff(one.axes[down[[0, -1]] + [0, 1], 3]))[0] / (2 * np.pi)
    per_turn = (one.axes[0, 2] - one.axes[down[-1] + 1, 2]) / turns
    for load in loads(plan).values():
        assert load.blades == 1
        assert load.plunge.advance == pytest.approx(per_turn, rel=1e-6)
        assert load.plunge.chip == pytest.approx(per_turn * np.sin(np.radians(20.0)), rel=1e-6)
        assert 0 < load.roll.chip < load.roll.advance < 3.0

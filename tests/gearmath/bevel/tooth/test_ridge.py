"""The ridge between the cuts of two cutters for one flank each, against the tips moved along their whole way."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearmath.bevel.ridge import edge_taken, point_width, ridge, ridge_words
from gearmath.bevel.tooth import tooth_space
from gearmath.machine.milling.surfaces import Surface, left_by_exact_motion
from gearmath.specs.bevel_set import Member, load_bevel_set
from gearmath.specs.toml import bundled

#: Concave, convex and edge radius: the first as 55 % of the slot made them.
CUTTERS = ((1.115, 1.145, 0.5), (1.0, 1.0, 0.5), (1.1, 1.4, 0.5), (0.9, 0.9, 0.1))


@pytest.fixture(scope="module")
def pinion() -> Member:
    """Of edge radii of 0.5 mm and no stated point widths, which by 55 % of the slot were 1.115 and 1.145 mm."""
    return load_bevel_set(bundled("spiral_7x43.toml")).pinion


def of_widths(member: Member, concave: float, convex: float, **more: float) -> Member:
    widths = {"concave": concave, "convex": convex}
    return member.model_copy(
        update={
            flank: member.flank(flank).model_copy(update={"blade_point_width": width, **more})
            for flank, width in widths.items()
        }
    )


def left_in_the_middle(member: Member) -> float:
    """The highest of what the tools leave on chords across the root [mm], in steps of 4 µm."""
    space = tooth_space(member, 4)
    low, high = (flank.point[-1] for flank in space.ordered)
    share = np.linspace(0.41, 0.65, 121)[:, None, None]
    a, b = (np.stack([np.arctan2(p[:, 1], p[:, 0]), np.hypot(p[:, 0], p[:, 1]), p[:, 2]], axis=1) for p in (low, high))
    across = b - a
    across[:, 0] = (across[:, 0] + math.pi) % (2 * math.pi) - math.pi
    angle, radius, z = np.moveaxis(a + share * across, -1, 0)
    gamma = math.radians(member.blank.root_angle)
    up = np.stack([np.cos(gamma) * np.cos(angle), np.cos(gamma) * np.sin(angle), 0 * angle - np.sin(gamma)], axis=-1)
    point = np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=-1).reshape(-1, 3)
    index = np.zeros(len(point), dtype=int)
    lines = Surface("root", point, up.reshape(-1, 3), index, index, np.full(len(point), -1.0))
    return float(left_by_exact_motion(member, space, lines).max())


@pytest.mark.parametrize(("concave", "convex", "radius"), CUTTERS)
def test_height_is_what_the_moved_tips_leave(pinion, concave, convex, radius) -> None:
    """2 um: the root of each cut lies up to 1 um beside the chord, and a ridge has flanks of one in three at most."""
    member = of_widths(pinion, concave, convex, blade_edge_radius=radius)
    found = ridge(member, tooth_space(pinion))
    assert found == pytest.approx(left_in_the_middle(member), abs=2e-3)
    assert found > 3e-3


def test_chosen_point_widths_leave_none(pinion) -> None:
    assert ridge(pinion, tooth_space(pinion)) == 0.0
    assert left_in_the_middle(pinion) < 1.5e-3


def test_chosen_flat_of_the_tip_is_55_percent_of_the_slot_whatever_the_edge_radius(pinion) -> None:
    """The edge of radius r between flat and a blade of angle α takes r tan((90° - α)/2) of the tip."""
    slot = tooth_space(pinion).slots["concave"]
    for radius in (0.0, 0.3, 0.5):
        member = of_widths(pinion, 1.0, 1.0, blade_edge_radius=radius)
        taken = radius * math.tan(math.radians(90 - member.convex.blade_pressure_angle) / 2)
        assert edge_taken(member, "concave") == pytest.approx(taken, abs=1e-9)
        chosen = member.model_copy(update={"concave": member.concave.model_copy(update={"blade_point_width": None})})
        assert point_width(chosen, "concave", slot) == pytest.approx(0.55 * slot.most + taken, abs=1e-9)


def test_edges_that_do_not_meet_leave_a_fin(pinion) -> None:
    member = of_widths(pinion, 0.5, 0.5, blade_edge_radius=0.1)
    height = ridge(member, tooth_space(pinion))
    assert height == math.inf
    assert "a fin stays" in ridge_words(height)


def test_one_cutter_for_both_flanks_leaves_none() -> None:
    gear = load_bevel_set(bundled("spiral_7x43.toml")).gear
    assert ridge(gear, tooth_space(gear)) == 0.0

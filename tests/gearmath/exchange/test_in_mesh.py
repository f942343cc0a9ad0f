"""A pair in mesh as it turns: pitch cones roll on each other, and the flanks keep touching."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearmath.bevel.pair import load_pair
from gearmath.exchange.in_mesh import poses
from gearmath.specs.toml import bundled


@pytest.mark.parametrize("name", ["nasa_tp3096_12x36.toml", "spiral_7x43.toml"])
def test_pitch_cones_roll_on_each_other(name):
    """A point of the common line of the pitch cones moves alike with both members, to first order of the rotation."""
    pair, step = load_pair(bundled(name)), 1e-4
    delta, distance = math.radians(pair.member("pinion").blank.pitch_angle), 80.0
    before, after = poses(pair), poses(pair, rotation=step)
    moves = []
    for sign in (1, -1):
        line = distance * np.array([sign * math.sin(delta), 0.0, math.cos(delta)])
        for member in ("pinion", "gear"):
            own = before[member].matrix.T @ (line - before[member].shift)
            moves.append(after[member].of(own) - line)
    # on one of the two sides of the pinion's axis the gear meets it: there both move alike
    apart = [np.linalg.norm(moves[k] - moves[k + 1]) for k in (0, 2)]
    assert min(apart) < 1e-3 * np.linalg.norm(moves[0])
    assert np.linalg.norm(moves[0]) == pytest.approx(step * distance * math.sin(delta), rel=1e-3)


def test_after_a_pitch_both_members_stand_a_tooth_on():
    pair = load_pair(bundled("nasa_tp3096_12x36.toml"))
    before, after = poses(pair), poses(pair, rotation=2 * math.pi / 12)
    for member, teeth in (("pinion", 12), ("gear", 36)):
        turn = before[member].matrix.T @ after[member].matrix
        assert np.trace(turn) == pytest.approx(1 + 2 * math.cos(2 * math.pi / teeth), abs=1e-12)
        assert turn[2] == pytest.approx([0, 0, 1], abs=1e-12)
        assert after[member].shift == pytest.approx(before[member].shift, abs=1e-9)

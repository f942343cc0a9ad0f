"""Ease-off beside that of chapter 24, pattern beside the gap of surfaces that are rolled on each other."""

from __future__ import annotations

import numpy as np
import pytest

from gearmath.bevel.contact.pattern import envelope, pattern
from gearmath.bevel.contact.places import places
from gearmath.bevel.contact.report import SIDES, side_mesh, side_system
from gearmath.bevel.contact.system import Assembly
from gearmath.bevel.ease_off import ease_off
from gearmath.bevel.flank import blank_grid
from gearmath.specs.bevel_set import BevelSet


@pytest.mark.parametrize("side", SIDES)
def test_ease_off_is_that_of_the_pinion_turned_onto_its_conjugate(side: str, gear_set: BevelSet) -> None:
    # chapter 24 measures it as a gap of the pinion at its own place, without an assembly
    system = side_system(gear_set, side)
    found = places(system, np.zeros(4), 5, 9)
    grid = blank_grid(gear_set.gear, 5, 9, 0.0)
    other = ease_off(gear_set.pinion, gear_set.gear, gear_set.rad("shaft_angle"), SIDES[side], grid)
    own = -system.sense * (found.error - found.error[2, 4]) * np.abs(found.lever)
    # normals of both flanks differ by the slope of the ease-off, and so do the levers
    assert own == pytest.approx(other, rel=0.02, abs=2e-5)


def test_gap_is_the_least_in_the_course_of_the_mesh(uniform_pair, rolling) -> None:
    pair = uniform_pair(103.0, -1500.0)
    run = side_mesh(pair, "drive", Assembly())
    found, witness, system = pattern(run, rows=5, columns=9), rolling(pair, "concave", lowest=0.35), run.system
    rotations = np.linspace(-1.8, 1.8, 1201) * system.pitch
    ahead = envelope(run, rotations)
    turns = [_on_pinion(*witness.from_gear(*_fractions(5, 9), rotation)) for rotation in rotations]
    open_ = [
        first - system.sense * (turn + system.ratio * rotation)
        for first, turn, rotation in zip(ahead, turns, rotations, strict=True)
    ]
    lever = np.abs(places(system, run.assembly, 5, 9).lever)
    at = np.nan_to_num(open_, nan=np.inf).argmin(axis=0)
    near = [
        np.take_along_axis(np.array(open_), np.clip(at + by, 0, len(rotations) - 1)[None], 0)[0] for by in (-9, 0, 9)
    ]
    least = near[1] * lever
    # where the pinion's flank ends before, as the witness knows it, the least gap is elsewhere
    known = np.isfinite(found.gap) & np.isfinite(near).all(axis=0)
    assert known.sum() > 15
    assert found.gap[known] == pytest.approx(least[known], rel=0.03, abs=1e-4)


def _on_pinion(turn, _across, _up, across, up):
    """The rotation of the gear where a point meets the pinion's flank, NaN where that is beyond its borders."""
    return np.where((across >= 0) & (across <= 1) & (up >= 0.35) & (up <= 1), turn, np.nan)


def _fractions(rows: int, columns: int) -> tuple[np.ndarray, np.ndarray]:
    up, across = np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij")
    return across, up


def test_pattern_grows_with_the_thickness_and_stands_where_the_flanks_touch(uniform_pair) -> None:
    run = side_mesh(uniform_pair(103.0, -800.0), "drive", Assembly())
    thin, thick = pattern(run, 0.003), pattern(run, 0.0063)
    assert 0 < thin.figures["share"] < thick.figures["share"] < 1
    assert (thick.marked | ~thin.marked).all()
    touch, _ = run.at_mean
    distance, height = run.system.gear_place(touch.x)
    assert thin.figures["center_cone_distance_mm"] == pytest.approx(distance, abs=1.0)
    assert thin.figures["center_height_mm"] == pytest.approx(height, abs=1.0)


def test_gear_withdrawn_to_the_heel_takes_the_pattern_there(uniform_pair) -> None:
    pair = uniform_pair(103.0, -800.0)
    centers = []
    for V in (-0.05, 0.0, 0.05):
        run = side_mesh(pair, "drive", Assembly(V=V))
        touch, _ = run.at_mean
        centers.append((pattern(run).figures["center_cone_distance_mm"], run.system.gear_place(touch.x)[0]))
    moved = np.diff(np.array(centers), axis=0)
    assert (np.sign(moved[:, 0]) == np.sign(moved[:, 1])).all()  # as the exact contact goes

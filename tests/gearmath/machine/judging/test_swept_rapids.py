"""Rapid moves at random heights across a member, by rays: whatever meets the work is said by ``gearmath mill``.

The witness knows the work as a solid of revolution from the blank and the machine file, typed afresh, and the tool as
the space between two cones under a disc under a column. Every pose of a dense walk along the move is tried by rays that
run down from the tool, parallel to its axis: where one of them is in the tool and in the work at once, they meet.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearmath.bevel.tooth import SHARP_EDGE, tooth_space
from gearmath.machine.bodies.profiles import obstacles
from gearmath.machine.control.executor import execute
from gearmath.machine.control.state import Setup
from gearmath.machine.judging.collision import RAPID_CLEARANCE, collisions, rapid_approaches
from gearmath.machine.milling.run import runs_of
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.machine.writing.cutting import cutting_program
from gearmath.specs.bevel_set import MEMBERS

MOVES = 80
_STEP, _RINGS, _AROUND = 1.5, 9, 72


class Solid:
    """The work about its axis: for every z_w the radii between which there is metal."""

    def __init__(self, member, fixture):
        blank, delta = member.blank, math.radians(member.blank.pitch_angle)
        ends = blank.mean_cone_distance + np.array([-0.5, 0.5]) * blank.face_width
        up = blank.mean_addendum + (ends - blank.mean_cone_distance) * np.tan(np.radians(blank.face_angle) - delta)
        tip = np.column_stack([ends * np.cos(delta) - up * np.sin(delta), ends * np.sin(delta) + up * np.cos(delta)])
        depth = 2 * (blank.mean_addendum + blank.mean_dedendum)
        down = depth * np.array([math.sin(delta), -math.cos(delta)])
        root = tip + down
        self.loops = [np.array([tip[0], tip[1], root[1], root[0]])]
        shank = fixture.shank_radius or 0.6 * root[1, 1]
        behind = root[1, 0] + fixture.shank_length
        for low, high, radius in ((root[1, 0], behind, shank), (behind, behind + fixture.length, fixture.radius)):
            self.loops.append(np.array([[low, 0.0], [low, radius], [high, radius], [high, 0.0]]))

    def holds(self, points):
        """Whether points (n,3) are in metal: odd crossings of a ray outwards in the (z_w, radius) plane."""
        z, r = points[:, 2], np.hypot(points[:, 0], points[:, 1])
        inside = np.zeros(len(points), bool)
        for loop in self.loops:
            odd = np.zeros(len(points), bool)
            for a, b in zip(loop, np.roll(loop, -1, axis=0), strict=True):
                crosses = (a[0] > z) != (b[0] > z)
                with np.errstate(divide="ignore", invalid="ignore"):
                    odd ^= crosses & (r < a[1] + (z - a[0]) / (b[0] - a[0]) * (b[1] - a[1]))
            inside |= odd
        return inside


def tool_points(run, machine):
    """Points (n,3) that fill the tool on rays along its axis, x y and height above the tip plane."""
    body, head = run.cutter.bodies[0], machine.cutter_head
    top = run.cutter.height + head.height
    wide = body.outer.point_radius + run.cutter.height * math.tan(body.outer.pressure_angle)
    angle = np.linspace(0, 2 * math.pi, _AROUND, endpoint=False)
    rows = []
    for height in np.concatenate([np.linspace(0.0, run.cutter.height, 13), [run.cutter.height + 1.0, top, top + 40.0]]):
        if height <= run.cutter.height:
            low = body.inner.point_radius - height * math.tan(body.inner.pressure_angle)
            high = body.outer.point_radius + height * math.tan(body.outer.pressure_angle)
        else:
            low, high = 0.0, (wide + head.beyond_tip if height <= top else head.spindle_radius)
        rows += [(radius, height) for radius in np.linspace(low, high, 3 if height <= run.cutter.height else _RINGS)]
    radius, height = (np.repeat(part, _AROUND) for part in np.array(rows).T)
    around = np.tile(angle, len(rows))
    return np.column_stack([radius * np.cos(around), radius * np.sin(around), height])


def in_work(points, at, height):
    """Points of the tool at axes X Y Z A B, seen from the work."""
    x, y, z, a, b = at
    machine = points + np.array([0.0, 0.0, z - height])
    forward, side, level = machine[:, 0] + x, machine[:, 1] + y, machine[:, 2]
    x_w, z_w = -math.sin(b) * forward + math.cos(b) * level, -math.cos(b) * forward - math.sin(b) * level
    c, s = math.cos(a), math.sin(a)
    return np.column_stack([c * x_w - s * side, s * x_w + c * side, z_w])


@pytest.mark.slow
@pytest.mark.parametrize("member", MEMBERS)
def test_rapid_moves_that_meet_the_work_are_all_said(gear_set, vertical, member):
    spec, height = gear_set.member(member), vertical.gauge_line_height + vertical.tool_length
    path = execute(
        cutting_program(gear_set, member, vertical, "CUT", CuttingJob((0,), 5e-3)), "CUT", Setup.of(vertical)
    )
    (run, *_) = runs_of(path, spec, vertical, None, tooth_space(spec, 7), SHARP_EDGE)
    solid, points = Solid(spec, vertical.fixture), tool_points(run, vertical)
    middle = run.axes[run.cutting].mean(axis=0)
    random, met, unseen, alarms = np.random.default_rng(11), 0, [], 0
    for move in range(MOVES):
        ends = middle + random.uniform([-120, -120, -30, -1, -0.3], [120, 120, 90, 1, 0.3], (2, 5))
        if move % 2:  # indexing and level moves, as between two spaces
            ends[1, 2] = ends[0, 2]
            ends[1, 4] = ends[0, 4]
        way = np.abs(np.diff(ends, axis=0))[0]
        steps = 2 + int(max(way[:3].max() / _STEP, way[4] * 100))
        poses = ends[0] + np.linspace(0, 1, steps)[:, None] * (ends[1] - ends[0])
        really = any(solid.holds(in_work(points, pose, height)).any() for pose in poses)
        one = type(run)(run.cut, run.cutter, ends, np.zeros(2, bool), np.full(2, -1), np.array([1, 2]))
        said = bool(rapid_approaches([one], spec, vertical)) or bool(
            collisions(path, [one], spec, vertical, *obstacles(vertical))
        )
        met += really
        alarms += said and not really
        unseen += [ends.tolist()] if really and not said else []
    print(f"{member}: {MOVES} moves, {met} meet the work, {alarms} said besides (nearer than {RAPID_CLEARANCE:g} mm)")
    assert unseen == []
    assert 0.2 * MOVES < met < 0.95 * MOVES
    assert alarms < 0.15 * MOVES

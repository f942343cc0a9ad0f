"""What a probing program comes near, from its text: tip, stylus and spindle against the whole work and its fixture.

The executor runs the text with a probe that triggers where the tip meets the body of the tooth space. That is 5 µm
from where it would trigger on the flank itself, and moves nothing but the end of a touch: 100 times as fast as the
contact search of :class:`gearmath.machine.measuring.probe.ProbeMachine`, and as exact as the distances that are wanted.

Tip and stylus are looked at every 0.25 mm and 1 mm of their way, each of their points in the tooth space in which it
is, so that far teeth count as much as near ones; above the face cone the height over it is taken, a lower bound. To
them, what is round about the work axis is a profile. The spindle, a cylinder from the gauge line up, meets rings on
that profile, good to 0.1 mm. The housing of the probe between stylus and gauge line is in no file and left out.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from gearmath.bevel.turning import turned
from gearmath.kernels import kernel
from gearmath.machine.bodies.probe_tip import probe_height
from gearmath.machine.bodies.profiles import rings, seen_from_axes, work_profiles
from gearmath.machine.bodies.space_body import SpaceBody
from gearmath.machine.control.executor import STEP_LIMIT, run_program
from gearmath.machine.control.expression import refuse
from gearmath.machine.control.state import Probe, Setup
from gearmath.machine.measuring.probe import BODY_ERROR
from gearmath.specs.bevel_set import Member
from gearmath.specs.calibration import Calibration
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.obstacles import CutterHead, Fixture
from gearmath.specs.touch_csv import planned_touches

#: Steps of the tip along a block [mm], and of A and B [rad]; stylus and spindle are looked at less often.
_STEP, _TURN = 0.25, math.radians(1.0)
_STYLUS_EVERY, _SPINDLE_EVERY = 4, 20
#: Points of the stylus lie no farther apart. [mm]
_STYLUS_STEP = 1.0
#: Above the face cone by more than this, the height over it is distance enough. [mm]
_ABOVE = 2.0
#: Steps [mm] in which a touch is looked for.
_TOUCH_STEP = 0.05
#: Blocks are alike that differ by less than one of so many parts of a mm or rad.
_ALIKE = 1e4
_SAME = 1e-7
#: Blocks that a program runs through from one touch to the next are fewer.
_STEPS_OF_A_TOUCH = 200


@dataclass(frozen=True)
class Approach:
    """How near [mm] a part of the probe comes to a part of the work at most, and in which line; negative: in it.

    ``said`` is what the program says there, such as the point that it touches.
    """

    probe: str
    work: str
    distance: float
    line: int
    said: str = ""


@dataclass(frozen=True)
class _Block:
    """Poses X Y Z A B (n,5) of one block, whether it ends or begins at a touch, its line, and what was said there."""

    poses: np.ndarray
    touching: bool
    line: int
    said: str


def approaches(
    text: str,
    program: str,
    member: Member,
    machine: MillingMachine,
    calibration: Calibration,
    fixture: Fixture | None = None,
    spindle_radius: float = CutterHead().spindle_radius,
    progress: Callable[[int], object] = lambda steps: None,
    probe: Probe | None = None,
) -> list[Approach]:
    """The nearest approach of every pair of tip, stylus, spindle and teeth, hub, shank, fixture.

    ``probe`` says where touches end, by default at the body of the tooth space.

    A touch does not count, unless the tip goes deeper than the body of the space is exact. ``progress`` hears of
    every MEAS block that is run, and then of the lines of the text whose blocks are looked at.
    Raises InputError with line and column for a text that cannot be run, or that ends in an alarm.
    """
    watch = _Watch(member, machine, calibration, fixture or Fixture(), spindle_radius)
    nearest: dict[tuple[str, str], Approach] = {}
    done = 0
    for block in watch.blocks(text, program, probe or watch.probe, progress):
        for pair, distance in watch.distances(block):
            if pair not in nearest or distance < nearest[pair].distance:
                nearest[pair] = Approach(*pair, distance, block.line, block.said)
        progress(max(block.line - done, 0))
        done = max(block.line, done)
    return list(nearest.values())


class _Watch:
    """The probe and the work as bodies."""

    def __init__(
        self, member: Member, machine: MillingMachine, calibration: Calibration, fixture: Fixture, spindle_radius: float
    ) -> None:
        self.body, self.calibration, self.spindle_radius = SpaceBody(member), calibration, spindle_radius
        self.setup = Setup.of(machine, calibration.length)
        self._place = probe_height(machine, calibration), calibration.tip_offset, machine.pivot
        profiles = work_profiles(member, fixture)
        self._profiles = {part: _corners(profile) for part, profile in profiles.items() if part != "teeth"}
        self._rings = {part: rings(profile) for part, profile in profiles.items()}
        self._edge = profiles["teeth"][0]
        slope = np.subtract(profiles["teeth"][-1], self._edge)
        self._up = np.array([-slope[1], slope[0]]) / np.linalg.norm(slope)  # square to the face cone, outward

    def blocks(self, text: str, program: str, probe: Probe, progress: Callable[[int], object]) -> list[_Block]:
        """The blocks of a program, those that are the same in another space but once, at their first line."""

        def moved(start: np.ndarray, end: np.ndarray) -> np.ndarray | None:
            progress(1)
            return probe(start, end)

        done = run_program(text, program, moved, step_limit=enough_steps(text), setup=self.setup)
        if done.alarm is not None:
            why = f" ({done.messages[-1]})" if done.messages else ""
            refuse(program, done.alarm[1], 1, f"the program sets alarm {done.alarm[0]} on the nominal member{why}")
        path = done.path
        found: dict[tuple[bytes, bool], _Block] = {}
        for k in range(1, len(path.axes)):
            first, last = path.axes[k - 1], path.axes[k]
            touching = (path.measuring[k] and is_touch(first, last)) or (
                k > 1 and path.measuring[k - 1] and is_touch(path.axes[k - 2], first)
            )
            start, way = first.copy(), last - first
            start[3] %= self.body.pitch
            key = np.round(np.concatenate([start, way]) * _ALIKE).astype(int).tobytes(), bool(touching)
            if key not in found:
                steps = 2 + int(max(np.linalg.norm(way[:3]) / _STEP, np.abs(way[3:]).max() / _TURN))
                poses = first + np.linspace(0.0, 1.0, steps)[:, None] * way
                found[key] = _Block(poses, bool(touching), int(path.line[k]), done.said[k])
        return list(found.values())

    def probe(self, start: np.ndarray, end: np.ndarray) -> np.ndarray | None:
        """Where the tip meets the body on its way; straight down into the space it must meet nothing, and goes on."""
        if not is_touch(start, end):
            return None
        share = np.linspace(0.0, 1.0, 2 + int(np.linalg.norm(end[:3] - start[:3]) / _TOUCH_STEP))
        away = self._from_teeth(self._tip(start + share[:, None] * (end - start))[0]) - self.calibration.tip_radius
        inside = np.flatnonzero(away <= 0.0)
        if not len(inside):
            return None
        k = int(inside[0])
        if k > 0:
            share[k] = share[k - 1] + (share[k] - share[k - 1]) * away[k - 1] / (away[k - 1] - away[k])
        return start + share[k] * (end - start)

    def distances(self, block: _Block) -> Iterator[tuple[tuple[str, str], float]]:
        """The least distance [mm] of each pair during one block."""
        probe = self.calibration
        tip, stylus = self._tip(block.poses)
        heights = np.arange(0.0, probe.stylus_length, min(_STYLUS_STEP, probe.stylus_radius))
        some = _every(len(tip), _STYLUS_EVERY)
        stem = (tip[some, None] + heights[heights > probe.tip_radius, None] * stylus[some, None]).reshape(-1, 3)
        for part, points, radius in (("tip", tip, probe.tip_radius), ("stylus", stem, probe.stylus_radius)):
            away = self._from_teeth(points) - radius
            if block.touching and part == "tip":
                away = away[away < -BODY_ERROR]
            yield (part, "teeth"), float(away.min(initial=math.inf))
            place = _place(points)
            for work, profile in self._profiles.items():
                yield (part, work), float(_to_segments(place, profile[:-1], profile[1:]).min()) - radius
        poses = block.poses[_every(len(tip), _SPINDLE_EVERY)][1:]  # the first one was the last of the block before
        for work, ring in self._rings.items():
            yield ("spindle", work), self._of_spindle(poses, ring)

    def _tip(self, axes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Centre of the tip and direction of the stylus (n,3) in the work."""
        tip, stylus = kernel("probe_tip")(axes, *self._place)
        return tip, stylus

    def _from_teeth(self, points: np.ndarray) -> np.ndarray:
        """Distances (n,) of points (n,3) from the spaces in which they are, or their heights over the face cone."""
        away = (_place(points) - self._edge) @ self._up
        low = away < _ABOVE
        if low.any():
            near = points[low]
            away[low] = self.body.clearance(turned(near, -self.body.spaces_of(near) * self.body.pitch))
        return away

    def _of_spindle(self, poses: np.ndarray, ring: np.ndarray) -> float:
        """How far [mm] points (m,3) at least lie from a cylinder that stands on the gauge line; negative in it."""
        height, _, pivot = self._place
        axis, up = kernel("probe_tip")(poses, height, np.zeros(3), pivot)
        along, radius = seen_from_axes(ring, axis, up)
        below, beside = self.calibration.length - along, radius - self.spindle_radius
        outside = np.hypot(np.maximum(below, 0.0), np.maximum(beside, 0.0))
        return float((outside + np.minimum(np.maximum(below, beside), 0.0)).min())


def enough_steps(text: str) -> int:
    """The steps that a probing program may take: more than usual where it plans very many touches."""
    return max(STEP_LIMIT, _STEPS_OF_A_TOUCH * planned_touches(text))


def is_touch(start: np.ndarray, end: np.ndarray) -> bool:
    """Whether a MEAS block between two positions (5,) is a touch: neither straight down, nor sideways at one height."""
    x, y, z, a, b = np.abs(end - start).tolist()
    return max(x, y) > _SAME and z > _SAME and max(a, b) <= _SAME


def _to_segments(place: np.ndarray, first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Distances (n,m) of points (n,2) from straight lines between ends (m,2)."""
    way = last - first
    length = np.maximum((way**2).sum(axis=1), 1e-12)
    share = np.clip(((place[:, None] - first) * way).sum(axis=2) / length, 0.0, 1.0)
    return np.linalg.norm(place[:, None] - first - share[..., None] * way, axis=2)


def _every(count: int, step: int) -> np.ndarray:
    """Every ``step``-th of ``count`` numbers, and the last one."""
    return np.append(np.arange(0, count - 1, step), count - 1)


def _corners(profile: np.ndarray) -> np.ndarray:
    """The points (m,2) of a profile between which it is straight."""
    profile = profile[np.append(True, np.linalg.norm(np.diff(profile, axis=0), axis=1) > _SAME)]
    way = np.diff(profile, axis=0)
    way /= np.linalg.norm(way, axis=1)[:, None]
    bends = np.linalg.norm(np.diff(way, axis=0), axis=1) > _SAME
    return profile[np.concatenate([[True], bends, [True]])]


def _place(points: np.ndarray) -> np.ndarray:
    """z_w and radius (n,2) of points (n,3)."""
    return np.column_stack([points[:, 2], np.hypot(points[:, 0], points[:, 1])])

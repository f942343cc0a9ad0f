"""Whether a machine may run a program: travel, speeds, spindle, stated modes, and rapid motion clear of the work.

What the program leaves of the metal is judged by :mod:`gearmath.machine.watch` and :mod:`gearmath.machine.stock`. Here
is what an inspector of machines looks for, in every block, and over the whole way of a block and not at its end alone.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from gearmath.bevel.method import motion_of
from gearmath.machine.bodies import obstacles
from gearmath.machine.collision import RAPID_CLEARANCE, collisions, rapid_approaches
from gearmath.machine.executor import MachinePath
from gearmath.machine.feeds import accelerations
from gearmath.machine.path import Cut, axis_positions
from gearmath.machine.run import Run
from gearmath.machine.simulation import roll_position
from gearmath.machine.watch import in_space_0
from gearmath.specs.bevel_set import Member
from gearmath.specs.milling_machine import MillingMachine

#: Speeds and accelerations may pass their limits by this part: the rounding of block times.
_SLACK = 1e-3
#: Where a block ends further than this beside the path of the settings, it cuts where it should not. [mm]
_ASIDE = 0.05
_SPACES = re.compile(r"^; spaces: ([0-9,]+)", re.MULTILINE)


@dataclass(frozen=True)
class Fault:
    """One thing that a machine must not do: a sentence, and the line of the program, 0 for the whole of it."""

    what: str
    line: int = 0

    def __str__(self) -> str:
        return f"line {self.line} {self.what}" if self.line else self.what


def faults_of(
    text: str, path: MachinePath, runs: list[Run], member: Member, name: str, machine: MillingMachine
) -> list[Fault]:
    """What a machine without errors must not do of a program, the first of each kind."""
    found = [*_unstated(path), *_spindle(path, machine), *_travel(path, machine), *_speeds(path, machine)]
    found += _missing(text, runs, member, name)
    if member.process != "face_hobbing":
        found += _beside_the_path(runs, member, machine)
    found += [
        Fault(f"takes the {one.cutter} {one.depth:.2f} mm into the {one.work}", one.lines[0])
        for one in collisions(path, runs, member, machine, *obstacles(machine))
    ]
    found += [
        Fault(
            f"moves in rapid {one.depth:.2f} mm into the work or nearer to it than {RAPID_CLEARANCE:g} mm", one.lines[0]
        )
        for one in rapid_approaches(runs, member, machine)
    ]
    return found


def _unstated(path: MachinePath) -> Iterator[Fault]:
    if path.unstated:
        yield Fault(f"the program moves before it states {', '.join(path.unstated)}")


def _spindle(path: MachinePath, machine: MillingMachine) -> Iterator[Fault]:
    """Sense and speed where metal can be cut: in feed, but for probing and for a spindle that is an axis."""
    cutting = ~path.rapid & ~path.measuring & ~np.isfinite(path.cutter)
    low, high = machine.spindle_speed_rpm
    sense = 1.0 if machine.cutter_direction == "M3" else -1.0
    for wrong, what in (
        (path.rpm == 0.0, "cuts with the spindle standing"),
        (path.rpm * sense < 0.0, f"cuts with the spindle turning backwards: {machine.name} cuts with "
         f"{machine.cutter_direction}"),
        ((np.abs(path.rpm) > high) | ((np.abs(path.rpm) < low) & (path.rpm != 0.0)),
         f"cuts at a speed outside of {low:g} to {high:g} rpm"),
    ):  # fmt: skip
        rows = np.flatnonzero(wrong & cutting)
        if len(rows):
            yield Fault(what, int(path.line[rows[0]]))


def _positions(path: MachinePath, machine: MillingMachine) -> np.ndarray:
    """Positions (n,5), or (n,6) with the cutter's axis where it is one; NaN where it is not."""
    if np.isfinite(path.cutter).any() and machine.axes.C is not None:
        return np.column_stack([path.axes, path.cutter])
    return path.axes


def _travel(path: MachinePath, machine: MillingMachine) -> Iterator[Fault]:
    positions = _positions(path, machine)
    limits = machine.limits(positions.shape[1])
    low, high = limits.travel.T
    half = np.append(machine.control.half_increments, machine.control.half_increments[-1])[: positions.shape[1]]
    outside = np.argwhere((positions < low - half) | (positions > high + half))
    if len(outside):
        row, axis = outside[0]
        scale, unit = limits.scale[axis], limits.units[axis]
        yield Fault(
            f"moves {limits.names[axis]} to {positions[row, axis] * scale:.3f} {unit}: {machine.name} travels "
            f"{low[axis] * scale:g} to {high[axis] * scale:g} {unit}", int(path.line[row]),
        )  # fmt: skip


def _speeds(path: MachinePath, machine: MillingMachine) -> Iterator[Fault]:
    """Speed of every feed block, and what it has to gain on its neighbours without a stop between them."""
    positions = _positions(path, machine)
    limits = machine.limits(positions.shape[1])
    feed = np.flatnonzero(~path.rapid & (path.seconds > 0.0) & (np.arange(len(path.rapid)) > 0))
    for rows in np.split(feed, np.flatnonzero(np.diff(feed) > 1) + 1):
        if not len(rows):
            continue
        steps = np.nan_to_num(positions[rows] - positions[rows - 1])
        seconds = path.seconds[rows]
        for values, limit, per, what in (
            (np.abs(steps) / seconds[:, None], limits.max_speed, 60.0, "/min"),
            (np.abs(accelerations(steps, seconds))[:-1], limits.max_acceleration, 1.0, "/s2"),
        ):
            over = np.argwhere(values > limit * (1.0 + _SLACK))
            if len(over):
                row, axis = over[0]
                scale, unit = limits.scale[axis] * per, limits.units[axis]
                yield Fault(
                    f"needs {values[row, axis] * scale:.0f} {unit}{what} of {limits.names[axis]}: {machine.name} "
                    f"allows {limit[axis] * scale:g} {unit}{what}", int(path.line[rows[row]]),
                )  # fmt: skip
                return


def _missing(text: str, runs: list[Run], member: Member, name: str) -> Iterator[Fault]:
    """Spaces that the program says it cuts and does not, with any of the tools of the member."""
    wanted = {int(part) for line in _SPACES.findall(text) for part in line.split(",") if part}
    if not wanted:
        return
    cut = {run.cut.tool: set(run.spaces) for run in runs}
    for one in Cut.of(member, name):
        lacking, more = sorted(wanted - cut.get(one.tool, set())), sorted(cut.get(one.tool, set()) - wanted)
        if lacking:
            yield Fault(f"space {lacking[0]} is not cut with {one.tool}, {len(lacking)} of {len(wanted)} are not")
        if more:
            yield Fault(f"space {more[0]} is cut with {one.tool}, and should not be")


def _beside_the_path(runs: list[Run], member: Member, machine: MillingMachine) -> Iterator[Fault]:
    """Feed blocks that end where the settings have no position, in X Y A B, or in Z below it."""
    reach = float(member.blank.mean_cone_distance + member.blank.face_width / 2)
    for run in runs:
        spec = member.flank(run.cut.flanks[0])
        rows, axes = in_space_0(run, member)
        theta = np.zeros(len(rows))
        if member.generation == "generated":
            theta, _ = roll_position()(spec.vector, axes[:, 0], axes[:, 1], machine.pivot, motion_of(spec))
        off = axes - axis_positions(spec, theta, machine.pivot_height, machine.pivot)
        off[:, 3] -= 2 * math.pi * np.round(off[:, 3] / (2 * math.pi))
        aside = np.abs(off * np.array([1.0, 1.0, 0.0, reach, reach])).max(axis=1)
        aside = np.maximum(aside, -off[:, 2])
        if len(aside) and aside.max() > _ASIDE:
            row = int(np.argmax(aside > _ASIDE))
            yield Fault(f"ends {aside[row]:.3f} mm beside the path of these settings", int(run.line[rows[row]]))

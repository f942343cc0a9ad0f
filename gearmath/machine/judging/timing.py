"""How long an executed program takes, and how fast its axes have to be."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmath.machine.control.executor import MachinePath
from gearmath.specs.milling_machine import MillingMachine


@dataclass(frozen=True)
class AxisSpeed:
    """The highest speed of one axis in cutting feed [mm/min, degrees/min], its limit, and the line that needs it."""

    axis: str
    speed_per_min: float
    limit_per_min: float
    line: int


@dataclass(frozen=True)
class Timing:
    """Seconds in feed and in rapid motion, and the axes. Rapid blocks run at full speed, without time to accelerate."""

    feed_seconds: float
    rapid_seconds: float
    axes: tuple[AxisSpeed, ...]


def timing(path: MachinePath, machine: MillingMachine) -> Timing:
    """Times and speeds of a program on a machine, with C where the program turns it.

    A tool change interrupts the path and is not counted.
    """
    positions = path.axes
    if np.isfinite(path.cutter).any() and machine.axes.C is not None:
        positions = np.column_stack([path.axes, path.cutter])
    steps = np.abs(np.nan_to_num(np.diff(positions, axis=0, prepend=positions[:1])))
    limits = machine.limits(positions.shape[1])
    steps[1:][path.tool[1:] != path.tool[:-1]] = 0.0
    short = np.abs(np.remainder(steps[:, 3::2] + np.pi, 2 * np.pi) - np.pi)
    steps[:, 3::2] = np.where(path.rapid[:, None], short, steps[:, 3::2])
    rapid = float((steps[path.rapid] / limits.max_speed).max(axis=1, initial=0.0).sum())
    moving = ~path.rapid & (path.seconds > 0.0)
    speeds = steps[moving] / path.seconds[moving][:, None]
    axes = []
    for k, axis in enumerate(limits.names):
        fastest = int(speeds[:, k].argmax()) if len(speeds) else 0
        speed = float(speeds[fastest, k]) if len(speeds) else 0.0
        line = int(path.line[moving][fastest]) if len(speeds) else 0
        scale = 60.0 * float(limits.scale[k])
        axes.append(AxisSpeed(axis, speed * scale, float(limits.max_speed[k]) * scale, line))
    return Timing(float(path.seconds.sum()), rapid, tuple(axes))

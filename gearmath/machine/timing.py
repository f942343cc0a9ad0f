"""How long an executed program takes, and how fast its axes have to be."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmath.machine.executor import MachinePath
from gearmath.specs.milling_machine import AXES, UNITS_PER_INTERNAL, MillingMachine


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
    """Times and speeds of a program on a machine; a tool change interrupts the path and is not counted."""
    steps = np.abs(np.diff(path.axes, axis=0, prepend=path.axes[:1]))
    steps[1:][path.tool[1:] != path.tool[:-1]] = 0.0
    steps[:, 3] = np.where(path.rapid, np.abs(np.remainder(steps[:, 3] + np.pi, 2 * np.pi) - np.pi), steps[:, 3])
    rapid = float((steps[path.rapid] / machine.max_speed).max(axis=1, initial=0.0).sum())
    moving = ~path.rapid & (path.seconds > 0.0)
    speeds = steps[moving] / path.seconds[moving][:, None]
    axes = []
    for k, axis in enumerate(AXES):
        fastest = int(speeds[:, k].argmax()) if len(speeds) else 0
        speed = float(speeds[fastest, k]) if len(speeds) else 0.0
        line = int(path.line[moving][fastest]) if len(speeds) else 0
        scale = 60.0 * float(UNITS_PER_INTERNAL[k])
        axes.append(AxisSpeed(axis, speed * scale, float(machine.max_speed[k]) * scale, line))
    return Timing(float(path.seconds.sum()), rapid, tuple(axes))

"""The speed of a pass: what the program asks for, and what the axes can."""

from __future__ import annotations

import numpy as np

from gearmath.machine.control.executor import MachinePath
from gearmath.machine.judging.look_ahead import path_length
from gearmath.machine.judging.trajectory import Trajectory
from gearmath.plot.figure import Figure
from gearmath.plot.style import AFTER, NOMINAL
from gearmath.specs.milling_machine import MillingMachine

#: Rows slower than this are no motion. [s]
_LEAST = 1e-9


def speed_figure(path: MachinePath, found: Trajectory, machine: MillingMachine) -> Figure:
    """Speed along the path [mm/min, a degree counted as a mm] over the time of the first row of feed blocks."""
    rows = first_pass(path)
    figure = Figure(figsize=(7.0, 3.2), layout="constrained")
    axes = figure.add_subplot()
    length = (
        path_length(np.diff(path.axes[[rows[0] - 1, *rows]], axis=0), machine.limits(5)) if len(rows) else np.zeros(0)
    )
    for seconds, color, label in (
        (path.seconds[rows], NOMINAL, "programmed"),
        (found.seconds[rows], AFTER, "as the axes move"),
    ):
        moving = seconds > _LEAST
        ends = np.concatenate([[0.0], np.cumsum(seconds[moving])])
        axes.stairs(60.0 * length[moving] / seconds[moving], ends, color=color, label=label, linewidth=1.2)
    axes.set_xlabel("time / s")
    axes.set_ylabel("speed / (mm/min), 1° as 1 mm")
    axes.legend(loc="best", fontsize=8, frameon=False)
    return figure


def first_pass(path: MachinePath) -> np.ndarray:
    """Rows of the first feed blocks behind each other that roll: the plunge before them is left out."""
    feed = np.flatnonzero(~path.rapid)
    feed = feed[feed > 0]
    if not len(feed):
        return feed
    behind = np.flatnonzero(path.rapid[feed[0] :])
    end = feed[0] + behind[0] if len(behind) else len(path.rapid)
    rows = np.arange(feed[0], end)
    rolls = np.diff(path.axes[[rows[0] - 1, *rows]], axis=0)[:, [0, 1, 3, 4]].any(axis=1)
    return rows[np.argmax(rolls) :] if rolls.any() else rows

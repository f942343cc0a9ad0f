"""A program as a control moves the axes: how long it takes, where it is slow, and how far it leaves the path.

The axes stand at the ends of rapid blocks and of those that measure, at dwells and stops, and where the tool is
changed; feed blocks between these are one run. The spindle, the tool change and the waiting of a program take what the
program says, and no more.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, fields, replace

import numpy as np

from gearmath.errors import InputError
from gearmath.machine.control.executor import MachinePath
from gearmath.machine.judging.look_ahead import FollowedRun, RoundedCorners, follow, path_length
from gearmath.machine.judging.parabolic import follow_parabolic
from gearmath.specs.milling_machine import AxisLimits, MillingMachine

#: Where a control is slow: this part of the speed that the block asks for, or less.
SLOW = 0.5
#: Where two blocks of POLY meet, the path has a corner if it turns by more than this times what it does beside.
_AS_SMOOTH = 3.0


@dataclass(frozen=True)
class Trajectory:
    """What a program takes [s], as it is asked and as it is; corners; how far they leave the path.

    ``slow_corners`` of ``corners`` between feed blocks run at less than half of the asked speed, the slowest at
    ``slowest_speed_share`` of it in ``slowest_line``; the exact stops at both ends of a run are not among them. X Y Z
    leave the path by ``contour_error_um`` at most, A and B by ``orientation_error_arcsec``, and all together, a degree
    counted as a mm, by ``path_error_um``, in ``worst_line``.
    """

    blocks: int
    polynomial_blocks: int
    asked_seconds: float
    feed_seconds: float
    rapid_seconds: float
    dwell_seconds: float
    corners: int
    slow_corners: int
    slowest_speed_share: float
    slowest_line: int
    contour_error_um: float
    orientation_error_arcsec: float
    path_error_um: float
    worst_line: int
    seconds: np.ndarray
    """What each row of the path takes, (n,) s."""

    def as_dict(self) -> dict[str, float]:
        """For JSON: all figures, and the time of all together."""
        figures = {one.name: getattr(self, one.name) for one in fields(self) if one.name != "seconds"}
        return {"total_seconds": self.total_seconds} | figures

    @property
    def total_seconds(self) -> float:
        """Feed, rapid motion and dwells [s]."""
        return self.feed_seconds + self.rapid_seconds + self.dwell_seconds


def corners_of(path: MachinePath, machine: MillingMachine) -> RoundedCorners:
    """What the path mode of the program allows, at most; of the machine file where the program says no tolerance."""
    modes = list(path.path_modes)
    if modes and all(mode == "G60" for mode, _, _ in modes):
        return RoundedCorners(0.0, 0.0)
    stated = [(linear, math.radians(turning)) for mode, linear, turning in modes if mode == "G642"]
    if not stated:
        return RoundedCorners(*machine.control.path_tolerance)
    return RoundedCorners(max(linear for linear, _ in stated), max(turning for _, turning in stated))


def trajectory(
    path: MachinePath,
    machine: MillingMachine,
    corners: RoundedCorners | None = None,
) -> Trajectory:
    """The motion of an executed program on the control that the machine file names.

    Corners are rounded as the program says, or as ``corners`` do. Raises InputError for polynomials on a LinuxCNC.
    """
    parabolic = machine.control.kind == "linuxcnc"
    if parabolic and path.inner.any():
        line = int(path.line[np.argmax(path.inner)])
        raise InputError(f"line {line} is a block of POLY: LinuxCNC, which {machine.name} has, reads none")
    corners = corners_of(path, machine) if corners is None else corners
    cutter = np.isfinite(path.cutter).any() and machine.axes.C is not None
    where = np.column_stack([path.axes, np.nan_to_num(path.cutter)]) if cutter else path.axes
    limits = machine.limits(where.shape[1])
    if machine.control.jerk == "BRISK":
        limits = replace(limits, max_jerk=np.full(len(limits.max_jerk), np.inf))
    found = _Found(path, limits)
    inner = path.inner if len(path.inner) else np.zeros(len(path.axes), dtype=bool)
    for rows in _runs(path):
        positions = where[[rows[0] - 1, *rows]]
        if path.rapid[rows[0]]:
            positions = _short_way(positions)
            run = follow(positions, np.zeros(len(rows)), np.zeros(0, dtype=bool), limits, RoundedCorners(0.0, 0.0))
        elif parabolic:
            run = follow_parabolic(positions, path.seconds[rows], limits, corners)
        else:
            run = follow(positions, path.seconds[rows], _smooth(positions, inner[rows[:-1]], limits), limits, corners)
        found.add(rows, positions, run, inner[rows[:-1]])
    return found.result(sum(halt.seconds for halt in path.halts))


def _runs(path: MachinePath) -> list[np.ndarray]:
    """Rows of the path from standstill to standstill; the first row has no known way to it."""
    count = len(path.rapid)
    still = np.zeros(count + 1, dtype=bool)
    still[:2] = still[-1] = True  # the first row is where the axes stand
    still[1:][path.rapid] = True  # after a rapid block
    still[:-1][path.rapid] = True  # and before one
    if len(path.measuring):
        still[1:][path.measuring] = True  # the rest of the way is deleted
    still[1:-1][path.tool[1:] != path.tool[:-1]] = True
    for halt in path.halts:
        still[halt.rows] = True
    bounds = np.flatnonzero(still)
    runs = [np.arange(a, b) for a, b in itertools.pairwise(bounds)]
    return [rows for rows in runs if rows[0] > 0 and path.tool[rows[0] - 1] == path.tool[rows[0]]]


def _smooth(positions: np.ndarray, inner: np.ndarray, limits: AxisLimits) -> np.ndarray:
    """Whether the path has no corner at inner positions (n,): within blocks of POLY, and where these meet smoothly."""
    steps = np.diff(positions, axis=0) * limits.scale
    unit = steps / np.maximum(np.linalg.norm(steps, axis=1), 1e-12)[:, None]
    turn = np.linalg.norm(np.diff(unit, axis=0), axis=1)
    before, after = np.insert(inner[:-1], 0, False), np.append(inner[1:], False)
    beside = np.maximum(np.insert(turn[:-1], 0, 0.0), np.append(turn[1:], 0.0))
    return inner | (before & after & (turn <= _AS_SMOOTH * beside))


def _short_way(positions: np.ndarray) -> np.ndarray:
    """A rapid block with its modulo axes going the short way."""
    ends = positions.copy()
    turn = ends[1, 3::2] - ends[0, 3::2]
    ends[1, 3::2] = ends[0, 3::2] + np.remainder(turn + math.pi, 2 * math.pi) - math.pi
    return ends


class _Found:
    """What all runs add up to."""

    def __init__(self, path: MachinePath, limits: AxisLimits) -> None:
        self.path, self.limits = path, limits
        self.seconds, self.asked = np.zeros(len(path.rapid)), 0.0
        self.shares: list[tuple[float, int]] = []
        self.errors: list[tuple[float, float, float, int]] = []

    def add(self, rows: np.ndarray, positions: np.ndarray, run: FollowedRun, inner: np.ndarray) -> None:
        """Take one run to the others."""
        self.seconds[rows] = run.seconds
        self.asked += float(self.path.seconds[rows].sum())
        if self.path.rapid[rows[0]] or len(rows) < 2:
            return
        length = path_length(np.diff(positions, axis=0), self.limits)
        asked = np.maximum(self.path.seconds[rows], 1e-9)
        wanted = np.minimum((length / asked)[1:], (length / asked)[:-1])
        lines = self.path.line[rows[:-1]]
        mean = length / np.maximum(run.seconds, 1e-12)
        slow = np.minimum(mean[1:], mean[:-1]) if run.speed[1:-1].max(initial=0.0) == 0.0 else run.speed[1:-1]
        share = np.minimum(slow / np.maximum(wanted, 1e-12), 1.0)
        together = np.hypot(run.rounded, np.degrees(run.turned))
        for k in np.flatnonzero(~inner):
            self.shares.append((float(share[k]), int(lines[k])))
            self.errors.append((float(together[k]), float(run.rounded[k]), float(run.turned[k]), int(lines[k])))

    def result(self, dwells: float) -> Trajectory:
        """All of it."""
        rapid, path = self.path.rapid, self.path
        slowest = min(self.shares, default=(1.0, 0))
        worst = max(self.errors, default=(0.0, 0.0, 0.0, 0))
        inner = path.inner if len(path.inner) else np.zeros(len(rapid), dtype=bool)
        return Trajectory(
            blocks=int((~rapid & ~inner)[1:].sum()),
            polynomial_blocks=int((np.diff(inner.astype(int), append=0) == -1).sum()),
            asked_seconds=self.asked,
            feed_seconds=float(self.seconds[~rapid].sum()),
            rapid_seconds=float(self.seconds[rapid].sum()),
            dwell_seconds=dwells,
            corners=len(self.shares),
            slow_corners=sum(share < SLOW for share, _ in self.shares),
            slowest_speed_share=slowest[0],
            slowest_line=slowest[1],
            contour_error_um=1e3 * max((error[1] for error in self.errors), default=0.0),
            orientation_error_arcsec=3600.0 * math.degrees(max((error[2] for error in self.errors), default=0.0)),
            path_error_um=1e3 * worst[0],
            worst_line=worst[3],
            seconds=self.seconds,
        )

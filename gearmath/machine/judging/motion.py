"""What a machine must not do of a program, whatever it cuts: modes, spindle, travel, speeds and feeds, blind motion.

Every check yields a fault for each row of the path that has it, so that a changed block can be judged by itself.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gearmath.machine.control.executor import MachinePath
from gearmath.machine.judging.faults import Fault
from gearmath.machine.judging.feed import STATED_SLACK, feed_limits, feeds
from gearmath.machine.judging.stated import Stated
from gearmath.machine.milling.run import CuttingRun
from gearmath.machine.planning.clear_space import clear_height, room_of
from gearmath.specs.bevel_set import Member
from gearmath.specs.milling_machine import MillingMachine

#: Speeds and accelerations may pass their limits by this part: the rounding of block times.
_SLACK = 1e-3
#: And a height its limit. [mm]
_HEIGHT_SLACK = 1e-3


def motion_faults(
    path: MachinePath, runs: list[CuttingRun], member: Member, machine: MillingMachine, stated: Stated
) -> Iterator[Fault]:
    """All faults of motion, kind by kind."""
    yield from states(path, machine)
    if path.blind or path.changes:
        needed = clear_height(room_of(member, machine, machine.fixture), machine, machine.tool_length)
        yield from blind_motion(path, needed)
    yield from spindle(path, machine, stated)
    yield from travel(path, machine)
    yield from speeds(path, machine)
    yield from feeds(path, runs, member, machine, stated)
    if not stated.raised:
        yield from feed_limits(path, runs, member, machine)
    yield from waiting(path)
    if stated.coolant:
        yield from dry(path)


def states(path: MachinePath, machine: MillingMachine) -> Iterator[Fault]:
    """Modal states that are not stated, or not as the machine file has them, and parameters that hold anything."""
    if path.unstated:
        yield Fault(f"the program moves before it states {', '.join(path.unstated)}")
    for number, line in path.unset.items():
        yield Fault(
            f"reads R{number} before it sets it: it has there what another program left, here it counts as 0", line, "R"
        )
    yield from path_modes(path, machine)


def waiting(path: MachinePath) -> Iterator[Fault]:
    """Dwells, stops and a spindle that is switched off with the cutter in the cut: between two feed blocks, and a stop
    after the last one too.
    """
    for halt in path.halts:
        before, after = halt.rows - 1, halt.rows
        if before < 0 or path.rapid[before] or path.measuring[before]:
            continue
        if halt.stop or (after < len(path.rapid) and not path.rapid[after]):
            yield Fault("lets the cutter stand in the cut", halt.line, "waiting")


def dry(path: MachinePath) -> Iterator[Fault]:
    """Feed blocks without coolant."""
    for row in np.flatnonzero(~path.rapid & ~path.coolant)[:1]:
        yield Fault("cuts without coolant (M8)", int(path.line[row]), "coolant")


def path_modes(path: MachinePath, machine: MillingMachine) -> Iterator[Fault]:
    """Path modes that round corners by more than the machine file allows."""
    control = machine.control
    within, turned = control.contour_tolerance_um / 1000, control.orientation_tolerance_arcsec / 3600
    for (mode, contour, orientation), line in path.path_modes.items():
        if mode in ("", "G60"):
            continue
        if mode != "G642" or control.path_mode != "G642":
            yield Fault(f"cuts with {mode}, the machine file has {control.path_mode}", line, "path mode")
        elif contour > within * (1 + STATED_SLACK) or orientation > turned * (1 + STATED_SLACK):
            yield Fault(
                f"cuts with CTOL={contour:g} OTOL={orientation:g}, the machine file allows {within:g} mm and "
                f"{turned:.3g} degrees",
                line,
                "path mode",
            )

    wanted = control.jerk, "FFWON" if control.feed_forward else "FFWOF"
    for found, line in path.dynamics.items():
        for is_there, should_be in zip(found, wanted, strict=True):
            if is_there not in ("", should_be):
                yield Fault(f"cuts with {is_there}, the machine file has {should_be}", line, should_be)


def blind_motion(path: MachinePath, clear: float) -> Iterator[Fault]:
    """Motion from wherever the axes stand, at the start and after a tool change: Z goes home before all else.

    From Z = ``clear`` [mm] on the tool clears the work however the axes stand.
    """
    needed = clear - _HEIGHT_SLACK
    for line, z in path.changes:
        if z is None or z < needed:
            yield Fault(f"changes the tool before Z has gone up to {needed:.1f} mm or more with SUPA", line, "change")
    for one in path.blind:
        if one.z is None or (one.raised and one.z < needed):
            yield Fault(
                f"moves before Z has gone up to {needed:.1f} mm or more with SUPA, from wherever the axes stand",
                one.line,
                "blind",
            )
        elif one.z < needed:
            yield Fault(
                f"moves at Z {one.z:.3f} while other axes may stand anywhere: the work is cleared from Z {needed:.1f} "
                "on",
                one.line,
                "blind",
            )


def spindle(path: MachinePath, machine: MillingMachine, stated: Stated) -> Iterator[Fault]:
    """Sense and speed where metal can be cut: in feed, but for probing and for a spindle that is an axis."""
    cutting = ~path.rapid & ~path.measuring & ~np.isfinite(path.cutter)
    low, high = machine.spindle_speed_rpm
    sense = 1.0 if machine.cutter_direction == "M3" else -1.0
    speed, wanted = np.abs(path.rpm), stated.rpm
    for wrong, what in (
        (path.rpm == 0.0, "cuts with the spindle standing"),
        (
            path.rpm * sense < 0.0,
            f"cuts with the spindle turning backwards: {machine.name} cuts with {machine.cutter_direction}",
        ),
        ((speed > high) | ((speed < low) & (speed != 0.0)), f"cuts at a speed outside of {low:g} to {high:g} rpm"),
        (
            np.abs(speed - (wanted or 0.0)) > STATED_SLACK * (wanted or np.inf),
            f"cuts at another speed than the {wanted or 0.0:g} rpm that the program states",
        ),
    ):
        for row in np.flatnonzero(wrong & cutting):
            yield Fault(what, int(path.line[row]), what)


def positions(path: MachinePath, machine: MillingMachine) -> np.ndarray:
    """Positions (n,5), or (n,6) with the cutter's axis where it is one; NaN where it is not."""
    if np.isfinite(path.cutter).any() and machine.axes.C is not None:
        return np.column_stack([path.axes, path.cutter])
    return path.axes


def travel(path: MachinePath, machine: MillingMachine) -> Iterator[Fault]:
    """Block ends outside of the travel."""
    where = positions(path, machine)
    limits = machine.limits(where.shape[1])
    low, high = limits.travel.T
    for one in path.blind:
        if one.z is not None and not low[2] - _SLACK <= one.z <= high[2] + _SLACK:
            what = f"moves Z to {one.z:.3f} mm: {machine.name} travels {low[2]:g} to {high[2]:g} mm"
            yield Fault(what, one.line, "travel")
    half = np.append(machine.control.half_increments, machine.control.half_increments[-1])[: where.shape[1]]
    for row, axis in np.argwhere((where < low - half) | (where > high + half)):
        scale, unit = limits.scale[axis], limits.units[axis]
        yield Fault(
            f"moves {limits.names[axis]} to {where[row, axis] * scale:.3f} {unit}: {machine.name} travels "
            f"{low[axis] * scale:g} to {high[axis] * scale:g} {unit}",
            int(path.line[row]),
            "travel",
        )


def speeds(path: MachinePath, machine: MillingMachine) -> Iterator[Fault]:
    """Speed of every feed block, and what it has to gain on its neighbors without a stop between them.

    Blocks of POLY meet smoothly, so that the control has time to change the speed from one to the next; within each
    the path itself asks for acceleration and jerk.
    """
    where = positions(path, machine)
    limits = machine.limits(where.shape[1])
    feed = np.flatnonzero(~path.rapid & (path.seconds > 0.0) & (np.arange(len(path.rapid)) > 0))
    inner = np.append(path.inner, False) if len(path.inner) else np.zeros(len(path.rapid) + 1, dtype=bool)
    first = np.append(True, (np.diff(feed) > 1) | _curve_ends(inner, feed))[: len(feed)]
    group = np.cumsum(first)
    curved = inner[feed[first]][group - 1]
    steps, seconds = np.nan_to_num(where[feed] - where[feed - 1]), path.seconds[feed]
    speed = steps / seconds[:, None]
    gained, times = _gained(speed, seconds, first)
    found = []
    for number, (values, asked, limit, per, what) in enumerate(
        (
            (np.abs(speed), np.full(len(feed), True), limits.max_speed, 60.0, "/min"),
            (np.abs(gained), ~(curved & first), limits.max_acceleration, 1.0, "/s2"),
            (_jerks(gained, times), curved & ~_up_to_second(first), limits.max_jerk, 1.0, "/s3"),
        )
    ):
        for row, axis in np.argwhere((values > limit * (1.0 + _SLACK)) & asked[:, None]):
            scale, unit = limits.scale[axis] * per, limits.units[axis]
            what_is_needed = (
                f"needs {values[row, axis] * scale:.0f} {unit}{what} of {limits.names[axis]}: {machine.name} "
                f"allows {limit[axis] * scale:g} {unit}{what}"
            )
            found.append((group[row], number, row, Fault(what_is_needed, int(path.line[feed[row]]), "speed")))
    yield from (fault for *_, fault in sorted(found, key=lambda one: one[:3]))


def _curve_ends(inner: np.ndarray, feed: np.ndarray) -> np.ndarray:
    """Whether a block of POLY begins or ends between feed rows (n,) and the next of them, (n-1,)."""
    curved = inner[:-1] | np.roll(inner[:-1], 1)  # the last row of a block follows an inner one
    last = ~inner[feed[:-1]] & curved[feed[:-1]]
    return last | (curved[feed[:-1]] != curved[feed[1:]])


def _gained(speed: np.ndarray, seconds: np.ndarray, first: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Change of speed over time (n,k) from block to block, from standstill at each ``first``; and that time."""
    before, earlier = np.zeros_like(speed), np.zeros_like(seconds)
    before[1:], earlier[1:] = speed[:-1], seconds[:-1]
    before[first], earlier[first] = 0.0, 0.0
    times = (seconds + earlier) / 2
    return (speed - before) / times[:, None], times


def _up_to_second(first: np.ndarray) -> np.ndarray:
    """Whether rows (n,) are the first or the second of their group."""
    return first | np.append(False, first[:-1])[: len(first)]


def _jerks(gained: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Change of acceleration over time (n,k), which means something from the third row of a group on."""
    jerks = np.zeros_like(gained)
    jerks[1:] = np.abs(np.diff(gained, axis=0)) / ((times[1:] + times[:-1]) / 2)[:, None]
    return jerks

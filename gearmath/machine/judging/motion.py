"""What a machine must not do of a program, whatever it cuts: modes, spindle, travel, speeds and feeds, blind motion.

Every check yields a fault for each row of the path that has it, so that a changed block can be judged by itself.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gearmath.kernels import kernel
from gearmath.machine.control.executor import MachinePath
from gearmath.machine.judging.faults import Fault
from gearmath.machine.judging.stated import Stated
from gearmath.machine.milling.run import CuttingRun
from gearmath.machine.planning.clear_space import clear_height, room_of
from gearmath.machine.planning.cut_plan import DEFAULT_FEED, DEFAULT_SPINDLE_RPM, middle_of_tooth
from gearmath.machine.planning.feeds import accelerations
from gearmath.machine.planning.passes import tooth_angles
from gearmath.specs.bevel_set import Member
from gearmath.specs.milling_machine import MillingMachine

#: Speeds and accelerations may pass their limits by this part: the rounding of block times.
_SLACK = 1e-3
#: And feeds and spindle speeds what the header states, by its digits; a height its limit. [mm]
_STATED_SLACK, _HEIGHT_SLACK = 1e-2, 1e-3

#: The part of the blocks that says how fast a program is, and how much faster some of them may be.
_MOST_BLOCKS, _BESIDE_MOST = 0.75, 2.0


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
    """Dwells and stops with the cutter in the cut: between two feed blocks, and a stop after the last one too."""
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
        elif contour > within * (1 + _STATED_SLACK) or orientation > turned * (1 + _STATED_SLACK):
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
            np.abs(speed - (wanted or 0.0)) > _STATED_SLACK * (wanted or np.inf),
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
    ends = np.flatnonzero((np.diff(feed) > 1) | _curve_ends(inner, feed)) + 1
    for rows in np.split(feed, ends):
        if not len(rows):
            continue
        steps = np.nan_to_num(where[rows] - where[rows - 1])
        seconds = path.seconds[rows]
        curved = inner[rows[0]]
        gained = np.abs(accelerations(steps, seconds))[int(curved) : -1]
        for values, limit, per, what in (
            (np.abs(steps) / seconds[:, None], limits.max_speed, 60.0, "/min"),
            (gained, limits.max_acceleration, 1.0, "/s2"),
            (_jerks(steps, seconds) if curved else steps[:0], limits.max_jerk, 1.0, "/s3"),
        ):
            for row, axis in np.argwhere(values > limit * (1.0 + _SLACK)):
                scale, unit = limits.scale[axis] * per, limits.units[axis]
                yield Fault(
                    f"needs {values[row, axis] * scale:.0f} {unit}{what} of {limits.names[axis]}: {machine.name} "
                    f"allows {limit[axis] * scale:g} {unit}{what}",
                    int(path.line[rows[row]]),
                    "speed",
                )


def _curve_ends(inner: np.ndarray, feed: np.ndarray) -> np.ndarray:
    """Whether a block of POLY begins or ends between feed rows (n,) and the next of them, (n-1,)."""
    curved = inner[:-1] | np.roll(inner[:-1], 1)  # the last row of a block follows an inner one
    last = ~inner[feed[:-1]] & curved[feed[:-1]]
    return last | (curved[feed[:-1]] != curved[feed[1:]])


def _jerks(steps: np.ndarray, seconds: np.ndarray) -> np.ndarray:
    """Change of acceleration over time (n-2,k) within a block of straight parts (n,k)."""
    gained = accelerations(steps, seconds)[1:-1]
    times = (seconds[1:] + seconds[:-1]) / 2
    return np.abs(np.diff(gained, axis=0)) / ((times[1:] + times[:-1]) / 2)[:, None]


def feeds(
    path: MachinePath, runs: list[CuttingRun], member: Member, machine: MillingMachine, stated: Stated
) -> Iterator[Fault]:
    """Feed of the cutter past the tooth and of the plunge, and in face hobbing the speed of C, beyond what is stated.

    ``runs`` are those of the path on a machine without errors. The header can be edited: what it states counts up to
    twice what three quarters of the blocks do, or up to the feed that is taken where nobody asks for one.
    """
    for run in runs:
        here = path.tool == path.tools.index(run.cut.tool)
        seconds = path.seconds[here]
        rows = np.flatnonzero(run.cutting & (seconds > 0.0) & (np.arange(len(seconds)) > 0))
        if run.blades is not None:
            unit = "rpm"
            speed = np.abs(run.turned[rows] - run.turned[rows - 1]) / seconds[rows] * 60.0 / (2 * np.pi)
            kinds = [(np.full(len(rows), True), stated.rpm, DEFAULT_SPINDLE_RPM)]
        else:
            unit = "mm/min"
            turns = tooth_angles(member.teeth, member.rad("index_correction"))[run.space[rows]]
            before, after = run.axes[rows - 1].copy(), run.axes[rows].copy()
            plunges = ~(after - before)[:, [0, 1, 3, 4]].any(axis=1)
            tooth, pose = middle_of_tooth(member, run.cut), (machine.pivot_height, machine.pivot)
            for ends in (before, after):
                ends[:, 3] -= turns
            (first,), (last,) = (kernel("seen_from_tool")(ends, tooth, *pose) for ends in (before, after))
            speed = np.linalg.norm(last - first, axis=1) / seconds[rows] * 60.0
            plunge = max(stated.feed, stated.plunge) if stated.feed and stated.plunge else None
            kinds = [(~plunges, stated.feed, DEFAULT_FEED), (plunges, plunge, DEFAULT_FEED)]
        for kind, wanted, default in kinds:
            most = _most(speed[kind], wanted, default)
            for k in np.flatnonzero(kind & (speed > most * (1.0 + _STATED_SLACK))):
                what = f"moves the cutter at {speed[k]:.0f} {unit} past the tooth, the program states {wanted:g} {unit}"
                if most < (wanted or 0.0):
                    what += f", and goes slower nearly everywhere: {most:.0f} {unit} count"
                yield Fault(what, int(run.line[rows[k]]), "feed")


def _most(speed: np.ndarray, stated: float | None, default: float) -> float:
    """How fast blocks of one kind may be, which do ``speed`` (n,), where ``stated`` is that or nothing."""
    if stated is None or not len(speed):
        return np.inf
    return min(stated, max(default, _BESIDE_MOST * float(np.quantile(speed, _MOST_BLOCKS))))

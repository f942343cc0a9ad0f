"""How fast a program cuts: by what it states, and by what the machine file allows."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gearmath.kernels import kernel
from gearmath.machine.control.executor import MachinePath
from gearmath.machine.judging.faults import Fault
from gearmath.machine.judging.stated import Stated
from gearmath.machine.milling.run import CuttingRun
from gearmath.machine.planning.cut_plan import DEFAULT_FEED, DEFAULT_SPINDLE_RPM, middle_of_tooth
from gearmath.machine.planning.hobbing import index_ratio
from gearmath.machine.planning.passes import tooth_angles
from gearmath.specs.bevel_set import Member
from gearmath.specs.milling_machine import MillingMachine

#: Feeds and spindle speeds may pass what a header or a file says by this part: the digits of both.
STATED_SLACK = 1e-2
#: The part of the blocks that says how fast a program is, and how much faster some of them may be.
_MOST_BLOCKS, _BESIDE_MOST = 0.75, 2.0
#: A block crawls that is slower by this factor than stated, and than its axes are, and takes longer than this. [s]
_CRAWLS, _LONG = 10.0, 5.0


def feeds(
    path: MachinePath, runs: list[CuttingRun], member: Member, machine: MillingMachine, stated: Stated
) -> Iterator[Fault]:
    """Feed of the cutter past the tooth and of the plunge, and in face hobbing the speed of C, beyond what is stated.

    ``runs`` are those of the path on a machine without errors. The header can be edited: what it states counts up to
    twice what three quarters of the blocks do, or up to the feed that is taken where nobody asks for one.
    """
    for run in runs:
        rows, seconds, _ = feed_rows(path, run)
        if run.blades is not None:
            unit = "rpm"
            speed = _turning(run, rows, seconds)
            kinds = [(np.full(len(rows), True), stated.rpm, DEFAULT_SPINDLE_RPM)]
        else:
            unit = "mm/min"
            plunges = ~(run.axes[rows] - run.axes[rows - 1])[:, [0, 1, 3, 4]].any(axis=1)
            speed = past_the_tooth(run, rows, seconds, member, machine)
            plunge = max(stated.feed, stated.plunge) if stated.feed and stated.plunge else None
            kinds = [(~plunges, stated.feed, DEFAULT_FEED), (plunges, plunge, DEFAULT_FEED)]
        for kind, wanted, default in kinds:
            most = _most(speed[kind], wanted, default)
            for k in np.flatnonzero(kind & (speed > most * (1.0 + STATED_SLACK))):
                what = f"moves the cutter at {speed[k]:.0f} {unit} past the tooth, the program states {wanted:g} {unit}"
                if most < (wanted or 0.0):
                    what += f", and goes slower nearly everywhere: {most:.0f} {unit} count"
                yield Fault(what, int(run.line[rows[k]]), "feed")


def feed_limits(path: MachinePath, runs: list[CuttingRun], member: Member, machine: MillingMachine) -> Iterator[Fault]:
    """Feed of the cutter past the tooth, in a minute and in a turn of it, and speed of its blade tips beyond what the
    machine file allows.

    Nobody can edit these limits in a header.
    """
    for run in runs:
        rows, seconds, rpm = feed_rows(path, run)
        feed = past_the_tooth(run, rows, seconds, member, machine)
        turning = rpm if run.blades is None else _turning(run, rows, seconds)
        each_turn = np.divide(feed, turning, out=np.zeros(len(feed)), where=turning > 0.0)
        tips = 2 * np.pi * run.cutter.tip_radius * turning / 1000
        for values, limit, what, key in (
            (feed, machine.max_feed_per_min, "past the tooth by {:.0f} mm/min", "max_feed_per_min"),
            (each_turn, machine.max_feed_per_turn, "past the tooth by {:.1f} mm a turn of it", "max_feed_per_turn"),
            (tips, machine.max_cutting_speed, "with {:.0f} m/min at the tips of its blades", "max_cutting_speed"),
        ):
            for k in np.flatnonzero(values > (limit or np.inf) * (1.0 + STATED_SLACK)):
                yield Fault(
                    f"moves the cutter {what.format(values[k])}: {machine.name} has {key} {limit:g}",
                    int(run.line[rows[k]]),
                    key,
                )


def feed_rows(path: MachinePath, run: CuttingRun) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The feed blocks (m,) of a run, their times [s] and the speed of the spindle [rpm]."""
    here = path.tool == path.tools.index(run.cut.tool)
    seconds = path.seconds[here]
    rows = np.flatnonzero(run.cutting & (seconds > 0.0) & (np.arange(len(seconds)) > 0))
    return rows, seconds[rows], np.abs(path.rpm[here][rows])


def past_the_tooth(
    run: CuttingRun, rows: np.ndarray, seconds: np.ndarray, member: Member, machine: MillingMachine
) -> np.ndarray:
    """Speed (m,) [mm/min] of the cutter past the middle of a tooth; what C indexes in face hobbing is left out."""
    before, after = run.axes[rows - 1].copy(), run.axes[rows].copy()
    if run.blades is None:
        indexed = tooth_angles(member.teeth, member.rad("index_correction"))[run.space[rows]]
        before[:, 3] -= indexed
        after[:, 3] -= indexed
    else:
        before[:, 3] += index_ratio(member) * run.turned[rows - 1]
        after[:, 3] += index_ratio(member) * run.turned[rows]
    tooth, pose = middle_of_tooth(member, run.cut), (machine.pivot_height, machine.pivot)
    (first,), (last,) = (kernel("seen_from_tool")(ends, tooth, *pose) for ends in (before, after))
    speed: np.ndarray = np.linalg.norm(last - first, axis=1) / seconds * 60.0
    return speed


def _turning(run: CuttingRun, rows: np.ndarray, seconds: np.ndarray) -> np.ndarray:
    """Speed (m,) [rpm] of the cutter as axis C."""
    turned: np.ndarray = np.abs(run.turned[rows] - run.turned[rows - 1]) / seconds * 60.0 / (2 * np.pi)
    return turned


def _most(speed: np.ndarray, stated: float | None, default: float) -> float:
    """How fast blocks of one kind may be, which do ``speed`` (n,), where ``stated`` is that or nothing."""
    if stated is None or not len(speed):
        return np.inf
    return min(stated, max(default, _BESIDE_MOST * float(np.quantile(speed, _MOST_BLOCKS))))


def crawling(
    path: MachinePath, runs: list[CuttingRun], member: Member, machine: MillingMachine, stated: Stated
) -> list[str]:
    """Sentences of blocks that take long because their feed is far below what the program states, or where it states
    nothing below that of most blocks, and not because an axis can go no faster: the longest of each kind.

    They damage nothing, and are no faults. ``runs`` are those of the path on a machine without errors.
    """
    found = []
    for run in runs:
        rows, seconds, _ = feed_rows(path, run)
        down = ~(run.axes[rows] - run.axes[rows - 1])[:, [0, 1, 3, 4]].any(axis=1)
        past = past_the_tooth(run, rows, seconds, member, machine)
        plunge = stated.plunge
        if plunge and stated.feed and member.generation == "formate":  # whose last way down has the feed of the cut
            plunge = min(plunge, stated.feed)
        kinds = [(down, past, plunge, "mm/min"), (~down, past, stated.feed, "mm/min")]
        if run.blades is not None:  # the roll is as slow as the tolerance wants it
            kinds[1] = (~down, _turning(run, rows, seconds), stated.rpm, "rpm of C")
        least = _least_seconds(run, rows, machine)
        for kind, speed, wanted, unit in kinds:
            usual = wanted or float(np.median(speed[kind])) if kind.any() else 0.0
            slow = np.flatnonzero(kind & (speed * _CRAWLS < usual) & (seconds > _CRAWLS * least))
            lines, of_line = np.unique(run.line[rows[slow]], return_inverse=True)
            times = np.bincount(of_line, seconds[slow], len(lines))
            if (times > _LONG).any():
                worst = int(times.argmax())
                at = speed[slow[of_line == worst]].min()
                asked = f"the program states {wanted:g}" if wanted else f"most blocks have {usual:.4g}"
                count = int((times > _LONG).sum())
                crawl = f"{count} blocks crawl, the longest is" if count > 1 else "a block crawls:"
                took = f"{times[worst] / 60:.1f} min at {at:.2g} {unit}, {asked} {unit}"
                found.append(f"{crawl} line {lines[worst]}, {took}: look at its F and G93")
    return found


def _least_seconds(run: CuttingRun, rows: np.ndarray, machine: MillingMachine) -> np.ndarray:
    """The time (m,) [s] that the fastest speed of every axis leaves for blocks."""
    positions = run.axes if run.blades is None else np.column_stack([run.axes, run.turned])
    steps = np.abs(positions[rows] - positions[rows - 1])
    least: np.ndarray = np.nanmax(steps / machine.limits(positions.shape[1]).max_speed, axis=1)
    return least

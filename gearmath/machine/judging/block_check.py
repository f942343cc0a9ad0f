"""Every block of a program watched where it generates: lines on the flanks so close together that none cuts unseen.

The lines lie along tip and foot of the flanks, along toe and heel and half way up, evenly, and some for every block of
a pass. Every line of contact crosses the outer curves at both of its ends, and a tool that is moved anywhere on it is
moved most at one of them, as a rigid body; where it is moved at one end and the block leaves most at the other, the sum
may be largest between them. :func:`watch` says what metal is left; :func:`off_the_way` where a tool stands beside its
way although its neighbours cut the flank clean.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.method import motion_of
from gearmath.bevel.turning import turned
from gearmath.kernels import kernel
from gearmath.machine.judging.scallops import ridges
from gearmath.machine.milling.axis_errors import roll_position
from gearmath.machine.milling.mill import expose, thickness
from gearmath.machine.milling.removal import REACH, annulus_entry
from gearmath.machine.milling.run import CuttingRun
from gearmath.machine.planning.blocks import on_one_machine
from gearmath.machine.planning.lines import flank_curve, foot_curves, joined
from gearmath.machine.planning.passes import tooth_angles
from gearmath.machine.planning.path import axis_positions, flank_points
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.simulated_machine import SimulatedMachine

#: Where along a block each curve has lines. A straight block leaves a parabola between its ends, and where one end is
#: wrong, a line besides: what lies between these places is at most 3 % more than at one of them. Where it leaves a
#: parabola at each of its ends, and a ridge between them, more lines stand on the highest of these ridges.
_STRAIGHT = (0.0, 0.3, 0.5, 0.7)
#: The same for a block of POLY, which leaves a smooth flank.
_CURVED = tuple(np.linspace(0.0, 1.0, 60, endpoint=False).tolist())
#: Where curves lie along the tooth, as parts of the working depth, and up the tooth, as parts of the face width.
_UP, _ACROSS = (0.5, 1.0), (0.0, 1.0)
#: The same for lines on ridges, of which a line of contact that ends at toe or heel crosses some besides.
_UP_RIDGES = (*np.linspace(0.125, 0.875, 7).tolist(), 1.0)
#: The part of the lines on a flank that says what its blocks are made for.
MOST_LINES = 0.75
#: So many of the highest ridges between lines of a flank get lines of their own, around them by parts of a block.
_RIDGES, _AROUND = 8, np.linspace(-0.2, 0.2, 21)
#: X and Y so far off the path are wrong wherever the flank is. [mm]
_FAR_ASIDE = 0.05


@dataclass(frozen=True)
class WatchedFlank:
    """Lines on one flank of space 0: points and outward normals (n,3), where they begin (n,) [mm], cradle rotation."""

    flank: str
    point: np.ndarray
    normal: np.ndarray
    start: np.ndarray
    theta: np.ndarray
    curves: tuple[int, ...]
    """Where the curves begin, along which the lines lie."""
    ends: np.ndarray
    """Cradle rotations of the ends of straight blocks."""


@dataclass(frozen=True)
class Watch:
    """What all blocks leave: number of lines, extremes [mm] with space, flank and line of the text; ``uncut`` lines.

    Where nothing is cut ``lowest`` is infinite, and ``highest`` minus infinite. ``usual`` [mm] is what three quarters
    of the lines on a flank deviate by at most, on its best space and on the worse of the flanks.
    """

    lines: int
    lowest: float
    lowest_at: tuple[int, str, int]
    highest: float
    highest_at: tuple[int, str, int]
    uncut: int
    usual: float

    @property
    def worst(self) -> tuple[float, tuple[int, str, int]]:
        """The larger extreme and where it is."""
        return max((self.lowest, self.lowest_at), (self.highest, self.highest_at), key=lambda found: abs(found[0]))


def watched_flanks(member: Member, runs: list[CuttingRun], machine: MillingMachine) -> list[WatchedFlank]:
    """Lines on all flanks that the tools of a program cut, where their blocks ask for them."""
    found = []
    for run in runs:
        rolls = _watched_rolls(member, run, machine) if member.generation == "generated" else np.zeros(0)
        for flank in run.cut.flanks:
            ends = np.zeros(0) if len(run.inner) and run.inner.any() else rolls[:: len(_STRAIGHT)]
            found.append(_watched(member, run, flank, rolls, ends))
    return found


def _watched(
    member: Member,
    run: CuttingRun,
    flank: str,
    rolls: np.ndarray,
    ends: np.ndarray,
    heights: tuple[float, ...] = _UP,
) -> WatchedFlank:
    theta, point, normal, curves = _lines(member, run, flank, rolls, heights)
    (other,) = (each for each in FLANKS if each != flank)
    opposite = flank_points(member, other, blank_grid(member, 5, 9)).point
    return WatchedFlank(flank, point, normal, -0.5 * thickness(point, opposite, member.teeth), theta, curves, ends)


def _watched_rolls(member: Member, run: CuttingRun, machine: MillingMachine) -> np.ndarray:
    """Cradle rotations (n,) [rad] that the blocks of a pass are watched at: of the pass that has most of them."""
    number, begins = np.cumsum(~run.cutting), np.append(True, run.at_ends[:-1])
    lines = np.where(run.at_ends, len(_STRAIGHT), len(_CURVED)) * (run.cutting & begins)
    rows = np.flatnonzero((number == np.bincount(number, lines).argmax()) & run.at_ends)
    spec = member.flank(run.cut.flanks[0])
    ends, _ = roll_position()(spec.vector, run.axes[rows, 0], run.axes[rows, 1], machine.pivot, motion_of(spec))
    shares = [np.array(_STRAIGHT if step == 1 else _CURVED) for step in np.diff(rows)]
    blocks = zip(ends, np.diff(ends), shares, strict=False)
    return np.concatenate([*(start + share * roll for start, roll, share in blocks), ends[-1:]])


def _lines(
    member: Member, run: CuttingRun, flank: str, rolls: np.ndarray, heights: tuple[float, ...]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, tuple[int, ...]]:
    if member.generation == "formate":
        points = flank_points(member, flank, blank_grid(member, 5, 17, 0.0))
        return points.contact[:, 2], points.point, points.normal, (0,)
    shared = on_one_machine(member, run.cut)
    curves = [flank_curve(shared, flank, rolls, up=up) for up in heights]
    curves += [flank_curve(shared, flank, rolls, across=across) for across in _ACROSS]
    curves += foot_curves(shared, flank, rolls)
    lines = joined(curves)
    begins = np.cumsum([0, *(len(curve.theta) for curve in curves[:-1])])
    return lines.theta, lines.point, lines.normal, tuple(begins.tolist())


def watch(
    runs: list[CuttingRun],
    member: Member,
    machine: MillingMachine,
    errors: SimulatedMachine | None = None,
    progress: Callable[[int], object] = lambda _: None,
    groups: Mapping[int, list[int]] | None = None,
    withdrawn: float = 0.0,
) -> Watch:
    """What the passes of every space leave on the flanks of that space, the ``runs`` with rounded blades.

    The flanks are those that the settings cut, indexed as they are corrected, whatever they are corrected for.

    Rapid blocks that end as low as the tool cuts take metal away like the others, in every space.

    ``progress`` is called for every space exposed. ``groups`` are spaces known to be cut alike, by the one that is
    exposed for all of them; where rapid motion takes metal away, it is every space. A cutter that is ``withdrawn`` [mm]
    for a stock passes above the foot of the flanks: what stays there is root, and does not count as ``highest``.
    """
    flanks = watched_flanks(member, runs, machine)
    reached = {one.flank: _height(one, member, runs, machine) >= withdrawn for one in flanks}
    numbers = np.concatenate([run.line for run in runs])
    rows: list[tuple[float, float, int, int, int, str, int]] = []
    usual: dict[str, float] = {}
    turns = tooth_angles(member.teeth, member.rad("index_correction"))
    every = {space: [space] for space in sorted({number for run in runs for number in run.spaces})}
    exposed = every if groups is None or any(_rapid_in_metal(run).any() for run in runs) else groups
    for space, like in exposed.items():
        own = [replace(run, cutting=(run.cutting & (run.space == space)) | _rapid_in_metal(run)) for run in runs]
        angle = turns[space]
        for one in flanks:
            lines = (turned(one.point, angle), turned(one.normal, angle), one.start)
            left = expose(own, machine, errors, *lines)
            met = np.isfinite(left.distance)
            low = int(np.argmin(np.where(met, left.distance, np.inf)))
            counts = np.where(met & reached[one.flank], left.distance, -np.inf)
            high = int(np.argmax(counts))
            most_left, left_by = float(counts[high]), int(left.block[high])
            if (more := _on_ridges(one, counts, member, runs)) is not None:
                again = expose(own, machine, errors, turned(more.point, angle), turned(more.normal, angle), more.start)
                whole = np.isfinite(again.distance) & (_height(more, member, runs, machine) >= withdrawn)
                high = int(np.argmax(np.where(whole, again.distance, -np.inf)))
                most_left, left_by = max((most_left, left_by), (float(again.distance[high]), int(again.block[high])))
            if met.any():
                most = float(np.quantile(np.abs(left.distance[met]), MOST_LINES))
                usual[one.flank] = min(most, usual.get(one.flank, np.inf))
            rows.append(
                (
                    float(left.distance[low]) if met.any() else np.inf,
                    most_left,
                    int(numbers[left.block[low]]),
                    int(numbers[left_by]),
                    int((~met).sum()) * len(like),
                    one.flank,
                    space,
                )
            )
        progress(1)
    deep, full = min(rows, key=lambda row: row[0]), max(rows, key=lambda row: row[1])
    return Watch(
        lines=len(every) * sum(len(one.point) for one in flanks),
        lowest=deep[0],
        lowest_at=(deep[6], deep[5], deep[2]),
        highest=full[1],
        highest_at=(full[6], full[5], full[3]),
        uncut=sum(row[4] for row in rows),
        usual=max(usual.values(), default=0.0),
    )


def _on_ridges(lines: WatchedFlank, left: np.ndarray, member: Member, runs: list[CuttingRun]) -> WatchedFlank | None:
    """Lines on the highest ridges that seem to stand between ``lines``, which keep ``left`` (n,), higher than these."""
    if len(lines.ends) < 2:
        return None
    parts = [slice(*ends) for ends in itertools.pairwise([*lines.curves, len(left)]) if ends[1] - ends[0] > 1]
    found = [ridges(lines.theta[part], left[part], lines.ends) for part in parts]
    peaks, theta = (np.concatenate(part) for part in zip(*found, strict=True))
    chosen = np.argsort(-peaks)[:_RIDGES]
    chosen = chosen[peaks[chosen] > left.max()]
    if not len(chosen):
        return None
    (run,) = (run for run in runs if lines.flank in run.cut.flanks)
    # where a curve is generated is known to a part of a block: lines stand all around
    around = theta[chosen, None] + _AROUND * float(np.median(np.abs(np.diff(lines.ends))))
    return _watched(member, run, lines.flank, np.unique(around), np.zeros(0), _UP_RIDGES)


def _height(lines: WatchedFlank, member: Member, runs: list[CuttingRun], machine: MillingMachine) -> np.ndarray:
    """How far (n,) [mm] along the cutter's axis lines lie from the end of the straight blade that generates them."""
    (run,) = (one for one in runs if lines.flank in one.cut.flanks)
    spec = member.flank(run.cut.flanks[0])
    axes = axis_positions(spec, lines.theta, machine.pivot_height, machine.pivot)
    center, axis = kernel("tool_pose")(axes, machine.pivot_height, machine.pivot)
    own = member.flank(lines.flank)
    edge = (own.blade_edge_radius or 0.0) * (1 - math.sin(own.alpha))
    return np.abs(((lines.point - center) * axis).sum(axis=1)) - edge


def _rapid_in_metal(run: CuttingRun) -> np.ndarray:
    """Rapid blocks (n,) that end no higher than the tool cuts: a right program has none."""
    return ~run.cutting & (run.axes[:, 2] <= run.axes[run.cutting, 2].max(initial=-np.inf))


def off_the_way(
    runs: list[CuttingRun],
    member: Member,
    machine: MillingMachine,
    flanks: list[WatchedFlank] | None = None,
) -> tuple[float, tuple[int, str, int]]:
    """The largest distance [mm] along a flank normal between the tool at the end of a block and where it belongs.

    With it come space, flank and line of the text. The cradle rotation of an end is that whose X and Y are nearest;
    the tool is compared there on the watched lines that it touches at that moment. That counts even where other blocks
    take away what this one leaves. Only for generated flanks, and for programs that leave no stock. ``flanks`` are the
    watched lines, if they are known.
    """
    flanks = watched_flanks(member, runs, machine) if flanks is None else flanks
    worst = 0.0, (0, "", 0)
    for run in runs:
        for flank in run.cut.flanks:
            (lines,) = (one for one in flanks if one.flank == flank)
            distance = distances_off_the_way(run, lines, member, machine)
            row = int(np.argmax(distance))
            if distance[row] > worst[0]:
                worst = float(distance[row]), (int(run.space[row]), flank, int(run.line[row]))
    return worst


def in_space_0(run: CuttingRun, member: Member) -> tuple[np.ndarray, np.ndarray]:
    """Rows (m,) of a run that cut in a space, and their positions (m,5) as they are in space 0."""
    rows = np.flatnonzero(run.cutting & (run.space >= 0))
    axes = run.axes[rows].copy()
    axes[:, 3] -= tooth_angles(member.teeth, member.rad("index_correction"))[run.space[rows]]
    return rows, axes


def distances_off_the_way(run: CuttingRun, lines: WatchedFlank, member: Member, machine: MillingMachine) -> np.ndarray:
    """How far the tool is off its path (n,) [mm] on one flank at every row of a run.

    Where it touches no line, as where it plunges, that is how far its X and Y are off the path.
    """
    spec, off = member.flank(run.cut.flanks[0]), np.zeros(len(run.axes))
    rows, axes = in_space_0(run, member)
    theta, aside = roll_position()(spec.vector, axes[:, 0], axes[:, 1], machine.pivot, motion_of(spec))
    steps = np.diff(theta)
    node, line = np.nonzero(np.abs(theta[:, None] - lines.theta) <= np.median(steps[steps > 0]) / 2)
    touches = np.isin(np.arange(len(rows)), node)
    off[rows] = np.where((aside > _FAR_ASIDE) | ~touches, aside, 0.0)
    meant = axis_positions(spec, theta, machine.pivot_height, machine.pivot)
    body = run.cutter.bodies[-1]
    entry, found = annulus_entry(), []
    for where in (axes, meant):
        center, axis = kernel("tool_pose")(where, machine.pivot_height, machine.pivot)
        raised = center - body.base * axis
        given = (lines.point[line], lines.normal[line], lines.start[line])
        found.append(entry(raised[node], axis[node], *given, body.annulus)[0])
    np.maximum.at(off, rows[node], np.minimum(np.abs(found[0] - found[1]), REACH))
    return off

"""All passes of a cutting job on a member, planned: tool by tool, roughing before finishing, space by space.

A stock is left by withdrawing the cutter along its own axis, which is Z: a cone that moves along its axis by d stands
parallel to itself at d sin(pressure angle), so that the flanks keep the same stock everywhere, and the root d. Where
one cutter has two pressure angles, the smaller one sets d, and the other flank keeps somewhat more.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.tooth import ToothSpace, tooth_space
from gearmath.bevel.turning import turned
from gearmath.errors import InputError
from gearmath.machine.bodies.cutter import cutter_of
from gearmath.machine.bodies.profiles import widest
from gearmath.machine.planning.blocks import TOLERANCES, check_tolerance, roll_nodes
from gearmath.machine.planning.clear_space import Room, room_of
from gearmath.machine.planning.curves import curve_nodes, curve_seconds, degree_for, powers_of
from gearmath.machine.planning.feeds import block_seconds, check_feed
from gearmath.machine.planning.hobbed_curves import check_counting, curved_hobbing
from gearmath.machine.planning.hobbing import LEAST_TOLERANCE, hobbing_motion, index_ratio, straight_hobbing
from gearmath.machine.planning.passes import Pass, tooth_angles
from gearmath.machine.planning.path import DEFAULT_TOLERANCE, Cut, axis_positions, flank_points, within_travel
from gearmath.machine.planning.rounding import ControlShare, control_share
from gearmath.remembered import remembered
from gearmath.specs.bevel_set import BevelSet, Member
from gearmath.specs.milling_machine import MillingMachine

#: Speed of the cutter past the tooth while it generates. [mm/min]
DEFAULT_FEED = 300.0
DEFAULT_SPINDLE_RPM = 120.0
#: Speed of Z on the way to the work, and into it. [mm/min]
PLUNGE_FEED = 200.0
#: A dry run keeps the cutter this far above its cut. [mm]
DRY_LIFT = 60.0
MOST_STOCK = 5.0
#: With less feed a pass takes hours, and in face hobbing C counts out of its travel; and the most, where the machine
#: file states no limit [mm/min].
_LEAST_FEED, _MOST_FEED = 1.0, 100_000.0
#: A roughing pass may deviate by this part of its stock.
_ROUGH_SHARE = 0.05
#: A plunge starts this many tooth depths above the bottom, and a bit [mm]; at the bottom the cutter turns this often.
_PLUNGE_DEPTHS, _PLUNGE_MARGIN, _SPARK_OUT_TURNS = 2.0, 5.0, 1.5
#: Turning, in face hobbing, it starts nearer: it goes down slowly.
_HOBBING_DEPTHS = 1.5


@dataclass(frozen=True)
class CuttingJob:
    """What a program does: tooth spaces, tolerance and stocks [mm] along the tooth normal, feed [mm/min] at the tooth.

    ``roughing_stock`` above ``finishing_stock`` adds a roughing pass of all spaces before the finishing one;
    ``finishing_stock`` is what stays on the finished flanks. A dry run cuts air above the work, without coolant.
    ``blocks`` are straight, or polynomials where the cutter rolls.
    """

    spaces: Sequence[int] = (0,)
    tolerance: float = DEFAULT_TOLERANCE
    feed: float = DEFAULT_FEED
    spindle_rpm: float = DEFAULT_SPINDLE_RPM
    roughing_stock: float = 0.0
    finishing_stock: float = 0.0
    dry_run: bool = False
    blocks: Literal["g1", "poly"] = "g1"

    def __post_init__(self) -> None:
        for key in ("roughing_stock", "finishing_stock"):
            if not 0.0 <= getattr(self, key) <= MOST_STOCK:
                raise InputError(f"{key} = {getattr(self, key)} mm: must lie between 0 and {MOST_STOCK:g} mm")
        if 0.0 < self.roughing_stock <= self.finishing_stock:
            raise InputError(
                f"roughing_stock = {self.roughing_stock} mm: must be more than the finishing_stock "
                f"{self.finishing_stock} mm, or 0 for no roughing"
            )
        if not len(self.spaces):
            raise InputError("spaces: there is no tooth space to cut")
        check_tolerance(self.tolerance)
        check_feed(self.feed)
        if self.feed < _LEAST_FEED:
            raise InputError(f"feed = {self.feed:g} mm/min: must be at least {_LEAST_FEED:g} mm/min")

    @property
    def stages(self) -> tuple[tuple[str, float, float], ...]:
        """Name, stock and tolerance [mm] of each turn through all spaces."""
        finish = ("finish", self.finishing_stock, self.tolerance)
        if self.roughing_stock == 0.0:
            return (finish,)
        coarse = min(max(self.tolerance, _ROUGH_SHARE * self.roughing_stock), TOLERANCES[1])
        return ("rough", self.roughing_stock, coarse), finish


ONE_SPACE = CuttingJob()


@dataclass(frozen=True)
class CuttingPlan:
    """A job on one member, planned: all that its program and its set-up sheet say.

    ``tool_radius`` [mm] is the widest of cutter, head and spindle, ``space`` the tooth space where each flank has a
    cutter of its own.
    """

    title: str
    member: Member
    machine: MillingMachine
    job: CuttingJob
    passes: tuple[Pass, ...]
    share: ControlShare
    space: ToothSpace | None
    room: Room
    tool_radius: float

    @property
    def seconds(self) -> float:
        """Time in the cut [s]; approaches and rapid motion are not in it."""
        return float(sum(one.seconds.sum() + one.dwell for one in self.passes))


def cutting_plan(
    bevel_set: BevelSet,
    name: str,
    machine: MillingMachine,
    job: CuttingJob = ONE_SPACE,
    progress: Callable[[int], object] = lambda passes: None,
) -> CuttingPlan:
    """All passes of a job on one member; ``progress`` hears of those that are planned.

    Raises InputError for a feed beyond the machine's, singular poses, travel and speed limits, a tolerance out of
    range, and a face hobbed member whose spaces are not all cut, or whose machine has no axis C.
    """
    member = bevel_set.member(name)
    _, most = feed_limits(machine, job.dry_run)
    if job.feed > most:
        if most == _MOST_FEED:
            raise InputError(f"feed = {job.feed:g} mm/min: must be at most {most:g}, the limit")
        raise InputError(f"feed = {job.feed:g} mm/min: must be at most {most:g}, max_feed_per_min of {machine.name}")
    _, fastest = spindle_limits(member, machine, job.dry_run)
    if machine.spindle_speed_rpm[1] >= job.spindle_rpm > fastest:
        known = math.floor(100 * fastest) / 100
        raise InputError(
            f"spindle speed = {job.spindle_rpm:g} rpm: must be at most {known:g} rpm, where the tips of the blades "
            f"reach max_cutting_speed {machine.max_cutting_speed:g} m/min of {machine.name}"
        )
    head, space = machine.cutter_head, _space(member)
    room = room_of(member, machine, machine.fixture)
    radius = max(widest(cutter_of(member, cut.flanks, space, 0.0), head) for cut in Cut.of(member))
    share = control_share(member, machine)
    passes: list[Pass] = []
    for one in _passes(member, machine, job, share):
        passes.append(one)
        progress(1)
    return CuttingPlan(bevel_set.title, member, machine, job, tuple(passes), share, space, room, radius)


def feed_limits(machine: MillingMachine, dry_run: bool) -> tuple[float, float]:
    """Least and highest feed [mm/min] of a job on a machine, whose limit is that of a cut: a dry run has another."""
    return _LEAST_FEED, _MOST_FEED if dry_run else machine.max_feed_per_min or _MOST_FEED


def spindle_limits(member: Member, machine: MillingMachine, dry_run: bool) -> tuple[float, float]:
    """Lowest and highest speed [1/min] of the spindle, at which no blade tip cuts faster than the machine may."""
    low, high = machine.spindle_speed_rpm
    if dry_run or machine.max_cutting_speed is None:
        return low, high
    space = _space(member)
    radius = max(cutter_of(member, cut.flanks, space).tip_radius for cut in Cut.of(member))
    return low, min(high, 1000 * machine.max_cutting_speed / (2 * math.pi * radius))


def tolerance_limits(member: Member) -> tuple[float, float]:
    """Least and largest tolerance [mm] of a job on a member: in face hobbing the scallops need more."""
    return LEAST_TOLERANCE if member.process == "face_hobbing" else TOLERANCES[0], TOLERANCES[1]


def _space(member: Member) -> ToothSpace | None:
    """The tooth space that tells how wide the cutters of single flanks are."""
    return None if member.cutting == "completing" else tooth_space(member, 7)


def pass_count(member: Member, job: CuttingJob) -> int:
    """How many passes the program of a job has: in face hobbing one a stage, else one a tool, stage and space."""
    hobbed = member.process == "face_hobbing"
    return len(job.stages) * (1 if hobbed else len(Cut.of(member)) * len(job.spaces))


def _passes(member: Member, machine: MillingMachine, job: CuttingJob, share: ControlShare) -> Iterator[Pass]:
    """All passes in their order: tool by tool, roughing before finishing, space by space."""
    if member.process == "face_hobbing":
        yield from _hobbing_passes(member, machine, job)
        return
    angles = tooth_angles(member.teeth, member.rad("index_correction"))
    beyond = next((space for space in job.spaces if not 0 <= space < member.teeth), None)
    if beyond is not None:
        raise InputError(f"{member.name}: space {beyond}: must be a number from 0 to {member.teeth - 1}")
    stands = None
    for cut in Cut.of(member):
        _check_motions(member, cut)
        for stage, stock, tolerance in job.stages:
            theta, first = first_pass(member, cut, machine, replace(job, tolerance=tolerance), share)
            first.axes[:, 2] += lift(member, cut, stock, job.dry_run)
            for space in job.spaces:
                label = f"space {space} {' and '.join(cut.flanks)}" + (f" {stage}" if len(job.stages) > 1 else "")
                indexed = first.axes + np.array([0, 0, 0, angles[space], 0])
                axes = within_travel(indexed, theta, machine, f"{member.name}, {label}", stands)
                stands = axes[-1]
                yield replace(first, label=label, tooth=int(space), axes=axes)


def _hobbing_passes(member: Member, machine: MillingMachine, job: CuttingJob) -> Iterator[Pass]:
    """One pass a stage, through all spaces at once."""
    if sorted(set(job.spaces)) != list(range(member.teeth)):
        raise InputError(
            f"{member.name}: spaces = {_short(job.spaces)}: face hobbing cuts all spaces in one roll: it must be all "
            f"{member.teeth}"
        )
    if any(member.index_correction):
        raise InputError(f"{member.name}: index_correction: face hobbing indexes without end, and not space by space")
    (cut,) = Cut.of(member)
    _check_motions(member, cut)
    spec, curved = member.flank(cut.flanks[0]), job.blocks == "poly" and member.generation == "generated"
    if curved:
        check_counting(member.name, machine)
    tooth, above = tooth_in_roll(member, cut), _HOBBING_DEPTHS * _depth(member)
    for stage, stock, tolerance in job.stages:
        given = (tolerance, job.feed, job.spindle_rpm, above, PLUNGE_FEED, tooth)
        motion = hobbing_motion(member, cut, machine, *given)
        one = (
            curved_hobbing(spec, motion, machine, degree_for(machine, 6))
            if curved
            else straight_hobbing(spec, motion, machine)
        )
        one.axes[:, 2] += lift(member, cut, stock, job.dry_run)
        label = f"all spaces {stage}, {motion.turns:.1f} turns of the work in the roll"
        axes = within_travel(one.axes, one.theta, machine, f"{member.name}, {label}")
        yield Pass(cut.tool, label, 0, axes, one.seconds, theta=one.theta, bends=one.bends)


def first_pass(
    member: Member, cut: Cut, machine: MillingMachine, job: CuttingJob, share: ControlShare
) -> tuple[np.ndarray, Pass]:
    """Cradle rotations and the pass through space 0, without stock: rolled, or for Formate plunged at rotation zero."""
    flank = member.flank(cut.flanks[0])
    tooth = middle_of_tooth(member, cut)
    if member.generation == "formate":
        theta = np.zeros(2)
        axes = axis_positions(flank, theta, machine.pivot_height, machine.pivot)
        axes[0, 2] += plunge_lift(member)
        dwell = _SPARK_OUT_TURNS * 60.0 / job.spindle_rpm if job.spindle_rpm > 0 else 0.0
    elif job.blocks == "poly":
        return _curved_pass(member, cut, machine, job, share)
    else:
        theta = roll_nodes(member, cut, job.tolerance, machine.pivot_height, machine.pivot, share.rounding)
        axes = axis_positions(flank, theta, machine.pivot_height, machine.pivot)
        dwell = 0.0
    return theta, Pass(cut.tool, "", 0, axes, block_seconds(axes, machine, job.feed, tooth), dwell, theta)


def _curved_pass(
    member: Member, cut: Cut, machine: MillingMachine, job: CuttingJob, share: ControlShare
) -> tuple[np.ndarray, Pass]:
    """The same by polynomial blocks."""
    degree, flank = degree_for(machine), member.flank(cut.flanks[0])
    theta = curve_nodes(member, cut, job.tolerance, machine, share.rounding, degree)
    powers = powers_of(flank, theta, machine.pivot_height, machine.pivot, degree)
    axes = np.vstack([powers[:, 0], powers[-1:].sum(axis=1)])
    seconds = curve_seconds(powers, machine, job.feed, middle_of_tooth(member, cut))
    return theta, Pass(cut.tool, "", 0, axes, seconds, 0.0, theta, powers[:, 2:].transpose(0, 2, 1))


@remembered(32)
def middle_of_tooth(member: Member, cut: Cut) -> np.ndarray:
    """The middle of the first flank of a pass (3,)."""
    return flank_points(member, cut.flanks[0], blank_grid(member, 1, 1)).point[0]


def tooth_in_roll(member: Member, cut: Cut) -> np.ndarray:
    """The same (3,) of a hobbed member, turned on by the indexing to where the blade meets it in the roll."""
    points = flank_points(member, cut.flanks[0], blank_grid(member, 1, 1))
    return turned(points.point[0], index_ratio(member) * float(points.contact[0, 1]))


def _depth(member: Member) -> float:
    """The whole depth of the tooth [mm] in the middle."""
    return member.blank.mean_addendum + member.blank.mean_dedendum


def _short(spaces: Sequence[int]) -> str:
    listed = ", ".join(map(str, spaces[:5]))
    return f"[{listed}]" if len(spaces) <= 5 else f"[{listed}, ...]"


def lift(member: Member, cut: Cut, stock: float, dry_run: bool) -> float:
    """How far Z is raised [mm] to leave a stock [mm] along the tooth normal, and for a dry run."""
    return stock / math.sin(_flattest(member, cut)) + (DRY_LIFT if dry_run else 0.0)


def plunge_lift(member: Member) -> float:
    """How far above the bottom a plunge of a Formate cut begins [mm]."""
    return _PLUNGE_DEPTHS * _depth(member) + _PLUNGE_MARGIN


def _flattest(member: Member, cut: Cut) -> float:
    """The smaller pressure angle [rad] of the blades of a pass."""
    return min(member.flank(flank).alpha for flank in cut.flanks)


def _check_motions(member: Member, cut: Cut) -> None:
    if len({repr(member.flank(flank).motion) for flank in cut.flanks}) > 1:
        raise InputError(
            f"{member.name}: motion: one cutter cuts both flanks at once, so that both must have the same motion"
        )

"""Probing programs: every tooth at the reference point for pitch, a grid of both flanks for topography.

After the last tooth some points of tooth 0 are touched again, as tooth z: what differs is drift.
The stylus enters a space from above, square to the root cone, and touches along the outward normal; outside of the
space it moves at a height that clears the whole member at every position of A.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from gearmath.errors import counted
from gearmath.kernels import kernel
from gearmath.machine.planning.clear_space import Room, check_home, room_of
from gearmath.machine.planning.pattern import Targets, TouchPattern, check_travel
from gearmath.machine.planning.setup_facts import NOT_ON_METAL, PROBING, VARIABLES
from gearmath.machine.planning.targets import CLEARANCE, probe_targets, tip_positions
from gearmath.machine.writing.point_loop import point_loop
from gearmath.machine.writing.probe_words import Blocks, ProbingPlan
from gearmath.machine.writing.words import plain
from gearmath.specs.bevel_set import FLANKS, BevelSet, Member, design_sha256
from gearmath.specs.calibration import Calibration
from gearmath.specs.milling_machine import MillingMachine
from gearmath.version import __version__


def clear_height(member: Member, machine: MillingMachine, calibration: Calibration) -> float:
    """Z [mm] at which the tip clears the member at every A, with B at the root angle."""
    axial, radial = kernel("flank_place")(member.blank.vector, np.array([0.0, 1.0]), np.ones(2))
    tips = np.stack([radial, np.zeros(2), axial], axis=1)
    here = tip_positions(tips, np.zeros(2), member.blank.delta_f, machine, calibration)
    return float(here[:, 2].max()) + calibration.tip_radius + CLEARANCE


def probed(
    member: Member,
    machine: MillingMachine,
    calibration: Calibration,
    program_name: str,
    topography: Sequence[int],
    pitch: bool,
    around: Sequence[int],
) -> tuple[Targets, float, Room]:
    """The touches of a member, the :func:`clear_height` of sideways motion, and the room of the work, all checked."""
    targets = probe_targets(member, machine, calibration, topography, pitch, around=around)
    level = clear_height(member, machine, calibration)
    check_travel(TouchPattern.of(targets, member.teeth, machine).targets(), member.name, machine, level)
    room = room_of(member, machine, machine.fixture)
    check_home(room, machine, calibration.length + calibration.tip_radius - calibration.offset[2], program_name)
    return targets, level, room


def probing_notes(
    bevel_set: BevelSet, name: str, machine: MillingMachine, calibration: Calibration, points: int, repeat: int
) -> Iterator[str]:
    """What the header says of set, machine and probe."""
    member = bevel_set.member(name)
    yield f"gearmath {__version__} probing program"
    yield f"set: {plain(bevel_set.title)}"
    yield f"member: {name}, {member.teeth} teeth, {member.hand} hand"
    yield f"nominal settings sha256: {design_sha256(member)}"
    yield f"machine: {plain(machine.name)}"
    tip = f"tip radius {calibration.tip_radius:g} mm, length {calibration.length:g} mm"
    yield f"probe: {plain(calibration.name)}, {tip}"
    yield f"{counted(points, 'point')}" + (f", each touched {repeat} times" if repeat > 1 else "")


def plan_of(targets: Targets, repeat: int) -> ProbingPlan:
    """What a run of all points makes, each touched ``repeat`` times."""
    flanks = " and ".join(flank for flank in FLANKS if (targets.flank == flank).any())
    touches = len(targets) * repeat
    said = f"{counted(touches, 'touch')}, {counted(len(set(targets.tooth.tolist())), 'tooth')}, {flanks}"
    return ProbingPlan(touches, said, len(targets), "point", repeat)


def write_touches(
    program_name: str,
    header: Sequence[str],
    targets: Targets,
    name: str,
    teeth: int,
    machine: MillingMachine,
    calibration: Calibration,
    level: float,
    room: Room,
    repeat: int = 1,
) -> str:
    """The text of a probing program: its touches in two loops, sideways at the ``level`` of :func:`clear_height`.

    The probe comes from the home of Z, which clears the ``room`` of the work. Every point can be the first of a run.

    Raises InputError for touches that fill the result file, and for a name that the control refuses.
    """
    pattern = TouchPattern.of(targets, teeth, machine)
    blocks = Blocks(program_name, machine, calibration.length)
    plan = plan_of(targets, repeat)
    return blocks.text(header, point_loop(blocks, pattern, name, plan, level, room))


@dataclass(frozen=True)
class TouchWriter:
    """How the programs of one control are written: what they say of themselves, and the text of their touches."""

    notes: tuple[str, ...]
    text: Callable[..., str]


#: Programs for a SINUMERIK.
SINUMERIK = TouchWriter(
    (
        "R90, R91: first and last point to touch, 0 for all; the program asks before it leaves points out",
        "a run from point 1 on deletes the touches of the last run, one that begins later adds to them",
        "R102 counts the runs, R101 the points offered, R103 those that a host has acknowledged",
        "R104 = 1, set before the start: a host reads R200 to R205 of every point, and the program waits for it",
        *(f"unconfirmed: {text}" for text in (NOT_ON_METAL, VARIABLES, PROBING)),
    ),
    write_touches,
)


def probing_program(
    bevel_set: BevelSet,
    name: str,
    machine: MillingMachine,
    calibration: Calibration,
    program_name: str,
    topography: Sequence[int] = (0,),
    pitch: bool = True,
    repeat: int = 1,
    around: Sequence[int] = (),
    writer: TouchWriter = SINUMERIK,
) -> str:
    """The program that probes a member, every point ``repeat`` times one after the other; see :func:`probe_targets`.

    Raises InputError for travel, room, and a name that the control refuses.
    """
    member = bevel_set.member(name)
    targets, level, room = probed(member, machine, calibration, program_name, topography, pitch, around)
    header = (*probing_notes(bevel_set, name, machine, calibration, len(targets), repeat), *writer.notes)
    return writer.text(program_name, header, targets, name, member.teeth, machine, calibration, level, room, repeat)

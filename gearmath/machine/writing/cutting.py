"""The text of a cutting program from its plan: header, sections, and what the header says of the flanks."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from gearmath.machine.planning.blocks import ROUNDING
from gearmath.machine.planning.cut_plan import DRY_LIFT, ONE_SPACE, PLUNGE_FEED, CuttingJob, CuttingPlan, cutting_plan
from gearmath.machine.planning.hobbing import C_ROUNDING
from gearmath.machine.planning.setup_facts import SetupFacts, member_note, setup_notes, z_note
from gearmath.machine.writing.program import write_program
from gearmath.machine.writing.words import plain
from gearmath.specs.bevel_set import BevelSet, Member, settings_sha256
from gearmath.specs.milling_machine import MillingMachine
from gearmath.version import __version__

#: Retract above the highest pass. [mm]
CLEARANCE = 40.0
#: Tooth spaces that a line of the header lists.
_LISTED = 30


def cutting_program(
    bevel_set: BevelSet,
    name: str,
    machine: MillingMachine,
    program_name: str,
    job: CuttingJob = ONE_SPACE,
    progress: Callable[[int], object] = lambda passes: None,
) -> str:
    """The text of the program of a job on one member. Raises InputError as ``cutting_plan`` does."""
    return program_of(cutting_plan(bevel_set, name, machine, job, progress), program_name)


def program_of(plan: CuttingPlan, program_name: str) -> str:
    """The text of a planned program. Raises InputError as the writer does."""
    member, machine, job = plan.member, plan.machine, plan.job
    header = (
        f"gearmath {__version__} cutting program",
        f"set: {plain(plan.title)}",
        member_note(member),
        f"machine settings sha256: {settings_sha256(member)}",
        *tolerance_notes(plan),
        _path_note(plan),
        *(f"{stage}: stock {stock:g} mm along the tooth normal" for stage, stock, _ in job.stages),
        f"feed: {job.feed:g} mm/min at the tooth",
        f"spindle: {job.spindle_rpm:g} rpm {machine.cutter_direction}, plunge: {PLUNGE_FEED:g} mm/min",
        *space_notes(job),
        *_hobbing_notes(member),
        *_polynomial_notes(plan),
        *((f"dry run: Z raised by {DRY_LIFT:g} mm",) if job.dry_run else ()),
        f"machine: {plain(machine.name)}",
        z_note(machine),
        *map(plain, setup_notes(SetupFacts.of(plan, PLUNGE_FEED))),
        "R90, R91: first and last section to cut, 0 for all; the program asks before it leaves sections out",
        f"time in the cut, without plunges and positioning: {plan.seconds:.1f} s",
    )
    return write_program(
        program_name,
        header,
        plan.passes,
        machine,
        job.spindle_rpm,
        CLEARANCE,
        plan.room,
        plan.tool_radius,
        PLUNGE_FEED,
        coolant=not job.dry_run,
    )


def tolerance_notes(plan: CuttingPlan) -> tuple[str, ...]:
    """What the header says of the flanks: how far they may deviate with the increments of this control."""
    control, share, wanted = plan.machine.control, plan.share, plan.job.tolerance * 1000
    if plan.member.process == "face_hobbing":
        blocks, rounding = wanted, max(share.rounding - ROUNDING - C_ROUNDING, 0.0) * 1000
    else:
        rounding = share.rounding * 1000
        blocks = wanted - min(rounding, wanted / 2)
    total = max(wanted, blocks + rounding)
    kind = "straight" if plan.passes[0].bends is None else "polynomial"
    return (
        f"flank tolerance: {upwards(total)} um along the tooth normal, by {kind} blocks and rounding",
        f"of which rounding to {control.increments_per_mm} increments per mm and {control.increments_per_degree} per "
        f"degree: up to {upwards(share.rounding * 1000)} um",
    )


def _path_note(plan: CuttingPlan) -> str:
    mode = plan.machine.control.path_mode
    adds = f" adds up to {upwards(plan.share.path_mode * 1000)} um" if mode == "G642" else ": exact stop"
    return f"path mode {mode}{adds}"


def space_notes(job: CuttingJob) -> Iterator[str]:
    """The spaces of the program, in lines of thirty: what virtual milling looks for."""
    spaces = list(job.spaces)
    for k in range(0, len(spaces), _LISTED):
        yield "spaces: " + ",".join(str(space) for space in spaces[k : k + _LISTED])


def _polynomial_notes(plan: CuttingPlan) -> tuple[str, ...]:
    """What the header says of polynomial blocks."""
    if (bends := plan.passes[0].bends) is None:
        return ()
    degree, most = bends.shape[2] + 1, max(int(np.diff(one.theta).astype(bool).sum()) for one in plan.passes)
    counting = "; PO of A counts on through 360 [unconfirmed]" if plan.machine.axes.A.modulo else ""
    return (
        f"blocks: POLY of degree {degree}, up to {most} in a roll; without the word POLY the control drives straight",
        f"POLY is an option of the control; POLY with G93 [unconfirmed]{counting}",
    )


def upwards(um: float) -> str:
    """A limit in um, rounded up."""
    return f"{math.ceil(um * 1e4 - 1e-6) / 1e4:g}"


def _hobbing_notes(member: Member) -> tuple[str, ...]:
    """What the header says of face hobbing."""
    if member.process != "face_hobbing":
        return ()
    return (
        f"face hobbing: {member.blade_groups} blade groups, all spaces in one roll",
        "C: cutter spindle as an axis after SPOS=0 [unconfirmed: whether M70 is needed, and the sense of C]",
    )

"""Cutting programs for LinuxCNC: every pass of the cutter as G1 blocks in inverse-time feed (G93).

P of G64 is how far LinuxCNC means X Y Z to leave the path; it has no such word for A and B. At a corner both give way
together: within 2 P before and behind it the path is a parabola, so that a rotary axis leaves its path by half of P
times the change of its degrees per mm, at most. Its controller leaves corners farther than P: see LEFT_BY.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from gearmath.errors import InputError
from gearmath.machine.planning.clear_space import check_home
from gearmath.machine.planning.cut_plan import DRY_LIFT, PLUNGE_FEED, CuttingPlan
from gearmath.machine.planning.limits import check_pass, check_process
from gearmath.machine.planning.passes import Pass
from gearmath.machine.planning.rounding import path_share
from gearmath.machine.planning.setup_facts import NOT_ON_METAL, SetupFacts, member_note, work_notes, z_note
from gearmath.machine.writing.cutting import CLEARANCE, space_notes, tolerance_notes, upwards
from gearmath.machine.writing.linuxcnc.dialect import Dialect, message
from gearmath.machine.writing.words import comment, feed_number, plain
from gearmath.specs.bevel_set import settings_sha256
from gearmath.specs.milling_machine import MillingMachine
from gearmath.version import __version__

#: What nobody has confirmed of a cutter that turns as an axis.
C_SENSE = "whether the sense of C is that of M3, and where it is 0"

#: How far the realtime controller of LinuxCNC 2.9 leaves a corner, as a multiple of P. The corner before the last block
#: of a roll is left by 1.37 P (``judging/parabolic.py``), and a servo cycle of 1 ms adds to that: 1.39 P were sampled
#: at 0.1 um, 1.51 P at 0.05 um. The other corners are left by 1.08 P at most.
LEFT_BY = 1.6


def program_of(plan: CuttingPlan, program_name: str, words: type[Dialect] = Dialect) -> str:
    """The text of a planned program, in LinuxCNC's ``words`` or those of a relative.

    Raises InputError where the machine cannot do it.
    """
    machine, job = plan.machine, plan.job
    if job.blocks == "poly":
        raise InputError(f"{program_name}: blocks = poly: LinuxCNC has no polynomials, write straight blocks")
    dialect = words(program_name, machine, machine.tool_length)
    check_process(program_name, machine, job.spindle_rpm, CLEARANCE, PLUNGE_FEED)
    check_home(plan.room, machine, machine.tool_length, program_name)
    highest = max(float(one.axes[:, 2].max()) for one in plan.passes) + CLEARANCE
    for one in plan.passes:
        check_pass(program_name, one, machine, highest)
    numbers = tool_numbers(machine, plan.passes)
    return dialect.text(_header(plan, numbers), _body(dialect, plan, numbers, highest))


def tool_numbers(machine: MillingMachine, passes: Sequence[Pass]) -> dict[str, int]:
    """The numbers of the tools of a program, in the order in which they are fetched.

    Raises InputError where the machine file gives one the number of another.
    """
    tools = dict.fromkeys(one.tool for one in passes)
    known = machine.control.tool_numbers
    numbers = {tool: known.get(tool, k) for k, tool in enumerate(tools, 1)}
    if len(set(numbers.values())) < len(numbers):
        raise InputError(f"[control] tool_numbers: {', '.join(tools)} must all have a number there, or none of them")
    return numbers


def tools_of(plan: CuttingPlan) -> dict[str, tuple[int, float]]:
    """Number and length in the tool table [mm] of the tools of a plan, by name."""
    machine = plan.machine
    length = machine.tool_length if machine.z_reference == "tip" else 0.0
    return {tool: (k, length) for tool, k in tool_numbers(machine, plan.passes).items()}


def turned_at_corners(passes: Sequence[Pass], tolerance: float) -> float:
    """How far A or B may leave its path [rad] where X Y Z leave theirs by the ``tolerance`` [mm]."""
    most = 0.0
    for one in passes:
        steps = np.diff(one.axes[:, :5], axis=0)
        way = np.linalg.norm(steps[:, :3], axis=1, keepdims=True)
        rates = steps[way[:, 0] > 0.0, 3:] / way[way[:, 0] > 0.0]
        most = max(most, float(np.abs(np.diff(rates, axis=0)).max(initial=0.0)))
    return most * tolerance / 2


def _header(plan: CuttingPlan, numbers: dict[str, int]) -> Iterator[str]:
    member, machine, job = plan.member, plan.machine, plan.job
    yield f"gearmath {__version__} cutting program"
    yield "control: LinuxCNC"
    yield f"set: {plain(plan.title)}"
    yield member_note(member)
    yield f"machine settings sha256: {settings_sha256(member)}"
    yield from tolerance_notes(plan)
    yield _path_note(plan)
    yield from (f"{stage}: stock {stock:g} mm along the tooth normal" for stage, stock, _ in job.stages)
    yield f"feed: {job.feed:g} mm/min at the tooth"
    yield f"spindle: {job.spindle_rpm:g} rpm {machine.cutter_direction}, plunge: {PLUNGE_FEED:g} mm/min"
    yield from space_notes(job)
    if member.process == "face_hobbing":
        yield f"face hobbing: {member.blade_groups} blade groups, all spaces in one roll"
        yield "C: the cutter spindle as an axis, its sense that of M3, and 0 where the first blade is [unconfirmed]"
    if job.dry_run:
        yield f"dry run: Z raised by {DRY_LIFT:g} mm"
    yield f"machine: {plain(machine.name)}, LINEAR_UNITS = mm, no WRAPPED_ROTARY"
    yield from (f"tool T{number}: {tool}" for tool, number in numbers.items())
    yield z_note(machine)
    facts = SetupFacts.of(plan, PLUNGE_FEED)
    yield from map(plain, work_notes(facts.sizes, machine))
    yield from (f"cut by {one.numbers}: {one.tool}, {one.span}" for one in facts.sections)
    yield from (f"note: {sentence}" for sentence in facts.not_stated)
    yield f"unconfirmed: {NOT_ON_METAL}"
    yield "parameters 3090, 3091: first and last section to cut, 0 for all; the program asks before it leaves any out"
    yield f"time in the cut, without plunges, positioning and slowing at corners: {plan.seconds:.1f} s"


def _path_note(plan: CuttingPlan) -> str:
    """What the path mode adds to the flank tolerance."""
    linear, _ = plan.machine.control.path_tolerance
    if linear == 0.0:
        return "path mode G61: exact path"
    return f"path mode G64 P{linear:.6f} adds up to {upwards(path_share_of(plan) * 1000)} um"


def path_share_of(plan: CuttingPlan) -> float:
    """Most that the path mode adds to the flanks [mm], along their normals."""
    linear = LEFT_BY * plan.machine.control.path_tolerance[0]
    turning = turned_at_corners(plan.passes, linear)
    return path_share(plan.member, plan.machine, linear, turning)


def _body(dialect: Dialect, plan: CuttingPlan, numbers: dict[str, int], highest: float) -> Iterator[str]:
    passes = plan.passes
    yield from dialect.head()
    yield from dialect.checks()
    yield from dialect.enough_height(plan.room, plan.tool_radius)
    yield from dialect.asked(len(passes), "section")
    yield from dialect.retract()
    first = 0
    for k in range(1, len(passes) + 1):
        if k == len(passes) or passes[k].tool != passes[first].tool:
            yield from dialect.if_chosen(first + 1, k, _tool(dialect, plan, passes[first], numbers))
            for number in range(first, k):
                one = passes[number]
                said = message(f"section {number + 1} of {len(passes)}: {one.label}")
                yield comment(dialect.name, f"section {number + 1}: {one.label}, tooth {one.tooth}")
                yield from dialect.if_chosen(number + 1, number + 1, (said, *_section(dialect, one, highest)))
            first = k
    yield from dialect.end()


def _tool(dialect: Dialect, plan: CuttingPlan, one: Pass, numbers: dict[str, int]) -> Iterator[str]:
    """A tool is fetched, and turns: with face hobbing as the axis C, else as a spindle."""
    control = plan.machine.control
    yield "M5 M9"
    yield from dialect.retract()
    yield from dialect.fetch(one.tool, numbers[one.tool])
    if one.axes.shape[1] == 5:
        yield f"S{plan.job.spindle_rpm:.3f} {plan.machine.cutter_direction}"
        if control.spindle_start_seconds > 0.0:
            yield f"G4 P{control.spindle_start_seconds:.1f}"
    if not plan.job.dry_run:
        yield "M8"


def _section(dialect: Dialect, one: Pass, highest: float) -> Iterator[str]:
    """One pass by itself: modal head, approach above its first point, plunge, the cut, retract.

    It leaves G93 at its end and renews F for G94.
    """
    points = dialect.positions.words(one.axes[:, :5])
    cutter = dialect.positions.cutter_words(one.axes[:, 5]) if one.axes.shape[1] == 6 else [""] * len(points)
    (x, y, z, *turned), *_ = points
    yield dialect.modal()
    yield f"G0 {x} {y} {' '.join(turned)} {cutter[0]}".rstrip()
    yield f"G0 {dialect.positions.z(highest)}"
    yield f"G1 {z} F{PLUNGE_FEED:.3f}"
    yield "G93"
    for words, turn, seconds in zip(points[1:], cutter[1:], one.seconds.tolist(), strict=True):
        yield f"G1 {' '.join(words)} {turn}".rstrip() + f" F{feed_number(60.0 / seconds)}"
    if one.dwell > 0.0:
        yield f"G4 P{feed_number(one.dwell)}"
    yield f"G94 F{PLUNGE_FEED:.3f}"
    yield f"G0 {dialect.positions.z(highest)}"

"""The settings file of ``gm-post``: a planned cut as flat text, from which that C program writes the NC program.

The text of the program is that of the Python writer: what it wrote, with a slot wherever a number stands that the C
program computes. So no text of a program is kept twice, and a change of the writer needs no change here. Lines:

    gm-post 3                          the format
    sum HEX                            FNV-1a, 64 bits, of all that follows, without carriage returns
    KEY NUMBERS                        machine and job: mm, rad, s, as the planner has them
    roll NAME                          then its settings, motion, tooth, plunge and nodes: one path of the cutter
    degree N                           of the blocks between its nodes: 1 where the line is missing, else 3 or 5
    to NUMBERS                         or so, of a hobbed member, the end of every planned block: X Y Z A B C, seconds,
                                       and where it has a degree a_2, a_3 .. of each axis
    pass ROLL LIFT ANGLE DWELL         one tooth space: where the path is raised and turned to
    c TEXT, n TEXT                     a line; a line with a number
    r TEXT, b TEXT                     the same for every node but the first
    s TEXT, e TEXT                     a line where the sum is right, and one where the file was edited

Slots are {NAME}, {TIME}, {UP}, {X} {Y} {Z} {A} {B} {C} of a node, and of the block that ends there {F} and {PX} ..
{PC}, the end and the coefficients of a polynomial; {{ is a brace.

Blocks of generated flanks, straight ones and polynomials, are computed from the settings. Rolls of face hobbing are
planned by searches that are not in the C library: they stand there as positions, coefficients and times.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from gearmath.bevel.method import motion_of
from gearmath.errors import ComputationError
from gearmath.machine.judging.dialects import SINUMERIK, ControlDialect
from gearmath.machine.planning.curves import NO_JERK_LIMIT
from gearmath.machine.planning.cut_plan import CuttingPlan, lift, middle_of_tooth, plunge_lift
from gearmath.machine.planning.passes import Pass, tooth_angles
from gearmath.machine.planning.path import Cut
from gearmath.machine.writing.cutting import CLEARANCE
from gearmath.machine.writing.program import pass_words
from gearmath.machine.writing.words import Positions, feed_number
from gearmath.specs.bevel_set import SETTINGS
from gearmath.specs.milling_machine import AXES
from gearmath.version import __version__

#: The name of a program while its text is turned into a form.
_NAME = "GM_POST_NAME"
_NUMBER = re.compile(r"-?\d+\.\d+")
_SHA = "; machine settings sha256: "
_EDITED = (
    "; machine settings: edited in the settings file of gm-post; what this head says of settings, tolerances and chips "
    "is as of the export"
)


@dataclass(frozen=True)
class _Form:
    """A plan, the paths of its cutters, and how positions stand in the text of the control's dialect.

    A roll is a cut, the name of its stage, its stock [mm], and a pass along it.
    """

    plan: CuttingPlan
    positions: Positions
    rolls: list[tuple[Cut, str, float, Pass]]


def post_file(plan: CuttingPlan, dialect: ControlDialect = SINUMERIK) -> str:
    """The settings file of one planned member, for programs in a dialect.

    Raises InputError as the writer does, ComputationError where a number of the program has no slot.
    """
    form = _Form(plan, dialect.positions(plan.machine), _rolls(plan))
    text = dialect.cutting(plan, _NAME).splitlines()
    body = "".join(f"{line}\n" for line in (*_values(form), *_roll_lines(form), *_lines(form, text)))
    return f"gm-post 3\nsum {_fnv(body.encode('ascii')):016x}\n{body}"


def _fnv(data: bytes) -> int:
    value = 0xCBF29CE484222325
    for byte in data:
        value = (value ^ byte) * 0x100000001B3 % 2**64
    return value


def _numbers(values: Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)


def _values(form: _Form) -> Iterator[str]:
    plan, machine, positions = form.plan, form.plan.machine, form.positions
    yield f"# gearmath {__version__}: {plan.member.name} on {machine.name}; mm, rad, s".encode(
        "ascii", "replace"
    ).decode()
    yield f"decimals {positions.mm} {positions.degrees}"
    yield f"modulo {int(positions.modulo)} {int(positions.turning_cutter)}"
    yield f"length {_numbers([positions.length])}"
    yield f"pivot {_numbers([machine.pivot_height, *machine.pivot])}"
    for axis, (low, high) in zip(AXES, machine.travel, strict=True):
        if np.isfinite(low):
            yield f"travel {axis} {_numbers([low, high])}"
    yield f"speed {_numbers(machine.max_speed)}"
    yield f"acceleration {_numbers(machine.max_acceleration)}"
    yield f"jerk {_numbers(np.minimum(machine.max_jerk, NO_JERK_LIMIT))}"
    yield f"feed {_numbers([plan.job.feed])}"
    yield f"clearance {_numbers([CLEARANCE])}"


def _rolls(plan: CuttingPlan) -> list[tuple[Cut, str, float, Pass]]:
    """Every path of a cutter: its cut, name of the stage, stock, and a pass along it."""
    found = []
    for cut in Cut.of(plan.member):
        for k, (stage, stock, _) in enumerate(plan.job.stages):
            passes = [one for one in plan.passes if one.tool == cut.tool]
            found.append((cut, stage, stock, passes[k * _passes_of_a_stage(plan)]))
    return found


def _passes_of_a_stage(plan: CuttingPlan) -> int:
    return 1 if plan.member.process == "face_hobbing" else len(plan.job.spaces)


def _roll_lines(form: _Form) -> Iterator[str]:
    plan = form.plan
    if plan.member.process != "face_hobbing":
        yield f"# settings: {' '.join(SETTINGS)}"
    for cut, stage, _, one in form.rolls:
        flank = plan.member.flank(cut.flanks[0])
        motion = motion_of(flank)
        yield f"roll {cut.tool}_{stage}"
        if plan.member.process == "face_hobbing":
            columns = [one.axes, np.append(0.0, one.seconds)]
            if one.bends is not None:
                yield f"degree {one.bends.shape[2] + 1}"
                columns.append(np.vstack([np.zeros(one.bends[0].size), one.bends.reshape(len(one.seconds), -1)]))
            yield from (f"to {_numbers(row)}" for row in np.column_stack(columns))
            continue
        yield f"settings {_numbers(flank.vector)}"
        if motion.any():
            yield from (f"motion {_numbers(row)}" for row in motion)
        yield f"tooth {_numbers(middle_of_tooth(plan.member, cut))}"
        yield f"plunge {_numbers([plunge_lift(plan.member) if plan.member.generation == 'formate' else 0.0])}"
        if one.bends is not None:
            yield f"degree {one.bends.shape[2] + 1}"
        yield from (f"node {_numbers([theta])}" for theta in one.theta)


def _lines(form: _Form, text: Sequence[str]) -> Iterator[str]:
    """The text of the program with its slots."""
    plan, rolls = form.plan, form.rolls
    starts = [k for k, line in enumerate(text) if re.match(r"; section \d+:", line)]
    if len(starts) != len(plan.passes):
        raise ComputationError(
            f"{plan.member.name}: the program has {len(starts)} sections for {len(plan.passes)} passes"
        )
    up = form.positions.z(max(float(one.axes[:, 2].max()) for one in plan.passes) + CLEARANCE)
    time = f"{plan.seconds:.1f} s"
    for line in text[: starts[0]]:
        if line.startswith(_SHA):
            yield f"s {_literal(line)}"
            yield f"e {_EDITED}"
        elif line.startswith("; time in the cut") and line.endswith(time):
            yield f"c {_literal(line.removesuffix(time))}{{TIME}} s"
        else:
            yield _kept(line)
    ends = [*starts[1:], len(text)]
    each = {(cut.tool, stage): k for k, (cut, stage, _, _) in enumerate(rolls)}
    angles = tooth_angles(plan.member.teeth, plan.member.rad("index_correction"))
    hobbed, count = plan.member.process == "face_hobbing", _passes_of_a_stage(plan)
    lifts = [0.0 if hobbed else lift(plan.member, cut, stock, plan.job.dry_run) for cut, _, stock, _ in rolls]
    for number, (one, (start, end)) in enumerate(zip(plan.passes, zip(starts, ends, strict=True), strict=True)):
        stage = plan.job.stages[number // count % len(plan.job.stages)][0]
        roll = each[one.tool, stage]
        yield f"pass {roll} {_numbers([lifts[roll], angles[one.tooth], one.dwell])}"
        yield from _section(form, one, up, text[start:end])


def _section(form: _Form, one: Pass, up: str, lines: Sequence[str]) -> Iterator[str]:
    """One section: positions before the first block, the blocks as one line, the rest."""
    words = pass_words(one, form.positions)
    slots, ends = ([_slot(word) for word in words[k]] for k in (0, -1))
    feeds = [f"F{feed_number(60.0 / seconds)}" for seconds in one.seconds.tolist()]
    node = 0
    for line in lines:
        numbered, block = _split(line)
        parts = block.split(" ")
        following = [*words[node + 1], feeds[node]] if node < len(feeds) else []
        if following and parts[-len(following) :] == following:
            if node == 0:
                begin = " ".join(map(_literal, parts[: -len(following)]))
                yield f"{'b' if numbered else 'r'} {begin} {' '.join(ends)} F{{F}}"
            node += 1
            continue
        if line.startswith(";"):
            yield _kept(line)
            continue
        if node == 0:
            parts = [slots[words[0].index(part)] if part in words[0] else _literal(part) for part in parts]
        parts = [_NUMBER.sub("{UP}", part) if part == up else part for part in parts]
        yield f"{'n' if numbered else 'c'} {' '.join(parts)}"
    if node != len(feeds):
        raise ComputationError(
            f"{form.plan.member.name}: {len(feeds) - node} blocks of section {one.label!r} have no slots"
        )


def _slot(word: str) -> str:
    """The word of an axis with a slot for its number, or for all that stands in the brackets of a polynomial."""
    axis, curved = re.sub("PO", "", word).strip("[")[0], "PO" in word
    return re.sub(r"\(.*\)", f"({{P{axis}}})", word) if curved else _NUMBER.sub(f"{{{axis}}}", word)


def _split(line: str) -> tuple[bool, str]:
    """Whether a line has a number, and what follows it."""
    found = re.match(r"N\d+ ", line)
    return (True, line[found.end() :]) if found else (False, line)


def _kept(line: str) -> str:
    """A line without slots, but for the name of the program."""
    numbered, block = _split(line)
    return f"{'n' if numbered else 'c'} {_literal(block).replace(_NAME, '{NAME}')}"


def _literal(text: str) -> str:
    return text.replace("{", "{{")

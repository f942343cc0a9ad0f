"""Writes cutting programs for SINUMERIK 840D sl: every pass of the cutter as G1 blocks in inverse-time feed (G93).

A modulo axis A goes the short way (DC), a counting one is written as it counts. Where a pass has a sixth column, the
cutter's spindle stands still at SPOS=0 first, and then runs as axis C. That C may follow SPOS without M70, and that its
sense is that of M3, depends on the machine [unconfirmed].

Where a pass has coefficients its blocks are polynomials: POLY with PO[X]=(..), or X=PO(..) of the fifth degree. All
axes that move are in FGROUP, so that all of them are functions of one parameter. That G93 may stand with POLY, and that
PO of a modulo A counts on through 360, no page of a manual at hand confirms [unconfirmed]; in face hobbing A and C,
which turn on, are counting axes.

The reader of these programs is ``gearmath.machine.control.reader``; it shares no code with this module, so that each
checks the other.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from gearmath.errors import InputError
from gearmath.machine.planning.clear_space import Room, check_home
from gearmath.machine.planning.limits import check_pass, check_process
from gearmath.machine.planning.passes import Pass
from gearmath.machine.writing import start
from gearmath.machine.writing.chosen import FIRST, LAST, asked, if_chosen
from gearmath.machine.writing.words import (
    MAX_BLOCK_CHARACTERS,
    MAX_LONG_CHARACTERS,
    MOST_SHORT_VALUES,
    Positions,
    check_name,
    comment,
    feed_number,
    numbered,
)
from gearmath.specs.milling_machine import AXES, CUTTER_AXIS, MillingMachine

__all__ = ["Pass", "write_program"]


def write_program(
    name: str,
    header: Sequence[str],
    passes: Sequence[Pass],
    machine: MillingMachine,
    spindle_rpm: float,
    clearance: float,
    room: Room,
    tool_radius: float,
    plunge_feed_mm_min: float = 200.0,
    coolant: bool = True,
) -> str:
    """The text of the program ``name`` (without .MPF); ``header`` lines become comments.

    Before anything else moves, Z retracts to its home, which must clear the ``room`` of the work; ``tool_radius`` [mm]
    is the widest radius of cutter, head and spindle. Between the passes of
    a tool all positioning happens ``clearance`` mm above the highest point of all passes. Every pass is a section of
    its own, with a label, a message and its modal head: R90 and R91 say which of them are cut. Raises InputError,
    naming pass, axis, value and limit, where the machine cannot do it or the text would break a rule of the control.
    """
    check_name(name)
    check_process(name, machine, spindle_rpm, clearance, plunge_feed_mm_min)
    check_home(room, machine, machine.tool_length, name)
    if not passes:
        raise InputError(f"{name}: there is no pass to write")
    retract = max(float(one.axes[:, 2:3].max(initial=-np.inf)) for one in passes if one.axes.ndim == 2) + clearance
    for one in passes:
        check_pass(name, one, machine, retract)
    job = _Job(name, machine, Positions.of(machine, machine.tool_length), spindle_rpm, retract, plunge_feed_mm_min)
    text = numbered([comment(name, text) for text in (name, *header)], _body(job, passes, room, tool_radius, coolant))
    _check_lengths(name, text, passes)
    return text


def _check_lengths(name: str, text: str, passes: Sequence[Pass]) -> None:
    """Raises InputError for a block of polynomials that the control would not read to its end."""
    if passes[0].bends is None:
        return
    most = MAX_BLOCK_CHARACTERS if passes[0].values_of_a_block <= MOST_SHORT_VALUES else MAX_LONG_CHARACTERS
    for number, line in enumerate(text.splitlines(), start=1):
        if len(line) + 1 > most:
            raise InputError(f"{name}: line {number} has {len(line) + 1} characters, {most} are allowed")


@dataclass(frozen=True)
class _Job:
    """What all sections of a program have in common: mm, mm/min and turns per minute."""

    name: str
    machine: MillingMachine
    positions: Positions
    rpm: float
    retract: float
    plunge: float

    @property
    def up(self) -> str:
        """The word of Z above all passes."""
        return self.positions.z(self.retract)


def _body(job: _Job, passes: Sequence[Pass], room: Room, tool_radius: float, coolant: bool) -> Iterator[str]:
    """Blocks without their numbers, and comments."""
    machine = job.machine
    yield from start.head(machine, "" if passes[0].bends is None else (AXES + CUTTER_AXIS)[: passes[0].axes.shape[1]])
    yield from start.checks(machine)
    yield from start.enough_height(machine, room, machine.tool_length, tool_radius)
    yield from asked(len(passes), "section")
    yield from start.retract(machine)
    for first, last in _by_tool(passes):
        one = passes[first]
        yield if_chosen(first + 1, last)
        yield "M5 M9"
        yield from start.retract(machine)
        yield from start.fetch(machine, one.tool, machine.tool_length)
        yield "SPOS=0" if one.axes.shape[1] == 6 else f"S{job.rpm:.3f} {machine.cutter_direction}"
        yield from start.dwell(machine.control.spindle_start_seconds)
        if coolant:
            yield "M8"
        yield "ENDIF"
        for k in range(first, last):
            yield from _section(job, passes[k], k + 1, len(passes))
    yield f"{FIRST}=0 {LAST}=0"
    yield from start.end(machine)


def _by_tool(passes: Sequence[Pass]) -> Iterator[tuple[int, int]]:
    """First pass, and the one behind the last, of every row of passes with one tool."""
    first = 0
    for k in range(1, len(passes) + 1):
        if k == len(passes) or passes[k].tool != passes[first].tool:
            yield first, k
            first = k


def _section(job: _Job, one: Pass, number: int, count: int) -> Iterator[str]:
    """One pass by itself: label, message, modal head, approach above its first point, plunge, the cut, retract.

    The last block leaves G93 and renews F for G94.
    """
    machine = job.machine
    (x, y, z, *turned), *points = pass_words(one, job.positions)
    mode = "G1" if one.bends is None else "POLY"
    yield comment(job.name, f"section {number}: {one.label}, tooth {one.tooth}")
    yield f"SECTION_{number}:"
    yield if_chosen(number, number)
    yield f'MSG("section {number} of {count}: {one.label}")'
    yield start.modal(machine)
    yield f"G0 {x} {y} {' '.join(turned)}"
    yield f"G0 {job.up}"
    yield f"G94 G1 {z} F{job.plunge:.3f}"
    for words, seconds in zip(points, one.seconds.tolist(), strict=True):
        yield f"G93 {mode} {' '.join(words)} F{feed_number(60.0 / seconds)}"
    if one.dwell > 0.0:
        yield f"G4 F{feed_number(one.dwell)}"
    yield f"G94 G0 {job.up} F{job.plunge:.3f}"
    yield "ENDIF"


def pass_words(one: Pass, positions: Positions) -> list[tuple[str, ...]]:
    """The words of the positions of a pass: its first, and the ends of its blocks."""
    ends = one.axes if one.bends is None else one.axes[:1]
    points = positions.words(ends[:, :5])
    if one.axes.shape[1] == 6:
        points = [(*words, word) for words, word in zip(points, positions.cutter_words(ends[:, 5]), strict=True)]
    return points if one.bends is None else [*points, *positions.polynomial_words(one.axes, one.bends)]

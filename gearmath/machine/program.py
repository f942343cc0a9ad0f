"""Writes NC programs for SINUMERIK 840D sl: every pass of the cutter as G1 blocks in inverse-time feed (G93).

Millimetres with five decimals, degrees with six; a modulo axis A goes the short way (DC), a counting one is written
as it counts. Where a pass has a sixth column, the cutter's spindle stands still at SPOS=0 first, and then runs as axis
C. That C may follow SPOS without M70, and that its sense is that of M3, depends on the machine [unconfirmed].

The reader of these programs is ``gearmath.machine.reader``; it shares no code with this module, so that each checks
the other.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from gearmath.errors import InputError
from gearmath.machine.limits import check_pass, check_process
from gearmath.machine.passes import Pass
from gearmath.machine.words import (
    axis_words,
    check_name,
    comment,
    cutter_positions,
    cutter_word,
    feed_number,
    fixed,
    numbered,
    printed,
)
from gearmath.specs.milling_machine import MillingMachine

__all__ = ["Pass", "write_program"]


def write_program(
    name: str,
    header: Sequence[str],
    passes: Sequence[Pass],
    machine: MillingMachine,
    spindle_rpm: float,
    clearance: float,
    plunge_feed_mm_min: float = 200.0,
    coolant: bool = True,
) -> str:
    """The text of the program ``name`` (without .MPF); ``header`` lines become comments.

    All positioning happens ``clearance`` mm above the highest point of all passes. Raises InputError, naming pass,
    axis, value and limit, where the machine cannot do it or the text would break a rule of the control.
    """
    check_name(name)
    check_process(name, machine, spindle_rpm, clearance, plunge_feed_mm_min)
    if not passes:
        raise InputError(f"{name}: there is no pass to write")
    retract = max(float(one.axes[:, 2:3].max(initial=-np.inf)) for one in passes if one.axes.ndim == 2) + clearance
    for one in passes:
        check_pass(name, one, machine, retract)
    body = _body(name, passes, machine, spindle_rpm, fixed(retract), plunge_feed_mm_min, coolant)
    return numbered([comment(name, text) for text in (name, *header)], body)


def _body(
    name: str, passes: Sequence[Pass], machine: MillingMachine, rpm: float, retract: str, plunge: float, coolant: bool
) -> Iterator[str]:
    """Blocks without their numbers, and comments."""
    yield f"G17 G40 G90 G710 G94 {machine.work_offset}"
    if machine.control.words:
        yield " ".join(machine.control.words)
    tool = None
    for one in passes:
        if one.tool != tool:
            if tool is not None:
                yield "M5 M9"
            tool = one.tool
            yield f'T="{tool}" D1'
            yield "M6"
            yield "SPOS=0" if one.axes.shape[1] == 6 else f"S{rpm:.3f} {machine.cutter_direction}"
            if coolant:
                yield "M8"
        yield comment(name, f"{one.label}, tooth {one.tooth}")
        yield from _pass_blocks(one, machine, retract, plunge)
    yield "M5 M9"
    yield "M30"


def _words(one: Pass, machine: MillingMachine) -> list[tuple[str, ...]]:
    modulo = machine.axes.A.modulo
    points: list[tuple[str, ...]] = [axis_words(point, modulo) for point in printed(one.axes[:, :5], modulo)]
    if machine.axes.C is None or one.axes.shape[1] == 5:
        return points
    turning = machine.axes.C.modulo
    cutter = [cutter_word(value, turning) for value in cutter_positions(one.axes[:, 5], turning).tolist()]
    return [(*words, word) for words, word in zip(points, cutter, strict=True)]


def _pass_blocks(one: Pass, machine: MillingMachine, retract: str, plunge: float) -> Iterator[str]:
    """Approach above the first point, plunge, the cut, retract. The last block leaves G93 and renews F for G94."""
    points = _words(one, machine)
    x, y, z, *turned = points[0]
    yield f"G0 Z{retract}"
    yield f"G0 {x} {y} {' '.join(turned)}"
    yield f"G94 G1 {z} F{plunge:.3f}"
    for words, seconds in zip(points[1:], one.seconds.tolist(), strict=True):
        yield f"G93 G1 {' '.join(words)} F{feed_number(60.0 / seconds)}"
    if one.dwell > 0.0:
        yield f"G4 F{feed_number(one.dwell)}"
    yield f"G94 G0 Z{retract} F{plunge:.3f}"

"""Writes NC programs for SINUMERIK 840D sl: every pass of the cutter as G1 blocks in inverse-time feed (G93).

Millimetres with five decimals, degrees with six; A is a modulo axis and goes the short way (DC). The reader of these
programs is ``gearmath.machine.reader``; it shares no code with this module, so that each checks the other.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from gearmath.errors import InputError
from gearmath.specs.milling_machine import AXES, UNITS, UNITS_PER_INTERNAL, MillingMachine

#: A block may be no longer than this, comment and line end included.
MAX_BLOCK_CHARACTERS = 250
MAX_NAME_CHARACTERS = 24
_MM_DECIMALS, _DEG_DECIMALS, _FEED_DIGITS = 5, 6, 9
#: Shortest and longest block; beyond them F has more digits than a control keeps.
_BLOCK_SECONDS = (1e-4, 1e5)
_MAX_TURN_DEG = 180.0 - 2e-6
_PROGRAM_NAME = re.compile(r"(?:[A-Za-z]{2}|_[A-Za-z])[A-Za-z0-9_]*")
_RESERVED_NAME = re.compile(r"CON|PRN|AUX|NUL|(?:COM|LPT)[1-9]", re.IGNORECASE)
_TOOL_NAME = re.compile(r"[A-Za-z0-9_]{1,31}")
#: Speeds may pass their limit by this much of it: the rounding of block times that were made to reach the limit.
_SPEED_SLACK = 1e-6


@dataclass(frozen=True)
class Pass:
    """One tool roll through one tooth space: plunge, cut along ``axes``, retract."""

    tool: str
    label: str
    tooth: int
    axes: np.ndarray
    """Positions X Y Z A B at the block ends, (n, 5) mm and rad; A counts on, not modulo."""
    seconds: np.ndarray
    """Duration of each block, (n-1,) s."""


def block_seconds(axes: np.ndarray, machine: MillingMachine, feed_mm_min: float) -> np.ndarray:
    """Duration of the blocks between ``axes`` (n, 5): (n-1,) s.

    The cutter centre moves with ``feed_mm_min`` along its path in X Y Z, or slower where an axis reaches its highest
    speed. Raises InputError for a feed that is not positive.
    """
    if not (math.isfinite(feed_mm_min) and feed_mm_min > 0):
        raise InputError(f"feed = {feed_mm_min} mm/min: must be greater than 0")
    steps = np.abs(np.diff(axes, axis=0))
    path = np.linalg.norm(steps[:, :3], axis=1) * 60.0 / feed_mm_min
    return np.maximum(path, (steps / machine.max_speed).max(axis=1))


def write_program(
    name: str,
    header: Sequence[str],
    passes: Sequence[Pass],
    machine: MillingMachine,
    spindle_rpm: float,
    clearance: float,
    plunge_feed_mm_min: float = 200.0,
) -> str:
    """The text of the program ``name`` (without .MPF); ``header`` lines become comments.

    All positioning happens ``clearance`` mm above the highest point of all passes. Raises InputError, naming pass,
    axis, value and limit, where the machine cannot do it or the text would break a rule of the control.
    """
    _check_name(name)
    _check_process(name, machine, spindle_rpm, clearance, plunge_feed_mm_min)
    if not passes:
        raise InputError(f"{name}: there is no pass to write")
    for one in passes:
        _check_shape(name, one)
    retract = max(float(one.axes[:, 2].max()) for one in passes) + clearance
    for one in passes:
        _check_travel(name, one, machine, retract)
        _check_speed(name, one, machine)
    lines = [_comment(name, text) for text in (name, *header)]
    body = _body(name, passes, machine, spindle_rpm, _fixed(retract), plunge_feed_mm_min)
    number = 0
    for line in body:
        if not line.startswith(";"):
            number += 10
            line = f"N{number} {line}"
        lines.append(line)
    return "\n".join(lines) + "\n"


def _body(
    name: str, passes: Sequence[Pass], machine: MillingMachine, rpm: float, retract: str, plunge: float
) -> Iterator[str]:
    """Blocks without their numbers, and comments."""
    yield f"G17 G40 G90 G710 G94 {machine.work_offset}"
    tool = None
    for one in passes:
        if one.tool != tool:
            if tool is not None:
                yield "M5 M9"
            tool = one.tool
            yield f'T="{tool}" D1'
            yield "M6"
            yield f"S{rpm:.3f} M3"
            yield "M8"
        yield _comment(name, f"{one.label}, tooth {one.tooth}")
        yield from _pass_blocks(one, retract, plunge)
    yield "M5 M9"
    yield "M30"


def _pass_blocks(one: Pass, retract: str, plunge: float) -> Iterator[str]:
    """Approach above the first point, plunge, the cut, retract. The last block leaves G93 and renews F for G94."""
    points = [_axis_words(point) for point in _printed(one.axes)]
    x, y, z, a, b = points[0]
    yield f"G0 Z{retract}"
    yield f"G0 {x} {y} {a} {b}"
    yield f"G94 G1 {z} F{plunge:.3f}"
    for words, seconds in zip(points[1:], one.seconds.tolist(), strict=True):
        yield f"G93 G1 {' '.join(words)} F{_feed(60.0 / seconds)}"
    yield f"G94 G0 Z{retract} F{plunge:.3f}"


def _printed(axes: np.ndarray) -> np.ndarray:
    """Positions as they stand in the text: (n, 5) mm and degrees, rounded, A in 0 <= A < 360, no negative zero."""
    values = axes * UNITS_PER_INTERNAL
    values[:, :3] = np.round(values[:, :3], _MM_DECIMALS)
    values[:, 3] = np.round(values[:, 3] % 360.0, _DEG_DECIMALS) % 360.0
    values[:, 4] = np.round(values[:, 4], _DEG_DECIMALS)
    return values + 0.0


def _axis_words(point: np.ndarray) -> tuple[str, str, str, str, str]:
    x, y, z, a, b = point.tolist()
    mm, deg = _MM_DECIMALS, _DEG_DECIMALS
    return f"X{x:.{mm}f}", f"Y{y:.{mm}f}", f"Z{z:.{mm}f}", f"A=DC({a:.{deg}f})", f"B{b:.{deg}f}"


def _fixed(value: float) -> str:
    """A length in mm, without negative zero."""
    return f"{round(value, _MM_DECIMALS) + 0.0:.{_MM_DECIMALS}f}"


def _feed(value: float) -> str:
    """F with nine significant digits in fixed form: one part in 1e9 of the block's time."""
    decimals = max(1, _FEED_DIGITS - 1 - math.floor(math.log10(value)))
    return f"{value:.{decimals}f}"


def _comment(name: str, text: str) -> str:
    """One comment line. Raises InputError for what would end the line, or for characters the control may not show."""
    bad = next((character for character in text if not " " <= character <= "~"), None)
    if bad is not None:
        raise InputError(f"{name}: comment {text!r}: the character {bad!r} is not printable ASCII")
    line = f"; {text}"
    if len(line) + 1 > MAX_BLOCK_CHARACTERS:
        raise InputError(
            f"{name}: comment {text[:40]!r}...: {len(line) + 1} characters, {MAX_BLOCK_CHARACTERS} allowed"
        )
    return line


def _check_name(name: str) -> None:
    if len(name) > MAX_NAME_CHARACTERS:
        raise InputError(f"program name {name!r}: has {len(name)} characters, {MAX_NAME_CHARACTERS} are allowed")
    if not _PROGRAM_NAME.fullmatch(name):
        raise InputError(
            f"program name {name!r}: must be letters, digits and _, and begin with two letters or with _ and a letter"
        )
    if _RESERVED_NAME.fullmatch(name):
        raise InputError(f"program name {name!r}: is a reserved name of the operating system")


def _check_process(name: str, machine: MillingMachine, rpm: float, clearance: float, plunge: float) -> None:
    low, high = machine.spindle_speed_rpm
    if not low <= rpm <= high:
        raise InputError(f"{name}: spindle speed = {rpm} rpm: {machine.name} has {low:g} to {high:g} rpm")
    if not (math.isfinite(clearance) and clearance > 0):
        raise InputError(f"{name}: clearance = {clearance} mm: must be greater than 0")
    fastest = machine.axes.Z.max_speed_per_min
    # three decimals are written, and F0.000 is no feed
    if not 0.001 <= plunge <= fastest:
        raise InputError(f"{name}: plunge feed = {plunge} mm/min: must be 0.001 to {fastest:g} mm/min, the speed of Z")


def _where(name: str, one: Pass) -> str:
    return f"{name}, pass {one.label!r}, tooth {one.tooth}"


def _check_shape(name: str, one: Pass) -> None:
    where, n = _where(name, one), len(one.axes)
    if not _TOOL_NAME.fullmatch(one.tool):
        raise InputError(f"{where}: tool = {one.tool!r}: must be 1 to 31 letters, digits and _")
    if one.axes.ndim != 2 or one.axes.shape[1] != 5 or n < 2 or one.seconds.shape != (n - 1,):
        shapes = f"positions {one.axes.shape} and times {one.seconds.shape}"
        raise InputError(f"{where}: has {shapes}, needed are (n, 5) and (n-1,) with n at least 2")
    if not np.isfinite(one.axes).all():
        point, axis = np.argwhere(~np.isfinite(one.axes))[0]
        raise InputError(f"{where}: axis {AXES[axis]} = {one.axes[point, axis]} at point {point}: must be finite")
    shortest, longest = _BLOCK_SECONDS
    bad = ~((one.seconds >= shortest) & (one.seconds <= longest))
    if bad.any():
        block = int(bad.argmax())
        raise InputError(
            f"{where}: time = {one.seconds[block]} s of block {block}: must be {shortest} to {longest:g} s"
        )


def _check_travel(name: str, one: Pass, machine: MillingMachine, retract: float) -> None:
    raised = one.axes[:1].copy()
    raised[0, 2] = retract
    points = np.vstack([one.axes, raised])
    low, high = machine.travel.T
    outside = np.argwhere((points < low) | (points > high))
    if outside.size:
        point, axis = outside[0]
        scale = UNITS_PER_INTERNAL[axis]
        where = "above the first point" if point == len(one.axes) else f"at point {point}"
        raise InputError(
            f"{_where(name, one)}: axis {AXES[axis]} = {points[point, axis] * scale:.5f} {UNITS[axis]} {where}: "
            f"{machine.name} travels {low[axis] * scale:g} to {high[axis] * scale:g} {UNITS[axis]}"
        )


def _check_speed(name: str, one: Pass, machine: MillingMachine) -> None:
    steps = np.diff(one.axes, axis=0)
    fast = np.argwhere(np.abs(steps) > machine.max_speed * one.seconds[:, None] * (1.0 + _SPEED_SLACK))
    if fast.size:
        block, axis = fast[0]
        scale = 60.0 * UNITS_PER_INTERNAL[axis]
        speed, limit = abs(steps[block, axis]) / one.seconds[block] * scale, machine.max_speed[axis] * scale
        raise InputError(
            f"{_where(name, one)}: axis {AXES[axis]} = {speed:.1f} {UNITS[axis]}/min in block {block}: "
            f"{machine.name} allows {limit:g} {UNITS[axis]}/min"
        )
    # DC goes the short way: from half a turn on, as printed, it would go the other one
    turned = np.degrees(np.abs(steps[:, 3]))
    if (turned > _MAX_TURN_DEG).any():
        block = int((turned > _MAX_TURN_DEG).argmax())
        raise InputError(
            f"{_where(name, one)}: axis A turns {turned[block]:.6f} degrees in block {block}: must be less than 180"
        )

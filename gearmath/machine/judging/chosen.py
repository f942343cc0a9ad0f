"""Whether R90 and R91 choose the parts of a program that they name, whole, and not before the operator has agreed.

Every part is run alone, as somebody does who goes on after an abort: its motion must be that of the whole run, so that
no run begins within a part, leaves one out, or makes another one. :mod:`gearmath.machine.measuring.parts` is the same
for probing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from gearmath.errors import InputError
from gearmath.machine.control.executor import MachinePath, ProgramRun, run_program
from gearmath.machine.control.state import Setup
from gearmath.machine.control.text import is_for_linuxcnc
from gearmath.machine.judging.faults import Fault

#: Sections that a cutting program may have, and positions that are the same. [mm, rad]
_MOST, _SAME = 5000, 1e-9


def reads_choice(text: str) -> bool:
    """Whether a program knows R90, or #3090 of LinuxCNC, at all."""
    return "#3090" in text if is_for_linuxcnc(text) else "R90" in text


def chosen_faults(text: str, name: str, path: MachinePath, setup: Setup) -> Iterator[Fault]:
    """What is wrong with the parts of a cutting program that are run alone; ``path`` is that of the whole run."""

    def run(first: int, last: int) -> ProgramRun:
        return run_program(text, name, parameters={90: float(first), 91: float(last)}, setup=setup)

    whole, done = all_rows(path), 0
    cuts = np.flatnonzero(~path.rapid)
    for number in range(1, _MOST):
        alone = tried(run, number, number)
        if isinstance(alone, str):
            yield Fault(f"with R90={number} R91={number} {alone}", kind="part")
            return
        if not_run(alone):
            break
        yield from agreed(alone, number)
        part = np.flatnonzero(~alone.path.rapid)
        if not len(part):
            yield Fault(f"with R90={number} R91={number} cuts nothing", kind="part")
            return
        if not same_part(all_rows(alone.path), part, whole, cuts[done : done + len(part)]):
            line = int(alone.path.line[~alone.path.rapid][0])
            yield Fault(
                f"with R90={number} R91={number} does not make section {number} of the whole run, and that alone",
                line,
                "part",
            )
            return
        done += len(part)
    if done != len(cuts):
        yield Fault(f"the {number - 1} sections that R90 and R91 choose do not make the whole program", kind="part")
        return
    yield from wrong_choices(run, number - 1)


def wrong_choices(run: Callable[[int, int], ProgramRun], count: int) -> Iterator[Fault]:
    """What R90 and R91 must not be: the program must stop before it moves."""
    for first, last in ((count + 1, 0), (0, count + 1), (-1, 0), (0, -1), (2, 1)):
        found = tried(run, first, last)
        if not isinstance(found, str) and not not_run(found):
            yield Fault(f"moves with R90={first} R91={last}, which choose nothing that it has", kind="part")


def tried(run: Callable[[int, int], ProgramRun], first: int, last: int) -> ProgramRun | str:
    """The run of some parts, or the sentence that refuses it."""
    try:
        return run(first, last)
    except InputError as error:
        return f"is refused: {error}"


def not_run(found: ProgramRun) -> bool:
    """Whether a program has stopped with an alarm before it moved anything."""
    return found.alarm is not None and not len(found.path.line) and not found.path.blind


def agreed(found: ProgramRun, number: int) -> Iterator[Fault]:
    """A run of a part of the program waits at M0 before it moves."""
    if not any(halt.stop and not halt.rows and not halt.blind for halt in found.path.halts):
        yield Fault(f"with R90={number} moves before it has waited at M0 for the operator", kind="M0")


def all_rows(path: MachinePath) -> np.ndarray:
    """The blocks of a path (n,11): X Y Z A B, C, seconds, spindle, tool, line, and whether it is rapid."""
    tool = np.array([hash(path.tools[k]) % 2**31 for k in path.tool], dtype=float)
    cutter = np.nan_to_num(path.cutter)
    return np.column_stack([path.axes, cutter, path.seconds, path.rpm, tool, path.line, path.rapid])


def same_part(alone: np.ndarray, own: np.ndarray, whole: np.ndarray, cuts: np.ndarray) -> bool:
    """Whether rows ``alone`` of :func:`all_rows` are a part of ``whole``, the feed rows of which are ``own``, ``cuts``.

    From its first cut to its last one it is; on the way there and away from there it may be higher. The spindle turns
    as fast where the cutter is drawn out.
    """
    if len(own) != len(cuts):
        return False
    before, first, last = int(own[0]), int(cuts[0]), int(cuts[-1])
    if not same(alone[before : own[-1] + 1], whole[first : last + 1]) or before > first:
        return False
    there = whole[first - before : first]
    away = whole[last + 1] if last + 1 < len(whole) else whole[last]
    after = alone[own[-1] + 1 :]
    return _above(alone[:before], there) and _above(after, away[None]) and bool((after[:1, 7] == away[7]).all())


def _above(rows: np.ndarray, others: np.ndarray) -> bool:
    """Whether rows stand where others do, or above them."""
    off = rows[:, :5] - others[:, :5]
    off[:, 3] -= 2 * np.pi * np.round(off[:, 3] / (2 * np.pi))
    off[:, 2] = np.minimum(off[:, 2], 0.0)
    return bool((np.abs(off) < _SAME).all())


def same(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether rows of :func:`all_rows` are the same, A and C by whole turns."""
    if one.shape != other.shape:
        return False
    off = one - other
    turns = off[:, 3:6:2]
    off[:, 3:6:2] = turns - 2 * np.pi * np.round(turns / (2 * np.pi))
    return bool((np.abs(off) < _SAME).all())

"""Whether R90 and R91 choose the points or sections of a probing program that they name, and the file goes on.

The same for cutting programs is :mod:`gearmath.machine.judging.chosen`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from gearmath.errors import InputError
from gearmath.machine.control.executor import ProgramRun
from gearmath.machine.control.state import Probe, Setup
from gearmath.machine.judging.chosen import agreed, not_run, wrong_choices
from gearmath.machine.judging.faults import Fault
from gearmath.machine.measuring.records import touch_lines
from gearmath.machine.measuring.ways import Watched, watched
from gearmath.specs.touch_csv import HELD

_SAME = 1e-9
#: Parts that are tried one by one; of more, those at both ends and in the middle.
_ALL = 30
_OLD = "what was there\n"


@dataclass(frozen=True)
class ProgramPart:
    """One part of a program, run alone: its number, and what it does."""

    number: int
    seen: Watched

    @property
    def parameters(self) -> dict[int, float]:
        """R90 and R91 that choose it."""
        return {90: float(self.number), 91: float(self.number)}


def parts_of(text: str, name: str, probe: Probe, seen: Watched, setup: Setup) -> list[ProgramPart] | Fault:
    """The parts of a program, each run alone, or some of them where there are many; ``seen`` is the whole run.

    A fault where one is not what it is in the whole run.
    """
    touches = [seen.ways[k] for k in seen.touches]
    (file, *_) = [*seen.run.files, ""]

    def alone(number: int) -> Watched:
        both = float(number)
        return watched(text, name, probe, setup, {90: both, 91: both}, {file: _OLD})

    try:
        count = _count(alone, len(touches))
        each, done, found = len(touches) // max(count, 1), 0, []
        numbers = range(1, count + 1) if count <= _ALL else (1, 2, count // 2, count - 1, count)
        for number in numbers:
            part = ProgramPart(number, alone(number))
            own = [part.seen.ways[k] for k in part.seen.touches]
            begin = done if count <= _ALL else (number - 1) * each
            wanted = touches[begin : begin + len(own)]
            alike = len(own) == len(wanted) and all(_same(a.end, b.end) for a, b in zip(own, wanted, strict=True))
            if not own or not alike or (count > _ALL and len(own) != each):
                what = f"does not make part {number} of the run, and that alone"
                return Fault(f"with R90={number} R91={number} {what}", kind="part")
            found.append(part)
            done = begin + len(own)
    except InputError as error:
        return Fault(f"with R90 and R91 to choose one part is refused: {error}", kind="part")
    if not found or done != len(touches):
        return Fault(f"the {count} parts that R90 and R91 choose do not make the whole program", kind="part")
    return found


def part_faults(
    text: str, name: str, probe: Probe, seen: Watched, parts: list[ProgramPart], setup: Setup
) -> Iterator[Fault]:
    """What is wrong with how parts begin and with what they write."""
    (file, *_) = [*seen.run.files, ""]
    lines = [line["point"] for line in touch_lines(seen.run.files.get(file, ""))]
    for part in parts:
        number, content = part.number, part.seen.run.files.get(file, "")
        yield from agreed(part.seen.run, number)
        if content.startswith(_OLD) == (number == 1):
            what = "adds to the file of the last run" if number == 1 else "loses the touches that were made before"
            yield Fault(f"with R90={number} {what}", kind="file")
        now = [line["point"] for line in touch_lines(content.removeprefix(_OLD))]
        begin = lines.index(now[0]) if now and now[0] in lines else 0
        held = f"# {HELD}: {begin + 1} to {begin + len(now)}"
        missing = held not in content and len(now) < len(lines)  # a part that is the whole run need not say so
        if missing or now != lines[begin : begin + len(now)] or len(now) != len(part.seen.touches):
            yield Fault(f"with R90={number} does not write which touches it makes: {held[2:]}", kind="held")

    def run(first: int, last: int) -> ProgramRun:
        return watched(text, name, probe, setup, {90: float(first), 91: float(last)}).run

    yield from wrong_choices(run, parts[-1].number)


def _count(alone: Callable[[int], Watched], touches: int) -> int:
    """How many parts there are: tried one by one, or where all are alike found from the first one."""
    first = len(alone(1).touches)
    if not first:
        return 0
    alike = touches // first
    if alike > _ALL and touches % first == 0 and not_run(alone(alike + 1).run):
        return alike
    return next((number for number in range(1, touches + 1) if not_run(alone(number + 1).run)), 0)


def _same(one: np.ndarray, other: np.ndarray) -> bool:
    off = one - other
    off[3:] -= 2 * np.pi * np.round(off[3:] / (2 * np.pi))
    return bool((np.abs(off) < _SAME).all())

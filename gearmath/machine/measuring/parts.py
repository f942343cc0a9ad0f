"""Whether R90 and R91 choose the points or sections of a probing program that they name, and the file goes on.

The same for cutting programs is :mod:`gearmath.machine.judging.chosen`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from gearmath.errors import InputError
from gearmath.machine.control.executor import Run
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


def part_faults(text: str, name: str, probe: Probe, seen: Watched, setup: Setup) -> Iterator[Fault]:
    """What is wrong with parts that are run alone; ``seen`` is the whole run."""
    touches, (file, *_) = [seen.ways[k] for k in seen.touches], [*seen.run.files, ""]
    lines = touch_lines(seen.run.files.get(file, ""))

    def run(first: int, last: int) -> Run:
        return alone(first, last).run

    def alone(first: int, last: int) -> Watched:
        return watched(text, name, probe, setup, {90: float(first), 91: float(last)}, {file: _OLD})

    count, done = _count(alone, len(touches)), 0
    if not count:
        yield Fault("with R90=1 R91=1 makes no touch, or is refused", kind="part")
        return
    each = len(touches) // count
    for number in range(1, count + 1):
        if count > _ALL:
            if number not in (1, 2, count // 2, count - 1, count):
                continue
            done = (number - 1) * each
        try:
            found = alone(number, number)
        except InputError as error:
            yield Fault(f"with R90={number} R91={number} is refused: {error}", kind="part")
            return
        yield from agreed(found.run, number)
        own = [found.ways[k] for k in found.touches]
        wanted = touches[done : done + len(own)]
        alike = len(own) == len(wanted) and all(_same(a.end, b.end) for a, b in zip(own, wanted, strict=True))
        if not own or not alike or (count > _ALL and len(own) != each):
            yield Fault(
                f"with R90={number} R91={number} does not make part {number} of the run, and that alone", kind="part"
            )
            return
        content = found.run.files.get(file, "")
        if content.startswith(_OLD) == (number == 1):
            what = "adds to the file of the last run" if number == 1 else "loses the touches that were made before"
            yield Fault(f"with R90={number} {what}", kind="file")
        held = f"# {HELD}: {done + 1} to {done + len(own)}"
        now = touch_lines(content.removeprefix(_OLD))
        if held not in content or [one.get("point") for one in now] != [
            one.get("point") for one in lines[done : done + len(own)]
        ]:
            yield Fault(f"with R90={number} does not write which touches it makes: {held[2:]}", kind="held")
        done += len(own)
    if done != len(touches):
        yield Fault(f"the {count} parts that R90 and R91 choose do not make the whole program", kind="part")
    yield from wrong_choices(run, count)


def _count(alone: Callable[[int, int], Watched], touches: int) -> int:
    """How many parts there are: tried one by one, or where all are alike found from the first one."""
    try:
        first = len(alone(1, 1).touches)
        if not first:
            return 0
        alike = touches // first
        if alike > _ALL and touches % first == 0 and not_run(alone(alike + 1, alike + 1).run):
            return alike
        return next(k for k in range(1, touches + 1) if not_run(alone(k + 1, k + 1).run))
    except (InputError, StopIteration):
        return 0


def _same(one: np.ndarray, other: np.ndarray) -> bool:
    off = one - other
    off[3:] -= 2 * np.pi * np.round(off[3:] / (2 * np.pi))
    return bool((np.abs(off) < _SAME).all())

"""Probing programs for LinuxCNC: the touches of the other dialect in the same order, one after the other without loops.

Every point is complete in itself, so that a run can begin at any of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from gearmath.machine.planning.clear_space import Room
from gearmath.machine.planning.pattern import Targets, TouchPattern
from gearmath.machine.planning.setup_facts import NOT_ON_METAL
from gearmath.machine.planning.targets import APPROACH_FEED, MEASURING_FEED
from gearmath.machine.writing.linuxcnc.dialect import message
from gearmath.machine.writing.linuxcnc.probe_words import LinuxCncBlocks
from gearmath.machine.writing.point_loop import over_the_work
from gearmath.machine.writing.probe_words import ProbingPlan
from gearmath.machine.writing.probing import TouchWriter, plan_of
from gearmath.specs.calibration import Calibration
from gearmath.specs.milling_machine import MillingMachine


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
    kind: type[LinuxCncBlocks] = LinuxCncBlocks,
) -> str:
    """The text of a probing program of a ``kind`` of blocks, sideways at the ``level``; the probe comes from home.

    Raises InputError for a name that the control refuses.
    """
    pattern = TouchPattern.of(targets, teeth, machine)
    blocks = kind(program_name, machine, calibration.length)
    return blocks.text(header, _points(blocks, pattern, name, plan_of(targets, repeat), level, room))


def touch_writer(kind: type[LinuxCncBlocks]) -> TouchWriter:
    """The writer of probing programs in blocks of LinuxCNC or of a relative."""
    return TouchWriter((f"unconfirmed: {NOT_ON_METAL}",), partial(write_touches, kind=kind))


#: Programs for LinuxCNC.
LINUXCNC = touch_writer(LinuxCncBlocks)


def _points(
    blocks: LinuxCncBlocks, pattern: TouchPattern, name: str, plan: ProbingPlan, level: float, room: Room
) -> Iterator[str]:
    yield from blocks.start(plan, room=room)
    yield from over_the_work(blocks, pattern, level)
    targets = pattern.targets()
    for k in range(len(targets)):
        flank, row, col = targets.place(k)
        place = f"{flank}, tooth {targets.tooth[k]}, row {row}, col {col}"
        blocks.place = f"point {k + 1}: "
        body = _point(blocks, targets, k, f"{name},{flank},{targets.tooth[k]},{row},{col}", plan, level)
        yield f"; point {k + 1} of {plan.parts}: {place}"
        said = message(f"point {k + 1} of {plan.parts}: {place}")
        yield from blocks.dialect.if_chosen(k + 1, k + 1, (said, blocks.dialect.modal(), *body))
    yield from blocks.end()


def _point(
    blocks: LinuxCncBlocks, targets: Targets, k: int, place: str, plan: ProbingPlan, level: float
) -> Iterator[str]:
    """One point by itself: sideways, down, its touches, and up."""
    x, y, z, a, b = blocks.axes(targets.start[k])
    before = targets.start[k] - np.array([0, 0, 0, blocks.machine.one_sided, 0])
    yield from blocks.to_point(f"{x} {y}", a, blocks.axes(before)[3], b)
    yield from blocks.guarded(z, APPROACH_FEED, level)
    end = " ".join(blocks.axes(targets.end[k])[:3])
    several = plan.each > 1
    for _ in range(plan.each):
        yield from blocks.touch(end, f"{x} {y} {z}", MEASURING_FEED, APPROACH_FEED, level, up=not several)
        yield from blocks.hand_over(place)
    if several:
        yield f"G0 {blocks.length('Z', level)}"

"""The blocks that touch a pattern of points: a table of the touches in space 0, one of the teeth, and two loops.

Every point is complete in itself, so that a run can begin at any of them: message, modal head, sideways at a height
that clears the whole member at every A, down, touch, up. That the control has the memory for the tables, and that MEAS
stops A in the middle of its way as it does X Y Z, are not confirmed by a manual at hand [unconfirmed].
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from gearmath.machine.planning.clear_space import Room
from gearmath.machine.planning.pattern import TouchPattern
from gearmath.machine.planning.targets import APPROACH_FEED, MEASURING_FEED
from gearmath.machine.writing import start
from gearmath.machine.writing.probe_words import FROM, TO, Blocks, ProbingPlan
from gearmath.specs.bevel_set import FLANKS

#: Variables: number of the point, tooth, place of the table, touch of a point; A of the point, and of the way there.
_POINT, _TOOTH, _PLACE, _TOUCH, _A, _BEFORE = "UPOINT", "UTOOTH", "UPLACE", "UTOUCH", "UANGLE", "UBEFORE"
#: Tables: start and end of a touch and its A in space 0; flank, row, column, least kind; angle of a tooth; its kind.
_WAY, _WHERE, _TURN, _KIND = "UWAY", "UWHERE", "UTURN", "UKIND"
#: A stands beside the first tooth by this part of a pitch, while the probe goes down.
_BESIDE = 0.1
#: Decimals of the angles in the tables, beyond those of any control.
_DECIMALS = 8


def point_loop(
    blocks: Blocks, pattern: TouchPattern, name: str, plan: ProbingPlan, level: float, room: Room
) -> Iterator[str]:
    """The body of the program."""
    places, teeth = len(pattern.least), len(pattern.kind)
    yield f"DEF INT {_POINT},{_TOOTH},{_PLACE},{_TOUCH},{_KIND}[{teeth}],{_WHERE}[{places},4]"
    yield f"DEF REAL {_A},{_BEFORE},{_TURN}[{teeth}],{_WAY}[{places},7]"
    yield from blocks.start(plan, room=room)
    yield from _tables(blocks, pattern)
    yield from over_the_work(blocks, pattern, level)
    *_, b = blocks.axes(pattern.places.end[0])
    yield "POINTS:"
    yield f"FOR {_TOOTH}=0 TO {teeth - 1}"
    yield f"FOR {_PLACE}=0 TO {places - 1}"
    yield f"IF {_KIND}[{_TOOTH}]>={_WHERE}[{_PLACE},3]"
    yield f"{_POINT}={_POINT}+1"
    yield f"IF ({_POINT}>={FROM}) AND ({_POINT}<={TO})"
    blocks.place = f'"point "<<{_POINT}<<": "<<'
    yield from _point(blocks, name, plan, level, b)
    yield "ENDIF"
    yield "ENDIF"
    yield "ENDFOR"
    yield "ENDFOR"
    yield from blocks.end()


def over_the_work(blocks: Blocks, pattern: TouchPattern, level: float) -> Iterator[str]:
    """From home down to the height of sideways motion: over the end of the first touch of space 0.

    Not over its start, for the way to the first point must not be none; and with A beside that of every tooth: a run
    may begin at the tooth opposite, where half a turn would leave open which way A goes.
    """
    beside = _BESIDE * 2.0 * math.pi / (len(pattern.kind) - 1)
    there = pattern.places.end[0] + (pattern.turn[0] + beside) * np.array([0, 0, 0, 1, 0])
    x, y, _, a, b = blocks.axes(there)
    yield f"G0 {x} {y} {a} {b}"
    yield from blocks.lowered(blocks.length("Z", level))


def _tables(blocks: Blocks, pattern: TouchPattern) -> Iterator[str]:
    mm, _ = blocks.machine.control.decimals
    places = pattern.places
    first, last = blocks.positions.printed(places.start), blocks.positions.printed(places.end)
    # a touch is a way in Z too: a level one would look like sideways motion
    last[:, 2] -= np.where(first[:, 2] == last[:, 2], 10.0**-mm, 0.0)
    angle = np.degrees(places.start[:, 3]) % 360.0 if blocks.positions.modulo else np.degrees(places.start[:, 3])
    yield f"; {_WAY}: X Y Z where a touch starts and ends, and A, all in space 0"
    yield f"; {_WHERE}: flank (0 {FLANKS[0]}, 1 {FLANKS[1]}), row, col, and from which {_KIND} of tooth on"
    for k in range(len(places)):
        values = [f"{value:.{mm}f}" for value in (*first[k, :3], *last[k, :3] + 0.0)]
        values.append(f"{angle[k] + 0.0:.{_DECIMALS}f}")
        flank, row, col = places.place(k)
        where = (FLANKS.index(flank), row, col, pattern.least[k])
        words = [f"{_WAY}[{k},{j}]={value}" for j, value in enumerate(values)]
        yield " ".join(words)
        yield " ".join(f"{_WHERE}[{k},{j}]={value}" for j, value in enumerate(where))
    yield f"; {_TURN}: what A has more on a tooth than in space 0; {_KIND}: how much of the table is touched there"
    for tooth, (turn, kind) in enumerate(zip(np.degrees(pattern.turn), pattern.kind, strict=True)):
        yield f"{_TURN}[{tooth}]={turn:.{_DECIMALS}f} {_KIND}[{tooth}]={kind}"


def _point(blocks: Blocks, name: str, plan: ProbingPlan, level: float, b: str) -> Iterator[str]:
    """One point by itself."""
    row, col = (f"{_WHERE}[{_PLACE},{k}]" for k in (1, 2))
    yield f"IF {_WHERE}[{_PLACE},0]==0"
    for flank, close in zip(FLANKS, ("ELSE", "ENDIF"), strict=True):
        said = f'"point "<<{_POINT}<<" of {plan.parts}: {flank}, tooth "<<{_TOOTH}<<", row "<<{row}<<", col "<<{col}'
        yield f"MSG({said})"
        yield close
    yield start.modal(blocks.machine)
    yield from _angle(blocks)
    x, y, z, x_end, y_end, z_end = (f"{axis}={_WAY}[{_PLACE},{k}]" for k, axis in enumerate("XYZXYZ"))
    yield from blocks.to_point(f"{x} {y}", _to(blocks, _A), _to(blocks, _BEFORE), b)
    yield from blocks.guarded(z, APPROACH_FEED, level)
    several = plan.each > 1
    if several:
        yield f"FOR {_TOUCH}=1 TO {plan.each}"
    yield from blocks.touch(
        f"{x_end} {y_end} {z_end}", f"{x} {y} {z}", MEASURING_FEED, APPROACH_FEED, level, up=not several
    )
    yield "R101=R101+1"
    yield f"IF {_WHERE}[{_PLACE},0]==0"
    for flank, close in zip(FLANKS, ("ELSE", "ENDIF"), strict=True):
        yield from blocks.record(f'{name},{flank},"<<{_TOOTH}<<","<<{row}<<","<<{col}<<"')
        yield close
    yield from blocks.wait()
    if several:
        yield "ENDFOR"
        yield f"G0 {blocks.length('Z', level)}"


def _angle(blocks: Blocks) -> Iterator[str]:
    """A of a point: two angles added, rounded once to the increments of the control, less than a turn if modulo."""
    per_degree = blocks.machine.control.increments_per_degree
    yield f"{_A}={_WAY}[{_PLACE},6]+{_TURN}[{_TOOTH}]"
    yield f"{_BEFORE}=TRUNC({_A})"
    yield f"{_A}={_BEFORE}+ROUND(({_A}-{_BEFORE})*{per_degree})/{per_degree}"
    if blocks.positions.modulo:
        yield f"IF {_A}>=360"
        yield f"{_A}={_A}-360"
        yield "ENDIF"
    if blocks.machine.one_sided:
        yield f"{_BEFORE}={_A}-{math.degrees(blocks.machine.one_sided):.3f}"
        if blocks.positions.modulo:
            yield f"IF {_BEFORE}<0"
            yield f"{_BEFORE}={_BEFORE}+360"
            yield "ENDIF"


def _to(blocks: Blocks, variable: str) -> str:
    return f"A=DC({variable})" if blocks.positions.modulo else f"A={variable}"

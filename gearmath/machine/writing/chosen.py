"""R90 and R91: which parts of a program are run, the first and the last, so that an aborted one can be continued."""

from __future__ import annotations

from collections.abc import Iterator

from gearmath.machine.writing import start

#: R parameters that say which sections or points of a program are run, from 1; 0 for all.
FIRST, LAST = "R90", "R91"
#: Alarm for parts that the program does not have.
NO_SUCH_PART = 65016


def asked(count: int, part: str) -> Iterator[str]:
    """Stops for parts that there are not; waits for the operator where not all of the ``count`` are to be run."""
    wrong = (
        f"({FIRST}<0)",
        f"({LAST}<0)",
        f"({FIRST}>{count})",
        f"({LAST}>{count})",
        f"(({LAST}>0) AND ({FIRST}>{LAST}))",
    )
    yield f"IF {' OR '.join(wrong)}"
    yield from start.stop(f"{FIRST} and {LAST}: first and last {part} must be 1 to {count}, or 0", NO_SUCH_PART)
    yield f"IF ({FIRST}>0) OR ({LAST}>0)"
    yield f'MSG("only {part}s "<<{FIRST}<<" to "<<{LAST}<<" of {count} (0: open): NC start goes on")'
    yield "M0"
    yield "ENDIF"


def if_chosen(first: int, last: int) -> str:
    """The condition that one of the parts from ``first`` to ``last`` is to be run."""
    return f"IF ({FIRST}<={last}) AND (({LAST}==0) OR ({LAST}>={first}))"

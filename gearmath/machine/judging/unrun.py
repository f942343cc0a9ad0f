"""What a cutting program may do beside what it was judged for: blocks that this run does not reach, and blocks with /.

A program chooses its parts by R90 and R91, and stops where the control is not set up right: what such branches hold
is not run where all goes well, and so it must not move, turn or set anything. Blocks with / are run here and left out
where block skip is on at the control.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from gearmath.machine.control.executor import MachinePath, parsed
from gearmath.machine.control.linuxcnc_lines import lines_of
from gearmath.machine.control.text import is_for_linuxcnc
from gearmath.machine.control.tree import Block, Branch, Command, Loop, Statement
from gearmath.machine.judging.faults import Fault

_SKIP = re.compile(r"[ \t]*/")
_SAYING = frozenset(("MSG", "SETAL", "STOPRE"))
#: What a block may do that is not run, and one that is left out at times, where the program stops and elsewhere.
_ENDS = {"program stop", "program end"}
_STOPPING, _WAITING, _NOTHING = {"N", *_ENDS}, {"N", "program stop"}, {"N"}
_LINUXCNC_STOPS = frozenset(("", "M0", "M2", "M30"))


def unrun_faults(text: str, name: str, path: MachinePath) -> Iterator[Fault]:
    """Blocks that act, and are not run where all of a program is; ``path`` is that of such a run."""
    for line in _unrun(text, name, path.ran):
        yield Fault(
            "is not run where all parts are and the control is set up right: it is not judged, and must only stop "
            "the program or say something",
            line,
            "unrun",
        )


def _unrun(text: str, name: str, ran: frozenset[int]) -> Iterator[int]:
    """Lines that act and are not among those that ``ran``."""
    if is_for_linuxcnc(text):
        for line in lines_of(text, name):
            if line.number not in ran and not line.flow and line.code not in _LINUXCNC_STOPS:
                yield line.number
        return
    for part, _ in _flat(parsed(text, name).body, False):
        if part.line not in ran and not _only(part, _STOPPING):
            yield part.line


def skipped_faults(text: str, name: str) -> Iterator[Fault]:
    """Blocks with / that do more than to wait or to say something: one program with block skip, another without."""
    lines = {number for number, line in enumerate(text.split("\n"), 1) if _SKIP.match(line)}
    if not lines or is_for_linuxcnc(text):  # the reader takes none of LinuxCNC
        return
    for part, inside in _flat(parsed(text, name).body, False):
        if part.line in lines and not _only(part, _NOTHING if inside else _WAITING):
            yield Fault("is left out where block skip is on at the control: take out its /", part.line, "skip")


def _flat(body: Iterable[Statement], inside: bool) -> Iterator[tuple[Statement, bool]]:
    """All statements that are no branches or loops, and whether they are inside of a branch that stops the program."""
    for part in body:
        if isinstance(part, Branch):
            for some in (part.then, part.otherwise):
                stops = any(isinstance(one, Block) and _ENDS & set(one.words) for one in some)
                yield from _flat(some, inside or stops)
        elif isinstance(part, Loop):
            yield from _flat(part.body, inside)
        else:
            yield part, inside


def _only(part: Statement, words: set[str]) -> bool:
    """Whether a statement does nothing but what ``words`` do, or says something."""
    if isinstance(part, Command):
        return part.name in _SAYING and (part.name != "SETAL" or words >= _ENDS)
    if not isinstance(part, Block) or part.assignments:
        return False
    return set(part.words) <= words | ({"dwell", "F"} if "dwell" in part.words else set())

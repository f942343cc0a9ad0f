"""Whether what a program does depends on what lies outside of it, so that one run of it says nothing of the next.

A program may look at the control and stop where it is not set up right; R90 and R91 say which of its parts are run; one
that probes may wait for a host, and take from its probe where it stands. Whatever else it takes from outside, in a
condition or in a word that acts, is judged here for one state only, and so it is a fault.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from gearmath.machine.control.expression import Constant, NcVariable, Node, Operation
from gearmath.machine.control.tree import Block, Branch, Command, Definition, Loop, ParsedProgram, Statement
from gearmath.machine.judging.faults import Fault

#: What the probe says of the motion that the program has made itself, and what WRITE and DELETE make of their files.
_OWN = frozenset(("$AC_MEA", "$AA_MM", "$AA_MW"))
#: R parameters that choose parts of a program, and those by which a run is counted and a host answers.
CHOOSING = frozenset((90, 91))
COUNTING = frozenset((101, 102, 103, 104))
_PROBE = "$A_PROBE"


def outside_faults(program: ParsedProgram) -> Iterator[Fault]:
    """Conditions and words that depend on what is not in the program."""
    watch = _Watch()
    while True:  # a loop may hand a variable back to its begin
        known = len(watch.outside)
        found = list(watch.faults(program.body))
        if len(watch.outside) == known:
            break
    yield from found


class _Watch:
    """The variables that hold something from outside."""

    def __init__(self) -> None:
        self.outside: dict[str, str] = {}

    def faults(self, body: Iterable[Statement]) -> Iterator[Fault]:
        for part in body:
            if isinstance(part, Block):
                yield from self._block(part)
            elif isinstance(part, Branch):
                yield from self._branch(part)
            elif isinstance(part, Loop):
                yield from self._loop(part)
            elif isinstance(part, Definition):
                for name, _, value in part.variables:
                    self._keep(name, value)
            elif part.name not in ("MSG", "WRITE", "DELETE"):
                yield from self._acts(part, (*part.arguments, *(node for _, node in part.words)))

    def _block(self, block: Block) -> Iterator[Fault]:
        for target, value in block.assignments:
            self._keep(_name(target), value)
        yield from self._acts(block, [word.value for word in block.words.values()])

    def _acts(self, part: Block | Command, nodes: Iterable[Node]) -> Iterator[Fault]:
        for name in self._from_outside(nodes):
            yield Fault(f"takes a value from {name}, which is not known here", part.line, "outside")

    def _branch(self, part: Branch) -> Iterator[Fault]:
        names = list(self._from_outside([part.condition]))
        chooses = names and all(name in {f"R{number}" for number in CHOOSING} for name in names)
        if names and not chooses and not _stops(part) and not (set(names) <= {"R104"} and _waits(part.then)):
            yield Fault(f"goes on in one way or another by {names[0]}, which is not known here", part.line, "outside")
        yield from self.faults(part.then)
        yield from self.faults(part.otherwise)

    def _loop(self, part: Loop) -> Iterator[Fault]:
        given = [node for node in (part.condition, part.first, part.last) if node is not None]
        names = list(self._from_outside(given))
        if names and not (set(names) <= {"R101", "R103"} and _waits(part.body)):
            yield Fault(f"repeats by {names[0]}, which is not known here", part.line, "outside")
        yield from self.faults(part.body)

    def _keep(self, name: str, value: Node) -> None:
        """A variable that was given something from outside holds it for good; but what counts runs counts."""
        if name not in self.outside and name not in {f"R{number}" for number in COUNTING | CHOOSING}:
            for source in self._from_outside([value]):
                self.outside[name] = source

    def _from_outside(self, nodes: Iterable[Node]) -> Iterator[str]:
        for node in nodes:
            if isinstance(node, Operation):
                yield from self._from_outside(node.operands)
            elif isinstance(node, NcVariable):
                yield from self._from_outside(node.index)
                name = _name(node)
                if name in self.outside:
                    yield self.outside[name]
                elif name.startswith("$") and name not in _OWN:
                    yield name + (f"[{node.axis}]" if node.axis else "")
                elif node.name == "R" and name[1:].isdecimal() and int(name[1:]) in COUNTING | CHOOSING:
                    yield name


def _name(variable: NcVariable) -> str:
    """The name of a variable, of an R parameter with its number where that is a constant."""
    if variable.name == "R" and isinstance(variable.index[0], Constant):
        return f"R{int(float(variable.index[0].value))}"
    return variable.name


def _stops(part: Branch) -> bool:
    """Whether a branch is one that sets an alarm and ends the program, and moves nothing but Z on its way."""
    alarm = any(isinstance(one, Command) and one.name == "SETAL" for one in part.then)
    last = part.then[-1] if part.then else None
    ends = isinstance(last, Block) and "program end" in last.words
    moves = [one for one in part.then if isinstance(one, Block) and set(one.words) & set("XYABC")]
    return alarm and ends and not moves and not part.otherwise


def _waits(body: Iterable[Statement]) -> bool:
    """Whether a body does nothing but wait."""
    for part in body:
        if isinstance(part, Loop):
            if not _waits(part.body):
                return False
        elif isinstance(part, Block):
            if part.assignments or set(part.words) - {"N", "dwell", "F"}:
                return False
        elif not (isinstance(part, Command) and part.name == "STOPRE"):
            return False
    return True

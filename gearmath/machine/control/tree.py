"""What a text of NC words says, as a tree of statements: the reader makes it, the executor runs it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from gearmath.machine.control.expression import NcVariable, Node


class Word(NamedTuple):
    """A word of a block: ``text`` is the code or the tool name, ``value`` the number, ``way`` DC, IC, AC, PO ...

    ``coefficients`` are what stands behind the end point in PO.
    """

    text: str
    value: Node
    column: int
    way: str = ""
    coefficients: tuple[Node, ...] = ()


class Assignment(NamedTuple):
    """A variable of the program and its new value."""

    target: NcVariable
    value: Node


@dataclass(frozen=True)
class Block:
    """Words of one line by address (X Y Z A B F S T D N ...) or by group of codes, and what it assigns."""

    line: int
    words: dict[str, Word]
    assignments: tuple[Assignment, ...] = ()


@dataclass(frozen=True)
class Command:
    """A line with one instruction that is no motion: STOPRE, MSG(...), TRANS X.. and the like."""

    line: int
    column: int
    name: str
    arguments: tuple[Node, ...] = ()
    words: tuple[tuple[str, Node], ...] = ()


@dataclass(frozen=True)
class Definition:
    """DEF INT or DEF REAL: variables with first values and sizes."""

    line: int
    column: int
    integer: bool
    variables: tuple[tuple[str, tuple[int, ...], Node], ...]


@dataclass(frozen=True)
class Branch:
    """IF ... ELSE ... ENDIF."""

    line: int
    column: int
    condition: Node
    then: tuple[Statement, ...]
    otherwise: tuple[Statement, ...]


@dataclass(frozen=True)
class Loop:
    """WHILE, or FOR with its counter and both ends."""

    line: int
    column: int
    condition: Node | None
    body: tuple[Statement, ...]
    counter: NcVariable | None = None
    first: Node | None = None
    last: Node | None = None


Statement = Block | Command | Definition | Branch | Loop


@dataclass(frozen=True)
class ParsedProgram:
    """The statements of a text, and its comments by line; ``lines`` is the number of its lines."""

    name: str
    body: tuple[Statement, ...]
    comments: dict[int, str]
    lines: int

"""Lines that open, divide and close a structure, made into statements with their bodies."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from gearmath.machine.control.expression import refuse
from gearmath.machine.control.tree import Branch, Loop, Statement

_DEEPEST = 8


class Keyword(NamedTuple):
    """A line that opens, divides or closes a structure."""

    name: str
    line: int
    column: int
    parts: tuple


def structured(parts: Iterator[Statement | Keyword], name: str, lines: int) -> list[Statement]:
    """Statements with their bodies, out of a flat row of lines."""
    open_: list[tuple[Keyword, list[Statement]]] = []
    body: list[Statement] = []
    for part in parts:
        if not isinstance(part, Keyword):
            body.append(part)
        elif part.name in ("IF", "WHILE", "FOR"):
            if len(open_) == _DEEPEST:
                refuse(name, part.line, part.column, f"{part.name} is nested more than {_DEEPEST} deep")
            open_.append((part, body))
            body = []
        else:
            body = _closed(part, open_, body, name)
    if open_:
        keyword = open_[-1][0]
        refuse(name, lines, 1, f"the text ends within the {keyword.name} of line {keyword.line}")
    return body


def _closed(
    part: Keyword, open_: list[tuple[Keyword, list[Statement]]], body: list[Statement], name: str
) -> list[Statement]:
    """What goes on after ELSE or an END...: the new body."""
    opened = {"ELSE": "IF", "ENDIF": "IF", "ENDWHILE": "WHILE", "ENDFOR": "FOR"}[part.name]
    if not open_ or (open_[-1][0].name not in (opened, "ELSE" if part.name == "ENDIF" else opened)):
        refuse(name, part.line, part.column, f"{part.name} without its {opened}")
    keyword, outer = open_.pop()
    if part.name == "ELSE":
        # the branch so far is kept among the parts of the keyword
        open_.append((Keyword("ELSE", keyword.line, keyword.column, (*keyword.parts, tuple(body))), outer))
        return []
    outer.append(_whole(keyword, tuple(body)))
    return outer


def _whole(keyword: Keyword, body: tuple[Statement, ...]) -> Statement:
    line, column, parts = keyword.line, keyword.column, keyword.parts
    if keyword.name == "IF":
        return Branch(line, column, parts[0], body, ())
    if keyword.name == "ELSE":
        return Branch(line, column, parts[0], parts[1], body)
    if keyword.name == "WHILE":
        return Loop(line, column, parts[0], body)
    return Loop(line, column, None, body, *parts)

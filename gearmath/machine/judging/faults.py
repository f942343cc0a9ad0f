"""What a machine or an inspector finds wrong with a program, as sentences with lines of its text."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Fault:
    """One thing that a program must not do: a sentence, the line of the program, 0 for the whole of it, and its kind.

    ``what`` follows "line 7 " where there is a line.
    """

    what: str
    line: int = 0
    kind: str = ""

    def __str__(self) -> str:
        return f"line {self.line} {self.what}" if self.line else self.what


def first_of_each(found: Iterable[Fault]) -> list[Fault]:
    """The first fault of every kind; those without a kind are all kept."""
    kept: dict[tuple[str, int], Fault] = {}
    for number, one in enumerate(found):
        kept.setdefault((one.kind, 0 if one.kind else number), one)
    return list(kept.values())

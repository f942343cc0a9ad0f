"""What an argument may be: a kind answers with nothing, or with the words that say what its value must be."""

from __future__ import annotations

import math
import os
import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Integral, Real
from typing import Any, Protocol

#: So many characters of a value a message shows.
_LONGEST = 100
_GRID = re.compile(r"(\d{1,6})x(\d{1,6})", re.ASCII)


class Kind(Protocol):
    """Kinds of arguments, one for each that are checked alike."""

    def refusal(self, name: str, value: object) -> str | None:
        """The sentence that refuses the value of the argument ``name``; None where it can be."""


def stated(name: str, value: object, words: str) -> str:
    """A sentence that names the argument, its value in one line, and what it must be."""
    text = " ".join(repr(value).split())
    return f"{name} = {text if len(text) <= _LONGEST else f'{text[:_LONGEST]}...'}: {words}"


def is_truth(value: object) -> bool:
    """Whether it is True or False, NumPy's too, which no number may be."""
    return isinstance(value, bool) or type(value).__name__ in ("bool", "bool_")


class Plain:
    """A kind that tells by the value alone whether it can be."""

    words = ""

    def fits(self, value: Any) -> bool:
        raise NotImplementedError

    def refusal(self, name: str, value: object) -> str | None:
        return None if self.fits(value) else stated(name, value, self.words)


@dataclass(frozen=True)
class Whole(Plain):
    """A whole number, within limits where the work itself does not say them."""

    low: int | None = None
    high: int | None = None

    @property
    def words(self) -> str:  # type: ignore[override]
        if self.low is None:
            return "must be a whole number"
        if self.high is None:
            return f"must be a whole number, at least {self.low}"
        return f"must be a whole number from {self.low} to {self.high}"

    def fits(self, value: Any) -> bool:
        if not isinstance(value, Integral) or is_truth(value):
            return False
        value = int(value)
        return (self.low is None or self.low <= value) and (self.high is None or value <= self.high)


@dataclass(frozen=True)
class Number(Plain):
    """A number, within limits where the work itself does not say them; that says of nan, too, what is not ``finite``.

    A limit is none of its values where it must be ``above`` or ``below`` it.
    """

    low: float = -math.inf
    high: float = math.inf
    unit: str = ""
    above: bool = False
    below: bool = False
    finite: bool = True

    @property
    def words(self) -> str:  # type: ignore[override]
        if self.low == -math.inf:
            return f"must be a {'finite ' * self.finite}number" + (f" of {self.unit}" if self.unit else "")
        least = f"be {'greater than' if self.above else 'at least'} {self.low:g}"
        most = f"{'less than' if self.below else 'at most'} {self.high:g}"
        said = f"{least} and {most}" if self.above or self.below else f"lie between {self.low:g} and {self.high:g}"
        return f"must {least if self.high == math.inf else said} {self.unit}".rstrip()

    def fits(self, value: Any) -> bool:
        if not isinstance(value, Real) or is_truth(value):
            return False
        try:
            value = float(value)
        except OverflowError:  # a whole number of hundreds of digits
            return False
        if not math.isfinite(value):
            return not self.finite
        if (self.above and value == self.low) or (self.below and value == self.high):
            return False
        return self.low <= value <= self.high


@dataclass(frozen=True)
class OneOf(Plain):
    """One of a few words or numbers."""

    choices: tuple[str | int, ...]
    said: str = ""

    @property
    def words(self) -> str:  # type: ignore[override]
        *rest, last = map(repr, self.choices)
        return self.said or f"must be {', '.join(rest)} or {last}"

    def fits(self, value: Any) -> bool:
        return any(type(value) is type(one) and value == one for one in self.choices)


class Truth(Plain):
    """True or False, no word and no number for it."""

    words = "must be True or False"

    def fits(self, value: Any) -> bool:
        return is_truth(value)


@dataclass(frozen=True)
class Text(Plain):
    """Text in one line that is not empty."""

    words: str = "must be text that is not empty"

    def fits(self, value: Any) -> bool:
        return isinstance(value, str) and bool(value.strip()) and value.isprintable()


@dataclass(frozen=True)
class Content(Plain):
    """A whole text, which may be empty."""

    words: str = "must be text"

    def fits(self, value: Any) -> bool:
        return isinstance(value, str)


@dataclass(frozen=True)
class Place(Plain):
    """The path of a file or folder."""

    words: str = "must be the path of a file"

    def fits(self, value: Any) -> bool:
        return isinstance(value, str | os.PathLike) and os.fspath(value) != "" and "\0" not in str(value)

    def refusal(self, name: str, value: object) -> str | None:
        return (
            stated(name, value, "a file must be named, its name is empty")
            if isinstance(value, str) and value == ""
            else super().refusal(name, value)
        )


@dataclass(frozen=True)
class Grid(Plain):
    """Rows and columns of points, (5, 9) or, as the command line has it, "5x9"; so many points at most."""

    most: int

    @property
    def words(self) -> str:  # type: ignore[override]
        return f"must be rows and columns like (5, 9) or '5x9', at most {self.most} points"

    def fits(self, value: Any) -> bool:
        if isinstance(value, str):
            match = _GRID.fullmatch(value)
            value = tuple(map(int, match.groups())) if match else ()
        if not isinstance(value, tuple | list) or len(value) != 2 or not all(map(Whole(1).fits, value)):
            return False
        return int(value[0]) * int(value[1]) <= self.most


def grid_of(size: Sequence[int] | str) -> tuple[int, int]:
    """Rows and columns of a grid that fits."""
    rows, columns = size.split("x") if isinstance(size, str) else size
    return int(rows), int(columns)


@dataclass(frozen=True)
class Called(Plain):
    """What is called, as work goes on."""

    words: str = "must be a function, which is called as the work goes on"

    def fits(self, value: Any) -> bool:
        return callable(value)


@dataclass(frozen=True)
class Record(Plain):
    """An object of a class, which is loaded for no check: where its module is not loaded, nothing can be of it."""

    home: str
    name: str
    said: str

    @property
    def words(self) -> str:  # type: ignore[override]
        return f"must be {self.said}"

    def fits(self, value: Any) -> bool:
        module = sys.modules.get(self.home)
        return module is not None and isinstance(value, getattr(module, self.name, ()))


@dataclass(frozen=True)
class Having(Plain):
    """Whatever has a method of this name."""

    method: str
    words: str

    def fits(self, value: Any) -> bool:
        return callable(getattr(value, self.method, None))


class Anything(Plain):
    """What only its use can judge."""

    def fits(self, value: Any) -> bool:
        return True

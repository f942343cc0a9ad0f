"""Numbers, parameters and expressions of RS-274 as LinuxCNC has them, computed where they are read."""

from __future__ import annotations

import math
import re
from collections.abc import Callable

from gearmath.machine.control.expression import refuse

_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)")
_NAME = re.compile(r"#<([^>]*)>")
_OPERATOR = re.compile(r"\*\*|AND|XOR|MOD|OR|EQ|NE|GE|GT|LE|LT|[*/+-]")
_FUNCTION = re.compile(r"(ABS|ROUND|FIX|FUP|SQRT|SIN|COS|TAN|ASIN|ACOS|EXISTS)\[")
#: How tightly operators bind.
_LEVEL = {"**": 5, "*": 4, "/": 4, "MOD": 4, "+": 3, "-": 3} | dict.fromkeys(("EQ", "NE", "GE", "GT", "LE", "LT"), 2)
_FUNCTIONS: dict[str, Callable[[float], float]] = {
    "ABS": abs,
    "ROUND": lambda value: math.floor(value + 0.5) if value >= 0 else math.ceil(value - 0.5),
    "FIX": math.floor,
    "FUP": math.ceil,
    "SQRT": math.sqrt,
    "SIN": lambda value: math.sin(math.radians(value)),
    "COS": lambda value: math.cos(math.radians(value)),
    "TAN": lambda value: math.tan(math.radians(value)),
    "ASIN": lambda value: math.degrees(math.asin(value)),
    "ACOS": lambda value: math.degrees(math.acos(value)),
}
#: Deeper brackets are refused.
_DEEPEST = 50

Numbered = Callable[[int], float]
Named = Callable[[str], float | None]


class Cursor:
    """One line without its blanks, in capitals, and how far it has been read."""

    def __init__(self, text: str, name: str, line: int, numbered: Numbered, named: Named) -> None:
        self.text, self.name, self.line, self.at = text, name, line, 0
        self._numbered, self._named = numbered, named
        self._depth = 0

    @property
    def ended(self) -> bool:
        return self.at >= len(self.text)

    def match(self, pattern: re.Pattern[str]) -> re.Match[str] | None:
        found = pattern.match(self.text, self.at)
        if found is not None:
            self.at = found.end()
        return found

    def refuse(self, what: str) -> None:
        """Raises InputError with the place that has been reached; columns do not count blanks."""
        refuse(self.name, self.line, self.at + 1, what)

    def value(self) -> float:
        """A number, a parameter, a function, or an expression in brackets."""
        if (found := self.match(_NUMBER)) is not None:
            return float(found[0])
        if (found := self.match(_FUNCTION)) is not None:
            return self._function(found[1])
        if self.text.startswith("#", self.at):
            return self._parameter()
        if self.text.startswith("[", self.at):
            self.at += 1
            return self._rest()
        self.refuse(f"{self.text[self.at : self.at + 10]!r}: a number is expected")
        raise AssertionError

    def _rest(self) -> float:
        """An expression whose bracket is open, and the bracket that closes it."""
        self._depth += 1
        if self._depth > _DEEPEST:
            self.refuse(f"brackets are more than {_DEEPEST} deep")
        value = self._expression(0)
        if not self.text.startswith("]", self.at):
            self.refuse("] is missing")
        self.at += 1
        self._depth -= 1
        return value

    def _expression(self, level: int) -> float:
        value = self.value()
        while (found := _OPERATOR.match(self.text, self.at)) is not None and _LEVEL.get(found[0], 1) > level:
            self.at = found.end()
            value = self._operated(found[0], value, self._expression(_LEVEL.get(found[0], 1)))
        return value

    def _operated(self, operator: str, one: float, other: float) -> float:
        if operator in ("/", "MOD") and other == 0.0:
            self.refuse("division by zero")
        values: dict[str, Callable[[], float]] = {
            "**": lambda: one**other,
            "*": lambda: one * other,
            "/": lambda: one / other,
            "MOD": lambda: one % abs(other),
            "+": lambda: one + other,
            "-": lambda: one - other,
            "AND": lambda: float(bool(one) and bool(other)),
            "OR": lambda: float(bool(one) or bool(other)),
            "XOR": lambda: float(bool(one) != bool(other)),
            "EQ": lambda: float(one == other),
            "NE": lambda: float(one != other),
            "GE": lambda: float(one >= other),
            "GT": lambda: float(one > other),
            "LE": lambda: float(one <= other),
            "LT": lambda: float(one < other),
        }
        return values[operator]()

    def _function(self, name: str) -> float:
        if name == "EXISTS":
            found = self.match(_NAME)
            if found is None or not self.text.startswith("]", self.at):
                self.refuse("EXISTS needs the name of a parameter")
                raise AssertionError
            self.at += 1
            return float(self._named(found[1]) is not None)
        value = self._rest()
        try:
            return float(_FUNCTIONS[name](value))
        except ValueError:
            self.refuse(f"{name} of {value:g} has no value")
            raise AssertionError from None

    def _parameter(self) -> float:
        if (found := self.match(_NAME)) is not None:
            value = self._named(found[1])
            if value is None:
                self.refuse(f"the parameter {found[0]} has no value")
                raise AssertionError
            return value
        return self._numbered(self.index())

    def index(self) -> int:
        """The number of a parameter, behind its #."""
        self.at += 1
        number = self.value()
        if number != int(number) or not 1 <= number <= 5602:
            self.refuse(f"there is no parameter #{number:g}")
        return int(number)

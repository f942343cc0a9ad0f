"""Arithmetic of NC programs: one line of text, scanned into expressions.

Operators bind as on the control: NOT; * / DIV MOD; + -; AND; XOR; OR; << (joins strings); comparisons last. So
``R1==1 AND R2==2`` does not mean what it seems to, and is refused: AND takes truth values, in parentheses.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import NoReturn

from gearmath.errors import InputError

Value = float | str | bool

# Nine digits before the point and twelve behind it: no number is too large for a double.
NUMBER = r"[0-9]{1,9}(?:\.[0-9]{1,12})?(?![0-9A-Za-z_.])"
_NUMBER = re.compile(NUMBER)
_NAME = re.compile(r"\$?[A-Z_][A-Z0-9_]{0,30}(?![A-Za-z0-9_.])")
_TEXT = re.compile(r'"([ !#-~]*)"')
_LEVELS = (
    ("==", "<>", "<=", ">=", "<", ">"), ("<<",), ("OR",), ("XOR",), ("AND",), ("+", "-"), ("*", "/", "DIV", "MOD"),
)  # fmt: skip
_DEEPEST = 20
FUNCTIONS: dict[str, tuple[int, Callable[..., float]]] = {
    "SIN": (1, lambda x: math.sin(math.radians(x))),
    "COS": (1, lambda x: math.cos(math.radians(x))),
    "TAN": (1, lambda x: math.tan(math.radians(x))),
    "ASIN": (1, lambda x: math.degrees(math.asin(x))),
    "ACOS": (1, lambda x: math.degrees(math.acos(x))),
    "ATAN2": (2, lambda y, x: math.degrees(math.atan2(y, x))),
    "SQRT": (1, math.sqrt),
    "ABS": (1, abs),
    "ROUND": (1, lambda x: math.floor(x + 0.5)),
    "TRUNC": (1, math.trunc),
}
#: System variables, and what stands in their brackets, where they have any.
SYSTEM = {
    "$AA_MM": "axis", "$AA_MW": "axis", "$AC_MEA": "1", "$A_PROBE": "1", "$AA_IM": "axis", "$P_ACTFRAME": "axis,part",
    "$P_TOOLL": "1", "$P_TOOLNO": "", "$TC_TP2": "$P_TOOLNO", "$MN_SCALING_SYSTEM_IS_METRIC": "",
    "$MN_INT_INCR_PER_MM": "", "$MN_INT_INCR_PER_DEG": "",
}  # fmt: skip
AXES = "XYZAB"
_INSIDE = {"axis": re.compile(rf"[{AXES}]"), "axis,part": re.compile(rf"[{AXES}],TR|[XYZ],(?:RT|MI|SC)")}
#: The cutter's spindle, once SPOS has made an axis of it.
CUTTER_AXIS = "C"


def refuse(name: str, line: int, column: int, what: str) -> NoReturn:
    """Say where the text is wrong."""
    raise InputError(f"{name}, line {line}, column {column}: {what}")


@dataclass(frozen=True)
class Constant:
    """A number or a text."""

    value: Value


@dataclass(frozen=True)
class Variable:
    """``R`` with an index, a variable of the program with its indices, or a system variable of an axis."""

    name: str
    index: tuple[Node, ...]
    column: int
    axis: str = ""


@dataclass(frozen=True)
class Operation:
    """An operator or a function, applied to its operands."""

    name: str
    operands: tuple[Node, ...]
    column: int


Node = Constant | Variable | Operation


class Scanner:
    """One line of a program without its comment, read from left to right."""

    def __init__(self, name: str, line: int, text: str) -> None:
        self.name, self.line, self.text, self.at = name, line, text, 0

    def refuse(self, what: str, at: int | None = None) -> NoReturn:
        refuse(self.name, self.line, (self.at if at is None else at) + 1, what)

    def match(self, pattern: re.Pattern[str]) -> re.Match[str] | None:
        """Take what the pattern matches here."""
        found = pattern.match(self.text, self.at)
        if found is not None:
            self.at = found.end()
        return found

    def blanks(self) -> None:
        while self.at < len(self.text) and self.text[self.at] in " \t":
            self.at += 1

    @property
    def done(self) -> bool:
        self.blanks()
        return self.at >= len(self.text)

    def take(self, sign: str) -> bool:
        """Take a sign if it stands here."""
        if self.text.startswith(sign, self.at):
            self.at += len(sign)
            return True
        return False

    def need(self, sign: str) -> None:
        self.blanks()
        if not self.take(sign):
            self.refuse(f"{sign!r} is missing")

    def expression(self, depth: int = 0, level: int = 0, words: bool = False) -> Node:
        """An expression. ``words`` ends it at the first blank outside parentheses: more words of the block follow."""
        if depth > _DEEPEST:
            self.refuse(f"an expression is nested more than {_DEEPEST} deep")
        if level == len(_LEVELS):
            return self._unary(depth, words)
        left = self.expression(depth, level + 1, words)
        while True:
            start = self.at
            if not words:
                self.blanks()
            at = self.at
            sign = self._operator(level)
            if sign is None:
                self.at = start
                return left
            if not words:
                self.blanks()
            left = Operation(sign, (left, self.expression(depth + 1 if level < 1 else depth, level + 1, words)), at + 1)
            if level == 0:
                return left

    def _operator(self, level: int) -> str | None:
        for sign in _LEVELS[level]:
            if not self.text.startswith(sign, self.at):
                continue
            after = self.text[self.at + len(sign) : self.at + len(sign) + 1]
            if (sign.isalpha() and (after.isalnum() or after == "_")) or (sign == "<" and after == "<"):
                continue
            self.at += len(sign)
            return sign
        return None

    def _unary(self, depth: int, words: bool) -> Node:
        at = self.at
        if self.take("-"):
            return Operation("negative", (self._primary(depth + 1, words),), at + 1)
        if re.match(r"NOT(?![A-Za-z0-9_])", self.text[self.at :]):
            self.at += 3
            self.blanks()
            return Operation("NOT", (self._primary(depth + 1, words),), at + 1)
        return self._primary(depth, words)

    def _primary(self, depth: int, words: bool) -> Node:
        if self.take("("):
            self.blanks()
            inner = self.expression(depth + 1)
            self.need(")")
            return inner
        if (number := self.match(_NUMBER)) is not None:
            return Constant(float(number[0]))
        if (text := self.match(_TEXT)) is not None:
            return Constant(text[1])
        at = self.at
        if (name := self.match(_NAME)) is None:
            self.refuse(f"{shown(self._rest())} is no number, variable or function")
        if name[0] in FUNCTIONS:
            self.need("(")
            return self._function(name[0], depth, at)
        return self.variable(name[0], at, depth)

    def _function(self, name: str, depth: int, at: int) -> Node:
        operands = self.arguments(depth)
        count, _ = FUNCTIONS[name]
        if len(operands) != count:
            self.refuse(f"{name} takes {count} numbers, not {len(operands)}", at)
        return Operation(name, operands, at + 1)

    def arguments(self, depth: int = 0) -> tuple[Node, ...]:
        """Expressions with commas between them, up to the closing parenthesis; the opening one is read."""
        operands: list[Node] = []
        self.blanks()
        if self.take(")"):
            return ()
        while True:
            self.blanks()
            operands.append(self.expression(depth + 1))
            self.blanks()
            if self.take(")"):
                return tuple(operands)
            if not self.take(","):
                self.refuse("')' is missing")

    def variable(self, name: str, at: int, depth: int = 0) -> Variable:
        """A variable whose name is read, with what stands in its brackets."""
        if name in SYSTEM:
            return self._system(name, at)
        if name.startswith("$"):
            self.refuse(f"the system variable {shown(name)} is not understood", at)
        if re.fullmatch(r"R[0-9]{1,4}", name):
            return Variable("R", (Constant(float(name[1:])),), at + 1)
        index: list[Node] = []
        if self.take("["):
            while True:
                self.blanks()
                index.append(self.expression(depth + 1))
                self.blanks()
                if self.take("]"):
                    break
                if not self.take(",") or len(index) >= 2:
                    self.refuse("']' is missing")
        if name == "R" and len(index) != 1:
            self.refuse("R needs one number, as in R1 or R[1]", at)
        return Variable(name, tuple(index), at + 1)

    def _system(self, name: str, at: int) -> Variable:
        """A system variable whose name is read, with what stands in its brackets."""
        inside = SYSTEM[name]
        if not inside:
            return Variable(name, (), at + 1)
        self.need("[")
        found = self.match(_INSIDE.get(inside) or re.compile(re.escape(inside)))
        if found is None:
            self.refuse(f"{name} of {shown(self._rest())} is not understood")
        self.need("]")
        return Variable(name, (), at + 1, found[0] if inside in _INSIDE else "")

    def _rest(self) -> str:
        return self.text[self.at :].split(" ")[0] or "the end of the line"


def shown(token: str) -> str:
    """A token as it can stand in a sentence."""
    return repr(token) if len(token) <= 40 else f"{token[:40]!r}..."

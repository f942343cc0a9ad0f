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

from gearmath.errors import InputError, counted

Value = float | str | bool

#: A number as the control reads it; what may follow, whoever uses it must say.
NUMBER = r"(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:EX[+-]?[0-9]{1,3})?"
_NUMBER = re.compile(rf"\+?({NUMBER})(?![0-9A-Z_.])")
#: A number that is the whole expression, as most are.
_ALONE = re.compile(rf"{NUMBER}(?=[),]|$)")
_E_EXPONENT = re.compile(r"[+-]?([0-9]*\.?[0-9]*)E([+-]?[0-9]+)")
_NAME = re.compile(r"\$?[A-Z_][A-Z0-9_]*(?![A-Z0-9_.])")
_TEXT = re.compile(r'"([^"]*)"')
#: R parameters hold no larger number, and no more decimals; addresses round what they have no places for.
LARGEST = 99999999.0
DECIMALS = 8
_MOST_DECIMALS = 12
#: Characters of the name of a variable or label.
LONGEST_NAME = 31
_LEVELS = ("== <> <= >= < >", "<<", "OR", "XOR", "AND", "+ -", "* / DIV MOD")
_LEVEL = {sign: level for level, signs in enumerate(_LEVELS) for sign in signs.split()}
_OPERATOR = re.compile(r"==|<>|<=|>=|<<|[<>+*/-]|(?:OR|XOR|AND|DIV|MOD)(?![A-Z0-9_])")
_DEEPEST = 20
_NOT = re.compile(r"NOT(?![A-Z0-9_])")
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
    "$AA_MM": "axis",
    "$AA_MW": "axis",
    "$AC_MEA": "1",
    "$A_PROBE": "1",
    "$AA_IM": "axis",
    "$P_ACTFRAME": "axis,part",
    "$P_TOOLL": "1",
    "$P_TOOLNO": "",
    "$TC_TP2": "$P_TOOLNO",
    "$MN_SCALING_SYSTEM_IS_METRIC": "",
    "$MN_INT_INCR_PER_MM": "",
    "$MN_INT_INCR_PER_DEG": "",
    "$MN_LEN_PROTOCOL_FILE": "",
}
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
class NcVariable:
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


Node = Constant | NcVariable | Operation


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

    def number(self, text: str, at: int) -> float:
        """The value of what NUMBER has matched at ``at``, within the range of the control."""
        if len(text) <= DECIMALS + text.find(".") + 1 and text.find(".") <= DECIMALS and "E" not in text:
            return float(text)  # at most eight digits before the point and behind it, as most are
        mantissa, _, exponent = text.partition("EX")
        self.check_decimals(mantissa, at, _MOST_DECIMALS)
        value = float(f"{mantissa}E{exponent or 0}")
        if value > LARGEST:
            self.refuse(f"the number {shown(text)} is too large; the control takes at most {LARGEST:.0f}", at)
        return value

    def check_decimals(self, mantissa: str, at: int, most: int) -> None:
        decimals = len(mantissa.partition(".")[2])
        if decimals > most:
            self.refuse(f"the number {shown(mantissa)} has {counted(decimals, 'decimal')}; the most here is {most}", at)

    def refuse_exponent(self) -> None:
        """Refuse a number with the exponent of other languages."""
        if (found := _E_EXPONENT.match(self.text, self.at)) is not None and found[1] not in ("", "."):
            self.refuse(f"{shown(found[0])} is not understood: an exponent is written {found[1]}EX{found[2]}")

    def expression(self, depth: int = 0, level: int = 0) -> Node:
        """An expression: it goes on over blanks as long as operators follow, with which no word begins.

        Only operators that bind as tightly as ``level``, or tighter, belong to it.
        """
        if depth > _DEEPEST:
            self.refuse(f"an expression is nested more than {_DEEPEST} deep")
        if (alone := self.match(_ALONE)) is not None:
            return Constant(self.number(alone[0], alone.start()))
        left = self._unary(depth)
        while True:
            start = self.at
            self.blanks()
            sign = self.match(_OPERATOR)
            if sign is None or (binds := _LEVEL[sign[0]]) < level:
                self.at = start
                return left
            self.blanks()
            right = self.expression(depth + 1 if binds == 0 else depth, binds + 1)
            left = Operation(sign[0], (left, right), sign.start() + 1)
            if binds == 0:
                return left

    def _unary(self, depth: int) -> Node:
        at = self.at
        if self.take("-"):
            return Operation("negative", (self._primary(depth + 1),), at + 1)
        if self.match(_NOT) is not None:
            self.blanks()
            return Operation("NOT", (self._primary(depth + 1),), at + 1)
        return self._primary(depth)

    def _primary(self, depth: int) -> Node:
        if self.take("("):
            self.blanks()
            inner = self.expression(depth + 1)
            self.need(")")
            return inner
        at = self.at
        if (number := self.match(_NUMBER)) is not None:
            return Constant(self.number(number[1], at))
        if (text := self.match(_TEXT)) is not None:
            return Constant(text[1])
        if (name := self.match(_NAME)) is None:
            self.refuse_exponent()
            self.refuse(f"{shown(self._rest())} is no number, variable or function")
        if name[0] in FUNCTIONS:
            self.need("(")
            return self._function(name[0], depth, at)
        return self.variable(name[0], at, depth)

    def _function(self, name: str, depth: int, at: int) -> Node:
        operands = self.arguments(depth)
        count, _ = FUNCTIONS[name]
        if len(operands) != count:
            self.refuse(f"{name} takes {counted(count, 'number')}, not {len(operands)}", at)
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

    def variable(self, name: str, at: int, depth: int = 0) -> NcVariable:
        """A variable whose name is read, with what stands in its brackets."""
        if name in SYSTEM:
            return self._system(name, at)
        if name.startswith("$"):
            self.refuse(f"the system variable {shown(name)} is not understood", at)
        if name[0] == "R" and name[1:].isdecimal():
            return NcVariable("R", (Constant(self.number(name[1:], at)),), at + 1)
        self.check_length(name, at)
        if self.text.startswith("(", self.at):
            self.refuse(f"{name} is no function that is understood", at)
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
        return NcVariable(name, tuple(index), at + 1)

    def _system(self, name: str, at: int) -> NcVariable:
        """A system variable whose name is read, with what stands in its brackets."""
        inside = SYSTEM[name]
        if not inside:
            return NcVariable(name, (), at + 1)
        self.need("[")
        found = self.match(_INSIDE.get(inside) or re.compile(re.escape(inside)))
        if found is None:
            self.refuse(f"{name} of {shown(self._rest())} is not understood")
        self.need("]")
        return NcVariable(name, (), at + 1, found[0] if inside in _INSIDE else "")

    def check_length(self, name: str, at: int) -> None:
        if len(name) > LONGEST_NAME:
            what = f"the name {shown(name)} has {len(name)} characters; the control allows {LONGEST_NAME}"
            self.refuse(what, at)

    def _rest(self) -> str:
        return self.text[self.at :].split(" ")[0] or "the end of the line"


def shown(token: str) -> str:
    """A token as it can stand in a sentence."""
    return repr(token) if len(token) <= 40 else f"{token[:40]!r}..."

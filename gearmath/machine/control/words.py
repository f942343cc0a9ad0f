"""One block of a program read: axis words, codes, tools, and what it assigns."""

from __future__ import annotations

import re
from typing import NoReturn

from gearmath.errors import counted
from gearmath.machine.control.expression import (
    AXES,
    CUTTER_AXIS,
    DECIMALS,
    NUMBER,
    Constant,
    Node,
    Scanner,
    shown,
)
from gearmath.machine.control.polynomial import CUBIC, QUINTIC
from gearmath.machine.control.refused import instead
from gearmath.machine.control.tree import Assignment, Block, Word
from gearmath.machine.control.vocabulary import ADDRESSES, GROUP_OF_CODE, LETTERS

_CODE_HAS_NO_VALUE = Constant(0.0)
_BLANK = r"(?=[ \t]|$)"
_CODE = re.compile(rf"[GM]0{{0,2}}([0-9]{{1,3}})(?=[ \tA-Z]|$)|[A-Z]{{3,8}}{_BLANK}")
_CONSTANT = re.compile(rf"([A-Z])[ \t]*([+-]?)({NUMBER})(?=[ \tA-Z]|$)")
#: A code, a number or a DC of an axis with few digits, and a blank: what nearly every block of a path consists of.
_PLAIN = re.compile(
    rf"(?:(G[0-9]{{1,3}})|([{AXES}{CUTTER_AXIS}FSD])([+-]?)([0-9]{{1,{DECIMALS}}}(?:\.[0-9]{{0,{DECIMALS}}})?)"
    rf"|([{AXES}{CUTTER_AXIS}])=(DC|AC|IC|ACP|ACN)\(([0-9]{{1,{DECIMALS}}}(?:\.[0-9]{{0,{DECIMALS}}})?)\))"
    r"(?:[ \t]+(?=[A-Z])|[ \t]*$)"
)
_TOOL = re.compile(r'T[ \t]*=[ \t]*"([A-Za-z0-9_]{1,31})"(?=[ \tA-Z]|$)')
_ADDRESS = re.compile(rf"([{AXES}{CUTTER_AXIS}FSD]|SPOS|MEAS|ADIS|ADISPOS|CTOL|OTOL|OVR|OVRRAP|PL)[ \t]*=(?!=)[ \t]*")
_WAY = re.compile(r"(DC|IC|AC|ACP|ACN|PO)\(")
_POLYNOMIAL = re.compile(rf"PO\[([{AXES}{CUTTER_AXIS}])\][ \t]*=[ \t]*\(")
_GROUP_RADIUS = re.compile(rf"(FGREF|ACC)\[([{AXES}{CUTTER_AXIS}])\][ \t]*=[ \t]*")
#: A variable that is given a value.
TARGET = re.compile(r"R[0-9]+(?=[ \t]*=[^=])|(?:R(?=\[)|[A-Z_][A-Z0-9_]+)(?=\[|[ \t]*=[^=])")


class WordScanner(Scanner):
    """The words of one line."""

    def block(self, words: dict[str, Word]) -> Block:
        assignments: list[Assignment] = []
        while (read := self._plain()) is not None or not self.done:
            if read is None and (read := self.constant()) is None:
                if (assignment := self._assignment()) is not None:
                    assignments.append(assignment)
                    continue
                read = self.word()
            key, word = read
            if key in words:
                self.refuse(f"{word.text} is a second value for {key} in one block", word.column - 1)
            words[key] = word
        return Block(self.line, words, tuple(assignments))

    def _assignment(self) -> Assignment | None:
        at = self.at
        name = self.match(TARGET)
        if name is None or name[0] in ADDRESSES:
            self.at = at
            return None
        if (known := instead(self.text[at:])) is not None:
            self.refuse(known, at)
        target = self.variable(name[0], at)
        self.need("=")
        self.blanks()
        begin = self.at
        value = self._value()
        if target.name == "R" and isinstance(value, Constant):
            self.check_decimals(self.text[begin : self.at].partition("E")[0], begin, DECIMALS)
        return Assignment(target, value)

    def _value(self) -> Node:
        """An expression, and the blank that must follow."""
        value = self.expression()
        if not self._ends():
            self.refuse_exponent()
            self.refuse(f"{shown(self._rest())} is not understood: a blank may be missing before it")
        return value

    def _plain(self) -> tuple[str, Word] | None:
        """What :meth:`constant` and :meth:`word` make of the words that are nearly all of a program, in one look."""
        found = _PLAIN.match(self.text, self.at)
        if found is None:
            return None
        code, letter, sign, digits, axis, way, target = found.groups()
        column = found.start() + 1
        if code is not None:
            if code not in GROUP_OF_CODE:
                return None
            self.at = found.end()
            return GROUP_OF_CODE[code], Word(code, _CODE_HAS_NO_VALUE, column)
        self.at = found.end()
        if letter is not None:
            value = float(digits)
            return letter, Word(f"{letter}{sign}{digits}", Constant(-value if sign == "-" else value), column)
        return axis, Word(f"{axis}={way}({target})", Constant(float(target)), column, way)

    def constant(self) -> tuple[str, Word] | None:
        """Key and content of a letter with its number, the most frequent word; None for others."""
        at = self.at
        if (constant := self.match(_CONSTANT)) is None:
            return None
        letter, sign, digits = constant.groups()
        if letter in LETTERS:
            if self.at < len(self.text) and self.text[self.at] == "E":
                self._refuse_exponent(constant.start(2))
            value = self.number(digits, constant.start(3))
            return letter, Word(constant[0], Constant(-value if sign == "-" else value), at + 1)
        if letter == "N" and digits.isdecimal():
            self.refuse(f"the block number {constant[0]} must be the first word", at)
        self.at = at
        return None

    def word(self) -> tuple[str, Word]:
        """Key and content of one word."""
        at, column = self.at, self.at + 1
        if (code := self.match(_CODE)) is not None:
            name = f"{code[0][0]}{int(code[1])}" if code[1] else code[0]
            if name in GROUP_OF_CODE:
                return GROUP_OF_CODE[name], Word(name, _CODE_HAS_NO_VALUE, column)
        elif (tool := self.match(_TOOL)) is not None:
            return "T", Word(tool[1], _CODE_HAS_NO_VALUE, column)
        elif (polynomial := self.match(_POLYNOMIAL)) is not None:
            return polynomial[1], self._polynomial(at, CUBIC)
        elif (radius := self.match(_GROUP_RADIUS)) is not None:
            return f"{radius[1]} {radius[2]}", Word(radius[0], self._value(), column)
        elif (address := self.match(_ADDRESS)) is not None:
            return address[1], self._addressed(address[1], at)
        self.at = at
        self.refuse(instead(self.text[at:]) or f"the word {shown(self._rest())} is not understood")

    def _refuse_exponent(self, begin: int) -> NoReturn:
        """Refuse X1E5 as a wrong exponent, though it could be two words."""
        self.at = begin
        self.refuse_exponent()
        self.refuse(f"the word {shown(self._rest())} is not understood")

    def _ends(self) -> bool:
        return self.at == len(self.text) or self.text[self.at] in " \t"

    def _addressed(self, address: str, at: int) -> Word:
        way = self.match(_WAY) if address in AXES + CUTTER_AXIS else None
        if way is None:
            value = self._value()
            return Word(self.text[at : self.at], value, at + 1)
        if way[1] == "PO":
            return self._polynomial(at, QUINTIC)
        self.blanks()
        value = self.expression()
        self.need(")")
        if not self._ends():
            self.refuse(f"{shown(self._rest())} is not understood: a blank may be missing before it")
        return Word(self.text[at : self.at], value, at + 1, way[1])

    def _polynomial(self, at: int, most: int) -> Word:
        """End point and coefficients of one axis, behind the opening parenthesis."""
        values = self.arguments()
        if not 1 <= len(values) <= most + 1:
            what = f"{shown(self.text[at : self.at])} has {counted(len(values), 'value')}: it takes the end point and "
            self.refuse(f"{what}up to {most} coefficients, a2 to a{most + 1}", at)
        if not self._ends():
            self.refuse(f"{shown(self._rest())} is not understood: a blank may be missing before it")
        return Word(self.text[at : self.at], values[0], at + 1, "PO", values[1:])

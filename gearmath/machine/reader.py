"""Reads NC programs back: words, logic and comments, as a tree of statements.

It understands the dialect that this package writes and refuses everything else with line and column. It shares no code
with the writers: what both get wrong, they must get wrong twice. ``gearmath.machine.executor`` runs what is read here.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

from gearmath.machine.nc_expression import AXES, CUTTER_AXIS, NUMBER, Constant, Node, Scanner, refuse, shown
from gearmath.machine.nc_tree import Assignment, Block, Branch, Command, Definition, Loop, Program, Statement, Word

#: The codes that are understood, by group. One code of a group at a time, in a block and in force.
GROUP_OF_CODE = {
    code: group
    for group, codes in {
        "motion": "G0 G1",
        "dwell": "G4",
        "plane": "G17",
        "radius compensation": "G40",
        "work offset": "G54 G55 G56 G57",
        "frame suppression": "G53 G153 SUPA",
        "dimensioning": "G90",
        "units": "G710",
        "feed mode": "G93 G94",
        "stop mode": "G60 G64 G641 G642",
        "acceleration": "BRISK SOFT",
        "feed forward": "FFWON FFWOF",
        "compressor": "COMPCAD COMPOF",
        "transformation": "TRAFOOF",
        "diameter programming": "DIAMOF",
        "buffer": "FIFOCTRL",
        "spindle": "M3 M4 M5",
        "tool change": "M6",
        "coolant": "M8 M9",
        "program stop": "M0",
        "program end": "M30",
    }.items()
    for code in codes.split()
}
_COMMANDS = {"STOPRE", "MSG", "SETAL", "WRITE", "TRANS", "FGROUP", "SPCON", "SPCOF"}
_TYPES = ("INT", "REAL")
_BLANK = r"(?=[ \t]|$)"
_NUMBERED = re.compile(rf"N([0-9]{{1,9}}){_BLANK}")
_CODE = re.compile(rf"(?:[GM]0?[0-9]{{1,3}}|[A-Z]{{4,8}}){_BLANK}")
_CONSTANT = re.compile(rf"([A-Z])(-?{NUMBER})")
_TOOL = re.compile(rf'T="([A-Za-z0-9_]{{1,31}})"{_BLANK}')
_ADDRESS = re.compile(rf"([{AXES}{CUTTER_AXIS}FS]|SPOS|MEAS|ADIS|ADISPOS|CTOL|OTOL|OVR|OVRRAP)=")
_NOT_ASSIGNED = ("SPOS", "MEAS", "ADIS", "ADISPOS", "FGREF", "CTOL", "OTOL", "OVR", "OVRRAP", "ACC")
_LABEL = re.compile(r"[A-Z_]{2}[A-Z0-9_]{0,29}:[ \t]*$")
_WAY = re.compile(r"(DC|IC|AC|ACP|ACN)\(")
_GROUP_RADIUS = re.compile(rf"(FGREF|ACC)\[([{AXES}])\]=")
_WORD = re.compile(r"[A-Z]+(?![A-Za-z0-9_.])")
_TARGET = re.compile(r"R[0-9]{1,4}(?=[ \t]*=[^=])|(?:R(?=\[)|[A-Z_][A-Z0-9_]{1,30})(?=\[|[ \t]*=[^=])")
_DEEPEST = 8


class _Keyword(NamedTuple):
    """A line that opens, divides or closes a structure."""

    name: str
    line: int
    column: int
    parts: tuple


def read_program(text: str, name: str) -> Program:
    """The statements of a program. Raises InputError with ``name``, line and column for what is not understood."""
    comments: dict[int, str] = {}
    lines = text.split("\n")

    def parts() -> Iterator[Statement | _Keyword]:
        for number, line in enumerate(lines, start=1):
            code, comment = _without_comment(line.removesuffix("\r"))
            if comment is not None:
                comments[number] = comment
            scanner = _AtLine(name, number, code)
            if (read := scanner.statement()) is not None:
                yield read

    body = tuple(_structured(parts(), name, len(lines)))
    return Program(name, body, comments, len(lines))


def _without_comment(line: str) -> tuple[str, str | None]:
    if '"' not in line:
        code, sign, comment = line.partition(";")
        return code, comment.strip() if sign else None
    quoted = False
    for at, sign in enumerate(line):
        quoted ^= sign == '"'
        if sign == ";" and not quoted:
            return line[:at], line[at + 1 :].strip()
    return line, None


def _structured(parts: Iterator[Statement | _Keyword], name: str, lines: int) -> list[Statement]:
    """Statements with their bodies, out of a flat row of lines."""
    open_: list[tuple[_Keyword, list[Statement]]] = []
    body: list[Statement] = []
    for part in parts:
        if not isinstance(part, _Keyword):
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
    part: _Keyword, open_: list[tuple[_Keyword, list[Statement]]], body: list[Statement], name: str
) -> list[Statement]:
    """What goes on after ELSE or an END...: the new body."""
    opened = {"ELSE": "IF", "ENDIF": "IF", "ENDWHILE": "WHILE", "ENDFOR": "FOR"}[part.name]
    if not open_ or (open_[-1][0].name not in (opened, "ELSE" if part.name == "ENDIF" else opened)):
        refuse(name, part.line, part.column, f"{part.name} without its {opened}")
    keyword, outer = open_.pop()
    if part.name == "ELSE":
        # the branch so far is kept among the parts of the keyword
        open_.append((_Keyword("ELSE", keyword.line, keyword.column, (*keyword.parts, tuple(body))), outer))
        return []
    outer.append(_whole(keyword, tuple(body)))
    return outer


def _whole(keyword: _Keyword, body: tuple[Statement, ...]) -> Statement:
    line, column, parts = keyword.line, keyword.column, keyword.parts
    if keyword.name == "IF":
        return Branch(line, column, parts[0], body, ())
    if keyword.name == "ELSE":
        return Branch(line, column, parts[0], parts[1], body)
    if keyword.name == "WHILE":
        return Loop(line, column, parts[0], body)
    return Loop(line, column, None, body, *parts)


class _AtLine(Scanner):
    """One line of the program."""

    def statement(self) -> Statement | _Keyword | None:
        """What the line says; None for an empty one."""
        if self.done:
            return None
        words: dict[str, Word] = {}
        if (number := self.match(_NUMBERED)) is not None:
            words["N"] = Word(number[0], Constant(float(number[1])), number.start() + 1)
            if self.done or self.match(_LABEL) is not None:
                return Block(self.line, words)
        at = self.at
        if (found := self.match(_WORD)) is not None:
            read = self._instruction(found[0], at)
            if read is not None:
                if not self.done:
                    self.refuse(f"{shown(self._rest())} after {found[0]}: nothing else may stand in its block")
                return read
            self.at = at
        return self._block(words)

    def _instruction(self, word: str, at: int) -> Statement | _Keyword | None:
        column = at + 1
        if word in ("IF", "WHILE"):
            self.blanks()
            return _Keyword(word, self.line, column, (self.expression(),))
        if word == "FOR":
            return _Keyword(word, self.line, column, self._counting())
        if word in ("ELSE", "ENDIF", "ENDWHILE", "ENDFOR"):
            return _Keyword(word, self.line, column, ())
        if word == "DEF":
            return self._definition(column)
        if word not in _COMMANDS:
            return None
        if word == "STOPRE":
            return Command(self.line, column, word)
        if word == "TRANS":
            return Command(self.line, column, word, words=self._translation())
        self.need("(")
        if word == "FGROUP":
            return Command(self.line, column, word, words=self._axes())
        return Command(self.line, column, word, self.arguments())

    def _counting(self) -> tuple:
        self.blanks()
        at = self.at
        if (name := self.match(_TARGET)) is None:
            self.refuse("FOR needs a variable and its first value")
        counter = self.variable(name[0], at)
        self.need("=")
        self.blanks()
        first = self.expression()
        self.need("TO")
        self.blanks()
        return counter, first, self.expression()

    def _definition(self, column: int) -> Definition:
        self.blanks()
        at = self.at
        kind = self.match(_WORD)
        if kind is None or kind[0] not in _TYPES:
            self.refuse(f"DEF knows {' and '.join(_TYPES)} only", at)
        variables = []
        while True:
            self.blanks()
            at = self.at
            name = self.match(re.compile(r"[A-Z_]{2}[A-Z0-9_]{0,29}"))
            if name is None:
                self.refuse("the name of a variable is missing; it begins with two letters")
            sizes = self.variable(name[0], at).index
            if not all(isinstance(size, Constant) and size.value in range(1, 1001) for size in sizes):
                self.refuse("the size of a field must be a whole number from 1 to 1000", at)
            value: Node = Constant(0.0)
            self.blanks()
            if self.take("="):
                self.blanks()
                value = self.expression()
            variables.append((name[0], tuple(int(s.value) for s in sizes if isinstance(s, Constant)), value))
            self.blanks()
            if not self.take(","):
                return Definition(self.line, column, kind[0] == "INT", tuple(variables))

    def _translation(self) -> tuple[tuple[str, Node], ...]:
        words: dict[str, Node] = {}
        while not self.done:
            key, word = self._word()
            if key not in AXES or word.way:
                self.refuse(f"TRANS takes axes with a number, not {word.text}", word.column - 1)
            words[key] = word.value
        return tuple(words.items())

    def _axes(self) -> tuple[tuple[str, Node], ...]:
        axes = self.match(re.compile(rf"(?:[{AXES}](?:,[{AXES}])*)?\)"))
        if axes is None:
            self.refuse("FGROUP takes axes with commas between them")
        return tuple((axis, Constant(0.0)) for axis in axes[0][:-1].split(",") if axis)

    def _block(self, words: dict[str, Word]) -> Block:
        assignments: list[Assignment] = []
        while not self.done:
            at = self.at
            if (assignment := self._assignment()) is not None:
                assignments.append(assignment)
                continue
            key, word = self._word()
            if key in words:
                self.refuse(f"{word.text} is a second value for {key} in one block", at)
            if key == "N":
                self.refuse(f"the block number {word.text} must be the first word", at)
            words[key] = word
        return Block(self.line, words, tuple(assignments))

    def _assignment(self) -> Assignment | None:
        at = self.at
        name = self.match(_TARGET)
        if name is None or name[0] in _NOT_ASSIGNED:
            self.at = at
            return None
        target = self.variable(name[0], at)
        self.need("=")
        self.blanks()
        return Assignment(target, self._value())

    def _value(self) -> Node:
        """An expression without blanks outside parentheses: the next word of the block may follow."""
        value = self.expression(words=True)
        if self.at < len(self.text) and self.text[self.at] not in " \t":
            self.refuse(f"{shown(self._rest())} is not understood")
        return value

    def _word(self) -> tuple[str, Word]:
        """Key and content of one word."""
        at, column = self.at, self.at + 1
        if (constant := self.match(_CONSTANT)) is not None and self._ends():
            letter, text = constant[1], constant[0]
            if letter in f"{AXES}{CUTTER_AXIS}FSD":
                return letter, Word(text, Constant(float(constant[2])), column)
            if letter == "N" and text[1:].isdecimal():
                return "N", Word(text, Constant(float(text[1:])), column)
        self.at = at
        if (code := self.match(_CODE)) is not None:
            name = f"{code[0][0]}{int(code[0][1:])}" if code[0][1:].isdecimal() else code[0]
            if name in GROUP_OF_CODE:
                return GROUP_OF_CODE[name], Word(name, Constant(0.0), column)
        elif (tool := self.match(_TOOL)) is not None:
            return "T", Word(tool[1], Constant(0.0), column)
        elif (radius := self.match(_GROUP_RADIUS)) is not None:
            return f"{radius[1]} {radius[2]}", Word(radius[0], self._value(), column)
        elif (address := self.match(_ADDRESS)) is not None:
            return address[1], self._addressed(address[1], at)
        self.at = at
        self.refuse(f"the word {shown(self._rest())} is not understood")

    def _ends(self) -> bool:
        return self.at == len(self.text) or self.text[self.at] in " \t"

    def _addressed(self, address: str, at: int) -> Word:
        way = self.match(_WAY) if address in AXES + CUTTER_AXIS else None
        if way is None:
            value = self._value()
            return Word(self.text[at : self.at], value, at + 1)
        self.blanks()
        value = self.expression()
        self.need(")")
        if not self._ends():
            self.refuse(f"{shown(self._rest())} is not understood")
        return Word(self.text[at : self.at], value, at + 1, way[1])

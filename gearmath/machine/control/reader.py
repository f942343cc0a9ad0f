"""Reads NC programs back: words, logic and comments, as a tree of statements.

It understands the dialect that this package writes and refuses everything else with line and column. It shares no code
with the writers: what both get wrong, they must get wrong twice. ``gearmath.machine.control.executor`` runs what is
read here.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import NoReturn

from gearmath.machine.control.expression import (
    AXES,
    CUTTER_AXIS,
    DECIMALS,
    FUNCTIONS,
    NUMBER,
    Constant,
    Node,
    Scanner,
    shown,
)
from gearmath.machine.control.refused import instead
from gearmath.machine.control.structure import Keyword, structured
from gearmath.machine.control.text import check_file_name, check_program_name, divided
from gearmath.machine.control.tree import Assignment, Block, Command, Definition, Program, Statement, Word

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
        "program end": "M2 M17 M30 RET",
    }.items()
    for code in codes.split()
}
_COMMANDS = {"STOPRE", "MSG", "SETAL", "WRITE", "DELETE", "TRANS", "FGROUP", "SPCON", "SPCOF"}
_TYPES = ("INT", "REAL")
_BLANK = r"(?=[ \t]|$)"
_SKIP = re.compile(r"/[0-9]?(?![0-9])")
_NUMBERED = re.compile(r"[N:]([0-9]+)(?![0-9.=_])")
_LABEL = re.compile(r"([A-Z_]{2}[A-Z0-9_]*):(?!=)")
_CODE = re.compile(rf"[GM]0{{0,2}}([0-9]{{1,3}})(?=[ \tA-Z]|$)|[A-Z]{{3,8}}{_BLANK}")
_CONSTANT = re.compile(rf"([A-Z])[ \t]*([+-]?)({NUMBER})(?=[ \tA-Z]|$)")
_TOOL = re.compile(r'T[ \t]*=[ \t]*"([A-Za-z0-9_]{1,31})"(?=[ \tA-Z]|$)')
_ADDRESS = re.compile(rf"([{AXES}{CUTTER_AXIS}FSD]|SPOS|MEAS|ADIS|ADISPOS|CTOL|OTOL|OVR|OVRRAP)[ \t]*=(?!=)[ \t]*")
_WAY = re.compile(r"(DC|IC|AC|ACP|ACN)\(")
_GROUP_RADIUS = re.compile(rf"(FGREF|ACC)\[([{AXES}])\][ \t]*=[ \t]*")
_WORD = re.compile(r"[A-Z]+(?![A-Z0-9_.])")
_NAME = re.compile(r"[A-Z_]{2}[A-Z0-9_]*")
_ANY_NAME = re.compile(r"[A-Z0-9_]+")
_PARAMETERS = re.compile(r"\([A-Z \t,\[\]0-9]*\)")
_TARGET = re.compile(r"R[0-9]+(?=[ \t]*=[^=])|(?:R(?=\[)|[A-Z_][A-Z0-9_]+)(?=\[|[ \t]*=[^=])")
_STRUCTURE = ("IF", "ELSE", "ENDIF", "WHILE", "ENDWHILE", "FOR", "ENDFOR")
_LETTERS = frozenset(f"{AXES}{CUTTER_AXIS}FSD")
_ADDRESSES = ("SPOS", "MEAS", "ADIS", "ADISPOS", "FGREF", "CTOL", "OTOL", "OVR", "OVRRAP", "ACC")
_RESERVED = frozenset((
    *GROUP_OF_CODE, *_COMMANDS, *_TYPES, *_STRUCTURE, *_ADDRESSES, *FUNCTIONS,
    "DEF", "TO", "PROC", "EXTERN", "DIV", "MOD", "AND", "OR", "XOR", "NOT", "DC", "IC", "AC", "ACP", "ACN",
))  # fmt: skip
#: Characters of the text of MSG, two lines of the display [unconfirmed].
_LONGEST_MESSAGE = 124
_LARGEST_BLOCK_NUMBER = 99_999_999
_LARGEST_FIELD = 10_000


def read_program(text: str, name: str) -> Program:
    """The statements of a program. Raises InputError with ``name``, line and column for what is not understood.

    Capitals and small letters are the same outside texts. A block that begins with ``/`` is taken as not skipped;
    labels, EXTERN and PROC are read and do nothing.
    """
    comments: dict[int, str] = {}

    def parts() -> Iterator[Statement | Keyword]:
        first = True
        for number, code, comment in divided(text, name):
            if comment is not None:
                comments[number] = comment
            scanner = _AtLine(name, number, code)
            if scanner.done or (first and scanner.heading()):
                continue
            first = False
            if (read := scanner.statement()) is not None:
                yield read

    lines = text.count("\n") + 1
    body = tuple(structured(parts(), name, lines))
    return Program(name, body, comments, lines)


class _AtLine(Scanner):
    """One line of the program."""

    def heading(self) -> bool:
        """Whether the line is a PROC with a name, which may begin a program."""
        at = self.at
        if (word := self.match(_WORD)) is None or word[0] != "PROC":
            self.at = at
            return False
        self._program_name()
        if not self.done:
            self.refuse(f"{shown(self._rest())} after PROC: only a name is read, for a program without parameters")
        return True

    def statement(self) -> Statement | Keyword | None:
        """What the line says; None where it does nothing."""
        skip = self.text[self.at] == "/" and self.match(_SKIP) is not None
        words: dict[str, Word] = {}
        self._mark()
        if (number := self.match(_NUMBERED)) is not None:
            if len(number[1]) > 8 and int(number[1][:400]) > _LARGEST_BLOCK_NUMBER:
                what = f"the block number {shown(number[0])} is too large; the control takes {_LARGEST_BLOCK_NUMBER}"
                self.refuse(what, number.start())
            words["N"] = Word(number[0], Constant(float(number[1])), number.start() + 1)
            self._mark()
        if self.done:
            return Block(self.line, words) if words else None
        at = self.at
        if (found := self.match(_WORD)) is not None:
            if found[0] == "EXTERN":
                self._extern()
                return None
            if skip and found[0] in _STRUCTURE:
                self.refuse(f"/ before {found[0]}: the program would mean something else with it skipped", at)
            read = self._instruction(found[0], at)
            if read is not None:
                if not self.done:
                    what = f"{shown(self._rest())} after {found[0]}: nothing else may stand in its block"
                    self.refuse(instead(self.text[self.at :]) or what)
                return read
            self.at = at
        return self._block(words)

    def _mark(self) -> None:
        """Pass over a label, to which nothing jumps, and the blanks around it."""
        self.blanks()
        if ":" not in self.text:
            return
        if (label := self.match(_LABEL)) is not None:
            self.check_length(label[1], label.start())
            if label[1] in _RESERVED:
                self.refuse(f"{label[1]} is a word of the language, and no label", label.start())
            self.blanks()

    def _program_name(self) -> None:
        self.blanks()
        at = self.at
        if (word := self.match(_ANY_NAME)) is None:
            self.refuse("the name of a program is missing")
        check_program_name(word[0], self.name, self.line, at + 1)

    def _extern(self) -> None:
        """EXTERN says that there is another program: its calls are refused where they stand."""
        self._program_name()
        self.blanks()
        self.match(_PARAMETERS)
        if not self.done:
            self.refuse(f"{shown(self._rest())} after EXTERN: it takes a name, and types in parentheses")

    def _instruction(self, word: str, at: int) -> Statement | Keyword | None:
        column = at + 1
        if word in ("IF", "WHILE"):
            self.blanks()
            return Keyword(word, self.line, column, (self.expression(),))
        if word == "FOR":
            return Keyword(word, self.line, column, self._counting())
        if word in ("ELSE", "ENDIF", "ENDWHILE", "ENDFOR"):
            return Keyword(word, self.line, column, ())
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
        arguments = self.arguments()
        self._check_texts(word, arguments, at)
        return Command(self.line, column, word, arguments)

    def _check_texts(self, word: str, arguments: tuple[Node, ...], at: int) -> None:
        """Refuse what does not fit the display, and what cannot be the name of a file."""
        texts = [one.value if isinstance(one, Constant) and isinstance(one.value, str) else None for one in arguments]
        if word == "MSG" and texts[:1] and len(texts[0] or "") > _LONGEST_MESSAGE:
            what = f"the text of MSG has {len(texts[0] or '')} characters; the control shows {_LONGEST_MESSAGE}"
            self.refuse(what, at)
        if word in ("WRITE", "DELETE") and texts[1:2] and texts[1] is not None:
            check_file_name(texts[1], self.name, self.line, self.text.index('"', at) + 2)

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
            name = self.match(_NAME)
            if name is None:
                self.refuse("the name of a variable is missing; it begins with two letters")
            if name[0] in _RESERVED:
                self.refuse(f"{name[0]} is a word of the language, and no name of a variable", at)
            sizes = self.variable(name[0], at).index
            if not all(isinstance(size, Constant) and size.value in range(1, 1001) for size in sizes):
                self.refuse("the size of a field must be a whole number from 1 to 1000", at)
            if math.prod(int(size.value) for size in sizes if isinstance(size, Constant)) > _LARGEST_FIELD:
                self.refuse(f"the field {name[0]} has more than {_LARGEST_FIELD} values", at)
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
            key, word = self._constant() or self._word()
            if key not in AXES or word.way:
                self.refuse(f"TRANS takes axes with a number, not {word.text}", word.column - 1)
            words[key] = word.value
        return tuple(words.items())

    def _axes(self) -> tuple[tuple[str, Node], ...]:
        axes = self.match(re.compile(rf"[ \t]*(?:[{AXES}][ \t]*(?:,[ \t]*[{AXES}][ \t]*)*)?\)"))
        if axes is None:
            self.refuse("FGROUP takes axes with commas between them")
        return tuple((axis, Constant(0.0)) for axis in axes[0] if axis in AXES)

    def _block(self, words: dict[str, Word]) -> Block:
        assignments: list[Assignment] = []
        while not self.done:
            at = self.at
            if (read := self._constant()) is None:
                if (assignment := self._assignment()) is not None:
                    assignments.append(assignment)
                    continue
                read = self._word()
            key, word = read
            if key in words:
                self.refuse(f"{word.text} is a second value for {key} in one block", at)
            words[key] = word
        return Block(self.line, words, tuple(assignments))

    def _assignment(self) -> Assignment | None:
        at = self.at
        name = self.match(_TARGET)
        if name is None or name[0] in _ADDRESSES:
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

    def _constant(self) -> tuple[str, Word] | None:
        """Key and content of a letter with its number, the most frequent word; None for others."""
        at = self.at
        if (constant := self.match(_CONSTANT)) is None:
            return None
        letter, sign, digits = constant.groups()
        if letter in _LETTERS:
            if self.at < len(self.text) and self.text[self.at] == "E":
                self._refuse_exponent(constant.start(2))
            value = self.number(digits, constant.start(3))
            return letter, Word(constant[0], Constant(-value if sign == "-" else value), at + 1)
        if letter == "N" and digits.isdecimal():
            self.refuse(f"the block number {constant[0]} must be the first word", at)
        self.at = at
        return None

    def _word(self) -> tuple[str, Word]:
        """Key and content of one word."""
        at, column = self.at, self.at + 1
        if (code := self.match(_CODE)) is not None:
            name = f"{code[0][0]}{int(code[1])}" if code[1] else code[0]
            if name in GROUP_OF_CODE:
                return GROUP_OF_CODE[name], Word(name, Constant(0.0), column)
        elif (tool := self.match(_TOOL)) is not None:
            return "T", Word(tool[1], Constant(0.0), column)
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
        self.blanks()
        value = self.expression()
        self.need(")")
        if not self._ends():
            self.refuse(f"{shown(self._rest())} is not understood: a blank may be missing before it")
        return Word(self.text[at : self.at], value, at + 1, way[1])

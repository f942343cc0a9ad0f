"""Reads NC programs back: words, logic and comments, as a tree of statements.

It understands the dialect that this package writes and refuses everything else with line and column. It shares no code
with the writers: what both get wrong, they must get wrong twice. ``gearmath.machine.control.executor`` runs what is
read here.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

from gearmath.machine.control.expression import AXES, CUTTER_AXIS, Constant, Node, shown
from gearmath.machine.control.refused import instead
from gearmath.machine.control.structure import Keyword, structured
from gearmath.machine.control.text import check_file_name, check_program_name, divided
from gearmath.machine.control.tree import Block, Command, Definition, ParsedProgram, Statement, Word
from gearmath.machine.control.vocabulary import COMMANDS, RESERVED, STRUCTURE, TYPES
from gearmath.machine.control.words import TARGET, WordScanner

_ALL = AXES + CUTTER_AXIS
_SKIP = re.compile(r"/[0-9]?(?![0-9])")
_NUMBERED = re.compile(r"[N:]([0-9]+)(?![0-9.=_])")
_LABEL = re.compile(r"([A-Z_]{2}[A-Z0-9_]*):(?!=)")
_WORD = re.compile(r"[A-Z]+(?![A-Z0-9_.])")
_NAME = re.compile(r"[A-Z_]{2}[A-Z0-9_]*")
_ANY_NAME = re.compile(r"[A-Z0-9_]+")
_PARAMETERS = re.compile(r"\([A-Z \t,\[\]0-9]*\)")
#: Characters of the text of MSG, two lines of the display [unconfirmed].
_LONGEST_MESSAGE = 124
_LARGEST_BLOCK_NUMBER = 99_999_999
_LARGEST_FIELD = 10_000


def read_program(text: str, name: str) -> ParsedProgram:
    """The statements of a program. Raises InputError with ``name``, line and column for what is not understood.

    Capitals and small letters are the same outside texts. A block that begins with ``/`` is taken as not skipped;
    labels, EXTERN and PROC are read and do nothing.
    """
    comments: dict[int, str] = {}
    labels: dict[str, int] = {}

    def parts() -> Iterator[Statement | Keyword]:
        first = True
        for number, code, comment in divided(text, name):
            if comment is not None:
                comments[number] = comment
            scanner = _AtLine(name, number, code, labels)
            if scanner.done or (first and scanner.heading()):
                continue
            first = False
            if (read := scanner.statement()) is not None:
                yield read

    lines = text.count("\n") + 1
    body = tuple(structured(parts(), name, lines))
    return ParsedProgram(name, body, comments, lines)


class _AtLine(WordScanner):
    """One line of the program; ``labels`` are those of the lines before it."""

    def __init__(self, name: str, line: int, text: str, labels: dict[str, int]) -> None:
        super().__init__(name, line, text)
        self.labels = labels

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
            if skip and found[0] in STRUCTURE:
                self.refuse(f"/ before {found[0]}: the program would mean something else with it skipped", at)
            read = self._instruction(found[0], at)
            if read is not None:
                if not self.done:
                    what = f"{shown(self._rest())} after {found[0]}: nothing else may stand in its block"
                    self.refuse(instead(self.text[self.at :]) or what)
                return read
            self.at = at
        return self.block(words)

    def _mark(self) -> None:
        """Pass over a label, to which nothing jumps, and the blanks around it."""
        self.blanks()
        if ":" not in self.text:
            return
        if (label := self.match(_LABEL)) is not None:
            self.check_length(label[1], label.start())
            if label[1] in RESERVED:
                self.refuse(f"{label[1]} is a word of the language, and no label", label.start())
            if label[1] in self.labels:
                what = f"the label {label[1]} stands in line {self.labels[label[1]]} already: a search finds one only"
                self.refuse(what, label.start())
            self.labels[label[1]] = self.line
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
        if word not in COMMANDS:
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
        if (name := self.match(TARGET)) is None:
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
        if kind is None or kind[0] not in TYPES:
            self.refuse(f"DEF knows {' and '.join(TYPES)} only", at)
        variables = []
        while True:
            self.blanks()
            at = self.at
            name = self.match(_NAME)
            if name is None:
                self.refuse("the name of a variable is missing; it begins with two letters")
            if name[0] in RESERVED:
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
            key, word = self.constant() or self.word()
            if key not in AXES or word.way:
                self.refuse(f"TRANS takes axes with a number, not {word.text}", word.column - 1)
            words[key] = word.value
        return tuple(words.items())

    def _axes(self) -> tuple[tuple[str, Node], ...]:
        axes = self.match(re.compile(rf"[ \t]*(?:[{_ALL}][ \t]*(?:,[ \t]*[{_ALL}][ \t]*)*)?\)"))
        if axes is None:
            self.refuse("FGROUP takes axes with commas between them")
        return tuple((axis, Constant(0.0)) for axis in axes[0] if axis in _ALL)

"""Reads NC programs back: words, modal groups, and the path of the axes that the text commands.

It understands the dialect that this house writes and refuses everything else with line and column. It shares no code
with the writer: what both get wrong, they must get wrong twice.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import NamedTuple, NoReturn

import numpy as np

from gearmath.errors import InputError

#: The codes that are understood, by group. One code of a group at a time, in a block and in force.
_GROUP_OF_CODE = {
    code: group
    for group, codes in {
        "motion": "G0 G1",
        "plane": "G17",
        "radius compensation": "G40",
        "work offset": "G54 G55 G56 G57",
        "dimensioning": "G90",
        "units": "G710",
        "feed mode": "G93 G94",
        "spindle": "M3 M4 M5",
        "tool change": "M6",
        "coolant": "M8 M9",
        "program end": "M30",
    }.items()
    for code in codes.split()
}
_GROUPS = frozenset(_GROUP_OF_CODE.values())
#: Without these the meaning of an axis word depends on how the control happens to stand.
_NEEDED_FOR_MOTION = {
    "plane": "G17",
    "radius compensation": "G40",
    "work offset": "G54",
    "dimensioning": "G90",
    "units": "G710",
}
#: Whether these act before or after the motion of their block is a setting of the machine.
_NOT_WITH_MOTION = ("spindle", "tool change", "coolant", "program end", "T", "D", "S")
_AXES = "XYZAB"
# Nine digits before the point and twelve behind it: no number is too large for a double.
_NUMBER = r"-?[0-9]{1,9}(?:\.[0-9]{1,12})?"
_WORD = re.compile(
    rf"(?:(?P<code>[GM]0?[0-9]{{1,3}})|(?P<address>[XYZBFSD])(?P<number>{_NUMBER})|(?P<block>N[0-9]{{1,9}})"
    rf'|A=DC\((?P<angle>{_NUMBER})\)|T="(?P<tool>[A-Za-z0-9_]{{1,31}})")'
)
_TOKEN = re.compile(r"[^ \t]+")
_HALF_RESOLUTION_DEG = 5e-7


class Word(NamedTuple):
    """One word of a block: ``text`` is the code or the tool name, ``value`` the number, in NC units."""

    text: str
    value: float
    column: int


@dataclass(frozen=True)
class Block:
    """One line with at least one word; ``words`` by address (X Y Z A B F S T D N) or by group of codes."""

    line: int
    words: dict[str, Word]


@dataclass(frozen=True)
class MachinePath:
    """What a program commands, one row for each motion block that ends at a known position of all five axes."""

    axes: np.ndarray
    """Positions X Y Z A B at the ends of the blocks, (n, 5) mm and rad; A unwrapped by the short way of DC."""
    rapid: np.ndarray
    """Whether the block is a G0 block, (n,). The first row, and the first after a tool change, is always one."""
    tool: np.ndarray
    """Index into ``tools``, (n,)."""
    tools: tuple[str, ...]
    line: np.ndarray
    """Line number in the text, from 1, (n,)."""
    seconds: np.ndarray
    """Duration, (n,) s; 0 for a rapid block, whose speed is the machine's and not the program's."""
    spindle_on: np.ndarray
    """Whether the spindle turns, (n,)."""


class _Row(NamedTuple):
    position: tuple[float, ...]
    rapid: bool
    tool: str
    line: int
    seconds: float
    spindle_on: bool


@dataclass
class _Control:
    """What is in force while the program runs."""

    name: str
    modal: dict[str, str] = field(default_factory=dict)
    position: dict[str, float] = field(default_factory=dict)
    feed: float | None = None
    speed_known: bool = False
    selected: str | None = None
    tool: str | None = None
    edge: bool = False
    ended: bool = False

    @property
    def spindle_on(self) -> bool:
        return self.modal.get("spindle", "M5") != "M5"


def read_program(text: str, name: str) -> list[Block]:
    """The blocks of a program. Raises InputError with ``name``, line and column for any word that is not understood."""
    blocks = []
    for number, line in enumerate(text.split("\n"), start=1):
        code = line.removesuffix("\r").partition(";")[0]
        words: dict[str, Word] = {}
        for token in _TOKEN.finditer(code):
            key, word = _word(token[0], name, number, token.start() + 1)
            if key in words:
                _refuse(name, number, word.column, f"{token[0]} is a second value for {key} in one block")
            if key == "N" and words:
                _refuse(name, number, word.column, f"the block number {token[0]} must be the first word")
            words[key] = word
        if words:
            blocks.append(Block(number, words))
    return blocks


def execute(text: str, name: str) -> MachinePath:
    """Run a program as the control would. Raises InputError with ``name``, line and column for what it must not do."""
    control = _Control(name)
    rows = []
    blocks = read_program(text, name)
    for block in blocks:
        row = _run(control, block)
        if row is not None:
            rows.append(row)
    if not control.ended:
        _refuse(name, text.count("\n") + 1, 1, "the text ends without M30: the program is not complete")
    return _path(rows, name)


def _word(token: str, name: str, line: int, column: int) -> tuple[str, Word]:
    """Key and content of one word."""
    match = _WORD.fullmatch(token)
    if match is None:
        _refuse(name, line, column, f"the word {_shown(token)} is not understood")
    kind = match.lastgroup
    if kind == "number":
        return match["address"], Word(token, float(match["number"]), column)
    if kind == "block":
        return "N", Word(token, float(token[1:]), column)
    if kind == "angle":
        angle = float(match["angle"])
        if not 0.0 <= angle < 360.0:
            _refuse(name, line, column, f"{token} is out of range: DC takes 0 to less than 360 degrees")
        return "A", Word(token, angle, column)
    if kind == "tool":
        return "T", Word(match["tool"], 0.0, column)
    code = f"{token[0]}{int(token[1:])}"
    if code not in _GROUP_OF_CODE:
        _refuse(name, line, column, f"the word {_shown(token)} is not understood")
    return _GROUP_OF_CODE[code], Word(code, 0.0, column)


def _run(control: _Control, block: Block) -> _Row | None:
    """Let one block act on the control; the row of the path if it moves to a position that is known."""
    words, name = block.words, control.name
    if control.ended:
        _refuse(name, block.line, 1, "there is a block after M30")
    if "feed mode" in words and words["feed mode"].text != control.modal.get("feed mode"):
        control.feed = None  # the number meant something else
    if "T" in words:
        control.selected, control.edge = words["T"].text, False
    for key, word in words.items():
        _switch(control, key, word, block.line)
    if "tool change" in words:
        _change_tool(control, block)
    if "spindle" in words and control.spindle_on and not control.speed_known:
        _refuse(name, block.line, words["spindle"].column, f"{words['spindle'].text} without a spindle speed S")
    control.ended = "program end" in words
    if any(axis in words for axis in _AXES):
        return _move(control, block)
    return None


def _switch(control: _Control, key: str, word: Word, line: int) -> None:
    """Put one word in force."""
    if key in "FS" and word.value <= 0.0:
        _refuse(control.name, line, word.column, f"{word.text}: must be greater than 0")
    if key == "F":
        control.feed = word.value
    elif key == "S":
        control.speed_known = True
    elif key == "D":
        if word.value != 1.0:
            _refuse(control.name, line, word.column, f"{word.text}: only the cutting edge D1 is understood")
        control.edge = True
    elif key == "work offset" and control.modal.get(key, word.text) != word.text:
        _refuse(
            control.name, line, word.column, f"{word.text} after {control.modal[key]}: one work offset is understood"
        )
    elif key in _GROUPS:
        control.modal[key] = word.text


def _change_tool(control: _Control, block: Block) -> None:
    """M6 fetches the selected tool and leaves the axes wherever the change takes place."""
    column = block.words["tool change"].column
    if control.selected is None:
        _refuse(control.name, block.line, column, "M6 without a tool: T is missing")
    if control.spindle_on:
        _refuse(control.name, block.line, column, "M6 with the spindle on")
    control.tool = control.selected
    control.position.clear()


def _move(control: _Control, block: Block) -> _Row | None:
    """The motion of one block; None while the position of an axis is still unknown."""
    name, line, words = control.name, block.line, block.words
    column = min(words[axis].column for axis in _AXES if axis in words)
    for key in _NOT_WITH_MOTION:
        if key in words:
            _refuse(name, line, words[key].column, f"{words[key].text} and axis words in one block")
    for group, example in _NEEDED_FOR_MOTION.items():
        if group not in control.modal:
            _refuse(name, line, column, f"motion before the {group} is stated ({example})")
    if control.tool is None or control.tool != control.selected or not control.edge:
        _refuse(name, line, column, 'motion without a tool: T="..." D1 and M6 must come first')
    if "motion" not in control.modal:
        _refuse(name, line, column, "axis words without G0 or G1")
    before = dict(control.position)
    control.position.update({axis: words[axis].value for axis in _AXES if axis in words})
    rapid = control.modal["motion"] == "G0"
    seconds = 0.0 if rapid else _cutting_seconds(control, block, before, column)
    if len(control.position) < len(_AXES):
        return None
    position = tuple(control.position[axis] for axis in _AXES)
    return _Row(position, rapid, control.tool, line, seconds, control.spindle_on)


def _cutting_seconds(control: _Control, block: Block, before: dict[str, float], column: int) -> float:
    """Duration of a G1 block [s]: 60/F with G93, length of the path / F with G94."""
    name, line, after = control.name, block.line, control.position
    if not control.spindle_on:
        _refuse(name, line, column, "cutting move with the spindle off")
    unknown = [axis for axis in _AXES if axis not in before]
    if unknown:
        _refuse(name, line, column, f"cutting move from an unknown position of {' '.join(unknown)}")
    mode = control.modal.get("feed mode")
    if mode is None:
        _refuse(name, line, column, "cutting move before G93 or G94")
    if mode == "G93":
        if "F" not in block.words:
            _refuse(name, line, column, "F is missing: every G93 block needs its own")
        return 60.0 / block.words["F"].value
    if control.feed is None:
        _refuse(name, line, column, "cutting move without a feed F")
    for axis in "AB":
        # what F means then depends on FGROUP, which is not part of the dialect
        if before[axis] != after[axis]:
            _refuse(name, line, column, f"G94 with {axis} turning: write such a block with G93")
    length = float(np.linalg.norm([after[axis] - before[axis] for axis in "XYZ"]))
    return 60.0 * length / control.feed


def _path(rows: list[_Row], name: str) -> MachinePath:
    """The rows as arrays, in mm and rad, A unwrapped."""
    positions = np.array([row.position for row in rows]).reshape(-1, len(_AXES))
    rapid = np.array([row.rapid for row in rows], dtype=bool)
    line = np.array([row.line for row in rows], dtype=int)
    steps = np.diff(positions[:, 3])
    halves = (np.abs(np.abs(steps) - 180.0) < _HALF_RESOLUTION_DEG) & ~rapid[1:]
    if halves.any():
        _refuse(name, int(line[1:][halves][0]), 1, "A turns by exactly 180 degrees: DC leaves the direction open")
    # whole turns are counted, so that no rounding error adds up over the program
    turns = np.concatenate([np.zeros(min(len(rows), 1)), -np.cumsum(np.rint(steps / 360.0))])
    positions[:, 3] += 360.0 * turns
    positions[:, 3:] = np.radians(positions[:, 3:])
    tools = tuple(dict.fromkeys(row.tool for row in rows))
    return MachinePath(
        axes=positions,
        rapid=rapid,
        tool=np.array([tools.index(row.tool) for row in rows], dtype=int),
        tools=tools,
        line=line,
        seconds=np.array([row.seconds for row in rows]),
        spindle_on=np.array([row.spindle_on for row in rows], dtype=bool),
    )


def _shown(token: str) -> str:
    """A token as it can stand in a sentence."""
    return repr(token) if len(token) <= 40 else f"{token[:40]!r}..."


def _refuse(name: str, line: int, column: int, what: str) -> NoReturn:
    raise InputError(f"{name}, line {line}, column {column}: {what}")

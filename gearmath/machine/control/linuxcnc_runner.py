"""Runs programs for LinuxCNC as its interpreter would, on a machine that is set up as the machine file says.

``#<_task>`` is 1: a program checks the control as it does where it moves a machine. What it asks of positions before
its first motion is answered with axes that are up and away, unless the set-up says where they stand. ABORT is the alarm
of a program. There is no host.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from gearmath.machine.control.expression import AXES, refuse
from gearmath.machine.control.linuxcnc_expression import Cursor
from gearmath.machine.control.linuxcnc_lines import NgcLine, lines_of, partners
from gearmath.machine.control.linuxcnc_motion import ABORTED, ANOTHER_TOOL, OFFSETS, LinuxCncMotion
from gearmath.machine.control.state import Deflected, Follower, Probe, Setup

#: R parameters that are handed in, and what they are here: the first and the last part that is run.
_SAME = {90: 3090, 91: 3091}
_WORD = re.compile(r"[A-Z]")
_TOOL = re.compile(r"^; tool T(\d+): ([A-Za-z0-9_]+)", re.MULTILINE)
_FORMAT = re.compile(r"%(d|\.\d+f)#(<[^>]+>|\d+)|#(<[^>]+>|\d+)")


class LinuxCncRunner(LinuxCncMotion):
    """Lines in the order in which they act; what it has at the end is what the runner of the other dialect has."""

    def __init__(
        self,
        name: str,
        setup: Setup,
        probe: Probe | None,
        parameters: Mapping[int, float],
        step_limit: int,
        deflected: Deflected,
        moved: Follower,
    ) -> None:
        super().__init__(name, setup, probe, deflected, moved)
        self.steps_left = self._steps = step_limit
        self.parameters = {_SAME.get(number, number): value for number, value in parameters.items()}
        self.named: dict[str, float] = {}
        self.local: list[dict[int, float]] = [{}]
        self.files: dict[str, list[str]] = {}
        self.taken: set[int] = set()
        self.unset: dict[int, int] = {}
        self.ran: set[int] = set()
        self._log: str | None = None

    def run(self, text: str) -> None:
        """The whole program, from its first line to M2."""
        self.tools = {int(number): tool for number, tool in _TOOL.findall(text)}
        self._begin_with(self.control.setup.tool)
        self.lines = lines_of(text, self.name)
        self.ends = partners(self.lines, self.name)
        self.subs = {line.label: place for place, line in enumerate(self.lines) if line.flow == "SUB"}
        self._from(0, len(self.lines))
        if not self.control.ended:
            refuse(self.name, len(text.splitlines()), 1, "the text ends without M2: the program is not complete")

    def _begin_with(self, tool: str | None) -> None:
        """The tool that is in the spindle at the start; one that the program does not know has another number."""
        if tool is not None:
            self.control.fetched = next((number for number, name in self.tools.items() if name == tool), ANOTHER_TOOL)

    def _from(self, place: int, end: int) -> None:
        """Lines from one place to another."""
        while place < end and not self.control.ended:
            line = self.lines[place]
            self.steps_left -= 1
            self.ran.add(line.number)
            if self.steps_left < 0:
                refuse(self.name, line.number, 1, f"the program takes more than {self._steps} steps: does it end?")
            if line.flow:
                place = self._flow(place, line)
                continue
            self._says(line)
            if not self.control.ended:
                self._block(line)
            place += 1

    def _flow(self, place: int, line: NgcLine) -> int:
        """Where an O-word leads."""
        if line.flow in ("IF", "WHILE"):
            holds = self._cursor(line).value() != 0.0
            return place + 1 if holds else self.ends[place] + 1
        if line.flow in ("ELSE", "SUB"):
            return self.ends[place] + 1
        if line.flow == "ENDWHILE":
            return self.ends[place]
        if line.flow == "CALL":
            begin = self.subs.get(line.label)
            if begin is None:
                refuse(self.name, line.number, 1, f"there is no subroutine O{line.label}")
            cursor = self._cursor(line)
            values: dict[int, float] = {}
            while not cursor.ended:
                values[len(values) + 1] = cursor.value()
            self.local.append(values)
            if len(self.local) > 10:
                refuse(self.name, line.number, 1, "subroutines are called more than 10 deep")
            self._from(begin + 1, self.ends[begin])
            self.local.pop()
        return place + 1

    def _cursor(self, line: NgcLine) -> Cursor:
        return Cursor(line.code, self.name, line.number, lambda number: self._numbered(number, line), self._named)

    def _numbered(self, number: int, line: NgcLine) -> float:
        """The value of a parameter: of the control, of the subroutine, or of the program."""
        state, setup = self.control, self.control.setup
        if number <= 30:
            return self.local[-1].get(number, 0.0)
        for code, first in OFFSETS.items():
            if first <= number < first + 20 and (setup.work_offset in (None, code)):
                at = number - first
                return setup.offset[at] if at < 5 else setup.turned[2] if at == 9 else 0.0
        if 5061 <= number < 5061 + len(AXES) and self._latched >= 0:
            self.taken.add(self._latched)
        if number == 5400:
            return float(state.fetched)
        if number == 5403:
            return self._length()
        if 5420 <= number < 5420 + len(AXES):
            return self._shown(AXES[number - 5420])
        if number >= 5000 and number not in self.parameters:
            return 0.0
        if number not in self.parameters and not 3090 <= number <= 3110:
            self.unset.setdefault(number, line.number)
        return self.parameters.get(number, 0.0)

    def _named(self, name: str) -> float | None:
        return 1.0 if name == "_TASK" else self.named.get(name)

    def _says(self, line: NgcLine) -> None:
        """What the comments of a line do."""
        for what, text in line.said:
            shown = _FORMAT.sub(lambda found: self._formatted(found, line), text).strip()
            if what in ("LOGOPEN", "LOGAPPEND"):
                self._log = shown
                self.files[shown] = [] if what == "LOGOPEN" else self.files.get(shown, [])
            elif what == "LOG":
                if self._log is None:
                    refuse(self.name, line.number, 1, "LOG without LOGOPEN")
                self.files[self._log].append(shown)
            elif what == "LOGCLOSE":
                self._log = None
            else:
                self.messages.append(shown)
            if what == "ABORT":
                self.alarm = ABORTED, line.number
                self.control.ended = True

    def _formatted(self, found: re.Match[str], line: NgcLine) -> str:
        name = found[2] or found[3]
        value = self._named(name[1:-1].upper()) if name.startswith("<") else self._numbered(int(name), line)
        form = found[1] or ".6f"
        return f"{round(value or 0.0)}" if form == "d" else f"{value or 0.0:{form}}"

    def _block(self, line: NgcLine) -> None:
        """Assignments, then words; assignments act when the line is over."""
        cursor = self._cursor(line)
        set_: dict[int | str, float] = {}
        words: dict[str, float] = {}
        codes: list[str] = []
        while not cursor.ended:
            if cursor.text.startswith("#", cursor.at):
                key = self._assigned(cursor)
                set_[key] = cursor.value()
                continue
            found = cursor.match(_WORD)
            if found is None:
                cursor.refuse(f"{cursor.text[cursor.at : cursor.at + 10]!r} is not understood")
                raise AssertionError
            value = cursor.value()
            if found[0] in "GM":
                codes.append(f"{found[0]}{value:g}")
            elif found[0] != "N":
                if found[0] in words:
                    cursor.refuse(f"{found[0]} is there twice")
                words[found[0]] = value
        self._act(line, codes, words)
        for key, value in set_.items():
            if isinstance(key, str):
                self.named[key] = value
            elif key <= 30:
                self.local[-1][key] = value
            else:
                self.parameters[key] = value

    def _assigned(self, cursor: Cursor) -> int | str:
        """The parameter that a line sets, behind it the sign of equality."""
        key: int | str
        if cursor.text.startswith("#<", cursor.at):
            end = cursor.text.find(">", cursor.at)
            key, cursor.at = cursor.text[cursor.at + 2 : end], end + 1
        else:
            key = cursor.index()
        if not cursor.text.startswith("=", cursor.at):
            cursor.refuse("= is expected")
        cursor.at += 1
        return key

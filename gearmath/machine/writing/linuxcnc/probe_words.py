"""The blocks of probing programs for LinuxCNC: G38.3 to a surface, G38.5 off it, result file, and the host's handshake.

Every motion of the probe that could meet something is a G38.3 block: LinuxCNC stops it where the probe triggers, and
refuses to begin it with a probe that is deflected. The way off a surface begins with G38.5, since G1 would end the
program with the probe still deflected. Results are parameters 5061 to 5065, in coordinates of the program, and 5070.

A handshake has one analog output for every number (M68), and the host answers by one analog input (M66): the point
that it has kept. The program asks for the host once, at its start, by a digital input.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import ClassVar

from gearmath.machine.planning.clear_space import Room
from gearmath.machine.planning.targets import POSITIONING_FEED
from gearmath.machine.writing.linuxcnc.dialect import FIRST, LAST, Dialect, message
from gearmath.machine.writing.probe_words import Blocks, ProbingPlan
from gearmath.specs.control import PROBE, PROBE_NUMBER
from gearmath.specs.milling_machine import AXES, MillingMachine
from gearmath.specs.touch_csv import COLUMNS, HELD, PLANNED

#: Parameters: run of the control, whether a host waits for the touches, and X Y Z A B and the result of the last touch.
RUN, HOST, TOUCH = 3102, 3104, (3200, 3201, 3202, 3203, 3204, 3205)
#: Analog outputs: the point that is offered, its run, its six values. Inputs: point acknowledged, first and last part.
OFFERED, NUMBER, VALUES = 0, 1, (2, 3, 4, 5, 6, 7)
ACKNOWLEDGED, FIRST_PART, LAST_PART = 0, 1, 2
#: The answer is the number of the run times this, and the point: that of an earlier run is none.
POINTS_OF_A_RUN = 1_000_000
#: Digital input: a host waits for the touches.
HOST_WAITS = 0
#: Seconds between two looks for the answer of the host.
_LOOK = 0.02
_FORMAT = "%.7f"
#: Ending of the result file.
RESULT = ".csv"


def probe_number(machine: MillingMachine) -> int:
    """Number of the probe in the tool table."""
    return machine.control.tool_numbers.get(PROBE, PROBE_NUMBER)


class LinuxCncBlocks(Blocks):
    """Writes the blocks of one program, in words of LinuxCNC: a word that ends in =IC(0) is left out."""

    words: ClassVar[type[Dialect]] = Dialect
    """Other words in a relative of LinuxCNC."""

    def __init__(self, name: str, machine: MillingMachine, length: float) -> None:
        super().__init__(name, machine, length)
        self.dialect = self.words(name, machine, length)
        self.positions = self.dialect.positions
        self.point = 0
        """The touch that was written last."""

    @property
    def tool(self) -> int:
        """Number of the probe in the tool table."""
        return probe_number(self.machine)

    def text(self, header: Sequence[str], body: Iterable[str]) -> str:
        """The program: a header of comments, the subroutine that offers a touch, and the body."""
        notes = (
            "control: LinuxCNC",
            f"tool T{self.tool}: {PROBE}; LINEAR_UNITS = mm, no WRAPPED_ROTARY",
            f"parameters {FIRST[1:]}, {LAST[1:]}: first and last part to touch, 0 for all; the program asks before it "
            "leaves any out",
            f"touches go to {self.result_file}{RESULT} in the folder of the INI file, and to the host's handshake",
        )
        first, *others = header
        return self.dialect.text((first, *notes, *others), (*self._offering(), *body))

    def _offering(self) -> Iterator[str]:
        """Subroutine: the numbers of a touch, the point last, and the wait for a host, if there is one, to keep it."""
        yield "o<offer> sub"
        yield f"M68 E{NUMBER} Q#{RUN}"
        for output, parameter in zip(VALUES, TOUCH, strict=True):
            yield f"M68 E{output} Q#{parameter}"
        yield f"M68 E{OFFERED} Q#1"
        yield from self.dialect.moving(f"#{HOST} EQ 1", self._waiting())
        yield "o<offer> endsub"

    def _waiting(self) -> Iterator[str]:
        yield f"M66 E{ACKNOWLEDGED} L0"
        yield f"o100 while [#5399 NE [#{RUN}*{POINTS_OF_A_RUN}+#1]]"
        yield f"G4 P{_LOOK}"
        yield f"M66 E{ACKNOWLEDGED} L0"
        yield "o100 endwhile"

    def number(self, value: float) -> str:
        text = f"{value:.5f}"
        return f"[{text}]" if value < 0 else text

    def variable(self, number: int) -> str:
        return f"#{3000 + number}"

    def middle(self, one: int, other: int) -> str:
        return f"[[{self.variable(one)}+{self.variable(other)}]/2]"

    def measured(self, axis: str) -> str:
        return f"#{TOUCH[AXES.index(axis)]}"

    def at(self, axis: str, number: int, off: str = "") -> str:
        return f"{axis}[{self.variable(number)}{off}]" if off else f"{axis}{self.variable(number)}"

    def start(self, plan: ProbingPlan, columns: Sequence[str] = COLUMNS, room: Room | None = None) -> Iterator[str]:
        dialect = self.dialect
        yield from dialect.head()
        yield from dialect.checks()
        if room is not None:
            yield from dialect.enough_height(room, self.machine.cutter_head.spindle_radius)
        yield f"M66 P{HOST_WAITS} L0"
        yield f"#{HOST}=#5399"
        for chosen, part in ((FIRST, FIRST_PART), (LAST, LAST_PART)):
            yield from dialect.moving(f"#{HOST} EQ 1", (f"M66 E{part} L0", f"{chosen}=#5399"))
        yield from dialect.asked(plan.parts, plan.part)
        yield "M5 M9"
        yield from dialect.retract()
        yield from dialect.fetch(PROBE, self.tool)
        yield f"#{RUN}=[#{RUN}+1]"
        yield f"M68 E{OFFERED} Q0"
        yield f"M68 E{NUMBER} Q#{RUN}"
        file = f"{self.result_file}{RESULT}"
        fresh = (f"(LOGOPEN,{file})",)
        yield from dialect.when(f"{FIRST} LE 1", fresh, (f"(LOGAPPEND,{file})",))
        yield f"(LOG,# {PLANNED}: {plan.said})"
        yield from self._held(plan)
        yield f"(LOG,{','.join(columns)})"

    def _held(self, plan: ProbingPlan) -> Iterator[str]:
        """The line that says which touches a run makes, where these are not all."""
        ends = plan.ends or tuple(plan.each * (k + 1) for k in range(plan.parts))
        first, last = "#3001", "#3002"
        chosen = f"[{FIRST} GT 1] OR [[{LAST} GT 0] AND [{LAST} LT {plan.parts}]]"
        body = [f"{first}=1", f"{last}={ends[-1]}"]
        if plan.ends:
            for part in range(1, plan.parts + 1):
                before = 1 + (ends[part - 2] if part > 1 else 0)
                body += self.dialect.when(f"{FIRST} EQ {part}", (f"{first}={before}",))
                body += self.dialect.when(f"{LAST} EQ {part}", (f"{last}={ends[part - 1]}",))
        else:
            body += self.dialect.when(f"{FIRST} GT 0", (f"{first}=[[{FIRST}-1]*{plan.each}+1]",))
            body += self.dialect.when(f"{LAST} GT 0", (f"{last}=[{LAST}*{plan.each}]",))
        body.append(f"(LOG,# {HELD}: %d{first} to %d{last})")
        yield from self.dialect.when(chosen, body)

    def section(self, plan: ProbingPlan, number: int, what: str, body: Iterable[str]) -> Iterator[str]:
        yield f"; section {number}: {what}"
        said = message(f"section {number} of {plan.parts}: {what}")
        yield from self.dialect.if_chosen(number, number, (said, self.dialect.modal(), *body))

    def end(self) -> Iterator[str]:
        yield "(LOGCLOSE)"
        yield from self.dialect.end()

    def aside(self, to: str) -> Iterator[str]:
        """Turned first, and then moved: the feed of LinuxCNC is that of X Y Z wherever one of them moves, and A and B
        would turn as fast as they can."""
        x, y, a, b = to.split(" ")
        for words in ((a, b), (x, y)):
            if moved := [word for word in words if not word.endswith("=IC(0)")]:
                yield from self._guarded(" ".join(moved), POSITIONING_FEED, "on the way to a point", None)

    def _off(self, up: str) -> Iterator[str]:
        """Off what was met, and up: as far as the contact lasts by G38.5."""
        yield f"G38.5 {up} F{POSITIONING_FEED:.3f}"
        yield f"G0 {up}"

    def _guarded(self, to: str, feed: float, where: str, level: float | None) -> Iterator[str]:
        yield f"G38.3 {_moved(to)} F{feed:.3f}"
        off = () if level is None else tuple(self._off(self.length("Z", level)))
        stop = self.dialect.stop(f"{self.place}touched something {where}")
        yield from self.dialect.moving("#5070 EQ 1", (*off, *stop))

    def touch(
        self, end: str, back: str, feed: float, retract_feed: float, level: float, up: bool = True
    ) -> Iterator[str]:
        zero = f"+{self.probe_length:.5f}" if self.machine.z_reference == "tip" else ""
        yield f"G38.3 {_moved(end)} F{feed:.3f}"
        for k, parameter in enumerate(TOUCH):
            value = f"#{5061 + k}" if k < len(AXES) else "#5070"
            yield f"#{parameter}=[{value}{zero}]" if zero and AXES[k : k + 1] == "Z" else f"#{parameter}={value}"
        yield from self.dialect.when(f"#{TOUCH[-1]} EQ 1", (f"G38.5 {_moved(back)} F{retract_feed:.3f}",))
        yield f"G1 {_moved(back)} F{retract_feed:.3f}"
        if up:
            yield f"G0 {self.length('Z', level)}"
        away = () if up else (f"G0 {self.length('Z', level)}",)
        stop = self.dialect.stop(f"{self.place}touched nothing")
        yield from self.dialect.moving(f"#{TOUCH[-1]} EQ 0", (*away, *stop))

    def hand_over(self, place: str) -> Iterator[str]:
        self.point += 1
        values = ",".join(f"{_FORMAT}#{parameter}" for parameter in TOUCH[:-1])
        yield f"(LOG,%d#{RUN},{self.point},{place},{values},%d#{TOUCH[-1]})"
        yield f"o<offer> call [{self.point}]"


def _moved(words: str) -> str:
    """Words without those of axes that stand still."""
    return " ".join(word for word in words.split(" ") if not word.endswith("=IC(0)"))

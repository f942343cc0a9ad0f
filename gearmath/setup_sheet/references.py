"""From where a machine counts, and what its programs compare with the control before they move anything."""

from __future__ import annotations

from gearmath.machine.writing.sheet_words import SheetWords
from gearmath.page import Page
from gearmath.setup_sheet.machine_drawing import CUTTER_TIP
from gearmath.specs.milling_machine import AXES, MillingMachine

_Z_MODES = {
    "gauge_line": "Z of a program is that of the gauge line: {length} of the tool in the table must be 0. Nothing on "
    "the control checks how long the tool really is: one that is longer cuts deeper by as much. A tool of another "
    "length, after grinding too, needs its length in the machine file and the program written anew.",
    "tip": "Z of a program is that of the tips, with {active} active: {length} of the tool in the table must be its "
    "length.",
}
_Z_OF_PROBE = {
    "gauge_line": "Z of a program is that of the gauge line: {length} of the probe in the table must be 0. Nothing on "
    "the control checks how long the probe really is: one that is longer touches late or runs into the work. After "
    "another stylus or tip it must be calibrated, and the program written anew.",
    "tip": "Z of a program is that of the center of the tip, with {active} active: {length} of the probe in the tool "
    "table must be its length.",
}


#: What else stops a program of a work before its first motion.
UNDER_THE_WORK = ", and where it may be under the work"


def references(
    page: Page,
    machine: MillingMachine,
    words: SheetWords,
    tips: str,
    length: float,
    length_name: str,
    more: str,
    more_before: str = UNDER_THE_WORK,
) -> None:
    """Table and sentences in the ``words`` of the control; ``tips`` is the end of the tool.

    ``length`` [mm] is its length, with the name of its key; ``more`` says what else the program stops for,
    ``more_before`` for what before its first motion.
    """
    above = machine.home - machine.gauge_line_height
    offsets = " ".join(f"{axis}{value:g}" for axis, value in zip(AXES, machine.work_offset_values, strict=True))
    pivot = ", ".join(f"{value:g}" for value in machine.pivot_offset)
    tool, modes = ("tool", _Z_MODES) if tips == CUTTER_TIP else ("probe", _Z_OF_PROBE)
    by_program = machine.z_reference == "tip"
    checked = f"by the program: {words.length} = {length:g}" if by_program else f"by hand: measure the {tool}"
    mode = modes[machine.z_reference].format(length=words.length, active=words.active)
    page.table(
        "References",
        ["what", "value", "unit", "checked"],
        [
            ["R_d, gauge_line_height", f"{machine.gauge_line_height:g}", "mm", "by hand, as below"],
            [length_name, f"{length:g}", "mm", checked],
            ["home of Z", f"{machine.home:g}", "mm", ""],
            ["gauge line above the B axis there", f"{above:g}", "mm", "by hand"],
            [f"{tips} above the B axis there", f"{above - length:g}", "mm", "by hand"],
            ["pitch apex from the B axis, x y z at A = 0", pivot, "mm", "by hand"],
            [f"{machine.work_offset} in machine coordinates", offsets, "mm, °", "by the program"],
            words.increments(machine),
            ["travel of X, Y, Z", ", ".join(_travel(machine, axis) for axis in "XYZ"), "mm", ""],
            ["travel of A, B", ", ".join(_travel(machine, axis) for axis in "AB"), "°", ""],
        ],
    )
    page.paragraph(
        f"{mode} The zero of {machine.work_offset} is on the B axis in X and Y; in Z it is "
        "where the gauge line reads 0. A turns the work clockwise, seen from its back towards the pitch apex. At B = 0 "
        "the work axis is level, with the toe of the teeth towards X+; B lowers the back."
    )
    page.paragraph(
        f"The program stops with a message before its first motion where {words.stops(machine)}{more_before}; "
        f"after a tool change, where {words.other_tool.format(tool=tool)}; {more}."
    )


def chosen_parts(words: SheetWords, part: str, done: str, stopped: str) -> str:
    """Sentences: how a program is started at one of its parts, and again at the one where it ``stopped``."""
    how = f" {words.how_set}" if words.how_set else ""
    return (
        f"{words.chosen[0].upper()}{words.chosen[1:]} are the first and the last {part} that are {done}, 0 for all; "
        f"the program shows them, waits for {words.goes_on}, and sets both to 0 at its end.{how} After a stop: "
        f"{words.ends}, {words.first} = {stopped}, {words.last} = 0, and start from the beginning of the program."
    )


def _travel(machine: MillingMachine, axis: str) -> str:
    travel = getattr(machine.axes, axis).travel
    return "without end" if travel is None else f"{travel[0]:g} to {travel[1]:g}"

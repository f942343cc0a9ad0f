"""From where a machine counts, and what its programs compare with the control before they move anything."""

from __future__ import annotations

from gearmath.page import Page
from gearmath.setup_sheet.machine_drawing import CUTTER_TIP
from gearmath.specs.milling_machine import AXES, MillingMachine

_Z_MODES = {
    "gauge_line": "Z of a program is that of the gauge line: length 1 of the tool in the table must be 0. Nothing on "
    "the control checks how long the tool really is: one that is longer cuts deeper by as much. A tool of another "
    "length, after grinding too, needs its length in the machine file and the program written anew.",
    "tip": "Z of a program is that of the tips, with D1 active: length 1 of the tool in the table must be its length.",
}
_Z_OF_PROBE = {
    "gauge_line": "Z of a program is that of the gauge line: length 1 of the probe in the table must be 0. Nothing on "
    "the control checks how long the probe really is: one that is longer touches late or runs into the work. After "
    "another stylus or tip it must be calibrated, and the program written anew.",
    "tip": "Z of a program is that of the center of the tip, with D1 active: length 1 of the probe in the tool table "
    "must be its length.",
}


#: What else stops a program of a work before its first motion.
UNDER_THE_WORK = ", and where it may be under the work"


def references(
    page: Page,
    machine: MillingMachine,
    tips: str,
    length: float,
    length_name: str,
    more: str,
    more_before: str = UNDER_THE_WORK,
) -> None:
    """Table and sentences; ``tips`` is the end of the tool, ``length`` [mm] its length, with the name of its key.

    ``more`` says what else the program stops for, ``more_before`` for what before its first motion.
    """
    above = machine.home - machine.gauge_line_height
    offsets = " ".join(f"{axis}{value:g}" for axis, value in zip(AXES, machine.work_offset_values, strict=True))
    pivot, control = ", ".join(f"{value:g}" for value in machine.pivot_offset), machine.control
    tool, modes = ("tool", _Z_MODES) if tips == CUTTER_TIP else ("probe", _Z_OF_PROBE)
    by_program = machine.z_reference == "tip"
    checked = f"by the program: length 1 = {length:g}" if by_program else f"by hand: measure the {tool}"
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
            [
                "increments per mm, per degree",
                f"{control.increments_per_mm}, {control.increments_per_degree}",
                "",
                "by the program, at least",
            ],
            ["travel of X, Y, Z", ", ".join(_travel(machine, axis) for axis in "XYZ"), "mm", ""],
            ["travel of A, B", ", ".join(_travel(machine, axis) for axis in "AB"), "°", ""],
        ],
    )
    page.paragraph(
        f"{modes[machine.z_reference]} The zero of {machine.work_offset} is on the B axis in X and Y; in Z it is "
        "where the gauge line reads 0. A turns the work clockwise, seen from its back towards the pitch apex. At B = 0 "
        "the work axis is level, with the toe of the teeth towards X+; B lowers the back."
    )
    page.paragraph(
        "The program stops with a message before its first motion where the basic system is not metric, where the "
        f"increments are fewer or {machine.work_offset}, with all frames, is not as above, where a frame turns, "
        f"mirrors or scales{more_before}; after a tool change, where the name of the {tool} or its length 1 is another "
        f"one; {more}."
    )


def _travel(machine: MillingMachine, axis: str) -> str:
    travel = getattr(machine.axes, axis).travel
    return "without end" if travel is None else f"{travel[0]:g} to {travel[1]:g}"

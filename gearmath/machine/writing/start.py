"""How every program begins and ends: all modal states set, what it relies on checked, the tool up before all else.

What the program can read of the control it compares with the machine file, and stops with a message and an alarm
before the first motion where they differ. Then Z goes up in machine coordinates, all offsets off, from wherever the
axes stand. Names of system variables that no page of a manual at hand confirms: $P_ACTFRAME[axis,TR|RT|MI|SC],
$TC_TP2[$P_TOOLNO], $P_TOOLL[1], $MN_INT_INCR_PER_MM, $MN_INT_INCR_PER_DEG [unconfirmed].
"""

from __future__ import annotations

from collections.abc import Iterator

from gearmath.machine.planning.clear_space import Room
from gearmath.machine.writing.words import Positions
from gearmath.specs.milling_machine import AXES, MillingMachine

#: FGREF with which a degree counts as a mm.
ONE_MM_A_DEGREE = "57.29578"
#: Alarms of the start.
NOT_METRIC, INCREMENTS, OFFSET, TOOL_NAME, TOOL_LENGTH, TOO_LOW = 65010, 65011, 65012, 65013, 65014, 65015
#: What a zero offset, and a tool length in the table that should be as the machine file has it, may differ by. [mm]
_SAME, _SAME_LENGTH = 0.0005, 1.0


def stop(why: str, alarm: int, place: str = "") -> Iterator[str]:
    """The end of the program within an IF. How the control reacts to SETAL is a setting: M30 stops it for sure.

    ``place`` is an expression that the message begins with.
    """
    yield f'MSG({place}"{why}")'
    yield f"SETAL({alarm})"
    yield "M30"
    yield "ENDIF"


def _off(name: str, value: float) -> str:
    """By how much a variable differs from a value."""
    return f"ABS({name}{-value:+.5f})" if value else f"ABS({name})"


def modal(machine: MillingMachine) -> str:
    """The block that states plane, compensation, dimensions, feed, units, offset, path mode and acceleration."""
    return " ".join((f"G17 G40 G90 G94 G710 {machine.work_offset}", *machine.control.words))


def head(machine: MillingMachine, curved: str = "") -> Iterator[str]:
    """Every modal state that acts on the path, none inherited: transformation, compressor and frames off.

    The path of polynomials is that of all axes that are ``curved``: what FGROUP leaves out follows it as UPATH or SPATH
    say.
    """
    yield modal(machine)
    yield "TRAFOOF"
    yield "COMPOF"
    yield "DIAMOF"
    yield "TRANS"
    if curved:
        yield f"FGROUP({','.join(curved)})"
        yield " ".join(f"FGREF[{axis}]={ONE_MM_A_DEGREE}" for axis in curved[3:])
    else:
        yield "FGROUP(X,Y,Z)"
    yield "OVR=100 OVRRAP=100"
    yield " ".join(f"ACC[{axis}]=100" for axis in AXES)
    yield "STOPRE"


def checks(machine: MillingMachine) -> Iterator[str]:
    """Units, increments and zero offset as the machine file has them."""
    yield "IF $MN_SCALING_SYSTEM_IS_METRIC<>1"
    yield from stop("the control's basic system is not metric", NOT_METRIC)
    control = machine.control
    needed = {"MM": control.increments_per_mm, "DEG": control.increments_per_degree}
    for unit, value in needed.items():
        name = f"$MN_INT_INCR_PER_{unit}"
        yield f"IF {name}<{value}"
        yield from stop(f"{name[1:]} is less than {value}, as in the machine file", INCREMENTS)
    values = list(zip(AXES, machine.work_offset_values, strict=True))
    yield "IF " + " OR ".join(f"({_off(f'$P_ACTFRAME[{axis},TR]', value)}>{_SAME})" for axis, value in values)
    wanted = " ".join(f"{axis}{value:g}" for axis, value in values)
    yield from stop(f"{machine.work_offset} with all frames must be {wanted}", OFFSET)
    for part, value in (("RT", 0), ("MI", 0), ("SC", 1)):
        yield "IF " + " OR ".join(f"($P_ACTFRAME[{axis},{part}]<>{value})" for axis in "XYZ")
        yield from stop(f"{machine.work_offset} with all frames must not turn, mirror or scale", OFFSET)


def enough_height(machine: MillingMachine, room: Room, length: float, radius: float) -> Iterator[str]:
    """Stops where the tool may stand under the work, so that it would meet it on its way up.

    It cannot where its tip is above all of the work, nor where the whole tool, up to its ``radius`` [mm], is in front
    of the work or beside it. The tool is ``length`` mm long, or as long as the tool table says if that is more.
    """
    x, y, z = machine.work_offset_values[:3]
    level = machine.gauge_line_height + room.top + z
    high = level + length
    low = f"(($AA_IM[Z]<{high:.3f}) OR ($AA_IM[Z]-$P_TOOLL[1]<{level:.3f}))"
    near = f"($AA_IM[X]<{room.front + radius + x:.3f}) AND ({_off('$AA_IM[Y]', y)}<{room.half + radius:.3f})"
    yield f"IF {low} AND {near}"
    yield from stop(f"Z is below {high:.0f}: raise Z by hand, the tool may be under the work", TOO_LOW)


def retract(machine: MillingMachine) -> Iterator[str]:
    """Z up to its home in machine coordinates: no offset, no tool length."""
    yield "D0"
    home = machine.home + machine.work_offset_values[2]
    yield f"G0 SUPA {Positions.of(machine, 0.0).word('Z', home)}"


def fetch(machine: MillingMachine, tool: str, length: float) -> Iterator[str]:
    """Tool change, and the tool that is in the spindle then compared with the one that is meant."""
    yield f'T="{tool}" D1'
    yield "M6"
    yield "D1"
    yield "STOPRE"
    yield f'IF $TC_TP2[$P_TOOLNO]<>"{tool}"'
    yield from stop(f"the tool in the spindle is not {tool}", TOOL_NAME)
    wanted, near = (length, _SAME_LENGTH) if machine.z_reference == "tip" else (0.0, _SAME)
    yield f"IF {_off('$P_TOOLL[1]', wanted)}>{near}"
    yield from stop(f"length 1 of {tool} in the tool table must be {wanted:g}", TOOL_LENGTH)
    yield from retract(machine)
    yield "D1"


def dwell(seconds: float) -> Iterator[str]:
    """Time for the spindle to be at speed."""
    if seconds > 0.0:
        yield f"G4 F{seconds:.1f}"


def end(machine: MillingMachine) -> Iterator[str]:
    """Spindle and coolant off, Z home, end."""
    yield "M5 M9"
    yield from retract(machine)
    yield "M30"

"""An example of what LinuxCNC needs to run a program: INI, HAL, tool table and parameter file of a simulated machine.

Axes, speeds and accelerations are those of the machine file. Nothing drives a motor: positions are fed back as they
are commanded, so that a program can be tried without a machine.
"""

from __future__ import annotations

from gearmath.specs.milling_machine import AXES, CUTTER_AXIS, MillingMachine, TravelAxis, TurningAxis

#: Of the files that are written.
SUFFIXES = (".ini", ".hal", ".tbl", ".var")
#: Signals of the handshake, by what they are for: pins of motion that a host reads and sets.
HOST = {
    "gearmath-acknowledged": "motion.analog-in-00",
    "gearmath-first": "motion.analog-in-01",
    "gearmath-last": "motion.analog-in-02",
    "gearmath-host": "motion.digital-in-00",
}
#: Travel of an axis that turns without end. [degrees]
_ENDLESS = 1e9
#: Parameters that LinuxCNC keeps: those that it must, and the number of the last run.
_KEPT = (5161, 5181, *range(5210, 5401, 1))
RUN = 3102


def configuration(name: str, machine: MillingMachine, tools: dict[str, tuple[int, float]]) -> dict[str, str]:
    """The texts of the files ``name``.ini, .hal, .tbl and .var by suffix; tools by name: number and length [mm]."""
    return {
        ".ini": _ini(name, machine),
        ".hal": _hal(machine),
        ".tbl": "".join(f"T{k} P{k} Z{length:.5f} ; {tool}\n" for tool, (k, length) in tools.items()),
        ".var": _parameters(machine),
    }


def _axes(machine: MillingMachine) -> dict[str, TravelAxis | TurningAxis]:
    found: dict[str, TravelAxis | TurningAxis] = {axis: getattr(machine.axes, axis) for axis in AXES}
    if machine.axes.C is not None:
        found[CUTTER_AXIS] = machine.axes.C
    return found


def _ini(name: str, machine: MillingMachine) -> str:
    axes = _axes(machine)
    letters = "".join(axes)
    fastest = max(axes[axis].max_speed_per_min for axis in "XYZ") / 60.0
    quickest = max(axes[axis].max_acceleration for axis in "XYZ")
    lines = [
        "[EMC]",
        "VERSION = 1.1",
        f"MACHINE = {machine.name}",
        "[DISPLAY]",
        "DISPLAY = axis",
        "[TASK]",
        "TASK = milltask",
        "CYCLE_TIME = 0.001",
        "[RS274NGC]",
        f"PARAMETER_FILE = {name}.var",
        "[EMCMOT]",
        "EMCMOT = motmod",
        "COMM_TIMEOUT = 1.0",
        "SERVO_PERIOD = 1000000",
        "[EMCIO]",
        "EMCIO = io",
        "CYCLE_TIME = 0.100",
        f"TOOL_TABLE = {name}.tbl",
        "[HAL]",
        f"HALFILE = {name}.hal",
        "[TRAJ]",
        f"COORDINATES = {letters}",
        "LINEAR_UNITS = mm",
        "ANGULAR_UNITS = degree",
        f"MAX_LINEAR_VELOCITY = {fastest:g}",
        f"MAX_LINEAR_ACCELERATION = {quickest:g}",
        f"DEFAULT_LINEAR_VELOCITY = {fastest / 10:g}",
        "NO_FORCE_HOMING = 1",
        "[KINS]",
        f"KINEMATICS = trivkins coordinates={letters}",
        f"JOINTS = {len(axes)}",
    ]
    for joint, (letter, axis) in enumerate(axes.items()):
        offset = machine.work_offset_values[joint] if joint < len(AXES) else 0.0
        low, high = axis.travel or (-_ENDLESS, _ENDLESS)
        limits = [
            f"MIN_LIMIT = {low + offset:g}",
            f"MAX_LIMIT = {high + offset:g}",
            f"MAX_VELOCITY = {axis.max_speed_per_min / 60.0:g}",
            f"MAX_ACCELERATION = {axis.max_acceleration:g}",
        ]
        home = machine.home + offset if letter == "Z" else 0.0
        kind = "LINEAR" if letter in "XYZ" else "ANGULAR"
        lines += [f"[AXIS_{letter}]", *limits, f"[JOINT_{joint}]", f"TYPE = {kind}", *limits]
        lines += [f"HOME = {home:g}", f"HOME_OFFSET = {home:g}", "HOME_SEQUENCE = 0", "FERROR = 1", "MIN_FERROR = 1"]
    return "\n".join(lines) + "\n"


def _hal(machine: MillingMachine) -> str:
    count = len(_axes(machine))
    lines = [
        "# A simulated machine: every joint is where it is commanded to be. Connect drives, spindle and probe here.",
        "loadrt [KINS]KINEMATICS",
        "loadrt [EMCMOT]EMCMOT servo_period_nsec=[EMCMOT]SERVO_PERIOD num_joints=[KINS]JOINTS num_aio=16",
        "addf motion-command-handler servo-thread",
        "addf motion-controller servo-thread",
        *(f"net joint-{k} joint.{k}.motor-pos-cmd joint.{k}.motor-pos-fb" for k in range(count)),
        "net estop-loop iocontrol.0.user-enable-out iocontrol.0.emc-enable-in",
        "net tool-prepared iocontrol.0.tool-prepare iocontrol.0.tool-prepared",
        "net tool-changed iocontrol.0.tool-change iocontrol.0.tool-changed",
        "net probe motion.probe-input",
        "setp spindle.0.at-speed TRUE",
        "# Set by a host that takes the touches: the point that it has kept, the parts to touch, and that it is there.",
        *(f"net {signal} {pin}" for signal, pin in HOST.items()),
    ]
    return "\n".join(lines) + "\n"


def _parameters(machine: MillingMachine) -> str:
    first = {"G54": 5221, "G55": 5241, "G56": 5261, "G57": 5281}[machine.work_offset]
    values = dict.fromkeys((RUN, *_KEPT), 0.0)
    values[5220] = float(int(machine.work_offset[1:]) - 53)
    values |= {first + k: value for k, value in enumerate(machine.work_offset_values)}
    return "".join(f"{number}\t{value:.6f}\n" for number, value in sorted(values.items()))

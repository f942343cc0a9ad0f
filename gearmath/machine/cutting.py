"""From the settings of a member to the text of its cutting program."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from gearmath import __version__
from gearmath.bevel.method import require_plain
from gearmath.machine.path import DEFAULT_TOLERANCE, Cut, axis_positions, roll_nodes
from gearmath.machine.program import Pass, block_seconds, write_program
from gearmath.specs.bevel_set import BevelSet, settings_sha256
from gearmath.specs.milling_machine import MillingMachine

#: Speed of the cutter centre along its path while generating. [mm/min]
DEFAULT_FEED = 300.0
DEFAULT_SPINDLE_RPM = 120.0
#: Retract above the highest pass. [mm]
CLEARANCE = 40.0


def tooth_angles(teeth: int, correction: Sequence[float] = ()) -> np.ndarray:
    """Angle (z,) [rad] of each tooth space about z_w, from its number and never summed; ``correction`` in degrees."""
    return 2 * math.pi * np.arange(teeth) / teeth + np.radians(correction if len(correction) else np.zeros(teeth))


def cutting_program(
    bevel_set: BevelSet,
    name: str,
    machine: MillingMachine,
    program_name: str,
    spaces: Sequence[int] = (0,),
    tolerance: float = DEFAULT_TOLERANCE,
    feed: float = DEFAULT_FEED,
    spindle_rpm: float = DEFAULT_SPINDLE_RPM,
) -> str:
    """The program that cuts tooth ``spaces`` of a member; ``tolerance`` [mm] along the tooth normal, feed [mm/min].

    Raises InputError for singular poses, travel and speed limits, and a tolerance out of range.
    """
    member = bevel_set.member(name)
    require_plain(member, name, "a cutting program")
    angles = tooth_angles(member.teeth, member.index_correction)
    passes = []
    for cut in Cut.of(member, name):
        theta = roll_nodes(member, cut, tolerance, machine.pivot_height)
        axes = axis_positions(member.flank(cut.flanks[0]), theta, machine.pivot_height)
        seconds = block_seconds(axes, machine, feed)
        for space in spaces:
            indexed = axes + np.array([0, 0, 0, angles[space], 0])
            passes.append(Pass(cut.tool, f"space {space} {' and '.join(cut.flanks)}", int(space), indexed, seconds))
    header = (
        f"gearmath {__version__} cutting program",
        f"set: {_plain(bevel_set.title)}",
        f"member: {name}, {member.teeth} teeth, {member.hand} hand, {member.cutting.replace('_', ' ')}",
        f"settings sha256: {settings_sha256(member)}",
        f"flank tolerance: {tolerance * 1000:g} um along the tooth normal",
        f"machine: {_plain(machine.name)}",
    )
    return write_program(program_name, header, passes, machine, spindle_rpm, CLEARANCE)


def _plain(text: str) -> str:
    """Free text as it may stand in an NC comment: printable ASCII, other characters as '?'."""
    return "".join(character if " " <= character <= "~" else "?" for character in text)

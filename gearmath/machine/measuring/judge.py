"""Whether a probe survives a program, and the program writes what it touches: all that is checked of one, in one place.

:mod:`gearmath.machine.measuring.collision_check` looks besides at what tip, stylus and spindle come near.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from gearmath.bevel.flank import blank_grid
from gearmath.errors import InputError
from gearmath.machine.bodies.probe_tip import probe_height
from gearmath.machine.control.executor import parsed
from gearmath.machine.control.state import Probe, Setup
from gearmath.machine.control.text import is_for_linuxcnc
from gearmath.machine.judging.faults import Fault, first_of_each
from gearmath.machine.judging.outside import outside_faults
from gearmath.machine.judging.start_state import start_faults
from gearmath.machine.measuring.artefacts import Artefacts
from gearmath.machine.measuring.guards import guard_faults
from gearmath.machine.measuring.parts import part_faults, parts_of
from gearmath.machine.measuring.probe_run import check_ended
from gearmath.machine.measuring.reactions import host_faults, reaction_faults
from gearmath.machine.measuring.records import Place, record_faults
from gearmath.machine.measuring.ways import Way, at_the_ends, watched
from gearmath.machine.planning.clear_space import clear_height, room_of
from gearmath.machine.planning.targets import targets_of_space
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.calibration import Calibration
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.touch_csv import RING, WORK_SPHERE

#: A touch may be searched for this far beside the line on which its place is [mm], A and B be turned by this [rad].
_BESIDE, _TURNED = 0.1, math.radians(0.05)
#: A surface is met where the tip is this near to it. [mm]
_MET = 1e-3
_CLEARANCE = 1.0


def judge_probing(
    text: str,
    name: str,
    member: Member,
    machine: MillingMachine,
    calibration: Calibration,
    progress: Callable[[int], object] = lambda ways: None,
) -> list[Fault]:
    """Faults of a program that probes a member. Raises InputError for a text that cannot be run.

    Raises ComputationError where it sets an alarm.
    """
    tip = calibration.length + calibration.tip_radius - calibration.offset[2]
    clear = clear_height(room_of(member, machine, machine.fixture), machine, tip)
    place = _on_flanks(member, machine, calibration)
    return _judged(text, name, machine, calibration, at_the_ends, clear, clear, place, progress)


def judge_calibration(
    text: str,
    name: str,
    machine: MillingMachine,
    calibration: Calibration,
    progress: Callable[[int], object] = lambda ways: None,
) -> list[Fault]:
    """Faults of a program that touches ring and spheres. Raises InputError for a text that cannot be run.

    Raises ComputationError where it sets an alarm.
    """
    there, free = Artefacts(machine, calibration), machine.home
    if calibration.work_sphere is not None and WORK_SPHERE in text:
        sphere = calibration.work_sphere
        farthest = float(np.linalg.norm(sphere.place) + np.linalg.norm(machine.pivot)) + sphere.diameter / 2
        height = probe_height(machine, calibration) - calibration.offset[2] + calibration.tip_radius
        free = min(free, height + farthest + _CLEARANCE)
    return _judged(text, name, machine, calibration, there, free, free, _on_artefacts(there), progress)


def _judged(
    text: str,
    name: str,
    machine: MillingMachine,
    calibration: Calibration,
    probe: Probe,
    clear: float,
    free: float,
    place: Place,
    progress: Callable[[int], object],
) -> list[Fault]:
    setup = Setup.of(machine, calibration.length)
    seen = watched(text, name, probe, setup)
    check_ended(seen.run, name)
    if not seen.ways:
        raise InputError(f"{name}: touches nothing: no touch is measured before its end")
    size = max((len(content) for content in seen.run.files.values()), default=0) / 1000
    linuxcnc = is_for_linuxcnc(text)
    found = [] if linuxcnc else [*outside_faults(parsed(text, name))]
    found += guard_faults(seen, machine, clear, free)
    found += [*record_faults(text, seen, place), *start_faults(text, machine, calibration.length, size)]
    if found:  # what follows counts on a program that is right where nothing goes wrong
        return first_of_each(found)
    parts = parts_of(text, name, probe, seen, setup)
    if isinstance(parts, Fault):
        return [parts]
    done = set[int]()
    for part in parts:
        found += reaction_faults(text, name, part.seen, setup, part.parameters, done, progress)
    found += [] if linuxcnc else [*host_faults(text, name, seen, setup)]
    found += [*part_faults(text, name, probe, seen, parts, setup)]
    return first_of_each(found)


def _on_flanks(member: Member, machine: MillingMachine, calibration: Calibration) -> Place:
    """Whether a touch is searched for on the line of the place that is written of it."""
    known = {}
    for flank in FLANKS:
        targets = targets_of_space(member, flank, blank_grid(member), machine, calibration)
        for k in range(len(targets)):
            known[flank, str(targets.row[k]), str(targets.col[k])] = targets.start[k], targets.end[k]

    def place(cells: dict[str, str], way: Way) -> str:
        where = cells["flank"], cells["row"], cells["col"]
        if cells["member"] != member.name or where not in known or not cells["tooth"].isdecimal():
            return "there is no such place"
        start, end = known[where]
        turn = 2 * math.pi * (int(cells["tooth"]) % member.teeth) / member.teeth
        along = (end - start)[:3] / np.linalg.norm((end - start)[:3])
        beside = max(
            float(np.linalg.norm(off - off @ along * along))
            for off in ((one - start)[:3] for one in (way.start, way.end))
        )
        turned = way.end[3:] - start[3:] - [turn, 0.0]
        turned -= 2 * math.pi * np.round(turned / (2 * math.pi))
        if beside > _BESIDE or np.abs(turned).max() > _TURNED:
            off = f"{beside:.3f} mm and {math.degrees(np.abs(turned).max()):.3f} degrees"
            return f"it lies {off} beside the line of {' '.join(where)} of tooth {cells['tooth']}"
        return ""

    return place


def _on_artefacts(there: Artefacts) -> Place:
    """Whether a touch has met the surface that is written of it."""

    def place(cells: dict[str, str], way: Way) -> str:
        gap = there.gap_of(cells["target"])
        if gap is None or way.met is None or not abs(float(gap(way.met[None])[0])) < _MET:
            return f"it did not meet the {cells['target']}"
        ring = there.calibration.ring
        if ring is not None and cells["target"] in RING:  # the bore of the model has no end in Z
            off = float(way.met[2] + there.calibration.offset[2] - ring.center[2])
            if abs(off) > _BESIDE:
                return f"it is {off:+.3f} mm off the height at which the tip stands in the ring"
        side = {"ring_x_low": (0, -1), "ring_x_high": (0, 1), "ring_y_low": (1, -1), "ring_y_high": (1, 1)}
        axis, sign = side.get(cells["target"], (0, 0))
        return "" if sign == 0 or (way.end - way.start)[axis] * sign > 0.0 else f"it is not the {cells['target']}"

    return place

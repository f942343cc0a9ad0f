"""The program that finds the rotary axes: a sphere on the work side, touched at several positions of A and B.

B goes from the horizontal work spindle to the vertical one, and at each of its positions A turns the sphere to the top
and to both sides of it. Between positions the tip is above all that the sphere can reach.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gearmath.errors import InputError
from gearmath.machine.bodies.probe_tip import probe_height
from gearmath.machine.planning.artefact_targets import axis_sections, sphere_positions, work_sphere_directions
from gearmath.machine.planning.targets import APPROACH, CLEARANCE
from gearmath.machine.writing.calibrating import touch_sphere
from gearmath.machine.writing.probe_words import Blocks, ProbingPlan
from gearmath.specs.calibration import Calibration, WorkSphere
from gearmath.specs.milling_machine import AXES, UNITS, UNITS_PER_INTERNAL, MillingMachine
from gearmath.specs.touch_csv import CALIBRATION_COLUMNS, WORK_SPHERE
from gearmath.version import __version__


def axis_program(
    machine: MillingMachine, calibration: Calibration, program_name: str, dialect: type[Blocks] = Blocks
) -> str:
    """The program that touches the sphere on the work side, where the machine file expects it, in a dialect.

    Raises InputError if the calibration file has none, and for positions out of travel.
    """
    sphere = calibration.work_sphere
    if sphere is None:
        raise InputError("the calibration file has no work_sphere: there is nothing to touch")
    centers = sphere_positions(machine, calibration, sphere)
    anywhere = above_all(machine, calibration, sphere)
    _check_travel(centers, anywhere, sphere, calibration, machine)
    if machine.home < anywhere:
        raise InputError(
            f"home of Z = {machine.home:g} mm: the tip clears the sphere at every A and B from Z {anywhere:.1f} mm on"
        )
    blocks = dialect(program_name, machine, calibration.length)
    header = (
        f"gearmath {__version__} calibration program of the rotary axes",
        f"machine: {machine.name}",
        f"probe: {calibration.name}, tip radius {calibration.tip_radius:g} mm, length {calibration.length:g} mm",
        f"work: sphere of {sphere.diameter:g} mm, {sphere.axial:g} mm from the pitch apex along the work axis and "
        f"{sphere.radius:g} mm off it, at {sphere.azimuth:g} degrees",
    )

    above = f"G0 {blocks.length('Z', anywhere)}"
    sections = axis_sections(machine, calibration, sphere)
    plan = ProbingPlan.of_sections([one.touches for one in sections])

    def body() -> Iterator[str]:
        yield from blocks.start(plan, CALIBRATION_COLUMNS)
        for number, (section, center) in enumerate(zip(sections, centers, strict=True), 1):  # the first one from home
            way = (*_position(blocks, center, sphere, calibration), above)
            yield from blocks.section(plan, number, section.what, way)
        yield from blocks.end()

    return blocks.text(header, body())


def _position(blocks: Blocks, center: np.ndarray, sphere: WorkSphere, calibration: Calibration) -> Iterator[str]:
    """The touches with A and B at one position, from above all that the sphere can reach."""
    before = center - blocks.machine.one_sided * np.array([0.0, 0.0, 0.0, 1.0, 0.0])
    if blocks.machine.one_sided:
        yield f"G0 {' '.join(word for word in blocks.axes(before) if word[0] != 'Z')}"
    yield f"G0 {' '.join(word for word in blocks.axes(center) if word[0] != 'Z')}"
    level = center[2] + sphere.diameter / 2 + calibration.tip_radius + CLEARANCE
    directions = work_sphere_directions(center, sphere, calibration)
    yield from touch_sphere(blocks, calibration, center[:3], sphere.diameter, directions, level, WORK_SPHERE)


def above_all(machine: MillingMachine, calibration: Calibration, sphere: WorkSphere) -> float:
    """Z [mm] at which the tip is above the sphere wherever A and B turn it."""
    farthest = float(np.linalg.norm(sphere.place) + np.linalg.norm(machine.pivot)) + sphere.diameter / 2
    height = probe_height(machine, calibration) - calibration.offset[2]
    return height + farthest + calibration.tip_radius + CLEARANCE


def _check_travel(
    centers: np.ndarray, anywhere: float, sphere: WorkSphere, calibration: Calibration, machine: MillingMachine
) -> None:
    """Raise InputError naming position, axis and limit where the sphere, or the height above it, is out of travel."""
    low, high = machine.travel.T
    reach = (sphere.diameter / 2 + calibration.tip_radius + APPROACH) * np.array([1.0, 1.0, 1.0, 0.0, 0.0])
    least, most = (centers - reach).min(axis=0), (centers + reach).max(axis=0)
    most[2] = max(most[2], anywhere)
    for axis, name in enumerate(AXES):
        if least[axis] < low[axis] or most[axis] > high[axis]:
            scale = UNITS_PER_INTERNAL[axis]
            raise InputError(
                f"work_sphere: axis {name} = {least[axis] * scale:.3f} to {most[axis] * scale:.3f} {UNITS[axis]}: "
                f"{machine.name} travels {low[axis] * scale:g} to {high[axis] * scale:g} {UNITS[axis]}"
            )

"""Calibration programs: a ring for radius and offset of the tip, its face for that in Z, a sphere for all of it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gearmath.errors import InputError
from gearmath.machine.planning.artefact_targets import FACE_SIDES, PAIRS, sphere_directions, tip_sections
from gearmath.machine.planning.targets import APPROACH, APPROACH_FEED, CLEARANCE, MEASURING_FEED
from gearmath.machine.writing.probe_words import STILL, Blocks, ProbingPlan
from gearmath.specs.calibration import Calibration, Face, Ring
from gearmath.specs.milling_machine import AXES, UNITS, UNITS_PER_INTERNAL, MillingMachine
from gearmath.specs.touch_csv import CALIBRATION_COLUMNS, RING_FACE, SPHERE
from gearmath.version import __version__

#: Numbers that the program keeps: the middle of the ring, and where two sides of it were met.
_CENTER = {"X": 10, "Y": 11}
_SIDES = 12, 13


def calibration_program(
    machine: MillingMachine, calibration: Calibration, program_name: str, dialect: type[Blocks] = Blocks
) -> str:
    """The program that touches ring and sphere, as far as the calibration file has them, in the words of a dialect.

    Raises InputError if it has neither, and for positions out of travel.
    """
    if calibration.ring is None and calibration.sphere is None:
        raise InputError("the calibration file has neither ring nor sphere: there is nothing to touch")
    blocks = dialect(program_name, machine, calibration.length)
    header = (f"gearmath {__version__} calibration program", f"machine: {machine.name}", f"probe: {calibration.name}")

    level, top = sideways_level(machine, calibration), blocks.length("Z", float(machine.travel[2, 1]))
    ring, sphere, ways = calibration.ring, calibration.sphere, []
    if ring is not None:
        ways.append(_ring(blocks, calibration, ring, level))
        if ring.face is not None:
            ways.append(_face(blocks, calibration, ring, ring.face, level))
    if sphere is not None:
        center, directions = np.array(sphere.center) - calibration.tip_offset, sphere_directions()
        ways.append(touch_sphere(blocks, calibration, center, sphere.diameter, directions, level, SPHERE))
    sections = tip_sections(calibration)
    plan = ProbingPlan.of_sections([one.touches for one in sections])

    def body() -> Iterator[str]:
        yield from blocks.start(plan, CALIBRATION_COLUMNS)
        yield f"G0 {top}"
        yield f"G0 {' '.join(blocks.axes(np.zeros(5))[3:])}"
        for number, (section, touches) in enumerate(zip(sections, ways, strict=True), 1):
            yield from blocks.section(plan, number, section.what, (*touches, f"G0 {top}"))
        yield from blocks.end()

    return blocks.text(header, body())


def sideways_level(machine: MillingMachine, calibration: Calibration) -> float:
    """Z of all sideways motion: well above ring and sphere. Raises InputError where the travel does not allow it."""
    ring, sphere = calibration.ring, calibration.sphere
    heights = [0.0 if ring is None else ring.center[2] + calibration.stylus_length]
    if ring is not None and ring.face is not None:
        heights.append(ring.face.seat + ring.face.height + calibration.tip_radius + CLEARANCE)
    if sphere is not None:
        heights.append(sphere.center[2] + sphere.diameter / 2 + calibration.tip_radius + CLEARANCE)
    level = max(heights) - min(calibration.offset[2], 0.0)
    low, high = machine.travel.T
    for place in (ring, sphere):
        if place is None:
            continue
        reach = place.diameter / 2 + calibration.tip_radius + APPROACH
        if isinstance(place, Ring) and place.face is not None:
            reach = max(reach, (place.diameter + place.face.width) / 2)
        for axis, (least, most) in enumerate(
            (
                (place.center[0] - reach, place.center[0] + reach),
                (place.center[1] - reach, place.center[1] + reach),
                (place.center[2], level),
            )
        ):
            if least < low[axis] or most > high[axis]:
                scale = UNITS_PER_INTERNAL[axis]
                raise InputError(
                    f"{type(place).__name__.lower()}: axis {AXES[axis]} = {least:.3f} to {most:.3f} {UNITS[axis]}: "
                    f"{machine.name} travels {low[axis] * scale:g} to {high[axis] * scale:g} {UNITS[axis]}"
                )
    return level


def _ring(blocks: Blocks, calibration: Calibration, ring: Ring, level: float) -> Iterator[str]:
    """Touches along X, along Y through the middle found, and along X again through the middle of these."""
    x, y, z = np.array(ring.center) - calibration.tip_offset
    reach = ring.diameter / 2 - calibration.tip_radius + calibration.overtravel
    yield f"G0 {blocks.length('X', x)} {blocks.length('Y', y)}"
    yield from blocks.lowered(blocks.length("Z", level))
    yield from blocks.guarded(blocks.length("Z", z), APPROACH_FEED, level)
    yield blocks.kept([(_CENTER["X"], blocks.number(x)), (_CENTER["Y"], blocks.number(y))])
    middle = " ".join(blocks.at(axis, number) for axis, number in _CENTER.items())
    for axis, pair in (("X", PAIRS[0]), ("Y", PAIRS[1]), ("X", PAIRS[0])):
        center = _CENTER[axis]
        for sign, store, target in zip("-+", _SIDES, pair, strict=True):
            to = blocks.at(axis, center, f"{sign}{blocks.number(reach)}")
            end = f"{to} Y=IC(0) Z=IC(0)" if axis == "X" else f"X=IC(0) {to} Z=IC(0)"
            yield from blocks.touch(end, middle, MEASURING_FEED, APPROACH_FEED, level, up=False)
            yield blocks.kept([(store, blocks.measured(axis))])
            yield from blocks.hand_over(target)
        yield blocks.kept([(center, blocks.middle(*_SIDES))])
        yield f"G1 {middle} F{APPROACH_FEED:.3f}"


def _face(blocks: Blocks, calibration: Calibration, ring: Ring, face: Face, level: float) -> Iterator[str]:
    """Touches from above in the middle of the wall, at the four sides of the bore."""
    x, y, _ = np.array(ring.center) - calibration.tip_offset
    height = face.seat + face.height + calibration.tip_radius - calibration.tip_offset[2]
    away = (ring.diameter + face.width) / 2
    for number, (to_x, to_y) in enumerate(FACE_SIDES):
        place = f"{blocks.length('X', x + to_x * away)} {blocks.length('Y', y + to_y * away)}"
        start = blocks.length("Z", height + APPROACH)
        if number:
            yield from blocks.aside(f"{place} {STILL}")
        else:  # from the top of Z
            yield f"G0 {place}"
            yield from blocks.lowered(blocks.length("Z", level))
        yield from blocks.guarded(start, APPROACH_FEED, level)
        end = f"X=IC(0) Y=IC(0) {blocks.length('Z', height - calibration.overtravel)}"
        yield from blocks.touch(end, start, MEASURING_FEED, APPROACH_FEED, level)
        yield from blocks.hand_over(RING_FACE)


def touch_sphere(
    blocks: Blocks,
    calibration: Calibration,
    center: np.ndarray,
    diameter: float,
    directions: np.ndarray,
    level: float,
    target: str,
) -> Iterator[str]:
    """Touches along the normals of a sphere; from the top of Z, and down to each of them outside of the sphere.

    ``center`` (3,) is X Y Z with the tip's centre in that of the sphere; ``level`` is the Z of sideways motion.
    """
    reach = diameter / 2 + calibration.tip_radius
    place = " ".join(blocks.axes(np.array([*center, 0.0, 0.0]))[:2])
    yield f"G0 {place}"
    yield from blocks.lowered(blocks.length("Z", level))
    for direction in directions:
        start, end = (center + (reach + off) * direction for off in (APPROACH, -calibration.overtravel))
        x, y, z, *_ = blocks.axes(np.array([*start, 0.0, 0.0]))
        if f"{x} {y}" != place:
            place = f"{x} {y}"
            yield from blocks.aside(f"{place} {STILL}")
        yield from blocks.guarded(z, APPROACH_FEED, level)
        way = " ".join(blocks.axes(np.array([*end, 0.0, 0.0]))[:3])
        yield from blocks.touch(way, f"{x} {y} {z}", MEASURING_FEED, APPROACH_FEED, level)
        yield from blocks.hand_over(target)

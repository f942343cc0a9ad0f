"""Ring and spheres that a probe is calibrated on, to scale: from above, in section, and as B turns that of the work."""

from __future__ import annotations

import math

import numpy as np

from gearmath.machine.planning.artefact_targets import sphere_positions
from gearmath.setup_sheet.machine_drawing import places_at
from gearmath.setup_sheet.svg import LETTER, WIDTH, Drawing
from gearmath.specs.calibration import Calibration, Ring, Sphere, WorkSphere
from gearmath.specs.milling_machine import MillingMachine

#: Greatest height of a drawing, room beside and above for words. [px]
_HEIGHT, _WORDS, _ABOVE, _SIDE = 330.0, 170.0, 46.0, 70.0
#: Of a ring whose height and wall the file does not have, above and below the touches, and in width; of a stem. [mm]
_UNKNOWN, _STEM = 5.0, 40.0


def plan_drawing(probe: Calibration) -> str:
    """As SVG: ring and sphere from above, X to the right and Y up, with their places from the zero of X and Y."""
    bodies = [(name, one) for name, one in (("ring", probe.ring), ("sphere", probe.sphere)) if one is not None]
    radii = {name: _outside(one) for name, one in bodies}
    corners = [(0.0, 0.0)]
    for name, one in bodies:
        corners += [(one.center[0] + sign * radii[name], one.center[1] + sign * radii[name]) for sign in (-1, 1)]
    (left, bottom), (right, top) = np.min(corners, axis=0), np.max(corners, axis=0)
    scale = min(_HEIGHT / (top - bottom), (WIDTH - 2 * _SIDE) / (right - left))
    drawing = Drawing(left, bottom - _ABOVE / scale, top, scale, (_SIDE, _ABOVE))
    drawing.dot("zero", 0.0, 0.0, 6.0, filled=False)
    zx, zy = drawing.at(0.0, 0.0)
    drawing.words(zx, zy + (LETTER + 8 if zy < drawing.height / 2 else -12), "X 0, Y 0", "middle")
    highest = max(bodies, key=lambda one: one[1].center[1])[0]
    for name, one in bodies:
        x, y, _ = one.center
        drawing.outline(_circle(x, y, radii[name]), "work")
        if isinstance(one, Ring):
            drawing.outline(_circle(x, y, one.diameter / 2), "holder")
        drawing.line((x, 0.0), (0.0, 0.0), "5 3")
        drawing.dimension(f"{name} X", (0.0, y), (x, y), "")
        drawing.dimension(f"{name} Y", (x, 0.0), (x, y), "")
        drawing.dot(name, x, y, 2.5)
        px, py = drawing.at(x, y)
        beside = radii[name] * scale
        py += -beside - LETTER - 8 if name == highest else beside + LETTER + 2
        drawing.words(px, py, name, "middle")
        drawing.words(px, py + LETTER + 1, f"X {x:g}, Y {y:g}", "middle")
    return drawing.svg


def section_drawing(probe: Calibration) -> str:
    """As SVG: ring and sphere cut along their axes, side by side, over the Z at which the tip's center is level."""
    ring, sphere, tip = probe.ring, probe.sphere, probe.tip_radius
    levels: list[tuple[float, str]] = []
    if ring is not None:
        low, high = _ring_ends(ring)
        levels.append((ring.center[2], "in the bore"))
        if ring.face is not None:
            levels += [(low, "seat"), (high, "face")]
    if sphere is not None:
        levels.append((sphere.center[2], "sphere"))
    low = min([z for z, _ in levels] + ([] if sphere is None else [sphere.center[2] - sphere.diameter / 2]))
    high = max([z for z, _ in levels] + ([] if sphere is None else [sphere.center[2] + sphere.diameter / 2 + 2 * tip]))
    low, high = (low - _UNKNOWN, high + _UNKNOWN)
    wide = sum(2 * _outside(one) for one in (ring, sphere) if one is not None) + 2 * _UNKNOWN
    scale = min(_HEIGHT / (high - low), (WIDTH - _WORDS) / wide)
    drawing, middle, right = Drawing(0.0, low - LETTER / scale, high, scale, (6.0, 2 * LETTER)), 0.0, 0.0
    if ring is not None:
        middle, bore, (bottom, top) = _outside(ring), ring.diameter / 2, _ring_ends(ring)
        for sign in (-1.0, 1.0):
            inner, outer = middle + sign * bore, middle + sign * _outside(ring)
            drawing.outline([(inner, bottom), (outer, bottom), (outer, top), (inner, top)], "work")
        drawing.outline(_circle(middle, ring.center[2], tip), "blade")
        drawing.line((middle, bottom), (middle, top), "10 3 2 3")
        drawing.dimension("bore", (middle - bore, bottom), (middle + bore, bottom), "")
        px, py = drawing.at(middle, bottom)
        drawing.words(px, py + LETTER + 2, f"⌀ {ring.diameter:g}", "middle")
        right = 2 * _outside(ring) + 2 * _UNKNOWN
    if sphere is not None:
        middle, radius, z = right + sphere.diameter / 2, sphere.diameter / 2, sphere.center[2]
        drawing.outline(_circle(middle, z, radius), "work")
        drawing.outline(_circle(middle, z + radius + tip, tip), "blade")
        px, py = drawing.at(middle, z + radius + 2 * tip)
        drawing.words(px, py - 4, f"S⌀ {sphere.diameter:g}", "middle")
        right = middle + radius
    below = -math.inf
    for z, what in sorted(levels, reverse=True):
        drawing.line((0.0, z), (right + 6 / scale, z), "5 3")
        px, py = drawing.at(right, z)
        below = max(py + LETTER / 3, below + LETTER + 1)
        drawing.words(px + 10, below, f"Z {z:g} {what}")
    return drawing.svg


def work_sphere_drawing(machine: MillingMachine, probe: Calibration, sphere: WorkSphere) -> str:
    """As SVG: the sphere on the work side from the front, turned to the top by A, at every B of the program."""
    turned = sorted(set(sphere_positions(machine, probe, sphere)[:, 4].tolist()))
    ends = np.array([[sphere.radius, 0.0, sphere.axial], [sphere.radius, 0.0, sphere.axial + _STEM], [0.0, 0.0, 0.0]])
    seen = {b: places_at(machine, ends, b) for b in turned}
    radius = sphere.diameter / 2
    around = np.vstack([[[0.0, 0.0]], *seen.values()])
    (left, bottom), (right, top) = around.min(axis=0) - radius, around.max(axis=0) + radius
    scale = min(_HEIGHT / (top - bottom), (WIDTH - _WORDS - _SIDE) / (right - left))
    drawing = Drawing(left, bottom - LETTER / scale, top, scale, (_SIDE, LETTER))
    drawing.line((left, 0.0), (right, 0.0), "5 3")
    for b, (center, stem, apex) in seen.items():
        along = (stem - center) / _STEM
        aside = np.array([-along[1], along[0]]) * sphere.stem_diameter / 2
        drawing.outline(np.array([center + aside, stem + aside, stem - aside, center - aside]), "holder")
        drawing.line(tuple(apex), tuple(apex + along * (sphere.axial + _STEM)), "10 3 2 3")
        x, height = float(center[0]), float(center[1])
        drawing.outline(_circle(x, height, radius), "work")
        drawing.dot(f"sphere at B {math.degrees(b):g}", x, height, 2.5)
        px, py = drawing.at(x + radius, height)
        drawing.words(px + 6, py + LETTER / 3, f"B {math.degrees(b):g}: X {x:.1f}, height {height:.1f}")
    drawing.dot("B axis", 0.0, 0.0, 6.0, filled=False)
    px, py = drawing.at(0.0, 0.0)
    drawing.words(px + 9, py + LETTER + 4, "B axis")
    return drawing.svg


def _outside(one: Ring | Sphere) -> float:
    """Greatest radius [mm] of what is drawn."""
    if isinstance(one, Sphere):
        return one.diameter / 2
    return one.diameter / 2 + (_UNKNOWN if one.face is None else one.face.width)


def _ring_ends(ring: Ring) -> tuple[float, float]:
    """Z of the lower and the upper end of what is drawn of a ring."""
    if ring.face is None:
        return ring.center[2] - _UNKNOWN, ring.center[2] + _UNKNOWN
    return ring.face.seat, ring.face.seat + ring.face.height


def _circle(x: float, y: float, radius: float) -> np.ndarray:
    at = np.linspace(0.0, 2 * math.pi, 72, endpoint=False)
    return np.column_stack([x + radius * np.cos(at), y + radius * np.sin(at)])

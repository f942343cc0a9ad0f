"""What is to be touched: ring and sphere to calibrate the probe, a sphere on the work to find the rotary axes."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass

import numpy as np

from gearmath.kernels import kernel
from gearmath.machine.planning.targets import tip_positions
from gearmath.specs.calibration import Calibration, WorkSphere
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.touch_csv import RING, RING_FACE, SPHERE

#: Targets in the ring, low and high, for X and for Y.
PAIRS = (RING[:2], RING[2:])
#: Directions from the axis of the bore to the touches on the face.
FACE_SIDES = ((-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0))
#: Touches on the sphere: the pole, then rings at these angles from it, with so many touches each.
_RINGS = (30.0, 60.0, 85.0)
_ON_RING = 8


@dataclass(frozen=True)
class ArtefactSection:
    """A part of a calibration program that R90 and R91 choose: its name, and how many touches it makes."""

    what: str
    touches: int


def sphere_directions() -> np.ndarray:
    """Unit vectors (n,3) from the centre of the sphere to its touches."""
    directions = [(0.0, 0.0, 1.0)]
    for polar in np.radians(_RINGS):
        for azimuth in 2 * math.pi * np.arange(_ON_RING) / _ON_RING:
            directions.append(
                (math.sin(polar) * math.cos(azimuth), math.sin(polar) * math.sin(azimuth), math.cos(polar))
            )
    return np.array(directions)


def calibration_touches(calibration: Calibration) -> dict[str, int]:
    """How often the program touches every target, as far as the calibration file has them."""
    ring = calibration.ring
    pairs = [target for pair in (*PAIRS, PAIRS[0]) for target in pair] if ring is not None else []
    face = [RING_FACE] * len(FACE_SIDES) if ring is not None and ring.face is not None else []
    sphere = [SPHERE] * len(sphere_directions()) if calibration.sphere is not None else []
    return dict(Counter([*pairs, *face, *sphere]))


def tip_sections(calibration: Calibration) -> list[ArtefactSection]:
    """The parts of the program that calibrates the tip, as far as the calibration file has them, in their order."""
    counts = calibration_touches(calibration)
    names = {"ring": RING, "face of the ring": (RING_FACE,), "sphere": (SPHERE,)}
    found = [ArtefactSection(what, sum(counts.get(target, 0) for target in targets)) for what, targets in names.items()]
    return [one for one in found if one.touches]


#: Positions of B, as far as the travel allows, and of A from that which has the sphere on top.
_SWIVELS = np.radians([0.0, 45.0, 90.0])
_TURNS = np.radians([-60.0, 0.0, 60.0])
#: Touches on the sphere: the pole, and so many around at this angle from it.
_POLAR, _AROUND = math.radians(50.0), 8
#: Room that a tip must have from the stem. [mm]
_FROM_STEM = 1.0


def axis_touches(machine: MillingMachine, calibration: Calibration) -> int:
    """How many touches the program makes; none where the calibration file has no sphere on the work side."""
    sphere = calibration.work_sphere
    return 0 if sphere is None else sum(one.touches for one in axis_sections(machine, calibration, sphere))


def axis_sections(machine: MillingMachine, calibration: Calibration, sphere: WorkSphere) -> list[ArtefactSection]:
    """The parts of the program that finds the rotary axes: one for every position of A and B, in their order."""
    found = []
    for center in sphere_positions(machine, calibration, sphere):
        a, b = np.degrees(center[3:]).round(3)
        touches = len(work_sphere_directions(center, sphere, calibration))
        found.append(ArtefactSection(f"sphere on the work, A {a:g} B {b:g}", touches))
    return found


def sphere_positions(machine: MillingMachine, calibration: Calibration, sphere: WorkSphere) -> np.ndarray:
    """Positions X Y Z A B (n,5) that put the tip's centre into that of the sphere."""
    low, high = machine.travel.T
    B = np.repeat(np.clip(_SWIVELS, low[4], high[4]), len(_TURNS))
    A = sphere.rad("azimuth") + np.tile(_TURNS, len(_SWIVELS))
    if math.isfinite(low[3]):
        A = A + 2 * math.pi * np.ceil((low[3] - A) / (2 * math.pi) - 1e-12)
    rows = [tip_positions(sphere.place[None], A[k : k + 1], float(B[k]), machine, calibration) for k in range(len(A))]
    return np.concatenate(rows)


def work_sphere_directions(center: np.ndarray, sphere: WorkSphere, calibration: Calibration) -> np.ndarray:
    """Unit vectors (n,3) from the centre of the sphere to its touches: those that keep clear of the stem."""
    around = 2 * math.pi * np.arange(_AROUND) / _AROUND
    ring = [(math.sin(_POLAR) * math.cos(at), math.sin(_POLAR) * math.sin(at), math.cos(_POLAR)) for at in around]
    directions = np.array([(0.0, 0.0, 1.0), *ring])
    # at the origin of the work, without offsets: a direction in the axes of the machine
    (stem,) = kernel("probe_axes")(np.array([0.0, 0.0, 1.0]), *center[3:], 0.0, np.zeros(3), np.zeros(3))
    along = directions @ stem[:3]
    aside = (sphere.diameter / 2 + calibration.tip_radius) * np.sqrt(np.maximum(1.0 - along**2, 0.0))
    room = aside - calibration.tip_radius - sphere.stem_diameter / 2
    return directions[(along <= 0.0) | (room > _FROM_STEM)]

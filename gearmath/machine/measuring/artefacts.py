"""Ring, its face, and the spheres on table and work, as a probe meets them: what calibration programs touch."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from gearmath.kernels import kernel
from gearmath.machine.bodies.probe_tip import probe_height
from gearmath.specs.calibration import Calibration, Face, Ring, Sphere, WorkSphere
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.touch_csv import RING, RING_FACE, SPHERE, WORK_SPHERE

#: Steps in which a way is searched for a touch [mm], and the parts of a step in which it is searched again, twice.
_STEP, _PARTS, _AGAIN = 0.1, 64, 2
_NO_LOBES = np.zeros(2)

#: Distance (n,) [mm] of the tip from a surface at positions X Y Z A B (n,5), negative in it.
Gap = Callable[[np.ndarray], np.ndarray]


class Artefacts:
    """The machine with the artefacts of a calibration file where it says they are, and a probe with the file's tip.

    What :func:`run_program` takes as a probe. Of the ring there is the bore for a tip that starts within it, and the
    face for one that starts over its wall; table, seat and the stem of the work sphere are not there.
    """

    def __init__(self, machine: MillingMachine, calibration: Calibration) -> None:
        self.machine, self.calibration = machine, calibration

    def __call__(self, start: np.ndarray, end: np.ndarray) -> np.ndarray | None:
        """Where the tip first meets a surface between two positions X Y Z A B (5,); None where it does not."""
        shares = (_closing(gap, start, end) for gap in self._gaps(start))
        share = min((one for one in shares if one is not None), default=None)
        return None if share is None else start + share * (end - start)

    def _gaps(self, start: np.ndarray) -> list[Gap]:
        """The surfaces that a tip may meet that starts there."""
        probe, found = self.calibration, []
        if probe.sphere is not None:
            found.append(self._of_sphere(probe.sphere))
        if probe.work_sphere is not None:
            found.append(self._of_work_sphere(probe.work_sphere))
        if probe.ring is not None:
            bore = self._of_bore(probe.ring)
            above = self._of_face(probe.ring.face) if probe.ring.face is not None else None
            beyond = float(-bore(start[None])[0]) - probe.tip_radius  # of the tip's centre beyond the wall of the bore
            if not beyond > 0.0:  # in the very middle of the bore it is NaN: the way to the wall has no direction there
                found.append(bore)
            elif above is not None and probe.ring.face is not None and beyond < probe.ring.face.width:
                found.append(above)
        return found

    def gap_of(self, target: str) -> Gap | None:
        """The surface that touch files call ``target``, where the calibration file has it."""
        probe = self.calibration
        if target == SPHERE and probe.sphere is not None:
            return self._of_sphere(probe.sphere)
        if target == WORK_SPHERE and probe.work_sphere is not None:
            return self._of_work_sphere(probe.work_sphere)
        if target == RING_FACE and probe.ring is not None and probe.ring.face is not None:
            return self._of_face(probe.ring.face)
        return self._of_bore(probe.ring) if target in RING and probe.ring is not None else None

    def _of_sphere(self, sphere: Sphere) -> Gap:
        tip = (self.calibration.tip_offset, self.calibration.tip_radius)
        place = (np.array(sphere.center), sphere.diameter / 2)
        return lambda axes: kernel("sphere_residual")(axes[:, :3], *tip, *place, _NO_LOBES)[0]

    def _of_work_sphere(self, sphere: WorkSphere) -> Gap:
        height, tip = probe_height(self.machine, self.calibration), self.calibration.tip_offset
        given = (height, tip, self.calibration.tip_radius, sphere.diameter / 2, sphere.place, np.zeros(2), 0.0)
        return lambda axes: kernel("carried_sphere")(
            axes[:, :3], axes[:, 3], axes[:, 4], *given, self.machine.pivot, _NO_LOBES
        )[0]

    def _of_bore(self, ring: Ring) -> Gap:
        tip = (self.calibration.tip_offset, self.calibration.tip_radius)
        place = (np.array(ring.center[:2]), ring.diameter)
        return lambda axes: -kernel("ring_residual")(axes[:, :3], *tip, *place, _NO_LOBES)[0]

    def _of_face(self, face: Face) -> Gap:
        offset, radius = self.calibration.tip_offset[2], self.calibration.tip_radius
        return lambda axes: offset - kernel("face_calibration")(axes[:, 2], face.seat, face.height, radius)[0]


def _closing(gap: Gap, start: np.ndarray, end: np.ndarray) -> float | None:
    """The least share of a way at which a gap closes: searched in ever smaller steps, the last of them straight."""
    shares = np.linspace(0.0, 1.0, 2 + int(np.linalg.norm((end - start)[:3]) / _STEP))
    for zoom in range(_AGAIN + 1):
        away = gap(start + shares[:, None] * (end - start))
        closed = np.flatnonzero(away <= 0.0)
        if not len(closed):
            return None
        k = int(closed[0])
        if k == 0:
            return float(shares[0])
        if zoom < _AGAIN:
            shares = np.linspace(shares[k - 1], shares[k], _PARTS + 1)
    part = away[k - 1] / (away[k - 1] - away[k])
    return float(shares[k - 1] + part * (shares[k] - shares[k - 1]))

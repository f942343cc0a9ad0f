"""One measured flank as the target of a fit, and the deviation that settings leave at its nominal points.

The deviation that settings x leave at a nominal point, along its outward normal n, is found on the exact surface:

    t(x) = (R(u, β, θ; x) - P)·n   with   e1·(R - P) = e2·(R - P) = 0,  f(u, β, θ; x) = 0

for tangents e1, e2 of the nominal flank, for every cutting method; its gradient is (20.1, 20.2).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gearmath.bevel.generation import Generation
from gearmath.bevel.identify.on_line import Kind, flank_on_line
from gearmath.bevel.identify.root_line import RootLine
from gearmath.bevel.identify.variables import SIZE, parts, whole
from gearmath.bevel.newton import FlankPoints
from gearmath.errors import ComputationError
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import SETTINGS

_LINE_TOLERANCE = 1e-9
#: Newton steps at once, and how often they are made for points that are not found yet: from the settings nearby the
#: first are enough, and after the last a cradle angle that a design changes by its bound.
_STEPS, _ROUNDS = 3, 8


@dataclass(frozen=True)
class FlankTarget:
    """One measured flank: how it was cut, its nominal points (n,) and the deviations measured there (n,) [mm].

    ``how.settings`` and ``how.motion`` are what the machine was set to. ``curvature`` [1/mm] is that of the blade, zero
    where it is straight; it touches the straight one at ``reference_height`` [mm]. ``place`` (n,2) holds X and Y of
    (6.3) for the fit of a deviation surface, ``root`` where the root line is to be held, and ``used`` (grid,) which
    points of the whole grid these are; ``absent`` are the others.
    """

    how: Generation
    nominal: FlankPoints
    deviation: np.ndarray
    curvature: float = 0.0
    reference_height: float = 0.0
    place: np.ndarray | None = None
    root: RootLine | None = None
    used: np.ndarray | None = None
    absent: FlankPoints | None = None

    @property
    def left_out(self) -> FlankTarget | None:
        """The points of the grid that were not measured, as a target without deviation; None if there are none."""
        if self.absent is None or not len(self.absent.point):
            return None
        return replace(self, nominal=self.absent, deviation=np.zeros(len(self.absent.point)), used=None, absent=None)

    @property
    def grid_points(self) -> int:
        """How many points the whole grid has."""
        return len(self.deviation) if self.used is None else len(self.used)

    def plus(self, deviation: np.ndarray) -> FlankTarget:
        """The target with deviations (grid,) [mm] added to what was measured."""
        return replace(self, deviation=self.deviation + (deviation if self.used is None else deviation[self.used]))

    def repeated(self, times: int) -> FlankTarget:
        """The target with its points so many times, one whole after the other; nothing is measured there."""
        nominal = FlankPoints(*(np.tile(a, (times, 1)) for a in vars(self.nominal).values()))
        return replace(self, nominal=nominal, deviation=np.zeros(times * len(self.deviation)), used=None, absent=None)

    @property
    def kind(self) -> Kind:
        """Which of the kernels on a line knows this flank as it is."""
        return self.kind_of(self.vector)

    def kind_of(self, vectors: np.ndarray, bending: bool = False) -> Kind:
        """The kernel for whole vectors (...,83), with the gradient by the curvature where it is ``bending``."""
        if bending or vectors[..., -1].any():
            return "curved"
        moved = self.how.index_ratio or not self.how.rolling or vectors[..., len(SETTINGS) : -1].any()
        return "straight" if moved else "plain"

    @property
    def settings(self) -> np.ndarray:
        """The settings (12,) that the machine was set to, mm and rad."""
        return self.how.settings

    @property
    def vector(self) -> np.ndarray:
        """Settings and motion that the machine was set to, and the curvature of the blade, as one vector (83,)."""
        return whole(self.how.settings, self.how.motion, self.curvature)

    def given(self, vectors: np.ndarray, kind: Kind) -> tuple:
        """The arguments of ``on_line.INPUTS`` for whole vectors (...,83)."""
        settings, motion = parts(vectors)
        if kind == "plain":
            return settings, self.how.side
        blade = (vectors[..., -1], self.reference_height) if kind == "curved" else ()
        cut = (settings, motion, self.how.index_ratio, self.how.blade_offset_angle, *blade)
        return *cut, self.how.side, float(self.how.rolling)


@dataclass(frozen=True)
class Located:
    """Where a flank crosses the normals of its nominal points: contact (n,3), deviation (n,) [mm], gradient, failed.

    The gradient is (n,83), or (n,12) by the settings alone; ``failed`` (n,) says which points were not found.
    """

    contact: np.ndarray
    deviation: np.ndarray
    gradient: np.ndarray
    failed: np.ndarray


def locate(
    target: FlankTarget,
    vectors: np.ndarray,
    moving: bool = True,
    bending: bool = False,
    start: np.ndarray | None = None,
) -> Located:
    """Where the flank of settings and motions (83,) crosses the normals, found from ``start`` (n,3) on.

    ``vectors`` may also be (n,83), one for every point; ``start`` is the nominal contact if it is not given. The
    gradient is (n,12) by the settings alone if neither ``moving`` nor ``bending``; by the curvature it is zero where
    the blade is straight and not ``bending``.
    """
    at, kind = target.nominal, target.kind_of(vectors, bending)
    on_line = flank_on_line(kind, _STEPS)
    contact, deviation, gradient, residual = on_line(
        at.contact if start is None else start, *target.given(vectors, kind), at.point, at.normal
    )
    for _ in range(_ROUNDS - 1):
        lost = ~(residual <= _LINE_TOLERANCE)
        lost &= np.isfinite(contact).all(axis=1)
        if not lost.any():
            break
        given = target.given(vectors if vectors.ndim == 1 else vectors[lost], kind)
        found = on_line(contact[lost], *given, at.point[lost], at.normal[lost])
        contact[lost], deviation[lost], gradient[lost], residual[lost] = found
    failed = ~(residual <= _LINE_TOLERANCE)
    by_settings, by_curvature = gradient[:, : len(SETTINGS)], gradient[:, len(SETTINGS) :]
    if not moving and not bending:
        return Located(contact, deviation, by_settings, failed)
    full = np.zeros((len(deviation), SIZE))
    full[:, : len(SETTINGS)] = by_settings
    if moving:
        (motion,) = kernel("coefficient_sensitivity")(contact[:, 2], by_settings)
        full[:, len(SETTINGS) : -1] = motion.reshape(len(motion), -1)
    if by_curvature.size:
        full[:, -1:] = by_curvature
    return Located(contact, deviation, full, failed)


def located(
    target: FlankTarget, vectors: np.ndarray, moving: bool = True, bending: bool = False
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Deviations (n,) [mm], their gradient, and which points (n,) were not found, by ``locate`` from the nominal."""
    found = locate(target, vectors, moving, bending)
    return found.deviation, found.gradient, found.failed


def predicted(target: FlankTarget, settings: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Deviation (n,) [mm] that settings leave at the nominal points, and its gradient by them.

    ``settings`` are (12,), with the motion of the target and a gradient (n,12), or the whole vector (83,) and (n,83).
    Raises ComputationError if the surface does not cross the normal of one of the points.
    """
    vector = settings if len(settings) == SIZE else np.concatenate([settings, target.vector[len(SETTINGS) :]])
    deviation, gradient, failed = located(target, vector, *[len(settings) == SIZE] * 2)
    if failed.any():
        raise ComputationError(
            f"the flank of the changed settings does not cross the normal of point {int(np.argmax(failed))}"
        )
    return deviation, gradient

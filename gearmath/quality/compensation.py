"""Compensation: which settings the machine behaved as if it had, and the settings that make up for it.

The deviation that settings x leave at a nominal point, along its outward normal n, is found on the exact surface:

    t(x) = (R(u, β, θ; x) - P)·n   with   e1·(R - P) = e2·(R - P) = 0,  f(u, β, θ; x) = 0

for tangents e1, e2 of the nominal flank, for every cutting method; its gradient is (20.1, 20.2). A bounded
Levenberg-Marquardt iteration makes t(x) equal to what was measured; the correction takes the difference back.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from gearmath.bevel.generation import Generation
from gearmath.bevel.kernels import kernel
from gearmath.bevel.newton import FlankPoints
from gearmath.errors import ComputationError
from gearmath.quality.deviation_surface import surface_map
from gearmath.quality.identification import Identification
from gearmath.quality.least_squares import Minimum, compensation_step, minimize
from gearmath.quality.on_line import Kind, Run, as_it_stands, flank_on_line
from gearmath.quality.root_line import RootLine
from gearmath.quality.variables import FREE, SIZE, Bounds, Variable, parts, variables_of, whole
from gearmath.specs.bevel_set import SETTINGS

_LINE_TOLERANCE = 1e-9
#: What a root line and its place between its limits differ by counts so many times its length.
ROOT_WEIGHT = 100.0

#: Where a design leaves more than this part of the sum of squares after so many steps, it also starts with so much of
#: the bound of the tilt.
_GOOD, _HEAT, _TILTED = 0.01, 6, 0.25
#: With noise, what improves the sum of squares by less than this part of its square is no improvement.
_MATTERS = 1e-6


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


def located(
    target: FlankTarget, vectors: np.ndarray, run: Run = as_it_stands, moving: bool = True, bending: bool = False
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Deviations (n,) [mm] of settings and motions (83,), their gradient, and which points (n,) were not found.

    ``vectors`` may also be (n,83), one for every point. The gradient is (n,83), or (n,12) by the settings alone if
    neither ``moving`` nor ``bending``; by the curvature it is zero where the blade is straight and not ``bending``.
    """
    nominal, kind = target.nominal, target.kind_of(vectors, bending)
    contact, deviation, gradient, residual = run(flank_on_line(kind))(
        nominal.contact, *target.given(vectors, kind), nominal.point, nominal.normal
    )
    failed = ~(residual <= _LINE_TOLERANCE)
    by_settings, by_curvature = gradient[:, : len(SETTINGS)], gradient[:, len(SETTINGS) :]
    if not moving and not bending:
        return deviation, by_settings, failed
    full = np.zeros((len(deviation), SIZE))
    full[:, : len(SETTINGS)] = by_settings
    if moving:
        (motion,) = run(kernel("coefficient_sensitivity"))(contact[:, 2], by_settings)
        full[:, len(SETTINGS) : -1] = motion.reshape(len(motion), -1)
    if by_curvature.size:
        full[:, -1:] = by_curvature
    return deviation, full, failed


def predicted(target: FlankTarget, settings: np.ndarray, run: Run = as_it_stands) -> tuple[np.ndarray, np.ndarray]:
    """Deviation (n,) [mm] that settings leave at the nominal points, and its gradient by them.

    ``settings`` are (12,), with the motion of the target and a gradient (n,12), or the whole vector (83,) and (n,83).
    Raises ComputationError if the surface does not cross the normal of one of the points.
    """
    vector = settings if len(settings) == SIZE else np.concatenate([settings, target.vector[len(SETTINGS) :]])
    deviation, gradient, failed = located(target, vector, run, *[len(settings) == SIZE] * 2)
    if failed.any():
        raise ComputationError(
            f"the flank of the changed settings does not cross the normal of point {int(np.argmax(failed))}"
        )
    return deviation, gradient


@dataclass(frozen=True)
class Problem:
    """The least-squares problem of some targets: what the solver calls, in scaled variables."""

    targets: Sequence[FlankTarget]
    variables: tuple[Variable, ...]
    weighting: np.ndarray | None
    root_limit: float | None
    run: Run = as_it_stands
    noise: float = 0.0

    @cached_property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Least and largest values of the scaled variables and of the slacks."""
        low, high = np.array([variable.range for variable in self.variables]).T
        ones = np.ones(self.slacks)
        return np.concatenate([low, -ones]), np.concatenate([high, ones])

    @cached_property
    def measured(self) -> np.ndarray:
        return np.concatenate([target.deviation for target in self.targets])

    @cached_property
    def scale(self) -> np.ndarray:
        return np.array([variable.bound for variable in self.variables])

    @cached_property
    def index(self) -> np.ndarray:
        return np.array([variable.index for variable in self.variables])

    @cached_property
    def moving(self) -> bool:
        """Whether coefficients of a motion are among the variables."""
        return bool(((self.index >= len(SETTINGS)) & (self.index < SIZE - 1)).any())

    @cached_property
    def bending(self) -> bool:
        """Whether the curvature of a blade is among the variables."""
        return bool((self.index == SIZE - 1).any())

    @cached_property
    def _depths(self) -> list[np.ndarray]:
        """Depths (2,) [mm] of the root lines as they were cut."""
        return [t.root.depth(t.vector, self.run)[1] for t in self.targets if t.root is not None]

    def deviations(self, v: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """Residual (m,) of the points and its Jacobian (m,p); None where a point is not found."""
        values, jacobians = [], []
        for k in range(len(self.targets)):
            deviation, gradient, failed = self.located(v, k)
            if failed.any():
                return None
            values.append(deviation)
            jacobians.append(self.columns(gradient, k))
        return np.concatenate(values) - self.measured, np.concatenate(jacobians)

    def located(self, v: np.ndarray, target: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """``located`` of one target for scaled variables (p,)."""
        return located(
            self.targets[target], self.targets[target].vector + self.change(v, target), self.run, self.moving,
            self.bending,
        )  # fmt: skip

    def change(self, v: np.ndarray, target: int) -> np.ndarray:
        """Scaled variables (...,p) as whole vectors (...,83) of one target."""
        vector, mine = np.zeros((*v.shape[:-1], SIZE)), self._mine[target]
        vector[..., self.index[mine]] = (v * self.scale)[..., mine]
        return vector

    @cached_property
    def _mine(self) -> list[np.ndarray]:
        """Which variables (p,) each target has."""
        return [np.array([v.target in (None, k) for v in self.variables]) for k in range(len(self.targets))]

    def columns(self, gradient: np.ndarray, target: int) -> np.ndarray:
        """The columns (n,p) of the variables of a gradient (n,83), or (n,12) by settings alone, of one target."""
        return gradient[:, self.index] * (self.scale * self._mine[target])

    def root(self, v: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """How far the root lines sink at toe and heel (2,) [mm], and their gradients (2,p), of those that have one."""
        moved: list[tuple[np.ndarray, np.ndarray]] = []
        for k, target in enumerate(self.targets):
            if target.root is not None:
                _, depth, gradient = target.root.depth(target.vector + self.change(v, k), self.run)
                moved.append((depth - self._depths[len(moved)], self.columns(gradient, k)))
        return moved

    @property
    def slacks(self) -> int:
        """How many places of root lines are watched: each is a variable more, bounded by the limit."""
        return 2 * sum(t.root is not None for t in self.targets) if self.root_limit is not None else 0

    def __call__(self, v: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """What is minimised, and its Jacobian by the variables and then the slacks of the root lines."""
        p = len(self.variables)
        found = self.deviations(v[:p])
        if found is None:
            return None
        residual, jacobian = found
        if self.weighting is not None:
            residual, jacobian = self.weighting @ residual, self.weighting @ jacobian
        if self.noise:
            residual = np.concatenate([residual, self.noise * v[:p]])
            jacobian = np.concatenate([jacobian, self.noise * np.eye(p)])
        if not self.slacks:
            return residual, jacobian
        try:
            roots = self.root(v[:p])
        except ComputationError:
            return None
        sunk, gradient = (np.concatenate(arrays) for arrays in zip(*roots, strict=True))
        apart = ROOT_WEIGHT * (sunk - self.root_limit * v[p:])
        slopes = np.zeros((len(residual) + self.slacks, p + self.slacks))
        slopes[: len(residual), :p], slopes[len(residual) :, :p] = jacobian, ROOT_WEIGHT * gradient
        np.fill_diagonal(slopes[len(residual) :, p:], -ROOT_WEIGHT * self.root_limit)  # type: ignore[operator]
        return np.concatenate([residual, apart]), slopes

    @property
    def other_starts(self) -> list[np.ndarray]:
        """Where a design may start too: tilted to either side, as without tilt the swivel does nothing."""
        names = [variable.name for variable in self.variables]
        if "cutter_tilt" not in names:
            return []
        to_side = _TILTED * np.eye(len(names) + self.slacks)[names.index("cutter_tilt")]
        low, high = self.bounds
        return [v for v in (low * to_side, high * to_side) if self(v) is not None]


def identify(
    targets: Sequence[FlankTarget], free: Sequence[str] = FREE, *, objective: str = "points",
    weights: np.ndarray | None = None, root_limit: float | None = None, noise: float = 0.0, bounds: Bounds = "machine",
    run: Run = as_it_stands,
) -> Identification:  # fmt: skip
    """The errors, common to all targets, whose exact flanks fit the measured deviations best.

    ``objective`` is "points", or "surface" for the coefficients of the cubic deviation surfaces (6.3) with ``weights``
    (10,). Where targets have a root line, it sinks or rises by at most ``root_limit`` [mm]. ``noise`` [mm] is the
    standard deviation of a measured deviation: with it, a change by a whole bound counts as one deviation of that size,
    so that directions which the flanks show less than the noise are hardly moved. Without noise, only those are left
    alone that the flanks do not show at all (singular value below 1e-6 of the largest).

    ``bounds`` "design" are for a target of tens of micrometres that settings are to be chosen for; "machine" those of
    errors of a machine.

    Bounded Levenberg-Marquardt in variables scaled by their bounds; a step is taken only if it makes the fit better on
    the re-solved surface.
    """
    variables = variables_of(free, [target.vector for target in targets], bounds)
    weighting = surface_map(targets, weights) if objective == "surface" else None
    problem = Problem(targets, variables, weighting, root_limit, run, noise)
    lower, upper = problem.bounds
    step, p = run(compensation_step(len(lower))), len(variables)
    solve = partial(minimize, problem, lower, upper, step, _MATTERS * noise**2)
    found = solve() if bounds == "machine" else _best_start(problem, solve)
    v, slack = found.variables[:p], found.variables[p:]
    residual, jacobian = problem.deviations(v)  # type: ignore[misc]
    rms_before, rms_after = (float(np.sqrt(np.mean(values**2))) for values in (problem.measured, residual))
    held = [
        variable.label for variable, part, low, high in zip(variables, v, lower[:p], upper[:p], strict=True)
        if not low < part < high
    ]  # fmt: skip
    held += ["root line"] * bool((np.abs(slack) >= 1).any())
    return Identification(
        variables, v * problem.scale, rms_before, rms_after, found.iterations, found.converged, jacobian,
        residual, weighting, tuple(held), noise,
    )  # fmt: skip


def nothing_identified(targets: Sequence[FlankTarget], run: Run = as_it_stands) -> Identification:
    """What was identified where no setting is free: the flanks are as they were set."""
    measured = np.concatenate([target.deviation for target in targets])
    left = np.concatenate([located(target, target.vector, run, moving=False)[0] for target in targets]) - measured
    before, after = (float(np.sqrt(np.mean(values**2))) for values in (measured, left))
    return Identification((), np.zeros(0), before, after, 0, True, np.zeros((len(measured), 0)), left)


def _best_start(problem: Problem, solve: Callable[..., Minimum]) -> Minimum:
    """The minimum of a design: the start that is ahead after some steps is followed to the end."""
    first = solve(most=_HEAT)
    heats = [first]
    if first.cost > _GOOD * float(problem.measured @ problem.measured):
        heats += [solve(start=v, most=_HEAT) for v in problem.other_starts]
    ahead = min(heats, key=lambda one: one.cost)
    return ahead if ahead.converged else solve(start=ahead.variables)


def with_deviations(targets: Sequence[FlankTarget], deviations: np.ndarray) -> list[FlankTarget]:
    """The targets with other deviations (m,), one target after the other."""
    ends = np.cumsum([len(target.deviation) for target in targets])
    pieces = np.split(deviations, ends[:-1])
    return [replace(target, deviation=piece) for target, piece in zip(targets, pieces, strict=True)]

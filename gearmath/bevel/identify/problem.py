"""The least-squares problem of some flanks: deviations and root lines by scaled variables, as the solver calls them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearmath.bevel.identify.flank_target import FlankTarget, Located, locate
from gearmath.bevel.identify.variables import SIZE, Variable
from gearmath.errors import ComputationError
from gearmath.specs.bevel_set import SETTINGS

#: What a root line and its place between its limits differ by counts so many times its length.
ROOT_WEIGHT = 100.0


class Trail:
    """The places that were found so far, by the variables (p,) that they belong to: the next is looked for from there.

    What a design changes by its bounds lies too far for a search from the nominal flank alone.
    """

    def __init__(self, first: np.ndarray, p: int) -> None:
        self._first, self._variables, self._places = first, np.zeros((1, p)), [first]

    def starts(self, v: np.ndarray) -> Iterator[np.ndarray]:
        """The place that belongs to the nearest variables, and after it the first of all."""
        apart = self._variables - v
        nearest = int(np.argmin(np.einsum("kp,kp->k", apart, apart)))
        yield self._places[nearest]
        if nearest:
            yield self._first

    def keep(self, v: np.ndarray, place: np.ndarray) -> None:
        self._variables = np.vstack([self._variables, v])
        self._places.append(place)


@dataclass(frozen=True)
class Problem:
    """The least-squares problem of some targets: what the solver calls, in scaled variables."""

    targets: Sequence[FlankTarget]
    variables: tuple[Variable, ...]
    weighting: np.ndarray | None
    root_limit: float | None

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
        return [t.root.depth(t.vector)[1] for t in self.targets if t.root is not None]

    def deviations(self, v: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """Residual (m,) of the points and its Jacobian (m,p); None where a point is not found."""
        values, jacobians = [], []
        for k in range(len(self.targets)):
            found = self.located(v, k)
            if found is None:
                return None
            values.append(found.deviation)
            jacobians.append(self.columns(found.gradient, k))
        return np.concatenate(values) - self.measured, np.concatenate(jacobians)

    @cached_property
    def _trails(self) -> list[Trail]:
        return [Trail(target.nominal.contact, len(self.variables)) for target in self.targets]

    @cached_property
    def _root_trails(self) -> list[Trail]:
        return [Trail(t.root.start, len(self.variables)) for t in self.targets if t.root is not None]

    def located(self, v: np.ndarray, target: int) -> Located | None:
        """Where one target's flank of scaled variables (p,) crosses the normals; None where a point is not found."""
        one, trail = self.targets[target], self._trails[target]
        vector = one.vector + self.change(v, target)
        for start in trail.starts(v):
            found = locate(one, vector, self.moving, self.bending, start)
            if not found.failed.any():
                trail.keep(v, found.contact)
                return found
        return None

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
                trail, vector = self._root_trails[len(moved)], target.vector + self.change(v, k)
                contact, depth, gradient = target.root.depth(vector, next(trail.starts(v)))
                trail.keep(v, contact)
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

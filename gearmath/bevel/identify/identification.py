"""What an identification returns: the values, how well they are known, and what a measurement does to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from gearmath.bevel.identify.variables import SIZE, Variable, parts
from gearmath.specs.bevel_set import SETTINGS

#: Singular values below this part of the largest do not count: their directions are left alone.
RANK = 1e-6


@dataclass(frozen=True)
class Identification:
    """What explains a measurement, and how well it is known.

    ``values`` (p,) [mm, rad] are the changes of ``variables``; ``rms_before`` and ``rms_after`` the RMS of the measured
    deviation and of what they leave [mm]. ``jacobian`` (m,p) [mm] is that of the deviations of all targets, one after
    the other, by the variables in parts of their bounds, at the solution; ``singular_values`` (p,) [mm] are its own.
    ``residual`` (m,) [mm] is predicted less measured deviation. ``weighting`` (c,m) makes of the deviations what was
    fitted. ``active`` names the bounds and limits that hold the solution back.
    """

    variables: tuple[Variable, ...]
    values: np.ndarray
    rms_before: float
    rms_after: float
    iterations: int
    converged: bool
    jacobian: np.ndarray
    residual: np.ndarray
    weighting: np.ndarray | None = None
    active: tuple[str, ...] = ()
    noise: float = 0.0
    singular_values: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "singular_values", np.linalg.svd(self.jacobian, compute_uv=False))

    @property
    def scale(self) -> np.ndarray:
        """The bounds (p,) by which the variables are scaled, mm or rad."""
        return np.array([variable.bound for variable in self.variables])

    @property
    def index(self) -> np.ndarray:
        """The place (p,) of every variable in the whole vector (82,) of a flank; below 12 it is a setting."""
        return np.array([variable.index for variable in self.variables])

    def change(self, target: int = 0) -> np.ndarray:
        """The identified errors of one target as a whole vector (82,)."""
        return spread(self.variables, self.values, target)

    @property
    def errors(self) -> np.ndarray:
        """The setting errors (12,) of the first target, mm and rad."""
        return self.change()[: len(SETTINGS)]

    @property
    def motion(self) -> np.ndarray:
        """The errors (10,7) of the motion, mm and rad."""
        return parts(self.change())[1]

    @cached_property
    def gain(self) -> np.ndarray:
        """How the values depend on the measured deviations: their derivative (p,m) [mm or rad per mm].

        What lies below the floor of the solver, and what a bound holds, does not depend on them.
        """
        loose = np.array([variable.label not in self.active for variable in self.variables])
        weighting = np.eye(len(self.jacobian)) if self.weighting is None else self.weighting
        inverse = np.zeros((len(self.variables), len(weighting)))
        inverse[loose] = damped_inverse(weighting @ self.jacobian[:, loose], self.noise)
        return self.scale[:, None] * (inverse @ weighting)

    @property
    def corrected_parameters(self) -> float:
        """How many directions of the settings are really corrected: the sum of squares of what is let through."""
        passed = self.jacobian @ (self.gain / self.scale[:, None])
        return float(np.sum(passed**2))


def damped_inverse(jacobian: np.ndarray, noise: float = 0.0) -> np.ndarray:
    """(JᵀJ + noise² I)⁻¹ Jᵀ (p,m) of a Jacobian (m,p), without the directions that it does not show."""
    U, S, V = np.linalg.svd(jacobian, full_matrices=False)
    shown = RANK * S.max(initial=0) < S
    return V[shown].T @ ((S[shown] / (S[shown] ** 2 + noise**2))[:, None] * U[:, shown].T)


def spread(variables: Sequence[Variable], values: np.ndarray, target: int) -> np.ndarray:
    """Values (...,p) of variables as whole vectors (...,82) of one target."""
    vector = np.zeros((*values.shape[:-1], SIZE))
    for k, variable in enumerate(variables):
        if variable.target in (None, target):
            vector[..., variable.index] += values[..., k]
    return vector

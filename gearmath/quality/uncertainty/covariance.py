"""Covariance of measured deviations, V = D + F F', and what it makes of the figures that are computed from them.

D is diagonal: what is new at every touch. Each column of F is the effect of one standard deviation of something that
many touches have in common. By the law of propagation (JCGM 100, the GUM) figures y(δ) with Jacobian J have

    U = J V J' = J D J' + (J F)(J F)'
"""

from __future__ import annotations

from dataclasses import dataclass
from statistics import NormalDist

import casadi as ca
import numpy as np

from gearmath.specs.flank_csv import FlankFile


@dataclass(frozen=True)
class Covariance:
    """Variances (n,) of what is new at every point, and factors (n,k) of what points share, by source [mm].

    ``names`` says for every factor where it comes from; several factors may have the same source.
    """

    variance: np.ndarray
    factors: np.ndarray
    names: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.variance)

    @property
    def matrix(self) -> np.ndarray:
        """V (n,n)."""
        return np.diag(self.variance) + self.factors @ self.factors.T

    @property
    def noise(self) -> float:
        """Standard deviation [mm] of the deviations in the middle one of the directions of V.

        What many points share takes few directions, and so it is what differs from point to point that counts here.
        """
        return float(np.sqrt(max(np.median(np.linalg.eigvalsh(self.matrix)), 0.0)))

    def pick(self, index: np.ndarray) -> Covariance:
        """The covariance of some of the points, in the order of ``index``."""
        return Covariance(self.variance[index], self.factors[index], self.names)

    def carried(self, matrix: np.ndarray) -> Covariance:
        """The covariance of what depends on the points by a matrix (m,n): nothing in it is one point's own any more."""
        own = matrix * np.sqrt(self.variance)
        names = ("repeatability",) * own.shape[1] + self.names
        return Covariance(np.zeros(len(matrix)), np.hstack([own, matrix @ self.factors]), names)

    def through(self, jacobian: np.ndarray) -> np.ndarray:
        """J V J' (m,m) of figures with this Jacobian (m,n)."""
        common = jacobian @ self.factors
        return (jacobian * self.variance) @ jacobian.T + common @ common.T

    def standard_uncertainty(self, jacobian: np.ndarray) -> np.ndarray:
        """Square root of the diagonal of J V J' (m,)."""
        return np.sqrt(jacobian**2 @ self.variance + ((jacobian @ self.factors) ** 2).sum(axis=1))

    def budget(self, jacobian: np.ndarray) -> dict[str, np.ndarray]:
        """Standard uncertainty (m,) of figures from each source alone; their squares sum to that of all."""
        parts = {"repeatability": jacobian**2 @ self.variance}
        for name, column in zip(self.names, (jacobian @ self.factors).T, strict=True):
            parts[name] = parts.get(name, 0.0) + column**2
        return {name: np.sqrt(part) for name, part in parts.items()}

    def drawn(self, function: ca.Function, at: np.ndarray) -> ca.Function:
        """``function`` of deviations ``at`` + an error of this covariance, as a function of standard normal numbers.

        Takes (n + k,): the n that are new at every point, then the k that are shared.
        """
        n, k = self.factors.shape
        z = ca.MX.sym("z", n + k)
        error = ca.DM(np.sqrt(self.variance)) * z[:n]
        if k:
            error += ca.mtimes(ca.sparsify(ca.DM(self.factors)), z[n:])
        return ca.Function("drawn_" + function.name(), [z], [function(ca.DM(at) + error)])


def independent(uncertainty: np.ndarray) -> Covariance:
    """Covariance of points (n,) that have nothing in common, each with its standard uncertainty [mm]."""
    return Covariance(np.asarray(uncertainty, dtype=float) ** 2, np.empty((len(uncertainty), 0)), ())


def stated(file: FlankFile) -> Covariance | None:
    """What u_um of a file states, taken as independent; None where it is empty at a point that has a deviation."""
    unknown = np.isnan(file.uncertainty)
    return None if unknown[np.isfinite(file.deviation)].any() else independent(np.where(unknown, 0.0, file.uncertainty))


def coverage_factor(probability: float) -> float:
    """Standard uncertainties to both sides that hold a normal quantity with this probability; 1.96 for 95 %."""
    return NormalDist().inv_cdf((1 + probability) / 2)

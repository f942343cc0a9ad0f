"""The figures of a measured member as one CasADi function of its deviations: to be differentiated, and to be drawn.

The same figures as in ``topography`` and ``pitch``, of the same kernels; here as a graph, for uncertainties. What is
smooth has a Jacobian that carries covariances. Maxima and ranges are the largest of many linear forms; they are drawn.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from gearmath.bevel.kernels import kernel
from gearmath.quality.pitch import evaluate_pitch, reference_point
from gearmath.quality.topography import evaluate_topography, grid_shape, local_coordinates
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import FlankFile

#: Powers of mm in the units of c_1 ... c_10.
_DEGREES = (0, 1, 1, 2, 2, 2, 3, 3, 3, 3)
_UNITS = ("um", "um/mm", "um/mm^2", "um/mm^3")
_COEFFICIENTS = len(_DEGREES)


@dataclass(frozen=True)
class Figure:
    """One figure of a flank, its unit where people read it, and whether it is smooth in the deviations."""

    flank: str
    name: str
    unit: str
    smooth: bool = True


@dataclass(frozen=True)
class Figures:
    """Figures (m,) of a member [mm and mm per mm^k], and their function of the deviations (n,) of its file [mm].

    ``forms`` has, for the index of every figure that is not smooth, the linear forms (p,n) of which it is the largest.
    """

    items: tuple[Figure, ...]
    function: ca.Function
    forms: dict[int, np.ndarray]

    def jacobian(self, at: np.ndarray) -> np.ndarray:
        """∂figures/∂deviations (m,n) at deviations (n,)."""
        return jacobian(self.function, at)


def jacobian(function: ca.Function, at: np.ndarray) -> np.ndarray:
    """Jacobian of a function of one column at a column."""
    return np.array(ca.DM(_slope(function)(at)))


@lru_cache(maxsize=16)
def _slope(function: ca.Function) -> ca.Function:
    given, name = function.name_in(0), function.name_out(0)
    return function.factory(f"{function.name()}_jacobian", [given], [f"jac:{name}:{given}"])


def figures_of(file: FlankFile, teeth: int) -> Figures:
    """All figures that a measured file has points for, flank by flank.

    Raises InputError as ``evaluate_topography`` and ``evaluate_pitch`` do.
    """
    deviation = ca.MX.sym("deviation", len(file))
    items: list[Figure] = []
    values: list[ca.MX] = []
    largest: dict[int, ca.MX] = {}
    for flank in FLANKS:
        if not (file.flank == flank).any():
            continue
        parts = _topography(file, flank, deviation)
        if evaluate_pitch(file, teeth, flank) is not None:
            parts += _pitch(file, flank, deviation)
        for figure, value in parts:
            if not figure.smooth:
                largest[len(items)] = value
                value = ca.mmax(value)
            items.append(figure)
            values.append(value)
    function = ca.Function("figures", [deviation], [ca.vertcat(*values)], ["deviation"], ["figures"])
    zero = np.zeros(len(file))
    forms = {
        k: jacobian(ca.Function("forms", [deviation], [value], ["deviation"], ["forms"]), zero)
        for k, value in largest.items()
    }
    return Figures(tuple(items), function, forms)


def _topography(file: FlankFile, flank: str, deviation: ca.MX) -> list[tuple[Figure, ca.MX]]:
    """Mean, cubic surface and largest deviation of the first tooth of a flank."""
    tooth = int(file.tooth[file.flank == flank][0])
    evaluate_topography(file, flank, tooth)  # refuses what is incomplete
    rows, columns = grid_shape(file)
    (index,) = np.nonzero((file.flank == flank) & (file.tooth == tooth))
    index = index[np.lexsort((file.col[index], file.row[index]))]
    along, upward = local_coordinates(file.point[index].reshape(rows, columns, 3), reference_point(file))
    _, monomials = kernel("deviation_surface")(along.ravel(), upward.ravel(), np.zeros(_COEFFICIENTS))
    used = _COEFFICIENTS if min(rows, columns) >= 4 else 3
    here = deviation[index.tolist()]
    fitted = ca.DM(np.linalg.pinv(monomials[:, :used])) @ here
    return [
        (Figure(flank, "mean", "um"), ca.sum1(here) / len(index)),
        *((Figure(flank, f"c_{k + 1}", _UNITS[_DEGREES[k]]), fitted[k]) for k in range(used)),
        (Figure(flank, "max_deviation", "um", smooth=False), ca.vertcat(here, -here)),
    ]


def _pitch(file: FlankFile, flank: str, deviation: ca.MX) -> list[tuple[Figure, ca.MX]]:
    """Single pitch of every tooth, the largest of them, and the cumulative pitch, whose forms are pairs of teeth."""
    row, col = reference_point(file)
    (index,) = np.nonzero((file.flank == flank) & (file.row == row) & (file.col == col))
    index = index[np.argsort(file.tooth[index])]
    n = len(index)
    turning = kernel("flank_turning").function.map(n)
    _, arc = turning(deviation[index.tolist()].T, file.point[index].T, file.normal[index].T)
    cumulative = (arc - arc[0]).T
    single = cumulative - ca.vertcat(cumulative[-1], cumulative[:-1])
    first, second = np.nonzero(~np.eye(n, dtype=bool))
    return [
        *((Figure(flank, f"f_pt_{file.tooth[index[k]]}", "um"), single[k]) for k in range(n)),
        (Figure(flank, "max_f_pt", "um", smooth=False), ca.vertcat(single, -single)),
        (Figure(flank, "F_p", "um", smooth=False), cumulative[first.tolist()] - cumulative[second.tolist()]),
    ]

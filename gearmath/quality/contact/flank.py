"""Measured flanks as contact takes them: the nominal flank, and a smooth spline of its measured deviations on it.

The spline is a tensor product over the flank: one cubic up the profile, and along the tooth a cubic spline with about
two thirds as many functions as the grid has columns, eight at most. It is fitted by least squares, so that it holds
every cubic surface exactly and smooths what is rougher: contact needs its second derivatives. It depends on the
deviations by a matrix, and so does what it does to the contact in first order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from gearmath.bevel.contact.surface import ContactSurface, displaced_surface, nominal_surface
from gearmath.bevel.grid import file_grid
from gearmath.engine.points import Points
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.quality.evaluation.member import MemberEvaluation
from gearmath.quality.evaluation.topography import grid_shape
from gearmath.specs.bevel_set import Member
from gearmath.specs.flank_csv import FlankFile

#: Functions of a cubic without knots, and the most that are taken along the tooth.
_CUBIC, _MOST = 4, 8
#: Condition of the fit beyond which the points do not determine the spline.
_WORST = 1e8


@dataclass(frozen=True, eq=False)
class MeasuredFlank:
    """One flank of a member with the deviations (k,) [mm] measured on it.

    ``fit`` (m,k) makes the coefficients of the spline of them; ``basis`` takes a place z_w, r_w to its functions
    (1,m). ``variance`` (k,) [mm²] is that of the deviations, NaN where the file does not state it.
    """

    nominal: ContactSurface
    deviation: np.ndarray
    variance: np.ndarray
    fit: np.ndarray
    basis: ca.Function
    places: np.ndarray

    @property
    def surface(self) -> ContactSurface:
        """The flank with the spline of its deviations on it."""
        return self.with_deviation(self.deviation)

    def with_deviation(self, deviation: np.ndarray) -> ContactSurface:
        """The flank with other deviations (k,) [mm] at the same points."""
        place = ca.SX.sym("place", 2)
        off = self.basis(place[0], place[1]) @ ca.DM(self.fit @ deviation)
        return displaced_surface(self.nominal, ca.Function("deviation", [place[0], place[1]], [off]))

    @cached_property
    def residual(self) -> np.ndarray:
        """What the spline leaves (k,) [mm]."""
        return self.deviation - _rows(self.basis, self.places) @ (self.fit @ self.deviation)


def measured_flank(member: Member, flank: str, file: FlankFile, evaluation: MemberEvaluation) -> MeasuredFlank | None:
    """A flank of an evaluated file, the mean of its teeth; None where no tooth of it was measured in full.

    ``file`` is as it was read: it states the uncertainty of the points. Raises InputError where the points do not
    determine the spline.
    """
    figures = evaluation.flanks.get(flank)
    if figures is None or figures.mean is None:
        return None
    teeth = [each.tooth for each in figures.topographies]
    rows, columns = grid_shape(file)
    variance = np.zeros(rows * columns)
    for tooth in teeth:
        points = file.select(flank, tooth)
        of_tooth = np.full(rows * columns, math.nan)
        of_tooth[points.row * columns + points.col] = points.uncertainty**2
        variance += of_tooth / len(teeth) ** 2
    grid = file_grid(evaluation.file, member, flank)
    return flank_with(member, flank, grid.axial, grid.radial, figures.mean.deviation, variance)


def flank_with(
    member: Member, flank: str, axial: np.ndarray, radial: np.ndarray, deviation: np.ndarray, variance: np.ndarray
) -> MeasuredFlank:
    """A flank with deviations at a grid of places (rows, columns) [mm], rows root to tip, columns toe to heel.

    Deviations that are NaN are left out. Raises InputError where the others do not determine the spline.
    """
    basis = _basis(member, axial, radial)
    deviation = deviation.ravel()
    known = np.isfinite(deviation)
    places = np.column_stack([axial.ravel(), radial.ravel()])[known]
    matrix = _rows(basis, places)
    if len(matrix) < matrix.shape[1] or np.linalg.cond(matrix) > _WORST:
        raise InputError(
            f"{flank} flank: {len(matrix)} points do not determine a spline of {matrix.shape[1]} functions"
        )
    nominal = nominal_surface(member, flank)
    return MeasuredFlank(nominal, deviation[known], variance.ravel()[known], np.linalg.pinv(matrix), basis, places)


def _rows(basis: ca.Function, places: np.ndarray) -> np.ndarray:
    """The functions of the spline (k,m) at places (k,2)."""
    return Points(basis)(places[:, :1], places[:, 1:])[0][:, 0, :]


def _basis(member: Member, axial: np.ndarray, radial: np.ndarray) -> ca.Function:
    """z_w, r_w -> the functions of the spline (1,m) over a grid of places (rows, columns)."""
    rows, columns = axial.shape
    point = np.stack([radial.ravel(), 0 * radial.ravel(), axial.ravel()], axis=1)
    delta = member.blank.delta
    along, depth = kernel("root_place")(point, delta)
    z, r = ca.SX.sym("z"), ca.SX.sym("r")
    place = kernel("root_place").function(ca.vertcat(r, 0, z), delta)
    across, deep = (
        (2 * one - float(values.min() + values.max())) / float(np.ptp(values))
        for one, values in zip(place, (along, depth), strict=True)
    )
    functions = [a * b for a in _functions(deep, min(rows, _CUBIC)) for b in _functions(across, columns)]
    return ca.Function("basis", [z, r], [ca.densify(ca.horzcat(*functions))])


def _functions(x: ca.SX, count: int) -> list[ca.SX]:
    """Functions of a spline over -1 to 1 for so many points: powers up to the third, then a cubic from each knot on."""
    size = min(count, _CUBIC) if count < 7 else min(round(2 * count / 3), _MOST)
    knots = np.linspace(-1, 1, max(size - _CUBIC, 0) + 2)[1:-1]
    return [x**k for k in range(min(size, _CUBIC))] + [ca.fmax(x - float(knot), 0) ** 3 for knot in knots]

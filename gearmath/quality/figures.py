"""The figures of an evaluated member as one CasADi function of the deviations that were measured.

The same figures as in ``evaluation``, of the same kernels and maps; here as a graph, to be differentiated and drawn. On
the way from what was measured to what is judged, drift and clamping are taken out: linear maps, to first order. What is
smooth has a Jacobian that carries covariances. Maxima and ranges are the largest of many linear forms; they are drawn.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import casadi as ca
import numpy as np

from gearmath.bevel.kernels import kernel
from gearmath.quality.drift import without_drift
from gearmath.quality.evaluation import Evaluation, FlankFigures
from gearmath.quality.nominal import completed
from gearmath.quality.outliers import find_outliers
from gearmath.quality.pitch import reference_point
from gearmath.quality.topography import ORDERS, Topography, orders_matrix
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.flank_csv import FlankFile

#: Powers of mm in the units of c_1 ... c_10.
_DEGREES = (0, 1, 1, 2, 2, 2, 3, 3, 3, 3)
_UNITS = ("um", "um/mm", "um/mm^2", "um/mm^3")


@dataclass(frozen=True)
class Figure:
    """One figure of a flank, or of both: its unit where people read it, and whether it is smooth in the deviations.

    ``factor`` makes its number in that unit of the one in mm and rad.
    """

    flank: str
    name: str
    unit: str
    smooth: bool = True
    factor: float = 1000.0


@dataclass(frozen=True)
class Figures:
    """Figures (m,) of a member [mm and mm per mm^k], and their function of the deviations (n,) of its file [mm].

    ``deviation`` (n,) are those measured, zero where a point was left out. ``forms`` has, for the index of every figure
    that is not smooth, the linear forms (p,n) of which it is the largest, apart from a constant.
    """

    items: tuple[Figure, ...]
    deviation: np.ndarray
    function: ca.Function
    forms: dict[int, np.ndarray]
    values: dict[int, np.ndarray]

    def jacobian(self) -> np.ndarray:
        """∂figures/∂deviations (m,n) at the deviations measured."""
        return jacobian(self.function, self.deviation)


def jacobian(function: ca.Function, at: np.ndarray) -> np.ndarray:
    """Jacobian of a function of one column at a column."""
    return np.array(ca.DM(_slope(function)(at)))


@lru_cache(maxsize=16)
def _slope(function: ca.Function) -> ca.Function:
    given, name = function.name_in(0), function.name_out(0)
    return function.factory(f"{function.name()}_jacobian", [given], [f"jac:{name}:{given}"])


def figures_of(file: FlankFile, member: Member, found: Evaluation) -> Figures:
    """All figures of the evaluation of a measured file, flank by flank, then those of both."""
    at = np.nan_to_num(file.deviation)
    prepared = _without_drift(file, member, found.member)
    judged = found.file
    deviation = ca.MX.sym("deviation", len(file))
    change = deviation - ca.DM(at)
    parts: list[tuple[Figure, ca.MX]] = []
    if found.registration is not None:
        gain = found.registration.gain @ prepared
        parts += _seat(found, ca.DM(gain) @ change)
        prepared = prepared - found.registration.columns @ gain
    prepared[~np.isfinite(judged.deviation)] = 0.0
    now = ca.DM(np.nan_to_num(judged.deviation)) + ca.DM(prepared) @ change
    for flank, figures in found.flanks.items():
        parts += _topography(judged, flank, figures, now)
        parts += _pitch(judged, flank, figures, now)
    parts += _spaces(judged, found, now)
    return _together(parts, deviation, at)


def _together(parts: list[tuple[Figure, ca.MX]], deviation: ca.MX, at: np.ndarray) -> Figures:
    one = [value if figure.smooth else ca.mmax(value) for figure, value in parts]
    function = ca.Function("figures", [deviation], [ca.vertcat(*one)], ["deviation"], ["figures"])
    forms, values = {}, {}
    for k, (figure, value) in enumerate(parts):
        if not figure.smooth:
            many = ca.Function("forms", [deviation], [value], ["deviation"], ["forms"])
            forms[k], values[k] = jacobian(many, at), np.array(many(at)).ravel()
    return Figures(tuple(figure for figure, _ in parts), at, function, forms, values)


def _without_drift(file: FlankFile, member: Member, name: str) -> np.ndarray:
    """How the deviations without outliers and drift (m,) depend on those measured (m,n).

    Taking out the drift is linear and homogeneous, so that unit deviations of the nominal points give the columns.
    """
    whole, _ = completed(find_outliers(file, member.teeth).without(file), member, name)
    known = np.isfinite(whole.deviation)
    kept = whole.tooth < member.teeth
    matrix = (np.eye(len(whole)) * known)[kept][:, : len(file)]
    nominal = _nominal(whole)
    twice = np.isin(whole.tooth, (0, member.teeth)) & known & bool((~kept).any())
    for k in np.flatnonzero(twice[: len(file)]):
        unit = np.where(known, np.eye(len(whole))[k], np.nan)
        moved = replace(whole, deviation=unit, point=nominal + np.nan_to_num(unit)[:, None] * whole.normal)
        matrix[:, k] = np.nan_to_num(without_drift(moved, member.teeth)[0].deviation)
    return matrix


def _seat(found: Evaluation, change: ca.MX) -> list[tuple[Figure, ca.MX]]:
    """How the work sat: eccentricity along x_w and y_w, tilt about them as a rise over 100 mm."""
    seat = ca.DM(found.registration.seat) + change  # type: ignore[union-attr]
    names = [("eccentricity_x", "um", 1), ("eccentricity_y", "um", 1)]
    if found.registration.tilt_found:  # type: ignore[union-attr]
        names += [("tilt_x", "um/100mm", 100), ("tilt_y", "um/100mm", 100)]
    return [(Figure("both", name, unit), seat[k] * scale) for k, (name, unit, scale) in enumerate(names)]


def _topography(
    file: FlankFile, flank: str, figures: FlankFigures, deviation: ca.MX
) -> list[tuple[Figure, ca.MX]]:  # fmt: skip
    """Orders of the mean of the teeth measured in full; cubic surface and largest deviation of the first of them."""
    if figures.mean is None:
        return []
    mean, first = figures.mean, figures.topographies[0]
    known = np.isfinite(mean.deviation).ravel()
    averaged = np.zeros((len(known), len(file)))
    for topography in figures.topographies:
        rows, places = _points(file, flank, topography)
        averaged[places, rows] = 1.0
    averaged = averaged[known] / averaged[known].sum(axis=1, keepdims=True)
    orders = orders_matrix(mean.along.ravel()[known], mean.upward.ravel()[known]) @ averaged
    rows, places = _points(file, flank, first)
    here = deviation[rows.tolist()]
    _, monomials = kernel("deviation_surface")(first.along.ravel(), first.upward.ravel(), np.zeros(len(_DEGREES)))
    used = len(_DEGREES) if min(first.deviation.shape) >= 4 else 3
    fitted = ca.DM(np.linalg.pinv(monomials[places, :used])) @ here
    by_order = ca.DM(orders) @ deviation
    return [
        *((Figure(flank, name, "um"), by_order[k]) for k, name in enumerate(ORDERS) if orders[k].any()),
        *((Figure(flank, f"c_{k + 1}", _UNITS[_DEGREES[k]]), fitted[k]) for k in range(used)),
        (Figure(flank, "max_deviation", "um", smooth=False), ca.vertcat(here, -here)),
    ]


def _points(file: FlankFile, flank: str, topography: Topography) -> tuple[np.ndarray, np.ndarray]:
    """The rows of a tooth that have a deviation, and their places on the grid."""
    (rows,) = np.nonzero((file.flank == flank) & (file.tooth == topography.tooth) & np.isfinite(file.deviation))
    return rows, file.row[rows] * topography.deviation.shape[1] + file.col[rows]


def _reference(file: FlankFile, flank: str) -> np.ndarray:
    """The rows (z,) of the reference point of every tooth, by tooth."""
    row, col = reference_point(file)
    (index,) = np.nonzero((file.flank == flank) & (file.row == row) & (file.col == col))
    return index[np.argsort(file.tooth[index])]


def _by_tooth(name: str, file: FlankFile, flank: str, deviation: ca.MX, point: np.ndarray) -> list[ca.MX]:
    """The outputs (z,) of a kernel of deviation, point and normal at the reference point of every tooth."""
    rows = _reference(file, flank)
    function = kernel(name).function.map(len(rows))
    return [
        row.T for row in function.call([deviation[rows.tolist()].T, ca.DM(point[rows].T), ca.DM(file.normal[rows].T)])
    ]


def _nominal(file: FlankFile) -> np.ndarray:
    return file.point - np.nan_to_num(file.deviation)[:, None] * file.normal


def _pitch(
    file: FlankFile, flank: str, figures: FlankFigures, deviation: ca.MX
) -> list[tuple[Figure, ca.MX]]:  # fmt: skip
    """Single pitch of every tooth, the largest of them, and the cumulative pitch, whose forms are pairs of teeth."""
    if figures.pitch is None or not np.isfinite(figures.pitch.cumulative).all():
        return []
    _, arc = _by_tooth("flank_turning", file, flank, deviation, file.point)
    cumulative = arc - arc[0]
    n = cumulative.shape[0]
    single = cumulative - ca.vertcat(cumulative[-1], cumulative[:-1])
    return [
        *((Figure(flank, f"f_pt_{k}", "um"), single[k]) for k in range(n)),
        (Figure(flank, "max_f_pt", "um", smooth=False), ca.vertcat(single, -single)),
        (Figure(flank, "F_p", "um", smooth=False), _range(cumulative)),
    ]


def _spaces(file: FlankFile, found: Evaluation, deviation: ca.MX) -> list[tuple[Figure, ca.MX]]:
    """Runout, and the mean thickness of the teeth: each flank of a tooth adds its allowance to it."""
    if found.runout is None or not np.isfinite(found.runout.radial).all():
        return []
    one, other = (_reference(file, flank) for flank in FLANKS)
    points = [
        argument
        for rows in (one, other)
        for argument in (deviation[rows.tolist()].T, _nominal(file)[rows].T, file.normal[rows].T)
    ]
    radial, _ = kernel("ball_shift").function.map(len(one))(*points)
    allowances = [_by_tooth("flank_allowance", file, flank, deviation, _nominal(file))[0] for flank in FLANKS]
    thicker = ca.sum1(ca.vertcat(*allowances)) / len(one)
    return [
        (Figure("both", "mean_thickness", "um"), thicker),
        (Figure("both", "F_r", "um", smooth=False), _range(radial.T)),
    ]


def _range(values: ca.MX) -> ca.MX:
    """The differences of all pairs of values, the largest of which is their range."""
    first, second = np.nonzero(~np.eye(values.shape[0], dtype=bool))
    return values[first.tolist()] - values[second.tolist()]

"""The figures of an evaluated member as one CasADi function of the deviations that were measured.

The same figures as in ``evaluation``, of the same kernels and maps; here as a graph, to be differentiated and drawn. On
the way from what was measured to what is judged, drift, clamping and rotation are taken out: linear maps, to first
order. What is smooth has a Jacobian that carries covariances. Maxima and ranges are the largest of many differences;
they are drawn.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca
import numpy as np

from gearmath.kernels import kernel
from gearmath.quality.evaluation.member import FlankFigures, MemberEvaluation
from gearmath.quality.evaluation.pitch import reference_point
from gearmath.quality.evaluation.registration import Registration
from gearmath.quality.evaluation.topography import ORDERS, Topography, orders_matrix
from gearmath.quality.uncertainty.judged import judging_of, nominal_points_of
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.flank_csv import FlankFile

#: Powers of mm in the units of c_1 ... c_10.
_DEGREES = (0, 1, 1, 2, 2, 2, 3, 3, 3, 3)
_UNITS = ("um", "um/mm", "um/mm^2", "um/mm^3")


@dataclass(frozen=True)
class Figure:
    """One figure of a flank, or of both: its unit where people read it, and whether it is smooth in the deviations.

    ``ranges`` tells a range from a largest size. ``factor`` makes its number in that unit of the one in mm and rad.
    """

    flank: str
    name: str
    unit: str
    smooth: bool = True
    ranges: bool = False
    factor: float = 1000.0


@dataclass(frozen=True)
class Extreme:
    """A maximum or a range: the largest of base[first] - base[second], where a last element, 0, is added to the base.

    ``function`` gives the base (b,) [mm] of what is judged (q,), and ``jacobian`` (b,n) its derivative by the measured
    deviations; the index arrays (p,) count up to b.
    """

    function: ca.Function
    jacobian: np.ndarray
    first: np.ndarray
    second: np.ndarray

    def differences(self, judged: np.ndarray) -> np.ndarray:
        """All of the differences (p,)."""
        base = np.append(np.array(self.function(judged)).ravel(), 0.0)
        return base[self.first] - base[self.second]

    def graph(self, judged: ca.MX, chosen: np.ndarray) -> ca.MX:
        """The chosen differences as a graph of what is judged."""
        base = ca.vertcat(self.function(judged), 0)
        return base[self.first[chosen].tolist()] - base[self.second[chosen].tolist()]


@dataclass(frozen=True)
class Figures:
    """Figures (m,) of a member [mm and mm per mm^k] as a function of the deviations (n,) of its file [mm].

    ``deviation`` (n,) are those measured, zero where a point was left out. ``judging`` makes of deviations what is
    judged (q,): deviations without drift, clamping and rotation, then the seat and the rotation; ``of_judged`` makes
    figures of it. ``jacobian`` (m,n) is the derivative of the figures by the deviations. ``extremes`` has, for the
    index of every figure that is not smooth, what it is the largest of.
    """

    items: tuple[Figure, ...]
    deviation: np.ndarray
    judging: ca.Function
    of_judged: ca.Function
    jacobian: np.ndarray
    extremes: dict[int, Extreme]

    @property
    def judged(self) -> np.ndarray:
        """What is judged (q,), of the deviations as measured."""
        return np.array(self.judging(self.deviation)).ravel()

    @property
    def values(self) -> np.ndarray:
        """The figures (m,) of the deviations as measured."""
        return np.array(self.of_judged(self.judged)).ravel()


def figures_of(file: FlankFile, member: Member, found: MemberEvaluation) -> Figures:
    """All figures of the evaluation of a measured file, flank by flank, then those of both."""
    judging, slope = judging_of(file, member, found)
    judged = ca.MX.sym("judged", judging.size1_out(0))
    parts: list[_Part] = []
    if found.registration is not None:
        parts += _seat(found.registration, judged[len(found.file) :])
    if found.rotation is not None:
        parts.append((Figure("both", "rotation", "arcsec", factor=math.degrees(3600)), judged[len(found.file) + 4]))
    now = judged[: len(found.file)]
    for flank, figures in found.flanks.items():
        parts += _topography(found.file, flank, figures, now)
        parts += _pitch(found.file, flank, figures, now)
    parts += _spaces(found.file, found, member, now)
    at = np.nan_to_num(file.deviation)
    return _together(parts, judged, at, judging, slope)


def _jacobian(function: ca.Function, at: np.ndarray) -> np.ndarray:
    given, name = function.name_in(0), function.name_out(0)
    slope = function.factory(f"{function.name()}_jacobian", [given], [f"jac:{name}:{given}"])
    return np.array(ca.DM(slope(at)))


#: A figure with its value, or with the base of the differences of which it is the largest.
_Part = tuple[Figure, ca.MX]


def _together(
    parts: list[_Part], judged: ca.MX, deviation: np.ndarray, judging: ca.Function, slope: np.ndarray
) -> Figures:
    values, extremes, at = [], {}, np.array(judging(deviation)).ravel()
    for k, (figure, value) in enumerate(parts):
        if figure.smooth:
            values.append(value)
            continue
        base = ca.Function("base", [judged], [value], ["judged"], ["base"])
        pairs = _pairs(value.shape[0]) if figure.ranges else _sizes(value.shape[0])
        extremes[k] = Extreme(base, _jacobian(base, at) @ slope, *pairs)
        values.append(ca.mmax(value) - ca.mmin(value) if figure.ranges else ca.mmax(ca.fabs(value)))
    function = ca.Function("figures", [judged], [ca.vertcat(*values)], ["judged"], ["figures"])
    items = tuple(figure for figure, _ in parts)
    return Figures(items, deviation, judging, function, _jacobian(function, at) @ slope, extremes)


def _sizes(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Indices of x_i - 0 and 0 - x_i: the largest of them is the largest size."""
    index, zero = np.arange(n), np.full(n, n)
    return np.concatenate([index, zero]), np.concatenate([zero, index])


def _pairs(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Indices of x_i - x_j: the largest of them is the range."""
    first, second = np.nonzero(~np.eye(n, dtype=bool))
    return first, second


def _seat(found: Registration, seat: ca.MX) -> list[_Part]:
    """The clamping of the work: eccentricity along x_w and y_w, tilt about them as a rise over 100 mm."""
    names = [("eccentricity_x", "um", 1), ("eccentricity_y", "um", 1)]
    if found.tilt_found:
        names += [("tilt_x", "um/100mm", 100), ("tilt_y", "um/100mm", 100)]
    return [(Figure("both", name, unit), seat[k] * scale) for k, (name, unit, scale) in enumerate(names)]


def _topography(file: FlankFile, flank: str, figures: FlankFigures, deviation: ca.MX) -> list[_Part]:
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
    orders = orders_matrix(mean.along.ravel()[known], mean.upward.ravel()[known])
    rows, places = _points(file, flank, first)
    here = deviation[rows.tolist()]
    _, monomials = kernel("deviation_surface")(first.along.ravel(), first.upward.ravel(), np.zeros(len(_DEGREES)))
    used = len(_DEGREES) if min(first.deviation.shape) >= 4 else 3
    fitted = ca.DM(np.linalg.pinv(monomials[places, :used])) @ here
    by_order = ca.mtimes(ca.DM(orders), ca.mtimes(ca.sparsify(ca.DM(averaged)), deviation))
    return [
        *((Figure(flank, name, "um"), by_order[k]) for k, name in enumerate(ORDERS) if orders[k].any()),
        *((Figure(flank, f"c_{k + 1}", _UNITS[_DEGREES[k]]), fitted[k]) for k in range(used)),
        *([] if first.left_out else [(Figure(flank, "max_deviation", "um", smooth=False), here)]),
    ]


def _points(file: FlankFile, flank: str, topography: Topography) -> tuple[np.ndarray, np.ndarray]:
    """The rows of a tooth that have a deviation, and their places on the grid."""
    (rows,) = np.nonzero((file.flank == flank) & (file.tooth == topography.tooth) & np.isfinite(file.deviation))
    return rows, file.row[rows] * topography.deviation.shape[1] + file.col[rows]


def _reference(file: FlankFile, flank: str) -> np.ndarray:
    """The rows (m,) of the reference points that have a reading, by tooth."""
    row, col = reference_point(file)
    here = (file.flank == flank) & (file.row == row) & (file.col == col) & np.isfinite(file.deviation)
    (index,) = np.nonzero(here)
    return index[np.argsort(file.tooth[index])]


def _by_tooth(name: str, file: FlankFile, rows: np.ndarray, deviation: ca.MX, point: np.ndarray) -> list[ca.MX]:
    """The outputs (m,) of a kernel of deviation, point and normal at the reference points of these rows."""
    function = kernel(name).function.map(len(rows))
    return [
        row.T for row in function.call([deviation[rows.tolist()].T, ca.DM(point[rows].T), ca.DM(file.normal[rows].T)])
    ]


def _pitch(file: FlankFile, flank: str, figures: FlankFigures, deviation: ca.MX) -> list[_Part]:
    """Single pitch of every tooth, the largest of them, and the total: the largest difference of two teeth.

    Of teeth without a reading there is no single pitch, and then neither of the maxima; of none where the pitch is not
    known for another reason.
    """
    if figures.pitch is None or figures.pitch.reason:
        return []
    rows = _reference(file, flank)
    _, arc = _by_tooth("flank_turning", file, rows, deviation, file.point)
    cumulative = arc - arc[0]
    at = {int(tooth): k for k, tooth in enumerate(file.tooth[rows])}
    teeth = len(figures.pitch.cumulative)
    single = {k: cumulative[at[k]] - cumulative[at[(k - 1) % teeth]] for k in at if (k - 1) % teeth in at}
    parts = [(Figure(flank, f"f_pt_{k}", "um"), value) for k, value in single.items()]
    if figures.pitch.withheld is None:
        parts += [
            (Figure(flank, "max_f_pt", "um", smooth=False), ca.vertcat(*single.values())),
            (Figure(flank, "F_p", "um", smooth=False, ranges=True), cumulative),
        ]
    return parts


def _spaces(file: FlankFile, found: MemberEvaluation, member: Member, deviation: ca.MX) -> list[_Part]:
    """Runout, and the mean thickness of the teeth: each flank of a tooth adds its allowance to it."""
    if found.runout is None or found.runout.withheld is not None:
        return []
    one, other = (_reference(file, flank) for flank in FLANKS)
    points = [
        argument
        for rows in (one, other)
        for argument in (deviation[rows.tolist()].T, nominal_points_of(file)[rows].T, file.normal[rows].T)
    ]
    shift, _ = kernel("ball_shift").function.map(len(one))(*points, member.blank.delta)
    allowances = [
        _by_tooth("flank_allowance", file, rows, deviation, nominal_points_of(file))[0] for rows in (one, other)
    ]
    thicker = ca.sum1(ca.vertcat(*allowances)) / len(one)
    return [
        (Figure("both", "mean_thickness", "um"), thicker),
        (Figure("both", "F_r", "um", smooth=False, ranges=True), shift.T),
    ]

"""A flank as contact takes it: a function of three parameters with one condition, and the borders where it ends."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property

import casadi as ca
import numpy as np

from gearmath.bevel.generation import Generation, Section, solve_curve, solve_section, turning_sense
from gearmath.bevel.method import nominal_cut
from gearmath.bevel.newton import FlankPoints
from gearmath.engine.kernel import Kernel
from gearmath.engine.points import Points
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import Blank, Member

#: The borders of a flank, in the order of ``Surface.borders``. The root makes no edge: there the fillet begins.
BORDERS = ("tip", "toe", "heel", "root")
ROOT = BORDERS.index("root")
#: Places from toe to heel at which a root is looked at.
_ALONG = 7
#: Fold [1] as a distance from the singular line [mm], in its size.
_FOLD = 5.0
#: Newton steps to a place, the residual [mm] to reach, and the largest change of u [mm], β, θ [rad] in a step.
_STEPS, _TOLERANCE, _LIMITS = 12, 1e-11, np.array([8.0, 0.4, 0.4])


def edges_of(active: tuple[int, ...]) -> tuple[int, ...]:
    """Those of the active borders that are edges: an active root says that the contact lies on the fillet below it."""
    return tuple(border for border in active if border % len(BORDERS) != ROOT)


def on_fillet(active: tuple[int, ...]) -> tuple[bool, ...]:
    """Whether a contact at active borders lies on the fillet of the pinion, and on that of the gear."""
    return tuple(len(BORDERS) * side + ROOT in active for side in range(2))


@dataclass(frozen=True, eq=False)
class ContactSurface:
    """One flank of a member, nominal or measured.

    ``function`` takes w = (u [mm], β, θ) to point [mm], outward unit normal, condition [mm], zero on the flank, and
    fold, positive from the mean point to a singular line; in the frame of the work. ``borders`` (4,4) are those of
    (25.4), inside where positive; beyond its singular line a flank is undercut, and ends as at its root. ``solve``
    finds points at places z_w, r_w (n,) [mm], NaN where there are none.

    ``fillet`` is what the rounded edge of the blade leaves below the root, as ``function`` with the same u, down to
    ``depth`` [mm] of it; None where no rounded edge joins the main section, or where the flank is undercut: there the
    fillet cuts into the flank instead of going on from its root.
    """

    function: ca.Function
    borders: np.ndarray
    solve: Callable[[np.ndarray, np.ndarray], FlankPoints]
    blank: Blank
    teeth: int
    fillet: ca.Function | None = None
    depth: float = 0.0

    @property
    def apex_beyond(self) -> float:
        return self.blank.pitch_apex_beyond_crossing_point

    @property
    def pitch_angle(self) -> float:
        """Pitch angle δ [rad]."""
        return self.blank.delta

    @property
    def ends(self) -> tuple[float, float]:
        """Cone distances of toe and heel [mm]."""
        mean, half = self.blank.mean_cone_distance, self.blank.face_width / 2
        return mean - half, mean + half

    @cached_property
    def limits(self) -> ca.Function:
        """w -> distances (4,) from the borders [mm]; that of the root is negative beyond a singular line too."""
        w = ca.SX.sym("w", 3)
        point, normal, _, fold = self.function(w)
        distances = self._from_borders(w, point, normal)
        distances[ROOT] = ca.fmin(distances[ROOT], _FOLD * fold)
        return ca.Function("limits", [w], [ca.vertcat(*distances)])

    def part(self, below: bool) -> tuple[ca.Function, ca.Function]:
        """Function and limits of the flank, or of the fillet ``below``: from the root to the bottom of the blade."""
        if not below or self.fillet is None:
            return self.function, self.limits
        w = ca.SX.sym("w", 3)
        point, normal, *_ = self.fillet(w)
        distances = self._from_borders(w, point, normal)
        distances[ROOT] = ca.fmin(-distances[ROOT], self.depth + distances[ROOT])
        return self.fillet, ca.Function("limits", [w], [ca.vertcat(*distances)])

    def _from_borders(self, w: ca.SX, point: ca.SX, normal: ca.SX) -> list[ca.SX]:
        return [kernel("flank_border").function(w[0], point, normal, ca.DM(border))[0] for border in self.borders]

    def below_root(self, w: np.ndarray) -> np.ndarray:
        """How far u (n,) of w (n,3) lies below the root [mm]: on the fillet where positive."""
        c_u, _, _, c_0 = self.borders[ROOT]
        return -(c_u * w[..., 0] + c_0)

    @cached_property
    def _mapped_limits(self) -> Points:
        return Points(self.limits)

    def distances(self, w: np.ndarray) -> np.ndarray:
        """Distances (n,4) from the borders [mm] at w (n,3)."""
        return self._mapped_limits(w)[0][:, :, 0]

    def at(self, cone_distance: float, height: float = 0.0) -> FlankPoints:
        """The one point at a cone distance and a height over the pitch cone [mm], NaN where there is none."""
        s, c = math.sin(self.pitch_angle), math.cos(self.pitch_angle)
        return self.solve(np.array([cone_distance * c - height * s]), np.array([cone_distance * s + height * c]))


def nominal_surface(member: Member, flank: str) -> ContactSurface:
    """The nominal flank of a member: what the main section of its blade cuts, whatever the method."""
    by = nominal_cut(member, flank)
    how, section = by.how, by.main
    delta, distance = member.blank.delta, member.blank.mean_cone_distance
    mean = _slowly(how, section, *(np.array([distance * f(delta)]) for f in (math.cos, math.sin))).contact[0]
    function = _function(how.with_blade(section), section, mean)
    solve = _solver(function, mean, lambda axial, radial: _slowly(how, section, axial, radial))
    borders = _borders(member, section)
    fillet, depth = None, 0.0
    if "edge" in by.sections and "toprem" not in by.sections and not _undercut(member.blank, how, section, mean):
        fillet, depth = _fillet(how, by.sections["edge"], borders[ROOT])
    return ContactSurface(function, borders, solve, member.blank, member.teeth, fillet, depth)


def displaced_surface(surface: ContactSurface, deviation: ca.Function) -> ContactSurface:
    """A flank with metal left on: ``deviation`` takes the place z_w, r_w of a nominal point to δ [mm] along its normal.

    Borders and singular line are those of the nominal flank. ``deviation`` must be smooth: twice differentiable.
    """
    function = _displaced(surface.function, deviation)
    fillet = None if surface.fillet is None else _displaced(surface.fillet, deviation)
    mean = surface.at(surface.blank.mean_cone_distance).contact[0]
    solve = _solver(function, mean, _nowhere)
    return ContactSurface(function, surface.borders, solve, surface.blank, surface.teeth, fillet, surface.depth)


def _displaced(function: ca.Function, deviation: ca.Function) -> ca.Function:
    w = ca.SX.sym("w", 3)
    point, normal, condition, *fold = function(w)
    off = deviation(point[2], ca.sqrt(point[0] ** 2 + point[1] ** 2))
    moved = point + off * normal
    rates, gradient = ca.jacobian(moved, w), ca.jacobian(condition, w).T
    own = kernel("displaced_normal").function(rates, gradient, normal)
    return ca.Function("displaced", [w], ca.cse([moved, own, condition, *fold]))


def _nowhere(axial: np.ndarray, radial: np.ndarray) -> FlankPoints:
    lost = np.full((len(axial), 3), np.nan)
    return FlankPoints(lost, lost, lost)


_Solver = Callable[[np.ndarray, np.ndarray], FlankPoints]


def _solver(function: ca.Function, mean: np.ndarray, otherwise: _Solver) -> _Solver:
    """Newton's method for places of a flank, from the parameters of its mean point; ``otherwise`` where it fails."""
    newton = _newton(function)

    def solve(axial: np.ndarray, radial: np.ndarray) -> FlankPoints:
        place = np.column_stack([axial, radial])
        w = np.tile(mean, (len(place), 1))
        for _ in range(_STEPS):
            r, J, point, normal = newton(w, place)
            done = np.abs(r[:, :, 0]).max(axis=1) < _TOLERANCE
            volume = np.linalg.det(np.where(np.isfinite(J), J, 0.0))
            if done.all():
                break
            step = np.zeros_like(w)
            good = ~done & np.isfinite(volume) & (volume != 0)
            step[good] = -np.linalg.solve(J[good], r[good])[:, :, 0]
            w = w + step / np.maximum(1.0, (np.abs(step) / _LIMITS).max(axis=1))[:, None]
        found = FlankPoints(w, point[:, :, 0], normal[:, :, 0])
        if not done.all():
            better = otherwise(axial[~done], radial[~done])
            for array, other in zip(vars(found).values(), vars(better).values(), strict=True):
                array[~done] = other
        return found

    return solve


def _slowly(how: Generation, section: Section, axial: np.ndarray, radial: np.ndarray) -> FlankPoints:
    """Points of a flank as the general solver finds them, NaN where it finds none."""
    found = solve_section(how, section, axial, radial)
    arrays = [found.contact * [_length_of_u(section), 1.0, 1.0], found.point.copy(), found.normal.copy()]
    for array in arrays:
        array[~found.converged] = np.nan
    return FlankPoints(*arrays)


def _newton(function: ca.Function) -> Points:
    """w and place -> how far w is off the place and the flank (3,), its derivatives (3,3), point and normal."""
    w, place = ca.SX.sym("w", 3), ca.SX.sym("place", 2)
    point, normal, condition, _ = function(w)
    off = ca.vertcat(point[2] - place[0], ca.sqrt(point[0] ** 2 + point[1] ** 2) - place[1], condition)
    outputs = ca.cse([off, ca.densify(ca.jacobian(off, w)), point, normal])
    return Points(ca.Function("on_place", [w, place], outputs))


def _borders(member: Member, section: Section) -> np.ndarray:
    """Tip: the face cone; toe and heel: cones square to the pitch cone; root: the lower end of the blade's section."""
    blank = member.blank
    delta, face = blank.delta, blank.delta_a
    axial, radial = (float(value) for value in kernel("flank_place")(blank.vector, 0.5, 1.0))
    mean, half = blank.mean_cone_distance, blank.face_width / 2
    sense, end = (-1.0, section.upper) if section.tip_is_upper else (1.0, section.lower)
    end *= _length_of_u(section)
    return np.array(
        [
            [0.0, math.sin(face), -math.cos(face), radial * math.cos(face) - axial * math.sin(face)],
            [0.0, math.cos(delta), math.sin(delta), half - mean],
            [0.0, -math.cos(delta), -math.sin(delta), half + mean],
            [sense, 0.0, 0.0, -sense * end],
        ]
    )


def _length_of_u(section: Section) -> float:
    """Length [mm] per unit of the blade's parameter: on an arc that is an angle."""
    return 1.0 if section.arc is None else abs(section.arc[2])


@cache
def _family(is_arc: bool) -> Kernel:
    return kernel("arc_generation" if is_arc else "straight_generation")


def _generated(flank: Generation, section: Section, u: ca.SX, w: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Point, normal and condition [mm] of what a section cuts at its parameter u."""
    arc = () if section.arc is None else (ca.DM(section.arc),)
    given = (ca.DM(flank.settings), ca.DM(flank.motion), flank.index_ratio, flank.blade_offset_angle, *arc, flank.side)
    point, normal, meshing = _family(section.arc is not None).function(u, w[1], w[2], *given)
    reach = float(flank.settings[0])
    return point, normal, meshing / reach if flank.rolling else reach * w[2]


def _undercut(blank: Blank, how: Generation, section: Section, mean: np.ndarray) -> bool:
    """Whether the flank has turned back on itself where the main section of the blade ends, from toe to heel."""
    end = section.upper if section.tip_is_upper else section.lower
    distance = blank.mean_cone_distance + blank.face_width * np.linspace(-0.5, 0.5, _ALONG)
    start, u = np.tile(mean, (_ALONG, 1)), np.full(_ALONG, end)
    start[:, 0] = end
    found = solve_curve(how, section, u, (math.cos(blank.delta), math.sin(blank.delta)), distance, start)
    (sense,) = turning_sense(how, section, mean[None] / [_length_of_u(section), 1.0, 1.0])
    return not found.converged.all() or bool((found.sense * sense <= 0).any())


def _fillet(how: Generation, edge: Section, root: np.ndarray) -> tuple[ca.Function, float]:
    """What the rounded edge of the blade cuts, by the u [mm] of the main section below its ``root``; and its depth."""
    w = ca.SX.sym("w", 3)
    length = _length_of_u(edge)
    below = -(root[0] * w[0] + root[3])
    surface = _generated(how.with_blade(edge), edge, edge.lower + below / length, w)
    return ca.Function("fillet", [w], list(surface)), (edge.upper - edge.lower) * length


def _function(flank: Generation, section: Section, mean: np.ndarray) -> ca.Function:
    """The family of chapter 10 with the numbers of one flank put in: what stands still drops out of the graph.

    ``mean`` holds u, β, θ of the mean point, which no singular line parts from the flank.
    """
    w = ca.SX.sym("w", 3)
    point, normal, condition = _generated(flank, section, w[0] / _length_of_u(section), w)
    place = ca.vertcat(point[2], ca.sqrt(point[0] ** 2 + point[1] ** 2), condition)
    rows = ca.vertsplit(ca.jacobian(place, w))
    volume = ca.dot(rows[0].T, ca.cross(rows[1].T, rows[2].T))
    fold = volume / (ca.norm_2(rows[0]) * ca.norm_2(rows[1]) * ca.norm_2(rows[2]))
    sign = math.copysign(1.0, float(ca.Function("fold", [w], [fold])(mean)))
    names = ["point", "normal", "condition", "fold"]
    return ca.Function("surface", [w], [point, normal, condition, sign * fold], ["w"], names)

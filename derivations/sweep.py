"""Chapter 16. The cutter as a body: an annulus with two blades, and where a line first meets what it sweeps.

At one pose, with the cutter centre c in the tip plane and its axis k towards the work, a line p + t d has the height
h above the tip plane and the distance ρ from the axis

    h = h_0 + h_1 t,   ρ² = |e|² - h_0² + 2 (e·d - h_0 h_1) t + (1 - h_1²) t²,
    e = p - c,   h_0 = -e·k,   h_1 = -d·k                                                      (16.1)

A blade of side s with point radius r and slope τ = tan α bounds a cone, ρ <= w = r + s τ h. Inside it, w² >= ρ²:

    a t² + 2 b t + g <= 0,   a = 1 - h_1² (1 + τ²),   b = e·d - h_0 h_1 - s τ h_1 (r + s τ h_0),
    g = |e|² - h_0² - (r + s τ h_0)²                                                           (16.2)
    t_in = (-b - √D)/a = g/(√D - b),   t_out = (√D - b)/a = -g/(√D + b),   D = b² - a g        (16.3)

The cutter takes away h >= 0 within the outer cone and not within the inner one. The outer cone above the tip plane is
convex, so it is met in one interval; so is the inner cone. From t_s on, the first of the line that is taken away is

    t = max(t_s, lower end of the outer interval), or the end of the inner interval if t lies in it   (16.4)

if that comes before the outer interval ends. Edges and curved blades take less: with a blade of curvature κ that
touches its cone at the reference height h_r, and an edge of radius r_e whose centre is (ρ_e, r_e), joined at u_j,

    E = max(-h, n·v + κ |v|²/2, |v_e| - r_e),   v = (s (ρ - ρ_r), h - h_r),   n = (cos α, -sin α)     (16.5)

of both blades is positive outside of the cutter, zero on it. The edge counts where v_e = (s (ρ - ρ_e), h - r_e) has
v_e1 >= 0 and v_e2 cos u_j + v_e1 sin u_j <= 0. E of the outer blade is convex along a line, so that Newton's steps
from (16.4) come to its first zero from outside and never pass it.

Work that sits on its axis tilted by ε about the apex, towards the azimuth λ, and moved off by e towards μ:

    p_a = Rz(λ) Rx(ε) Rz(-λ) p + e (cos μ, sin μ, 0),   n_a = Rz(λ) Rx(ε) Rz(-λ) n              (16.6)
"""

from __future__ import annotations

from functools import cache

import mpmath
import sympy as sp

from derivations import cutter
from derivations import notation as q
from derivations.expression import Expression, Quantity
from derivations.frames import Rx, Rz
from derivations.proof import DIGITS, is_close, is_zero

NOWHERE = sp.Integer(q.NOWHERE)
#: Stands for infinity in the ends of intervals. [mm]
_FAR = sp.Integer(10) ** 9
#: Less climb than this is none.
_LEVEL = sp.Rational(1, 10**30)


def _height() -> tuple[sp.Expr, sp.Expr, sp.Matrix]:
    """h_0, h_1 and e of (16.1)."""
    e = q.line_point.symbol - q.cutter_center_w.symbol
    k = q.cutter_axis_w.symbol
    return -e.dot(k), -q.line_direction.symbol.dot(k), e


def _coefficients(side: int, radius: sp.Expr, slope: sp.Expr) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """a, b, g of (16.2)."""
    h_0, h_1, e = _height()
    w_0 = radius + side * slope * h_0
    a = 1 - h_1**2 * (1 + slope**2)
    return a, e.dot(q.line_direction.symbol) - h_0 * h_1 - side * slope * h_1 * w_0, e.dot(e) - h_0**2 - w_0**2


@cache
def line_in_cone() -> Expression:
    """The interval of (16.4) in one cone above the tip plane as an Expression; its lower end above the upper if none.

    Each root is taken in the form of (16.3) that subtracts nothing. Where a < 0 the line stays within the nappe that it
    runs into, and the other of the two rays belongs to the other nappe. Where a > 0 both roots are on one nappe, that
    of their middle -b/a.
    """
    side, radius, slope = q.side.symbol, q.blade_point_radius.symbol, q.blade_slope.symbol
    h_0, h_1, _ = _height()
    a, b, g = _coefficients(side, radius, slope)
    discriminant = b**2 - a * g
    root = sp.sqrt(sp.Max(discriminant, 0))
    t_in = sp.Piecewise((g / (root - b), b < 0), (-(root + b) / a, True))
    t_out = sp.Piecewise(((root - b) / a, b < 0), (-g / (root + b), True))
    on_nappe = sp.And(discriminant > 0, a * (radius + side * slope * h_0) - side * slope * h_1 * b > 0)
    steep, rising = a <= 0, side * h_1 > 0
    lower = sp.Piecewise((t_in, sp.And(steep, rising)), (-_FAR, steep), (t_in, on_nappe), (_FAR, True))
    upper = sp.Piecewise((_FAR, sp.And(steep, rising)), (t_out, steep), (t_out, on_nappe), (-_FAR, True))
    # a level line has h_1 = 0: it is above the tip plane everywhere or nowhere
    above = sp.Piecewise((-h_0 / sp.Max(h_1, _LEVEL), h_1 >= 0), (-_FAR, True))
    below = sp.Piecewise((-h_0 / h_1, h_1 < 0), (_FAR, True))
    return Expression(
        "line_in_cone",
        "Ends of the part of a line that lies above the tip plane and within the cone of one blade (16.2, 16.3).",
        (
            q.cutter_center_w,
            q.cutter_axis_w,
            q.line_point,
            q.line_direction,
            q.blade_point_radius,
            q.blade_slope,
            q.side,
        ),
        (
            # not evaluated: SymPy would look for seconds for an order that there is not
            (q.line_lower, sp.Max(lower, above, evaluate=False)),
            (q.line_upper, sp.Min(upper, below, evaluate=False)),
        ),
        requires=(discriminant - 1, a**2 - sp.Rational(1, 10**6), h_1**2 - sp.Rational(1, 10**6)),
        source="line against a cone of revolution",
    )


@cache
def first_removed() -> Expression:
    """(16.4) as an Expression."""
    reached = sp.Max(q.line_start.symbol, q.line_lower.symbol)
    hole, wall, upper = q.hole_lower.symbol, q.hole_upper.symbol, q.line_upper.symbol
    in_hole = sp.And(hole <= reached, reached < wall)
    return Expression(
        "first_removed",
        "The first of a line that an annulus takes away, out of its parts in the outer and in the inner cone (16.4).",
        (q.line_start, q.line_lower, q.line_upper, q.hole_lower, q.hole_upper),
        (
            (
                q.line_distance,
                sp.Piecewise(
                    (wall, sp.And(in_hole, wall < upper)),
                    (NOWHERE, in_hole),
                    (reached, reached < upper),
                    (NOWHERE, True),
                ),
            ),
        ),
        source="difference of two intervals",
    )


def _blade_excess(side: int, blade: Quantity, rho: sp.Expr, h: sp.Expr) -> sp.Expr:
    """The part of E (16.5) that one blade has."""
    radius, alpha, curvature, reference, edge_center, edge_radius, joint = blade.symbols
    v = (side * (rho - radius - side * reference * sp.tan(alpha)), h - reference)
    flank = sp.cos(alpha) * v[0] - sp.sin(alpha) * v[1] + curvature * (v[0] ** 2 + v[1] ** 2) / 2
    v_e = (side * (rho - edge_center), h - edge_radius)
    at_edge = sp.And(v_e[0] >= 0, v_e[1] * sp.cos(joint) + v_e[0] * sp.sin(joint) <= 0)
    edge = sp.Piecewise((sp.sqrt(v_e[0] ** 2 + v_e[1] ** 2) - edge_radius, at_edge), (-NOWHERE, True))
    return sp.Max(flank, edge)


@cache
def place_in_cutter() -> Expression:
    """h and ρ (16.1) as an Expression; ρ is the length of what is square to the axis: always real."""
    from_center = q.line_point.symbol - q.cutter_center_w.symbol + q.line_place.symbol * q.line_direction.symbol
    h = -from_center.dot(q.cutter_axis_w.symbol)
    across = from_center + h * q.cutter_axis_w.symbol
    return Expression(
        "place_in_cutter",
        "Height above the tip plane and distance from the cutter axis of a place of a line (16.1).",
        (q.cutter_center_w, q.cutter_axis_w, q.line_point, q.line_direction, q.line_place),
        ((q.tip_height, h), (q.axis_distance, sp.sqrt(sum(component**2 for component in across)))),
        source="components along and across the axis",
    )


@cache
def cutter_excess() -> Expression:
    """(16.5) as an Expression."""
    h, rho = q.tip_height.symbol, q.axis_distance.symbol
    value = sp.Max(-h, _blade_excess(1, q.outer_blade, rho, h), _blade_excess(-1, q.inner_blade, rho, h))
    return Expression(
        "cutter_excess",
        "How far a place lies outside of a cutter with rounded edges and curved blades (16.5).",
        (q.tip_height, q.axis_distance, q.outer_blade, q.inner_blade),
        ((q.excess, value),),
        source="half-plane distances of the blade's sections, turned about the axis",
    )


def _seat() -> sp.Matrix:
    """The rotation of (16.6)."""
    return Rz(q.tilt_azimuth.symbol) * Rx(q.work_tilt.symbol) * Rz(-q.tilt_azimuth.symbol)


@cache
def seated() -> Expression:
    """(16.6) as an Expression."""
    at = q.eccentricity_azimuth.symbol
    moved = q.eccentricity.symbol * sp.Matrix([sp.cos(at), sp.sin(at), 0])
    return Expression(
        "seated",
        "Point and normal of a work that sits tilted and off centre, in the frame that turns with A (16.6).",
        (q.point_w, q.normal_w, q.eccentricity, q.eccentricity_azimuth, q.work_tilt, q.tilt_azimuth),
        (
            (q.seated_point, _seat() * q.point_w.symbol + moved),
            (q.seated_normal, _seat() * q.normal_w.symbol),
        ),
        source="rotation about a horizontal axis through the apex",
    )


def prove_seat_is_a_rotation_about_a_horizontal_axis() -> None:
    """(16.6) The axis (cos λ, sin λ, 0) stays where it is, z_w tilts by ε, and nothing is stretched."""
    turn, tilt, azimuth = _seat(), q.work_tilt.symbol, q.tilt_azimuth.symbol
    axis = sp.Matrix([sp.cos(azimuth), sp.sin(azimuth), 0])
    assert is_zero(turn * axis - axis)
    assert is_zero(turn * turn.T - sp.eye(3))
    assert is_zero(turn[2, 2] - sp.cos(tilt))


def prove_height_and_radius_are_those_of_the_line() -> None:
    """(16.1) For a unit direction, h and ρ are distance along and across the axis, worked out in the cutter frame."""
    x, y, z, t, azimuth, climb = sp.symbols("x y z t azimuth climb", real=True)
    d = sp.Matrix([sp.cos(azimuth) * sp.cos(climb), sp.sin(azimuth) * sp.cos(climb), sp.sin(climb)])
    given = dict(zip(q.line_direction.symbols, d, strict=True))
    given |= dict(zip(q.line_point.symbols, (x, y, z), strict=True))
    given |= dict.fromkeys(q.cutter_center_w.symbols, sp.S.Zero)
    given |= dict(zip(q.cutter_axis_w.symbols, (0, 0, 1), strict=True))
    h_0, h_1, e = (value.subs(given) for value in _height())
    at = sp.Matrix([x, y, z]) + t * d
    assert is_zero(h_0 + h_1 * t + at[2])
    squared = e.dot(e) - h_0**2 + 2 * (e.dot(d) - h_0 * h_1) * t + (1 - h_1**2) * t**2
    assert is_zero(squared - at[0] ** 2 - at[1] ** 2)
    given[q.line_place.symbol] = t
    placed = place_in_cutter()
    assert is_zero(placed["tip_height"].subs(given) + at[2])
    assert is_zero(placed["axis_distance"].subs(given) ** 2 - squared)


def prove_coefficients_are_those_of_the_cone() -> None:
    """(16.2) a t² + 2 b t + g = ρ² - (r + s τ h)², with ρ and r + s τ h those of chapter 1, for both blades."""
    t, radius = q.line_place.symbol, q.blade_point_radius.symbol
    alpha = q.blade_pressure_angle.symbol
    d = q.line_direction.symbol
    for side in (1, -1):
        a, b, g = _coefficients(side, radius, sp.tan(alpha))
        h_0, h_1, e = _height()
        squared = e.dot(e) - h_0**2 + 2 * (e.dot(d) - h_0 * h_1) * t + (1 - h_1**2) * t**2
        blade = cutter.radius(h_0 + h_1 * t).subs(q.side.symbol, side)
        assert sp.expand(a * t**2 + 2 * b * t + g - squared + blade**2) == 0


def prove_a_line_is_in_the_cone_between_its_ends_and_nowhere_else() -> None:
    """(16.3) Lines of many directions, their places told by (16.1): within the blade's cone of chapter 1 and h >= 0.

    A little within either end is inside, a little beyond it outside; where there is no interval, all is outside.
    """
    radius, alpha, near = mpmath.mpf(80), mpmath.mpf("0.35"), mpmath.mpf(10) ** -9
    frame, met = [0, 0, 0, 0, 0, 1], set()
    for k in range(30):
        with mpmath.workdps(DIGITS):
            polar, azimuth = mpmath.mpf(7 * k % 19 + 1) / 8, mpmath.mpf(5 * k % 23) / 4
            d = [mpmath.sin(polar) * mpmath.cos(azimuth), mpmath.sin(polar) * mpmath.sin(azimuth), mpmath.cos(polar)]
            line = [mpmath.mpf(3 * k % 17 - 8) * 12 + 1, mpmath.mpf(11 * k % 13 - 6) * 12, mpmath.mpf(k % 9 - 6), *d]
            for side in (1, -1):

                def inside(t: mpmath.mpf, line: list[mpmath.mpf] = line, side: int = side) -> bool:
                    h, rho = place_in_cutter().function(*frame, *line, t)
                    return h >= 0 and rho <= radius + side * h * mpmath.tan(alpha)

                lower, upper = line_in_cone().function(*frame, *line, radius, mpmath.tan(alpha), side)
                ends = [end for end in (lower, upper) if abs(end) < _FAR / 2]
                met.add((side, len(ends), lower < upper))
                if lower >= upper:
                    assert not any(inside(mpmath.mpf(j)) for j in range(-300, 301, 50))
                    continue
                for end, inward in ((lower, 1), (upper, -1)):
                    if end in ends:
                        assert inside(end + inward * near)
                        assert not inside(end - inward * near)
    assert met >= {(1, 2, True), (-1, 2, True), (1, 1, True)}


def prove_edge_joins_tip_plane_and_blade() -> None:
    """(16.5) With the edge of (1.5), E of blade and edge agree where they join, and those of edge and tip plane."""
    alpha, side = q.blade_pressure_angle.symbol, q.side.symbol
    (center, height, r), joint = (
        cutter.edge_round()[name].subs(q.blade_tip_height.symbol, 0) for name in ("blade_arc", "joint_height")
    )
    along = sp.Matrix([sp.cos(alpha), -sp.sin(alpha)])
    # beyond the joint, by a along n, and below the tip plane at the centre's radius, by a: both are a
    a = sp.Symbol("a", positive=True)
    for sign in (1, -1):
        on_blade = sp.Matrix([side * (cutter.radius(joint) - center), joint - height]).subs(side, sign)
        assert is_zero(on_blade - r * along)  # |v_e| = r, on the boundary of the sector
        outside = on_blade + a * along
        assert is_zero(outside.dot(outside) - (r + a) ** 2)
    assert is_zero(sp.Matrix([0, -a - height]).dot(sp.Matrix([0, -a - height])) - (r + a) ** 2)


def prove_excess_is_zero_on_the_sections_of_the_blade_and_has_their_sign() -> None:
    """(16.5) Places of the arc (1.4) and of the edge (1.6) that touches it, and others along the normals there.

    At the edge E is the distance; at the blade the distance to first order in κ times it.
    """
    radius, alpha, r, reference, rounded = map(mpmath.mpf, (80, "0.375", 500, 2, "0.75"))
    for side in (1, -1):
        with mpmath.workdps(DIGITS):
            arc = cutter.spheric_blade().function(radius, alpha, r, reference, side)
            *edge, joint = cutter.edge_round_of_arc().function(*arc, rounded, 0, side)
            own = [radius, alpha, 1 / r, reference, edge[0], rounded, joint]
            other = [radius - side * 40, alpha, 0, 0, 0 if side == 1 else 1000, 0, 0]  # far away, without an edge
            for (center, height, size), angles in (
                (arc, (joint - k / mpmath.mpf(1000) for k in range(1, 15, 3))),
                (edge, (joint + k * (mpmath.pi / 2 - joint) / 5 for k in range(1, 5))),
            ):
                for angle in angles:
                    for off in (0, mpmath.mpf(1) / 8, -mpmath.mpf(1) / 8):
                        rho = center + side * (size + off) * mpmath.cos(angle)
                        h = height - (size + off) * mpmath.sin(angle)
                        outer, inner = (own, other)[::side]
                        (excess,) = cutter_excess().function(h, rho, *outer, *inner)
                        exact = off if size == rounded else off + off**2 / (2 * r)
                        assert is_close([excess], [exact])


def prove_distance_from_the_axis_is_convex_along_a_line() -> None:
    """(16.5) About an upright axis ρ of (16.1) has the second derivative (x d_y - y d_x)²/ρ³, which is not negative.

    The parts of E that belong to the outer blade do not fall with ρ and are convex in (ρ, h): so they are convex in t.
    """
    t, (x, y, _), (along, over, _) = q.line_place.symbol, q.line_point.symbols, q.line_direction.symbols
    upright = dict.fromkeys(q.cutter_center_w.symbols, 0) | dict(zip(q.cutter_axis_w.symbols, (0, 0, 1), strict=True))
    rho = sp.simplify(place_in_cutter()["axis_distance"].subs(upright))
    assert sp.simplify(rho.diff(t, 2) - (x * over - y * along) ** 2 / rho**3) == 0

"""Chapter 6. Deviation: what is left on the flank, what a setting does to it, and the surface that sums it up.

    δ = (p_m - R)·n - r_m                                   n outward, + = metal left on       (6.1)
    ∂δ/∂x = n · ∂R/∂x at fixed u, β, θ                                                         (6.2)
    δ(X, Y) = c_1 + c_2 X + c_3 Y + c_4 X² + c_5 XY + c_6 Y² + c_7 X³ + ... + c_10 Y³          (6.3)

and where a line p + t d enters the material swept by a blade: in the cutter frame, with a point a + t b,

    q_a t² + 2 q_b t + q_c = 0,   t = q_c / (s √(q_b² - q_a q_c) - q_b)                        (6.4)

which is followed to the tip plane, where the cutter ends. A flank turned by ε about z_w has, to first order,

    δ = ε (z_w × R)·n,   s = ε √(R_x² + R_y²)                                                  (6.5)

Of a surface (6.3) about the middle of an evaluated area of length a and height b, the first and second order are

    f_β = c_2 a,   f_α = c_3 b,   C_β = -c_4 a²/4,   S = c_5 a b,   C_α = -c_6 b²/4            (6.6)

rise toe to heel (spiral angle) and root to tip (pressure angle), crowning along tooth and profile (middle over ends,
positive = barrelled), and twist: how much more f_α is at the heel than at the toe.
"""

from __future__ import annotations

from functools import cache, partial

import mpmath
import sympy as sp

from derivations import axes, cradle, cutter, flank, meshing
from derivations import notation as q
from derivations.expression import Expression
from derivations.frames import Rz
from derivations.proof import DIGITS, is_close, is_zero, numbers, shifts

#: Distance reported where the line never meets the blade: farther away than any tooth space is wide. [mm]
NOWHERE = sp.Integer(1000)


@cache
def point_deviation() -> Expression:
    """(6.1) as an Expression."""
    value = (q.tip_center.symbol - q.point_w.symbol).dot(q.normal_w.symbol) - q.tip_radius.symbol
    return Expression(
        "point_deviation",
        "Deviation of a touched point from the nominal flank, along the outward normal (6.1).",
        (q.tip_center, q.tip_radius, q.point_w, q.normal_w),
        ((q.deviation, value),),
        source="the source text's delta = (R_g - R_0)·n, with the tip radius it leaves out and a unit normal",
    )


@cache
def setting_sensitivity() -> Expression:
    """(6.2) as an Expression, one element for every setting."""
    R, n = flank.point(), flank.normal()
    gradient = sp.Matrix([n.dot(R.diff(setting)) for setting in q.settings.symbols])
    return Expression(
        "setting_sensitivity",
        "Change of the deviation per unit of each setting at a point in mesh, u, beta, theta held (6.2).",
        (q.u, q.beta, q.theta, q.settings, q.side),
        ((q.sensitivity, gradient),),
        source="envelope theorem; the shift of u, beta, theta has no component along the normal",
    )


def monomials() -> sp.Matrix:
    """1, X, Y, X², XY, Y², X³, X²Y, XY², Y³ (6.3)."""
    X, Y = q.lengthwise.symbol, q.profilewise.symbol
    return sp.Matrix([X ** (degree - k) * Y**k for degree in range(4) for k in range(degree + 1)])


@cache
def deviation_surface() -> Expression:
    """(6.3) as an Expression: the surface and its monomials at one place."""
    return Expression(
        "deviation_surface",
        "Cubic deviation surface in the local system at the reference point (6.3).",
        (q.lengthwise, q.profilewise, q.surface_coefficients),
        ((q.surface_deviation, q.surface_coefficients.symbol.dot(monomials())), (q.monomials, monomials())),
        source="Coordinate Control Method for Full CNC Vertical Spiral Bevel Gear Milling Machine, section 2",
    )


def _line_in_cutter() -> tuple[sp.Matrix, sp.Matrix]:
    """a and b of (6.4): the line in machine coordinates, turned so that the cutter axis is +z."""
    work_to_machine = sp.Matrix.hstack(*(axes.machine_to_work(sp.eye(3)[:, k]) for k in range(3))).T
    to_tool = sp.diag(1, -1, -1)  # half a turn about X: the tool looks down
    a = to_tool * (work_to_machine * (q.line_point.symbol - axes.cutter_center()))
    b = to_tool * (work_to_machine * q.line_direction.symbol)
    return a, b


def _quadratic(a: sp.Matrix, b: sp.Matrix) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """q_a, q_b, q_c of x² + y² - ρ(-z)² = 0 along a + t b (6.4)."""
    slope = -q.side.symbol * sp.tan(q.blade_pressure_angle.symbol) * b[2]
    rho = cutter.radius(-a[2])
    return (
        b[0] ** 2 + b[1] ** 2 - slope**2,
        a[0] * b[0] + a[1] * b[1] - rho * slope,
        a[0] ** 2 + a[1] ** 2 - rho**2,
    )


@cache
def line_entry() -> Expression:
    """(6.4) as an Expression: the lower end of the interval of the line inside the material that the blade sweeps."""
    a, b = _line_in_cutter()
    q_a, q_b, q_c = _quadratic(a, b)
    discriminant = q_b**2 - q_a * q_c
    root = sp.sqrt(sp.Max(discriminant, 0))
    on_cone = q_c / (q.side.symbol * root - q_b)
    tip = -a[2] / b[2]
    below_tip = a[2] + on_cone * b[2] > 0
    entry = sp.Piecewise(
        (NOWHERE, discriminant <= 0),
        (on_cone, sp.Not(below_tip)),
        (tip, b[2] < 0),
        (NOWHERE, True),
    )
    return Expression(
        "line_entry",
        "Where a line, followed along its direction, enters the material swept by the blade at one pose (6.4).",
        (
            q.axes,
            q.pivot_height,
            q.line_point,
            q.line_direction,
            q.blade_point_radius,
            q.blade_pressure_angle,
            q.side,
            q.pivot_offset,
        ),
        ((q.line_distance, entry),),
        source="line against cone, the root at which the line passes from the metal into the cutter",
    )


@cache
def flank_turning() -> Expression:
    """(6.5) as an Expression: what pitch is made of."""
    R, n = q.point_w.symbol, q.normal_w.symbol
    lever = R[0] * n[1] - R[1] * n[0]
    angle = q.deviation_in.symbol / lever
    radius = sp.sqrt(R[0] ** 2 + R[1] ** 2)
    return Expression(
        "flank_turning",
        "Rotation of a tooth flank about the member's axis that explains a deviation, as angle and as arc (6.5).",
        (q.deviation_in, q.point_w, q.normal_w),
        ((q.turning, angle), (q.arc, angle * radius)),
        requires=(sp.Abs(lever) - 1,),
        source="first-order motion of a rotated surface along its normal",
    )


@cache
def surface_orders() -> Expression:
    """(6.6) as an Expression."""
    c = q.surface_coefficients.symbols
    a, b = q.evaluated_length.symbol, q.evaluated_height.symbol
    return Expression(
        "surface_orders",
        "First and second order of a deviation surface about the middle of the evaluated area (6.6).",
        (q.surface_coefficients, q.evaluated_length, q.evaluated_height),
        (
            (q.spiral_angle_deviation, c[1] * a),
            (q.pressure_angle_deviation, c[2] * b),
            (q.length_crowning, -c[3] * a**2 / 4),
            (q.twist, c[4] * a * b),
            (q.profile_crowning, -c[5] * b**2 / 4),
        ),
        source="slopes and curvatures of (6.3), over the evaluated area",
    )


def prove_orders_are_differences_of_the_quadratic_surface() -> None:
    """(6.6) What a ruler would find on the surface of second degree: rises between ends, heights of the middle."""
    X, Y = q.lengthwise.symbol, q.profilewise.symbol
    a, b = q.evaluated_length.symbol, q.evaluated_height.symbol
    cubic = dict.fromkeys(q.surface_coefficients.symbols[6:], sp.S.Zero)
    surface = q.surface_coefficients.symbol.dot(monomials()).subs(cubic)

    def at(x: sp.Expr, y: sp.Expr) -> sp.Expr:
        return surface.subs({X: x, Y: y}, simultaneous=True)

    heel, toe, tip, root = a / 2, -a / 2, b / 2, -b / 2
    orders = surface_orders()
    assert sp.expand(at(heel, 0) - at(toe, 0) - orders["spiral_angle_deviation"]) == 0
    assert sp.expand(at(0, tip) - at(0, root) - orders["pressure_angle_deviation"]) == 0
    assert sp.expand(at(0, 0) - (at(heel, 0) + at(toe, 0)) / 2 - orders["length_crowning"]) == 0
    assert sp.expand(at(0, 0) - (at(0, tip) + at(0, root)) / 2 - orders["profile_crowning"]) == 0
    twist = at(heel, tip) - at(heel, root) - at(toe, tip) + at(toe, root)
    assert sp.expand(twist - orders["twist"]) == 0


def prove_turning_explains_its_own_deviation() -> None:
    """(6.5) The point turned by a small ε has moved by ε (z_w × R)·n along the normal: the derivative at ε = 0."""
    eps = sp.Symbol("eps", real=True)
    R, n = q.point_w.symbol, q.normal_w.symbol
    moved = (Rz(eps) * sp.Matrix(R)).diff(eps).subs(eps, 0).dot(n)
    value = flank_turning()["turning"].subs(q.deviation_in.symbol, eps * moved)
    assert sp.simplify(value - eps) == 0


def prove_sensitivity_is_the_shift_of_the_flank_cut_anew() -> None:
    """(6.2) Every setting moved, and the envelope solved anew on the normal, where u, β, θ shift as they may."""
    settings = [mpmath.mpf(x) for x in (75, 1, "0.125", "0.875", "3.5", "0.25", 1, "0.375", 3, "0.5", 80, "0.25")]
    u, theta = mpmath.mpf(2), mpmath.mpf("0.125")

    def flank_of(*given: mpmath.mpf) -> list[mpmath.mpf]:
        return [*flank.flank_family().function(*given)[:3], *meshing.meshing().function(*given)]

    for side in map(mpmath.mpf, (1, -1)):
        with mpmath.workdps(DIGITS):
            beta = mpmath.findroot(partial(_meshes, u, theta, settings, side), mpmath.mpf(-1))
            at = u, beta, theta
            family = flank.flank_family().function(*at, *settings, side)
            found = shifts(flank_of, [*settings, side], range(len(settings)), at, family[:3], family[3:])
            assert is_close(found, setting_sensitivity().function(*at, *settings, side), mpmath.mpf(10) ** -12)


def _meshes(
    u: mpmath.mpf, theta: mpmath.mpf, settings: list[mpmath.mpf], side: mpmath.mpf, beta: mpmath.mpf
) -> mpmath.mpf:
    """f of (4.2)."""
    return meshing.meshing().function(u, beta, theta, *settings, side)[0]


def prove_advance_of_the_work_shifts_the_flank_along_its_axis() -> None:
    """(6.2) Limit case: X_p moves the whole flank along z_w, so its sensitivity is the z component of n."""
    n, R = flank.normal(), flank.point()
    advance = n.dot(R.diff(q.machine_center_to_crossing_point.symbol))
    assert is_zero(advance - n[2])


def prove_turning_the_work_gives_the_lever_arm_of_the_normal() -> None:
    """(6.2) Limit case: φ_0 turns the flank by -φ_0 about z_w: its sensitivity is -(z_w × R)·n."""
    n, R = flank.normal(), flank.point()
    turning = n.dot(R.diff(q.work_rotation_offset.symbol))
    assert is_zero(turning + sp.Matrix([-R[1], R[0], 0]).dot(n))


def prove_line_that_is_laid_through_the_blade_enters_there() -> None:
    """(6.4) A line from the metal that is laid through a place of the blade of chapters 1 and 2, or of its tip plane.

    What is cut is known from the cradle machine; the entry is found from the axis positions of the other.
    """
    settings = [mpmath.mpf(x) for x in (75, 1, "0.125", "0.875", "3.5", "0.25", 1, "0.375", 3, "0.5", 80, "0.25")]
    theta, height, offset = mpmath.mpf("0.125"), mpmath.mpf(3), [mpmath.mpf(x) for x in ("0.5", "-0.25", 2)]
    radius, alpha = (
        settings[q.settings.symbols.index(each.symbol)] for each in (q.blade_point_radius, q.blade_pressure_angle)
    )
    at = dict(zip(q.settings.symbols, settings, strict=True)) | {q.theta.symbol: theta}
    chain = [numbers(cradle.machine_to_work(cradle.cutter_to_machine(sp.eye(3)[:, k])).subs(at)) for k in range(3)]
    center = numbers(cradle.machine_to_work(cradle.apex_to_cutter()).subs(at))
    for side in (1, -1):
        outwards = [-side * mpmath.cos(alpha), 0, -mpmath.sin(alpha)]  # of the metal, at β = 0
        on_blade = ([radius + side * 2 * mpmath.tan(alpha), 0, -2], [*(2 * n for n in outwards[:1]), 1, -1])
        at_tip = ([radius - side, 0, 0], [-side * mpmath.mpf("0.6"), 0, -mpmath.mpf("0.8")])
        for place, along in (on_blade, at_tip):
            with mpmath.workdps(DIGITS):
                length = mpmath.norm(along)
                place_w, d = (
                    [start[k] + sum(chain[j][k] * v[j] for j in range(3)) for k in range(3)]
                    for start, v in ((center, place), ([0, 0, 0], [component / length for component in along]))
                )
                positions = axes.axis_transform().function(*settings, theta, height, *offset)
                begin = [x - 2 * c for x, c in zip(place_w, d, strict=True)]
                found = line_entry().function(*positions, height, *begin, *d, radius, alpha, side, *offset)
                assert is_close(found, [2], mpmath.mpf(10) ** -12)


def prove_deviation_of_a_probe_on_the_flank_is_zero() -> None:
    """(6.1) Limit case: a tip that touches the nominal flank has its centre at R + r_m n."""
    R, n = q.point_w.symbol, q.normal_w.symbol
    value = point_deviation()["deviation"]
    touching = dict(zip(q.tip_center.symbols, R + q.tip_radius.symbol * n, strict=True))
    length = sum(component**2 for component in n)
    assert sp.expand(value.subs(touching) - q.tip_radius.symbol * (length - 1)) == 0

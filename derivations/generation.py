"""Chapter 10. Every motion and every blade: one family R(u, β, θ), one equation of meshing.

Settings may move with the cradle, the work may index with the cutter, and the blade may be an arc:

    x_k(θ) = x_k + Σ_j m_kj θ^j,   j = 1 ... 7                       machine settings k        (10.1)
    φ_w = φ_0(θ) + R_a(θ) θ + ι β,   ι = N_b/z                       indexing of face hobbing  (10.2)
    ρ = ρ_b + s r cos u,   h = h_b - r sin u                         arc blade, u its normal's angle   (10.3)
    t = (u - h_r)/cos α,   σ = κ t²/(1 + √(1 - κ² t²))                curved blade, u its foot's height  (10.8)
    ρ = r_p + s (u tan α - σ cos α),   h = u + σ sin α
    r_c = Rz(β) [r_p + (ρ - r_p) cos η, (ρ - r_p) sin η, -h]         blade offset angle η      (10.4)
    R = Rz(-φ_w) W (V_ls + T r_c)                                                              (10.5)
    n = ±R_u × R_β / |R_u × R_β|,   f = n · R_θ = 0                                            (10.6)

Modified roll is φ_0(θ): with the published coefficients 2C, 6D, 24E, 120F

    φ_w = φ_0 + R_a (θ - C θ² - D θ³ - E θ⁴ - F θ⁵)                                            (10.7)

helical motion is X_b(θ), universal motion all of them. Everything is derived in the frame w before it turns,
p = W (V_ls + T r_c), where a derivative by a is g_a = p_a - φ_w,a z × p: rotations change no product.

(10.8) is the arc (10.3) again, by the height u of the foot of a point on its tangent at the reference height h_r, and
by its curvature κ = 1/r instead of its radius, so that a straight blade is the case κ = 0 and not a limit:

    u = h_r + r sin(α - u_arc) cos α                                                           (10.9)

The spine's (3.1, 3.2, 4.2) are the case m = 0, ι = 0. A Formate flank has no roll: θ = 0 takes the place of f = 0.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import mpmath
import sympy as sp

from derivations import cradle, cutter, flank, meshing
from derivations import notation as q
from derivations.expression import Expression, Quantity
from derivations.frames import K, Rz
from derivations.proof import DIGITS, is_close, is_zero


@dataclass(frozen=True)
class Profile:
    """A blade's edge in its own plane: cutting radius ρ(u), height h(u) and the sign that turns R_u × R_β outwards."""

    radius: sp.Expr
    height: sp.Expr
    outward: sp.Expr


def straight() -> Profile:
    """The blade of chapter 1."""
    side = q.side.symbol
    radius = q.blade_point_radius.symbol + side * q.u.symbol * sp.tan(q.blade_pressure_angle.symbol)
    return Profile(radius, q.u.symbol, -side)


def arc() -> Profile:
    """(10.3): edge radius, or a blade of circular arc; r > 0 where the blade is convex."""
    center_radius, center_height, r = q.blade_arc.symbols
    u, side = q.arc_angle.symbol, q.side.symbol
    return Profile(center_radius + side * r * sp.cos(u), center_height - r * sp.sin(u), side * sp.sign(r))


def curved() -> Profile:
    """(10.8): a blade of any curvature, straight or arc."""
    u, side, kappa = q.u.symbol, q.side.symbol, q.blade_curvature.symbol
    alpha = q.blade_pressure_angle.symbol
    t = (u - q.reference_height.symbol) / sp.cos(alpha)
    sag = kappa * t**2 / (1 + sp.sqrt(1 - kappa**2 * t**2))
    blade = straight()
    return Profile(blade.radius - side * sag * sp.cos(alpha), u + sag * sp.sin(alpha), blade.outward)


@cache
def arc_foot() -> Expression:
    """(10.9) as an Expression."""
    r, alpha = q.blade_spheric_radius.symbol, q.blade_pressure_angle.symbol
    return Expression(
        "arc_foot",
        "Height of the foot of a point of an arc blade on its tangent at the reference height (10.9).",
        (q.arc_angle, q.blade_pressure_angle, q.blade_spheric_radius, q.reference_height),
        ((q.u, q.reference_height.symbol + r * sp.sin(alpha - q.arc_angle.symbol) * sp.cos(alpha)),),
        source="projection of a radius on a tangent",
    )


@cache
def touching_blade() -> Expression:
    """The straight blade that touches an arc blade (10.3) at u, as an Expression."""
    profile, u = arc(), q.arc_angle.symbol
    return Expression(
        "touching_blade",
        "Point radius and pressure angle of the straight blade that touches an arc blade at one point (10.3).",
        (q.arc_angle, q.blade_arc, q.side),
        (
            (q.touching_point_radius, profile.radius - q.side.symbol * profile.height * sp.tan(u)),
            (q.touching_pressure_angle, u),
        ),
        source="tangent of the arc, followed to the tip plane",
    )


def moving_settings() -> dict[sp.Symbol, sp.Expr]:
    """x_k(θ) of every machine setting, in Horner's form (10.1)."""
    theta, rows = q.theta.symbol, q.motion.symbol
    moving = {}
    for k, setting in enumerate(q.settings.symbols[: rows.rows]):
        value = sp.S.Zero
        for power in reversed(range(rows.cols)):
            value = (value + rows[k, power]) * theta
        moving[setting] = setting + value
    return moving


@dataclass(frozen=True)
class Family:
    """p, φ_w and the three derivatives of the family in the frame w before it turns."""

    point: sp.Matrix
    work_angle: sp.Expr
    along_u: sp.Matrix
    along_beta: sp.Matrix
    along_theta: sp.Matrix
    outward: sp.Expr

    @property
    def normal(self) -> sp.Matrix:
        """n of (10.6), not yet turned."""
        cross = self.along_u.cross(self.along_beta)
        return self.outward * cross / sp.sqrt(sum(component**2 for component in cross))


def family(profile: Profile, parameter: Quantity) -> Family:
    """The family of a blade (10.5) with all motions (10.1, 10.2)."""
    moving, beta = moving_settings(), q.beta.symbol
    eta, deviation = q.blade_offset_angle.symbol, profile.radius - q.blade_point_radius.symbol
    in_plane = sp.Matrix(
        [q.blade_point_radius.symbol + deviation * sp.cos(eta), deviation * sp.sin(eta), -profile.height]
    )
    in_cutter = Rz(beta) * in_plane
    p = cradle.frame_w() * (cradle.apex_to_cutter() + cradle.cutter_to_machine(in_cutter))
    p = p.subs(moving, simultaneous=True)
    phi = cradle.work_angle().subs(moving, simultaneous=True) + q.index_ratio.symbol * beta
    u, theta = parameter.symbol, q.theta.symbol

    def along(a: sp.Symbol) -> sp.Matrix:
        return p.diff(a) - phi.diff(a) * sp.Matrix(K).cross(p)

    return Family(p, phi, along(u), along(beta), along(theta), profile.outward)


def _expression(
    name: str, description: str, profile: Profile, parameter: Quantity, extra: tuple[Quantity, ...]
) -> Expression:
    surface = family(profile, parameter)
    turn, n = Rz(-surface.work_angle), surface.normal
    cross = surface.along_u.cross(surface.along_beta)
    return Expression(
        name,
        description,
        (parameter, q.beta, q.theta, q.settings, q.motion, q.index_ratio, q.blade_offset_angle, *extra, q.side),
        (
            (q.point_w, turn * surface.point),
            (q.normal_w, turn * n),
            (q.meshing_residual, n.dot(surface.along_theta)),
        ),
        requires=(sum(component**2 for component in cross) - 1,),
        source="envelope of a family of surfaces; universal motion as polynomials of the cradle angle",
    )


@cache
def modified_roll() -> Expression:
    """(10.7) as an Expression: the row of the motion that belongs to the work rotation offset."""
    coefficients = [
        -q.ratio_of_roll.symbol * value / sp.factorial(power)
        for power, value in zip(range(2, 6), q.roll_coefficients.symbols, strict=True)
    ]
    return Expression(
        "modified_roll",
        "Motion of the work rotation offset that a modified roll is (10.7).",
        (q.ratio_of_roll, q.roll_coefficients),
        ((q.roll_motion, sp.Matrix([0, *coefficients, 0, 0])),),
        source="Gleason's 2C, 6D, 24E, 120F: derivatives of the roll, hence the factorials",
    )


def prove_modified_roll_has_the_published_derivatives() -> None:
    """(10.7) The second to fifth derivatives of -φ_w/R_a at θ = 0 are 2C, 6D, 24E and 120F."""
    theta = q.theta.symbol
    row = modified_roll()["roll_motion"]
    roll = sum(value * theta ** (k + 1) for k, value in enumerate(row))
    for order, value in zip(range(2, 6), q.roll_coefficients.symbols, strict=True):
        assert sp.simplify(-roll.diff(theta, order).subs(theta, 0) / q.ratio_of_roll.symbol - value) == 0


@cache
def straight_generation() -> Expression:
    """(10.5, 10.6) of a straight blade as an Expression."""
    return _expression(
        "straight_generation",
        "Point, outward normal and meshing residual of a straight blade under every motion (10.5, 10.6).",
        straight(),
        q.u,
        (),
    )


@cache
def arc_generation() -> Expression:
    """(10.5, 10.6) of an arc blade as an Expression: circular-arc flanks and fillets."""
    return _expression(
        "arc_generation",
        "Point, outward normal and meshing residual of an arc blade under every motion (10.3, 10.5, 10.6).",
        arc(),
        q.arc_angle,
        (q.blade_arc,),
    )


@cache
def curved_generation() -> Expression:
    """(10.5, 10.6) of a curved blade as an Expression."""
    return _expression(
        "curved_generation",
        "Point, outward normal and meshing residual of a curved blade under every motion (10.5, 10.6, 10.8).",
        curved(),
        q.u,
        (q.blade_curvature, q.reference_height),
    )


def prove_curved_blade_without_curvature_is_straight() -> None:
    """(10.8) κ = 0: radius and height of chapter 1, at every u."""
    bent, blade = curved(), straight()
    values = {q.blade_curvature.symbol: 0}
    assert is_zero(bent.radius.subs(values) - blade.radius)
    assert is_zero(bent.height.subs(values) - blade.height)


def prove_curved_blade_is_the_arc_that_touches_the_straight_one() -> None:
    """(10.8, 10.9) With κ = 1/r and u = h_r + r sin φ cos α it is the point u_arc = α - φ of (10.3) on the arc (1.4).

    √(1 - κ² t²) = √(1 - sin² φ) = cos φ for |φ| < π/2, and r (1 - cos φ) = r sin² φ/(1 + cos φ).
    """
    phi, r = sp.Symbol("phi", real=True), q.blade_spheric_radius.symbol
    alpha, side = q.blade_pressure_angle.symbol, q.side.symbol
    foot = arc_foot()["u"].subs(q.arc_angle.symbol, alpha - phi)
    values = {q.u.symbol: foot, q.blade_curvature.symbol: 1 / r}
    root = sp.sqrt(1 - ((foot - q.reference_height.symbol) / sp.cos(alpha) / r) ** 2)
    sag = r * sp.sin(phi) ** 2 / (1 + root)
    assert is_zero((1 - sp.sin(phi) ** 2) - (root**2))
    height = foot + sag.subs(root, sp.cos(phi)) * sp.sin(alpha)
    radius = straight().radius.subs(q.u.symbol, foot) - side * sag.subs(root, sp.cos(phi)) * sp.cos(alpha)
    for claimed, own in (
        (curved().height, foot + sag * sp.sin(alpha)),
        (curved().radius, straight().radius.subs(q.u.symbol, foot) - side * sag * sp.cos(alpha)),
    ):
        assert is_zero(claimed.subs(values, simultaneous=True) - own)
    center = dict(zip(q.blade_arc.symbols, cutter.spheric_blade()["blade_arc"], strict=True))
    at = {q.arc_angle.symbol: alpha - phi}
    round_ = arc()
    assert is_zero(round_.height.subs(center).subs(at) - height)
    assert is_zero(round_.radius.subs(center).subs(at) - radius)


def still() -> dict[sp.Symbol, sp.Expr]:
    """No motion, no indexing, no blade offset: the machine of the chapters 2 to 4."""
    values = dict.fromkeys(q.motion.symbols, sp.S.Zero)
    return values | {q.index_ratio.symbol: sp.S.Zero, q.blade_offset_angle.symbol: sp.S.Zero}


def prove_still_settings_give_the_family_of_face_milling() -> None:
    """(10.5) Limit case: universal motion of degree 0 and zero indexing give (3.1)."""
    surface = family(straight(), q.u)
    resting = (Rz(-surface.work_angle) * surface.point).subs(still())
    assert is_zero(resting - flank.point())


def prove_still_normal_is_the_normal_of_the_cutter() -> None:
    """(10.6) Limit case: R_u × R_β is the cutter's normal times ρ/cos α, for both blades, so n is that of (3.2)."""
    surface = family(straight(), q.u)
    cross = surface.along_u.cross(surface.along_beta).subs(still())
    n = (Rz(cradle.work_angle()) * flank.normal()).applyfunc(sp.expand_trig)
    for side in (1, -1):
        rho = straight().radius.subs(q.side.symbol, side)
        difference = surface.outward * cross - n * rho / sp.cos(q.blade_pressure_angle.symbol)
        assert is_zero(difference.subs(q.side.symbol, side))


def prove_still_residual_is_the_equation_of_meshing() -> None:
    """(10.6) Limit case: with the normal of (3.2), n · R_θ is (4.2)."""
    surface = family(straight(), q.u)
    rolling = surface.along_theta.subs(still())
    n_c_in_w = cradle.frame_w() * cradle.cutter_to_machine(cutter.normal())
    assert is_zero(n_c_in_w.dot(rolling) - meshing.residual())


def prove_an_arc_touches_a_straight_blade_where_their_normals_agree() -> None:
    """(10.3) The arc's tangent at u = α has the direction of the straight blade: edge and flank join smoothly."""
    blade, round_ = straight(), arc()
    alpha = q.blade_pressure_angle.symbol
    slope = (round_.radius.diff(q.arc_angle.symbol) / round_.height.diff(q.arc_angle.symbol)).subs(
        q.arc_angle.symbol, alpha
    )
    assert is_zero(slope - blade.radius.diff(q.u.symbol))


def prove_touching_blade_meets_the_arc_with_its_slope() -> None:
    """(10.3) At u, the straight blade has the radius ρ(u) at the height h(u), and dρ/dh of the arc."""
    round_, side, u = arc(), q.side.symbol, q.arc_angle.symbol
    radius, angle = (value for _, value in touching_blade().outputs)
    assert is_zero(radius + side * round_.height * sp.tan(angle) - round_.radius)
    assert is_zero(round_.radius.diff(u) - side * sp.tan(angle) * round_.height.diff(u))


def prove_normal_and_residual_are_those_of_the_turned_surface() -> None:
    """(10.6) With every motion, indexing and offset: R of (10.5) alone, differentiated by numbers as it turns.

    n is square to R_u and R_β, on the side that -s R_u × R_β has (+s of an arc, r > 0), and f = n · R_θ.
    """
    settings = [75, 1, "0.125", "0.875", "3.5", "0.25", 1, "0.375", 3, "0.5", 80, "0.25"]
    motion = [mpmath.mpf(k % 7 - 3) / 2**9 for k in range(q.motion.size)]
    for make, first, extra, turn in (
        (straight_generation, "1.5", [], -1),
        (curved_generation, "1.5", ["0.00390625", 1], -1),
        (arc_generation, "0.5", [90, 3, 12], 1),
    ):
        for side in (1, -1):
            rest = [*map(mpmath.mpf, settings), *motion, mpmath.mpf("0.375"), mpmath.mpf("0.25")]
            rest += [*map(mpmath.mpf, extra), mpmath.mpf(side)]
            with mpmath.workdps(DIGITS):
                at = [mpmath.mpf(first), mpmath.mpf("-0.625"), mpmath.mpf("0.1875")]
                value = make().function(*at, *rest)
                along_u, along_beta, along_theta = (
                    sp.Matrix([_slope(make, at, rest, parameter, axis) for axis in range(3)]) for parameter in range(3)
                )
                n, cross = sp.Matrix(value[3:6]), along_u.cross(along_beta)
                assert is_close(list(turn * side * cross / cross.norm()), list(n), mpmath.mpf(10) ** -15)
                assert is_close([n.dot(along_theta)], [value[6]], mpmath.mpf(10) ** -13)


def _slope(
    make: Callable[[], Expression], at: list[mpmath.mpf], rest: list[mpmath.mpf], parameter: int, axis: int
) -> mpmath.mpf:
    """Slope of one coordinate of the point, by central difference."""
    step = mpmath.mpf(10) ** -12
    ends = []
    for sign in (1, -1):
        moved = [value + sign * step * (k == parameter) for k, value in enumerate(at)]
        ends.append(make().function(*moved, *rest)[axis])
    return (ends[0] - ends[1]) / (2 * step)

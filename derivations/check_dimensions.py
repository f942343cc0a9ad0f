"""Chapter 9, continued. The dimensions by which a hobbed gear is checked: blank, span, chord, and over pins.

    m_t = m_n / cos β,  tan α_t = tan α_n / cos β,  sin β_b = sin β cos α_n,  d = z m_t,  d_b = d cos α_t     (9.6)
    d_a = m_n (z / cos β + 2 + 2x)                                                             (9.7)

Span over k teeth, chordal thickness and height (of the virtual spur gear, z_v = z/cos³ β), and over pins, with
inv α = tan α - α. The pin angle φ is the root of (9.12); for an odd number of teeth its term in (9.13) is shortened.

    k_th = z K + 1/2,   π K = (1 + sin² β / (cos² β + tan² α_n)) √((cos² β + tan² α_n)(1/cos β + 2x/z)² - 1)
                              - inv α_t - 2 (x/z) tan α_n                                      (9.8)
    W = m_n cos α_n (π (k - 1/2) + z inv α_t) + 2 x m_n sin α_n,   d_W² = d_b² + (W cos β_b)²  (9.9)
    s_n = m_n (π/2 + 2x tan α_n),   ψ = s_n / (m_n z_v)                                        (9.10)
    s̄ = m_n z_v sin ψ,   h̄_a = m_n (1 + x) + m_n z_v (1 - cos ψ) / 2                           (9.11)
    f = inv φ - d_p / (z m_n cos α_n) + π/(2z) - inv α_t - 2x tan α_n / z                      (9.12)
    M = d_b / cos φ [cos(π/(2z))] + d_p,   2 l_p = d_b tan φ - d_p cos β_b,   d_p'² = d_b² + (2 l_p)²         (9.13)

z is the number of teeth, x the profile shift in modules, β the helix angle; suffix t is transverse, b at the base.
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from derivations import gearbox
from derivations import notation as q
from derivations.expression import Expression
from derivations.proof import is_zero

_TEXTBOOK = "ISO 21771; worked examples of the SDP/SI handbook"
HALF = sp.Rational(1, 2)


def involute(angle: sp.Expr) -> sp.Expr:
    """inv of an angle."""
    return sp.tan(angle) - angle


def transverse_angle() -> sp.Expr:
    """α_t of (9.6)."""
    return sp.atan(sp.tan(q.pressure_angle.symbol) / sp.cos(q.helix_angle.symbol))


def base_helix() -> sp.Expr:
    """β_b of (9.6)."""
    return sp.asin(sp.sin(q.helix_angle.symbol) * sp.cos(q.pressure_angle.symbol))


def diameter() -> sp.Expr:
    """d of (9.6)."""
    return q.teeth.symbol * q.module.symbol / sp.cos(q.helix_angle.symbol)


@cache
def transverse_gear() -> Expression:
    """(9.6) as an Expression."""
    d, alpha_t = diameter(), transverse_angle()
    return Expression(
        "transverse_gear",
        "A helical gear in the plane normal to its axis, and its base cylinder (9.6).",
        (q.teeth, q.module, q.pressure_angle, q.helix_angle),
        (
            (q.transverse_module, q.module.symbol / sp.cos(q.helix_angle.symbol)),
            (q.transverse_pressure_angle, alpha_t),
            (q.base_helix_angle, base_helix()),
            (q.reference_diameter, d),
            (q.base_diameter, d * sp.cos(alpha_t)),
        ),
        source=_TEXTBOOK,
    )


@cache
def helical_blank() -> Expression:
    """(9.7) as an Expression."""
    return Expression(
        "helical_blank",
        "Outside diameter of the blank of a helical gear with profile shift (9.7).",
        (q.teeth, q.module, q.helix_angle, q.profile_shift),
        ((q.tip_diameter, diameter() + q.module.symbol * (2 + 2 * q.profile_shift.symbol)),),
        source=_TEXTBOOK,
    )


@cache
def span_teeth() -> Expression:
    """(9.8) as an Expression."""
    shift = q.profile_shift.symbol / q.teeth.symbol
    tangent, beta = sp.tan(q.pressure_angle.symbol), q.helix_angle.symbol
    rest = sp.cos(beta) ** 2 + tangent**2
    inside = rest * (1 / sp.cos(beta) + 2 * shift) ** 2 - 1
    K = (1 + sp.sin(beta) ** 2 / rest) * sp.sqrt(inside) - involute(transverse_angle()) - 2 * shift * tangent
    return Expression(
        "span_teeth",
        "Number of teeth over which the span touches in the middle of the flanks (9.8).",
        (q.teeth, q.pressure_angle, q.helix_angle, q.profile_shift),
        ((q.best_spanned_teeth, q.teeth.symbol * K / sp.pi + HALF),),
        requires=(inside - sp.Rational(1, 1000), sp.Rational(1, 4) + shift),
        source=_TEXTBOOK,
    )


@cache
def span_measurement() -> Expression:
    """(9.9) as an Expression."""
    alpha, module, x = q.pressure_angle.symbol, q.module.symbol, q.profile_shift.symbol
    arc = sp.pi * (q.spanned_teeth.symbol - HALF) + q.teeth.symbol * involute(transverse_angle())
    W = module * sp.cos(alpha) * arc + 2 * x * module * sp.sin(alpha)
    base = diameter() * sp.cos(transverse_angle())
    return Expression(
        "span_measurement",
        "Span (base tangent length) over k teeth, where it touches, and the face width that it needs (9.9).",
        (q.spanned_teeth, q.teeth, q.module, q.pressure_angle, q.helix_angle, q.profile_shift),
        (
            (q.span, W),
            (q.span_contact_diameter, sp.sqrt(base**2 + (W * sp.cos(base_helix())) ** 2)),
            (q.span_face_width, W * sp.sin(base_helix())),
        ),
        source=_TEXTBOOK,
    )


@cache
def chordal_thickness() -> Expression:
    """(9.10, 9.11) as an Expression."""
    module, x = q.module.symbol, q.profile_shift.symbol
    virtual = module * q.teeth.symbol / sp.cos(q.helix_angle.symbol) ** 3
    s = module * (sp.pi / 2 + 2 * x * sp.tan(q.pressure_angle.symbol))
    psi = s / virtual
    return Expression(
        "chordal_thickness",
        "Chord of a tooth at the reference cylinder and the height of the tip above it (9.10, 9.11).",
        (q.teeth, q.module, q.pressure_angle, q.helix_angle, q.profile_shift),
        (
            (q.tooth_thickness, s),
            (q.thickness_half_angle, psi),
            (q.chordal_thickness, virtual * sp.sin(psi)),
            (q.chordal_height, module * (1 + x) + virtual * (1 - sp.cos(psi)) / 2),
        ),
        source=_TEXTBOOK,
    )


@cache
def pin_equation() -> Expression:
    """(9.12) as an Expression."""
    z, alpha = q.teeth.symbol, q.pressure_angle.symbol
    wanted = (
        q.pin_diameter.symbol / (z * q.module.symbol * sp.cos(alpha))
        - sp.pi / (2 * z)
        + involute(transverse_angle())
        + 2 * q.profile_shift.symbol * sp.tan(alpha) / z
    )
    return Expression(
        "pin_equation",
        "Pressure angle at the centre of a pin in a tooth space: zero at the root (9.12).",
        (q.pin_angle, q.pin_diameter, q.teeth, q.module, q.pressure_angle, q.helix_angle, q.profile_shift),
        ((q.pin_residual, involute(q.pin_angle.symbol) - wanted),),
        source=_TEXTBOOK,
    )


@cache
def over_pins() -> Expression:
    """(9.13) as an Expression."""
    base = diameter() * sp.cos(transverse_angle())
    shortened = 1 + q.odd_teeth.symbol * (sp.cos(sp.pi / (2 * q.teeth.symbol)) - 1)
    pin, angle = q.pin_diameter.symbol, q.pin_angle.symbol
    length = base * sp.tan(angle) - pin * sp.cos(base_helix())
    return Expression(
        "over_pins",
        "Measurement over two pins (balls for an odd helical gear), and where they touch (9.13).",
        (q.pin_angle, q.odd_teeth, q.pin_diameter, q.teeth, q.module, q.pressure_angle, q.helix_angle),
        (
            (q.over_pins, base / sp.cos(angle) * shortened + pin),
            (q.pin_contact_length, length),
            (q.pin_contact_diameter, sp.sqrt(base**2 + length**2)),
        ),
        source=_TEXTBOOK,
    )


#: Worked examples: SDP/SI handbook, tables 10-1 (chordal), span over 4 teeth and its number before rounding, over pins.
PUBLISHED_SPAN = ("3.78787", "32.8266")  # m = 3, z = 24, x = 0.4: teeth before rounding, span over 4
PUBLISHED_CHORD = ("17.8918", "8.54270", "17.8256", "13.6657")  # m = 10, z = 12, x = 0.3
PUBLISHED_PINS = "22.22489"  # m = 1, z = 20, d_p = 1.68


def _at(expression: Expression, **values: sp.Expr | float) -> dict[sp.Symbol, sp.Expr]:
    """Substitution of the named inputs."""
    return {quantity.symbol: sp.sympify(values[quantity.name]) for quantity in expression.inputs}


def _prints(value: sp.Expr, printed: str) -> bool:
    """Whether a value rounds to what is printed."""
    last = sp.Rational(1, 10 ** len(printed.split(".")[1]))
    return bool(abs(value.evalf(30) - sp.Rational(printed)) <= last / 2)


def prove_published_span() -> None:
    """(9.8, 9.9) m = 3, z = 24, x = 0.4, 20°: k = 3.78787 before rounding, W over 4 teeth = 32.8266."""
    gear = {"teeth": 24, "module": 3, "pressure_angle": sp.pi / 9, "helix_angle": 0, "profile_shift": sp.Rational(2, 5)}
    number, span = span_teeth(), span_measurement()
    assert _prints(number["best_spanned_teeth"].subs(_at(number, **gear)), PUBLISHED_SPAN[0])
    assert _prints(span["span"].subs(_at(span, **gear, spanned_teeth=4)), PUBLISHED_SPAN[1])


def prove_published_chordal_dimensions() -> None:
    """(9.10, 9.11) m = 10, z = 12, x = 0.3, 20°: 17.8918 mm, 8.54270°, 17.8256 mm, 13.6657 mm."""
    rule = chordal_thickness()
    at = _at(rule, teeth=12, module=10, pressure_angle=sp.pi / 9, helix_angle=0, profile_shift=sp.Rational(3, 10))
    values = [value.subs(at) for _, value in rule.scalars()]
    values[1] = values[1] * 180 / sp.pi
    assert all(_prints(value, printed) for value, printed in zip(values, PUBLISHED_CHORD, strict=True))


def prove_published_measurement_over_pins() -> None:
    """(9.12, 9.13) m = 1, z = 20, d_p = 1.68, 20°: M = 22.22489."""
    gear = {"teeth": 20, "module": 1, "pressure_angle": sp.pi / 9, "helix_angle": 0, "pin_diameter": "1.68"}
    rule, measure, angle = pin_equation(), over_pins(), q.pin_angle.symbol
    residual = rule["pin_residual"].subs(_at(rule, **gear, profile_shift=0, pin_angle=angle))
    root = sp.nsolve(residual, angle, 0.4, prec=30)
    assert _prints(measure["over_pins"].subs(_at(measure, **gear, odd_teeth=0, pin_angle=root)), PUBLISHED_PINS)


def prove_base_cylinder_relations() -> None:
    """(9.6) tan β_b = tan β cos α_t, and d_b cos β_b = z m_n cos α_n: the base pitch is that of the hob."""
    alpha_t, beta_b = transverse_angle(), base_helix()
    beta, alpha = q.helix_angle.symbol, q.pressure_angle.symbol
    tangent = sp.tan(beta) * sp.cos(alpha_t)
    assert sp.simplify((sp.sin(beta) * sp.cos(alpha)) ** 2 * (1 + tangent**2) - tangent**2) == 0  # = sin² β_b
    pitch = diameter() * sp.cos(alpha_t) * sp.cos(beta_b) / (q.teeth.symbol * q.module.symbol)
    assert sp.simplify(pitch**2 - sp.cos(alpha) ** 2) == 0


def prove_span_touches_where_it_should() -> None:
    """(9.8, 9.9) Over k_th teeth a spur gear is touched at d + 2 x m; a helical one too, here to 20 digits."""
    number, span = span_teeth(), span_measurement()
    z, m, x = q.teeth.symbol, q.module.symbol, q.profile_shift.symbol
    spur = {q.helix_angle.symbol: 0}
    W = span["span"].subs(q.spanned_teeth.symbol, number["best_spanned_teeth"]).subs(spur)
    squared = W**2 + (z * m * sp.cos(q.pressure_angle.symbol)) ** 2
    assert sp.simplify(sp.expand(squared - (m * z + 2 * x * m) ** 2)) == 0
    gear = {"teeth": 31, "module": 2, "pressure_angle": sp.pi / 9, "helix_angle": sp.pi / 8}
    gear["profile_shift"] = sp.Rational(3, 10)
    best = number["best_spanned_teeth"].subs(_at(number, **gear))
    touched = span["span_contact_diameter"].subs(_at(span, **gear, spanned_teeth=best))
    assert abs((touched - 62 / sp.cos(sp.pi / 8) - sp.Rational(6, 5)).evalf(30)) < 1e-20


def prove_chord_of_a_rack_is_its_thickness() -> None:
    """(9.10, 9.11) Limit case z → ∞: chord and thickness, height and addendum are the same."""
    rule = chordal_thickness()
    chord, height = (rule[name].subs(q.helix_angle.symbol, 0) for name in ("chordal_thickness", "chordal_height"))
    z = q.teeth.symbol
    large = sp.Symbol("z", positive=True)
    assert sp.simplify(sp.limit(chord.subs(z, large), large, sp.oo) - rule["tooth_thickness"]) == 0
    addendum = q.module.symbol * (1 + q.profile_shift.symbol)
    assert sp.simplify(sp.limit(height.subs(z, large), large, sp.oo) - addendum) == 0


def prove_pin_touches_both_flanks_of_its_space() -> None:
    """(9.12, 9.13) A spur gear: on the normal of the flank, the pin's radius away, lies the middle of the space.

    An involute of the base circle r starts half a base space from the middle, π/(2z) - 2x tan α/z - inv α. Its normal
    at the unrolled angle t touches the base circle at the angle θ, t further; the pin's centre lies on it, behind the
    contact by the pin's radius. Where that centre stands at the polar angle 0, (9.12) is zero.
    """
    rule, z, pin = pin_equation(), q.teeth.symbol, q.pin_diameter.symbol
    alpha, x, phi = q.pressure_angle.symbol, q.profile_shift.symbol, q.pin_angle.symbol
    r = z * q.module.symbol * sp.cos(alpha) / 2
    half_space = sp.pi / (2 * z) - 2 * x * sp.tan(alpha) / z - involute(alpha)
    line = r * sp.tan(phi)  # from the base circle to the pin's centre
    t = (line - pin / 2) / r  # unrolled to the contact
    theta = sp.Symbol("theta", real=True)
    center = r * sp.Matrix([sp.cos(theta), sp.sin(theta)]) - line * sp.Matrix([-sp.sin(theta), sp.cos(theta)])
    assert is_zero(center.subs(theta, phi) - sp.Matrix([r / sp.cos(phi), 0]))
    spur = {q.helix_angle.symbol: 0, alpha: sp.atan(sp.Symbol("w", positive=True))}
    assert sp.simplify((rule["pin_residual"] - (half_space + t - phi)).subs(spur)) == 0  # = θ - φ
    assert sp.simplify((over_pins()["pin_contact_length"] - 2 * r * t).subs(spur)) == 0


def prove_spur_blank_is_that_of_the_gearbox_chapter() -> None:
    """(9.7) Limit case β = 0, x = 0: m (z + 2) of (7.7)."""
    blank = helical_blank()["tip_diameter"].subs({q.helix_angle.symbol: 0, q.profile_shift.symbol: 0})
    assert sp.expand(blank - gearbox.hobbed_blank()["blank_diameter"]) == 0

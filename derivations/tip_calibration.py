"""Chapter 23. The tip of a probe: its centre and its effective radius, out of touches on a ring and on a sphere.

The centre of the tip stands in the machine at V_m = (X, Y, Z) + (x_cm, y_cm, z_cm), of which o is what differs from the
stylus on the spindle axis (15.3). In a ring of diameter D, whose centre is known to lie at L, touches along one axis at
X_1 < X_2 give

    o = L - (X_1 + X_2)/2,   r = (D - (X_2 - X_1))/2                                           (23.1)

and on a sphere of radius R_s and known centre c, touches at p leave, whatever their direction,

    |p + o - c| - (R_s + r(m)) = 0,   m = (p + o - c)/|p + o - c|                              (23.2)

A probe on three points triggers later where it presses between two of them. With m the outward normal of what is
touched, φ its azimuth about the stylus and θ its angle from the stylus, the effective radius is

    r + a cos 3(φ - φ_0) sin θ

which needs no angle when it is written with the vector (a cos 3φ_0, a sin 3φ_0):

    r(m) = r + (a_1 (m_x³ - 3 m_x m_y²) + a_2 (3 m_x² m_y - m_y³))/(m_x² + m_y²)               (23.3)
    a = |a|,   φ_0 = atan2(a_2, a_1)/3                                                         (23.4)

Any touch in the ring leaves, with d = (p + o - L) in X and Y only,

    |d| + r(m) - D/2 = 0,   m = -d/|d|                                                         (23.5)

of which (23.1) is the case of two opposite touches. A touch from above, on the face of a ring of height F on a seat at
the height D, has the centre of the tip at D + F + r, and so

    z_cm = D + F + r - Z_c                                                                     (23.6)
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from derivations import notation as q
from derivations.expression import Expression
from derivations.proof import is_zero

#: Keeps a fraction defined where both of its parts vanish; nothing to any other.
_LEAST = sp.Rational(1, 10**24)


def radius_towards(m: sp.Matrix) -> sp.Expr:
    """r(m) (23.3); the least of numbers under the fraction keeps it defined along the stylus, where it is r."""
    a_1, a_2 = q.lobing.symbols
    x, y = m[0], m[1]
    lobes = a_1 * (x**3 - 3 * x * y**2) + a_2 * (3 * x**2 * y - y**3)
    return q.tip_radius.symbol + lobes / (x**2 + y**2 + _LEAST)


def _length(vector: sp.Matrix) -> sp.Expr:
    return sp.sqrt(sum(component**2 for component in vector))


@cache
def ring_calibration() -> Expression:
    """(23.1) as an Expression."""
    first, last = q.first_trigger.symbol, q.last_trigger.symbol
    return Expression(
        "ring_calibration",
        "Offset and radius of the tip out of two opposite touches in a ring (23.1).",
        (q.first_trigger, q.last_trigger, q.ring_center, q.ring_diameter),
        (
            (q.axis_offset, q.ring_center.symbol - (first + last) / 2),
            (q.tip_radius, (q.ring_diameter.symbol - (last - first)) / 2),
        ),
        source="derived afresh: the source text sets both X_1 + x_cm and X_2 + x_cm equal to L_x, so that X_1 = X_2",
    )


@cache
def effective_radius() -> Expression:
    """(23.3) as an Expression."""
    return Expression(
        "effective_radius",
        "Radius of the tip that a touch in its direction has, with the three lobes of its pre-travel (23.3).",
        (q.touch_normal, q.tip_radius, q.lobing),
        ((q.effective_radius, radius_towards(q.touch_normal.symbol)),),
        source="Estler et al., Precision Engineering 1996/97: pre-travel of three-point probes",
    )


@cache
def lobing_of() -> Expression:
    """(23.4), from amplitude and azimuth, as an Expression."""
    a, phase = q.lobing_amplitude.symbol, 3 * q.lobing_phase.symbol
    return Expression(
        "lobing_of",
        "Lobes of the effective radius out of their amplitude and the azimuth of one (23.4).",
        (q.lobing_amplitude, q.lobing_phase),
        ((q.lobing, sp.Matrix([a * sp.cos(phase), a * sp.sin(phase)])),),
        source="real and imaginary part of a e^(3iφ_0)",
    )


@cache
def shape_of_lobes() -> Expression:
    """(23.4) as an Expression."""
    a_1, a_2 = q.lobing.symbols
    size = sp.sqrt(a_1**2 + a_2**2)
    return Expression(
        "shape_of_lobes",
        "Amplitude of the lobes of the effective radius and the azimuth of one (23.4).",
        (q.lobing,),
        ((q.lobing_amplitude, size), (q.lobing_phase, sp.atan2(a_2, a_1) / 3)),
        requires=(size - sp.Rational(1, 1000),),
        source="(23.4)",
    )


@cache
def sphere_residual() -> Expression:
    """(23.2) as an Expression."""
    off = q.trigger.symbol + q.tip_offset.symbol - q.sphere_center.symbol
    distance = _length(off)
    return Expression(
        "sphere_residual",
        "What a touch on the calibration sphere leaves of its equation; zero for the right tip (23.2).",
        (q.trigger, q.tip_offset, q.tip_radius, q.sphere_center, q.sphere_radius, q.lobing),
        ((q.sphere_rest, distance - q.sphere_radius.symbol - radius_towards(off / distance)),),
        requires=(distance - 1,),
        source="two spheres touch where their centres are the sum of their radii apart",
    )


@cache
def ring_residual() -> Expression:
    """(23.5) as an Expression."""
    moved = q.trigger.symbol + q.tip_offset.symbol
    off = sp.Matrix([moved[0] - q.ring_axis.symbol[0], moved[1] - q.ring_axis.symbol[1]])
    distance = _length(off)
    return Expression(
        "ring_residual",
        "What a touch in the calibration ring leaves of its equation; zero for the right tip (23.5).",
        (q.trigger, q.tip_offset, q.tip_radius, q.ring_axis, q.ring_diameter, q.lobing),
        ((q.ring_rest, distance + radius_towards(-off / distance) - q.ring_diameter.symbol / 2),),
        requires=(distance - 1,),
        source="a circle within a circle touches it where their centres are the difference of their radii apart",
    )


@cache
def face_calibration() -> Expression:
    """(23.6) as an Expression."""
    centre = q.seat_height.symbol + q.ring_height.symbol + q.tip_radius.symbol
    return Expression(
        "face_calibration",
        "Offset of the tip along Z out of a touch from above on the face of the ring (23.6).",
        (q.face_trigger, q.seat_height, q.ring_height, q.tip_radius),
        ((q.axis_offset, centre - q.face_trigger.symbol),),
        source="the source text's z_cm = D + F + r_m - Z_c, of whose letters it defines none",
    )


def prove_ring_gives_back_the_tip_that_touched_it() -> None:
    """(23.1) A tip of radius r, off by o, touches the wall at L ± (D/2 - r) - o: both come back."""
    o, r = sp.symbols("o r", real=True)
    L, D = q.ring_center.symbol, q.ring_diameter.symbol
    values = {q.first_trigger.symbol: L - (D / 2 - r) - o, q.last_trigger.symbol: L + (D / 2 - r) - o}
    assert sp.expand(ring_calibration()["axis_offset"].subs(values) - o) == 0
    assert sp.expand(ring_calibration()["tip_radius"].subs(values) - r) == 0


def prove_source_text_s_ring_equation_leaves_no_room_for_a_ring() -> None:
    """(23.1) L = X_1 + x_cm = X_2 + x_cm has a solution only where both touches are the same."""
    first, last, x_cm = sp.symbols("X_1 X_2 x_cm", real=True)
    (solution,) = sp.solve([first + x_cm - (last + x_cm)], [first], dict=True)
    assert solution[first] == last


def prove_sphere_leaves_nothing_for_the_tip_that_touched_it() -> None:
    """(23.2) A trigger at c - o + (R_s + r) m, m any unit vector, leaves zero."""
    polar, azimuth = sp.symbols("polar azimuth", real=True)
    m = sp.Matrix([sp.sin(polar) * sp.cos(azimuth), sp.sin(polar) * sp.sin(azimuth), sp.cos(polar)])
    reach = q.sphere_radius.symbol + q.tip_radius.symbol
    trigger = q.sphere_center.symbol - q.tip_offset.symbol + reach * m
    off = trigger + q.tip_offset.symbol - q.sphere_center.symbol
    assert is_zero(off.dot(off) - reach**2)
    given = dict(zip(q.trigger.symbols, trigger, strict=True)) | dict.fromkeys(q.lobing.symbols, 0)
    rest = sphere_residual()["sphere_rest"].subs(given, simultaneous=True)
    assert is_zero((rest + reach) ** 2 - reach**2)


def prove_lobes_come_back_every_third_of_a_turn_and_leave_the_stylus_alone() -> None:
    """(23.3, 23.4) With m by its angles and a by amplitude and azimuth, r(m) = r + a cos 3(φ - φ_0) sin θ.

    So a turn of m by 120° leaves it as it is, one by 60° turns the sign of the lobes, and along the stylus it is r.
    """
    phi, theta = sp.symbols("phi theta", real=True)
    m = sp.Matrix([sp.sin(theta) * sp.cos(phi), sp.sin(theta) * sp.sin(phi), sp.cos(theta)])
    given = dict(zip(q.touch_normal.symbols, m, strict=True)) | {_LEAST: 0}
    given |= dict(zip(q.lobing.symbols, lobing_of()["lobing"], strict=True))
    value = effective_radius()["effective_radius"].subs(given, simultaneous=True) - q.tip_radius.symbol
    expected = q.lobing_amplitude.symbol * sp.cos(3 * (phi - q.lobing_phase.symbol)) * sp.sin(theta)
    assert is_zero(value - expected)
    for by, sign in ((sp.Rational(2, 3) * sp.pi, 1), (sp.pi / 3, -1)):
        assert is_zero(expected.subs(phi, phi + by) - sign * expected)
    along = dict(zip(q.touch_normal.symbols, (0, 0, 1), strict=True))
    assert effective_radius()["effective_radius"].subs(along) == q.tip_radius.symbol


def prove_amplitude_and_azimuth_make_the_lobes_that_they_are_of() -> None:
    """(23.4) |a| (cos, sin) of three times the azimuth are a_1 and a_2 again."""
    a_1, a_2 = q.lobing.symbols
    size, azimuth = (shape_of_lobes()[name] for name in ("lobing_amplitude", "lobing_phase"))
    shape = {q.lobing_amplitude.symbol: size, q.lobing_phase.symbol: azimuth}
    again = sp.Matrix(lobing_of()["lobing"]).subs(shape)
    assert is_zero(again - sp.Matrix([a_1, a_2]))


def prove_opposite_touches_in_the_ring_leave_nothing_for_the_tip_of_their_equation() -> None:
    """(23.1, 23.5) The tip that (23.1) finds from touches along X, its lobes none, solves (23.5) for both of them."""
    first, gap = q.first_trigger.symbol, sp.Symbol("gap", positive=True)
    tip = ring_calibration()
    values = {
        q.tip_radius.symbol: tip["tip_radius"],
        q.tip_offset.symbols[0]: tip["axis_offset"],
        q.ring_axis.symbols[0]: q.ring_center.symbol,
        q.trigger.symbols[1]: q.ring_axis.symbols[1] - q.tip_offset.symbols[1],
    } | dict.fromkeys(q.lobing.symbols, 0)
    for place in (first, first + gap):
        rest = ring_residual()["ring_rest"].subs(values | {q.trigger.symbols[0]: place}, simultaneous=True)
        assert sp.simplify(rest.subs(q.last_trigger.symbol, first + gap)) == 0


def prove_tip_on_the_face_of_the_ring_has_its_offset_back() -> None:
    """(23.6, 23.5) A tip off by o_z whose lowest point is on the face, at D + F, has its centre r above it."""
    o_z = sp.Symbol("o_z", real=True)
    lowest = q.face_trigger.symbol + o_z - q.tip_radius.symbol
    (at,) = sp.solve(lowest - (q.seat_height.symbol + q.ring_height.symbol), q.face_trigger.symbol)
    assert sp.expand(face_calibration()["axis_offset"].subs(q.face_trigger.symbol, at) - o_z) == 0

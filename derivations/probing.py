"""Chapter 15. Probing: where the tip of a stylus must stand to touch a flank, and what a touch says.

The centre of a tip of radius r that touches the flank in R, or keeps a distance s from it along the outward normal n:

    C = R + (r + s) n                                                                          (15.1)

The stylus stands in the tool spindle and looks down. It enters the tooth space square to the root cone, B = Γ_f, with
the middle of the space, between R and the opposite flank's R' of the same z_w and radius, turned to the top:

    A = atan2(y + y', x + x')                                                                  (15.2)

With H the height of the tip over the B axis at Z = 0 and o the centre of the tip off the spindle axis and off H:

    (X, Y, Z) = M(B) (Rz(-A) C + e) - o + (0, 0, H)                                            (15.3)
    C = Rz(A) (M(B)' ((X, Y, Z) - (0, 0, H) + o) - e)                                          (15.4)

A touch with the tip at C gives, along the nominal normal, the contact point C - r n and, by (6.1), the deviation

    P = C - r n,   δ = (C - R)·n - r                                                           (15.5)

Calibration. The centre of the tip stands in the machine at V_m = (X, Y, Z) + (x_cm, y_cm, z_cm), of which o is what
differs from the stylus on the spindle axis. In a ring of diameter D, whose centre is known to lie at L, touches along
one axis at X_1 < X_2 give

    o = L - (X_1 + X_2)/2,   r = (D - (X_2 - X_1))/2                                           (15.6)

and on a sphere of radius R_s and known centre c, touches at p leave, whatever their direction,

    |p + o - c| - (R_s + r(m)) = 0,   m = (p + o - c)/|p + o - c|                              (15.7)

A probe on three points triggers later where it presses between two of them. With m the outward normal of what is
touched, φ its azimuth about the stylus and θ its angle from the stylus, the effective radius is

    r + a cos 3(φ - φ_0) sin θ

which needs no angle when it is written with the vector (a cos 3φ_0, a sin 3φ_0):

    r(m) = r + (a_1 (m_x³ - 3 m_x m_y²) + a_2 (3 m_x² m_y - m_y³))/(m_x² + m_y²)               (15.8)
    a = |a|,   φ_0 = atan2(a_2, a_1)/3                                                         (15.9)

Any touch in the ring leaves, with d = (p + o - L) in X and Y only,

    |d| + r(m) - D/2 = 0,   m = -d/|d|                                                         (15.10)

of which (15.6) is the case of two opposite touches. A touch from above, on the face of a ring of height F on a seat at
the height D, has the centre of the tip at D + F + r, and so

    z_cm = D + F + r - Z_c                                                                     (15.11)
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from derivations import axes, deviation
from derivations import notation as q
from derivations.expression import Expression
from derivations.frames import Rz
from derivations.proof import is_zero

#: Keeps a fraction defined where both of its parts vanish; nothing to any other.
_LEAST = sp.Rational(1, 10**24)


@cache
def probe_target() -> Expression:
    """(15.1) as an Expression."""
    return Expression(
        "probe_target",
        "Centre of a stylus tip at a distance from a flank point, along its outward normal (15.1).",
        (q.point_w, q.normal_w, q.tip_radius, q.standoff),
        ((q.tip_center, q.point_w.symbol + (q.tip_radius.symbol + q.standoff.symbol) * q.normal_w.symbol),),
        source="the offset surface R ± n r_m of the source text, with a unit normal that knows its side",
    )


@cache
def space_azimuth() -> Expression:
    """(15.2) as an Expression."""
    x, y, _ = q.point_w.symbol + q.opposite_w.symbol
    return Expression(
        "space_azimuth",
        "Position of the work axis that turns the middle of a tooth space to the top (15.2).",
        (q.point_w, q.opposite_w),
        ((q.A, sp.atan2(y, x)),),
        requires=(x**2 + y**2 - 1,),
        source="(5.4): what has the azimuth A in the work lies in the plane of X and Z",
    )


def _height() -> sp.Matrix:
    return sp.Matrix([0, 0, q.probe_height.symbol])


@cache
def probe_axes() -> Expression:
    """(15.3) as an Expression."""
    work = Rz(-q.A.symbol) * q.tip_center.symbol + q.pivot_offset.symbol
    position = axes.swivel(q.B.symbol) * work - q.tip_offset.symbol + _height()
    return Expression(
        "probe_axes",
        "Axis positions that put the tip of the stylus at a place of the work (15.3).",
        (q.tip_center, q.A, q.B, q.probe_height, q.tip_offset, q.pivot_offset),
        ((q.axes, sp.Matrix([*position, q.A.symbol, q.B.symbol])),),
        source="(5.4) with the stylus in the place of the cutter",
    )


@cache
def probe_tip() -> Expression:
    """(15.4) as an Expression."""
    machine = sp.Matrix([q.X.symbol, q.Y.symbol, q.Z.symbol]) - _height() + q.tip_offset.symbol
    work = axes.swivel(q.B.symbol).T * machine - q.pivot_offset.symbol
    return Expression(
        "probe_tip",
        "Centre of the tip, and direction of the stylus from tip to spindle, out of the axis positions (15.4).",
        (q.axes, q.probe_height, q.tip_offset, q.pivot_offset),
        (
            (q.tip_center, Rz(q.A.symbol) * work),
            (q.stylus_w, axes.machine_to_work(sp.Matrix([0, 0, 1]))),
        ),
        source="(15.3) inverted",
    )


@cache
def touched_point() -> Expression:
    """(15.5) as an Expression."""
    return Expression(
        "touched_point",
        "Corrected contact point and deviation of a touch, along the nominal normal (15.5).",
        (q.tip_center, q.tip_radius, q.point_w, q.normal_w),
        (
            (q.contact_point, q.tip_center.symbol - q.tip_radius.symbol * q.normal_w.symbol),
            (q.deviation, deviation.point_deviation()["deviation"]),
        ),
        source="(6.1) and (15.1)",
    )


@cache
def ring_calibration() -> Expression:
    """(15.6) as an Expression."""
    first, last = q.first_trigger.symbol, q.last_trigger.symbol
    return Expression(
        "ring_calibration",
        "Offset and radius of the tip out of two opposite touches in a ring (15.6).",
        (q.first_trigger, q.last_trigger, q.ring_center, q.ring_diameter),
        (
            (q.axis_offset, q.ring_center.symbol - (first + last) / 2),
            (q.tip_radius, (q.ring_diameter.symbol - (last - first)) / 2),
        ),
        source="derived afresh: the source text sets both X_1 + x_cm and X_2 + x_cm equal to L_x, so that X_1 = X_2",
    )


def radius_towards(m: sp.Matrix) -> sp.Expr:
    """r(m) (15.8); the least of numbers under the fraction keeps it defined along the stylus, where it is r."""
    a_1, a_2 = q.lobing.symbols
    x, y = m[0], m[1]
    lobes = a_1 * (x**3 - 3 * x * y**2) + a_2 * (3 * x**2 * y - y**3)
    return q.tip_radius.symbol + lobes / (x**2 + y**2 + _LEAST)


def _length(vector: sp.Matrix) -> sp.Expr:
    return sp.sqrt(sum(component**2 for component in vector))


@cache
def effective_radius() -> Expression:
    """(15.8) as an Expression."""
    return Expression(
        "effective_radius",
        "Radius of the tip that a touch in its direction has, with the three lobes of its pre-travel (15.8).",
        (q.touch_normal, q.tip_radius, q.lobing),
        ((q.effective_radius, radius_towards(q.touch_normal.symbol)),),
        source="Estler et al., Precision Engineering 1996/97: pre-travel of three-point probes",
    )


@cache
def lobing_of() -> Expression:
    """(15.9), from amplitude and azimuth, as an Expression."""
    a, phase = q.lobing_amplitude.symbol, 3 * q.lobing_phase.symbol
    return Expression(
        "lobing_of",
        "Lobes of the effective radius out of their amplitude and the azimuth of one (15.9).",
        (q.lobing_amplitude, q.lobing_phase),
        ((q.lobing, sp.Matrix([a * sp.cos(phase), a * sp.sin(phase)])),),
        source="real and imaginary part of a e^(3iφ_0)",
    )


@cache
def shape_of_lobes() -> Expression:
    """(15.9) as an Expression."""
    a_1, a_2 = q.lobing.symbols
    size = sp.sqrt(a_1**2 + a_2**2)
    return Expression(
        "shape_of_lobes",
        "Amplitude of the lobes of the effective radius and the azimuth of one (15.9).",
        (q.lobing,),
        ((q.lobing_amplitude, size), (q.lobing_phase, sp.atan2(a_2, a_1) / 3)),
        requires=(size - sp.Rational(1, 1000),),
        source="(15.9)",
    )


@cache
def sphere_residual() -> Expression:
    """(15.7) as an Expression."""
    off = q.trigger.symbol + q.tip_offset.symbol - q.sphere_center.symbol
    distance = _length(off)
    return Expression(
        "sphere_residual",
        "What a touch on the calibration sphere leaves of its equation; zero for the right tip (15.7).",
        (q.trigger, q.tip_offset, q.tip_radius, q.sphere_center, q.sphere_radius, q.lobing),
        ((q.sphere_rest, distance - q.sphere_radius.symbol - radius_towards(off / distance)),),
        requires=(distance - 1,),
        source="two spheres touch where their centres are the sum of their radii apart",
    )


@cache
def ring_residual() -> Expression:
    """(15.10) as an Expression."""
    moved = q.trigger.symbol + q.tip_offset.symbol
    off = sp.Matrix([moved[0] - q.ring_axis.symbol[0], moved[1] - q.ring_axis.symbol[1]])
    distance = _length(off)
    return Expression(
        "ring_residual",
        "What a touch in the calibration ring leaves of its equation; zero for the right tip (15.10).",
        (q.trigger, q.tip_offset, q.tip_radius, q.ring_axis, q.ring_diameter, q.lobing),
        ((q.ring_rest, distance + radius_towards(-off / distance) - q.ring_diameter.symbol / 2),),
        requires=(distance - 1,),
        source="a circle within a circle touches it where their centres are the difference of their radii apart",
    )


@cache
def face_calibration() -> Expression:
    """(15.11) as an Expression."""
    centre = q.seat_height.symbol + q.ring_height.symbol + q.tip_radius.symbol
    return Expression(
        "face_calibration",
        "Offset of the tip along Z out of a touch from above on the face of the ring (15.11).",
        (q.face_trigger, q.seat_height, q.ring_height, q.tip_radius),
        ((q.axis_offset, centre - q.face_trigger.symbol),),
        source="the source text's z_cm = D + F + r_m - Z_c, of whose letters it defines none",
    )


def prove_tip_of_the_positions_is_where_it_was_wanted() -> None:
    """(15.3, 15.4) Forward after inverse is the identity, whatever A, B, the offsets and the height."""
    position = probe_axes()["axes"]
    values = dict(zip(q.axes.symbols, position, strict=True))
    assert is_zero(sp.Matrix(probe_tip()["tip_center"]).subs(values, simultaneous=True) - q.tip_center.symbol)


def prove_stylus_without_offset_is_the_cutter_centre() -> None:
    """(15.4) Limit case o = 0: the tip is where the centre of a cutter of the same length is (5.4)."""
    values = {**dict.fromkeys(q.tip_offset.symbols, 0), q.probe_height.symbol: q.pivot_height.symbol}
    assert is_zero(sp.Matrix(probe_tip()["tip_center"]).subs(values) - axes.cutter_center())


def prove_stylus_stands_square_to_the_root_cone() -> None:
    """(15.2) At B = Γ_f the stylus is at right angles to the line of the root cone at azimuth A, and to its circle."""
    A, B = q.A.symbol, q.B.symbol
    stylus = sp.Matrix(probe_tip()["stylus_w"])
    line = sp.Matrix([sp.sin(B) * sp.cos(A), sp.sin(B) * sp.sin(A), sp.cos(B)])
    circle = sp.Matrix([-sp.sin(A), sp.cos(A), 0])
    assert is_zero(sp.Matrix([stylus.dot(line), stylus.dot(circle), stylus.dot(stylus) - 1]))
    outward = sp.Matrix([sp.cos(A), sp.sin(A), 0])
    assert is_zero(sp.Matrix([stylus.dot(outward) - sp.cos(B)]))


def prove_middle_of_the_space_is_on_top() -> None:
    """(15.2) Two points of one radius at azimuths A ± ε lie at opposite Y, so that their middle lies at Y = 0."""
    A, eps, rho, z = sp.symbols("A eps rho z", real=True)
    low, high = (sp.Matrix([rho * sp.cos(A + sign * eps), rho * sp.sin(A + sign * eps), z]) for sign in (-1, 1))
    y = [(axes.swivel(q.B.symbol) * (Rz(-A) * point))[1] for point in (low, high)]
    assert is_zero(y[0] + y[1])
    total = low + high
    assert is_zero(total[1] * sp.cos(A) - total[0] * sp.sin(A))
    assert is_zero(total[0] * sp.cos(A) + total[1] * sp.sin(A) - 2 * rho * sp.cos(eps))


def prove_touching_tip_has_its_point_back() -> None:
    """(15.1, 15.5) A tip that stands off by s gives the point R + s n and the deviation s, for unit normals."""
    n, s = q.normal_w.symbol, q.standoff.symbol
    at = dict(zip(q.tip_center.symbols, probe_target()["tip_center"], strict=True))
    point = sp.Matrix(touched_point()["contact_point"]).subs(at, simultaneous=True)
    assert is_zero(point - (q.point_w.symbol + s * n))
    length = sum(component**2 for component in n)
    rest = touched_point()["deviation"].subs(at, simultaneous=True) - s
    assert sp.expand(rest - (q.tip_radius.symbol + s) * (length - 1)) == 0


def prove_ring_gives_back_the_tip_that_touched_it() -> None:
    """(15.6) A tip of radius r, off by o, touches the wall at L ± (D/2 - r) - o: both come back."""
    o, r = sp.symbols("o r", real=True)
    L, D = q.ring_center.symbol, q.ring_diameter.symbol
    values = {q.first_trigger.symbol: L - (D / 2 - r) - o, q.last_trigger.symbol: L + (D / 2 - r) - o}
    assert sp.expand(ring_calibration()["axis_offset"].subs(values) - o) == 0
    assert sp.expand(ring_calibration()["tip_radius"].subs(values) - r) == 0


def prove_source_text_s_ring_equation_leaves_no_room_for_a_ring() -> None:
    """(15.6) L = X_1 + x_cm = X_2 + x_cm has a solution only where both touches are the same."""
    first, last, x_cm = sp.symbols("X_1 X_2 x_cm", real=True)
    (solution,) = sp.solve([first + x_cm - (last + x_cm)], [first], dict=True)
    assert solution[first] == last


def prove_sphere_leaves_nothing_for_the_tip_that_touched_it() -> None:
    """(15.7) A trigger at c - o + (R_s + r) m, m any unit vector, leaves zero."""
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
    """(15.8, 15.9) With m by its angles and a by amplitude and azimuth, r(m) = r + a cos 3(φ - φ_0) sin θ.

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
    """(15.9) |a| (cos, sin) of three times the azimuth are a_1 and a_2 again."""
    a_1, a_2 = q.lobing.symbols
    size, azimuth = (shape_of_lobes()[name] for name in ("lobing_amplitude", "lobing_phase"))
    shape = {q.lobing_amplitude.symbol: size, q.lobing_phase.symbol: azimuth}
    again = sp.Matrix(lobing_of()["lobing"]).subs(shape)
    assert is_zero(again - sp.Matrix([a_1, a_2]))


def prove_opposite_touches_in_the_ring_leave_nothing_for_the_tip_of_their_equation() -> None:
    """(15.6, 15.10) The tip that (15.6) finds from touches along X, its lobes none, solves (15.10) for both of them."""
    first, gap = q.first_trigger.symbol, sp.Symbol("gap", positive=True)
    tip = ring_calibration()
    values = {
        q.tip_radius.symbol: tip["tip_radius"], q.tip_offset.symbols[0]: tip["axis_offset"],
        q.ring_axis.symbols[0]: q.ring_center.symbol,
        q.trigger.symbols[1]: q.ring_axis.symbols[1] - q.tip_offset.symbols[1],
    } | dict.fromkeys(q.lobing.symbols, 0)  # fmt: skip
    for place in (first, first + gap):
        rest = ring_residual()["ring_rest"].subs(values | {q.trigger.symbols[0]: place}, simultaneous=True)
        assert sp.simplify(rest.subs(q.last_trigger.symbol, first + gap)) == 0


def prove_tip_on_the_face_of_the_ring_has_its_offset_back() -> None:
    """(15.11, 15.10) A tip off by o_z whose lowest point is on the face, at D + F, has its centre r above it."""
    o_z = sp.Symbol("o_z", real=True)
    lowest = q.face_trigger.symbol + o_z - q.tip_radius.symbol
    (at,) = sp.solve(lowest - (q.seat_height.symbol + q.ring_height.symbol), q.face_trigger.symbol)
    assert sp.expand(face_calibration()["axis_offset"].subs(q.face_trigger.symbol, at) - o_z) == 0

"""Chapter 29. The chip of one blade: how far the work advances from blade to blade, and how thick that makes the chip.

A cutter with N blades that cut one flank, at n turns a minute, brings a blade to the same place every

    T_b = 60 / (n N)                                                                           (29.1)

In face hobbing each space is cut once in a turn of the work: N = N_b / z. Meanwhile the work, which moves past the
cutter with v = (v_ρ, v_β, v_k), radial, along the cut and along k, advances by f_b; the layer between the cones (1.1)
of one blade and the next is as thick as the part of that along the normal (1.2):

    f_b = |v| T_b,   h = |v · n_c| T_b = |s v_ρ cos α + v_k sin α| T_b                         (29.2)

A plunge has v = (0, 0, v): h = f_b sin α on the flanks, and f_b itself under the tip. In a roll, h is 0 where the blade
touches the finished flank (the equation of meshing), and at most f_b anywhere.
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from derivations import cutter
from derivations import notation as q
from derivations.expression import Expression
from derivations.proof import is_zero


@cache
def blade_period() -> Expression:
    """(29.1) as an Expression."""
    return Expression(
        "blade_period",
        "Time from one blade to the next at the same place (29.1).",
        (q.cutter_rpm, q.blades_per_turn),
        ((q.blade_period, 60 / (q.cutter_rpm.symbol * q.blades_per_turn.symbol)),),
        source="definition",
    )


@cache
def chip() -> Expression:
    """(29.2) as an Expression."""
    v, period = q.passing_speed.symbol, q.blade_period.symbol
    normal = cutter.normal().subs(q.beta.symbol, 0)
    # the axes of v at β = 0 are those of the cutter
    return Expression(
        "chip",
        "Advance of the work from blade to blade, and thickness of the chip that makes (29.2).",
        (q.passing_speed, q.blade_period, q.blade_pressure_angle, q.side),
        (
            (q.blade_advance, sp.sqrt(v.dot(v)) * period),
            (q.chip_thickness, sp.Abs(v.dot(normal)) * period),
        ),
        source="our own: the layer between two positions of the cone (1.1)",
    )


def prove_chip_of_a_plunge_lies_between_two_cones_along_their_axis() -> None:
    """(29.2) Two straight blades (1.1), f apart along the axis, are f sin α apart: the distance of a point and a line.

    No normal is used: a point of the one blade, and the line of the other in the plane of the blade.
    """
    f, u, t = sp.symbols("f u t", positive=True)
    alpha = q.blade_pressure_angle.symbol
    for side in (1, -1):
        blade = sp.Matrix([cutter.radius(q.u.symbol), q.u.symbol]).subs(q.side.symbol, side)
        apart = blade.subs(q.u.symbol, u) + sp.Matrix([0, f]) - blade.subs(q.u.symbol, t)
        (foot,) = sp.solve(sp.diff(apart.dot(apart), t), t)
        squared = sp.simplify(apart.dot(apart).subs(t, foot))
        plunge = dict(zip(q.passing_speed.symbols, (0, 0, f), strict=True)) | {q.side.symbol: side}
        ours = chip()["chip_thickness"].subs(plunge).subs(q.blade_period.symbol, 1)
        assert is_zero(squared - f**2 * sp.sin(alpha) ** 2)
        assert is_zero(squared - ours**2)
        assert is_zero(chip()["blade_advance"].subs(plunge).subs(q.blade_period.symbol, 1) - f)


def prove_sideways_it_is_the_face_mill_of_the_textbooks() -> None:
    """(29.2) Limit case: fed across its axis a face mill has h = f_z sin κ, with the entering angle κ = 90° - α."""
    f, alpha = sp.Symbol("f", positive=True), q.blade_pressure_angle.symbol
    sideways = dict(zip(q.passing_speed.symbols, (f, 0, 0), strict=True)) | {q.blade_period.symbol: 1}
    for side in (1, -1):
        thickness = chip()["chip_thickness"].subs(sideways | {q.side.symbol: side})
        assert is_zero(thickness**2 - (f * sp.sin(sp.pi / 2 - alpha)) ** 2)


def prove_chip_is_no_thicker_than_the_advance() -> None:
    """(29.2) f_b² - h² = |v - (v · n) n|² T_b², which is no less than 0 as n is a unit vector: nothing without it."""
    v, alpha, side = q.passing_speed.symbol, q.blade_pressure_angle.symbol, q.side.symbol
    normal = sp.Matrix([-side * sp.cos(alpha), 0, -sp.sin(alpha)])
    along = sp.Matrix(v) - sp.Matrix(v).dot(normal) * normal
    for one in (1, -1):
        made = {side: one, q.blade_period.symbol: 1}
        advance, thickness = (chip()[name].subs(made) for name in ("blade_advance", "chip_thickness"))
        assert is_zero(advance**2 - sp.expand(thickness**2) - along.dot(along).subs(side, one))


def prove_more_blades_share_the_advance_of_a_turn() -> None:
    """(29.1) N blades of one turn together take as long as the turn, 60 s over the turns of a minute."""
    assert is_zero(blade_period()["blade_period"] * q.blades_per_turn.symbol - 60 / q.cutter_rpm.symbol)

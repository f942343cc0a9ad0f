"""Chapter 21. Where the rotary axes are: a sphere that the work carries, touched at several positions of A and B.

The centre of the sphere lies at s in the work. The control reads B where the swivel stands at B + β, and the axis B
passes b_x and b_z beside where the zero of X and R_d have it. So, seen from there, the centre is at

    c = (b_x, 0, b_z) + M(B + β) (Rz(-A) s + e)                                                (21.1)

and touches at X Y Z, with the tip of chapter 23, leave

    |(X, Y, Z) - (0, 0, H) + o - c| - (R_s + r(m)) = 0,   m along what is in the bars          (21.2)

What touches cannot tell: s_z from e_z, of which only the sum appears (21.3): s_z must be known from the arbor; the zero
of A from the azimuth of s (21.4); a Y of the axis B, which has none, from e_y. What they can: at one B the centre goes
around a circle whose plane is square to the axis A (21.5), which tells β whatever e is; and at one A around a circle
about the axis B (21.6), which tells b.
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from derivations import axes, probing, tip_calibration
from derivations import notation as q
from derivations.expression import Expression
from derivations.frames import Rz
from derivations.proof import is_zero


def _center() -> sp.Matrix:
    """c of (21.1)."""
    b_x, b_z = q.axis_place.symbols
    carried = Rz(-q.A.symbol) * q.sphere_w.symbol + q.pivot_offset.symbol
    return sp.Matrix([b_x, 0, b_z]) + axes.swivel(q.B.symbol + q.swivel_zero.symbol) * carried


@cache
def carried_sphere() -> Expression:
    """(21.2) as an Expression."""
    tip = q.trigger.symbol + q.tip_offset.symbol - sp.Matrix([0, 0, q.probe_height.symbol])
    off = tip - _center()
    distance = sp.sqrt(sum(component**2 for component in off))
    return Expression(
        "carried_sphere",
        "What a touch on a sphere carried by the work leaves of its equation; zero for the right axes (21.2).",
        (
            q.trigger,
            q.A,
            q.B,
            q.probe_height,
            q.tip_offset,
            q.tip_radius,
            q.sphere_radius,
            q.sphere_w,
            q.axis_place,
            q.swivel_zero,
            q.pivot_offset,
            q.lobing,
        ),
        ((q.sphere_rest, distance - q.sphere_radius.symbol - tip_calibration.radius_towards(off / distance)),),
        requires=(distance - 1,),
        source="(5.4) for the centre of the sphere, (23.2) for the touch",
    )


def prove_sphere_leaves_nothing_for_the_axes_that_carry_it() -> None:
    """(21.2) A trigger at c - o + (0, 0, H) + (R_s + r) m, m any unit vector and no lobes, leaves zero."""
    polar, azimuth = sp.symbols("polar azimuth", real=True)
    m = sp.Matrix([sp.sin(polar) * sp.cos(azimuth), sp.sin(polar) * sp.sin(azimuth), sp.cos(polar)])
    reach = q.sphere_radius.symbol + q.tip_radius.symbol
    trigger = _center() - q.tip_offset.symbol + sp.Matrix([0, 0, q.probe_height.symbol]) + reach * m
    given = dict(zip(q.trigger.symbols, trigger, strict=True)) | dict.fromkeys(q.lobing.symbols, 0)
    rest = carried_sphere()["sphere_rest"].subs(given, simultaneous=True)
    assert is_zero(sp.simplify(rest + reach) ** 2 - reach**2)


def prove_true_axes_carry_the_sphere_as_they_carry_a_flank() -> None:
    """(21.1) Limit case β = b = 0: X Y Z of (15.3) put the tip into the centre of the sphere."""
    none = dict.fromkeys((*q.axis_place.symbols, q.swivel_zero.symbol), 0)
    given = dict(zip(q.tip_center.symbols, q.sphere_w.symbols, strict=True))
    positions = sp.Matrix(probing.probe_axes()["axes"])[:3, 0].subs(given, simultaneous=True)
    there = positions + q.tip_offset.symbol - sp.Matrix([0, 0, q.probe_height.symbol])
    assert is_zero(there - _center().subs(none))


def prove_only_the_sum_of_both_axial_places_is_told() -> None:
    """(21.3) ∂c/∂s_z = ∂c/∂e_z."""
    assert is_zero(_center().diff(q.sphere_w.symbols[2]) - _center().diff(q.pivot_offset.symbols[2]))


def prove_zero_of_a_passes_for_an_azimuth_of_the_sphere() -> None:
    """(21.4) A that stands α ahead does what a sphere does that lies α behind."""
    alpha = sp.Symbol("alpha", real=True)
    behind = dict(zip(q.sphere_w.symbols, Rz(-alpha) * q.sphere_w.symbol, strict=True))
    ahead = _center().subs(q.A.symbol, q.A.symbol + alpha)
    assert is_zero(ahead - _center().subs(behind, simultaneous=True))


def prove_circle_about_the_work_axis_is_square_to_it() -> None:
    """(21.5) Between two positions of A the centre moves square to M(B + β) k, which holds β and not e."""
    other = sp.Symbol("A_2", real=True)
    moved = _center() - _center().subs(q.A.symbol, other)
    axis = axes.swivel(q.B.symbol + q.swivel_zero.symbol)[:, 2]
    assert is_zero(sp.Matrix([moved.dot(axis)]))
    assert not axis.free_symbols & set(q.pivot_offset.symbols)


def prove_circle_about_the_swivel_axis_is_about_its_place() -> None:
    """(21.6) Whatever B, the centre keeps its distance from (b_x, b_z) in X and Z, and its Y."""
    b_x, b_z = q.axis_place.symbols
    off = _center() - sp.Matrix([b_x, 0, b_z])
    assert is_zero(sp.Matrix([off[0] ** 2 + off[2] ** 2, off[1]]).diff(q.B.symbol))

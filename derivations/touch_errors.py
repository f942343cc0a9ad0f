"""Chapter 22. What a touch gets wrong: errors of the machine that measures, as errors of the measured deviation.

The control reads the axes a = (X, Y, Z, A, B); they stand at a' because every axis is off by some e, X moves with Z by
the squareness σ, and the work, warmer than its drawing, is larger by the factor 1 + ε about its apex:

    a' = a + (e_X + σ Z, e_Y, e_Z, e_A, 0)                                                     (22.1)

The tip touches a perfect flank when its centre C(a') (15.4) is at (1 + ε) R + r n. What the control makes of it, by
(15.5) at C(a), is the deviation

    δ_e = (C(a) - C(a'))·n + ε R·n                                                             (22.2)

of which only the derivatives at zero error are used: they carry the variances of the errors to that of a deviation.
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from derivations import deviation, probing
from derivations import notation as q
from derivations.expression import Expression
from derivations.proof import is_zero


def _tip(axes: sp.Matrix) -> sp.Matrix:
    """C of (15.4) at other axis positions."""
    at = dict(zip(q.axes.symbols, axes, strict=True))
    return sp.Matrix(probing.probe_tip()["tip_center"]).subs(at, simultaneous=True)


def standing_axes() -> sp.Matrix:
    """a' of (22.1)."""
    X, Y, Z, A, squareness, _ = q.touch_errors.symbols
    return sp.Matrix(q.axes.symbols) + sp.Matrix([X + squareness * q.Z.symbol, Y, Z, A, 0])


@cache
def touch_error() -> Expression:
    """(22.2) as an Expression."""
    n, R = q.normal_w.symbol, q.point_w.symbol
    growth = q.touch_errors.symbols[-1]
    value = (_tip(sp.Matrix(q.axes.symbols)) - _tip(standing_axes())).dot(n) + growth * R.dot(n)
    return Expression(
        "touch_error",
        "Deviation that a perfect flank seems to have where axes and work are not as they are taken to be (22.2).",
        (q.touch_errors, q.axes, q.probe_height, q.tip_offset, q.point_w, q.normal_w, q.pivot_offset),
        ((q.seeming_deviation, value),),
        source="(15.4), (15.5) with the axes at a' in truth and at a in the control",
    )


def _gradient() -> sp.Matrix:
    value = touch_error()["seeming_deviation"]
    zero = dict.fromkeys(q.touch_errors.symbols, 0)
    return sp.Matrix([value.diff(error).subs(zero) for error in q.touch_errors.symbols])


def prove_no_error_seems_no_deviation() -> None:
    """(22.2) Limit case: axes that stand where they say, and work of the right size."""
    assert is_zero(sp.Matrix([touch_error()["seeming_deviation"].subs(dict.fromkeys(q.touch_errors.symbols, 0))]))


def prove_linear_axes_move_a_touch_by_their_whole_error() -> None:
    """(22.2) The sensitivities to X, Y, Z are the normal in machine axes: their squares sum to n·n."""
    slope = _gradient()[:3, :]
    n = sp.Matrix(q.normal_w.symbol)
    assert is_zero(sp.Matrix([slope.dot(slope) - n.dot(n)]))


def prove_work_axis_acts_by_the_lever_arm_of_the_normal() -> None:
    """(22.2) An error of A turns the work under the tip by -(z_w × C)·n: what (6.5) calls the lever of a turned flank.

    For a tip that touches, C = R + r n, and (z_w × n)·n = 0: the lever is that of the flank point itself.
    """
    n = sp.Matrix(q.normal_w.symbol)
    tip = _tip(sp.Matrix(q.axes.symbols))
    assert is_zero(sp.Matrix([_gradient()[3] + (tip[0] * n[1] - tip[1] * n[0])]))
    moved = q.deviation_in.symbol / deviation.flank_turning()["turning"]  # the lever of (6.5)
    touching = dict(zip(q.point_w.symbols, q.point_w.symbol + q.tip_radius.symbol * n, strict=True))
    assert is_zero(sp.Matrix([moved.subs(touching, simultaneous=True) - moved]))


def prove_squareness_is_an_error_of_x_that_grows_with_z() -> None:
    """(22.1) Its sensitivity is that of X times the position of Z."""
    slope = _gradient()
    assert is_zero(sp.Matrix([slope[4] - q.Z.symbol * slope[0]]))


def prove_growth_leaves_a_cone_about_the_apex_alone() -> None:
    """(22.2) Limit cases: warmth changes nothing of a surface ruled through the apex; a sphere grows by ε R."""
    growth = _gradient()[5]
    along, t = sp.Matrix(sp.symbols("d_0:3", real=True)), sp.Symbol("t", real=True)
    normal = along.cross(sp.Matrix(sp.symbols("e_0:3", real=True)))  # tangents: the ruling d, and any other
    polar, azimuth, radius = sp.symbols("polar azimuth radius", real=True)
    m = sp.Matrix([sp.sin(polar) * sp.cos(azimuth), sp.sin(polar) * sp.sin(azimuth), sp.cos(polar)])
    for point, n, change in ((t * along, normal, 0), (radius * m, m, radius)):
        there = dict(zip((*q.point_w.symbols, *q.normal_w.symbols), (*point, *n), strict=True))
        assert is_zero(sp.Matrix([growth.subs(there, simultaneous=True) - change]))

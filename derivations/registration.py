"""Chapter 18. Registration: what clamping does to a measurement, and what can be told from the gear's own errors.

A work seated as in (16.6) is measured in the frame that turns with A. What was touched there belongs in the work to

    p = Rz(λ) Rx(-ε) Rz(-λ) (p_a - e (cos μ, sin μ, 0)),   n = Rz(λ) Rx(-ε) Rz(-λ) n_a         (18.1)

To first order a body that is moved by t and turned by ω shows, at a flank point R with outward normal n, the deviation

    δ = t·n + ω·(R × n)                                                                        (18.2)

so that its six columns are the Plücker coordinates of the normal's line. Eccentricity is t_x and t_y, tilt is
(ω_x, ω_y) = ε (cos λ, sin λ), axial setting is t_z, and ω_z is the turning (6.5) of pitch and phase.

At azimuth φ, radius r and height z, with ν = n_r + i n_t, E = t_x + i t_y, W = ω_x + i ω_y, and an index error whose
first harmonic is Re(C' e^(iφ_i)) on tooth i with azimuth φ_i (' conjugate), (18.2) is the real part of

    δ = e^(iφ) (E' ν + i W' (z ν - r n_z)) + e^(iφ_i) C' r n_t                                 (18.3)

Seen from the height z_0, E' + i z_0 W' is the eccentricity there, and tilt keeps i W' ((z - z_0) ν - r n_z). Every
flank measured at one place of all teeth gives one complex number, the first harmonic; its mean over the teeth is form,
setting or axial position, and so t_z = ∂δ/∂X_p cannot be told from the setting X_p. With one place on each flank there
are two numbers: for E and W alone their determinant is i r (ν_2 n_z1 - ν_1 n_z2), for E and C alone
r (ν_1 n_t2 e^(-iψ_2) - ν_2 n_t1 e^(-iψ_1)), with ψ = φ - φ_i. E, W and C together need places of different z or r.
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from derivations import notation as q
from derivations import sweep
from derivations.expression import Expression
from derivations.frames import Rx, Rz
from derivations.proof import is_zero


def _unseat() -> sp.Matrix:
    """The rotation of (18.1)."""
    return Rz(q.tilt_azimuth.symbol) * Rx(-q.work_tilt.symbol) * Rz(-q.tilt_azimuth.symbol)


@cache
def unseated() -> Expression:
    """(18.1) as an Expression."""
    at = q.eccentricity_azimuth.symbol
    moved = q.eccentricity.symbol * sp.Matrix([sp.cos(at), sp.sin(at), 0])
    return Expression(
        "unseated",
        "Point and normal in the work that were found in the frame that turns with A (18.1).",
        (q.seated_point, q.seated_normal, q.eccentricity, q.eccentricity_azimuth, q.work_tilt, q.tilt_azimuth),
        (
            (q.point_w, _unseat() * (q.seated_point.symbol - moved)),
            (q.normal_w, _unseat() * q.seated_normal.symbol),
        ),
        source="(16.6) solved for the work",
    )


@cache
def motion_sensitivity() -> Expression:
    """(18.2) as an Expression: one column for each component of a small rigid motion."""
    R, n = sp.Matrix(q.point_w.symbol), sp.Matrix(q.normal_w.symbol)
    return Expression(
        "motion_sensitivity",
        "Deviation per unit of each component of a small motion: t_x, t_y, t_z, ω_x, ω_y, ω_z (18.2).",
        (q.point_w, q.normal_w),
        ((q.motion_sensitivity, sp.Matrix.vstack(n, R.cross(n))),),
        source="velocity of a rigid body along the normal; Plücker coordinates of the normal's line",
    )


def prove_unseating_takes_back_the_seat() -> None:
    """(18.1) after (16.6) is nothing at all, for points and for normals, however large the tilt."""
    seat, back = sweep.seated(), unseated()
    placed = dict(zip(q.seated_point.symbols, seat["seated_point"], strict=True))
    placed |= dict(zip(q.seated_normal.symbols, seat["seated_normal"], strict=True))
    assert is_zero(back["point_w"].subs(placed, simultaneous=True) - sp.Matrix(q.point_w.symbol))
    assert is_zero(back["normal_w"].subs(placed, simultaneous=True) - sp.Matrix(q.normal_w.symbol))


def prove_columns_are_the_derivatives_of_the_seat() -> None:
    """(18.2) The seat of (16.6) moves a point along its normal by the columns' sum, at e = ε = 0."""
    seat, n = sweep.seated()["seated_point"], sp.Matrix(q.normal_w.symbol)
    column = motion_sensitivity()["motion_sensitivity"]
    still = {q.eccentricity.symbol: 0, q.work_tilt.symbol: 0}
    for size, azimuth, pair in (
        (q.eccentricity, q.eccentricity_azimuth, column[0:2]),
        (q.work_tilt, q.tilt_azimuth, column[3:5]),
    ):
        along = seat.diff(size.symbol).subs(still).dot(n)
        assert is_zero(along - sp.cos(azimuth.symbol) * pair[0] - sp.sin(azimuth.symbol) * pair[1])


def prove_first_harmonic_is_the_complex_form() -> None:
    """(18.3) is (18.2) for a point and a normal in cylindrical coordinates, with the real part written out."""
    r, z, phi, n_r, n_t, n_z = sp.symbols("r z phi n_r n_t n_z", real=True)
    t_x, t_y, w_x, w_y = sp.symbols("t_x t_y w_x w_y", real=True)
    outward, around = sp.Matrix([sp.cos(phi), sp.sin(phi), 0]), sp.Matrix([-sp.sin(phi), sp.cos(phi), 0])
    R, n = r * outward + sp.Matrix([0, 0, z]), n_r * outward + n_t * around + sp.Matrix([0, 0, n_z])
    there = dict(zip((*q.point_w.symbols, *q.normal_w.symbols), (*R, *n), strict=True))
    column = motion_sensitivity()["motion_sensitivity"].subs(there, simultaneous=True)
    value = column.dot(sp.Matrix([t_x, t_y, 0, w_x, w_y, 0]))
    nu, turned = n_r + sp.I * n_t, sp.cos(phi) + sp.I * sp.sin(phi)
    form = turned * ((t_x - sp.I * t_y) * nu + sp.I * (w_x - sp.I * w_y) * (z * nu - r * n_z))
    assert is_zero(sp.re(sp.expand(form)) - value)


def prove_determinants_of_one_place_on_each_flank() -> None:
    """(18.3) The determinants of E', W' and of E', C' out of two flanks at the same r and z, as stated."""
    r, z, p1, p2 = sp.symbols("r z psi_1 psi_2", real=True)
    nu1, nu2, nz1, nz2, nt1, nt2 = sp.symbols("nu_1 nu_2 n_z1 n_z2 n_t1 n_t2")
    tilt = [sp.I * (z * nu - r * nz) for nu, nz in ((nu1, nz1), (nu2, nz2))]
    assert sp.expand(sp.Matrix([[nu1, tilt[0]], [nu2, tilt[1]]]).det() - sp.I * r * (nu2 * nz1 - nu1 * nz2)) == 0
    index = [r * nt * sp.exp(-sp.I * psi) for nt, psi in ((nt1, p1), (nt2, p2))]
    stated = r * (nu1 * nt2 * sp.exp(-sp.I * p2) - nu2 * nt1 * sp.exp(-sp.I * p1))
    assert sp.expand(sp.Matrix([[nu1, index[0]], [nu2, index[1]]]).det() - stated) == 0


def prove_index_and_clamping_are_one_at_a_single_place() -> None:
    """(18.3) One place on each flank: three unknowns, two equations; W' is made up for by E' and C' exactly."""
    r, z = sp.symbols("r z", positive=True)
    nu1, nu2, nz1, nz2, c1, c2 = sp.symbols("nu_1 nu_2 n_z1 n_z2 c_1 c_2")
    rows = sp.Matrix([[nu, sp.I * (z * nu - r * nz), c] for nu, nz, c in ((nu1, nz1, c1), (nu2, nz2, c2))])
    assert rows.rank() == 2
    (kernel,) = rows.nullspace()
    assert sp.simplify(rows * kernel) == sp.zeros(2, 1)
    assert kernel[1] != 0
    # a spur gear's rack-like limit, n_z = 0: tilt is nothing but eccentricity at the height z, and C stays free of it
    spur = rows.subs({nz1: 0, nz2: 0})
    (kernel,) = spur.nullspace()
    assert sp.simplify(kernel[2]) == 0
    assert sp.simplify(kernel[0] + sp.I * z * kernel[1]) == 0

"""Chapter 31. Tolerances of cylindrical gears, ISO 1328-1:2013: what a flank tolerance class allows.

Class A from 1 to 11; m_n, d and the face width b in mm, tolerances in µm; class 5 is the one that the others follow
from by √2 a class. Other programs that cite the numbers of the formulas have the same; no printed example of this
edition was found, so that it is [unconfirmed] wherever it is used. The standard rounds its values; here they are not.

    f_ptT = (0.001 d + 0.4 m_n + 5) √2^(A-5),   F_pT = (0.002 d + 0.55 √d + 0.7 m_n + 12) √2^(A-5)   (31.1)
    f_HαT = (0.4 m_n + 0.001 d + 4) √2^(A-5),   f_fαT = (0.55 m_n + 5) √2^(A-5),   F_αT = √(f_HαT² + f_fαT²)   (31.2)
    f_HβT = (0.05 √d + 0.35 √b + 4) √2^(A-5),   f_fβT = (0.07 √d + 0.45 √b + 4) √2^(A-5),   F_βT alike (31.3)
    F_rT = 0.9 F_pT                                                                            (31.4)
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from derivations import notation as q
from derivations.expression import Expression

_SOURCE = "ISO 1328-1:2013 [unconfirmed: as other programs have it, no printed example found]"


def _factor() -> sp.Expr:
    """√2^(A-5)."""
    return sp.sqrt(2) ** (q.accuracy_class.symbol - 5)


@cache
def cylindrical_tolerances() -> Expression:
    """(31.1) to (31.4) as an Expression."""
    m, d, b = q.module.symbol, q.reference_diameter.symbol, q.gear_face_width.symbol
    number, root = sp.Rational, sp.sqrt
    slope = number("0.4") * m + number("0.001") * d + 4
    form = number("0.55") * m + 5
    helix_slope = number("0.05") * root(d) + number("0.35") * root(b) + 4
    helix_form = number("0.07") * root(d) + number("0.45") * root(b) + 4
    cumulative = number("0.002") * d + number("0.55") * root(d) + number("0.7") * m + 12
    single = number("0.001") * d + number("0.4") * m + 5
    values = (
        (q.single_pitch_tolerance, single),
        (q.cumulative_pitch_tolerance, cumulative),
        (q.runout_tolerance, number("0.9") * cumulative),
        (q.profile_slope_tolerance, slope),
        (q.profile_form_tolerance, form),
        (q.profile_tolerance, root(slope**2 + form**2)),
        (q.helix_slope_tolerance, helix_slope),
        (q.helix_form_tolerance, helix_form),
        (q.helix_tolerance, root(helix_slope**2 + helix_form**2)),
    )
    return Expression(
        "cylindrical_tolerances",
        "What a flank tolerance class of a cylindrical gear allows (31.1 to 31.4).",
        (q.accuracy_class, q.module, q.reference_diameter, q.gear_face_width),
        tuple((quantity, value * _factor()) for quantity, value in values),
        source=_SOURCE,
    )


def prove_two_classes_double_every_tolerance_and_totals_are_root_sums_of_squares() -> None:
    """(31.1 to 31.4) The steps of the system, and the totals of profile and helix from slope and form."""
    rule, A = cylindrical_tolerances(), q.accuracy_class.symbol
    for _, value in rule.scalars():
        assert sp.simplify(value.subs(A, A + 2) / value) == 2
    for kind in ("profile", "helix"):
        total, slope, form = (rule[f"{kind}{part}_tolerance"] for part in ("", "_slope", "_form"))
        assert sp.simplify(total**2 - slope**2 - form**2) == 0


def prove_hand_calculation() -> None:
    """(31.1 to 31.3) m = 4, d = 100, b = 25, class 5, by hand: 6.7, 20.5, 18.45; 5.7, 7.2; 6.25, 6.95."""
    rule = cylindrical_tolerances()
    known = ("6.7", "20.5", "18.45", "5.7", "7.2", None, "6.25", "6.95", None)
    symbols = [quantity.symbol for quantity in rule.inputs]
    for A, factor in ((5, 1), (7, 2)):
        at = dict(zip(symbols, (A, 4, 100, 25), strict=True))
        for printed, (_, value) in zip(known, rule.scalars(), strict=True):
            assert printed is None or sp.simplify(value.subs(at) - factor * sp.Rational(printed)) == 0


def prove_figures_that_another_program_gives_for_class_6() -> None:
    """(31.1, 31.2) m = 3, d = 120: 8.94 and 28.80 before rounding; profile 12 after rounding to a whole µm."""
    rule = cylindrical_tolerances()
    at = dict(zip([quantity.symbol for quantity in rule.inputs], (6, 3, 120, 30), strict=True))
    assert abs(rule["single_pitch_tolerance"].subs(at) - sp.Rational("8.94")) < sp.Rational("0.005")
    assert abs(rule["cumulative_pitch_tolerance"].subs(at) - sp.Rational("28.80")) < sp.Rational("0.005")
    assert abs(rule["profile_tolerance"].subs(at) - 12) < sp.Rational(1, 2)

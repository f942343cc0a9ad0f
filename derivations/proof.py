"""An exact decision whether a trigonometric expression vanishes: proofs need more than a simplifier's good luck."""

from __future__ import annotations

import sympy as sp


def is_zero(value: sp.Expr | sp.MatrixBase) -> bool:
    """True if every entry is identically zero.

    Sines and cosines of sums are expanded to those of single angles; each pair becomes two indeterminates S, C with
    S² = 1 - C². The numerator, reduced by these relations, is a polynomial in normal form: zero only if it is 0.
    """
    entries = value if isinstance(value, sp.MatrixBase) else [value]
    return all(_normal_form(sp.sympify(entry)) == 0 for entry in entries)


def _normal_form(entry: sp.Expr) -> sp.Expr:
    entry = entry.replace(sp.tan, lambda a: sp.sin(a) / sp.cos(a)).replace(sp.cot, lambda a: sp.cos(a) / sp.sin(a))
    entry = sp.expand_trig(entry)
    angles = sorted({f.args[0] for f in entry.atoms(sp.sin, sp.cos)}, key=sp.default_sort_key)
    pairs = [(sp.Dummy(f"S{k}"), sp.Dummy(f"C{k}")) for k in range(len(angles))]
    for angle, (S, C) in zip(angles, pairs, strict=True):
        entry = entry.subs({sp.sin(angle): S, sp.cos(angle): C})
    numerator = sp.expand(sp.fraction(sp.together(entry))[0])
    if numerator == 0 or not pairs:
        return numerator
    variables = [symbol for pair in pairs for symbol in pair]
    others = sorted(numerator.free_symbols - set(variables), key=sp.default_sort_key)
    relations = [S**2 + C**2 - 1 for S, C in pairs]
    return sp.reduced(numerator, relations, *variables, *others, order="lex")[1]

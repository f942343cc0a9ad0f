"""What proofs use: an exact decision whether an expression vanishes, and numbers of many digits for all else."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import mpmath
import sympy as sp

#: Digits in which a proof by numbers computes, and how close it has to come.
DIGITS, CLOSE = 40, mpmath.mpf(10) ** -30


def is_close(one: Sequence[mpmath.mpf], other: Sequence[mpmath.mpf], within: mpmath.mpf = CLOSE) -> bool:
    """True if two equally long vectors agree in every element."""
    return all(abs(a - b) < within for a, b in zip(one, other, strict=True))


def numbers(matrix: Sequence[sp.Expr]) -> list[mpmath.mpf]:
    """The elements of a vector of numbers, in many digits."""
    with mpmath.workdps(DIGITS):
        return [mpmath.mpmathify(sp.N(element, DIGITS)) for element in matrix]


def shifts(
    flank_of: Callable[..., Sequence[mpmath.mpf]],
    given: Sequence[mpmath.mpf],
    which: Iterable[int],
    contact: Sequence[mpmath.mpf],
    point: Sequence[mpmath.mpf],
    direction: Sequence[mpmath.mpf],
) -> list[mpmath.mpf]:
    """How an envelope moves along the line through a ``point`` of it, per unit of those of the ``given``: cut anew.

    ``flank_of`` gives x, y, z and the residual of the equation of meshing out of three parameters, at the point those
    of the ``contact``, and what is given. Each is moved up and down by a little: the difference is the slope.
    """
    step = mpmath.mpf(10) ** -12

    def crossing(k: int, by: mpmath.mpf) -> mpmath.mpf:
        moved = [value + by * (j == k) for j, value in enumerate(given)]

        def miss(*unknowns: mpmath.mpf) -> list[mpmath.mpf]:
            *place, residual = flank_of(*unknowns[:3], *moved)
            return [x - p - unknowns[3] * d for x, p, d in zip(place, point, direction, strict=True)] + [residual]

        return mpmath.findroot(miss, (*contact, mpmath.mpf(0)))[3]

    return [(crossing(k, step) - crossing(k, -step)) / (2 * step) for k in which]


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

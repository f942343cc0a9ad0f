"""Exact numbers in files: fractions in quotes, and pitches in mm or threads per inch."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from typing import Annotated

from pydantic import BeforeValidator, InstanceOf

from gearmath.errors import InputError

INCH = 25.4  # mm
#: The same, exactly.
EXACT_INCH = Fraction(127, 5)
#: A degree in radians, and a radian in degrees: each rounded once, which the inverse of the other is not.
DEGREE, RADIAN = math.pi / 180, 180 / math.pi

#: Largest numerator and denominator of a fraction in a file: products of a few of them stay within 63 bits.
LARGEST = 1_000_000

#: π of worm threads by module or diametral pitch: 8.5e-8 of it too much, 43 nm over 500 mm.
PI = Fraction(355, 113)

_PITCH = re.compile(r"\s*(\d+(?:\.\d+|/\d+)?)\s*(mm|tpi|m|dp)\s*\Z")


def _rational(value: object, most: int = 10_000) -> Fraction:
    """A whole number, text like "5/2", or what was made of it. A decimal number is refused: 0.1 is no exact ratio in
    binary."""
    wanted = f'must be a whole number, or a fraction in quotes such as "5/2", between 1/1000 and {most}'
    if isinstance(value, bool) or not isinstance(value, int | str | Fraction):
        raise ValueError(wanted)
    try:
        ratio = Fraction(value)
    except ZeroDivisionError:
        raise ValueError(f"is a division by 0: {wanted}") from None
    except ValueError:
        raise ValueError(wanted) from None
    if not Fraction(1, 1000) <= ratio <= most:
        raise ValueError(f"must lie between 1/1000 and {most}")
    return _small(ratio)


def _pulses(value: object) -> Fraction:
    return _rational(value, LARGEST)


def pitch(value: object) -> Fraction:
    """Pitch [mm] of text such as "2mm", "1.25mm", "8tpi" or "23/2tpi", exactly; an inch is 127/5 mm.

    "1.5m" is that of a worm of module 1.5 mm, "16dp" of diametral pitch 16, with PI for π. A length that was made of
    such a text stays as it is.

    Raises ValueError where it is none, or outside 1/100 to 100 mm.
    """
    length = value if isinstance(value, Fraction) else _length(value)
    if not Fraction(1, 100) <= length <= 100:
        raise ValueError("must lie between 0.01 mm and 100 mm")
    return _small(length)


def _length(value: object) -> Fraction:
    match = _PITCH.match(value) if isinstance(value, str) else None
    try:
        number = Fraction(match[1]) if match else Fraction(0)
    except ZeroDivisionError:
        number = Fraction(0)
    if match is None or number == 0:
        raise ValueError(
            'must be a pitch such as "2mm", "1.25mm", "8tpi", "23/2tpi", "1.5m" or "16dp", between 0.01 mm and 100 mm'
        )
    length = number if match[2] in ("mm", "m") else EXACT_INCH / number
    return length * PI if match[2] in ("m", "dp") else length


def _small(ratio: Fraction) -> Fraction:
    if max(ratio.numerator, ratio.denominator) > LARGEST:
        raise ValueError(f"numerator and denominator must not exceed {LARGEST}")
    return ratio


Rational = Annotated[InstanceOf[Fraction], BeforeValidator(_rational)]
#: Pulses per turn of a servo, which may be more.
Pulses = Annotated[InstanceOf[Fraction], BeforeValidator(_pulses)]
Pitch = Annotated[InstanceOf[Fraction], BeforeValidator(pitch)]


def pitch_of(text: str) -> Fraction:
    """The pitch [mm] that an option says, such as 1.25mm or 8tpi. Raises InputError."""
    try:
        return pitch(text)
    except ValueError as error:
        raise InputError(f"pitch = {text!r}: {error}") from None

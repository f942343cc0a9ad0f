"""Numbers that are read or typed wrongly: what a value may have been."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

#: So many digits of a number are exchanged with their neighbor, so many may be another one: a set bears those behind.
_EXCHANGED, _WRONG = 5, 3
#: A wrong digit changes a value by these parts of it: less a set bears, more shows at once.
_LEAST, _MOST = 0.005, 0.5


def exchanged_digits(value: float) -> Iterator[float]:
    """A number with two neighboring digits exchanged."""
    text, digits = _digits(value)
    for one, two in pairwise(digits[: _EXCHANGED + 1]):
        if text[one] != text[two] and (one != digits[0] or text[two] != "0"):
            between = text[one + 1 : two]  # the decimal point, or nothing
            yield float(text[:one] + text[two] + between + text[one] + text[two + 1 :])


def wrong_digits(value: float) -> Iterator[float]:
    """A number with one digit another, the nearest first; never one digit less."""
    text, digits = _digits(value)
    for place in digits[:_WRONG]:
        others = sorted(set("0123456789") - {text[place]}, key=lambda digit: abs(int(digit) - int(text[place])))
        for digit in others:
            other = float(text[:place] + digit + text[place + 1 :])
            if (place != digits[0] or digit != "0") and _LEAST <= abs(other / value - 1) <= _MOST:
                yield other


def minutes_as_decimals(value: float) -> list[float]:
    """The angle in degrees that 63.5631 is where it was written for 63 degrees 56 minutes 31 seconds; often none.

    With two decimals these are minutes, with four or more seconds follow, and then parts of a second.
    """
    text = repr(abs(float(value)))
    whole, _, parts = text.partition(".")
    if "e" in text or len(parts) not in (2, 4, 5, 6):
        return []
    minutes, seconds = int(parts[:2]), float(f"{parts[2:4] or 0}.{parts[4:] or 0}")
    if minutes >= 60 or seconds >= 60:
        return []
    return [math.copysign(int(whole) + minutes / 60 + seconds / 3600, value)]


def _digits(value: float) -> tuple[str, list[int]]:
    """A number as text, and where its digits stand, from the first that is not zero on; none of 1e-9 or infinity."""
    text = repr(float(value))
    digits = [k for k, letter in enumerate(text) if letter.isdigit()] if text.lstrip("-")[0].isdigit() else []
    while digits and text[digits[0]] == "0":
        del digits[0]
    return text, [] if "e" in text else digits

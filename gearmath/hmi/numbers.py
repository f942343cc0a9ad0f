"""Numbers that an operator types: read as they stand, refused with the reason, never changed."""

from __future__ import annotations

import math
import re

from gearmath.hmi.messages import Text

_NUMBER = re.compile(r"[+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][+-]?\d+)?", re.ASCII)


def parsed(
    text: Text, typed: str, low: float, high: float, unit: str, whole: bool = False
) -> tuple[float | None, str | None]:
    """The number of what was typed, or the reason why it is refused. A decimal comma is a decimal point."""
    plain = typed.strip().replace("−", "-")
    if not plain:
        return None, text("shell.required")
    if _NUMBER.fullmatch(plain) is None:
        return None, text("shell.no_number", value=plain[:30])
    value = float(plain.replace(",", "."))
    if not (math.isfinite(value) and low <= value <= high):
        limits = {"low": f"{low:.10g}", "high": f"{high:.10g} {unit}".rstrip()}
        return None, text("shell.out_of_range", value=f"{plain[:30]} {unit}".rstrip(), **limits)
    if whole and not value.is_integer():
        return None, text("shell.whole", value=plain[:30])
    return value, None

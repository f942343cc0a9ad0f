"""Numbers that an operator types: read as they stand, refused with the reason, never changed."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from decimal import Decimal

from gearmath.hmi.messages import Text

_NUMBER = re.compile(r"[+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][+-]?\d+)?", re.ASCII)


@dataclass(frozen=True)
class Limits:
    """Least and largest number; ``above`` and ``below`` where it must be more than the one, less than the other."""

    low: float
    high: float
    above: bool = False
    below: bool = False

    def hold(self, value: float) -> bool:
        """Whether a number lies within them."""
        least = self.low < value if self.above else self.low <= value
        return least and (value < self.high if self.below else value <= self.high)

    def hint(self, text: Text, unit: str) -> str:
        """Both, as they stand under a field."""
        low, high = self._words(unit)
        return text("shell.range", low=f"> {low}" if self.above else low, high=f"< {high}" if self.below else high)

    def refusal(self, text: Text, typed: str, unit: str) -> str:
        """What must hold of a number that does not lie within them."""
        low, high = self._words(unit)
        value = f"{typed} {unit}".rstrip()
        if not (self.above or self.below):
            return text("shell.out_of_range", value=value, low=low, high=high)
        least = text("shell.more" if self.above else "shell.least", low=low)
        return text("shell.out_of_open_range", value=value, low=least, high=text(_MOST[self.below], high=high))

    def _words(self, unit: str) -> tuple[str, str]:
        low, high = (f"{one}" if isinstance(one, int) else f"{one:.10g}" for one in (self.low, self.high))
        return low, f"{high} {unit}".rstrip()


_MOST = {False: "shell.most", True: "shell.less"}


def parsed(text: Text, typed: str, limits: Limits, unit: str, whole: bool = False) -> tuple[float | None, str | None]:
    """The number of what was typed, or the reason why it is refused. A decimal comma is a decimal point."""
    plain = typed.strip().replace("−", "-")
    if not plain:
        return None, text("shell.required")
    if _NUMBER.fullmatch(plain) is None:
        return None, text("shell.no_number", value=plain[:30])
    point = plain.replace(",", ".")
    value = float(point)
    if not (math.isfinite(value) and limits.hold(value)):
        return None, limits.refusal(text, plain[:30], unit)
    if not whole:
        return value, None
    exact = Decimal(point)  # a large count has more digits than a float
    if exact != exact.to_integral_value():
        return None, text("shell.whole", value=plain[:30])
    if not limits.hold(int(exact)):
        return None, limits.refusal(text, plain[:30], unit)
    return int(exact), None

"""What a grid leaves out on each side of a flank, as the header of a flank file says it."""

from __future__ import annotations

import re
from dataclasses import astuple, dataclass

from gearmath.errors import InputError

_NUMBER = r"(?:0(?:\.[0-4]\d*)?|\d(?:\.\d+)?e-\d\d)"  # as Python prints it: 0.1, 0, 1e-05
#: What the header may say: both margins up the profile and along the tooth, or root, tip, toe and heel.
PATTERN = rf"{_NUMBER},{_NUMBER}(?:,{_NUMBER},{_NUMBER})?"
#: How far a grid may reach beyond the flank, as a part of it; a file of measured points has none of that.
BEYOND = 0.1
#: In place of margins: every point has a place of its own, listed, or as another measuring machine takes it.
OWN = "own"


@dataclass(frozen=True)
class Margins:
    """Parts of the working depth left out at root and tip, and of the face width at toe and heel."""

    root: float
    tip: float
    toe: float
    heel: float

    def __post_init__(self) -> None:
        for low, high in (("root", "tip"), ("toe", "heel")):
            one, other = getattr(self, low), getattr(self, high)
            if not (one >= -BEYOND and other >= -BEYOND and one + other < 1):
                raise InputError(
                    f"margins: {low} = {one}, {high} = {other}: must be at least {-BEYOND:g}, and less than 1 together"
                )

    @classmethod
    def alike(cls, margin: float) -> Margins:
        """The same part on all four sides."""
        return cls(margin, margin, margin, margin)

    @classmethod
    def read(cls, text: str) -> Margins:
        """Margins out of a header. Raises InputError where it has none."""
        if not re.fullmatch(PATTERN, text, re.ASCII):
            raise InputError(f"margins = {text!r}: must read like 0.1,0.1, or root,tip,toe,heel, each less than 0.5")
        numbers = [float(part) for part in text.split(",")]
        return cls(*numbers) if len(numbers) == 4 else cls(numbers[0], numbers[0], numbers[1], numbers[1])

    def __str__(self) -> str:
        if self.root == self.tip and self.toe == self.heel:
            return f"{self.root:g},{self.toe:g}"
        return ",".join(f"{part:g}" for part in astuple(self))

"""The helix of a job on a hobbing machine, as options say it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from gearmath.specs.hobbing import Hand

SIGNS: dict[str, int] = {"right": 1, "left": -1, "climb": 1, "conventional": -1}

FeedSense = Literal["climb", "conventional"]


@dataclass(frozen=True)
class Helix:
    """A helix to be cut: angle [degrees], hand, and how. ``feed`` [mm per table turn] only without a feed encoder."""

    angle: float
    hand: Hand = "right"
    cut: FeedSense = "climb"
    feed: Fraction | None = None

    @property
    def beta(self) -> float:
        """Helix angle [rad]."""
        return math.radians(self.angle)

    @property
    def sign(self) -> int:
        """s_β: +1 right-hand."""
        return SIGNS[self.hand]

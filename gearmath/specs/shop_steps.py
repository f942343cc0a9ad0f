"""Settings rounded to what a shop can set: in the units of its file, mm and degrees."""

from __future__ import annotations

import math


def to_step(value: float, step: float) -> float:
    """The whole multiple of a step that is nearest to a value; the value itself where there is no step."""
    return round(value / step) * step if step else value


def angle_to_step(angle: float, step: float) -> float:
    """The same for an angle [rad], with a step in degrees."""
    return math.radians(to_step(math.degrees(angle), step))

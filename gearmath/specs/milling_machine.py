"""The vertical 5-axis milling machine: its file in mm, degrees and minutes, its limits in mm, rad and s."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, Field

from gearmath.specs.toml import Spec, load

#: Order of the axes in every array of positions.
AXES = "XYZAB"
#: What a TOML file states an axis in, in the same order, and how many of these make a mm or a rad.
UNITS = ("mm", "mm", "mm", "degrees", "degrees")
UNITS_PER_INTERNAL = np.array([1.0, 1.0, 1.0, 180.0 / np.pi, 180.0 / np.pi])


def _increasing(limits: tuple[float, float]) -> tuple[float, float]:
    if limits[0] >= limits[1]:
        raise ValueError("the first value must be less than the second")
    return limits


_Number = Annotated[float, Field(strict=True)]
_Range = Annotated[tuple[_Number, _Number], Field(strict=False), AfterValidator(_increasing)]
_Speeds = Annotated[tuple[Annotated[_Number, Field(gt=0)], _Number], Field(strict=False), AfterValidator(_increasing)]


class TravelAxis(Spec):
    """An axis between two ends: X, Y, Z in mm and mm/min, B in degrees and degrees/min."""

    travel: _Range
    max_speed_per_min: float = Field(gt=0)


class ModuloAxis(Spec):
    """An axis that turns without end and counts from 0 to 360 degrees."""

    modulo: Literal[True]
    max_speed_per_min: float = Field(gt=0)


class Axes(Spec):
    """The five axes, named as in the program."""

    X: TravelAxis
    Y: TravelAxis
    Z: TravelAxis
    A: ModuloAxis
    B: TravelAxis


class MillingMachine(Spec):
    """One machine with the tool set-up that matters for its geometry."""

    name: str
    gauge_line_height: float
    """R_d [mm]: gauge line of the spindle over the B axis at Z = 0."""
    tool_length: float = Field(gt=0)
    """C_t [mm]: gauge line to the blade tips."""
    work_offset: Literal["G54", "G55", "G56", "G57"]
    spindle_speed_rpm: _Speeds
    axes: Axes

    @property
    def pivot_height(self) -> float:
        """R_d + C_t [mm] of equation (5.1)."""
        return self.gauge_line_height + self.tool_length

    @property
    def travel(self) -> np.ndarray:
        """Lowest and highest position of X Y Z A B, (5, 2) mm and rad; infinite for the modulo axis."""
        axes = self.axes
        endless = (-np.inf, np.inf)
        limits = np.array([axes.X.travel, axes.Y.travel, axes.Z.travel, endless, axes.B.travel])
        return limits / UNITS_PER_INTERNAL[:, None]

    @property
    def max_speed(self) -> np.ndarray:
        """Highest speed of X Y Z A B, (5,) mm/s and rad/s."""
        axes = (self.axes.X, self.axes.Y, self.axes.Z, self.axes.A, self.axes.B)
        return np.array([axis.max_speed_per_min for axis in axes]) / UNITS_PER_INTERNAL / 60.0


def load_milling_machine(path: Path) -> MillingMachine:
    """Read a machine file. Raises InputError with file, key, value and limit."""
    return load(path, MillingMachine)

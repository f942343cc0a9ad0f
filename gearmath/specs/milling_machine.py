"""The vertical 5-axis milling machine: its file in mm, degrees and minutes, its limits in mm, rad and s."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import tomlkit
from pydantic import AfterValidator, Field, model_validator

from gearmath.files import read_text, write_text
from gearmath.specs.control import ControlSettings
from gearmath.specs.obstacles import CutterHead, Fixture
from gearmath.specs.ratio import RADIAN
from gearmath.specs.toml import Spec, load, parse

#: Order of the axes in every array of positions.
AXES = "XYZAB"
#: What a TOML file states an axis in, in the same order, and how many of these make a mm or a rad.
UNITS = ("mm", "mm", "mm", "degrees", "degrees")
UNITS_PER_INTERNAL = np.array([1.0, 1.0, 1.0, RADIAN, RADIAN])
#: The cutter spindle as an axis: where positions have a sixth column, it is this one, in degrees.
CUTTER_AXIS = "C"


def _increasing(limits: tuple[float, float]) -> tuple[float, float]:
    if limits[0] >= limits[1]:
        raise ValueError("the first value must be less than the second")
    return limits


_Number = Annotated[float, Field(strict=True)]
_Range = Annotated[tuple[_Number, _Number], Field(strict=False), AfterValidator(_increasing)]
_Speeds = Annotated[tuple[Annotated[_Number, Field(gt=0)], _Number], Field(strict=False), AfterValidator(_increasing)]


class TravelAxis(Spec):
    """An axis between two ends: X, Y, Z in mm and mm/min, B in degrees and degrees/min; mm/s² and degrees/s²."""

    travel: _Range
    max_speed_per_min: float = Field(gt=0)
    max_acceleration: float = Field(gt=0)
    max_jerk: float | None = Field(default=None, gt=0)


class TurningAxis(Spec):
    """Work or cutter spindle: a modulo axis turns without end and counts 0 to 360 degrees, a counting one has a travel.

    In degrees, degrees/min and degrees/s². ``one_sided_approach`` is for A: the probe touches only after A has turned
    so far forwards, so that its backlash is always on the same side.
    """

    modulo: bool
    travel: _Range | None = None
    max_speed_per_min: float = Field(gt=0)
    max_acceleration: float = Field(gt=0)
    max_jerk: float | None = Field(default=None, gt=0)
    one_sided_approach: float = Field(default=0.0, ge=0, le=20)

    @model_validator(mode="after")
    def _one_way_to_count(self) -> TurningAxis:
        if self.modulo != (self.travel is None):
            raise ValueError("travel belongs to an axis with modulo = false, and such an axis needs it")
        return self


class Axes(Spec):
    """The five axes, named as in the program, and the cutter spindle where the control can run it as the sixth."""

    X: TravelAxis
    Y: TravelAxis
    Z: TravelAxis
    A: TurningAxis
    B: TravelAxis
    C: TurningAxis | None = None


@dataclass(frozen=True)
class AxisLimits:
    """Names and limits of k axes: ``scale`` (k,) makes the unit of the file of mm or rad; the rest is in mm, rad, s."""

    names: str
    units: tuple[str, ...]
    scale: np.ndarray
    travel: np.ndarray
    max_speed: np.ndarray
    max_acceleration: np.ndarray
    max_jerk: np.ndarray


class MillingMachine(Spec):
    """One machine with the tool set-up that matters for its geometry."""

    name: str
    gauge_line_height: float
    """R_d [mm]: the reading of Z at which the gauge line of the spindle stands level with the B axis, Z counting up."""
    tool_length: float = Field(gt=0)
    """C_t [mm]: gauge line to the blade tips."""
    pivot_offset: Annotated[tuple[_Number, _Number, _Number], Field(strict=False)] = (0.0, 0.0, 0.0)
    """e [mm] of equation (5.1): B axis to pitch apex along x_w, y_w, z_w at A = 0; at B = 0 these are Z, Y, -X."""
    z_reference: Literal["gauge_line", "tip"] = "gauge_line"
    """What Z of a program says: where the gauge line is, or with the length of the tool table where the tip is."""
    work_offset: Literal["G54", "G55", "G56", "G57"]
    work_offset_values: Annotated[tuple[_Number, _Number, _Number, _Number, _Number], Field(strict=False)] = (0.0,) * 5
    """What the control must hold for it, X Y Z A B: machine coordinates of the zero that this file counts from."""
    home_z: float | None = None
    """The Z to which programs retract before anything else moves; the top of the travel if left out."""
    cutter_direction: Literal["M3", "M4"] = "M3"
    spindle_speed_rpm: _Speeds
    max_feed_per_min: float | None = Field(default=None, gt=0)
    """Highest feed of the cutter past the tooth [mm/min]; None for no limit but those of the axes."""
    max_feed_per_turn: float | None = Field(default=None, gt=0)
    """The same in a turn of the cutter [mm]: what all of its blades together may take."""
    max_cutting_speed: float | None = Field(default=None, gt=0)
    """Highest speed of the blade tips [m/min]."""
    axes: Axes
    control: ControlSettings = ControlSettings()
    cutter_head: CutterHead = CutterHead()
    fixture: Fixture = Fixture()

    @model_validator(mode="after")
    def _one_sided_is_for_the_probe(self) -> MillingMachine:
        if self.axes.C is not None and self.axes.C.one_sided_approach:
            raise ValueError(
                f"axes.C.one_sided_approach {self.axes.C.one_sided_approach:g} must be left out: it is for A, which "
                "turns the work to the probe; C turns the cutter, and stands still where the probe is moved"
            )
        return self

    @model_validator(mode="after")
    def _tool_over_the_table(self) -> MillingMachine:
        low, high = self.axes.Z.travel
        if self.pivot_height >= high:
            raise ValueError(
                f"gauge_line_height {self.gauge_line_height:g} and tool_length {self.tool_length:g}: the tip of the "
                f"tool would be below the B axis over the whole travel of Z, {low:g} to {high:g}; gauge_line_height is "
                "the reading of Z at which the gauge line is level with the B axis"
            )
        if not low <= self.home <= high:
            raise ValueError(f"home_z {self.home:g} must lie within the travel of Z, {low:g} to {high:g}")
        return self

    @property
    def pivot(self) -> np.ndarray:
        """e of equation (5.1), (3,) mm."""
        return np.array(self.pivot_offset)

    @property
    def home(self) -> float:
        """The Z of ``home_z`` [mm]."""
        return self.axes.Z.travel[1] if self.home_z is None else self.home_z

    @property
    def one_sided(self) -> float:
        """How far A turns forwards before every touch [rad]; 0 where it comes from either side."""
        return math.radians(self.axes.A.one_sided_approach)

    @property
    def pivot_height(self) -> float:
        """R_d + C_t [mm] of equation (5.1)."""
        return self.gauge_line_height + self.tool_length

    @property
    def travel(self) -> np.ndarray:
        """Lowest and highest position of X Y Z A B, (5, 2) mm and rad; infinite for a modulo axis."""
        limits = np.array([axis.travel or (-np.inf, np.inf) for axis in self._all])
        return limits / UNITS_PER_INTERNAL[:, None]

    @property
    def max_speed(self) -> np.ndarray:
        """Highest speed of X Y Z A B, (5,) mm/s and rad/s."""
        return np.array([axis.max_speed_per_min for axis in self._all]) / UNITS_PER_INTERNAL / 60.0

    @property
    def max_acceleration(self) -> np.ndarray:
        """Highest acceleration of X Y Z A B, (5,) mm/s² and rad/s²."""
        return np.array([axis.max_acceleration for axis in self._all]) / UNITS_PER_INTERNAL

    @property
    def max_jerk(self) -> np.ndarray:
        """Highest jerk of X Y Z A B, (5,) mm/s³ and rad/s³; infinite where the file states none."""
        return np.array([axis.max_jerk or np.inf for axis in self._all]) / UNITS_PER_INTERNAL

    def limits(self, count: int) -> AxisLimits:
        """Limits of positions with ``count`` columns: five, or six with the cutter's axis, which must be there."""
        cutter = self.axes.C
        if count == len(AXES) or cutter is None:
            return AxisLimits(
                AXES, UNITS, UNITS_PER_INTERNAL, self.travel, self.max_speed, self.max_acceleration, self.max_jerk
            )
        degree = UNITS_PER_INTERNAL[-1]
        return AxisLimits(
            AXES + CUTTER_AXIS,
            (*UNITS, UNITS[-1]),
            np.append(UNITS_PER_INTERNAL, degree),
            np.vstack([self.travel, np.array(cutter.travel or (-np.inf, np.inf)) / degree]),
            np.append(self.max_speed, cutter.max_speed_per_min / degree / 60.0),
            np.append(self.max_acceleration, cutter.max_acceleration / degree),
            np.append(self.max_jerk, (cutter.max_jerk or np.inf) / degree),
        )

    @property
    def _all(self) -> tuple[TravelAxis, TravelAxis, TravelAxis, TurningAxis, TravelAxis]:
        return self.axes.X, self.axes.Y, self.axes.Z, self.axes.A, self.axes.B


def load_milling_machine(path: Path) -> MillingMachine:
    """Read a machine file. Raises InputError with file, key, value and limit."""
    return load(path, MillingMachine)


def save_axes(source: Path, target: Path, pivot_offset: np.ndarray, gauge_line_height: float) -> None:
    """Write the machine of ``source``, comments kept, with other places of its rotary axes, whole or not at all."""
    document = tomlkit.parse(read_text(source))
    document["gauge_line_height"] = round(float(gauge_line_height), 7)
    document["pivot_offset"] = [round(float(value), 7) for value in pivot_offset]
    text = tomlkit.dumps(document)
    parse(text, MillingMachine, str(target))
    write_text(target, text)

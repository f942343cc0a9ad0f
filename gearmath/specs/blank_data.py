"""The few design data from which the blank of a spiral bevel pair follows, to ISO 23509 method 0 (mm, degrees)."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Literal

from pydantic import Field, model_validator

from gearmath.specs.sheet import Angle, Length, Sheet
from gearmath.specs.toml import Spec, load

#: The tapers of the depth, numbered as ``notation.depth_taper``.
TAPERS = ("uniform", "standard", "duplex", "tilted_root_line")
#: The kinds of backlash, numbered as ``notation.backlash_kind``.
BACKLASHES = ("outer_normal", "outer_transverse", "mean_normal", "mean_transverse")


class BlankCutter(Sheet):
    """The cutter head: its mean radius, and the blade groups of a face hobbing head."""

    process: Literal["face_milling", "face_hobbing"]
    cutter_radius: Length = Field(ge=5, le=500)
    blade_groups: int | None = Field(default=None, ge=1, le=60)

    @model_validator(mode="after")
    def _consistent(self) -> BlankCutter:
        if (self.process == "face_hobbing") != (self.blade_groups is not None):
            raise ValueError("blade_groups belongs to face_hobbing, which needs it, and to no other process")
        return self


class Taper(Sheet):
    """How the depth changes along the tooth: a taper by name, or the two angles of the wheel."""

    kind: Literal["uniform", "standard", "duplex", "tilted_root_line"] | None = None
    wheel_addendum_angle: Angle | None = Field(default=None, ge=0, le=15)
    wheel_dedendum_angle: Angle | None = Field(default=None, ge=0, le=15)

    @model_validator(mode="after")
    def _one_way(self) -> Taper:
        given = [angle is not None for angle in (self.wheel_addendum_angle, self.wheel_dedendum_angle)]
        if any(given) != all(given) or all(given) == (self.kind is not None):
            raise ValueError("taper needs either kind, or both wheel_addendum_angle and wheel_dedendum_angle")
        return self


class DataType1(Sheet):
    """Data type I of ISO 23509: the basic crown gear."""

    crown_gear_addendum_factor: float = Field(ge=0.5, le=1.5)
    crown_gear_dedendum_factor: float = Field(ge=0.5, le=2)
    profile_shift_coefficient: float = Field(ge=-1, le=1)
    thickness_modification: float = Field(ge=-0.3, le=0.3)

    @model_validator(mode="after")
    def _deep_enough(self) -> DataType1:
        up, down = self.crown_gear_addendum_factor, self.crown_gear_dedendum_factor
        if down < up:
            raise ValueError(f"crown_gear_dedendum_factor {down} must be at least crown_gear_addendum_factor {up}")
        if abs(self.profile_shift_coefficient) >= up:
            raise ValueError(f"profile_shift_coefficient must lie between -{up} and {up}, or a member has no addendum")
        return self


class DataType2(Sheet):
    """Data type II of ISO 23509: depth, clearance, addendum and thickness factors."""

    tooth_depth_factor: float = Field(ge=1, le=3)
    clearance_factor: float = Field(ge=0, le=0.5)
    mean_addendum_factor: float = Field(gt=0, lt=1)
    thickness_factor: float = Field(ge=-0.6, le=0.6)


class Backlash(Sheet):
    """Backlash of the pair, square to the flank or as an arc on the pitch circle, at the heel or at the mean point."""

    outer_normal: Length | None = Field(default=None, ge=0, le=5)
    outer_transverse: Length | None = Field(default=None, ge=0, le=5)
    mean_normal: Length | None = Field(default=None, ge=0, le=5)
    mean_transverse: Length | None = Field(default=None, ge=0, le=5)

    @model_validator(mode="after")
    def _one_kind(self) -> Backlash:
        if sum(getattr(self, kind) is not None for kind in BACKLASHES) != 1:
            raise ValueError(f"backlash needs exactly one of {', '.join(BACKLASHES)}")
        return self

    @property
    def kind(self) -> int:
        """The number of the kind that is given."""
        return next(number for number, kind in enumerate(BACKLASHES) if getattr(self, kind) is not None)

    @property
    def value(self) -> float:
        return float(getattr(self, BACKLASHES[self.kind]))


class BlankData(Sheet):
    """Design data of a spiral bevel pair without hypoid offset. ``unit`` is that of the file's lengths; loaded: mm."""

    unit: Literal["mm", "inch"] = "mm"
    title: str = Field(min_length=1, max_length=200)
    source: str = Field(max_length=1000)
    shaft_angle: Angle = Field(ge=20, le=150)
    pinion_teeth: int = Field(ge=5, le=200)
    wheel_teeth: int = Field(ge=5, le=400)
    wheel_outer_pitch_diameter: Length | None = Field(default=None, gt=0, le=2000)
    outer_transverse_module: Length | None = Field(default=None, gt=0, le=50)
    face_width: Length = Field(gt=1, le=300)
    mean_spiral_angle: Angle = Field(ge=0, le=50)
    pressure_angle_drive: Angle = Field(ge=10, le=30)
    pressure_angle_coast: Angle = Field(ge=10, le=30)
    cutter: BlankCutter
    taper: Taper
    data_type_1: DataType1 | None = None
    data_type_2: DataType2 | None = None
    backlash: Backlash

    @model_validator(mode="after")
    def _consistent(self) -> BlankData:
        if self.wheel_teeth < self.pinion_teeth:
            raise ValueError(f"wheel_teeth {self.wheel_teeth} must be at least pinion_teeth {self.pinion_teeth}")
        if (self.wheel_outer_pitch_diameter is None) == (self.outer_transverse_module is None):
            raise ValueError("exactly one of wheel_outer_pitch_diameter and outer_transverse_module must be given")
        if (self.data_type_1 is None) == (self.data_type_2 is None):
            raise ValueError("exactly one of the tables data_type_1 and data_type_2 must be given")
        uniform = self.taper.kind == "uniform" or (
            self.taper.wheel_addendum_angle,
            self.taper.wheel_dedendum_angle,
        ) == (0, 0)
        if self.cutter.process == "face_hobbing" and not uniform:
            raise ValueError(
                "taper.kind must be 'uniform' (or both angles 0) in face_hobbing, which cuts uniform depth"
            )
        return self

    @property
    def values(self) -> dict[str, float]:
        """What is given as numbers, mm and rad, by the names of ``derivations.notation``."""
        angles = ("shaft_angle", "mean_spiral_angle", "pressure_angle_drive", "pressure_angle_coast")
        lengths = ("face_width", "wheel_outer_pitch_diameter", "outer_transverse_module")
        given = {name: math.radians(getattr(self, name)) for name in angles}
        given |= {name: getattr(self, name) for name in lengths if getattr(self, name) is not None}
        given |= {"pinion_teeth": self.pinion_teeth, "wheel_teeth": self.wheel_teeth}
        given |= {"cutter_radius": self.cutter.cutter_radius}
        given |= {"backlash": self.backlash.value, "backlash_kind": self.backlash.kind}
        if self.cutter.blade_groups is not None:
            given["blade_groups"] = self.cutter.blade_groups
        if self.taper.kind is not None:
            given["depth_taper"] = TAPERS.index(self.taper.kind)
        else:
            for name in ("wheel_addendum_angle", "wheel_dedendum_angle"):
                given[name] = math.radians(getattr(self.taper, name))
        return given | (self.data_type_1 or self.data_type_2 or Spec()).model_dump()


def load_blank_data(path: Path) -> BlankData:
    """Read the design data of a blank. Raises InputError naming file, key, value and limit."""
    return load(path, BlankData)

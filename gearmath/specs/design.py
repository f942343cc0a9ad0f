"""What a designer asks for: the few data from which blank and settings of a pair follow (mm, degrees).

All that a blank file has (``blank_data``) may stand here too; what is left out gets a value to start from.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

from pydantic import Field, model_validator

from gearmath.kernels import kernel
from gearmath.specs.blank_data import Backlash, BlankData, DataType1, DataType2, Taper
from gearmath.specs.cut import EdgeRadius
from gearmath.specs.sheet import Angle, Length, Sheet, shown
from gearmath.specs.toml import checked, load

#: Depth factor, and the two constants of the addendum factor, by the teeth of the pinion; 12 stands for all above. The
#: last is ISO 23509's, the others are shallower and give the pinion more of the depth, so that it is not undercut.
_SMALL_PINIONS = {
    5: (1.70, 0.115, 0.080),
    6: (1.765, 0.130, 0.115),
    7: (1.835, 0.145, 0.160),
    8: (1.895, 0.160, 0.195),
    9: (1.940, 0.170, 0.235),
    10: (1.975, 0.185, 0.260),
    11: (1.995, 0.210, 0.280),
    12: (2.0, 0.210, 0.290),
}
#: A Formate gear has straight flanks, which reach deeper into the pinion: its addendum is so much of the other one.
_FORMATE = 0.8
_CLEARANCE_FACTOR = 0.125
#: Backlash square to the flank, in outer transverse modules.
_BACKLASH = 0.03
#: What may be left free beyond what the mean point needs.
Free = Literal["blade_pressure_angle", "modified_roll", "cutter_tilt", "helical_motion"]


class DesignCutter(Sheet):
    """The cutter, and the radii of the cutters that the shop has: then the radius must be one of them, or is chosen."""

    process: Literal["face_milling", "face_hobbing"] = "face_milling"
    cutter_radius: Length | None = Field(default=None, ge=5, le=500)
    blade_groups: int | None = Field(default=None, ge=1, le=60)
    radii: tuple[Length, ...] = Field(default=(), strict=False, max_length=200)

    @model_validator(mode="after")
    def _radius(self) -> DesignCutter:
        if (self.process == "face_hobbing") != (self.blade_groups is not None):
            raise ValueError("blade_groups belongs to face_hobbing, which needs it, and to no other process")
        if any(not 5 <= radius <= 500 for radius in self.radii):
            raise ValueError("radii must lie between 5 and 500 mm")
        if self.cutter_radius is None and not self.radii:
            raise ValueError("cutter needs cutter_radius, or radii to choose from")
        if self.radii and self.cutter_radius is not None and self.cutter_radius not in self.radii:
            listed = ", ".join(f"{shown(radius):g}" for radius in sorted(self.radii))
            raise ValueError(f"cutter_radius {shown(self.cutter_radius):g} is not on the list of radii: {listed}")
        return self


class PinionMethod(Sheet):
    """How the pinion is cut, and what the fit of its whole flank may change beyond what the mean point needs."""

    cutting: Literal["fixed_setting", "completing"] = "fixed_setting"
    #: Left out: blade angle and modified roll where each flank is cut by itself, else all.
    free: tuple[Free, ...] | None = Field(default=None, strict=False)
    #: Tilt of the cutter; without it none for a generated gear, and square to the root line of a Formate one.
    cutter_tilt: Angle | None = Field(default=None, ge=-30, le=30)
    blade_edge_radius: EdgeRadius | None = None

    @model_validator(mode="after")
    def _tilt(self) -> PinionMethod:
        if self.cutting == "completing" and self.cutter_tilt is not None:
            raise ValueError(
                "cutter_tilt belongs to cutting = 'fixed_setting': a completing pinion gets the tilt that the fit "
                "finds, or none where free lacks 'cutter_tilt'"
            )
        return self

    @property
    def may_change(self) -> tuple[Free, ...]:
        """What the fit of the whole flank may change."""
        if self.free is not None:
            return self.free
        some: tuple[Free, ...] = ("blade_pressure_angle", "modified_roll")
        return some if self.cutting == "fixed_setting" else (*some, "cutter_tilt", "helical_motion")


class GearMethod(Sheet):
    """How the gear is cut; both its flanks in one cut."""

    generation: Literal["generated", "formate"] = "generated"
    blade_edge_radius: EdgeRadius | None = None


#: What may be asked for in the place of transmission error, path and pattern.
CROWNINGS = ("lengthwise_crowning", "profile_crowning", "bias")


class ContactRequest(Sheet):
    """What is asked of the contact of one side.

    ``transmission_error`` is that half a pitch from the vertex [arcsec], ``path_angle`` the direction of the path on
    the gear in its tangent plane, from the root line towards the tip; without it, a path that leans with the roll.
    ``pattern_length`` is the major axis of the contact ellipse at 6.35 µm over the face width. ``position`` tells where
    the vertex lies: from toe (0) to heel (1), and from root to tip of the part of the flank that the mate reaches;
    without it halfway along the tooth, and as high as makes both halves of the path as long.

    ``lengthwise_crowning``, ``profile_crowning`` and ``bias`` [um] may take the place of these three: the gap to a
    flank that would roll without transmission error, at toe and heel, at root and tip, and what the corner of heel and
    tip has beyond both.
    """

    transmission_error: float = Field(default=8.0, gt=0, le=120)
    path_angle: Angle | None = Field(default=None, ge=15, le=165)
    pattern_length: float = Field(default=0.5, ge=0.1, le=2)
    position: tuple[float, float] | None = Field(default=None, strict=False)
    lengthwise_crowning: float | None = Field(default=None, gt=0, le=500)
    profile_crowning: float | None = Field(default=None, gt=0, le=200)
    bias: float = Field(default=0.0, ge=-200, le=200)

    @model_validator(mode="after")
    def _one_way(self) -> ContactRequest:
        ways = (
            CROWNINGS,
            ("transmission_error", "path_angle", "pattern_length"),
        )
        given = [[name for name in names if name in self.model_fields_set] for names in ways]
        if given[0] and given[1]:
            raise ValueError(f"{given[0][0]} takes the place of {given[1][0]}: only one of them may be given")
        if not given[0]:
            return self
        length, profile = self.lengthwise_crowning, self.profile_crowning
        if length is None or profile is None:
            alone = " and ".join(given[0])
            raise ValueError(f"{alone}: lengthwise_crowning and profile_crowning must both be given")
        # beyond it the corners of the flank would stand out (27.7)
        most = 2 * math.sqrt(length * profile)
        if not abs(self.bias) < most:
            raise ValueError(f"bias = {self.bias:g} um: must be below {most:.4g} in size with these crownings")
        return self

    @model_validator(mode="after")
    def _inside(self) -> ContactRequest:
        if self.position is not None and any(not 0.1 <= part <= 0.9 for part in self.position):
            raise ValueError("position must lie between 0.1 and 0.9, from toe to heel and from root to tip")
        return self


class Shop(Sheet):
    """Steps to which the shop sets machine and cutter; 0 leaves a value as it is computed."""

    length_step: Length = Field(default=0.0, ge=0, le=1)
    angle_step: Angle = Field(default=0.0, ge=0, le=1)
    ratio_step: float = Field(default=0.0, ge=0, le=0.01)
    #: Of 2C and 6D.
    modified_roll_step: float = Field(default=0.0, ge=0, le=0.01)
    blade_angle_step: Angle = Field(default=0.0, ge=0, le=5)
    blade_radius_step: Length = Field(default=0.0, ge=0, le=10)


class DesignData(Sheet):
    """A spiral bevel pair to be designed. ``unit`` is that of the file's lengths; loaded: mm."""

    unit: Literal["mm", "inch"] = "mm"
    title: str = Field(min_length=1, max_length=200)
    source: str = Field(default="designed by gearmath", max_length=1000)
    shaft_angle: Angle = Field(default=90.0, ge=20, le=150)
    hand: Literal["left", "right"] = "left"
    pinion_teeth: int = Field(ge=5, le=200)
    wheel_teeth: int = Field(ge=5, le=400)
    wheel_outer_pitch_diameter: Length | None = Field(default=None, gt=0, le=2000)
    outer_transverse_module: Length | None = Field(default=None, gt=0, le=50)
    face_width: Length = Field(gt=1, le=300)
    #: Hypoid pairs are not designed yet; the key is there so that a file which needs it is refused in plain words.
    hypoid_offset: Length = Field(default=0.0, ge=-200, le=200)
    mean_spiral_angle: Angle = Field(default=35.0, ge=0, le=50)
    pressure_angle_drive: Angle = Field(default=20.0, ge=10, le=30)
    pressure_angle_coast: Angle = Field(default=20.0, ge=10, le=30)
    cutter: DesignCutter
    taper: Taper | None = None
    data_type_1: DataType1 | None = None
    data_type_2: DataType2 | None = None
    backlash: Backlash | None = None
    pinion: PinionMethod = PinionMethod()
    gear: GearMethod = GearMethod()
    drive: ContactRequest = ContactRequest()
    coast: ContactRequest = ContactRequest()
    shop: Shop = Shop()

    @classmethod
    def plain(cls, values: Mapping[str, Any], mm: float, where: tuple[str, ...]) -> dict[str, Any]:
        return {**super().plain(values, mm, where), "unit": values.get("unit", "mm")}

    @model_validator(mode="after")
    def _possible(self) -> DesignData:
        if self.hypoid_offset:
            raise ValueError(
                f"hypoid_offset = {shown(self.hypoid_offset):g}: must be 0, hypoid pairs are not designed yet"
            )
        if self.wheel_teeth < self.pinion_teeth:
            raise ValueError(f"wheel_teeth {self.wheel_teeth} must be at least pinion_teeth {self.pinion_teeth}")
        if (self.wheel_outer_pitch_diameter is None) == (self.outer_transverse_module is None):
            raise ValueError("exactly one of wheel_outer_pitch_diameter and outer_transverse_module must be given")
        return self

    def contact(self, side: str) -> ContactRequest:
        """What is asked of a side, ``drive`` or ``coast``."""
        return self.drive if side == "drive" else self.coast

    @property
    def module(self) -> float:
        """Outer transverse module [mm]."""
        if self.outer_transverse_module is not None:
            return self.outer_transverse_module
        assert self.wheel_outer_pitch_diameter is not None
        return self.wheel_outer_pitch_diameter / self.wheel_teeth

    @property
    def pitch_angles(self) -> tuple[float, float]:
        """Pitch angles of pinion and gear [rad]."""
        wheel = kernel("pitch_cones")
        given = {
            "shaft_angle": math.radians(self.shaft_angle),
            "pinion_teeth": self.pinion_teeth,
            "wheel_teeth": self.wheel_teeth,
            "wheel_outer_pitch_diameter": self.module * self.wheel_teeth,
            "face_width": self.face_width,
            "mean_spiral_angle": math.radians(self.mean_spiral_angle),
        }
        found = dict(
            zip([one.name for one in wheel.outputs], wheel(*(given[one.name] for one in wheel.inputs)), strict=True)
        )
        return float(found["pinion_pitch_angle"]), float(found["wheel_pitch_angle"])

    def blank_data(self, cutter_radius: float) -> BlankData:
        """The data of the blank with a cutter, completed by values to start from."""
        hobbed = self.cutter.process == "face_hobbing"
        keys = (
            "title",
            "source",
            "shaft_angle",
            "pinion_teeth",
            "wheel_teeth",
            "wheel_outer_pitch_diameter",
            "outer_transverse_module",
            "face_width",
            "mean_spiral_angle",
            "pressure_angle_drive",
            "pressure_angle_coast",
            "taper",
            "data_type_1",
            "data_type_2",
            "backlash",
        )
        values = self.model_dump(include=set(keys), exclude_none=True)
        values["cutter"] = {
            **self.cutter.model_dump(include={"process", "blade_groups"}),
            "cutter_radius": cutter_radius,
        }
        values.setdefault("taper", {"kind": "uniform" if hobbed else "duplex"})
        values.setdefault("backlash", {"outer_normal": _BACKLASH * self.module})
        if self.data_type_1 is None and self.data_type_2 is None:
            values["data_type_2"] = self._factors()
        return checked(values, BlankData, "design data")

    def _factors(self) -> dict[str, float]:
        depth, constant, share = _SMALL_PINIONS[min(self.pinion_teeth, max(_SMALL_PINIONS))]
        addendum, thickness = kernel("suggested_factors")(
            self.wheel_teeth / self.pinion_teeth, self.pinion_teeth, *self.pitch_angles, constant, share
        )
        return {
            "tooth_depth_factor": depth,
            "clearance_factor": _CLEARANCE_FACTOR,
            "mean_addendum_factor": float(addendum) * (_FORMATE if self.gear.generation == "formate" else 1.0),
            # fitted to usual ratios; it falls again beyond them, and below zero from 15 on
            "thickness_factor": max(float(thickness), 0.0),
        }


def load_design(path: Path) -> DesignData:
    """Read the data of a design. Raises InputError naming file, key, value and limit."""
    return load(path, DesignData)

"""How one flank of a bevel gear is cut: settings of machine and blade, their motions, those of the nominal flank."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, Field, model_validator

from derivations import Quantity, notation
from gearmath.specs.sheet import Angle, Length, Sheet, Unit, is_number, refusal_of, shown
from gearmath.specs.toml import Spec

SETTINGS = tuple(component.name for component in notation.settings.components)
#: The settings that belong to the machine and not to the blade: a completing cut shares them.
MACHINE_SETTINGS = tuple(name for name in SETTINGS if not name.startswith("blade_"))
#: The largest radius of a blade that is no straight one [mm]: its sagitta over 10 mm is 0.6 um.
STRAIGHT = 20_000.0
#: The settings that are angles.
ANGULAR = {component.name for component in notation.settings.components if component.unit == "rad"}
#: Cradle rotation by work rotation, in place of the ratio of roll.
CRADLE_PER_WORK = "ratio_of_roll_cradle_per_work"
RATIO = "ratio_of_roll"

_Coefficients = Annotated[tuple[Annotated[float, Field(ge=-1000, le=1000)], ...], Field(strict=False, max_length=7)]
_Lengths = Annotated[_Coefficients, Unit("mm")]
_Angles = Annotated[_Coefficients, Unit("degree")]

#: Less than this is no rounded edge [mm].
_SHARP = 0.001


def _edge(radius: float) -> float:
    if 0 < radius < _SHARP:
        raise ValueError(f"must be 0, for a sharp corner, or at least {shown(_SHARP):g}")
    return radius


EdgeRadius = Annotated[Length, Field(ge=0, le=10), AfterValidator(_edge)]


class Motion(Sheet):
    """Coefficients of θ^1 ... θ^7 of machine settings, mm and degrees per rad^j; ``modified_roll`` is 2C, 6D, ..."""

    radial_distance: _Lengths = ()
    cradle_angle: _Angles = ()
    cutter_tilt: _Angles = ()
    cutter_swivel: _Angles = ()
    blank_offset: _Lengths = ()
    sliding_base: _Lengths = ()
    machine_center_to_crossing_point: _Lengths = ()
    machine_root_angle: _Angles = ()
    ratio_of_roll: _Coefficients = ()
    work_rotation_offset: _Angles = ()
    modified_roll: Annotated[_Coefficients, Field(max_length=4)] = ()

    @classmethod
    def plain(cls, values: Mapping[str, Any], mm: float, where: tuple[str, ...]) -> dict[str, Any]:
        for key, value in values.items():
            if value == [] and key in cls.model_fields:
                raise refusal_of(cls, (*where, key), value, "holds no coefficient, so it has no effect; leave it out")
        return super().plain(values, mm, where)

    @property
    def matrix(self) -> np.ndarray:
        """The motion as the matrix of ``notation.motion`` (10,7), mm and rad, without the modified roll."""
        matrix = np.zeros(notation.motion.shape)
        for row, name in zip(matrix, MACHINE_SETTINGS, strict=True):
            if values := getattr(self, name):
                row[: len(values)] = np.radians(values) if name in ANGULAR else values
        return matrix

    @property
    def roll(self) -> np.ndarray:
        """2C, 6D, 24E, 120F (4,)."""
        roll = np.zeros(4)
        roll[: len(self.modified_roll)] = self.modified_roll
        return roll

    @property
    def moves(self) -> bool:
        """Whether any setting moves."""
        return any(any(getattr(self, name)) for name in type(self).model_fields)


class Settings(Sheet):
    """The settings of machine and cutter of one flank (mm, degrees).

    A file may give the ratio of roll, work by cradle, as ``ratio_of_roll_cradle_per_work`` instead.
    """

    radial_distance: Length = Field(gt=0, le=1000)
    cradle_angle: Angle = Field(ge=-180, le=180)
    cutter_tilt: Angle = Field(ge=-45, le=45)
    cutter_swivel: Angle = Field(ge=-360, le=360)
    blank_offset: Length = Field(ge=-200, le=200)
    sliding_base: Length = Field(ge=-200, le=200)
    machine_center_to_crossing_point: Length = Field(ge=-200, le=200)
    machine_root_angle: Angle = Field(gt=-30, lt=87)
    ratio_of_roll: float = Field(gt=0.1, le=50)
    work_rotation_offset: Angle = Field(ge=-360, le=360)
    blade_point_radius: Length = Field(gt=5, le=500)
    blade_pressure_angle: Angle = Field(ge=3, le=45)

    @classmethod
    def keys(cls) -> list[str]:
        """The keys of its table in a file."""
        return [*super().keys(), CRADLE_PER_WORK]

    @classmethod
    def plain(cls, values: Mapping[str, Any], mm: float, where: tuple[str, ...]) -> dict[str, Any]:
        plain = super().plain(values, mm, where)
        if CRADLE_PER_WORK in plain:
            ratio = plain.pop(CRADLE_PER_WORK)
            if RATIO in plain:
                raise refusal_of(
                    cls, (*where, CRADLE_PER_WORK), ratio, f"{RATIO} is given too: only one of them may be"
                )
            if not is_number(ratio) or not 1 / 50 <= ratio < 1 / 0.1:
                raise refusal_of(cls, (*where, CRADLE_PER_WORK), ratio, "must be at least 0.02 and less than 10")
            plain[RATIO] = 1 / ratio
        return plain

    @property
    def alpha(self) -> float:
        """Pressure angle α of the blade [rad]."""
        return math.radians(self.blade_pressure_angle)

    @property
    def vector(self) -> np.ndarray:
        """The settings as the vector of ``notation.settings`` (12,), mm and rad."""
        return vector_of(self, notation.settings.components)


class Design(Settings):
    """The settings of the nominal flank of a corrected one; ``motion`` where the motion was corrected too.

    ``blade_spheric_radius`` is that of the nominal blade, or "straight", where it was corrected.
    """

    motion: Motion | None = None
    blade_spheric_radius: Annotated[Length, Field(ge=-STRAIGHT, le=STRAIGHT)] | Literal["straight"] | None = None


class Flank(Settings):
    """How one flank is cut; ``design``, where given, holds the settings of the nominal flank, the others corrected."""

    blade_profile_height: Length = Field(gt=0, le=60)
    blade_edge_radius: EdgeRadius = 0.0
    #: Of a hobbing blade: its tip stands so far above the plane of the point radius, or below it where negative (mm).
    blade_tip_height: Length = Field(default=0.0, ge=-2, le=2)
    #: Of a fixed-setting cutter, which has another side (mm); without it the root of the space decides.
    blade_point_width: Length | None = Field(default=None, gt=0, le=60)
    #: Blades that cut this flank in a turn of the cutter, 1 for a fly cutter; they make the chip, and not the flank.
    blade_count: int | None = Field(default=None, ge=1, le=100)
    blade_spheric_radius: Length | None = Field(default=None, ge=-STRAIGHT, le=STRAIGHT)
    blade_reference_height: Length = Field(default=0.0, ge=0, le=60)
    toprem_angle: Angle | None = Field(default=None, ge=0.5, le=45)
    toprem_height: Length = Field(default=0.0, ge=0, le=10)
    blade_offset_angle: Angle = Field(default=0.0, ge=-45, le=45)
    motion: Motion = Motion()
    design: Design | None = None

    @model_validator(mode="after")
    def _blade(self) -> Flank:
        if self.blade_spheric_radius is not None and abs(self.blade_spheric_radius) < 2 * self.blade_profile_height:
            radius, limit = shown(self.blade_spheric_radius), shown(2 * self.blade_profile_height)
            raise ValueError(f"blade_spheric_radius = {radius}: must be at least {limit} in size")
        if (self.toprem_angle is not None) != (self.toprem_height > 0):
            raise ValueError("toprem_angle and toprem_height belong together")
        return self

    @property
    def nominal(self) -> Settings:
        """The settings whose tooth surface is wanted."""
        return self.design or self

    @property
    def nominal_spheric_radius(self) -> float | None:
        """The radius of the blade whose tooth surface is wanted, None where it is straight."""
        before = self.design.blade_spheric_radius if isinstance(self.design, Design) else None
        return self.blade_spheric_radius if before is None else None if before == "straight" else before

    @property
    def nominal_motion(self) -> Motion:
        """The motion of the settings whose tooth surface is wanted."""
        return (self.design.motion if isinstance(self.design, Design) else None) or self.motion


def vector_of(model: Spec, components: tuple[Quantity, ...]) -> np.ndarray:
    """The values of these keys, in mm and rad."""
    values = [(getattr(model, component.name), component.unit) for component in components]
    return np.array([math.radians(value) if unit == "rad" else value for value, unit in values])

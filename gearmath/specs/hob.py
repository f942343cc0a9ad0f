"""One hob: its size, the rule for the depth of its teeth, its diameter.

Lengths of diametral-pitch hobs are converted here: P teeth per inch of diameter is the module 25.4/P mm.
"""

from __future__ import annotations

import math
from typing import Literal

from pydantic import Field, model_validator

from derivations import notation
from gearmath.specs.ratio import INCH
from gearmath.specs.toml import Spec

#: depth rule -> (whole depth in modules, depth added in mm). P rules are for hobs in diametral pitch, m for module.
DEPTH_RULES = {
    "2.25/P": (2.25, 0.0),
    "2.157/P": (2.157, 0.0),
    "2.2/P+0.002in": (2.2, 0.002 * INCH),
    "2.25m": (2.25, 0.0),
}

#: Tip radius of the hob in modules, which is the root fillet of the basic rack, ISO 53.
TIP_RADII = {"A": 0.38, "B": 0.3, "C": 0.25, "D": 0.39}

#: How much less the pressure angle of a protuberance is than that of the flank: at least, and usually [degrees].
LEAST_PROTRUDING, USUAL_PROTRUDING = 2.0, 10.0
#: Reference diameter of a hob whose file does not say it: the usual small one, or so many modules [mm].
ASSUMED_DIAMETER, ASSUMED_MODULES = 25.4, 16.0
#: Least lead of its gashes, in its diameters.
LEAST_GASH_LEAD = 5.0


class Hob(Spec):
    """One hob: its diametral pitch [1/in] or its module [mm], and the rule for the whole depth of its teeth."""

    diametral_pitch: float | None = Field(default=None, ge=1.0, le=254.0)
    module: float | None = Field(default=None, ge=0.1, le=25.0)
    depth_rule: Literal["2.25/P", "2.157/P", "2.2/P+0.002in", "2.25m"]
    diameter: float | None = Field(default=None, gt=0.0, le=500.0)
    """Reference diameter [mm], where the lead angle is taken; only the swivel angle needs it."""
    length: float | None = Field(default=None, gt=0.0, le=500.0)
    """Length of its toothed part [mm]; a hob that is too short for a gear is refused by ``gearbox cut``."""
    pressure_angle: float = Field(default=20.0, ge=10.0, le=30.0)
    """Normal pressure angle [degrees]."""
    gashes: int = Field(default=12, ge=int(notation.hob_gashes.domain[0]), le=int(notation.hob_gashes.domain[1]))
    """How many rows of teeth the hob has around."""
    basic_rack: Literal["A", "B", "C", "D"] = "A"
    """Basic rack of ISO 53, which says how the tips of its teeth are rounded."""
    tip_radius: float | None = Field(default=None, ge=0.0, le=1.0)
    """Radius of the tips in modules, where it is not that of the basic rack."""
    protuberance: float = Field(default=0.0, ge=0.0, le=0.2)
    """How far the tips protrude beyond the flank, along its normal, in modules."""
    protuberance_angle: float | None = Field(default=None, ge=0.0, lt=30.0)
    """Pressure angle of the protruding flank [degrees]: 10 less than that of the flank if not given."""
    topping: bool = False
    """Whether the root of the hob turns the tip of the gear, one module above the reference circle."""
    gash_lead: float | None = Field(default=None, gt=0.0, le=100_000.0)
    """Lead of the gashes around the hob [mm], of the other hand than its threads; straight gashes if not given."""

    @model_validator(mode="after")
    def _one_size(self) -> Hob:
        if (self.diametral_pitch is None) == (self.module is None):
            given = self.module is not None
            raise ValueError(
                f"module = {self.module:g} and diametral_pitch = {self.diametral_pitch:g}: exactly one is a hob's"
                if given
                else "a hob needs exactly one of module (0.1 to 25 mm) and diametral_pitch (1 to 254 per inch)"
            )
        if self.depth_rule.endswith("m") != (self.module is not None):
            fitting = [rule for rule in DEPTH_RULES if rule.endswith("m") != self.depth_rule.endswith("m")]
            size = f"module = {self.module:g}" if self.module is not None else f"diametral_pitch = {self._size:g}"
            raise ValueError(f"depth_rule = {self.depth_rule!r}: does not fit {size}, use one of {', '.join(fitting)}")
        if abs(self._size * 10_000 - self.size_tenthousandths) > 1e-6:
            key = "diametral_pitch" if self.module is None else "module"
            raise ValueError(f"{key} = {self._size:.12g}: has more than the four decimals that the display keeps")
        if self.diameter is not None and self.diameter <= 5.0 * self.module_mm:
            raise ValueError(f"diameter = {self.diameter:g}: must be more than five modules of {self.module_mm:g} mm")
        return self

    @model_validator(mode="after")
    def _protuberance_is_one(self) -> Hob:
        given, angle = self.protuberance, self.protuberance_angle
        if not given:
            if angle is not None:
                raise ValueError("protuberance_angle has no meaning without protuberance")
            return self
        if angle is not None and angle > self.pressure_angle - LEAST_PROTRUDING:
            most = self.pressure_angle - LEAST_PROTRUDING
            raise ValueError(f"protuberance_angle = {angle:g}: must be at most {most:g} degrees, to leave the flank")
        radius = self.tip_rounding / self.module_mm
        least = radius * (1.0 - math.cos(self.alpha - self.alpha_protuberance))
        if given < least:
            raise ValueError(
                f"protuberance = {given:g}: must be at least {least:.4f} modules beside a tip radius of {radius:g}"
            )
        return self

    @property
    def alpha_protuberance(self) -> float:
        """Pressure angle of the protruding flank [rad]."""
        given = self.protuberance_angle
        return math.radians(max(0.0, self.pressure_angle - USUAL_PROTRUDING) if given is None else given)

    @model_validator(mode="after")
    def _gashes_are_not_threads(self) -> Hob:
        least = LEAST_GASH_LEAD * self.reference_diameter
        if self.gash_lead is not None and self.gash_lead < least:
            raise ValueError(
                f"gash_lead = {self.gash_lead:g}: must be at least {LEAST_GASH_LEAD:g} diameters, {least:g} mm"
            )
        return self

    @property
    def reference_diameter(self) -> float:
        """Reference diameter [mm]: where the file does not say it, the usual small one, or so many modules."""
        return self.diameter or max(ASSUMED_DIAMETER, ASSUMED_MODULES * self.module_mm)

    @property
    def _size(self) -> float:
        return self.diametral_pitch if self.diametral_pitch is not None else float(self.module or 0.0)

    @property
    def name(self) -> str:
        """What people call it: 32dp, or m0.5."""
        return f"{self.diametral_pitch:g}dp" if self.diametral_pitch is not None else f"m{self.module:g}"

    @property
    def unit(self) -> Literal["inch", "mm"]:
        """In which unit its gears are shown."""
        return "inch" if self.diametral_pitch is not None else "mm"

    @property
    def size_tenthousandths(self) -> int:
        """Diametral pitch or module, times 10 000: a whole number; GM_HOB_UNIT."""
        return round(self._size * 10_000)

    @property
    def module_mm(self) -> float:
        """Normal module [mm]."""
        return INCH / self.diametral_pitch if self.diametral_pitch is not None else float(self.module or 0.0)

    @property
    def addendum(self) -> float:
        """Height of its teeth above the reference cylinder [mm]: the whole depth less one module."""
        factor, extra = self.depth_terms
        return (factor - 1.0) * self.module_mm + extra

    @property
    def tip_rounding(self) -> float:
        """Radius of its tips [mm]."""
        factor = TIP_RADII[self.basic_rack] if self.tip_radius is None else self.tip_radius
        return factor * self.module_mm

    @property
    def alpha(self) -> float:
        """Normal pressure angle [rad]."""
        return math.radians(self.pressure_angle)

    @property
    def depth_terms(self) -> tuple[float, float]:
        """Whole depth in modules, and the depth added to it [mm]."""
        return DEPTH_RULES[self.depth_rule]

"""How well a machine measures: the standard uncertainties behind every touch."""

from __future__ import annotations

import math
from pathlib import Path

from pydantic import Field

from gearmath.specs.toml import Spec, load


class MeasuringModel(Spec):
    """Standard uncertainties (1 sigma) of what goes into a touch, and how many touches are averaged."""

    title: str = Field(min_length=1, max_length=200)
    repeatability_um: float = Field(ge=0, le=100)
    """New at every touch."""
    touches: int = Field(default=1, ge=1, le=1000)
    """Touches averaged to one point."""
    pretravel_um: float = Field(default=0.0, ge=0, le=100)
    """What calibration leaves of the tip's radius, common to all touches of a flank."""
    position_um: float = Field(default=0.0, ge=0, le=100)
    """Of each of X, Y, Z where they stand; common to the touches at one place of every tooth."""
    work_axis_arcsec: float = Field(default=0.0, ge=0, le=600)
    """Of the work axis A, common to the touches in one tooth space."""
    squareness_um_per_m: float = Field(default=0.0, ge=0, le=1000)
    """X to Z, common to all touches."""
    temperature_K: float = Field(default=0.0, ge=0, le=20)
    """Of the work's temperature against that of the machine's scales, common to all touches."""
    expansion_per_K: float = Field(default=11.5e-6, ge=0, le=1e-4)
    """Thermal expansion of the work; 11.5e-6 for steel."""

    @property
    def touch(self) -> float:
        """Standard uncertainty of an averaged point from repeatability alone [mm]."""
        return self.repeatability_um / 1000 / math.sqrt(self.touches)

    @property
    def work_axis(self) -> float:
        """Standard uncertainty of A [rad]."""
        return math.radians(self.work_axis_arcsec / 3600)

    @property
    def growth(self) -> float:
        """Standard uncertainty of the work's relative size."""
        return self.expansion_per_K * self.temperature_K


def load_measurement(path: Path) -> MeasuringModel:
    """Read a file of measurement uncertainties. Raises InputError naming file, key, value and limit."""
    return load(path, MeasuringModel)

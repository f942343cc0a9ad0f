"""What is wrong with a simulated machine and its probe: the file behind every closed loop without metal."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import Field

from derivations import notation
from gearmath.shown import Shown, Shows
from gearmath.specs.bevel_set import MACHINE_SETTINGS, SETTINGS
from gearmath.specs.obstacles import CutterHead, Fixture
from gearmath.specs.toml import Spec, load

_UNITS = {component.name: component.unit for component in notation.settings.components}


class SettingErrors(Spec):
    """By how much the machine is really off its settings (mm, degrees), for every pass of a member."""

    radial_distance: float = Field(default=0.0, ge=-1, le=1)
    cradle_angle: float = Field(default=0.0, ge=-1, le=1)
    cutter_tilt: float = Field(default=0.0, ge=-1, le=1)
    cutter_swivel: float = Field(default=0.0, ge=-1, le=1)
    blank_offset: float = Field(default=0.0, ge=-1, le=1)
    sliding_base: float = Field(default=0.0, ge=-1, le=1)
    machine_center_to_crossing_point: float = Field(default=0.0, ge=-1, le=1)
    machine_root_angle: float = Field(default=0.0, ge=-1, le=1)
    ratio_of_roll: float = Field(default=0.0, ge=-0.1, le=0.1)
    work_rotation_offset: float = Field(default=0.0, ge=-1, le=1)

    @property
    def vector(self) -> np.ndarray:
        """The errors as the vector of ``notation.settings`` (12,), mm and rad; the blades have none."""
        values = {name: getattr(self, name) for name in MACHINE_SETTINGS}
        return np.array(
            [
                math.radians(values.get(name, 0.0)) if _UNITS[name] == "rad" else values.get(name, 0.0)
                for name in SETTINGS
            ]
        )


class WorkAxis(Spec):
    """Index error of the work axis: a first harmonic over the turn, and a random part of every tooth space."""

    first_harmonic_arcsec: float = Field(default=0.0, ge=0, le=600)
    first_harmonic_phase: float = Field(default=0.0, ge=-360, le=360)
    random_arcsec: float = Field(default=0.0, ge=0, le=600)


class Harmonic(Spec):
    """A periodic error of the work axis, ``order`` periods a turn, at every position and not only at the spaces."""

    order: int = Field(ge=1, le=1000)
    amplitude_arcsec: float = Field(ge=0, le=600)
    phase: float = Field(default=0.0, ge=-360, le=360)


class Screw(Spec):
    """Error of a ball screw that comes back with every turn: a sine over the travel, ``lead`` (mm) a period."""

    axis: Literal["X", "Y", "Z"]
    lead: float = Field(ge=1, le=100)
    amplitude_um: float = Field(ge=0, le=100)
    phase: float = Field(default=0.0, ge=-360, le=360)


class AxisErrors(Spec):
    """Geometric errors of the axes: offsets in mm and degrees, and X to Z out of square: X moves with Z (µm/m)."""

    X: float = Field(default=0.0, ge=-1, le=1)
    Y: float = Field(default=0.0, ge=-1, le=1)
    Z: float = Field(default=0.0, ge=-1, le=1)
    A: float = Field(default=0.0, ge=-1, le=1)
    B: float = Field(default=0.0, ge=-1, le=1)
    A_backlash_arcsec: float = Field(default=0.0, ge=0, le=600)
    B_backlash_arcsec: float = Field(default=0.0, ge=0, le=600)
    """Between both directions of turning: half of it the axis lags behind in each."""
    squareness_x_z_um_per_m: float = Field(default=0.0, ge=-1000, le=1000)
    A_harmonics: tuple[Harmonic, ...] = Field(default=(), strict=False, max_length=20)
    screws: tuple[Screw, ...] = Field(default=(), strict=False, max_length=20)

    @property
    def offsets(self) -> np.ndarray:
        """Offsets of X Y Z A B (5,), mm and rad."""
        return np.array([self.X, self.Y, self.Z, math.radians(self.A), math.radians(self.B)])

    @property
    def backlash(self) -> np.ndarray:
        """Backlash of A and B (2,), rad."""
        return np.radians(np.array([self.A_backlash_arcsec, self.B_backlash_arcsec]) / 3600)


class Mounting(Spec):
    """How the work sits on its axis: eccentricity (mm) and tilt (degrees), each with its direction in the work."""

    eccentricity: float = Field(default=0.0, ge=0, le=1)
    eccentricity_direction: float = Field(default=0.0, ge=-360, le=360)
    tilt: float = Field(default=0.0, ge=0, le=1)
    tilt_direction: float = Field(default=0.0, ge=-360, le=360)


class Drift(Spec):
    """How far the work has moved in X Y Z of the machine by the end of a run (µm), evenly from its beginning."""

    X_um: float = Field(default=0.0, ge=-1000, le=1000)
    Y_um: float = Field(default=0.0, ge=-1000, le=1000)
    Z_um: float = Field(default=0.0, ge=-1000, le=1000)

    @property
    def vector(self) -> np.ndarray:
        """At the end of the run (3,), mm."""
        return np.array([self.X_um, self.Y_um, self.Z_um]) / 1000


class SimulatedMeasuring(Spec):
    """The clamping in which a finished member is measured, and how the measuring machine drifts during a run."""

    pinion: Mounting = Mounting()
    gear: Mounting = Mounting()
    drift: Drift = Drift()


class Probe(Spec):
    """Standard deviation of one touch, how many touches of a point are averaged, and the lobes of the pre-travel.

    The effective radius varies by ``lobing_um`` cos 3(azimuth - ``lobing_phase``) sin(angle to the stylus), (23.3).
    """

    sigma_um: float = Field(default=0.0, ge=0, le=100)
    touches: int = Field(default=1, ge=1, le=100)
    lobing_um: float = Field(default=0.0, ge=0, le=20)
    lobing_phase: float = Field(default=0.0, ge=-360, le=360)

    @property
    def sigma(self) -> float:
        """Standard deviation of the average of the touches of one point [mm]."""
        return self.sigma_um / 1000 / math.sqrt(self.touches)


class SimulatedMachine(Shown, Spec):
    """Errors of machine, work axis and probe; ``seed`` makes the random ones the same in every run."""

    title: str = Field(min_length=1, max_length=200)
    seed: int = Field(ge=0)
    pinion: SettingErrors = SettingErrors()
    gear: SettingErrors = SettingErrors()
    work_axis: WorkAxis = WorkAxis()
    axes: AxisErrors = AxisErrors()
    mounting: Mounting = Mounting()
    measuring: SimulatedMeasuring = SimulatedMeasuring()
    cutter_head: CutterHead | None = None
    fixture: Fixture | None = None
    """Where they are given, they stand for those of the machine file."""
    probe: Probe = Probe()

    def setting_errors(self, member: str) -> np.ndarray:
        """Setting errors (12,) of a member, mm and rad."""
        return (self.pinion if member == "pinion" else self.gear).vector

    def measuring_clamp(self, member: str) -> Mounting:
        """How a member sits while it is measured."""
        return self.measuring.pinion if member == "pinion" else self.measuring.gear

    def _shown(self) -> tuple[str, list[Shows]]:
        return self.title, [("seed", self.seed, ""), ("probe noise", self.probe.sigma_um, "um")]


def load_simulated_machine(path: Path) -> SimulatedMachine:
    """Read the errors of a simulated machine. Raises InputError naming file, key, value and limit."""
    return load(path, SimulatedMachine)

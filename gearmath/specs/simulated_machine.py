"""What is wrong with a simulated machine and its probe: the file behind every closed loop without metal."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from pydantic import Field

from derivations import notation
from gearmath.specs.bevel_set import MACHINE_SETTINGS, SETTINGS
from gearmath.specs.toml import Spec, load

_UNITS = {component.name: component.unit for component in notation.settings.components}


class SettingErrors(Spec):
    """By how much the machine really stands off its settings (mm, degrees), for every pass of a member."""

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
        return np.array([
            math.radians(values.get(name, 0.0)) if _UNITS[name] == "rad" else values.get(name, 0.0) for name in SETTINGS
        ])  # fmt: skip


class WorkAxis(Spec):
    """Index error of the work axis: a first harmonic over the turn, and a random part of every tooth space."""

    first_harmonic_arcsec: float = Field(default=0.0, ge=0, le=600)
    first_harmonic_phase: float = Field(default=0.0, ge=-360, le=360)
    random_arcsec: float = Field(default=0.0, ge=0, le=600)


class Probe(Spec):
    """Standard deviation of one measured deviation."""

    sigma_um: float = Field(default=0.0, ge=0, le=100)


class SimulatedMachine(Spec):
    """Errors of machine, work axis and probe; ``seed`` makes the random ones the same in every run."""

    title: str = Field(min_length=1, max_length=200)
    seed: int = Field(ge=0)
    pinion: SettingErrors = SettingErrors()
    gear: SettingErrors = SettingErrors()
    work_axis: WorkAxis = WorkAxis()
    probe: Probe = Probe()

    def setting_errors(self, member: str) -> np.ndarray:
        """Setting errors (12,) of a member, mm and rad."""
        return (self.pinion if member == "pinion" else self.gear).vector


def load_simulated_machine(path: Path) -> SimulatedMachine:
    """Read the errors of a simulated machine. Raises InputError naming file, key, value and limit."""
    return load(path, SimulatedMachine)

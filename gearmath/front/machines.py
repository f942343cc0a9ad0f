"""Machines, simulated shops and probes from their files."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gearmath.specs.calibration import Calibration, load_calibration
from gearmath.specs.hobbing import HobbingMachine, load_hobbing_machine
from gearmath.specs.milling_machine import MillingMachine, load_milling_machine
from gearmath.specs.simulated_machine import SimulatedMachine, load_simulated_machine
from gearmath.specs.toml import find


@dataclass(frozen=True)
class Machine:
    """A vertical 5-axis milling machine; ``spec`` is the checked content of its file (docs/machine_files.md)."""

    spec: MillingMachine

    def to_dict(self) -> dict[str, Any]:
        """The machine with the keys of its file, mm and degrees."""
        return self.spec.model_dump(exclude_defaults=True)


def load_machine(path: str | Path = "vertical_5axis.toml") -> Machine:
    """Read a milling machine: a TOML file, or a bundled one. Raises InputError naming key, value and limit.

    >>> import gearmath as gm
    >>> gm.load_machine().spec.name
    'Vertical 5-axis machine'
    """
    return Machine(load_milling_machine(find(str(path))))


def load_shop(path: str | Path = "simulated_shop.toml") -> SimulatedMachine:
    """Read what is wrong with a simulated machine, its clamping and its probe. Raises InputError."""
    return load_simulated_machine(find(str(path)))


def load_probe(path: str | Path = "probe.toml") -> Calibration:
    """Read a calibrated probe. Raises InputError."""
    return load_calibration(find(str(path)))


def load_hobber(path: str | Path = "hobbing_plewes.toml") -> HobbingMachine:
    """Read a hobbing machine or lathe with an electronic gearbox. Raises InputError."""
    return load_hobbing_machine(find(str(path)))

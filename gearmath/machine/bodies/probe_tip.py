"""The tip of a probe on the machine: the height that positions count with, and the lobes of its sphere."""

from __future__ import annotations

import numpy as np

from gearmath.kernels import kernel
from gearmath.specs.calibration import Calibration
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.simulated_machine import Probe


def probe_height(machine: MillingMachine, calibration: Calibration) -> float:
    """H [mm] of equation (15.3)."""
    return machine.gauge_line_height + calibration.length


def lobing(probe: Calibration | Probe) -> np.ndarray:
    """Lobes (2,) [mm] of equation (23.3)."""
    (lobes,) = kernel("lobing_of")(probe.lobing_um / 1000, probe.rad("lobing_phase"))
    return lobes

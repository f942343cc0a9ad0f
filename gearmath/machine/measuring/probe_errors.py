"""A probe that errs: on axes that err, on work that drifts, with lobes and noise."""

from __future__ import annotations

import numpy as np

from gearmath.kernels import kernel
from gearmath.machine.bodies.probe_tip import lobing
from gearmath.machine.control.state import Probe
from gearmath.machine.milling.axis_errors import AxisBacklash, with_axis_errors
from gearmath.specs.simulated_machine import SimulatedMachine

#: A and B stand still within this. [rad]
_STILL = 1e-9


class ErringProbe:
    """Stands between a program and a perfect ``probe``, for :func:`run_program`, with the errors of a shop.

    The probe is moved where the axes really stand, the control reads where they should. ``touches`` is how many the
    run has, over which the drift comes about evenly; without it there is none. ``run`` numbers the runs: each has its
    own noise, the same every time. The tip is taken to move against the normal of what it touches.
    """

    def __init__(self, probe: Probe, shop: SimulatedMachine, touches: int | None = None, run: int = 1) -> None:
        self.probe, self.shop = probe, shop
        self.count, self.steps = 0, max((touches or 1) - 1, 1)
        self._drift = shop.measuring.drift.vector if touches is not None else np.zeros(3)
        self._random = np.random.default_rng([shop.seed, run])
        self._backlash = AxisBacklash(shop)

    def follow(self, position: np.ndarray) -> None:
        """The axes have moved to a position X Y Z A B (5,), touching or not."""
        self._backlash(position)

    def __call__(self, start: np.ndarray, end: np.ndarray) -> np.ndarray | None:
        """Where the control reads the trigger between two positions X Y Z A B (5,); None if nothing is touched."""
        real = with_axis_errors(np.stack([start, end]), self.shop)
        for one, told in zip(real, (start, end), strict=True):
            one[3:] += self._backlash(told)
        # work that has moved by d is, to the tip, an axis that stands back by d
        real[:, :3] -= self.count / self.steps * self._drift
        found = self.probe(*real)
        if found is None:
            return None
        share = float(np.linalg.norm(found - real[0]) / np.linalg.norm(real[1] - real[0]))
        if np.abs(end - start)[3:].max() > _STILL:
            return start + share * (end - start)  # in the way, and no touch
        self.count += 1
        way = (end - start)[:3]
        length = float(np.linalg.norm(way))
        (early,) = kernel("effective_radius")(-way / length, 0.0, lobing(self.shop.probe))
        off = float(early) + self.shop.probe.sigma_um / 1000 * self._random.standard_normal()
        return start + (share - off / length) * (end - start)

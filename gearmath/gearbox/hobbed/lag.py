"""The motor that lags behind its steps, under a hob whose speed is uneven."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmath.gearbox.hobbed.job import TURN, HobbingJob
from gearmath.gearbox.hobbed.sines import PERCENT, harmonics
from gearmath.specs.cutting_errors import CuttingErrors

#: Times of a first-order lag that stand for all of them, each as likely as the others.
TIMES = -np.log(1.0 - (np.arange(32) + 0.5) / 32)


@dataclass(frozen=True)
class Lag:
    """A lag of the first order at a mean speed of the hob [1/min]."""

    errors: CuttingErrors
    job: HobbingJob
    rpm: float

    @property
    def is_even(self) -> bool:
        """Whether it is the same all the time."""
        return not self.errors.speed_ripple and self.errors.stop_in_cut_mm is None

    def delay(self, psi: np.ndarray) -> np.ndarray:
        """Turn of the hob [rad] by which the motor lags at hob turns ψ."""
        return self._constant * self._part_of_speed(psi) * self._ripple(psi)

    def ahead(self, psi: np.ndarray) -> np.ndarray:
        """Turn of the hob [rad] by which it is ahead, at ψ, of the lag at the speed of the job."""
        found: np.ndarray = (self._constant - self.delay(psi)) * TIMES.mean()
        return found

    def ahead_range(self, psi: np.ndarray, unsure: float) -> tuple[np.ndarray, np.ndarray]:
        """Its least and most where ψ is known but for ``unsure`` [rad]."""
        parts = [np.ones_like(psi)] * 2
        if self.errors.stop_in_cut_mm is not None:
            away = np.abs(psi - self._stands)
            parts = [self._part_beside_stop(np.maximum(away + each, 0.0)) for each in (-unsure, unsure)]
        swing = sum(
            each.amplitude_percent * PERCENT * min(2.0, unsure * each.order) for each in self.errors.speed_ripple
        )
        ripple = self._ripple(psi)
        slowest, fastest = parts[0] * np.maximum(ripple - swing, 0.0), parts[1] * (ripple + swing)
        by_speed = self._constant * float(TIMES.mean())
        return by_speed * (1.0 - fastest), by_speed * (1.0 - slowest)

    @property
    def _speed(self) -> float:
        """Of the hob [rad/s]."""
        return self.rpm / 60 * TURN

    @property
    def _constant(self) -> float:
        """Turn of the hob [rad] by which the motor lags at the speed of the job."""
        return self._speed * self.errors.motor_time_constant_ms / 1000

    def _ripple(self, psi: np.ndarray) -> np.ndarray:
        return 1.0 + harmonics(self.errors.speed_ripple, psi, PERCENT)

    def _part_of_speed(self, psi: np.ndarray) -> np.ndarray:
        """The hob's speed as part of that of the job: less on both sides of a stop, evenly slower and faster."""
        if self.errors.stop_in_cut_mm is None:
            return np.ones_like(psi)
        return self._part_beside_stop(np.abs(psi - self._stands))

    @property
    def _stands(self) -> float:
        """Turn of the hob [rad] at which it stood within the cut."""
        height = self.errors.stop_in_cut_mm
        assert height is not None
        return (height - self.job.start_height) / self.job.travel_per_rad

    def _part_beside_stop(self, away: np.ndarray) -> np.ndarray:
        run_up = self._speed * self.errors.run_up_seconds / 2
        found: np.ndarray = np.sqrt(np.minimum(away / run_up, 1.0))
        return found

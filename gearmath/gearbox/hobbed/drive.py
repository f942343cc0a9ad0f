"""The drive train as it is: how far the table deviates from ideal meshing, and how hob and gear are displaced.

The steps are those of the compiled rule at the encoder's edges: :func:`step_error` is its closed form (7.4), which a
test compares with the compiled kernel edge by edge.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from gearmath.errors import InputError
from gearmath.gearbox.helix import JobRatio
from gearmath.gearbox.hobbed.job import TURN, HobbingJob
from gearmath.gearbox.hobbed.lag import TIMES, Lag
from gearmath.gearbox.hobbed.sines import ARCSEC, UM, harmonics
from gearmath.gearbox.kernels import kernel
from gearmath.gearbox.simulation import FloatRule
from gearmath.specs.cutting_errors import CuttingErrors
from gearmath.specs.hobbing import HobbingMachine

Rule = Literal["ideal", "exact", "float"]

#: Positions of the motor that are asked for at once.
AT_ONCE = 200_000


@dataclass(frozen=True)
class DriveTrain:
    """A machine at work on a job: its ratio, its rule, hob speed [1/min], and seconds it has run before the cut."""

    machine: HobbingMachine
    job: HobbingJob
    ratio: JobRatio
    rule: Rule = "exact"
    rpm: float = 100.0
    seconds: float = 0.0

    def __post_init__(self) -> None:
        if self.rule == "float" and self.ratio.numerators[1]:
            raise InputError("rule float: the floating rule of the source text knows no encoder on the feed")

    @property
    def errors(self) -> CuttingErrors:
        """What is wrong with the machine."""
        return self.machine.errors

    @property
    def step(self) -> float:
        """Turn of the table by a motor step [rad]."""
        return TURN / float(self.machine.motor_steps)

    @property
    def jump(self) -> float:
        """What a motor step, or those of one edge, change at once along the normal [mm]."""
        if self.rule == "ideal":
            return 0.0
        return self.step * self.ratio.steps_per_edge * self.job.base_radius * math.cos(self.job.base_helix)

    # --- the table ------------------------------------------------------------------------------------------------
    def table(self, psi: np.ndarray, side: int) -> np.ndarray:
        """Δφ (n,) [rad] at hob turns (n,)."""
        errors, table = self.errors, self.machine.table
        assert table is not None
        turned = self.job.table_angle(psi)
        total = harmonics(errors.wheel, turned, ARCSEC) + harmonics(errors.worm, turned * float(table.worm), ARCSEC)
        if self.rule != "ideal":
            total -= self.step * self.motor_error(psi)
        if errors.backlash_taken_by_cut:
            total += side * table.rad("backlash") / 2
        return total

    def motor_error(self, psi: np.ndarray) -> np.ndarray:
        """How far the motor stands beyond ideal meshing (n,), in steps, positive with a right-hand hob."""
        return self._unsteady_error(psi) + self._ahead(psi)

    def _unsteady_error(self, psi: np.ndarray) -> np.ndarray:
        """That of rounding to steps and counts, and within a step (n,), in steps; of a motor that lags its mean."""
        if self._lag is None:
            return self._given(psi)
        delay = self._lag.delay(psi)
        earlier = psi - delay * TIMES[:, None]
        at_once = max(1, AT_ONCE // max(1, len(psi)))
        parts = (earlier[low : low + at_once] for low in range(0, len(TIMES), at_once))
        found: np.ndarray = sum(self._given(part.ravel()).reshape(part.shape).sum(axis=0) for part in parts)
        return found / len(TIMES)

    def _given(self, psi: np.ndarray) -> np.ndarray:
        found = self.step_error(psi)
        return found + self._within_step(psi, found)

    def _ahead(self, psi: np.ndarray) -> np.ndarray:
        """By how many steps a motor that lags is ahead (n,) of its lag at the speed of the job."""
        return np.zeros_like(psi) if self._lag is None else self._steps_per_rad * self._lag.ahead(psi)

    @cached_property
    def _lag(self) -> Lag | None:
        return Lag(self.errors, self.job, self.rpm) if self.errors.motor_time_constant_ms else None

    @cached_property
    def _steps_per_rad(self) -> float:
        """Motor steps per radian of the hob."""
        turn = self.job.table_angle(np.array([0.0, 1.0]))
        return float(turn[0] - turn[1]) / self.step

    def step_error(self, psi: np.ndarray) -> np.ndarray:
        """Steps that the rule has given less the ideal position (n,), in steps."""
        hob, hob_counts = self._hob_counts(psi)
        feed, feed_counts = self._feed_counts(psi)
        numerators, denominator = self.ratio.numerators, self.ratio.denominator
        between = (numerators[0] * (hob - hob_counts) + numerators[1] * (feed - feed_counts)) / denominator
        if self.rule == "float":
            rule = FloatRule(numerators[0], denominator)
            counts = hob.astype(np.int64)
            return rule.positions(counts) - counts * (numerators[0] / denominator) + between
        return rounding(self.ratio, hob, feed) + between

    def _hob_counts(self, psi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Whole counts of the hob (n,), and where it really is in counts; both with the counts before the cut."""
        belt, per_turn = float(self.machine.encoder.belt), float(self.machine.encoder_counts)
        before = math.floor(self.rpm / 60 * self.seconds) * per_turn
        real = psi / TURN * per_turn + before
        seen = harmonics(self.errors.encoder, psi * belt, ARCSEC) / belt / TURN * per_turn
        return np.floor(real + seen), real

    def _feed_counts(self, psi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The same of the feed, whose encoder sees the travel as it is."""
        machine, job = self.machine, self.job
        if machine.feed is None:
            return np.zeros_like(psi), np.zeros_like(psi)
        up = -1.0 if machine.feed_climbs else 1.0  # climbing, the hob goes down
        per_mm = up * float(machine.feed_counts)
        ideal = job.travel_per_rad * psi
        return np.floor(per_mm * (ideal + self.feed_error(psi))), per_mm * ideal

    def _within_step(self, psi: np.ndarray, step_error: np.ndarray) -> np.ndarray:
        """Error of the microsteps (n,), in steps: a sine of the place within a full step."""
        microsteps = self.machine.drive.microsteps or 1
        percent = self.errors.microstep_percent
        if not percent:
            return np.zeros_like(psi)
        steps = -self.job.table_angle(psi) / self.step + step_error
        turned = TURN * (steps / microsteps)
        return kernel("harmonic")(turned, percent / 100 * microsteps, 1, 0.0)[0]

    # --- hob, feed and blank --------------------------------------------------------------------------------------
    def feed_error(self, psi: np.ndarray) -> np.ndarray:
        """How much the hob stands too high (n,) [mm]."""
        travel = self.job.travel_per_rad * psi
        return harmonics(self.errors.feed, TURN * travel / self.errors.feed_screw_pitch, UM)

    def displacement(self, psi: np.ndarray, thread: np.ndarray, place: np.ndarray) -> np.ndarray:
        """D (n, 3) [mm] at hob turns, thread angles (n,) and places (n, 3)."""
        if not self._is_displaced:
            return np.zeros((len(psi), 3))
        errors, job = self.errors, self.job
        phase = psi + errors.rad("hob_eccentricity_phase")
        size = errors.hob_eccentricity_um * UM
        wobble = kernel("harmonic")(psi, errors.hob_axial_runout_um * UM, 1, errors.rad("hob_axial_runout_phase"))[0]
        longer = job.hob.sign * errors.hob_lead_um_per_turn * UM * thread / TURN
        along = wobble + longer + self._start_error(psi, thread)
        hob_shift = np.column_stack([size * np.cos(phase), size * np.sin(phase), along])
        table = job.table_angle(psi)
        eccentric = table + errors.rad("blank_eccentricity_phase")
        tilted = table + errors.rad("blank_tilt_phase")
        tilt = errors.blank_tilt_um_per_100mm * UM / 100
        off = errors.blank_eccentricity_um * UM
        return kernel("hob_displacement")(
            hob_shift,
            self.feed_error(psi),
            np.column_stack([off * np.cos(eccentric), off * np.sin(eccentric)]),
            np.column_stack([-tilt * np.sin(tilted), tilt * np.cos(tilted)]),
            place,
            job.hob.sign,
            job.helix_sign,
            job.hob.starts,
            job.gear.module,
            job.gear.beta,
            job.hob.diameter,
        )[0]

    def _start_error(self, psi: np.ndarray, thread: np.ndarray) -> np.ndarray:
        """Displacement along the hob (n,) [mm] of the thread that cuts: thread R of chapter 30 is start R mod k."""
        given, starts = self.errors.hob_starts_um, self.job.hob.starts
        if not given:
            return np.zeros_like(psi)
        off = np.resize(np.array(given) * UM, starts)
        return off[np.rint(starts * (thread + psi) / TURN).astype(np.int64) % starts]

    @cached_property
    def _is_displaced(self) -> bool:
        errors = self.errors
        return bool(
            errors.feed
            or errors.hob_eccentricity_um
            or errors.hob_axial_runout_um
            or errors.hob_lead_um_per_turn
            or errors.hob_starts_um
            or errors.blank_eccentricity_um
            or errors.blank_tilt_um_per_100mm
        )

    # --- how much all that changes --------------------------------------------------------------------------------
    def variation(self, psi: np.ndarray, thread: np.ndarray) -> np.ndarray:
        """Bounds of how much the errors differ along the normal [mm] over hob turns and turns of the thread.

        Without those that :meth:`sudden` bounds, and :meth:`lag_range`.
        """
        total = abs(self.errors.hob_lead_um_per_turn) * UM / TURN * np.abs(thread)
        for size, rate in self._swings():
            turned = np.abs((rate * psi + math.pi) % TURN - math.pi)  # whole turns bring a sine back
            total += size * np.minimum(2.0, turned)
        return total

    def lag_range(self, psi: np.ndarray, side: int, unsure: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Least and most that uneven speed leaves along the normal [mm] at hob turns known but for ``unsure`` [rad].

        None where the speed is even, or the motor does not lag.
        """
        if self.rule == "ideal" or self._lag is None or self._lag.is_even:
            return None
        along = -side * self._steps_per_rad * self._normal_step
        ends = [along * each for each in self._lag.ahead_range(psi, unsure)]
        return (ends[0], ends[1]) if along > 0 else (ends[1], ends[0])

    @property
    def unsteady(self) -> float:
        """How much rounding to steps and counts, microsteps and starts differ at most along the normal [mm]."""
        return self._start_range + self._normal_step * float(np.ptp(self._step_range))

    def sudden(self, psi: np.ndarray, side: int) -> tuple[np.ndarray, np.ndarray]:
        """What they leave along the normal (n,) [mm] at hob turns, and the least (n,) that they leave near there.

        Without starts, whose error is a displacement; the floating rule drifts, so that its least is from where it is.
        """
        if self.rule == "ideal":
            return np.zeros_like(psi), np.full_like(psi, -self._start_range)
        now = self._unsteady_error(psi)
        ends = np.array(self._step_range) if self.rule == "exact" else now + np.array(self._step_range)[:, None]
        least = (-side * ends).min(axis=0)
        return -side * now * self._normal_step, least * self._normal_step - self._start_range

    @property
    def _start_range(self) -> float:
        """How much the starts of the hob differ [mm]."""
        return float(np.ptp(self.errors.hob_starts_um)) * UM if self.errors.hob_starts_um else 0.0

    @property
    def _normal_step(self) -> float:
        """A motor step along the normal [mm]; a hundredth more, as where it cuts moves with it."""
        return 1.01 * self.step * self.job.base_radius * math.cos(self.job.base_helix)

    @property
    def _step_range(self) -> tuple[float, float]:
        """Least and largest error of the motor in steps; of the floating rule least and largest change of it."""
        errors = self.errors
        if self.rule == "ideal":
            return 0.0, 0.0
        per_turn = abs(self._steps_per_rad) * TURN
        more = errors.microstep_percent / 100 * (self.machine.drive.microsteps or 1)
        if self.rule == "float":
            most = 12.0 + per_turn / float(self.machine.encoder_counts) + 2 * more
            return -most, most
        ratio = self.ratio
        belt = float(self.machine.encoder.belt)
        seen = sum(each.amplitude_arcsec for each in errors.encoder) * ARCSEC / belt / TURN
        more += seen * per_turn
        # whole counts lag behind where hob and feed really are, by less than one
        lags = [-numerator / ratio.denominator for numerator in ratio.numerators]
        low = (ratio.first_remainder - ratio.denominator + 1) / ratio.denominator + sum(min(0.0, lag) for lag in lags)
        high = ratio.first_remainder / ratio.denominator + sum(max(0.0, lag) for lag in lags)
        return low - more, high + more

    def _swings(self) -> list[tuple[float, float]]:
        """Amplitude along the normal [mm] of every sine, and by how much its argument turns per turn of the hob."""
        errors, job, wheel = self.errors, self.job, self.machine.table
        assert wheel is not None
        radius = job.base_radius
        table, travel = float(np.diff(job.table_angle(np.array([0.0, 1.0])))[0]), job.travel_per_rad
        belt, feed = float(self.machine.encoder.belt), TURN * travel / errors.feed_screw_pitch
        by_table, by_encoder = ARCSEC * radius, ARCSEC / belt * job.hob.starts / job.gear.teeth * radius
        found = [(each.amplitude_arcsec * by_table, each.order * table * float(wheel.worm)) for each in errors.worm]
        found += [(each.amplitude_arcsec * by_table, each.order * table) for each in errors.wheel]
        if self.rule != "ideal":
            found += [(each.amplitude_arcsec * by_encoder, each.order * belt) for each in errors.encoder]
        found += [(wave.amplitude_um * UM * math.sin(job.base_helix), wave.order * feed) for wave in errors.feed]
        # what it does along the tooth does not matter; a tenth more, as a shift across the axis is not quite that
        found.append((1.1 * math.sin(job.gear.alpha) * errors.hob_eccentricity_um * UM, 1.0))
        found.append((errors.hob_axial_runout_um * UM, 1.0))
        found.append((errors.blank_eccentricity_um * UM, table))
        found.append((errors.blank_tilt_um_per_100mm * UM * (job.face_width + radius) / 100, table))
        return [(size, rate) for size, rate in found if size]


def rounding(ratio: JobRatio, hob: np.ndarray, feed: np.ndarray) -> np.ndarray:
    """p - Σ N_j e_j/D of (7.4) after whole counts (n,) of hob and feed, in steps: never more than half a step."""
    numerators: Sequence[int] = ratio.numerators
    largest = max((int(np.abs(counts).max(initial=0)) for counts in (hob, feed)), default=0) + 1
    kind: type = np.int64 if 2 * largest * max(map(abs, numerators)) + ratio.denominator < 2**62 else object
    sums: np.ndarray = np.full(len(hob), ratio.first_remainder, dtype=kind)
    for numerator, counts in zip(numerators, (hob, feed), strict=True):
        if numerator:
            sums = sums + numerator * counts.astype(np.int64).astype(kind)
    left = (sums % ratio.denominator).astype(float)
    return (ratio.first_remainder - left) / ratio.denominator

"""Where an ideal hob would touch points of a flank, and which passes come near that."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmath.gearbox.hobbed.job import TURN, HobbingJob
from gearmath.gearbox.hobbed.passes import ridge_form


@dataclass(frozen=True)
class Touching:
    """Points (n,) of the flank ``side`` of spaces, by length of roll and height on the gear, and how a hob touches.

    ``contact`` (n, 2) is h and τ; ``psi`` the turn of the hob, ``thread`` that of its thread, ``middle`` of its middle
    with the gash that cuts there; ``form`` and ``slope`` (n, 2, 2) are those of :func:`ridge_form`; ``nearest`` is the
    turn of the table next to it.
    """

    side: int
    space: np.ndarray
    length: np.ndarray
    height: np.ndarray
    contact: np.ndarray
    psi: np.ndarray
    thread: np.ndarray
    middle: np.ndarray
    form: np.ndarray
    slope: np.ndarray
    nearest: np.ndarray

    @classmethod
    def of(cls, job: HobbingJob, side: int, space: np.ndarray, length: np.ndarray, height: np.ndarray) -> Touching:
        """How the hob of a job touches."""
        on_gear, edge, tau, thread = job.contact(side, length)
        # of the gash that cuts there, in the middle of the hob
        middle = job.gash_at(side, edge, thread)
        form, slope = ridge_form()(
            np.column_stack([edge, tau, middle]),
            np.array([job.travel_per_rad, job.gash_twist]),
            np.array(job.pair(side), float),
        )
        psi = (height - on_gear - job.start_height) / job.travel_per_rad
        nearest = np.rint(((psi - tau + thread) / TURN * job.hob.starts - job.hob.sign * space) / job.gear.teeth)
        contact = np.column_stack([edge, tau])
        return cls(side, space, length, height, contact, psi, thread, middle, form, slope, nearest)

    def part(self, which: np.ndarray) -> Touching:
        """Some of the points."""
        rows = (getattr(self, name)[which] for name in self.__dataclass_fields__ if name != "side")
        return Touching(self.side, *rows)

    def ridges(self, job: HobbingJob, turns: int) -> np.ndarray:
        """R of (30.2), (n, 2 turns + 1), of so many turns of the table to either side."""
        nearby = self.nearest[:, None] + np.arange(-turns, turns + 1)
        return (job.hob.sign * self.space[:, None] + job.gear.teeth * nearby).astype(np.int64)

    def gashes(self, job: HobbingJob, ridges: np.ndarray) -> np.ndarray:
        """The gash of each ridge (n, m) that leaves the least there."""
        thread, tau, travel = self.thread[:, None], self.contact[:, 1, None], job.travel_per_rad
        nominal = TURN / job.hob.starts * ridges - thread  # turn of a hob that would touch at this length
        too_high = travel * (nominal + tau - self.psi[:, None])
        best = nominal + (thread - self.middle[:, None] - job.gash_phase) + self._least_along(travel) * too_high
        return np.rint(job.hob.gashes / TURN * best)

    def _least_along(self, travel: float) -> np.ndarray:
        """By how much the hob turns (n, 1), per mm that it is too high, until it leaves the least.

        H x along (-1, v).
        """
        by_thread, both, by_height = (self.form[:, i, j, None] for i, j in ((0, 0), (0, 1), (1, 1)))
        return (both - travel * by_height) / (by_thread - 2 * travel * both + travel**2 * by_height)

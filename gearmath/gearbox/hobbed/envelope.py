"""The flank that is left: at each of its points the least of what single gashes leave, (30.5).

Which gash, which turn of the table: the line of action says when an ideal hob touches there, and the second derivatives
of δ say which gash leaves the least at the turns of the table next to that: on a helical gear one that touches at
another height of the profile. A gash further off could only cut if the errors were larger than they are. Those within
are tried nearest first: as soon as the least that the errors could leave of all others, on top of their ridges, is more
than what is left already, a point is done. So coarse steps, under which many gashes compete, cost little more.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gearmath.gearbox.hobbed.job import TURN, HobbingJob
from gearmath.gearbox.hobbed.passes import CuttingErrorModel, Passes
from gearmath.gearbox.hobbed.touching import Touching
from gearmath.gearbox.hobbed.window import UNSURE, windows

#: Passes of one block.
BLOCK = 200_000
#: Passes of a point that are tried first; every further time as many as all before.
FIRST = 8
#: Part of its ridge that a pass leaves at least, as the second derivatives say it.
CERTAIN_PART = 0.7


@dataclass(frozen=True)
class NoErrors:
    """An ideal machine."""

    jump: float = 0.0
    unsteady: float = 0.0

    def sudden(self, psi: np.ndarray, side: int) -> tuple[np.ndarray, np.ndarray]:
        """Nothing."""
        return np.zeros(len(psi)), np.zeros(len(psi))

    def variation(self, psi: np.ndarray, thread: np.ndarray) -> np.ndarray:
        """Nothing."""
        return np.zeros_like(psi)

    def lag_range(self, psi: np.ndarray, side: int, unsure: float) -> None:
        """Nothing."""

    def table(self, psi: np.ndarray, side: int) -> np.ndarray:
        """Nothing."""
        return np.zeros(len(psi))

    def displacement(self, psi: np.ndarray, thread: np.ndarray, place: np.ndarray) -> np.ndarray:
        """Nothing."""
        return np.zeros((len(psi), 3))


@dataclass(frozen=True)
class Envelope:
    """A gear as a job with these errors leaves it."""

    job: HobbingJob
    errors: CuttingErrorModel = NoErrors()

    def deviation(
        self,
        side: int,
        space: np.ndarray,
        length: np.ndarray,
        height: np.ndarray,
        progress: Callable[[int], object] = lambda done: None,
    ) -> np.ndarray:
        """δ (n,) [mm] of the flank ``side`` of ``space`` (n,), at lengths of roll and heights (n,) on the gear.

        nan where no straight edge cuts: below the form circle. ``progress`` is told how many points are done.
        """
        spaces, lengths, heights = np.broadcast_arrays(space, np.asarray(length, float), np.asarray(height, float))
        at = Touching.of(self.job, side, spaces, lengths, heights)
        near = windows(self.job, self.errors, at)
        found = np.empty(len(lengths))
        for gashes, turns in np.unique(near, axis=0):
            (alike,) = np.nonzero((near == (gashes, turns)).all(axis=1))
            size = max(1, BLOCK // ((2 * gashes + 1) * (2 * turns + 1)))
            for start in range(0, len(alike), size):
                part = alike[start : start + size]
                found[part] = self._least(at.part(part), int(gashes), int(turns))
                progress(len(part))
        return found

    def _least(self, at: Touching, gashes: int, turns: int) -> np.ndarray:
        job, hob = self.job, self.job.hob
        ridge = at.ridges(job, turns)
        gash = (at.gashes(job, ridge)[:, :, None] + np.arange(-gashes, gashes + 1)).astype(np.int64)
        thread = (ridge[:, :, None] * hob.gashes - gash * hob.starts) * (
            TURN / (hob.gashes * hob.starts)
        ) - job.gash_phase
        turn = gash * (TURN / hob.gashes) + job.gash_phase
        too_early = (at.contact[:, 1] + at.middle - at.thread - at.psi)[:, None, None]
        moved = np.stack([thread - at.middle[:, None, None], job.travel_per_rad * (turn + too_early)], axis=-1)
        candidates = _Candidates(
            at, *(each.reshape(len(at.psi), -1, *each.shape[3:]) for each in (turn, thread, moved))
        )
        return candidates.least(job, self.errors)


@dataclass(frozen=True)
class _Candidates:
    """Passes (n, m) that may leave the least at points (n,), and what an ideal hob does there.

    ``turn`` and ``thread`` of the passes, and by how much they are off (n, m, 2): turned, and too high.
    """

    at: Touching
    turn: np.ndarray
    thread: np.ndarray
    moved: np.ndarray

    def least(self, job: HobbingJob, errors: CuttingErrorModel) -> np.ndarray:
        """δ (n,) [mm]: of all passes, of which only those are followed that can be it."""
        ridge = self._ridge()
        open_, count = np.arange(len(ridge)), ridge.shape[1]
        done = min(FIRST, count)
        tried = np.argpartition(ridge, done - 1, axis=1)[:, :done]
        found, turned = self._solve(job, errors, open_, tried, np.full(len(ridge), np.inf))
        best = found.argmin(axis=1)
        known = found[open_, best]
        if done == count:
            return known
        lowest = self._lowest(errors, ridge, tried[open_, best], known, turned[open_, best])
        np.put_along_axis(lowest, tried, np.inf, axis=1)
        while done < count and len(open_ := open_[(lowest[open_].min(axis=1) <= known[open_])]):
            size = min(done, count - done)
            tried = np.argpartition(lowest[open_], size - 1, axis=1)[:, :size]
            found, _ = self._solve(job, errors, open_, tried, known[open_])
            known[open_] = np.minimum(known[open_], found.min(axis=1))
            lowest[open_[:, None], tried] = np.inf
            done += size
        return known

    def _ridge(self) -> np.ndarray:
        """What an ideal hob leaves (n, m) [mm], by the second derivatives."""
        turned, high = self.moved[..., 0], self.moved[..., 1]
        of_thread, both, of_height = (self.at.form[:, i, j, None] for i, j in ((0, 0), (0, 1), (1, 1)))
        ridge: np.ndarray = (0.5 * of_thread * turned + both * high) * turned + 0.5 * of_height * high**2
        return ridge

    def _lowest(
        self, errors: CuttingErrorModel, ridge: np.ndarray, best: np.ndarray, known: np.ndarray, turned: np.ndarray
    ) -> np.ndarray:
        """The least δ (n, m) [mm] that passes can leave, by what the pass ``best`` (n,) leaves at hob turns ``turned``.

        What it leaves more than its ridge and the steps, errors that change evenly leave elsewhere but for their bound.
        """
        own = np.arange(len(best)), best
        now, least = errors.sudden(turned, self.at.side)
        steady = known - now - ridge[own] / CERTAIN_PART + least
        tau = self.at.contact[:, 1, None] + (self.moved @ self.at.slope[:, 1, :, None])[..., 0]
        psi, thread = self.turn + tau - turned[:, None], self.thread - self.thread[own][:, None]
        lowest = steady[:, None] + CERTAIN_PART * ridge - errors.variation(psi, thread)
        there = errors.lag_range(self.turn + tau, self.at.side, UNSURE)
        here = errors.lag_range(turned, self.at.side, 0.0)
        if here is not None and there is not None:
            less = there[0] - here[0][:, None]
            lowest += np.where(less > 0, CERTAIN_PART, 1.0) * less
        lowest[~np.isfinite(known)] = -np.inf
        return lowest

    def _solve(
        self, job: HobbingJob, errors: CuttingErrorModel, points: np.ndarray, tried: np.ndarray, known: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """δ and ψ (k, j) of passes ``tried`` (k, j) of some points (k,)."""
        own = points[:, None]
        begin = self.at.contact[own] + np.einsum("nij,nmj->nmi", self.at.slope[points], self.moved[own, tried])
        length, height = (np.broadcast_to(value[own], tried.shape) for value in (self.at.length, self.at.height))
        given = (self.turn[own, tried], self.thread[own, tried], length, height, begin[..., 0], begin[..., 1])
        passes = Passes(self.at.side, *(each.ravel() for each in given))
        delta, turned = passes.solve(job, errors, known)
        return delta.reshape(tried.shape), turned.reshape(tried.shape)

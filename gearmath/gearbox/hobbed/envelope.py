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
from gearmath.gearbox.hobbed.passes import CuttingErrorModel, Passes, ridge_form
from gearmath.gearbox.kernels import evaluate

#: Passes of one block.
BLOCK = 200_000
#: Most passes to either side that are tried.
MOST = 60
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
        gashes, turns = self._window(float(lengths.max(initial=0.0)))
        size = max(1, BLOCK // ((2 * gashes + 1) * (2 * turns + 1)))
        parts = []
        for start in range(0, len(spaces), size):
            part = slice(start, start + size)
            parts.append(self._least(side, spaces[part], lengths[part], heights[part], gashes, turns))
            progress(len(parts[-1]))
        return np.concatenate(parts) if parts else np.empty(0)

    def _window(self, longest: float) -> tuple[int, int]:
        """How many gashes and turns of the table to either side can leave less than their neighbors.

        A pass that is so many gashes or turns off leaves the ridge more, which grows with the square of that; it can be
        the least only if the errors change by as much until there, or, of another turn, if its gashes come half way
        between those of the nearest turn.
        """
        job, gear = self.job, self.job.gear
        (flat,) = evaluate("generating_flat", 0.5 * longest, job.hob.starts, gear.teeth, job.hob.gashes)
        mark = job.feed_mark(0.5 * longest)
        away = np.arange(MOST + 1.0)
        by_gash, by_turn = TURN / job.hob.gashes * away, TURN * gear.teeth / job.hob.starts * away
        changes = self.errors.variation(by_gash, by_gash), self.errors.variation(by_turn, np.zeros_like(away))
        gains = [
            change - 4 * ridge * np.maximum(away - 0.5, 0.0) ** 2
            for change, ridge in zip(changes, (flat, mark), strict=True)
        ]
        gains[1] += flat
        gashes, turns = (
            1 + int(np.flatnonzero(own + other + self.errors.unsteady >= 0).max(initial=0))
            for own, other in ((gains[0], gains[1].max() - flat), (gains[1], gains[0].max()))
        )
        return min(gashes, MOST), min(turns, MOST)

    def _least(
        self, side: int, space: np.ndarray, length: np.ndarray, height: np.ndarray, gashes: int, turns: int
    ) -> np.ndarray:
        job = self.job
        on_gear, edge, tau, thread = job.contact(side, length)
        hob, teeth, travel = job.hob, job.gear.teeth, job.travel_per_rad
        # of the gash that cuts there, in the middle of the hob
        middle = job.gash_at(side, edge, thread)
        form, slope = ridge_form()(
            np.column_stack([edge, tau, middle]), np.array([travel, job.gash_twist]), np.array(job.pair(side), float)
        )
        # the turn of the hob, and of the table, at which an ideal hob touches there
        psi = (height - on_gear - job.start_height) / travel
        first = hob.sign * space
        turned = np.rint(((psi - tau + thread) / TURN * hob.starts - first) / teeth)
        nearby = turned[:, None] + np.arange(-turns, turns + 1)
        ridge = (first[:, None] + teeth * nearby).astype(np.int64)  # R of (30.2)
        nominal = TURN / hob.starts * ridge - thread[:, None]  # turn of a hob that would touch at this length
        too_high = travel * (nominal + tau[:, None] - psi[:, None])
        best = nominal + (thread - middle - job.gash_phase)[:, None] + _least_along(form, travel)[:, None] * too_high
        gash = np.rint(hob.gashes / TURN * best)
        gash = (gash[:, :, None] + np.arange(-gashes, gashes + 1)).astype(np.int64)
        at = (ridge[:, :, None] * hob.gashes - gash * hob.starts) * (TURN / (hob.gashes * hob.starts)) - job.gash_phase
        turn = gash * (TURN / hob.gashes) + job.gash_phase
        moved = np.stack(
            [at - middle[:, None, None], travel * (turn + (tau + middle - thread - psi)[:, None, None])], axis=-1
        )
        candidates = _Candidates(
            side,
            length,
            height,
            np.column_stack([edge, tau]),
            form,
            slope,
            *(each.reshape(len(space), -1, *each.shape[3:]) for each in (turn, at, moved)),
        )
        return candidates.least(job, self.errors)


def _least_along(form: np.ndarray, travel: float) -> np.ndarray:
    """By how much the hob turns (n,), per mm that it is too high, until it leaves the least: H x along (-1, v)."""
    by_thread, both, by_height = form[:, 0, 0], form[:, 0, 1], form[:, 1, 1]
    return (both - travel * by_height) / (by_thread - 2 * travel * both + travel**2 * by_height)


@dataclass(frozen=True)
class _Candidates:
    """Passes (n, m) that may leave the least at points (n,), and what an ideal hob does there.

    ``contact`` (n, 2): h and τ where it touches; ``form`` and ``slope`` (n, 2, 2) of :func:`ridge_form`. ``turn`` and
    ``thread`` of the passes, and by how much they are off (n, m, 2): turned, and too high.
    """

    side: int
    length: np.ndarray
    height: np.ndarray
    contact: np.ndarray
    form: np.ndarray
    slope: np.ndarray
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
        of_thread, both, of_height = (self.form[:, i, j, None] for i, j in ((0, 0), (0, 1), (1, 1)))
        ridge: np.ndarray = (0.5 * of_thread * turned + both * high) * turned + 0.5 * of_height * high**2
        return ridge

    def _lowest(
        self, errors: CuttingErrorModel, ridge: np.ndarray, best: np.ndarray, known: np.ndarray, turned: np.ndarray
    ) -> np.ndarray:
        """The least δ (n, m) [mm] that passes can leave, by what the pass ``best`` (n,) leaves at hob turns ``turned``.

        What it leaves more than its ridge and the steps, errors that change evenly leave elsewhere but for their bound.
        """
        own = np.arange(len(best)), best
        now, least = errors.sudden(turned, self.side)
        steady = known - now - ridge[own] / CERTAIN_PART + least
        tau = self.contact[:, 1, None] + (self.moved @ self.slope[:, 1, :, None])[..., 0]
        psi, thread = self.turn + tau - turned[:, None], self.thread - self.thread[own][:, None]
        lowest = steady[:, None] + CERTAIN_PART * ridge - errors.variation(psi, thread)
        lowest[~np.isfinite(known)] = -np.inf
        return lowest

    def _solve(
        self, job: HobbingJob, errors: CuttingErrorModel, points: np.ndarray, tried: np.ndarray, known: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """δ and ψ (k, j) of passes ``tried`` (k, j) of some points (k,)."""
        own = points[:, None]
        begin = self.contact[own] + np.einsum("nij,nmj->nmi", self.slope[points], self.moved[own, tried])
        length, height = (np.broadcast_to(value[own], tried.shape) for value in (self.length, self.height))
        given = (self.turn[own, tried], self.thread[own, tried], length, height, begin[..., 0], begin[..., 1])
        passes = Passes(self.side, *(each.ravel() for each in given))
        delta, turned = passes.solve(job, errors, known)
        return delta.reshape(tried.shape), turned.reshape(tried.shape)

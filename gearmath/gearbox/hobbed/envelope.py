"""The flank that is left: at each of its points the least of what single gashes leave, (30.5).

Which gash, which turn of the table: the line of action says when an ideal hob touches there, and the second derivatives
of δ say which gash leaves the least at the turns of the table next to that: on a helical gear one that touches at
another height of the profile. So many gashes and turns are tried that a further one could only cut if the errors were
larger than they are. Where the edge of such a pass crosses the foot of the point is a root of (30.6) in h and τ, found
by Newton's method for all points and passes in one call.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Protocol

import casadi as ca
import numpy as np

from gearmath.engine.points import Points
from gearmath.gearbox.hobbed.job import TURN, HobbingJob
from gearmath.gearbox.kernels import evaluate, kernel

#: Newton steps, and the distance [mm] from the foot at which a root counts as found.
STEPS, FOUND = 10, 1e-9
#: Steps at which the errors of the machine are asked for: where a pass is, is known well enough by then.
ASKED = (1, 3)
#: How much of the distance from the foot can be missing from δ at most, and a distance that counts as none [mm].
STEEPEST, CERTAIN = 0.5, 1e-6
#: Distance from the foot [mm] from which that bound is trusted.
NEAR = 0.1
#: Passes of one block.
BLOCK = 200_000
#: Most passes to either side that are tried.
MOST = 60


class CuttingErrorModel(Protocol):
    """What the machine does other than ideally, at hob turns ψ."""

    def variation(self, away: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Bounds (n,) of how much the errors differ along the normal [mm], ``away`` gashes, and turns of the table."""
        ...

    @property
    def jump(self) -> float:
        """How much that changes at once, along the normal [mm]: a motor step."""
        ...

    def table(self, psi: np.ndarray, side: int) -> np.ndarray:
        """Δφ (n,) [rad] while the flank ``side`` is cut."""
        ...

    def displacement(self, psi: np.ndarray, thread: np.ndarray, place: np.ndarray) -> np.ndarray:
        """D (n, 3) [mm] at thread angles (n,) and places of the cut (n, 3)."""
        ...


@dataclass(frozen=True)
class NoErrors:
    """An ideal machine."""

    jump: float = 0.0

    def variation(self, away: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Nothing."""
        return np.zeros_like(away), np.zeros_like(away)

    def table(self, psi: np.ndarray, side: int) -> np.ndarray:
        """Nothing."""
        return np.zeros(len(psi))

    def displacement(self, psi: np.ndarray, thread: np.ndarray, place: np.ndarray) -> np.ndarray:
        """Nothing."""
        return np.zeros((len(psi), 3))


@dataclass(frozen=True)
class Cut:
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
        gains = [
            change - 4 * ridge * np.maximum(away - 0.5, 0.0) ** 2
            for change, ridge in zip(self.errors.variation(away), (flat, mark), strict=True)
        ]
        gains[1] += flat
        by_gash, by_turn = (
            1 + int(np.flatnonzero(own + other >= 0).max(initial=0))
            for own, other in ((gains[0], gains[1].max() - flat), (gains[1], gains[0].max()))
        )
        return min(by_gash, MOST), min(by_turn, MOST)

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
        shape = at.shape
        turn = gash * (TURN / hob.gashes) + job.gash_phase
        too_high = turn + (tau + middle - thread - psi)[:, None, None]
        moved = np.stack([at - middle[:, None, None], travel * too_high])
        begin = np.stack([edge, tau])[:, :, None, None] + np.einsum("nij,jnrg->inrg", slope, moved)
        passes = _Passes(
            side,
            turn.ravel(),
            at.ravel(),
            *(np.broadcast_to(value[:, None, None], shape).ravel() for value in (length, height)),
            *(start.ravel() for start in begin),
        )
        return passes.solve(job, self.errors, shape[1] * shape[2]).reshape(len(space), -1).min(axis=1)


def _least_along(form: np.ndarray, travel: float) -> np.ndarray:
    """By how much the hob turns (n,), per mm that it is too high, until it leaves the least: H x along (-1, v)."""
    by_thread, both, by_height = form[:, 0, 0], form[:, 0, 1], form[:, 1, 1]
    return (both - travel * by_height) / (by_thread - 2 * travel * both + travel**2 * by_height)


@dataclass(frozen=True)
class _Passes:
    """Gashes that may cut points of flanks: hob turn and thread of each, foot of its point, start of the search.

    Turn and thread are those of its middle, ϑ_0 of (30.21).
    """

    side: int
    psi: np.ndarray
    thread: np.ndarray
    length: np.ndarray
    height: np.ndarray
    edge: np.ndarray
    tau: np.ndarray

    def solve(self, job: HobbingJob, errors: CuttingErrorModel, together: int) -> np.ndarray:
        """δ (n,) [mm], infinite for passes that do not reach the foot with their straight edge.

        ``together`` passes in a row belong to one point: those that cannot be its least are left where they are seen to
        be too high, with a bound of what a root not found yet may still change.
        """
        pair, shared = np.array(job.pair(self.side)), np.array([job.travel_per_rad, job.gash_twist])
        target = np.column_stack([self.length, self.height - job.hob_height(self.psi)])
        given = np.column_stack([self.thread, np.zeros((len(self.psi), 4))])
        limits = 0.9 * np.array([job.hob.diameter / 2, math.pi])
        unknown = np.column_stack([self.edge, self.tau])
        last = unknown.copy()
        left, off = (np.full(len(self.psi), np.inf) for _ in range(2))
        open_ = np.arange(len(self.psi))
        for k in range(STEPS):
            if k in ASKED:
                given[open_, 1:] = self._errors(job, errors, open_, unknown[open_])
            step, delta, miss = newton_step()(unknown[open_], target[open_], given[open_], shared, pair)
            left[open_], off[open_] = delta[:, 0, 0], np.abs(miss[:, :, 0]).max(axis=1)
            if k > max(ASKED) and not (off[open_] > FOUND).any():
                break
            # nan where the edge is inside the base cylinder: half of the last step is taken back
            fine = np.isfinite(step[:, :, 0]).all(axis=1)[:, None]
            ahead = np.where(fine, unknown[open_] + np.nan_to_num(step[:, :, 0]), 0.5 * (unknown[open_] + last[open_]))
            last[open_] = np.where(fine, unknown[open_], last[open_])
            unknown[open_] = np.clip(ahead, -limits, limits)
            if k in ASKED:
                jump = errors.jump if k < max(ASKED) else 0.0
                straight = unknown[:, 0] <= job.form_height
                open_ = self._in_question(left, off, straight, together, jump)
        off[np.isnan(left)] = np.inf
        reached = (off < FOUND) & (unknown[:, 0] <= job.form_height + FOUND)
        return np.where(reached, left, np.inf)

    @staticmethod
    def _in_question(left: np.ndarray, off: np.ndarray, straight: np.ndarray, together: int, jump: float) -> np.ndarray:
        """Which passes may still be the least of their point; those that are not ``straight`` there decide nothing."""
        doubt = STEEPEST * np.nan_to_num(off, nan=0.0) + jump + CERTAIN
        low = np.nan_to_num(left, nan=np.inf) - doubt
        highest = np.where(straight & (off < NEAR), low + 2 * doubt, np.inf)
        sure = highest.reshape(-1, together).min(axis=1)
        return np.flatnonzero(low <= np.repeat(sure, together))

    def _errors(self, job: HobbingJob, errors: CuttingErrorModel, which: np.ndarray, at: np.ndarray) -> np.ndarray:
        """Δφ and D (n, 4) of some passes whose edge is at h and τ (n, 2)."""
        middle = self.thread[which]
        thread = job.thread_at(self.side, at[:, 0], middle) if job.gash_twist else middle
        psi = self.psi[which] + middle - thread + at[:, 1]
        moved = errors.displacement(psi, thread, self._place(job, which))
        return np.column_stack([errors.table(psi, self.side), moved])

    def _place(self, job: HobbingJob, which: np.ndarray) -> np.ndarray:
        """About where the flank is cut, in space from the middle of the gear's lower face."""
        radius = np.hypot(job.base_radius, self.length[which])
        return np.column_stack([radius, np.zeros_like(radius), self.height[which]])


def _of_gash(
    unknown: ca.SX, middle: ca.SX, shared: ca.SX, table: ca.SX, moved: ca.SX, pair: ca.SX
) -> tuple[ca.SX, ca.SX, ca.SX]:
    """L_0, z_0 and δ (30.6, 30.21) where a gash is at h and τ; ``shared`` is v and κ. z_0 is from the gash's middle."""
    travel, twist = shared[0], shared[1]
    arguments = ca.vertsplit(pair)
    thread = kernel("thread_of_gash").function(unknown[0], 0, middle, twist, *arguments)
    place = (unknown[0], 0, unknown[1], thread, travel, table, moved)
    foot, height, delta = kernel("hobbed_deviation").function(*place, *arguments)
    return foot, height + travel * (middle - thread), delta


@cache
def newton_step() -> Points:
    """One step of Newton's method for h and τ of a pass: arguments unknown, foot wanted, ϑ_0, Δφ and D, (v, κ), PAIR.

    Results: the step, δ, and how far the foot is off.
    """
    unknown, target, given = ca.SX.sym("unknown", 2), ca.SX.sym("target", 2), ca.SX.sym("given", 5)
    shared, pair = ca.SX.sym("shared", 2), ca.SX.sym("pair", 10)
    foot, height, delta = _of_gash(unknown, given[0], shared, given[1], given[2:], pair)
    miss = ca.vertcat(foot, height) - target
    slope = ca.jacobian(miss, unknown)
    step = -ca.solve(slope, miss)
    return Points(
        ca.Function("hobbing_newton", [unknown, target, given, shared, pair], [step, delta, miss]), shared=(3, 4)
    )


@cache
def ridge_form() -> Points:
    """What a pass leaves next to where it touches: arguments h, τ and ϑ_0 of the contact, (v, κ), PAIR.

    Results: H (2, 2), by which it leaves xᵀ H x/2 at a foot that it passes turned by ϑ_0 and too high by Z,
    x = (ϑ_0, Z), and by how much h and τ of the edge that crosses the foot change with x.
    """
    contact, high, shared, pair = (ca.SX.sym(name, size) for name, size in zip("chvp", (3, 1, 2, 10), strict=True))
    foot, height, delta = _of_gash(contact[:2], contact[2], shared, ca.SX(0), ca.SX.zeros(3), pair)
    moves = ca.vertcat(contact, high)
    slope = ca.jacobian(ca.vertcat(foot, height + high), moves)
    follow = -ca.solve(slope[:, :2], slope[:, 2:])
    along = ca.vertcat(follow, ca.SX.eye(2))
    # without derivatives of the foot: δ has none of the first order where it touches
    form = along.T @ ca.hessian(delta, moves)[0] @ along
    return Points(ca.Function("hobbing_ridge", [contact, shared, pair], [form, follow]), shared=(1, 2))

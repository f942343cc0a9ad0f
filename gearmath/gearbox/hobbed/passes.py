"""What single gashes leave at points of a flank, (30.5).

Where the edge of a pass crosses the foot of the point is a root of (30.6) in h and τ, found by Newton's method for all
points and passes in one call.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Protocol

import casadi as ca
import numpy as np

from gearmath.engine.points import Points
from gearmath.gearbox.hobbed.job import HobbingJob
from gearmath.gearbox.kernels import kernel

#: Newton steps, and the distance [mm] from the foot at which a root counts as found.
STEPS, FOUND = 10, 1e-9
#: Steps at which the errors of the machine are asked for: where a pass is, is known well enough by then.
ASKED = (1, 3)
#: How much of the distance from the foot can be missing from δ at most, and a distance that counts as none [mm].
STEEPEST, CERTAIN = 0.5, 1e-6
#: Distance from the foot [mm] from which that bound is trusted.
NEAR = 0.1


class CuttingErrorModel(Protocol):
    """What the machine does other than ideally, at hob turns ψ."""

    def variation(self, psi: np.ndarray, thread: np.ndarray) -> np.ndarray:
        """Bounds of how much the errors differ along the normal [mm] over hob turns and turns of the thread.

        Without those that :meth:`sudden` bounds, and :meth:`lag_range`.
        """
        ...

    def lag_range(self, psi: np.ndarray, side: int, unsure: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Least and most that uneven speed leaves along the normal [mm] at hob turns known but for ``unsure`` [rad].

        None where it leaves nothing anywhere.
        """
        ...

    @property
    def unsteady(self) -> float:
        """How much those differ at most along the normal [mm]: steps, counts, starts of the hob."""
        ...

    def sudden(self, psi: np.ndarray, side: int) -> tuple[np.ndarray, np.ndarray]:
        """What they leave along the normal (n,) [mm] at hob turns, and the least (n,) that they leave near there."""
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
class Passes:
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

    def solve(self, job: HobbingJob, errors: CuttingErrorModel, known: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """δ (n,) [mm], infinite for passes that do not reach the foot with their straight edge; ψ (n,) of its errors.

        The same number of passes in a row belongs to each point, of which ``known`` (m,) [mm] is left already: those
        that cannot leave less are given up where they are seen to be too high, with a bound of what a root not found
        yet may still change.
        """
        pair, shared = np.array(job.pair(self.side)), np.array([job.travel_per_rad, job.gash_twist])
        target = np.column_stack([self.length, self.height - job.hob_height(self.psi)])
        given = np.column_stack([self.thread, np.zeros((len(self.psi), 4))])
        limits = 0.9 * np.array([job.hob.diameter / 2, math.pi])
        unknown = np.column_stack([self.edge, self.tau])
        last, turned = unknown.copy(), self.psi.copy()
        left, off = (np.full(len(self.psi), np.inf) for _ in range(2))
        open_ = np.arange(len(self.psi))
        for k in range(STEPS):
            if k in ASKED:
                given[open_, 1:], turned[open_] = self._errors(job, errors, open_, unknown[open_])
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
                open_ = self._in_question(left, off, straight, known, jump)
        off[np.isnan(left)] = np.inf
        reached = (off < FOUND) & (unknown[:, 0] <= job.form_height + FOUND)
        return np.where(reached, left, np.inf), turned

    @staticmethod
    def _in_question(
        left: np.ndarray, off: np.ndarray, straight: np.ndarray, known: np.ndarray, jump: float
    ) -> np.ndarray:
        """Which passes may still be the least of their point; those that are not ``straight`` there decide nothing."""
        doubt = STEEPEST * np.nan_to_num(off, nan=0.0) + jump + CERTAIN
        low = np.nan_to_num(left, nan=np.inf) - doubt
        highest = np.where(straight & (off < NEAR), low + 2 * doubt, np.inf)
        sure = np.minimum(highest.reshape(len(known), -1).min(axis=1), known)
        return np.flatnonzero(low <= np.repeat(sure, len(left) // len(known)))

    def _errors(
        self, job: HobbingJob, errors: CuttingErrorModel, which: np.ndarray, at: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Δφ and D (n, 4) of some passes whose edge is at h and τ (n, 2), and their hob turns ψ (n,)."""
        middle = self.thread[which]
        thread = job.thread_at(self.side, at[:, 0], middle) if job.gash_twist else middle
        psi = self.psi[which] + middle - thread + at[:, 1]
        moved = errors.displacement(psi, thread, self._place(job, which))
        return np.column_stack([errors.table(psi, self.side), moved]), psi

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

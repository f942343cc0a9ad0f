"""How far from where an ideal hob touches a pass can still leave the least, whatever the errors are."""

from __future__ import annotations

import numpy as np

from gearmath.gearbox.hobbed.job import TURN, HobbingJob
from gearmath.gearbox.hobbed.passes import CuttingErrorModel
from gearmath.gearbox.hobbed.touching import Touching
from gearmath.gearbox.kernels import evaluate

#: Most passes to either side that are tried.
MOST = 60
#: Turn of the hob [rad] by which a pass cuts earlier or later at most than the first derivatives say.
UNSURE = 0.05


def windows(job: HobbingJob, errors: CuttingErrorModel, at: Touching) -> np.ndarray:
    """How many gashes and turns of the table to either side (n, 2) can leave less than their neighbors.

    A pass that is so many gashes or turns off leaves the ridge more, which grows with the square of that; it can be the
    least only if the errors change by as much until there, or, of another turn, if its gashes come half way between
    those of the nearest turn. What uneven speed changes more, it changes only near where it is uneven.
    """
    longest = float(at.length.max(initial=0.0))
    (flat,) = evaluate("generating_flat", 0.5 * longest, job.hob.starts, job.gear.teeth, job.hob.gashes)
    mark = job.feed_mark(0.5 * longest)
    away = np.arange(MOST + 1.0)
    by_gash, by_turn = TURN / job.hob.gashes * away, TURN * job.gear.teeth / job.hob.starts * away
    changes = errors.variation(by_gash, by_gash), errors.variation(by_turn, np.zeros_like(away))
    gashes, turns = (
        change - 4 * ridge * np.maximum(away - 0.5, 0.0) ** 2
        for change, ridge in zip(changes, (flat, mark), strict=True)
    )
    everywhere = _within(gashes[None], turns[None], flat, errors.unsteady)
    less = _less_by_lag(job, errors, at, by_gash, by_turn)
    if less is None:
        return np.broadcast_to(everywhere, (len(at.psi), 2))
    beside = _within(gashes + less[0], turns + less[1], flat, errors.unsteady)
    few_kinds = 2 ** np.ceil(np.log2(beside)).astype(int)
    return np.where(beside > everywhere, np.minimum(few_kinds, MOST), everywhere)


def _within(gashes: np.ndarray, turns: np.ndarray, flat: float, unsteady: float) -> np.ndarray:
    """Windows (n, 2) by how much less passes so many gashes or turns away can leave (n, m) [mm]."""
    pairs = (gashes, turns.max(axis=1)), (turns + flat, gashes.max(axis=1))
    can = [own + other[:, None] + unsteady >= 0 for own, other in pairs]
    farthest = [(np.arange(each.shape[1]) * each).max(axis=1) for each in can]
    return np.minimum(1 + np.column_stack(farthest), MOST)


def _less_by_lag(
    job: HobbingJob, errors: CuttingErrorModel, at: Touching, by_gash: np.ndarray, by_turn: np.ndarray
) -> list[np.ndarray] | None:
    """How much less uneven speed leaves (n, m) [mm] over hob turns to either side; None where it leaves nothing."""
    ridge = at.ridges(job, 0)
    gash = at.gashes(job, ridge)
    nearest = gash * (TURN / job.hob.gashes) + job.gash_phase + at.contact[:, 1, None]
    found = []
    here = errors.lag_range(nearest, at.side, TURN / job.hob.gashes)
    # of another turn of the table, any gash within the window
    for over, unsure in ((by_gash, TURN / job.hob.gashes), (by_turn, by_gash[-1])):
        there = [errors.lag_range(nearest + sign * over, at.side, unsure) for sign in (-1, 1)]
        if here is None or there[0] is None or there[1] is None:
            return None
        found.append(here[1] - np.minimum(there[0][0], there[1][0]))
    found[1][:, 0] = 0.0  # gashes of the nearest turn are seen one by one
    return found

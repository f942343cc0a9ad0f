"""The tip that the root of a topping hob turns: at every point the least that a gash leaves there."""

from __future__ import annotations

import math
from functools import cache

import casadi as ca
import numpy as np

from gearmath.engine.points import Points
from gearmath.gearbox.hobbed.envelope import BLOCK, Envelope
from gearmath.gearbox.hobbed.job import TURN
from gearmath.gearbox.kernels import kernel

#: Points across the facet of a gash, and along a feed, and how often they are drawn together around the highest.
GRID, CLOSER = 7, 3
#: Turns of the table and gashes to either side that are tried.
TURNS, GASHES = 2, 3
#: Newton steps, and those at which the errors of the machine are asked for.
STEPS, ASKED = 6, (0, 2)


def topped_radii(cut: Envelope, height: float) -> np.ndarray:
    """Radius (z,) [mm] of the tip of every tooth about a height on the gear, as a micrometer feels it: the highest.

    Of the points that one gash and one feed leave, in the middle of the tooth between space i and i + 1.
    """
    job = cut.job
    teeth = job.gear.teeth
    spread = np.array([TURN * job.hob.starts / (teeth * job.hob.gashes), job.feed])
    grid = np.stack(np.meshgrid(*(np.linspace(-0.5, 0.5, GRID),) * 2), axis=-1).reshape(-1, 2)
    middle = np.tile([math.pi / teeth, height], (teeth, 1))
    space = np.repeat(np.arange(teeth), len(grid))
    for _ in range(CLOSER):
        points = middle[:, None] + grid * spread
        angle, at = points.reshape(-1, 2).T
        radius = topped_radius(cut, space, angle, at).reshape(teeth, -1)
        middle = points[np.arange(teeth), radius.argmax(axis=1)]
        spread /= GRID - 1
    highest: np.ndarray = radius.max(axis=1)
    return highest


def topped_radius(cut: Envelope, space: np.ndarray, angle: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Radius (n,) [mm] at angles from the middle of spaces and at heights on the gear, of all gashes nearby."""
    size = BLOCK // ((2 * TURNS + 1) * (2 * GASHES + 1))
    blocks = [slice(start, start + size) for start in range(0, len(space), size)]
    return np.concatenate([_least(cut, space[part], angle[part], height[part]) for part in blocks])


def _least(cut: Envelope, space: np.ndarray, angle: np.ndarray, height: np.ndarray) -> np.ndarray:
    """The same of one block."""
    job, hob, teeth = cut.job, cut.job.hob, cut.job.gear.teeth
    # the root stands across the tooth where the gear has turned it to the common perpendicular
    thread = -hob.sign * teeth / hob.starts * angle
    psi = (height - job.start_height) / job.travel_per_rad
    first = hob.sign * space
    nearest = np.rint(((psi + thread) / TURN * hob.starts - first) / teeth)
    ridge = first[:, None] + teeth * (nearest[:, None] + np.arange(-TURNS, TURNS + 1))
    gash = np.rint(hob.gashes / TURN * (TURN / hob.starts * ridge - thread[:, None] - job.gash_phase))
    # a helical tooth turns away by so many gashes while the hob is fed; what they leave grows evenly to both sides of
    # the least, so that it is found in ever smaller strides
    turned = TURNS * job.feed * abs(job.turns_per_mm) * teeth / hob.starts * hob.gashes
    stride = GASHES ** max(0, math.ceil(math.log(max(turned, 1.0) / GASHES, GASHES)))
    while True:
        tried = gash[:, :, None] + stride * np.arange(-GASHES, GASHES + 1)
        turn = tried * (TURN / hob.gashes) + job.gash_phase
        at = TURN / hob.starts * ridge[:, :, None] - turn
        points = (turn, at, angle[:, None, None], height[:, None, None])
        radius = _radius(cut, *(np.broadcast_to(each, at.shape).ravel() for each in points)).reshape(at.shape)
        if stride == 1:
            least: np.ndarray = radius.min(axis=(1, 2))
            return least
        gash = np.take_along_axis(tried, radius.argmin(axis=2)[:, :, None], axis=2)[:, :, 0]
        stride //= GASHES


def _radius(cut: Envelope, turn: np.ndarray, thread: np.ndarray, angle: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Where the root of single gashes, a line along the hob, passes the angle at the height (n,) [mm].

    The line is sought by its place along the hob and the hob's turn; a helical gash is taken as straight in a tooth.
    """
    job = cut.job
    depth = job.hob.dedendum
    assert depth is not None
    shared = np.array([-depth, job.travel_per_rad])
    target = np.column_stack([angle, height - job.hob_height(turn)])
    unknown = np.zeros((len(turn), 2))
    given = np.column_stack([thread, np.zeros((len(turn), 4))])
    place = np.column_stack([np.full_like(turn, job.reference_diameter / 2), np.zeros_like(turn), height])
    radius = np.full(len(turn), np.inf)
    for k in range(STEPS):
        if k in ASKED:
            psi = turn + unknown[:, 1]
            given[:, 1] = cut.errors.table(psi, 1)
            given[:, 2:] = cut.errors.displacement(psi, thread, place)
        step, found, miss = _step()(unknown, target, given, shared, np.array(job.pair(1)))
        radius = np.where(np.abs(miss[:, :, 0]).max(axis=1) < 1e-7, found[:, 0, 0], np.inf)
        unknown = np.clip(unknown + np.nan_to_num(step[:, :, 0]), -job.hob.diameter, job.hob.diameter)
        unknown[:, 1] = np.clip(unknown[:, 1], -0.6, 0.6)
    return radius


@cache
def _step() -> Points:
    """One step of Newton's method for place along the hob and turn τ of a gash's root.

    Arguments: unknown, target, ϑ with Δφ and D, (height of the root, v), PAIR. Results: the step, the radius, and how
    far angle and height are off.
    """
    rule = kernel("hobbed_place")
    unknown, target, given = ca.SX.sym("unknown", 2), ca.SX.sym("target", 2), ca.SX.sym("given", 5)
    shared, pair = ca.SX.sym("shared", 2), ca.SX.sym("pair", 10)
    # where the line stands along the hob is free: (30.2) with a relief that is
    place = (shared[0], unknown[0], unknown[1], given[0], shared[1], given[1], given[2:])
    radius, angle, height = rule.function(*place, *ca.vertsplit(pair))
    miss = ca.vertcat(angle, height) - target
    step = -ca.solve(ca.jacobian(miss, unknown), miss)
    return Points(
        ca.Function("hobbing_topping", [unknown, target, given, shared, pair], [step, radius, miss]), shared=(3, 4)
    )

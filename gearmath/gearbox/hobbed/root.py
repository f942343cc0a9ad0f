"""The root of a space: what straight edge, rounded tip and land of the hob leave below the involute, undercut too.

In the transverse section at one height. At a radius the space is as wide as the farthest of all edges makes it; that is
one number also where a trochoid undercuts the flank. Ideal motion.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearmath.gearbox.hobbed.job import TURN, HobbingJob
from gearmath.gearbox.kernels import evaluate, kernel

#: Points of an edge: straight part, flank of a protuberance, rounding, half of the land.
STRAIGHT, PROTRUDING, ROUND, LAND = 60, 12, 60, 12
#: Threads of the hob to either side that can cut a space, as turns of a single start.
REACH = 3.0
#: The root is that of a hob of at least so many gashes: a few flats in a fillet are no undercut.
LEAST_GASHES = 72
#: Newton steps for the turn at which an edge passes the section.
_STEPS = 6
#: The involute begins where the space is wider than it by no more than this [mm].
UNDERCUT = 1e-3


@dataclass(frozen=True)
class Root:
    """A space below its flanks: radius of its bottom, and half its angle (n,) [rad] at radii (n,) [mm]."""

    bottom: float
    radius: np.ndarray
    half_angle: np.ndarray


def root(job: HobbingJob, radii: np.ndarray, side: int = 1) -> Root:
    """The space at these radii, from its middle to the flank ``side``: nan where no edge cuts."""
    height, relief = _edge(job)
    thread = _threads(job)
    shape = (len(thread), len(height))
    h, w = (np.broadcast_to(values, shape).ravel() for values in (height, relief))
    at = np.repeat(thread, shape[1])
    rho, theta = _section(job, side, h, w, at)
    rho, theta = rho.reshape(shape), side * theta.reshape(shape)
    return Root(float(np.nanmin(rho)), radii, _widest(rho, theta, radii))


def _threads(job: HobbingJob) -> np.ndarray:
    """Thread angles of all gashes within reach, one in the middle of the space; of so many that they do not matter."""
    gashes = max(job.hob.gashes, LEAST_GASHES)
    count = round(REACH * gashes / job.hob.starts)
    return np.arange(-count, count + 1) * TURN / gashes


def undercut_radius(job: HobbingJob, tip: float) -> float | None:
    """Radius [mm] up to which the involute is cut away, between base circle and ``tip``; None where it is not."""
    base = job.base_radius
    radii = np.linspace(base * (1 + 1e-6), tip, 200)
    found = root(job, radii)
    beyond = (found.half_angle - _involute(job, radii)) * radii
    with np.errstate(invalid="ignore"):
        (cut,) = np.nonzero(beyond > UNDERCUT)
    return float(radii[min(cut[-1] + 1, len(radii) - 1)]) if len(cut) else None


def _involute(job: HobbingJob, radii: np.ndarray) -> np.ndarray:
    """Half the angle of an ideal space at radii (n,)."""
    gear = job.gear
    length = np.sqrt(np.maximum(radii**2 - job.base_radius**2, 0.0))
    shape = (gear.teeth, gear.module, gear.alpha, gear.beta, gear.shift)
    point, _ = kernel("involute_flank")(length, 0.0, 0, 1, job.helix_sign, *shape)
    return np.arctan2(point[:, 1], point[:, 0])


def _edge(job: HobbingJob) -> tuple[np.ndarray, np.ndarray]:
    """Height above the hob's reference cylinder, and relief against its flank, of points from the root to the land."""
    hob, gear = job.hob, job.gear
    _, land = evaluate("hob_form", gear.module, hob.addendum, hob.tip_radius, hob.protuberance, gear.alpha)
    straight = np.linspace(-1.5 * gear.module, job.form_height, STRAIGHT)
    # without a protuberance the rounding begins on the flank, else at the end of a flank of its own
    begin = hob.protuberance_angle if hob.protuberance else gear.alpha
    turn = np.linspace(begin, math.pi / 2, ROUND)
    rounded = kernel("hob_tip")(turn, hob.addendum, hob.tip_radius, hob.protuberance, gear.alpha, job.lead_angle)
    part = np.linspace(0.0, 1.0, PROTRUDING if hob.protuberance else 2)[1:-1]
    flat = rounded[1][-1] + np.linspace(0.0, max(land, 0.0) / math.cos(job.lead_angle), LAND)[1:]
    height = [
        straight,
        straight[-1] + part * (rounded[0][0] - straight[-1]),
        rounded[0],
        np.full(LAND - 1, hob.addendum),
    ]
    return np.concatenate(height), np.concatenate([np.zeros(STRAIGHT), part * rounded[1][0], rounded[1], flat])


def _section(
    job: HobbingJob, side: int, height: np.ndarray, relief: np.ndarray, thread: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Radius and angle (n,) of edges where they pass the height of the hob's middle."""
    place, none = kernel("hobbed_place"), np.zeros((len(height), 3))
    turn = np.zeros(len(height))
    slope = (job.hob.diameter / 2 + height) * math.cos(job.swivel)
    for _ in range(_STEPS):
        radius, angle, up = place(height, relief, turn, thread, 0.0, 0.0, none, *job.pair(side))
        turn = np.clip(turn - up / slope, -0.5, 0.5)
    return np.where(np.abs(up) < 1e-6, radius, np.nan), angle


def _widest(rho: np.ndarray, theta: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """The largest angle (n,) at radii (n,) of all edges (passes, points)."""
    low, high = np.minimum(rho[:, :-1], rho[:, 1:]), np.maximum(rho[:, :-1], rho[:, 1:])
    widest = np.full(len(radii), np.nan)
    for k, radius in enumerate(radii):
        passes, points = np.nonzero((low <= radius) & (radius <= high) & (high > low))
        if len(passes):
            part = (radius - rho[passes, points]) / (rho[passes, points + 1] - rho[passes, points])
            cut = theta[passes, points] + part * (theta[passes, points + 1] - theta[passes, points])
            widest[k] = cut.max()
    return widest

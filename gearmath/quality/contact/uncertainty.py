"""What errors of the measured points do to the contact of a measured pair: center of its pattern, transmission error.

In first order metal left on by δ pushes the gear ahead by δ/ρ where the flanks touch, and closes the gap elsewhere:

    change of the lead of the gear at φ      (δ_1 + δ_2)(contact at φ)/ρ
    change of the gap at a point             ρ(point) · change of the lead at its φ - (δ_1 + δ_2)(point)

δ depends on the deviations of the points by the matrix of the spline, so that nothing is solved again.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from gearmath.bevel.contact.marked import marked_area
from gearmath.bevel.contact.mesh import Mesh
from gearmath.bevel.contact.pattern import pattern
from gearmath.bevel.contact.places import places
from gearmath.bevel.contact.report import ARCSEC
from gearmath.bevel.turning import half_turn
from gearmath.engine.points import Points
from gearmath.kernels import kernel
from gearmath.quality.contact.flank import MeasuredFlank

#: Change of a field [mm] by which derivatives of the pattern's center are taken: small beside the compound's thickness.
_STEP = 1e-6
#: Change of a slope [1] by which that of a rotation is taken.
_TILT = 1e-6
#: Samples of a pitch, and the part of one that is sampled more, so that an extreme lies between samples.
_SAMPLES, _BEYOND = 120, 0.25

#: The measured flanks of pinion and gear.
Flanks = tuple[MeasuredFlank | None, MeasuredFlank | None]
#: Contacts x (n,7) to what the coefficients of all splines do there.
Effect = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class UncertainContact:
    """Standard uncertainties of a contact: center of the pattern [mm], peak to peak of the transmission error [rad]."""

    center_cone_distance: float
    center_height: float
    peak_to_peak: float

    def as_dict(self) -> dict[str, float | None]:
        values = {
            "center_cone_distance_mm": self.center_cone_distance,
            "center_height_mm": self.center_height,
            "peak_to_peak_arcsec": self.peak_to_peak * ARCSEC,
        }
        return {name: value if math.isfinite(value) else None for name, value in values.items()}


def uncertain_contact(run: Mesh, flanks: Flanks) -> UncertainContact | None:
    """Of a pair with measured flanks of pinion and gear, by propagation; None where no file states an uncertainty."""
    known = [one for one in flanks if one is not None and np.isfinite(one.variance).all() and (one.variance > 0).any()]
    if not known or run.is_line or run.leads.peak_to_peak is None:
        return None
    deviation = np.sqrt(np.concatenate([one.variance for one in known]))
    pinion, gear = (one if one in known else None for one in flanks)
    rows = jacobian(run, (pinion, gear))
    center_along, center_up, spread = np.linalg.norm(rows * deviation, axis=1)
    return UncertainContact(float(center_along), float(center_up), float(spread))


def jacobian(run: Mesh, flanks: Flanks) -> np.ndarray:
    """How center (cone distance, height) [mm] and peak to peak [rad] change with the deviations (3,k) [mm].

    The deviations are those of the pinion's points, then the gear's, of the flanks that are given.
    """
    system, pitch = run.system, run.system.pitch
    effect, turn = _effect(run, flanks), _turn(run, flanks)
    found = pattern(run)
    shape = found.gap.shape
    grid = places(system, run.assembly, *shape)
    x = grid.x.reshape(-1, 7)
    at, lever = effect(x)
    known = np.asarray(np.isfinite(at).all(axis=1))
    samples = np.linspace(0, (1 + _BEYOND) * pitch, round(_SAMPLES * (1 + _BEYOND)) + 1)
    first, whose, leads = _first(run, samples)
    pushed, levers = effect(first)
    by_sample, slopes = pushed / levers[:, None], np.gradient(leads, samples)
    within = np.where(known, grid.rotation.ravel(), 0.0) % pitch
    low = np.minimum((within / samples[1]).astype(int), len(samples) - 2)
    part = (within / samples[1] - low)[:, None]
    ahead = (1 - part) * by_sample[low] + part * by_sample[low + 1]
    # the gear's own slopes change at which rotation a point meets the pinion
    ahead += np.interp(within, samples, slopes)[:, None] * turn(x)
    gap_by = np.where(known[:, None], np.nan_to_num(lever)[:, None] * ahead - np.nan_to_num(at), 0.0)
    center_by = np.empty((2, gap_by.shape[1]))
    for k, column in enumerate(gap_by.T):
        change = _STEP / max(float(np.abs(column).max()), 1e-12)
        ends = [
            marked_area(
                found.cone_distance, found.height, found.gap + sign * change * column.reshape(shape), found.thickness
            ).center
            for sign in (-1, 1)
        ]
        center_by[:, k] = (ends[1] - ends[0]) / (2 * change)
    inner = slice(round(_SAMPLES * _BEYOND / 2), round(_SAMPLES * (1 + _BEYOND / 2)) + 1)
    extremes = [
        _extreme(run, effect, samples, whose, by_sample, inner.start + int(k))
        for k in (leads[inner].argmax(), leads[inner].argmin())
    ]
    return np.vstack([center_by, extremes[0] - extremes[1]]) @ _fit(flanks)


def _extreme(
    run: Mesh, effect: Effect, samples: np.ndarray, whose: np.ndarray, by_sample: np.ndarray, k: int
) -> np.ndarray:
    """Change (m,) of an extreme of the lead: where two contacts take over from each other, that of their crossing."""
    system = run.system

    def lead(runner: np.ndarray, at: np.ndarray) -> np.ndarray:
        thread, pair = runner
        return system.sense * run.threads[thread].errors(system, at - pair * system.pitch)

    for j in (k - 1, k):
        ends = samples[[j, j + 1]]
        both = [lead(whose[i], ends) for i in (j, j + 1)]
        off: np.ndarray = both[0] - both[1]
        if np.array_equal(whose[j], whose[j + 1]) or not np.isfinite(off).all() or off[0] == off[1]:
            continue
        slopes = [float(one[1] - one[0]) for one in both]
        if slopes[0] * slopes[1] >= 0:
            continue
        crossing = np.array([ends[0] + (ends[1] - ends[0]) * off[0] / (off[0] - off[1])])
        by = []
        for thread, pair in (whose[j], whose[j + 1]):
            x, _ = run.threads[thread].sample(system, crossing - pair * system.pitch)
            pushed, lever = effect(x)
            by.append(pushed[0] / lever[0])
        return (slopes[1] * by[0] - slopes[0] * by[1]) / (slopes[1] - slopes[0])
    return by_sample[k]


def _first(run: Mesh, rotations: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The contacts x (n,7) that carry at rotations (n,), their thread and pair of teeth (n,2), and their leads (n,)."""
    system, reach = run.system, math.ceil(run.reach)
    x, whose = np.full((len(rotations), 7), np.nan), np.zeros((len(rotations), 2), dtype=int)
    leads = np.full(len(rotations), -np.inf)
    for t, thread in enumerate(run.threads):
        for k in range(-reach, reach + 1):
            at = rotations - k * system.pitch
            lead = system.sense * thread.errors(system, at)
            ahead = np.flatnonzero(lead > leads)
            if len(ahead):
                x[ahead], whose[ahead], leads[ahead] = thread.sample(system, at[ahead])[0], (t, k), lead[ahead]
    return x, whose, leads


def _turn(run: Mesh, flanks: Flanks) -> Callable[[np.ndarray], np.ndarray]:
    """x (n,7) to the change of the rotation of the pinion at which that point of the gear meets it (n,m) [rad/mm]."""
    count = [0 if one is None else len(one.fit) for one in flanks]
    gear, system = flanks[1], run.system
    if gear is None:
        return lambda x: np.zeros((len(x), sum(count)))
    w = ca.SX.sym("w", 3)
    point, normal, *_ = gear.nominal.function(w)
    z, r = ca.SX.sym("z"), ca.SX.sym("r")
    rates = ca.Function("rates", [z, r], [ca.jacobian(gear.basis(z, r), ca.vertcat(z, r))])
    radius = ca.sqrt(point[0] ** 2 + point[1] ** 2)
    slopes = rates(point[2], radius) @ ca.vertcat(
        ca.horzcat(0, 0, 1), ca.horzcat(point[0] / radius, point[1] / radius, 0)
    )
    tangential = slopes - (slopes @ normal) @ normal.T
    at = Points(ca.Function("slopes", [w], ca.cse([point, normal, ca.densify(tangential)])))
    pair = (gear.nominal.apex_beyond, system.shaft_angle, system.offset, run.assembly, system.ratio)

    def turn(x: np.ndarray) -> np.ndarray:
        point, normal, slopes = at(x[:, 3:6])
        point, normal = point[:, :, 0], normal[:, :, 0]
        still = np.stack([kernel("meeting")(point, normal, *pair, side)[0] for side in (1, -1)])
        nearest = np.abs(half_turn(still - system.phase[1] - x[:, 6])).argmin(axis=0)
        by_function = np.empty(slopes.shape[:2])
        for k in range(slopes.shape[1]):
            tilted = normal - _TILT * slopes[:, k]
            tilted /= np.linalg.norm(tilted, axis=1, keepdims=True)
            both = np.stack([kernel("meeting")(point, tilted, *pair, side)[0] for side in (1, -1)])
            by_function[:, k] = half_turn(np.take_along_axis(both - still, nearest[None], 0)[0]) / _TILT
        # where a point meets the pinion, the error does not change with the rotation: both turn by the ratio
        return np.hstack([np.zeros((len(x), count[0])), -by_function / system.ratio])

    return turn


def _fit(flanks: Flanks) -> np.ndarray:
    """From the deviations of all points to the coefficients of all splines (m,k)."""
    fits = [flank.fit for flank in flanks if flank is not None]
    whole = np.zeros([sum(sizes) for sizes in zip(*(one.shape for one in fits), strict=True)])
    row = column = 0
    for one in fits:
        whole[row : row + len(one), column : column + one.shape[1]] = one
        row, column = row + len(one), column + one.shape[1]
    return whole


def _effect(run: Mesh, flanks: Flanks) -> Effect:
    """x (n,7) to δ_1 + δ_2 there by the coefficients of all splines (n,m), and the gear's lever in size (n,) [mm]."""
    system = run.system
    x, assembly = ca.SX.sym("x", 7), ca.SX.sym("assembly", 4)
    rows = []
    for side, flank in enumerate(flanks):
        if flank is not None:
            point, *_ = flank.nominal.function(x[3 * side : 3 * side + 3])
            rows.append(flank.basis(point[2], ca.sqrt(point[0] ** 2 + point[1] ** 2)))
    point, normal, *_ = system.gear.function(x[3:6])
    placed = system.placed(1, point, normal, x[6], assembly)
    lever, _ = kernel("transmission").function(*placed, system.shaft_angle, system.offset, assembly)
    outputs = [ca.horzcat(*rows), ca.fabs(lever)]
    run_at = Points(ca.Function("effect", [x, assembly], ca.cse([ca.densify(one) for one in outputs])), shared=(1,))

    def effect(at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        functions, size = run_at(at, run.assembly)
        return functions[:, 0, :], size[:, 0, 0]

    return effect

"""The flank that is left against a brute-force cut: every gash that comes near is swept over a grid, in plain matrices.

Written from the frames alone: the hob as an involute worm in its own axes, its pose, the turning table.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearmath.gearbox.dimensions import Gear
from gearmath.gearbox.hobbed.envelope import Envelope
from gearmath.gearbox.hobbed.inspection import form_length
from gearmath.gearbox.hobbed.job import TURN, HobbingJob, HobTool

UM = 1e-3


class Sines:
    """Smooth errors of every kind, written here again: table three times a turn of it, hob and blank eccentric."""

    jump = unsteady = 0.0

    def __init__(self, of: HobbingJob, size: float) -> None:
        self.job, self.size = of, size

    def variation(self, psi, thread):
        return np.full_like(psi, 0.04 * self.size)

    def sudden(self, psi, side):
        return np.zeros_like(psi), np.zeros_like(psi)

    def lag_range(self, psi, side, unsure):
        return None

    def table(self, psi, side):
        turned = psi * self.job.hob.starts / self.job.gear.teeth
        return self.size * 4e-3 / self.job.base_radius * np.sin(3 * turned + 0.3)

    def displacement(self, psi, thread, place):
        return self.size * np.column_stack([0.01 * np.cos(psi), 0.004 * np.sin(psi), 0.003 * np.sin(2 * psi)])


def _crossing(off: np.ndarray, across: np.ndarray, deep: np.ndarray, edge: np.ndarray) -> tuple[float, float]:
    """Where a surface given on a grid crosses a line: a cubic through the 5 x 5 nodes around the nearest one.

    Its place on the line, and the height on the hob.
    """
    i, j = np.unravel_index(int((off**2 + across**2).argmin()), off.shape)
    if not (2 <= i < off.shape[0] - 2 and 2 <= j < off.shape[1] - 2):
        return math.inf, 0.0
    part = (slice(i - 2, i + 3), slice(j - 2, j + 3))
    x, y, w, h = (values[part].ravel() * 10 for values in (off, across, deep, edge))
    terms = np.column_stack([np.ones_like(x), x, y, x * x, x * y, y * y, x**3, x * x * y, x * y * y, y**3])
    found = np.linalg.lstsq(terms, np.column_stack([w, h]), rcond=None)[0][0] / 10
    return float(found[0]), float(found[1])


def brute_force(of: HobbingJob, errors, side: int, space: int, length: float, height: float) -> float:
    """The distance along the normal to the nearest of all surfaces that single gashes sweep."""
    gear, hob = of.gear, of.hob
    z, m, k, r0 = gear.teeth, gear.module, hob.starts, hob.diameter / 2
    d = z * m / math.cos(gear.beta)
    alpha_t = math.atan(math.tan(gear.alpha) / math.cos(gear.beta))
    rb, lead = d * math.cos(alpha_t) / 2, math.asin(m * k / hob.diameter)
    twist = of.helix_sign * 2 * math.sin(gear.beta) / (z * m)  # rad per mm

    # the point of the involute and its normal
    xi0 = side * (math.pi / (2 * z) - 2 * gear.shift * math.tan(gear.alpha) / z - math.tan(alpha_t) + alpha_t)
    xi = xi0 + side * length / rb + twist * height + TURN * space / z
    out = np.array([side * math.sin(xi), -side * math.cos(xi), side * rb * twist])
    point = np.array([rb * math.cos(xi) + length * out[0], rb * math.sin(xi) + length * out[1], height])
    normal = out / np.linalg.norm(out)
    first = np.cross(normal, [0.0, 0.0, 1.0])
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)

    # the hob in its own axes: radius and place along the axis; a little beyond the straight edge, for the fit
    reduced = m * k / (2 * math.cos(lead))
    a0 = math.atan(math.tan(gear.alpha) / math.sin(lead))
    base0 = r0 * math.cos(a0)
    eta = hob.sign * lead - of.helix_sign * gear.beta
    h, tau = np.meshgrid(np.arange(-1.6 * m, 1.3 * m, 0.05), np.arange(-0.5, 0.5, 0.01), indexing="ij")
    a = np.arccos(base0 / (r0 + h))
    half = reduced * (math.pi / (2 * k) + math.tan(a0) - a0 - np.tan(a) + a)
    center = d / 2 + gear.shift * m + r0

    # on the hob a gash stands at the azimuth c + twist y, a thread at y = per_rad (R - azimuth) + half of it; where the
    # hob is shifted, it is turned until its threads are in place again
    per_rad, twisted = hob.sign * reduced, 0.0 if hob.gash_lead is None else hob.sign * TURN / hob.gash_lead
    turned = -of.hob_offset / per_rad

    def swept(gash, ridge: int, part) -> tuple[np.ndarray, ...]:
        on_hob = per_rad * TURN * (ridge / k - gash / hob.gashes) + side * half[part]
        on_hob = on_hob / (1 + per_rad * twisted)
        psi = TURN * gash / hob.gashes + twisted * on_hob + turned + tau[part]
        along = on_hob + of.hob_offset
        moved = errors.displacement(psi.ravel(), 0 * psi.ravel(), None).reshape(*psi.shape, 3)
        x = center - (r0 + h[part]) * np.cos(tau[part]) + moved[..., 0]
        up = (r0 + h[part]) * np.sin(tau[part])
        y = along * math.cos(eta) - up * math.sin(eta) + moved[..., 1]
        rise = along * math.sin(eta) + up * math.cos(eta) + moved[..., 2]
        at = of.start_height + of.travel_per_rad * psi
        table = -hob.sign * k / z * psi - twist * at + errors.table(psi.ravel(), side).reshape(psi.shape)
        cos, sin = np.cos(table), np.sin(table)
        place = np.stack([cos * x + sin * y, -sin * x + cos * y, rise + at], axis=-1) - point
        return place @ first, place @ second, place @ normal

    best = math.inf
    straight = hob.addendum - hob.tip_radius * (1 - math.sin(gear.alpha))
    per_turn = abs(of.travel_per_rad) * TURN * z / k  # between two cuts of one space
    every, coarse = (slice(None), slice(None)), (slice(None, None, 8), slice(None, None, 2))
    apart = (0.2**2 + (0.01 * r0) ** 2) + 0.5**2  # of nodes of the coarse grid, with room
    for turn in range(-400, 800):
        ridge = hob.sign * space + z * turn
        around = round(hob.gashes * (ridge / k - turned / TURN))
        off_height = of.start_height + of.travel_per_rad * TURN * ridge / k - height
        if abs(off_height) > 4.0 * per_turn + 3.0 * m:
            continue
        gashes = np.arange(around - 2 * hob.gashes, around + 2 * hob.gashes + 1)
        # where the line crosses at all, roughly: the whole grid only there
        off, across, deep = (values.reshape(len(gashes), -1) for values in swept(gashes[:, None, None], ridge, coarse))
        near = off**2 + across**2
        nearest = near.argmin(axis=1)
        rows = np.arange(len(gashes))
        for gash in gashes[(near[rows, nearest] < apart) & (deep[rows, nearest] < 0.7)]:
            left, edge = _crossing(*swept(gash, ridge, every), h)
            if edge <= straight:
                best = min(best, left)
    return best


def random_job(random: np.random.Generator, hands: tuple[int, int], starts: int, beta: float) -> HobbingJob:
    """Any gear, hob and feed of a bench: coarse enough that the ridges are micrometres high."""
    module = float(random.uniform(0.8, 2.0))
    gear = Gear(int(random.integers(18, 90)), module, math.radians(20), math.radians(beta), random.uniform(-0.2, 0.4))
    hob = HobTool(
        starts, hands[0], int(random.integers(8, 15)), module * random.uniform(25, 50), 1.25 * module, 0.38 * module
    )
    return HobbingJob(gear, hands[1], hob, 20.0, float(random.uniform(0.4, 3.0)), bool(random.integers(2)))


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(
    ("hands", "beta", "starts"),
    [
        ((1, 1), 0.0, 1),
        ((-1, 1), 0.0, 3),
        ((1, 1), 30.0, 2),
        ((-1, 1), 42.0, 1),
        ((1, -1), 12.0, 2),
        ((-1, -1), 42.0, 3),
    ],
)
def test_envelope_is_what_a_brute_force_cut_of_the_same_edges_leaves(hands, beta, starts, side):
    """Within 0.1 um from form circle to tip; one flank of every gear by an ideal machine, one by one with errors."""
    random = np.random.default_rng([18, starts, round(beta), hands[0] + 1, side + 1])
    of = random_job(random, hands, starts, beta)
    tip = math.sqrt((of.reference_diameter / 2 + of.gear.module * (1 + of.gear.shift)) ** 2 - of.base_radius**2)
    form = form_length(of, tip)
    check(of, Sines(of, float(side != hands[0])), side, form, tip, random)


@pytest.mark.parametrize(
    ("hands", "beta", "starts", "lead", "offset"),
    [((1, 1), 0.0, 3, 250.0, 0.0), ((-1, 1), 25.0, 3, 250.0, -2.3), ((1, -1), 12.0, 1, None, 1.9)],
)
def test_helical_gashes_and_a_shifted_hob_leave_what_a_brute_force_cut_leaves(hands, beta, starts, lead, offset):
    """Within 0.1 um; the gashes cross the threads far from at a right angle, so that edges stand closer by 4 to 5 %."""
    random = np.random.default_rng([30, starts, hands[0] + 1])
    of = random_job(random, hands, starts, beta)
    of = replace(of, hob=replace(of.hob, gash_lead=lead), hob_offset=offset)
    tip = math.sqrt((of.reference_diameter / 2 + of.gear.module * (1 + of.gear.shift)) ** 2 - of.base_radius**2)
    check(of, Sines(of, 1.0), 1 if beta else -1, form_length(of, tip), tip, random)


def check(of: HobbingJob, errors, side: int, form: float, tip: float, random: np.random.Generator) -> None:
    """Three points of the flank ``side``, one on the form circle."""
    spaces = random.integers(0, of.gear.teeth, 3)
    lengths, heights = np.array([form, *random.uniform(form, tip, 2)]), random.uniform(5.0, 15.0, 3)
    found = Envelope(of, errors).deviation(side, spaces, lengths, heights)
    rows = zip(spaces.tolist(), lengths.tolist(), heights.tolist(), strict=True)
    cut = [brute_force(of, errors, side, *row) for row in rows]
    np.testing.assert_allclose(found, cut, rtol=0, atol=0.1 * UM)

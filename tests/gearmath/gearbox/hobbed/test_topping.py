"""The tip that a topping hob turns: its radius, its ridges, and what an eccentric blank does to it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import fsolve

from gearmath.gearbox.dimensions import Gear
from gearmath.gearbox.hobbed.envelope import Envelope
from gearmath.gearbox.hobbed.inspection import inspect, layout
from gearmath.gearbox.hobbed.job import TURN, HobbingJob, HobTool
from gearmath.gearbox.hobbed.setup import setup
from gearmath.gearbox.hobbed.topping import topped_radii, topped_radius
from gearmath.specs.cutting_errors import CuttingErrors
from gearmath.specs.hobbing import find_hobbing_machine

UM = 1e-3


def job(gashes: int, feed: float, beta: float = 0.0, shift: float = 0.0, starts: int = 1) -> HobbingJob:
    gear = Gear(24, 1.0, math.radians(20), math.radians(beta), shift)
    return HobbingJob(gear, 1, HobTool(starts, 1, gashes, 50.0, 1.25, 0.38, dedendum=1.0), 20.0, feed)


@pytest.mark.parametrize(("gashes", "starts", "shift"), [(12, 1, 0.0), (8, 1, 0.3), (16, 2, 0.0)])
def test_facets_of_a_topped_tip_are_those_of_a_polygon_around_its_circle(gashes, starts, shift):
    """r_a/cos(half the turn of a gash) - r_a within 1 %; r_a = r + m (1 + x)."""
    radius, half = 12.0 + 1.0 + shift, math.pi * starts / (24 * gashes)
    found = topped_radii(Envelope(job(gashes, 0.01, shift=shift, starts=starts)), 10.0) - radius
    np.testing.assert_allclose(found, radius / math.cos(half) - radius, rtol=0.01)


def test_feed_leaves_on_a_topped_tip_what_circles_of_the_hob_s_root_leave():
    """f²/(8 (r_0 - m)) within 1 %: circles of 24 mm radius, 1 mm apart."""
    found = topped_radii(Envelope(job(3000, 1.0)), 10.0) - 13.0
    np.testing.assert_allclose(found, 1.0 / (8 * 24.0), rtol=0.01)


def by_hand(of: HobbingJob, tooth: int, angle: float, height: float) -> float:
    """The nearest of all lines that the root of a gash is, at an angle from the middle of the tooth's front space.

    Unscrewed to the lower face; each line turned with the hob until it passes the angle at the height.
    """
    gear, hob = of.gear, of.hob
    lead = math.asin(gear.module * hob.starts / hob.diameter)
    eta, reach, z = lead - gear.beta, hob.diameter / 2 - 1.0, gear.teeth
    center = z / math.cos(gear.beta) / 2 + gear.shift + hob.diameter / 2
    twist = 2 * math.sin(gear.beta) / (z * gear.module)
    target = TURN * tooth / z + angle + twist * height

    def place(along: float, tau: float, gash: int) -> np.ndarray:
        psi = TURN * gash / hob.gashes + tau
        x, up = center - reach * math.cos(tau), reach * math.sin(tau)
        y, rise = along * math.cos(eta) - up * math.sin(eta), along * math.sin(eta) + up * math.cos(eta)
        at = of.start_height + of.travel_per_rad * psi
        table = -hob.starts / z * psi - twist * at
        off = math.remainder(math.atan2(y, x) - table - target, TURN)
        return np.array([math.hypot(x, y), off, rise + at - height])

    best = math.inf
    middle = (height - of.start_height) / of.travel_per_rad / TURN * hob.gashes
    for gash in range(round(middle - 2.6 * z * hob.gashes), round(middle + 2.6 * z * hob.gashes)):
        _, off, high = place(0.0, 0.0, gash)
        if abs(off) * center > 4.0 or abs(high) > 4.0:
            continue
        found, _, status, _ = fsolve(lambda u, g=gash: place(u[0], u[1], g)[1:], (0.0, 0.0), full_output=True)
        if status == 1:
            best = min(best, place(*found, gash)[0])
    return best


@pytest.mark.parametrize(
    ("beta", "starts", "gashes", "feed"), [(0.0, 2, 10, 1.3), (25.0, 1, 10, 1.3), (40.0, 1, 24, 4.0)]
)
def test_topped_tip_is_what_the_nearest_of_all_gashes_leaves(beta, starts, gashes, feed):
    """Within 0.01 um of the lines of all gashes, each solved by itself; anywhere within a facet and a feed."""
    of = job(gashes, feed, beta, starts=starts)
    random = np.random.default_rng([22, starts])
    teeth = random.integers(0, 24, 4)
    angles = math.pi / 24 + TURN * starts / (24 * gashes) * random.uniform(-0.5, 0.5, 4)
    heights = random.uniform(9.0, 11.0, 4)
    found = topped_radius(Envelope(of), teeth, angles, heights)
    cut = [by_hand(of, *row) for row in zip(teeth.tolist(), angles.tolist(), heights.tolist(), strict=True)]
    np.testing.assert_allclose(found, cut, rtol=0, atol=0.01 * UM)


def test_topped_tip_runs_out_with_an_eccentric_blank_and_a_turned_one_does_not():
    """25 um off center: the tip runs out by 50 um about the bore; without topping it is the blank's."""
    machine = find_hobbing_machine("hobbing_helical.toml")
    errors = CuttingErrors.model_validate({"blank_eccentricity_um": 25.0})
    rows = {}
    for topped in (True, False):
        hobs = tuple(hob.model_copy(update={"topping": topped}) for hob in machine.hobs)
        changed = machine.model_copy(update={"hobs": hobs, "errors": errors})
        prepared = setup(changed, 24, hob="m1", feed=0.5, rule="ideal")
        where = replace(layout(prepared.job), teeth=np.array([0]))
        found = inspect(Envelope(prepared.job, prepared.train), where).thicknesses
        rows[topped] = {each.what: each for each in found}
    assert "tip radius" not in rows[False]
    tip = rows[True]["tip radius"]
    assert tip.nominal == pytest.approx(13.0, abs=1e-12)
    assert tip.range == pytest.approx(0.05, rel=0.02)
    ridges = 13.0 * (math.pi / (24 * 12)) ** 2 / 2 + 0.5**2 / (8 * (prepared.job.hob.diameter / 2 - 1.0))
    assert tip.mean - 13.0 == pytest.approx(ridges, abs=0.5 * UM)

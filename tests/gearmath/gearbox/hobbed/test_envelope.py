"""The flank that gashes leave: the involute helicoid in the limit, and ridges of known height."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearmath.gearbox.dimensions import Gear
from gearmath.gearbox.hobbed.envelope import Envelope
from gearmath.gearbox.hobbed.inspection import form_length, inspect, layout
from gearmath.gearbox.hobbed.job import TURN, HobbingJob, HobTool

UM = 1e-3


def job(
    teeth: int = 24,
    module: float = 1.0,
    beta: float = 0.0,
    shift: float = 0.0,
    hands: tuple[int, int] = (1, 1),
    starts: int = 1,
    gashes: int = 12,
    diameter: float = 50.0,
    feed: float = 1.0,
    climb: bool = True,
) -> HobbingJob:
    gear = Gear(teeth, module, math.radians(20), math.radians(beta), shift)
    hob = HobTool(starts, hands[0], gashes, diameter, 1.25 * module, 0.38 * module)
    return HobbingJob(gear, hands[1], hob, 20.0, feed, climb)


def pitch_length(of: HobbingJob) -> float:
    return of.base_radius * math.tan(of.transverse[1])


@pytest.mark.parametrize(
    ("teeth", "beta", "shift", "hands", "starts", "climb"),
    [
        (24, 0.0, 0.0, (1, 1), 1, True),
        (6, 0.0, 0.5, (1, 1), 1, False),
        (17, 0.0, -0.2, (-1, 1), 2, True),
        (200, 0.0, -0.5, (1, 1), 3, True),
        (41, 20.0, -0.3, (-1, 1), 2, True),
        (6, 10.0, 0.5, (1, -1), 3, True),
        (23, 35.0, 0.2, (-1, -1), 1, False),
        (200, 25.0, 0.5, (1, 1), 1, True),
    ],
)
def test_ideal_drive_and_many_gashes_leave_the_involute_helicoid(teeth, beta, shift, hands, starts, climb):
    """Within 0.01 um, never below, on both flanks, along profile and helix, and at every tooth that is asked."""
    cut = Envelope(job(teeth, 1.0, beta, shift, hands, starts, 1500, 50.0, 0.02, climb))
    gear, base = cut.job.gear, cut.job.base_radius
    tip = math.sqrt((cut.job.reference_diameter / 2 + 1 + shift) ** 2 - base**2)
    profile = np.linspace(form_length(cut.job, tip), tip, 25)
    middle = float(profile[12])
    for side in (1, -1):
        spaces = np.arange(25) % gear.teeth
        along_profile = cut.deviation(side, spaces, profile, np.full(25, 10.007))
        along_helix = cut.deviation(side, spaces, np.full(25, middle), np.linspace(2.0, 18.0, 25))
        for found in (along_profile, along_helix):
            assert found.max() < 0.01 * UM
            assert found.min() > -1e-9


@pytest.mark.parametrize(("starts", "gashes"), [(1, 10), (2, 16), (3, 15)])
@pytest.mark.parametrize("at", [0.85, 1.0, 1.15])
def test_ridges_between_flats_are_those_of_the_textbooks(starts, gashes, at):
    """δ = L (π k/(z n))²/2, at the reference circle π² k² m sin α/(4 z n²): within 1 %."""
    of = job(80, 1.0, starts=starts, gashes=gashes, diameter=120.0, feed=0.02)
    length = at * pitch_length(of)
    flats = TURN * starts / (80 * gashes) * of.base_radius  # length of roll from gash to gash
    near = np.linspace(length - 0.6 * flats, length + 0.6 * flats, 401)
    for side in (1, -1):
        found = Envelope(of).deviation(side, np.zeros(401, int), near, np.full(401, 10.0))
        top = int(found.argmax())
        expected = near[top] * (math.pi * starts / (80 * gashes)) ** 2 / 2
        assert found[top] == pytest.approx(expected, rel=0.01)
    if at == 1.0:
        assert expected == pytest.approx(
            math.pi**2 * starts**2 * math.sin(math.radians(20)) / (4 * 80 * gashes**2), rel=0.03
        )


@pytest.mark.parametrize("beta", [0.0, 2.0, 15.0, 30.0, 45.0])
@pytest.mark.parametrize("hands", [(1, 1), (-1, 1), (1, -1)])
@pytest.mark.parametrize("diameter", [50.0, 500.0])
def test_feed_marks_of_many_gashes_are_those_of_the_closed_form_at_every_helix_angle(beta, hands, diameter):
    """(30.10) within 1 %; up to 2 degrees that is the textbooks' (f_a/cos β)² sin α/(4 d), d where it cuts."""
    of = job(40, 1.0, beta, hands=hands, gashes=3000, diameter=diameter, feed=1.0)
    length = pitch_length(of)
    heights = np.linspace(10.0, 11.1, 1001)
    for side in (1, -1):
        found = Envelope(of).deviation(side, np.zeros(1001, int), np.full(1001, length), heights).max()
        assert found == pytest.approx(of.feed_mark(length), rel=0.01)
        if beta <= 2.0:
            known = (1.0 / math.cos(math.radians(beta))) ** 2 * math.sin(math.radians(20)) / (4 * diameter)
            assert found == pytest.approx(known, rel=0.01)


@pytest.mark.parametrize("of", [job(gashes=2000, feed=0.02), job(31, 2.0, 18.0, 0.3, gashes=2000, feed=0.02)])
def test_span_and_pins_of_an_ideal_gear_are_those_of_the_plan(of):
    """Within 0.1 um; the plan's own figures are compared with published ones elsewhere."""
    found = inspect(Envelope(of), layout(of)).thicknesses
    assert [each.what.split()[0] for each in found] == ["span", "over"]
    for each in found:
        assert each.mean == pytest.approx(each.nominal, abs=0.1 * UM)
        assert each.range < 0.05 * UM

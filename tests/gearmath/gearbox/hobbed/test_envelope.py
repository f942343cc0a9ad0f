"""The flank that gashes leave: the involute helicoid in the limit, the textbooks' ridges, and a brute-force cut."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearmath.gearbox.dimensions import Gear
from gearmath.gearbox.hobbed.envelope import Cut
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
    cut = Cut(job(teeth, 1.0, beta, shift, hands, starts, 1500, 50.0, 0.02, climb))
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
        found = Cut(of).deviation(side, np.zeros(401, int), near, np.full(401, 10.0))
        top = int(found.argmax())
        expected = near[top] * (math.pi * starts / (80 * gashes)) ** 2 / 2
        assert found[top] == pytest.approx(expected, rel=0.01)
    if at == 1.0:
        assert expected == pytest.approx(
            math.pi**2 * starts**2 * math.sin(math.radians(20)) / (4 * 80 * gashes**2), rel=0.03
        )


@pytest.mark.parametrize(
    ("beta", "feed", "within"), [(0.0, 1.0, 0.01), (0.0, 3.0, 0.01), (2.0, 1.0, 0.01), (30.0, 2.0, 0.06)]
)
@pytest.mark.parametrize("diameter", [50.0, 500.0])
def test_feed_marks_are_those_of_the_textbooks_with_the_curvatures_that_are_there(beta, feed, within, diameter):
    """(f_a/cos β)² sin α (1/r_0 + sin² β/r)/8: 1 % at small angles."""
    of = job(40, 1.0, beta, gashes=3000, diameter=diameter, feed=feed)
    length = pitch_length(of)
    heights = np.linspace(10.0, 10.0 + 1.2 * feed, 801)
    found = Cut(of).deviation(1, np.zeros(801, int), np.full(801, length), heights)
    angle = math.radians(beta)
    curved = 2 / diameter + math.sin(angle) ** 2 * math.cos(angle) / 20.0
    expected = (feed / math.cos(angle)) ** 2 * math.sin(math.radians(20)) * curved / 8
    assert found.max() == pytest.approx(expected, rel=within)


class _Sines:
    """Smooth errors of every kind, written here again: table three times a turn of it, hob and blank eccentric."""

    jump = 0.0

    def __init__(self, of: HobbingJob) -> None:
        self.job = of

    def variation(self, away):
        return np.full_like(away, 0.04), np.full_like(away, 0.04)

    def table(self, psi, side):
        return 4e-4 * np.sin(3 * psi * self.job.hob.starts / self.job.gear.teeth + 0.3)

    def displacement(self, psi, thread, place):
        return np.column_stack([0.01 * np.cos(psi), 0.004 * np.sin(psi), 0.003 * np.sin(2 * psi)])


def _crossing(off: np.ndarray, across: np.ndarray, deep: np.ndarray) -> float:
    """Where a surface given on a grid crosses a line: a parabola through the 5 x 5 nodes around the nearest one."""
    i, j = np.unravel_index(int((off**2 + across**2).argmin()), off.shape)
    if not (2 <= i < off.shape[0] - 2 and 2 <= j < off.shape[1] - 2):
        return math.inf
    part = (slice(i - 2, i + 3), slice(j - 2, j + 3))
    x, y, w = (values[part].ravel() * 10 for values in (off, across, deep))
    terms = np.column_stack([np.ones_like(x), x, y, x * x, x * y, y * y, x**3, x * x * y, x * y * y, y**3])
    return float(np.linalg.lstsq(terms, w, rcond=None)[0][0]) / 10


def brute_force(of: HobbingJob, errors, side: int, space: int, length: float, height: float) -> float:
    """The distance along the normal to the nearest of all surfaces that single gashes sweep, from rotation matrices.

    Written from the frames alone: the hob as an involute worm in its own axes, its pose, the turning table.
    """
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

    # the hob in its own axes: radius and place along the axis
    reduced = m * k / (2 * math.cos(lead))
    a0 = math.atan(math.tan(gear.alpha) / math.sin(lead))
    base0 = r0 * math.cos(a0)
    eta = hob.sign * lead - of.helix_sign * gear.beta
    h, tau = np.meshgrid(np.arange(-1.5 * m, 1.1 * m, 0.05), np.arange(-0.2, 0.2, 0.004), indexing="ij")
    a = np.arccos(base0 / (r0 + h))
    half = reduced * (math.pi / (2 * k) + math.tan(a0) - a0 - np.tan(a) + a)
    center = d / 2 + gear.shift * m + r0

    best = math.inf
    per_turn = of.travel_per_rad * TURN * z / k  # of the table, nearly
    for turn in range(-200, 400):
        ridge = hob.sign * space + z * turn
        around = hob.gashes * ridge // k
        psi0 = TURN * around / hob.gashes
        if abs(of.start_height + of.travel_per_rad * psi0 - height) > 2.5 * abs(per_turn):
            continue
        for c in range(around - 12, around + 13):
            psi = TURN * c / hob.gashes + tau
            along = hob.sign * reduced * TURN * (ridge / k - c / hob.gashes) + side * half
            moved = errors.displacement(psi.ravel(), 0 * psi.ravel(), None).reshape(*psi.shape, 3)
            x = center - (r0 + h) * np.cos(tau) + moved[..., 0]
            up = (r0 + h) * np.sin(tau)
            y = along * math.cos(eta) - up * math.sin(eta) + moved[..., 1]
            rise = along * math.sin(eta) + up * math.cos(eta) + moved[..., 2]
            at = of.start_height + of.travel_per_rad * psi
            table = -hob.sign * k / z * psi - twist * at + errors.table(psi.ravel(), side).reshape(psi.shape)
            cos, sin = np.cos(table), np.sin(table)
            place = np.stack([cos * x + sin * y, -sin * x + cos * y, rise + at], axis=-1) - point
            off, across, deep = place @ first, place @ second, place @ normal
            left = _crossing(off, across, deep)
            best = min(best, left)
    return best


@pytest.mark.parametrize(
    ("of", "with_errors"),
    [
        (job(), False),
        (job(18, 1.0, 0.0, 0.2, (1, 1), 2, 9, 40.0, 1.5), True),
        (job(30, 1.0, 20.0, 0.0, (-1, 1), 1, 8, 40.0, 1.0), True),
        (job(25, 1.0, 12.0, -0.1, (1, -1), 1, 10, 40.0, 2.0, False), True),
    ],
)
def test_envelope_is_what_a_brute_force_cut_of_the_same_edges_leaves(of, with_errors):
    """Within 0.1 um at ten points of both flanks."""
    errors = _Sines(of)
    if not with_errors:
        errors.table = lambda psi, side: np.zeros(len(psi))
        errors.displacement = lambda psi, thread, place: np.zeros((len(psi), 3))
    random = np.random.default_rng(18)
    middle = pitch_length(of)
    for side in (1, -1):
        spaces = random.integers(0, of.gear.teeth, 3)
        lengths, heights = middle + random.uniform(-0.8, 1.2, 3), random.uniform(5.0, 15.0, 3)
        found = Cut(of, errors).deviation(side, spaces, lengths, heights)
        rows = zip(spaces.tolist(), lengths.tolist(), heights.tolist(), strict=True)
        cut = [brute_force(of, errors, side, *row) for row in rows]
        np.testing.assert_allclose(found, cut, rtol=0, atol=0.1 * UM)


@pytest.mark.parametrize("of", [job(gashes=2000, feed=0.02), job(31, 2.0, 18.0, 0.3, gashes=2000, feed=0.02)])
def test_span_and_pins_of_an_ideal_gear_are_those_of_the_plan(of):
    """Within 0.1 um; the plan's own figures are compared with published ones elsewhere."""
    found = inspect(Cut(of), layout(of)).thicknesses
    assert [each.what.split()[0] for each in found] == ["span", "over"]
    for each in found:
        assert each.mean == pytest.approx(each.nominal, abs=0.1 * UM)
        assert each.range < 0.05 * UM

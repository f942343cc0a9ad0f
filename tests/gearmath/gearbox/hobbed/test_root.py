"""Root and undercut of a hobbed space: the rolling of a rack with rounded tips, worked out here anew."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearmath.gearbox.dimensions import Gear
from gearmath.gearbox.hobbed.inspection import form_length
from gearmath.gearbox.hobbed.job import HobbingJob, HobTool
from gearmath.gearbox.hobbed.root import root, undercut_radius

UM = 1e-3
ALPHA = math.radians(20)


def job(teeth: int, shift: float, diameter: float = 4000.0, tip_radius: float = 0.38, starts: int = 1) -> HobbingJob:
    gear = Gear(teeth, 1.0, ALPHA, 0.0, shift)
    return HobbingJob(gear, 1, HobTool(starts, 1, 720, diameter, 1.25, tip_radius), 10.0, 0.5)


def by_rack(
    teeth: int, shift: float, radii: np.ndarray, tip_radius: float = 0.38, amount: float = 0.0, angle: float = ALPHA
) -> np.ndarray:
    """Half the angle of the space at radii: a rack of m = 1 rolls on the pitch circle, the farthest of its points.

    Flank, rounding whose middle is ``amount`` further along the normal, and between them a line at ``angle``.
    """
    center = 1.25 - tip_radius
    middle = math.pi / 4 - center * math.tan(ALPHA) - (tip_radius - amount) / math.cos(ALPHA)
    gamma = np.linspace(angle, math.pi / 2, 300)
    rounded = np.column_stack([center + tip_radius * np.sin(gamma), middle + tip_radius * np.cos(gamma)])
    (top, out), slope = rounded[0], math.tan(angle)
    # the line through the first point of the rounding meets the flank across = pi/4 - height tan(20)
    if amount:
        form = top - (out - math.pi / 4 + top * math.tan(ALPHA)) / (math.tan(ALPHA) - slope)
    else:
        form = top
    heights = np.linspace(-1.5, form, 400)
    straight = np.column_stack([heights, math.pi / 4 - heights * math.tan(ALPHA)])
    rounded = np.vstack([np.linspace(straight[-1], rounded[0], 50), rounded])
    height, across = np.vstack([straight, rounded]).T
    pitch = teeth / 2
    turn = np.linspace(-8.0 / pitch, 8.0 / pitch, 1201)[:, None]
    x, y = pitch + shift - height, across + pitch * turn
    rho, theta = np.hypot(x, y), np.arctan2(y, x) - turn
    found = []
    for radius in radii:
        i, k = np.nonzero((rho[:, :-1] - radius) * (rho[:, 1:] - radius) <= 0)
        part = (radius - rho[i, k]) / (rho[i, k + 1] - rho[i, k])
        found.append((theta[i, k] + part * (theta[i, k + 1] - theta[i, k])).max())
    return np.array(found)


@pytest.mark.parametrize(("teeth", "shift", "tip_radius"), [(24, 0.0, 0.38), (40, 0.3, 0.25), (8, 0.2, 0.3)])
def test_root_and_undercut_of_a_large_hob_are_those_of_the_rack(teeth, shift, tip_radius):
    """Fillet and flank, also where the trochoid undercuts: within 1 um along the circle, from the bottom to the tip."""
    of = job(teeth, shift, tip_radius=tip_radius)
    radii = np.linspace(teeth / 2 + shift - 1.25 + 0.02, teeth / 2 + shift + 0.9, 40)
    for side in (1, -1):
        found = root(of, radii, side)
        assert found.bottom == pytest.approx(teeth / 2 + shift - 1.25, abs=0.5 * UM)
        np.testing.assert_allclose(found.half_angle * radii, by_rack(teeth, shift, radii, tip_radius) * radii, atol=UM)


def test_small_hob_leaves_nearly_the_same_root():
    """A hob of 50 mm: less than 0.01 mm from that of the rack."""
    radii = np.linspace(11.0, 12.8, 20)
    assert np.abs((root(job(24, 0.0, 50.0), radii).half_angle - by_rack(24, 0.0, radii)) * radii).max() < 0.01


@pytest.mark.parametrize(
    ("teeth", "shift", "is_cut"),
    [(24, 0.0, False), (18, 0.0, False), (10, 0.42, False), (10, 0.0, True), (12, 0.0, True), (6, 0.0, True)],
)
def test_undercut_of_a_micrometre_is_there_far_below_the_least_number_of_teeth_and_never_above(teeth, shift, is_cut):
    """z_min = 2 (h_F/m - x)/sin² α, h_F = 1.25 - 0.38 (1 - sin α) of basic rack A: 17.1, and 9.9 for x = 0.42."""
    least = 2 * (1.25 - 0.38 * (1 - math.sin(ALPHA)) - shift) / math.sin(ALPHA) ** 2
    assert (teeth < least) == is_cut
    found = undercut_radius(job(teeth, shift, 1000.0), teeth / 2 + shift + 1)
    assert (found is not None) == is_cut


@pytest.mark.parametrize(
    ("teeth", "shift", "tip_radius", "amount", "angle"), [(24, 0.0, 0.3, 0.08, 10), (40, 0.2, 0.2, 0.05, 8)]
)
def test_protuberance_of_a_large_hob_leaves_the_root_of_a_rack_that_has_it(teeth, shift, tip_radius, amount, angle):
    """Within 1 um along the circle; the involute begins where that of the rack does."""
    hob = HobTool(1, 1, 720, 4000.0, 1.25, tip_radius, amount, math.radians(angle))
    of = HobbingJob(Gear(teeth, 1.0, ALPHA, 0.0, shift), 1, hob, 10.0, 0.5)
    radii = np.linspace(teeth / 2 + shift - 1.25 + 0.02, teeth / 2 + shift + 0.9, 40)
    by_hand = by_rack(teeth, shift, radii, tip_radius, amount, math.radians(angle))
    for side in (1, -1):
        np.testing.assert_allclose(root(of, radii, side).half_angle * radii, by_hand * radii, atol=UM)
    tip = teeth / 2 + shift + 1
    begin = math.hypot(form_length(of, math.sqrt(tip**2 - of.base_radius**2)), of.base_radius)
    near = np.linspace(begin - 0.05, begin + 0.05, 21)
    wider = (by_rack(teeth, shift, near, tip_radius, amount, math.radians(angle)) - involute(of, near)) * near
    assert wider[0] > UM
    assert wider[-1] < UM


def involute(of: HobbingJob, radii: np.ndarray) -> np.ndarray:
    """Half the angle of an ideal space of module 1 at radii."""
    at = np.arccos(of.base_radius / radii)
    gear = of.gear
    middle = math.pi / (2 * gear.teeth) - 2 * gear.shift * math.tan(ALPHA) / gear.teeth
    return middle - math.tan(ALPHA) + ALPHA + np.tan(at) - at

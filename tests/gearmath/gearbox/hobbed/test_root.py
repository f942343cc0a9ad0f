"""Root and undercut of a hobbed space: the rolling of a rack with rounded tips, worked out here anew."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearmath.gearbox.dimensions import Gear
from gearmath.gearbox.hobbed.job import HobbingJob, HobTool
from gearmath.gearbox.hobbed.root import root, undercut_radius

UM = 1e-3
ALPHA = math.radians(20)


def job(teeth: int, shift: float, diameter: float = 4000.0, tip_radius: float = 0.38, starts: int = 1) -> HobbingJob:
    gear = Gear(teeth, 1.0, ALPHA, 0.0, shift)
    return HobbingJob(gear, 1, HobTool(starts, 1, 720, diameter, 1.25, tip_radius), 10.0, 0.5)


def by_rack(teeth: int, shift: float, radii: np.ndarray, tip_radius: float = 0.38) -> np.ndarray:
    """Half the angle of the space at radii: a rack of m = 1 rolls on the pitch circle, the farthest of its points."""
    form = 1.25 - tip_radius * (1 - math.sin(ALPHA))
    heights = np.linspace(-1.5, form, 400)
    straight = np.column_stack([heights, math.pi / 4 - heights * math.tan(ALPHA)])
    gamma = np.linspace(ALPHA, math.pi / 2, 300)
    middle = math.pi / 4 - (1.25 - tip_radius) * math.tan(ALPHA) - tip_radius / math.cos(ALPHA)
    rounded = np.column_stack([1.25 - tip_radius * (1 - np.sin(gamma)), middle + tip_radius * np.cos(gamma)])
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

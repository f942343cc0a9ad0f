"""Contact of measured flanks: the spline of deviations, contact beside rolled surfaces and solved draws, refusals."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearmath.bevel.contact.local import MARKING
from gearmath.bevel.contact.marked import marked_area
from gearmath.bevel.contact.mesh import mesh
from gearmath.bevel.contact.pattern import pattern
from gearmath.bevel.contact.places import places
from gearmath.bevel.contact.system import System, pair_system
from gearmath.bevel.flank import blank_grid
from gearmath.engine.points import Points
from gearmath.errors import InputError
from gearmath.quality.contact.flank import MeasuredFlank, flank_with
from gearmath.quality.contact.uncertainty import jacobian, uncertain_contact
from gearmath.specs.bevel_set import BevelSet, load_bevel_set
from gearmath.specs.toml import bundled

SIZES = [("pinion", "concave"), ("gear", "convex")]


def cubic(axial, radial):
    """Of some 20 µm over the NASA pinion."""
    x, y = (axial - 77.0) / 10, (radial - 25.6) / 5
    return 0.008 * x - 0.006 * y + 0.004 * x**2 - 0.005 * x * y + 0.003 * y**2 + 0.002 * x**3 - 0.001 * x * y**2


def flat(member, flank: str, u: float = math.nan, shape: tuple[int, int] = (5, 9)) -> MeasuredFlank:
    grid = blank_grid(member, *shape, 0.1)
    return flank_with(member, flank, grid.axial, grid.radial, np.zeros(shape), np.full(shape, u**2))


@pytest.mark.parametrize("shape", [(5, 9), (4, 7), (9, 15), (31, 41)])
def test_spline_holds_a_cubic_exactly_to_the_edges_of_the_flank(shape: tuple[int, int], gear_set: BevelSet) -> None:
    member = gear_set.pinion
    grid = blank_grid(member, *shape, 0.1)
    one = flank_with(member, "concave", grid.axial, grid.radial, cubic(grid.axial, grid.radial), np.zeros(shape))
    edges = blank_grid(member, 7, 11, 0.0)
    at = np.column_stack([edges.axial.ravel(), edges.radial.ravel()])
    found = [float(one.basis(*place) @ (one.fit @ one.deviation)) for place in at]
    assert found == pytest.approx(cubic(*at.T), abs=1e-9)
    assert np.abs(one.residual).max() < 1e-10


def test_spline_smooths_noise(gear_set: BevelSet) -> None:
    one = flat(gear_set.pinion, "concave", 0.001)
    rows = np.vstack([np.asarray(one.basis(*place)) for place in one.places])
    spread = np.sqrt(np.diag(rows @ one.fit @ one.fit.T @ rows.T))
    # of 45 points 24 functions: the mean square of the fitted noise is 24/45 of that of the points
    assert np.mean(spread**2) == pytest.approx(24 / 45, rel=1e-6)


def test_points_left_out_are_not_needed_but_too_few_are_refused(gear_set: BevelSet) -> None:
    member, shape = gear_set.pinion, (5, 9)
    grid = blank_grid(member, *shape, 0.1)
    deviation = cubic(grid.axial, grid.radial)
    deviation[1, 2] = deviation[4, 8] = math.nan
    one = flank_with(member, "concave", grid.axial, grid.radial, deviation, np.zeros(shape))
    assert np.abs(one.residual).max() < 1e-10
    deviation[:3] = math.nan
    with pytest.raises(InputError, match=r"concave flank: 17 points do not determine a spline of 24 functions"):
        flank_with(member, "concave", grid.axial, grid.radial, deviation, np.zeros(shape))


def test_pattern_and_error_of_a_measured_pinion_are_those_of_its_rolled_surface(rolling, gear_set: BevelSet) -> None:
    member = gear_set.pinion
    grid = blank_grid(member, 5, 9, 0.1)
    one = flank_with(member, "concave", grid.axial, grid.radial, cubic(grid.axial, grid.radial), np.zeros((5, 9)))
    gear = flat(gear_set.gear, "convex")
    run = mesh(pair_system(one.surface, gear.nominal, math.radians(gear_set.shaft_angle)))
    witness = rolling(gear_set, "concave", deviation=cubic)
    for part in (-1.2, -0.4, 0.3, 1.1):
        rotation = part * run.system.pitch
        turn, distance, height = witness.first(rotation)
        (row,) = run.rows(np.array([rotation]))
        assert abs(row.error - run.system.ratio * rotation - turn) < 5e-9  # 0.001 arcsec
        assert math.hypot(row.cone_distance - distance, row.height - height) < 1e-3


def test_propagated_changes_are_those_of_the_exact_contact(uniform_pair) -> None:
    # draws on both flanks, solved again each time; noise is small, so that what is left of second order is too
    pair, u = uniform_pair(106.0, -800.0), 0.0001
    flanks = [flat(pair.member(name), flank, u) for name, flank in SIZES]

    def solved(deviations) -> np.ndarray:
        pinion, gear = (one.with_deviation(part) for one, part in zip(flanks, deviations, strict=True))
        run = mesh(pair_system(pinion, gear, math.radians(90.0)))
        found = pattern(run).figures
        return np.array([found["center_cone_distance_mm"], found["center_height_mm"], run.leads.peak_to_peak]), run

    still, run = solved([np.zeros(45)] * 2)
    rows = jacobian(run, tuple(flanks))
    sure = uncertain_contact(run, tuple(flanks))
    u_each = np.array([sure.center_cone_distance, sure.center_height, sure.peak_to_peak])
    assert u_each == pytest.approx(u * np.linalg.norm(rows, axis=1), rel=1e-12)
    rng = np.random.default_rng(0)
    for _ in range(4):
        deviations = rng.normal(scale=u, size=(2, 45))
        exact = solved(deviations)[0] - still
        # the gap is taken at the rotation of each point's own contact, which at the tip is not quite where it is least
        assert (np.abs(exact - rows @ deviations.ravel()) < 0.25 * u_each).all()
        assert (np.abs(exact) < 4 * u_each).all()


class EasedPair:
    """A pair by its ease-off alone: what deviations do to it is a sum, so that hundreds of draws are soon drawn.

    Center of the pattern and transmission error are as nonlinear in the deviations as those of the exact contact: which
    point of a contact line is first, where one pair of teeth takes over, where the pattern ends.
    """

    SAMPLES = 240

    def __init__(self, system: System, flanks: list[MeasuredFlank]) -> None:
        self.system, self.found = system, places(system, np.zeros(4), 41, 121)
        x, rows = self.found.x.reshape(-1, 7), []
        for side, one in enumerate(flanks):
            point = Points(one.nominal.function)(x[:, 3 * side : 3 * side + 3])[0][:, :, 0]
            radius = np.hypot(point[:, 0], point[:, 1])
            rows.append(Points(one.basis)(point[:, 2:], radius[:, None])[0][:, 0, :] @ one.fit)
        self.by = np.nan_to_num(np.hstack(rows)) / np.abs(self.found.lever.ravel())[:, None]
        self.lead = np.where(self.found.common, system.sense * self.found.error, np.nan)

    def figures(self, deviations: np.ndarray) -> np.ndarray:
        found, pitch, n = self.found, self.system.pitch, self.SAMPLES
        lead = self.lead + (self.by @ deviations.ravel()).reshape(self.lead.shape)
        rotations = np.arange(-2 * n, 2 * n) / n * pitch
        lines = np.full((lead.shape[1], len(rotations)), -np.inf)
        for line, of_rotation, of_lead in zip(lines, found.rotation.T, lead.T, strict=True):
            known = np.isfinite(of_lead) & np.isfinite(of_rotation)
            order = np.argsort(of_rotation[known])
            if len(order) > 1:
                ends = {"left": -np.inf, "right": -np.inf}
                line[:] = np.interp(rotations, of_rotation[known][order], of_lead[known][order], **ends)
        envelope = lines.max(axis=0).reshape(4, n).max(axis=0)
        at = np.nan_to_num(found.rotation) % pitch / pitch * n
        gap = np.abs(found.lever) * (np.interp(at, np.arange(n + 1), [*envelope, envelope[0]]) - lead)
        center = marked_area(found.cone_distance, found.height, gap, MARKING).center
        return np.array([*center, np.ptp(envelope)])


def test_uncertainties_are_the_spread_of_500_draws() -> None:
    # 0.5 µm a point, of a probe: the transmission error of this pair is 8 arcsec, and changes by a third
    pair, u = load_bevel_set(bundled("spiral_7x43.toml")), 0.0005
    flanks = [flat(pair.member(name), flank, u) for name, flank in SIZES]
    system = pair_system(flanks[0].nominal, flanks[1].nominal, math.radians(pair.shaft_angle))
    sure = uncertain_contact(mesh(system), tuple(flanks))
    u_each = np.array([sure.center_cone_distance, sure.center_height, sure.peak_to_peak])
    eased, rng = EasedPair(system, flanks), np.random.default_rng(0)
    draws = np.array([eased.figures(rng.normal(scale=u, size=(2, 45))) for _ in range(500)])
    # the spread of so many is known to 3 %; three times that
    assert draws.std(axis=0, ddof=1) == pytest.approx(u_each, rel=0.1)
    # of 95 %, which 500 draws tell to 1 %
    inside = np.mean(np.abs(draws - eased.figures(np.zeros((2, 45)))) < 2 * u_each, axis=0)
    assert (inside > 0.92).all()

"""Uncertainty: against arithmetic by hand, against draws, and against how often the intervals hold the truth."""

from __future__ import annotations

import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from scipy.stats import binomtest, norm

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.quality.evaluation.member import evaluate_member
from gearmath.quality.evaluation.topography import ORDERS
from gearmath.quality.uncertainty.covariance import Covariance, coverage_factor, independent, stated
from gearmath.quality.uncertainty.figures import Extreme, figures_of
from gearmath.quality.uncertainty.propagation import contenders, uncertain_figures
from gearmath.quality.uncertainty.touch_model import touch_covariance
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.calibration import load_calibration
from gearmath.specs.flank_csv import FlankFile, join
from gearmath.specs.measurement import load_measurement
from gearmath.specs.toml import bundled

SEEDS = 2000
#: Error probability of a whole table of coverage tests.
ALPHA = 1e-3


@pytest.fixture(scope="module")
def measured(gear_set, mill, shop) -> FlankFile:
    """The pinion of the simulated shop, all teeth."""
    return mill(gear_set, "pinion", range(12), shop)


@pytest.fixture(scope="module")
def model(gear_set, measured, vertical) -> Covariance:
    """How well the bundled machine and probe measure it."""
    how, probe = load_measurement(bundled("measurement.toml")), load_calibration(bundled("probe.toml"))
    return touch_covariance(measured, gear_set.pinion, how, vertical, probe)


@pytest.fixture(scope="module")
def evaluation(gear_set, measured):
    return evaluate_member(measured, gear_set.pinion)


@pytest.fixture(scope="module")
def figures(gear_set, measured, evaluation):
    return figures_of(measured, gear_set.pinion, evaluation)


@pytest.fixture(scope="module")
def found(figures, model):
    """Every figure of that pinion, with 20 000 draws."""
    return uncertain_figures(figures, model, draws=20_000, seed=0)


@pytest.fixture(scope="module")
def small(gear_set):
    """A perfect concave flank of the pinion: a grid of 3 x 3 on tooth 0, the reference point on the others."""
    grid = blank_grid(gear_set.pinion, 3, 3)
    files = [nominal_flank(gear_set.pinion, "concave", grid, tooth=k) for k in range(12)]
    file = join([one if k == 0 else one.pick(one.row * 3 + one.col == 4) for k, one in enumerate(files)])
    return replace(file, deviation=np.zeros(len(file)))


def unregistered(gear_set, file, deviation):
    """The figures of the small pinion with these deviations."""
    file = replace(file, point=file.point + deviation[:, None] * file.normal, deviation=deviation)
    return figures_of(file, gear_set.pinion, evaluate_member(file, gear_set.pinion, registered=False))


def by_name(found, flank="concave"):
    return {one.figure.name: one for one in found if one.figure.flank == flank}


def test_figures_are_those_of_the_evaluation(evaluation, figures):
    values = dict(
        zip(
            [(item.flank, item.name) for item in figures.items],
            figures.values,
            strict=True,
        )
    )
    for flank in FLANKS:
        judged = evaluation.flanks[flank]
        assert values[flank, "max_deviation"] == pytest.approx(abs(judged.topographies[0].extreme), abs=1e-15)
        np.testing.assert_allclose(
            [values[flank, f"c_{k}"] for k in range(1, 11)], judged.topographies[0].coefficients, rtol=1e-9, atol=1e-15
        )
        for name in ORDERS:
            assert values[flank, name] == pytest.approx(getattr(judged.orders, name), abs=1e-14)
        np.testing.assert_allclose(
            [values[flank, f"f_pt_{k}"] for k in range(12)], judged.pitch.single, rtol=0, atol=1e-14
        )
        assert values[flank, "F_p"] == pytest.approx(judged.pitch.total, abs=1e-14)
        assert values[flank, "max_f_pt"] == pytest.approx(judged.pitch.largest_single, abs=1e-14)
    seat = evaluation.registration.seat
    assert [values["both", f"eccentricity_{axis}"] for axis in "xy"] == pytest.approx(seat[:2], abs=1e-15)
    assert values["both", "F_r"] == pytest.approx(evaluation.runout.total, abs=1e-14)
    assert values["both", "mean_thickness"] == pytest.approx(evaluation.thickness.mean, abs=1e-14)
    assert values["both", "rotation"] == pytest.approx(evaluation.rotation.angle, abs=1e-15)
    assert not evaluation.registration.tilt_found
    assert ("both", "tilt_x") not in values


def test_extremes_are_the_largest_of_their_differences(figures):
    step = 1e-3 * np.random.default_rng(5).standard_normal(len(figures.deviation))
    assert len(figures.extremes) == 7
    for here in (figures, replace(figures, deviation=figures.deviation + step)):
        for k, extreme in here.extremes.items():
            assert extreme.differences(here.judged).max() == pytest.approx(here.values[k], abs=1e-15)


def test_contenders_are_all_that_can_be_the_largest():
    """By hand: four points of u = 1, one of them far below, and a part in common that tells none from another."""
    base = ca.MX.sym("base", 4)
    extreme = Extreme(ca.Function("base", [base], [base]), np.eye(4), np.arange(4), np.full(4, 4))
    covariance = Covariance(np.ones(4), np.full((4, 1), 100.0), ("common",))
    reach = 9 * math.sqrt(2)
    chosen, u = contenders(extreme, np.array([50.0, 50 - reach + 0.01, 50 - reach - 0.01, 49.0]), covariance)
    assert chosen.tolist() == [0, 1, 3]
    assert u == pytest.approx(math.hypot(1, 100), rel=1e-12)


@pytest.fixture(scope="module")
def dense(gear_set):
    """3 x 5 points on all perfect flanks of the pinion, tooth 0 once more at the end: tilt and drift are told too."""
    grid = blank_grid(gear_set.pinion, 3, 5)
    files = [nominal_flank(gear_set.pinion, flank, grid, tooth=k) for k in range(12) for flank in FLANKS]
    file = join(files + [replace(one, tooth=one.tooth + 12) for one in files[:2]])
    return replace(file, deviation=np.zeros(len(file)))


@pytest.mark.parametrize(("which", "limit"), [("dense", 1e-5), ("measured", 2e-3)])
def test_jacobian_is_the_derivative_of_the_whole_evaluation(gear_set, request, which, limit):
    """Drift, registration and all: a measurement that is shifted at every point, evaluated anew.

    The places of the points count as fixed, and they move with the deviations: of some um in some mm, a part in 1e3.
    """
    file = request.getfixturevalue(which)
    step = 2e-4 * np.random.default_rng(6).standard_normal(len(file))

    def evaluated(change):
        shifted = replace(file, point=file.point + change[:, None] * file.normal, deviation=file.deviation + change)
        return figures_of(shifted, gear_set.pinion, evaluate_member(shifted, gear_set.pinion))

    here = evaluated(0 * step)
    smooth = np.array([item.smooth for item in here.items])
    assert ("tilt_x" in [item.name for item in here.items]) == (which == "dense")
    change = (evaluated(step).values - evaluated(-step).values)[smooth] / 2
    expected = (here.jacobian @ step)[smooth]
    scale = np.sqrt(np.sum(here.jacobian[smooth] ** 2, axis=1)) * 2e-4
    assert np.abs((change - expected) / scale).max() <= limit


def test_drift_is_propagated_with_the_points_that_tell_it(gear_set, small):
    """Tooth 0 measured again: by hand, tooth k of 12 loses k/12 of the difference if the rows are even in time."""
    reference = small.pick((small.row == 1) & (small.col == 1))
    again = reference.pick(reference.tooth == 0)
    file = join([reference, replace(again, tooth=again.tooth + 12)])
    grid = small.pick((small.tooth == 0) & ~((small.row == 1) & (small.col == 1)))
    file = join([file, grid])  # the grid comes last, and has its own share of the drift
    figures = figures_of(file, gear_set.pinion, evaluate_member(file, gear_set.pinion, registered=False))
    f_pt_1 = figures.jacobian[[item.name for item in figures.items].index("f_pt_1")]
    point, normal = reference.point[0], reference.normal[0]
    arc = math.hypot(*point[:2]) / (point[0] * normal[1] - point[1] * normal[0])
    expected = np.zeros(len(file))
    expected[[0, 1, 12]] = np.array([-1 + 1 / 12, 1, -1 / 12]) * arc
    np.testing.assert_allclose(f_pt_1, expected, rtol=0, atol=1e-9)


def test_independent_points_by_hand(gear_set, small):
    """Nine points of 0.6 um: mean 0.2; f_pt of two points, each an arc by the lever of its normal."""
    u = 0.6e-3
    one = by_name(uncertain_figures(unregistered(gear_set, small, np.zeros(20)), independent(np.full(20, u)), 1000))
    assert one["mean"].uncertainty == pytest.approx(u / 3, rel=1e-12)
    point, normal = small.point[small.tooth == 5][0], small.normal[small.tooth == 5][0]
    arc = math.hypot(*point[:2]) / abs(point[0] * normal[1] - point[1] * normal[0])
    for tooth in range(12):
        assert one[f"f_pt_{tooth}"].uncertainty == pytest.approx(math.sqrt(2) * u * arc, rel=1e-9)


def test_what_is_common_to_a_flank_moves_its_mean_and_leaves_its_pitch_alone(gear_set, small):
    common = Covariance(np.zeros(20), np.full((20, 1), 0.4e-3), ("probe calibration",))
    one = by_name(uncertain_figures(unregistered(gear_set, small, np.zeros(20)), common, 1000))
    assert one["mean"].uncertainty == pytest.approx(0.4e-3, rel=1e-12)
    assert one["f_pt_3"].uncertainty < 1e-12
    assert one["F_p"].interval[1] < 1e-12


def test_covariance_is_that_of_a_dense_matrix():
    rng = np.random.default_rng(0)
    J, d, F = rng.normal(size=(4, 9)), rng.uniform(0.1, 1, 9), rng.normal(size=(9, 3))
    covariance = Covariance(d, F, ("a", "b", "a"))
    V = np.diag(d) + sum(np.outer(F[:, k], F[:, k]) for k in range(3))
    np.testing.assert_allclose(covariance.matrix, V, rtol=1e-14)
    np.testing.assert_allclose(covariance.through(J), J @ V @ J.T, rtol=1e-12)
    np.testing.assert_allclose(covariance.standard_uncertainty(J) ** 2, np.diag(J @ V @ J.T), rtol=1e-12)
    index = np.array([5, 0, 7])
    np.testing.assert_allclose(covariance.pick(index).matrix, V[np.ix_(index, index)], rtol=1e-14)
    parts = covariance.budget(J)
    assert set(parts) == {"repeatability", "a", "b"}
    np.testing.assert_allclose(sum(part**2 for part in parts.values()), np.diag(J @ V @ J.T), rtol=1e-12)
    np.testing.assert_allclose(parts["b"], np.abs(J @ F[:, 1]), rtol=1e-12)


def test_noise_is_what_differs_from_point_to_point():
    """Neither what all points share, nor what half of them share; but what each has alone, whatever its name."""
    alone = Covariance(np.full(20, 0.3**2), 0.4 * np.eye(20), ("linear axes",) * 20)
    shared = np.stack([np.ones(20), np.arange(20) < 10], axis=1) * 7.0
    both = Covariance(alone.variance, np.hstack([alone.factors, shared]), (*alone.names, "a", "b"))
    assert independent(np.full(20, 0.3)).noise == pytest.approx(0.3, rel=1e-12)
    assert alone.noise == pytest.approx(0.5, rel=1e-12)
    assert both.noise == pytest.approx(0.5, rel=1e-9)


@pytest.mark.parametrize("probability", [0.5, 0.9, 0.95, 0.997])
def test_coverage_factor_is_that_of_the_normal_distribution(probability):
    assert norm.cdf(coverage_factor(probability)) - norm.cdf(-coverage_factor(probability)) == pytest.approx(
        probability
    )


def test_file_states_its_uncertainty_only_where_it_has_it_at_every_point(small):
    u = np.linspace(1e-4, 1e-3, 20)
    np.testing.assert_allclose(np.sqrt(stated(replace(small, uncertainty=u)).variance), u, rtol=1e-14)
    u[3] = np.nan
    assert stated(replace(small, uncertainty=u)) is None
    left_out = np.where(np.arange(20) == 3, np.nan, 0.0)
    assert stated(replace(small, uncertainty=u, deviation=left_out)).variance[3] == 0


def test_smooth_figures_have_the_spread_of_20000_draws_within_3_percent(found):
    smooth = [one for one in found if one.figure.smooth]
    assert len(smooth) == 2 * (6 + 10 + 12) + 2 + 1 + 1
    worst = max(abs(one.drawn / one.uncertainty - 1) for one in smooth)
    assert worst <= 0.03


def test_maxima_have_their_value_inside_and_the_spread_of_the_draws(found):
    largest = [one for one in found if not one.figure.smooth]
    assert [one.figure.name for one in largest] == [*["max_deviation", "max_f_pt", "F_p"] * 2, "F_r"]
    for one in largest:
        assert one.method == "Monte Carlo"
        assert one.uncertainty == one.drawn
        assert one.interval[0] < one.value < one.interval[1]


@pytest.mark.slow
@pytest.mark.parametrize(("size_um", "seeds"), [(3.0, SEEDS), (0.0, 500)], ids=["gear with errors", "perfect gear"])
def test_95_percent_intervals_hold_the_truth(gear_set, small, size_um, seeds):
    """Exact binomial tests, Bonferroni over the table: exactly 95 % for smooth figures, no less for maxima.

    A perfect gear, here with fewer seeds, is the hardest case for a maximum: every point competes for it.
    """
    truth = size_um / 1000 * np.random.default_rng(0).standard_normal(20)
    covariance = Covariance(np.full(20, 0.5e-3**2), np.full((20, 1), 0.3e-3), ("probe calibration",))
    figures = unregistered(gear_set, small, truth)
    true = figures.values
    held = np.zeros(len(true), dtype=int)
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        deviation = truth + 0.5e-3 * rng.standard_normal(20) + 0.3e-3 * rng.standard_normal()
        here = replace(figures, deviation=deviation)  # without registration all of it is linear
        found = uncertain_figures(here, covariance, 250, seed, workers=1)
        held += [low <= value <= high for (low, high), value in zip((u.interval for u in found), true, strict=True)]
    table = {
        item.name: (count / seeds, binomtest(int(count), seeds, 0.95, "two-sided" if item.smooth else "less").pvalue)
        for item, count in zip(figures.items, held, strict=True)
    }
    assert len(table) == 6 + 3 + 12 + 3
    assert min(p for _, p in table.values()) >= ALPHA / len(table), table


def test_bundled_model_is_covered_too(figures, model):
    """All correlated parts of the bundled model at once: the smooth figures, whose intervals need no draws."""
    smooth = np.array([item.smooth for item in figures.items])
    half = coverage_factor(0.95) * model.standard_uncertainty(figures.jacobian[smooth])
    root = np.concatenate([np.diag(np.sqrt(model.variance)), model.factors], axis=1)
    noise = np.stack([np.random.default_rng(seed).standard_normal(root.shape[1]) for seed in range(SEEDS)], axis=1)
    judged = figures.judging.map(SEEDS)(figures.deviation[:, None] + root @ noise)
    off = np.array(figures.of_judged.map(SEEDS)(judged))
    held = (np.abs(off - figures.values[:, None])[smooth] <= half[:, None]).sum(axis=1)
    assert min(binomtest(int(count), SEEDS, 0.95).pvalue for count in held) >= ALPHA / len(held)

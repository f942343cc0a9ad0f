"""Uncertainty: against arithmetic by hand, against draws, and against how often the intervals hold the truth."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binomtest, norm

from gearmath.quality.covariance import Covariance, coverage_factor, independent, stated
from gearmath.quality.figures import figures_of
from gearmath.quality.pitch import evaluate_pitch
from gearmath.quality.topography import evaluate_topography
from gearmath.quality.touch_model import touch_covariance
from gearmath.quality.uncertainty import uncertain_figures
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.calibration import load_calibration
from gearmath.specs.flank_csv import FlankFile
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
    return touch_covariance(measured, gear_set.pinion, "pinion", how, vertical, probe)


@pytest.fixture(scope="module")
def found(measured, model):
    """Every figure of that pinion, with 20 000 draws."""
    return uncertain_figures(figures_of(measured, 12), measured.deviation, model, draws=20_000, seed=0)


def with_deviation(file: FlankFile, deviation: np.ndarray) -> FlankFile:
    return replace(file, deviation=deviation)


def by_name(found, flank="concave"):
    return {one.figure.name: one for one in found if one.figure.flank == flank}


def test_figures_are_those_of_topography_and_pitch(measured):
    figures = figures_of(measured, 12)
    values = dict(zip(
        [(item.flank, item.name) for item in figures.items], np.array(figures.function(measured.deviation)).ravel(),
        strict=True,
    ))  # fmt: skip
    for flank in FLANKS:
        topography, pitch = evaluate_topography(measured, flank), evaluate_pitch(measured, 12, flank)
        assert values[flank, "mean"] == pytest.approx(topography.deviation.mean(), abs=1e-15)
        assert values[flank, "max_deviation"] == abs(topography.extreme)
        np.testing.assert_allclose(
            [values[flank, f"c_{k}"] for k in range(1, 11)], topography.coefficients, rtol=1e-9, atol=1e-15
        )
        np.testing.assert_allclose([values[flank, f"f_pt_{k}"] for k in range(12)], pitch.single, rtol=0, atol=1e-15)
        assert values[flank, "F_p"] == pytest.approx(pitch.total, abs=1e-15)
        assert values[flank, "max_f_pt"] == pytest.approx(np.abs(pitch.single).max(), abs=1e-15)


def test_figures_are_the_largest_of_their_forms(measured):
    figures = figures_of(measured, 12)
    values = np.array(figures.function(measured.deviation)).ravel()
    assert len(figures.forms) == 6
    for k, forms in figures.forms.items():
        assert (forms @ measured.deviation).max() == pytest.approx(values[k], abs=1e-15)


def test_independent_points_by_hand(small_gear):
    """Nine points of 0.6 um: mean 0.2; f_pt from two points with arc = delta 50 / 40; a plane by its moments."""
    u = 0.6e-3
    one = by_name(uncertain_figures(figures_of(small_gear, 8), small_gear.deviation, independent(np.full(16, u)), 2000))
    assert one["mean"].uncertainty == pytest.approx(u / 3, rel=1e-12)
    for tooth in range(8):
        # (z_w x R)·n = 50 * 0.8: the arc is 1 / 0.8 of the deviation
        assert one[f"f_pt_{tooth}"].uncertainty == pytest.approx(math.sqrt(2) * u / 0.8, rel=1e-12)
    assert one["c_2"].uncertainty == pytest.approx(u / math.sqrt(3 * 2 * 5.0**2), rel=1e-12)
    assert one["c_3"].uncertainty == pytest.approx(u / math.sqrt(3 * 2 * 2.0**2), rel=1e-12)


def test_what_is_common_to_a_flank_moves_its_mean_and_leaves_its_pitch_alone(small_gear):
    common = Covariance(np.zeros(16), np.full((16, 1), 0.4e-3), ("probe calibration",))
    one = by_name(uncertain_figures(figures_of(small_gear, 8), small_gear.deviation, common, 2000))
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


@pytest.mark.parametrize("probability", [0.5, 0.9, 0.95, 0.997])
def test_coverage_factor_is_that_of_the_normal_distribution(probability):
    assert norm.cdf(coverage_factor(probability)) - norm.cdf(-coverage_factor(probability)) == pytest.approx(
        probability
    )


def test_file_states_its_uncertainty_only_where_it_has_it_at_every_point(small_gear):
    u = np.linspace(1e-4, 1e-3, 16)
    np.testing.assert_allclose(np.sqrt(stated(replace(small_gear, uncertainty=u)).variance), u, rtol=1e-14)
    u[3] = np.nan
    assert stated(replace(small_gear, uncertainty=u)) is None


def test_smooth_figures_have_the_spread_of_20000_draws_within_3_percent(found):
    smooth = [one for one in found if one.figure.smooth]
    assert len(smooth) == 2 * (11 + 12)
    worst = max(abs(one.drawn / one.uncertainty - 1) for one in smooth)
    assert worst <= 0.03


def test_maxima_have_their_value_inside_and_the_spread_of_the_draws(found):
    largest = [one for one in found if not one.figure.smooth]
    assert [one.figure.name for one in largest] == ["max_deviation", "max_f_pt", "F_p"] * 2
    for one in largest:
        assert one.method == "Monte Carlo"
        assert one.uncertainty == one.drawn
        assert one.interval[0] < one.value < one.interval[1]


def coverage(file, teeth, truth, covariance, draws):
    """How many of the intervals of SEEDS simulated measurements hold the true figures (m,)."""
    figures = figures_of(file, teeth)
    true = np.array(figures.function(truth)).ravel()
    root = np.concatenate([np.diag(np.sqrt(covariance.variance)), covariance.factors], axis=1)
    held = np.zeros(len(true), dtype=int)
    for seed in range(SEEDS):
        noise = root @ np.random.default_rng(seed).standard_normal(root.shape[1])
        found = uncertain_figures(figures, truth + noise, covariance, draws, seed, workers=1)
        held += [low <= value <= high for (low, high), value in zip((u.interval for u in found), true, strict=True)]
    return figures.items, held


@pytest.mark.slow
@pytest.mark.parametrize("size_um", [0.0, 3.0], ids=["perfect gear", "gear with errors"])
def test_95_percent_intervals_hold_the_truth(small_gear, size_um):
    """Exact binomial tests, Bonferroni over the table: exactly 95 % for smooth figures, no less for maxima.

    A perfect gear is the hardest case for a maximum: every point competes for it.
    """
    truth = size_um / 1000 * np.random.default_rng(0).standard_normal(16)
    covariance = Covariance(np.full(16, 0.5e-3**2), np.full((16, 1), 0.3e-3), ("probe calibration",))
    items, held = coverage(small_gear, 8, truth, covariance, draws=250)
    table = {
        item.name: (count / SEEDS, binomtest(int(count), SEEDS, 0.95, "two-sided" if item.smooth else "less").pvalue)
        for item, count in zip(items, held, strict=True)
    }
    assert len(table) == 15
    assert min(p for _, p in table.values()) >= ALPHA / (2 * len(table)), table


def test_bundled_model_is_covered_too(measured, model):
    """All correlated parts of the bundled model at once: the smooth figures, whose intervals need no draws."""
    figures = figures_of(measured, 12)
    smooth = np.array([item.smooth for item in figures.items])
    J = figures.jacobian(measured.deviation)[smooth]
    half = coverage_factor(0.95) * model.standard_uncertainty(J)
    root = np.concatenate([np.diag(np.sqrt(model.variance)), model.factors], axis=1)
    noise = np.stack([np.random.default_rng(seed).standard_normal(root.shape[1]) for seed in range(SEEDS)], axis=1)
    off = np.array(figures.function.map(SEEDS)(measured.deviation[:, None] + root @ noise))
    true = np.array(figures.function(measured.deviation))
    held = (np.abs(off - true)[smooth] <= half[:, None]).sum(axis=1)
    assert min(binomtest(int(count), SEEDS, 0.95).pvalue for count in held) >= ALPHA / len(held)

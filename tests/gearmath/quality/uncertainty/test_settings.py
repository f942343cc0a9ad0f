"""Uncertainty of corrected settings: against identifications of shifted measurements, and against draws."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binomtest

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.identify.compensation import identify, with_deviations
from gearmath.bevel.identify.flank_target import FlankTarget, located
from gearmath.errors import ComputationError
from gearmath.quality.correction.analysis import analyse
from gearmath.quality.correction.batch import compensation_kernel
from gearmath.quality.correction.target import flank_target, target_of
from gearmath.quality.evaluation.topography import local_coordinates
from gearmath.quality.uncertainty.covariance import Covariance, coverage_factor, independent
from gearmath.quality.uncertainty.settings import exact_gain, rows_of, setting_uncertainty
from gearmath.quality.uncertainty.study import monte_carlo, parameter_study, run
from gearmath.specs.bevel_set import FLANKS, MEMBERS, load_bevel_set
from gearmath.specs.toml import bundled

SETS = ("nasa_tp3096_12x36.toml", "crown_gear_hobbed_14x39.toml", "crown_gear_formate_14x39.toml")
NOISE = 0.5e-3
SEEDS, ALPHA = 2000, 1e-3
#: Four settings that a flank of the NASA pinion tells apart.
FREE = ("radial_distance", "cradle_angle", "machine_center_to_crossing_point", "machine_root_angle")


def target(spec, flank, rows=5, columns=9) -> FlankTarget:
    nominal = solve_flank(spec, flank, blank_grid(spec, rows, columns))
    along, up = local_coordinates(nominal.point.reshape(rows, columns, 3), (rows // 2, columns // 2))
    return target_of(spec, flank, nominal, np.stack([along.ravel(), up.ravel()], axis=1))


def measured(one: FlankTarget, errors: dict[str, float], seed=0, noise=NOISE) -> FlankTarget:
    """What wrong settings leave, with noise."""
    from gearmath.bevel.identify.variables import NAMES

    vector = one.vector.copy()
    for name, value in errors.items():
        vector[NAMES.index(name)] += value
    deviation, _, failed = located(one, vector)
    assert not failed.any()
    return replace(one, deviation=deviation + noise * np.random.default_rng(seed).standard_normal(len(deviation)))


def differences(targets, free, directions, h=2e-6, **how):
    """Change of the identified values per mm along directions (k,m), by central differences of whole identifications.

    A solution is found to about 1e-7 of its residual, which over 2 h leaves a few parts in 1e5 of the change.
    """
    at = np.concatenate([one.deviation for one in targets])

    def values(d):
        return identify(with_deviations(targets, d), free, **how).values

    return np.array([(values(at + h * e) - values(at - h * e)) / (2 * h) for e in directions])


@pytest.mark.parametrize("name", SETS)
@pytest.mark.parametrize("member", MEMBERS)
def test_gain_is_the_derivative_of_the_identification(name, member):
    """Both flanks together, the settings that suit the cutting method, weak directions damped by the noise."""
    spec = load_bevel_set(bundled(name)).member(member)
    targets = [
        measured(target(spec, flank), {"radial_distance": 0.02, "machine_root_angle": 1e-4}, seed)
        for seed, flank in enumerate(FLANKS)
    ]
    free = analyse(targets).choose().names
    found = identify(targets, free)
    gain = exact_gain(targets, found)
    directions = np.random.default_rng(3).standard_normal((3, len(found.residual)))
    expected = differences(targets, free, directions) / found.scale
    assert np.abs(directions @ gain.T / found.scale - expected).max() <= 1e-4 * np.abs(expected).max()


@pytest.mark.parametrize(
    ("free", "how"),
    [
        (FREE, {"objective": "surface"}),
        (FREE, {"noise": NOISE}),
        ((*FREE, "blank_offset", "sliding_base", "ratio_of_roll"), {"noise": NOISE}),
        (("machine_center_to_crossing_point", "work_rotation_offset.2", "sliding_base.1"), {}),
    ],
    ids=["surface", "damped", "all settings, damped", "motions"],
)
def test_gain_is_the_derivative_whatever_is_fitted(gear_set, free, how):
    one = measured(target(gear_set.pinion, "concave"), {"radial_distance": 0.02, "sliding_base": 0.01})
    found = identify([one], free, **how)
    directions = np.random.default_rng(3).standard_normal((3, 45))
    expected = differences([one], free, directions, **how) / found.scale
    exact = directions @ exact_gain([one], found).T / found.scale
    assert np.abs(exact - expected).max() <= 1e-3 * np.abs(expected).max()


def test_curvature_is_the_difference_to_the_linear_gain(gear_set):
    """With some um that no setting explains, the gain without curvature is off by 0.4 %, the exact one is not."""
    one = measured(target(gear_set.pinion, "concave"), {"radial_distance": 0.02})
    col = np.indices((5, 9))[1].ravel()
    one = one.plus(0.01 * ((col - 4) / 4.0) ** 4)
    found = identify([one], FREE, noise=NOISE)
    assert found.rms_after > 3e-3
    directions = np.random.default_rng(3).standard_normal((3, 45))
    expected = differences([one], FREE, directions, noise=NOISE) / found.scale
    size = np.abs(expected).max()
    assert np.abs(directions @ exact_gain([one], found).T / found.scale - expected).max() <= 1e-4 * size
    assert np.abs(directions @ found.gain.T / found.scale - expected).max() > 1e-3 * size


def test_what_a_bound_holds_does_not_move_and_the_others_know_it(gear_set):
    """The root angle is off by more than its bound: it stays there, and the others are those of a fit without it."""
    one = measured(target(gear_set.pinion, "concave"), {"machine_root_angle": 0.03})
    found = identify([one], FREE)
    assert found.active == ("machine_root_angle",)
    gain = exact_gain([one], found)
    assert not gain[FREE.index("machine_root_angle")].any()
    directions = np.random.default_rng(3).standard_normal((2, 45))
    expected = differences([one], FREE, directions) / found.scale
    assert np.abs(directions @ gain.T / found.scale - expected).max() <= 1e-3 * np.abs(expected).max()
    known = setting_uncertainty([one], found, independent(np.full(45, NOISE)))
    assert known.held == ("machine_root_angle",)
    assert known.standard[FREE.index("machine_root_angle")] == 0


def test_root_line_at_its_limit_holds_the_settings_too(gear_set):
    """Sunk by more than it may: the fit without the root line is another, and the gain is that of the one with it."""
    one = measured(target(gear_set.pinion, "concave"), {"sliding_base": 0.2})
    free, limit = ("radial_distance", "cradle_angle", "sliding_base"), 0.05
    found = identify([one], free, root_limit=limit)
    assert found.active == ("root line",)
    directions = np.random.default_rng(3).standard_normal((2, 45))
    expected = differences([one], free, directions, root_limit=limit) / found.scale
    size = np.abs(expected).max()
    assert np.abs(directions @ exact_gain([one], found, limit).T / found.scale - expected).max() <= 2e-3 * size
    assert np.abs(directions @ exact_gain([one], found).T / found.scale - expected).max() > 0.1 * size


def test_settings_that_the_flank_does_not_tell_apart_are_refused(gear_set):
    """Turning the cradle and turning the work do the same to a generated flank, unless noise says not to move them."""
    one = measured(target(gear_set.pinion, "concave"), {"cradle_angle": 1e-4})
    alike = ("cradle_angle", "work_rotation_offset")
    with pytest.raises(ComputationError, match="do not determine the settings"):
        exact_gain([one], identify([one], alike))
    assert np.isfinite(exact_gain([one], identify([one], alike, noise=NOISE))).all()


@pytest.fixture(scope="module")
def drawn(gear_set):
    """A flank of the pinion on 3 x 5 points, its settings found again in 20 000 draws of the noise."""
    errors = {"radial_distance": 0.03, "machine_root_angle": 2e-4}
    targets = [measured(target(gear_set.pinion, "concave", 3, 5), errors)]
    covariance = Covariance(np.full(15, NOISE**2), np.full((15, 1), 0.3e-3), ("probe calibration",))
    found = identify(targets, FREE, noise=NOISE)
    kernel = compensation_kernel(targets, FREE, noise=NOISE, steps=2)
    study = monte_carlo(covariance.drawn(_from(kernel, found.values), found_at(targets)), 20_000)
    return targets, found, covariance, run(study)


def found_at(targets):
    return np.concatenate([one.deviation for one in targets])


def _from(kernel, start):
    """The Kernel as a function of the deviations alone: values, then what remains."""
    import casadi as ca

    d = ca.MX.sym("measured", kernel.function.size1_in(0))
    return ca.Function("identified", [d], [ca.vertcat(*kernel.function(d, ca.DM(start)))])


@pytest.mark.slow
def test_settings_and_what_remains_have_the_spread_of_20000_draws_within_3_percent(drawn):
    targets, found, covariance, draws = drawn
    known = setting_uncertainty(targets, found, covariance)
    spread = draws.std(axis=0, ddof=1)
    np.testing.assert_allclose(draws.mean(axis=0)[:4], found.values, rtol=0, atol=0.05 * known.standard.max())
    assert np.abs(spread[:4] / known.standard - 1).max() <= 0.03
    assert np.abs(spread[4:] / known.remaining - 1).max() <= 0.03
    correlation = np.corrcoef(draws[:, :4].T)
    np.testing.assert_allclose(
        known.covariance / np.outer(known.standard, known.standard), correlation, rtol=0, atol=0.03
    )


@pytest.mark.slow
def test_few_steps_from_the_solution_are_the_whole_identification(drawn):
    """The first draws once more, by the solver itself."""
    targets, found, covariance, draws = drawn
    children = np.random.SeedSequence(0).spawn(1)
    z = np.random.default_rng(children[0]).standard_normal((16, 250))[:, :5]
    root = np.concatenate([np.diag(np.sqrt(covariance.variance)), covariance.factors], axis=1)
    for k, deviations in enumerate((found_at(targets)[:, None] + root @ z).T):
        whole = identify(with_deviations(targets, deviations), FREE, noise=NOISE)
        assert (
            np.abs((whole.values - draws[k, :4]) / found.scale).max() <= 1e-3 * np.abs(found.values / found.scale).max()
        )


@pytest.mark.slow
def test_95_percent_intervals_of_settings_hold_the_truth(gear_set):
    """Exact binomial tests over 2000 seeds, Bonferroni over the table; the truth is what the flank was cut with."""
    one = target(gear_set.pinion, "concave", 3, 5)
    errors = {"radial_distance": 0.03, "machine_root_angle": 2e-4}
    true = np.array([errors.get(name, 0.0) for name in FREE])
    exact = measured(one, errors, noise=0.0)
    covariance = independent(np.full(15, NOISE))
    known = setting_uncertainty([exact], identify([exact], FREE), covariance)
    noise = np.stack([np.random.default_rng(seed).standard_normal(15) for seed in range(SEEDS)])
    function = _from(compensation_kernel([one], FREE, steps=3), true)
    values = run(parameter_study(function, exact.deviation + NOISE * noise))[:, : len(FREE)]
    held = (np.abs(values - true) <= coverage_factor(0.95) * known.standard).sum(axis=0)
    assert min(binomtest(int(count), SEEDS, 0.95).pvalue for count in held) >= ALPHA / len(held)


def test_rows_of_a_target_are_its_points_in_a_file_of_any_order(gear_set, mill):
    file = mill(gear_set, "pinion", (0, 1))
    mixed = file.pick(np.random.default_rng(4).permutation(len(file)))
    excluded = (mixed.row == 1) & (mixed.col == 3)
    for flank in FLANKS:
        one = flank_target(gear_set.pinion, flank, mixed, excluded=excluded)
        rows = rows_of(mixed, flank, one)
        assert len(rows) == 44
        np.testing.assert_array_equal(mixed.deviation[rows], one.deviation)
        assert set(mixed.flank[rows]) == {flank}

"""Many measurements at once, and the identification as one Kernel: both must find what one at a time finds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.identify.compensation import identify, with_deviations
from gearmath.bevel.identify.variables import free_settings
from gearmath.quality.correction.batch import compensation_kernel, identify_many
from gearmath.quality.correction.target import target_of
from gearmath.specs.bevel_set import FLANKS, load_bevel_set
from gearmath.specs.toml import bundled

NOISE = 0.5e-3


@pytest.fixture(scope="module", params=["nasa_tp3096_12x36", "crown_gear_formate_14x39", "crown_gear_hobbed_14x39"])
def case(request):
    """Both flanks of a gear, its free settings, and five measurements: a smooth error of 20 um with noise."""
    gear = load_bevel_set(bundled(f"{request.param}.toml")).gear
    grid = blank_grid(gear)
    targets = [replace(target_of(gear, f, solve_flank(gear, f, grid)), root=None) for f in FLANKS]
    row, col = (np.tile(index.ravel(), 2) for index in np.indices((5, 9)))
    smooth = 5e-3 * (row - 2) - 2e-3 * (col - 4) + 0.3e-3 * (row - 2) * (col - 4)
    random = np.random.default_rng(0)
    return targets, free_settings(gear), smooth + NOISE * random.standard_normal((5, 90))


@pytest.mark.parametrize("objective", ["points", "surface"])
def test_many_at_once_are_found_as_one_by_one(host_compiler, case, objective):
    targets, free, deviations = case
    row, col = (index.ravel() for index in np.indices((5, 9)))
    targets = [replace(target, place=np.stack([2.5 * (col - 4.0), 1.2 * (row - 2.0)], axis=1)) for target in targets]
    many = identify_many(targets, deviations, free, objective=objective, noise=NOISE)
    assert many.converged.all()
    for one, values, residual in zip(deviations, many.values, many.residual, strict=True):
        found = identify(with_deviations(targets, one), free, objective=objective, noise=NOISE)
        np.testing.assert_allclose(residual, found.residual, rtol=0, atol=1e-6)
        np.testing.assert_allclose(values / found.scale, found.values / found.scale, rtol=0, atol=1e-3)


def test_kernel_of_the_whole_identification_finds_the_same_and_can_be_mapped(host_compiler, case):
    targets, free, deviations = case
    many = identify_many(targets, deviations, free, noise=NOISE)
    kernel = compensation_kernel(targets, free, noise=NOISE)
    values, remaining = kernel(deviations, np.zeros(7))
    np.testing.assert_allclose(remaining, many.residual, rtol=0, atol=1e-6)
    np.testing.assert_allclose(values, many.values, rtol=0, atol=1e-4)
    threads = kernel.function.map(5, "thread", 2)
    by_threads = threads(deviations.T, np.zeros((7, 5)))[1]
    np.testing.assert_array_equal(np.asarray(by_threads).T, remaining)
    compiled = kernel(deviations, np.zeros(7))
    np.testing.assert_allclose(compiled[1], remaining, rtol=0, atol=1e-12)


def test_motions_are_not_for_the_kernel(case):
    targets, _, _ = case
    with pytest.raises(ValueError, match="free settings only"):
        compensation_kernel(targets, ("sliding_base.1",))


def test_gain_is_how_the_values_follow_the_measurement(host_compiler, case):
    """Central differences of whole identifications, in two random directions of the deviations."""
    targets, free, deviations = case
    found = identify(with_deviations(targets, deviations[0]), free, noise=NOISE)
    for direction in np.random.default_rng(1).standard_normal((2, 90)):
        step = 1e-4 * direction
        up, down = (
            identify(with_deviations(targets, deviations[0] + sign * step), free, noise=NOISE).values
            for sign in (1, -1)
        )
        expected = (up - down) / 2 / found.scale
        followed = found.gain @ step / found.scale
        # without the curvature of the flank: setting_uncertainty.exact_gain has it
        assert np.abs(followed - expected).max() <= 0.03 * np.abs(expected).max()

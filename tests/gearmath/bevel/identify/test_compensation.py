"""Sensitivities and identification: against re-solved surfaces, known errors, and measurements of every kind."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from gearmath.bevel.flank import FlankPoints, blank_grid, solve_places
from gearmath.bevel.generation import Generation
from gearmath.bevel.identify.compensation import identify
from gearmath.bevel.identify.flank_target import FlankTarget, predicted
from gearmath.bevel.identify.variables import BOUNDS, FREE
from gearmath.errors import ComputationError
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import FLANKS, MEMBERS, SETTINGS, SIDES

each_flank = pytest.mark.parametrize(("member", "flank"), [(m, f) for m in MEMBERS for f in FLANKS])
#: Steps of the finite differences: each shifts the flank by about a micrometre.
STEP = {
    "radial_distance": 1e-3,
    "blank_offset": 1e-3,
    "sliding_base": 1e-3,
    "machine_center_to_crossing_point": 1e-3,
    "blade_point_radius": 1e-3,
}


def target_of(gear_set, member, flank, deviation=0.0, tilt=0.0, rows=5, columns=9) -> FlankTarget:
    spec = gear_set.member(member).flank(flank)
    deeper = {"cutter_tilt": tilt, "cutter_swivel": 8 * tilt, "sliding_base": spec.sliding_base - tilt}
    settings = spec.model_copy(update=deeper).vector
    grid = blank_grid(gear_set.member(member), rows, columns)
    points, residual = solve_places(settings, SIDES[flank], grid.axial.ravel(), grid.radial.ravel())
    assert residual.max() < 1e-9
    return FlankTarget(Generation(settings, SIDES[flank]), points, np.broadcast_to(deviation, len(points.point)))


@each_flank
def test_sensitivities_are_finite_differences_of_re_solved_surfaces(gear_set, witness, member, flank):
    """Twice: the envelope theorem and the implicit function theorem, against brute force on the cradle machine.

    With tilt, so that the swivel counts too. Fourth-order differences; 1e-6 of the largest element of each column.
    """
    target = target_of(gear_set, member, flank, tilt=2.0, rows=2, columns=3)
    nominal = target.nominal
    (by_theorem,) = kernel("setting_sensitivity")(*nominal.contact.T, target.settings, target.how.side)
    deviation, by_gradient = predicted(target, target.settings)
    np.testing.assert_allclose(deviation, 0, atol=1e-9)

    def left(k, change):
        settings = target.settings.copy()
        settings[k] += change
        start = nominal.contact[:, 2]
        return witness.left_by_cradle(settings, target.how.side, nominal.point, nominal.normal, start, 0.03, 6)[0]

    for k, name in enumerate(SETTINGS):
        h = STEP.get(name, 2e-5) * 4
        differences = (8 * (left(k, h) - left(k, -h)) - (left(k, 2 * h) - left(k, -2 * h))) / (12 * h)
        limit = 1e-6 * np.abs(differences).max()
        assert np.abs(by_theorem[:, k] - differences).max() <= limit, name
        assert np.abs(by_gradient[:, k] - differences).max() <= limit, name


@each_flank
def test_predicted_deviation_is_what_the_cradle_machine_leaves(gear_set, shop, witness, member, flank):
    target = target_of(gear_set, member, flank)
    wrong = target.settings + shop.setting_errors(member)
    deviation, _ = predicted(target, wrong)
    left, _ = witness.left_by_cradle(
        wrong, target.how.side, target.nominal.point, target.nominal.normal, target.nominal.contact[:, 2]
    )
    np.testing.assert_allclose(deviation, left, rtol=0, atol=1e-9)


@each_flank
def test_known_setting_errors_are_explained_to_the_last_digit(gear_set, shop, member, flank):
    target = target_of(gear_set, member, flank)
    deviation, _ = predicted(target, target.settings + shop.setting_errors(member))
    found = identify([replace(target, deviation=deviation)])
    assert found.rms_before > 3e-3
    assert found.rms_after < 1e-6  # mm: what they leave, not which they are; some settings do nearly the same
    explained, _ = predicted(target, target.settings + found.errors)
    np.testing.assert_allclose(explained, deviation, rtol=0, atol=5e-6)


def test_only_free_settings_are_changed(gear_set):
    target = target_of(gear_set, "pinion", "concave", 0.01)
    found = identify([target], ("radial_distance", "ratio_of_roll"))
    changed = [name for name, error in zip(SETTINGS, found.errors, strict=True) if error]
    assert changed == ["radial_distance", "ratio_of_roll"]
    assert len(found.singular_values) == 2
    held = [name for name, error in zip(SETTINGS, identify([target]).errors, strict=True) if error and name not in FREE]
    assert held == []


def test_perfect_measurement_needs_no_correction(gear_set):
    for member in MEMBERS:
        for flank in FLANKS:
            found = identify([target_of(gear_set, member, flank)])
            assert found.rms_before == 0
            assert np.abs(found.errors).max() < 1e-9
            assert found.rms_after < 1e-9


@given(st.sampled_from(MEMBERS), st.sampled_from(FLANKS), st.floats(0, 0.3), st.integers(0, 10**6), st.booleans())
@hypothesis_settings(max_examples=40)
def test_identification_keeps_within_its_bounds_and_never_makes_the_fit_worse(
    gear_set, member, flank, size, seed, smooth
):
    """Noise and tilted planes of up to 0.3 mm, far more than settings can explain."""
    generator = np.random.default_rng(seed)
    if smooth:
        up, along = (index.ravel() - middle for index, middle in zip(np.indices((5, 9)), (2, 4), strict=True))
        a, b, c = size / 3 * generator.uniform(-1, 1, 3)
        deviation = a + b * up / 2 + c * along / 4
    else:
        deviation = size * generator.uniform(-1, 1, 45)
    found = identify([target_of(gear_set, member, flank, deviation)])
    for name, change in zip(SETTINGS, found.errors, strict=True):
        assert abs(change) <= BOUNDS.get(name, 0.0) * (1 + 1e-12)
    assert found.rms_after <= found.rms_before + 1e-12  # rounding


def test_surface_that_misses_a_normal_is_a_failure_by_its_point(gear_set):
    target = target_of(gear_set, "gear", "convex")
    far = target.settings.copy()
    far[SETTINGS.index("sliding_base")] += 400.0
    with pytest.raises(ComputationError, match=r"^the flank of the changed settings does not cross .* of point 0$"):
        predicted(target, far)


def test_point_that_is_no_number_is_a_failure_by_its_point(gear_set):
    target = target_of(gear_set, "gear", "convex")
    point = target.nominal.point.copy()
    point[7, 1] = np.nan
    nominal = FlankPoints(target.nominal.contact, point, target.nominal.normal)
    with pytest.raises(ComputationError, match=r"of point 7$"):
        predicted(replace(target, nominal=nominal), target.settings)

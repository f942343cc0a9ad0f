"""What a correction can do, said beforehand: against plain linear algebra, and against what is then done."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.generation import solve_section
from gearmath.bevel.identify.compensation import identify
from gearmath.bevel.identify.flank_target import predicted
from gearmath.bevel.identify.variables import FREE, free_settings
from gearmath.bevel.method import blade_sections
from gearmath.errors import InputError
from gearmath.quality.correction.analysis import analyse, projection_residual
from gearmath.quality.correction.target import target_of
from gearmath.specs.bevel_set import FLANKS, MACHINE_SETTINGS, MEMBERS, SETTINGS, load_bevel_set
from gearmath.specs.toml import bundled


@pytest.fixture(scope="module")
def target(gear_set):
    nominal = solve_flank(gear_set.pinion, "concave", blank_grid(gear_set.pinion))
    return replace(target_of(gear_set.pinion, "concave", nominal), root=None)


def off(target, **changes):
    settings = target.settings.copy()
    for name, change in changes.items():
        settings[SETTINGS.index(name)] += change
    return replace(target, deviation=predicted(target, settings)[0])


def ripple(size):
    row, col = (index.ravel() for index in np.indices((5, 9)))
    return size * np.sin(2.5 * row + 1.9 * col)


def test_best_residual_is_what_least_squares_leaves(target):
    analysis = analyse([replace(target, deviation=ripple(0.004))])
    _, left, rank, _ = np.linalg.lstsq(analysis.jacobian, ripple(0.004), rcond=1e-6)
    assert rank == analysis.rank == 7
    assert analysis.best_rms == pytest.approx(np.sqrt(left[0] / 45), rel=1e-9)
    assert analysis.best_rms <= analysis.rms
    np.testing.assert_allclose(analysis.jacobian.T @ projection_residual(analysis.jacobian, ripple(1.0)), 0, atol=1e-9)


def test_no_correction_gets_below_what_was_said(target):
    measured = replace(target, deviation=off(target, radial_distance=0.03).deviation + ripple(0.003))
    analysis, found = analyse([measured]), identify([measured])
    assert found.rms_after >= analysis.best_rms * (1 - 1e-3)
    bounded = lsq_linear(analysis.jacobian, measured.deviation, (-1, 1), tol=1e-14, max_iter=1000)
    assert found.rms_after == pytest.approx(np.sqrt(np.mean(bounded.fun**2)), rel=5e-3)


def test_cradle_angle_and_work_rotation_are_said_to_be_one(target):
    """Face milling with settings at rest: turning the cradle's zero by q turns the work by -R_a q, and nothing else."""
    analysis = analyse([target], ("cradle_angle", "work_rotation_offset", "radial_distance", "blank_offset"))
    ((first, second, cosine),) = [pair for pair in analysis.alike if "work_rotation_offset" in pair]
    assert {first, second} == {"cradle_angle", "work_rotation_offset"}
    assert abs(cosine) == pytest.approx(1, abs=1e-12)
    assert analysis.rank == 3
    named = analysis.direction(3)
    ratio = target.settings[SETTINGS.index("ratio_of_roll")]
    assert set(named) == {"cradle_angle", "work_rotation_offset"}
    assert abs(named["work_rotation_offset"] / named["cradle_angle"]) == pytest.approx(ratio, rel=1e-6)


def test_settings_without_effect_are_named(target):
    """No tilt: the swivel turns nothing. Formate: no roll, no ratio."""
    assert analyse([target], MACHINE_SETTINGS).unseen == ("cutter_swivel",)
    formate = load_bevel_set(bundled("crown_gear_formate_14x39.toml")).gear
    nominal = solve_flank(formate, "convex", blank_grid(formate))
    assert "ratio_of_roll" in analyse([target_of(formate, "convex", nominal)], FREE).unseen
    assert "ratio_of_roll" not in free_settings(formate)


def test_a_target_is_simple_where_strong_directions_are_enough(target):
    assert analyse([off(target, radial_distance=0.02)]).is_simple
    base = analyse([target])
    weak = base.jacobian @ np.linalg.svd(base.jacobian)[2][5]  # all of one weak direction: 10 um at most
    assert 5 in base.weak
    assert not analyse([replace(target, deviation=weak)]).is_simple


def test_few_settings_are_as_good_as_any_of_their_number(target):
    """No fewer would do, and of as many none with less change; what they lose is as small as stated, and said."""
    measured = replace(target, deviation=off(target, radial_distance=0.03, machine_root_angle=3e-4).deviation)
    analysis = analyse([measured])
    choice = analysis.choose()
    assert len(choice.names) < len(FREE)
    assert list(choice.left) == sorted(choice.left, reverse=True)
    most = max(0.1 * analysis.best_rms, 1e-4)  # a tenth, or what a probe resolves
    assert choice.loss <= most
    alone = analyse([measured], choice.names)
    assert alone.best_rms - analysis.best_rms == pytest.approx(choice.loss, abs=1e-12)
    fewer = [analyse([measured], names) for names in itertools.combinations(FREE, len(choice.names) - 1)]
    assert min(one.best_rms for one in fewer) > analysis.best_rms + most
    as_many = [analyse([measured], names) for names in itertools.combinations(FREE, len(choice.names))]
    able = [one for one in as_many if one.best_rms <= analysis.best_rms + most]
    assert np.linalg.norm(alone.correction) == pytest.approx(min(np.linalg.norm(one.correction) for one in able))


def test_flanks_of_a_completing_cut_are_judged_together(gear_set):
    grid = blank_grid(gear_set.gear)
    targets = [target_of(gear_set.gear, f, solve_flank(gear_set.gear, f, grid)) for f in FLANKS]
    both, each = analyse(targets), [analyse([target]) for target in targets]
    assert both.jacobian.shape == (90, 7)
    np.testing.assert_array_equal(both.jacobian, np.concatenate([one.jacobian for one in each]))


@pytest.mark.parametrize(
    ("names", "sentence"),
    [
        (("radius",), r"^setting = 'radius': must be one of radial_distance, .* like work_rotation_offset\.2"),
        (("radial_distance.8",), r"^setting = 'radial_distance\.8': must be one of"),
        (("radial_distance", "radial_distance"), r"^setting = 'radial_distance': is named twice$"),
        ((), r"^settings: at least one must be free$"),
    ],
)
def test_names_that_are_no_settings_are_refused(target, names, sentence):
    with pytest.raises(InputError, match=sentence):
        analyse([target], names)


def test_large_deviations_are_damped_and_stay_within_bounds(target):
    """Planes and noise of 1 mm, where full steps lead to surfaces that do not cross the normals."""
    random = np.random.default_rng(0)
    row, col = (index.ravel() for index in np.indices((5, 9)))
    for deviation in (random.uniform(-1, 1, 45), 0.5 * (row - 2.0), 0.25 * (col - 4.0), np.full(45, 1.0)):
        found = identify([replace(target, deviation=deviation)])
        assert (np.abs(found.values) <= found.scale).all()
        assert found.rms_after < found.rms_before


def test_root_line_is_held_and_said_to_hold_back(gear_set):
    nominal = solve_flank(gear_set.pinion, "concave", blank_grid(gear_set.pinion))
    target = target_of(gear_set.pinion, "concave", nominal)
    deeper = off(target, sliding_base=-0.12, machine_root_angle=5e-4)
    names = ("radial_distance", "cradle_angle", "sliding_base")
    free, held = identify([deeper], names), identify([deeper], names, root_limit=0.03)
    assert free.active == ()
    assert held.active == ("root line",)
    assert held.rms_after > free.rms_after
    sunk, gradient = target.root.sunk(target.vector, target.vector + held.change())
    assert np.abs(sunk).max() == pytest.approx(0.03, abs=2e-3)
    # the gradient, by differences of the depth itself
    for name, h in (("sliding_base", 1e-3), ("machine_root_angle", 1e-5), ("radial_distance", 1e-3)):
        step = h * np.eye(83)[SETTINGS.index(name)]
        at = target.vector + held.change()
        up, down = (target.root.sunk(target.vector, at + sign * step)[0] for sign in (1, -1))
        np.testing.assert_allclose((up - down) / (2 * h), gradient[:, SETTINGS.index(name)], rtol=1e-5, atol=1e-8)


@pytest.mark.parametrize("name", MEMBERS)
@pytest.mark.parametrize(
    "set_name", ["crown_gear_formate_14x39", "crown_gear_universal_14x39", "crown_gear_hobbed_14x39"]
)
def test_root_line_is_where_the_general_solver_meets_the_tip_of_the_blade(set_name, name):
    """The place of the depth, asked for on the blank: the blade is there with its height zero."""
    member = load_bevel_set(bundled(f"{set_name}.toml")).member(name)
    delta = np.radians(member.blank.pitch_angle)
    for flank in FLANKS:
        target = target_of(member, flank, solve_flank(member, flank, blank_grid(member)))
        contact, depth, _ = target.root.depth(target.vector)
        along = target.root.distances
        place = along * np.cos(delta) + depth * np.sin(delta), along * np.sin(delta) - depth * np.cos(delta)
        section = blade_sections(member.flank(flank), target.how.side)["main"]
        points = solve_section(target.how, section, *place, start=contact + np.array([0.01, 1e-3, 1e-3]))
        assert points.converged.all()
        np.testing.assert_allclose(points.contact[:, 0], 0, atol=1e-6)

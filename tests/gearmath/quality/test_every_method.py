"""Compensation of every cutting method: sensitivities, correctable and other errors, noise, against brute force."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.generation import solve_section
from gearmath.bevel.identify.compensation import identify, with_deviations
from gearmath.bevel.identify.flank_target import predicted
from gearmath.bevel.identify.identification import spread
from gearmath.bevel.identify.variables import BOUNDS, NAMES, SIZE, Variable, free_settings, variables_of
from gearmath.bevel.method import blade_sections
from gearmath.quality.correction.batch import identify_many
from gearmath.quality.correction.target import target_of
from gearmath.specs.bevel_set import FLANKS, MEMBERS, SETTINGS, load_bevel_set
from gearmath.specs.toml import bundled

SETS = (
    "nasa_tp3096_12x36",
    "spiral_7x43",
    "crown_gear_formate_14x39",
    "crown_gear_universal_14x39",
    "crown_gear_hobbed_14x39",
)
ALL = [(name, member) for name in SETS for member in MEMBERS]
each_member = pytest.mark.parametrize(("set_name", "name"), ALL)
#: Errors of the largest size that must be found again. [mm]
LARGEST = 0.05
SIGMA, SEEDS = 0.5e-3, 200


def member_of(set_name, name, arc=False):
    member = load_bevel_set(bundled(f"{set_name}.toml")).member(name)
    if not arc:
        return member
    round_blade = {"blade_spheric_radius": 500.0, "blade_reference_height": 3.0}
    flanks = {flank: member.flank(flank).model_copy(update=round_blade) for flank in FLANKS}
    return member.model_copy(update=flanks)


def targets_of(member, flanks=FLANKS, rows=5, columns=9):
    grid = blank_grid(member, rows, columns)
    return [replace(target_of(member, flank, solve_flank(member, flank, grid)), root=None) for flank in flanks]


def groups_of(member):
    """The flanks that share their settings."""
    return [FLANKS] if member.cutting == "completing" else [(flank,) for flank in FLANKS]


def unit(index, size=1.0):
    return size * np.eye(SIZE)[index]


def re_solved(member, flank, target, change):
    """What the flank of changed settings leaves, from points of it that are solved on the blank, place by place.

    A tangent plane at the place of P + t n says where the line meets the surface; the next place is there.
    """
    section = blade_sections(member.flank(flank), target.how.side)["main"]
    settings, motion = target.settings + change[:12], target.how.motion + change[12:82].reshape(10, 7)
    start = target.nominal.contact
    if not target.vector[-1] + change[-1]:
        section = replace(section, point_radius=settings[10], pressure_angle=settings[11])
    else:  # the arc that touches the changed blade at the reference height
        r, height = 1 / (target.vector[-1] + change[-1]), target.reference_height
        touching = settings[10] + target.how.side * height * np.tan(settings[11])
        center = touching - target.how.side * r * np.cos(settings[11]), height + r * np.sin(settings[11])
        section = replace(section, point_radius=settings[10], pressure_angle=settings[11], arc=(*center, r))
        # the solver of the blank takes the angle of the normal: at a foot t along the tangent it is alpha - asin(t/r)
        angle = settings[11] - np.arcsin((start[:, 0] - height) / np.cos(settings[11]) / r)
        start = np.column_stack([angle, start[:, 1:]])
    how, at = replace(target.how, settings=settings, motion=motion), target.nominal
    t = np.zeros(len(at.point))
    for _ in range(4):
        on_line = at.point + t[:, None] * at.normal
        place = on_line[:, 2], np.hypot(on_line[:, 0], on_line[:, 1])
        points = solve_section(how, section, *place, start=start)
        assert points.converged.all()
        off = np.sum((points.point - on_line) * points.normal, axis=1)
        t = t + off / np.sum(at.normal * points.normal, axis=1)
    return t


@pytest.mark.parametrize("arc", [False, True], ids=["straight", "arc"])
@each_member
def test_sensitivities_are_finite_differences_of_re_solved_surfaces(set_name, name, arc):
    """Fourth order, 1e-6 of the largest element of the column: settings, motions of powers 1 to 3, curvature.

    The step of each shifts the flank by about 4 um; by 0.4 um for motions, to which it answers less straight.
    """
    member = member_of(set_name, name, arc)
    motions = ("sliding_base.1", "work_rotation_offset.2", "radial_distance.3", "machine_root_angle.1")
    for flank in FLANKS:
        (target,) = targets_of(member, (flank,), 2, 3)
        deviation, gradient = predicted(target, target.vector)
        np.testing.assert_allclose(deviation, 0, atol=1e-9)
        for k in (*range(12), *map(NAMES.index, motions), NAMES.index("blade_spheric_radius")):
            size = np.abs(gradient[:, k]).max()
            if size < 1e-9:  # no tilt, no swivel; no roll, no ratio
                assert np.abs(re_solved(member, flank, target, unit(k, 1e-3))).max() < 1e-9
                continue
            h = (4e-3 if k < 12 else 4e-4) / size
            left = [re_solved(member, flank, target, unit(k, part * h)) for part in (1, -1, 2, -2)]
            differences = (8 * (left[0] - left[1]) - (left[2] - left[3])) / (12 * h)
            assert np.abs(gradient[:, k] - differences).max() <= 1e-6 * np.abs(differences).max(), (flank, NAMES[k])


@pytest.fixture(scope="module")
def cut(brute_force):
    """``cut(set_name, name)``: for every group of flanks of a member its targets, free settings, variables, errors (p,)
    with a largest deviation of LARGEST, and the deviations (m,) that brute force leaves; worked out once."""
    known = {}

    def make(set_name, name):
        if (set_name, name) not in known:
            member = member_of(set_name, name)
            known[set_name, name] = [_group(brute_force, member, flanks) for flanks in groups_of(member)]
        return known[set_name, name]

    return make


def _group(brute_force, member, flanks):
    targets, free = targets_of(member, flanks), free_settings(member)
    variables = variables_of(free, len(targets))
    errors = 1e-3 * np.random.default_rng(0).uniform(-1, 1, len(variables)) * [v.bound for v in variables]
    for _ in range(3):
        left = [predicted(t, t.vector + spread(variables, errors, k))[0] for k, t in enumerate(targets)]
        errors *= LARGEST / np.abs(np.concatenate(left)).max()
    return targets, free, variables, errors, measured(brute_force, member, flanks, targets, variables, errors)


def measured(brute_force, member, flanks, targets, variables, errors):
    """What brute force leaves on all flanks of a group."""
    return np.concatenate(
        [
            brute_force.left(member, flank, target, spread(variables, errors, k))
            for k, (flank, target) in enumerate(zip(flanks, targets, strict=True))
        ]
    )


@each_member
def test_correctable_errors_are_found_to_the_last_digit(cut, host_compiler, set_name, name):
    """50 um: RMS at most 1e-4 um in at most 8 iterations; parameters above 1 % of the largest singular value to 1e-3.

    Of themselves, or of a tenth of all errors where one is smaller by accident.
    """
    for targets, free, _, errors, left in cut(set_name, name):
        assert np.abs(left).max() == pytest.approx(LARGEST, rel=0.02)
        found = identify(with_deviations(targets, left), free)
        assert found.converged
        assert found.iterations <= 8
        assert found.rms_after <= 1e-7  # mm
        _, S, V = np.linalg.svd(found.jacobian, full_matrices=False)
        strong = 0.01 * S[0] < S
        missed, true = V @ ((found.values - errors) / found.scale), V @ (errors / found.scale)
        size = np.maximum(np.abs(true), 0.1 * np.linalg.norm(true))
        assert (np.abs(missed[strong]) <= 1e-3 * size[strong]).all()


@each_member
def test_surface_objective_finds_the_same_errors(cut, host_compiler, set_name, name):
    """Ten coefficients a flank: what lies in the cubic surface goes, so that as good as nothing is left."""
    targets, free, _, _, left = cut(set_name, name)[0]
    grid = np.indices((5, 9)).reshape(2, -1)
    place = np.stack([(grid[1] - 4) * 2.5, (grid[0] - 2) * 1.25], axis=1)
    targets = [replace(target, place=place) for target in targets]
    found = identify(with_deviations(targets, left), free, objective="surface")
    assert found.converged
    coefficients = found.weighting @ found.residual
    assert np.sqrt(np.mean(coefficients**2)) <= 1e-6
    assert found.rms_after <= 1e-5


@each_member
def test_what_no_setting_mends_is_all_that_is_left(cut, host_compiler, set_name, name):
    """Errors of 50 um and a ripple of 3 um besides: at most 1.001 of what is left of them by a bounded linear fit.

    The bounds count: on one flank alone the ripple calls for more sliding base than may be given.
    """
    for targets, free, _, _, left in cut(set_name, name):
        row, col = (index.ravel() for index in np.indices((5, 9)))
        ripple = 3e-3 * np.concatenate([np.sin(2.1 * row + 1.3 * col + k) for k in range(len(targets))])
        found = identify(with_deviations(targets, left + ripple), free)
        v, J = found.values / found.scale, found.jacobian
        linear = lsq_linear(J, J @ v - found.residual, (-1, 1), tol=1e-14, max_iter=1000)
        projected = np.sqrt(np.mean(linear.fun**2))
        assert projected > 1e-3
        assert found.rms_after <= 1.001 * projected
        # all of it lies outside of the columns: nothing can be done, and nothing is made worse
        columns = np.linalg.svd(J, full_matrices=False)[0]
        outside = ripple - columns @ (columns.T @ ripple)
        alone = identify(with_deviations(targets, outside), free)
        assert alone.rms_after <= 1.001 * np.sqrt(np.mean(outside**2))


@each_member
def test_noise_leaves_as_much_as_there_are_corrected_parameters(cut, host_compiler, set_name, name):
    """200 seeds of 0.5 um on errors of 50 um: the true remaining RMS is sigma √(p_eff/m) within 5 %, as mean square.

    The plain mean of the RMS of p parameters lies below that by 1/4p.
    """
    for targets, free, _, _, true in cut(set_name, name):
        noise = np.array([np.random.default_rng(seed).normal(0, SIGMA, len(true)) for seed in range(SEEDS)])
        found = identify_many(targets, true + noise, free, noise=SIGMA)
        assert found.converged.all()
        remaining = found.residual + noise  # predicted less true
        parameters = identify(with_deviations(targets, true), free, noise=SIGMA).corrected_parameters
        expected = SIGMA * np.sqrt(parameters / len(true))
        rms = np.sqrt(np.mean(remaining**2, axis=1))
        assert np.sqrt(np.mean(rms**2)) == pytest.approx(expected, rel=0.05)
        assert np.mean(rms) == pytest.approx(expected * (1 - 1 / (4 * parameters)), rel=0.05)


def test_higher_order_errors_need_motions_and_are_found_with_them(brute_force, host_compiler):
    """Modified roll of 0.2 degrees per rad² and a helical motion, which no setting at rest makes up for."""
    member = member_of("crown_gear_universal_14x39", "pinion")
    targets = targets_of(member, ("concave",))
    names = ("work_rotation_offset.2", "sliding_base.1")
    free, variables = free_settings(member, higher_order=True), variables_of(names, 1)
    errors = np.array([np.radians(0.2), 0.15])
    left = measured(brute_force, member, ("concave",), targets, variables, errors)
    rest, moving = (identify(with_deviations(targets, left), f) for f in (free_settings(member), free))
    assert rest.rms_after > 1e-5
    assert moving.rms_after <= 1e-7
    alone = identify(with_deviations(targets, left), names)
    np.testing.assert_allclose(alone.values, errors, rtol=1e-6)
    assert not alone.errors.any()
    assert np.count_nonzero(alone.motion) == 2


def test_blades_of_a_completing_cut_are_identified_one_by_one(brute_force, host_compiler):
    member = member_of("crown_gear_hobbed_14x39", "gear")
    targets, names = targets_of(member), ("sliding_base", "blade_pressure_angle")
    variables = variables_of(names, 2)
    assert [variable.label for variable in variables] == [
        "sliding_base",
        "blade_pressure_angle[0]",
        "blade_pressure_angle[1]",
    ]
    errors = np.array([0.02, 0.001, -0.002])
    left = measured(brute_force, member, FLANKS, targets, variables, errors)
    found = identify(with_deviations(targets, left), names)
    np.testing.assert_allclose(found.values, errors, rtol=1e-6)
    np.testing.assert_allclose(found.change(1)[SETTINGS.index("blade_pressure_angle")], -0.002, rtol=1e-6)


def test_every_setting_has_a_bound_and_motions_as_much_at_half_a_radian():
    assert set(BOUNDS) == {*SETTINGS, "blade_spheric_radius"}
    assert Variable("sliding_base.2").bound * 0.5**2 == BOUNDS["sliding_base"]

"""Compensation that does not overreach: errors of one setting, rotations of the work, limits, and flanks made worse."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.generation import solve_section
from gearmath.bevel.identify.flank_target import located
from gearmath.bevel.identify.variables import NAMES
from gearmath.bevel.method import blade_sections, cut_generation_of
from gearmath.bevel.nominal_file import flank_header
from gearmath.bevel.root import above_root, mean_place, root_trace
from gearmath.errors import ComputationError
from gearmath.quality.correction.member import ROOT_LIMIT, correct, setting_changes
from gearmath.quality.correction.target import target_of
from gearmath.quality.evaluation.member import evaluate_member
from gearmath.quality.uncertainty.covariance import independent
from gearmath.quality.uncertainty.judged import judged_by_measured
from gearmath.quality.uncertainty.settings import uncertain_settings
from gearmath.specs.bevel_set import FLANKS, SETTINGS, SIDES, load_bevel_set
from gearmath.specs.flank_csv import FlankFile, flank_file, join
from gearmath.specs.toml import bundled

NASA, SPIRAL = (load_bevel_set(bundled(f"{name}.toml")) for name in ("nasa_tp3096_12x36", "spiral_7x43"))
RADIAL, SIGMA, ARCSEC = 0.05, 0.5e-3, np.pi / 180 / 3600


def measured(name, errors, rotation=0.0, sigma=0.0, seed=0, extra=None, gear_set=NASA) -> FlankFile:
    """Tooth 0 of a member whose flanks were cut with ``errors`` by flank and name, measured turned by ``rotation``.

    The re-solved surface of the changed settings; turning the work on is less work rotation offset.
    """
    member, random, files = gear_set.member(name), np.random.default_rng(seed), []
    for flank in FLANKS:
        grid = blank_grid(member)
        target = target_of(member, flank, solve_flank(member, flank, grid))
        vector = target.vector
        for key, value in errors.get(flank, {}).items():
            vector[NAMES.index(key)] += value
        vector[NAMES.index("work_rotation_offset")] -= rotation
        deviation, _, failed = located(target, vector)
        assert not failed.any()
        deviation = deviation + sigma * random.standard_normal(len(deviation))
        if extra is not None:
            deviation = deviation + extra(flank)
        row, col = (index.ravel() for index in np.indices((5, 9)))
        at = target.nominal
        point = at.point + deviation[:, None] * at.normal
        files.append(
            flank_file(flank_header(member, grid.shape), name, flank, 0, row, col, point, at.normal, deviation)
        )
    file = join(files)
    return replace(file, uncertainty=np.full(len(file), sigma or np.nan))


def corrected(name, file, **options):
    """Changes by flank and setting of ``few``, as the command corrects, and the evaluation and the correction."""
    member = NASA.member(name)
    judged = evaluate_member(file, member)
    found = correct(member, judged.file, few=True, **options)
    changes = {flank: {} for flank in FLANKS}
    for flank, key, old, new in setting_changes(member, found):
        changes[flank][key] = new - old
    return changes, judged, found


CASES = [
    ("pinion", ("concave",)),
    ("pinion", ("convex",)),
    ("pinion", FLANKS),
    ("gear", FLANKS),
]


@pytest.mark.parametrize(("sign", "arcsec"), [(1, 0), (-1, 30)])
@pytest.mark.parametrize(("name", "flanks"), CASES)
def test_radial_error_alone_is_corrected_by_the_radial_distance_alone(name, flanks, arcsec, sign):
    """Exact surface without noise: to 0.1 um, by no other setting, on no other flank, however the work stood."""
    file = measured(name, {flank: {"radial_distance": sign * RADIAL} for flank in flanks}, arcsec * ARCSEC)
    changes, _, found = corrected(name, file)
    for flank in FLANKS:
        assert list(changes[flank]) == (["radial_distance"] if flank in flanks else [])
        if flank in flanks:
            assert changes[flank]["radial_distance"] == pytest.approx(-sign * RADIAL, abs=1e-4)
            before, after = found.rms[flank]
            assert before > 2e-3
            assert after < 1e-5


@pytest.mark.parametrize(("sign", "seed"), [(1, 0), (-1, 1)])
@pytest.mark.parametrize(("name", "flanks"), CASES)
def test_radial_error_under_noise_is_corrected_within_three_of_its_uncertainties(name, flanks, sign, seed):
    member = NASA.member(name)
    errors = {flank: {"radial_distance": sign * RADIAL} for flank in flanks}
    file = measured(name, errors, 20 * ARCSEC, SIGMA, seed)
    changes, judged, found = corrected(name, file)
    known = independent(np.full(len(file), SIGMA)).carried(judged_by_measured(file, member, judged))
    u = {
        (one.figure.flank, one.figure.name): one.uncertainty
        for one in uncertain_settings(member, judged.file, found, known)[0]
    }
    for flank in FLANKS:
        assert list(changes[flank]) == (["radial_distance"] if flank in flanks else [])
        if flank in flanks:
            own = u[flank, "radial_distance"]
            assert 0 < own < 0.01
            assert abs(changes[flank]["radial_distance"] + sign * RADIAL) <= 3 * own


@pytest.mark.parametrize("sigma", [0.0, SIGMA])
@pytest.mark.parametrize("arcsec", [30, -300])
@pytest.mark.parametrize("name", ["pinion", "gear"])
def test_pure_rotation_of_the_work_corrects_no_setting(name, arcsec, sigma):
    changes, _, found = corrected(name, measured(name, {}, arcsec * ARCSEC, sigma))
    assert changes == {flank: {} for flank in FLANKS}
    for before, after in found.rms.values():
        assert after == pytest.approx(before, abs=1e-9)
        assert before <= max(1e-5, 1.3 * sigma)


def test_thickness_is_no_rotation():
    """Both flanks of the pinion off by as much the other way: each is put right by its own cradle or work rotation."""
    turn = 1e-4
    errors = {"concave": {"work_rotation_offset": turn}, "convex": {"work_rotation_offset": -turn}}
    file = measured("pinion", errors, 30 * ARCSEC)
    judged = evaluate_member(file, NASA.pinion).file
    found = correct(NASA.pinion, judged, ("work_rotation_offset",), few=True)
    row = SETTINGS.index("work_rotation_offset")
    moved = [found.settings[flank][row] - NASA.pinion.flank(flank).vector[row] for flank in FLANKS]
    assert moved[0] - moved[1] == pytest.approx(-2 * turn, rel=1e-3)
    assert max(after for _, after in found.rms.values()) < 1e-5


def ripple(size):
    row, col = (index.ravel() for index in np.indices((5, 9)))
    return size * np.sin(2.1 * row + 1.3 * col)


@pytest.mark.parametrize("name", ["pinion", "gear"])
@pytest.mark.parametrize("size", [0.0, 0.003])
def test_no_result_is_below_its_limit(name, size):
    """The limit is an exact optimum within the bounds, of all that are free: for few, for all, and large errors."""
    errors = {"radial_distance": 0.3, "blank_offset": -0.25, "machine_root_angle": 2e-3}
    errors = dict.fromkeys(FLANKS, errors)
    file = measured(name, errors, extra=lambda _: ripple(size))
    for few in (True, False):
        found = correct(NASA.member(name), file, few=few)
        for group, result in found.identified.items():
            assert result.converged
            assert found.reachable[group] <= result.rms_after
            assert found.reachable[group] >= 0.5 * size * 0.7  # most of the ripple is beyond all settings


def test_flank_that_a_common_correction_makes_worse_is_refused_with_figures():
    """A blade error of one side only, and a machine setting for both: the good flank would pay for the other."""
    file = measured("gear", {"concave": {"blade_pressure_angle": 2e-3}})
    with pytest.raises(
        ComputationError,
        match=r"^gear: the correction by .* makes the convex flank worse \(RMS concave [\d.]+ to [\d.]+ um, "
        r"convex 0\.\d+ to [\d.]+ um\); nothing is written",
    ):
        correct(NASA.gear, file, ("machine_root_angle", "ratio_of_roll"))


def test_where_the_few_meet_a_bound_the_next_best_few_are_taken_if_they_leave_less():
    """A ratio of roll off by more than its bound of 0.02: fewer than all seven settings, none of them at a limit."""
    file = measured("pinion", {key: {"ratio_of_roll": 0.021} for key in FLANKS})
    found = correct(NASA.pinion, file, few=True)
    for group, one in found.identified.items():
        names = [variable.name for variable in one.variables]
        assert "ratio_of_roll" not in names
        assert len(names) < 7
        assert one.active == ()
        assert one.rms_after < 0.02 * found.measured_rms(group)


def test_root_that_the_tip_of_the_cutter_leaves_keeps_its_limit_where_settings_reach_theirs():
    """3 um of twist, seven teeth: machine root angle and roll end at their bounds, and the root does not sink.

    The end of the flank stayed within 0.06 mm while the tip plane went 0.9 mm deeper. Measured here on the line that
    the tip plane cuts in the middle of the space, by the solver of the blank, beyond both ends of the face.
    """
    member = SPIRAL.pinion
    y, x = (index.ravel() * 2.0 / (n - 1) - 1 for index, n in zip(np.indices((5, 9)), (5, 9), strict=True))
    file = measured("pinion", {}, extra=lambda _: 3e-3 * x * y + 2e-3 * y, gear_set=SPIRAL)
    found = correct(member, evaluate_member(file, member).file, few=True)
    for flank in FLANKS:
        how, section = cut_generation_of(member, flank), blade_sections(member.flank(flank), SIDES[flank])["main"]
        new = replace(how, settings=found.settings[flank])
        mean = solve_section(new, section, *mean_place(member))
        above = above_root(member, root_trace(member, flank, new, mean.contact).point)
        assert np.abs(above).max() <= 1.75 * ROOT_LIMIT  # from 0.4 of the face width, where it is kept, to 0.7
        before, after = found.rms[flank]
        assert after < 0.25 * before
        assert np.abs(found.root[flank]).max() <= ROOT_LIMIT + 1e-6

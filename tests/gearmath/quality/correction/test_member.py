"""The closed loop without metal, and what is refused before any setting is touched."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.errors import ComputationError, InputError
from gearmath.quality.correction.member import correct, setting_changes
from gearmath.quality.correction.target import flank_target
from gearmath.quality.evaluation.pitch import evaluate_pitch
from gearmath.specs.bevel_set import FLANKS, MEMBERS, SETTINGS, load_bevel_set
from gearmath.specs.flank_csv import FlankFile, join
from gearmath.specs.set_text import save_corrected
from gearmath.specs.simulated_machine import Probe
from gearmath.specs.toml import bundled

SET = bundled("nasa_tp3096_12x36.toml")
each_member = pytest.mark.parametrize("member", MEMBERS)


@pytest.fixture(scope="module")
def quiet_shop(shop):
    """The bundled shop with its setting errors and index errors, measured without noise."""
    return shop.model_copy(update={"probe": Probe()})


@pytest.fixture(scope="module")
def loop(gear_set, mill, quiet_shop, tmp_path_factory):
    """``loop(member, rounds)``: measurements of the first cut and of each cut after a correction, all from text."""
    folder, known = tmp_path_factory.mktemp("loop"), {}

    def run(member: str, rounds: int) -> list[FlankFile]:
        if (member, rounds) not in known:
            source, files = SET, []
            for k in range(rounds + 1):
                current = load_bevel_set(source)
                files.append(mill(current, member, range(current.member(member).teeth), quiet_shop))
                correction = correct(current.member(member), files[-1])
                target = folder / f"{member}_{k}.toml"
                save_corrected(source, target, member, correction.settings, correction.index)
                source = target
            known[member, rounds] = files
        return known[member, rounds]

    return run


@pytest.fixture(scope="module")
def measured(gear_set, mill, quiet_shop) -> FlankFile:
    return mill(gear_set, "pinion", (0,), quiet_shop)


def profile(file: FlankFile, member) -> float:
    return max(np.abs(file.select(flank, 0).deviation).max() for flank in FLANKS)


def pitch(file: FlankFile, teeth: int) -> float:
    return max(evaluate_pitch(file, teeth, flank).total for flank in FLANKS)


@each_member
def test_one_correction_leaves_at_most_half_a_micrometre(loop, member):
    first, second, _ = loop(member, 2)
    assert 0.02 <= profile(first, member) <= 0.03  # mm, the size in the source text
    assert profile(second, member) <= 5e-4


@each_member
def test_index_correction_levels_the_pitch(gear_set, loop, member):
    teeth = gear_set.member(member).teeth
    first, second, _ = loop(member, 2)
    assert pitch(first, teeth) > 0.01
    assert pitch(second, teeth) <= 5e-4


@each_member
def test_second_correction_keeps_what_the_first_has_reached(gear_set, loop, member):
    """From the corrected file: its measurement is judged against the design, and the machine errors stay known."""
    _, _, third = loop(member, 2)
    assert profile(third, member) <= 5e-4
    assert pitch(third, gear_set.member(member).teeth) <= 5e-4


@each_member
def test_perfect_member_stays_perfect(gear_set, mill, tmp_path, member):
    """What straight blocks leave, 0.1 µm, is all that there is to correct; the next cut is no worse for it."""
    good = mill(gear_set, member)
    correction = correct(gear_set.member(member), good)
    save_corrected(SET, tmp_path / "next.toml", member, correction.settings, correction.index)
    assert profile(mill(load_bevel_set(tmp_path / "next.toml"), member), member) <= 2e-4
    assert correction.index is None  # one space has no pitch


@each_member
def test_measurement_without_any_deviation_changes_nothing(gear_set, mill, member):
    file = mill(gear_set, member)
    point = file.point - file.deviation[:, None] * file.normal
    correction = correct(gear_set.member(member), replace(file, point=point, deviation=0 * file.deviation))
    for flank in FLANKS:
        settings = gear_set.member(member).flank(flank).vector
        np.testing.assert_allclose(correction.settings[flank], settings, rtol=0, atol=1e-9)
        assert correction.expected[flank] < 1e-9


def test_noise_of_the_probe_stays_about_as_small_as_it_is(gear_set, mill, shop, quiet_shop, tmp_path):
    """45 points of 0.5 µm: the corrected flank is off by no more than twice that, noise taken away."""
    noisy = mill(gear_set, "pinion", (0,), shop)
    correction = correct(gear_set.pinion, noisy)
    save_corrected(SET, tmp_path / "next.toml", "pinion", correction.settings)
    assert profile(mill(load_bevel_set(tmp_path / "next.toml"), "pinion", (0,), quiet_shop), "pinion") <= 1e-3


def test_completing_cut_keeps_one_machine_setting_for_both_flanks(gear_set, mill, quiet_shop):
    correction = correct(gear_set.gear, mill(gear_set, "gear", (0,), quiet_shop))
    assert list(correction.identified) == [FLANKS]
    changes = [
        {name: new - old for f, name, old, new in setting_changes(gear_set.gear, correction) if f == flank}
        for flank in FLANKS
    ]
    assert changes[0] == pytest.approx(changes[1], abs=1e-12)
    assert all(name not in changes[0] for name in ("blade_point_radius", "blade_pressure_angle", "cutter_tilt"))


def test_fixed_settings_are_corrected_flank_by_flank(gear_set, measured):
    correction = correct(gear_set.pinion, measured)
    assert list(correction.identified) == [("concave",), ("convex",)]
    other = measured.select("concave")
    alone = replace(measured, deviation=np.where(measured.flank == "convex", measured.deviation, 0.0))
    alone = replace(alone, point=alone.point + (alone.deviation - measured.deviation)[:, None] * alone.normal)
    changed = correct(gear_set.pinion, alone)
    np.testing.assert_array_equal(changed.settings["convex"], correction.settings["convex"])
    assert np.abs(other.deviation).max() > 0.005


def test_expected_remainder_is_what_the_next_cut_shows(gear_set, loop):
    first, second, _ = loop("gear", 2)
    correction = correct(gear_set.gear, first)
    for flank in FLANKS:
        left = np.abs(second.select(flank, 0).deviation).max()
        assert correction.expected[flank] == pytest.approx(left, abs=3e-4)  # straight blocks of both cuts


def test_grid_may_stand_on_any_tooth_and_in_any_order(gear_set, mill, quiet_shop, measured):
    """Spaces 5 and 0 and then all others: the grid is on tooth 5."""
    file = mill(gear_set, "pinion", (5, *(k for k in range(12) if k != 5)), quiet_shop)
    mixed = np.random.default_rng(0).permutation(len(file))
    arrays = {
        name: getattr(file, name)[mixed]
        for name in ("flank", "tooth", "row", "col", "point", "normal", "deviation", "uncertainty")
    }
    correction = correct(gear_set.pinion, replace(file, **arrays))
    assert max(correction.expected.values()) < 3e-4
    target = flank_target(gear_set.pinion, "concave", file)
    np.testing.assert_array_equal(target.deviation, file.select("concave", 5).deviation)


def header(file: FlankFile, **values: str) -> FlankFile:
    return replace(file, header=file.header | values)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda f: replace(header(f, member="gear"), member="gear"), r"^member = 'gear' .*: must be 'pinion'$"),
        (lambda f: header(f, member_teeth="13"), r"^member_teeth = 13: the pinion of the set has 12$"),
        (lambda f: header(f, settings_sha256="ab" * 32), r"^settings_sha256 = abababababab\.\.\.: .* other nominal"),
        (lambda f: replace(f, point=f.point / 25.4), r"^concave flank, row 4, col 8: .* limit is 0\.01 mm; is the"),
        (lambda f: replace(f, deviation=f.deviation * 25.4), r"row \d, col \d: the measured point lies 0\.\d{4} mm"),
        (lambda f: replace(f, point=f.point * [1, -1, 1]), r"of this set and hand\?$"),
        (lambda f: replace(f, deviation=np.full(len(f), np.nan)), r"deviation_um is empty; is this a nominal file"),
        (lambda f: f.select("convex"), r"^concave flank: 0 points were measured, the grid 5x9 needs them$"),
        (lambda f: f.select("concave"), r"^convex flank: 0 points were measured, the grid 5x9 needs them$"),
        (lambda f: header(f, grid="4x9"), r"^concave flank: row 4, col 0 lies outside of the grid 4x9$"),
        (lambda f: header(f, grid="9x5"), r"^concave flank: row 0, col 5 lies outside of the grid 9x5$"),
        (lambda f: header(f, grid="6x10"), r"mm beside the nominal normal"),
        (lambda f: join([f, f]), r"^concave flank: row 0, col 0 was measured twice$"),
        (lambda f: header(f, margins="0.2,0.2"), r"mm beside the nominal normal"),
        (lambda f: replace(f, tooth=f.tooth + 1), r"mm beside the nominal normal"),
    ],
)
def test_file_that_is_not_of_this_member_is_refused(gear_set, measured, change, sentence):
    with pytest.raises(InputError, match=sentence):
        correct(gear_set.pinion, change(measured))


def test_nominal_file_of_both_flanks_is_refused(gear_set):
    grid = blank_grid(gear_set.pinion)
    nominal = join([nominal_flank(gear_set.pinion, flank, grid) for flank in FLANKS])
    with pytest.raises(InputError, match="nominal file"):
        correct(gear_set.pinion, nominal)


def without(file: FlankFile, dropped: np.ndarray) -> FlankFile:
    """The file without some of its points."""
    return replace(
        file,
        **{
            name: getattr(file, name)[~dropped]
            for name in ("flank", "tooth", "row", "col", "point", "normal", "deviation", "uncertainty")
        },
    )


def test_points_that_are_missing_empty_or_excluded_are_left_out_and_said(gear_set, measured):
    """A column in the middle is gone: the settings that the other points give correct the flank all the same."""
    gone = (measured.flank == "concave") & (measured.col == 4)
    whole, fewer = (correct(gear_set.pinion, f) for f in (measured, without(measured, gone)))
    assert whole.left_out == {"concave": 0, "convex": 0}
    assert fewer.left_out == {"concave": 5, "convex": 0}
    assert max(fewer.expected.values()) < 3e-4
    empty = replace(measured, deviation=np.where(gone, np.nan, measured.deviation))
    marked = replace(measured, deviation=np.where(gone, 0.3, measured.deviation))
    marked = replace(marked, point=measured.point + (marked.deviation - measured.deviation)[:, None] * measured.normal)
    for other in (correct(gear_set.pinion, empty), correct(gear_set.pinion, marked, excluded=gone)):
        np.testing.assert_allclose(other.settings["concave"], fewer.settings["concave"], rtol=0, atol=1e-12)
        assert other.left_out == fewer.left_out


@pytest.mark.parametrize("kept", [lambda f: f.col < 4, lambda f: f.row == 2, lambda f: (f.row < 2) & (f.col % 4 == 0)])
def test_too_few_points_to_tell_the_settings_apart_are_refused(gear_set, measured, kept):
    few = without(measured, (measured.flank == "concave") & ~kept(measured))
    with pytest.raises(
        InputError, match=r"^pinion concave: \d+ points are left of 45: too few to tell what 7 settings"
    ):
        correct(gear_set.pinion, few)


def test_measurement_that_no_setting_explains_is_not_made_worse(gear_set, measured):
    """A checkerboard of ±20 µm: the expected remainder stays below what was measured, or nothing is given back."""
    sign = np.where((measured.row + measured.col) % 2, 0.02, -0.02)
    board = replace(
        measured, deviation=sign, point=measured.point + (sign - measured.deviation)[:, None] * measured.normal
    )
    try:
        found = correct(gear_set.pinion, board).identified
    except ComputationError:
        return
    for result in found.values():
        assert result.rms_after <= result.rms_before
        changed = dict(zip(SETTINGS, result.errors, strict=True))
        assert abs(changed["radial_distance"]) <= 1.0

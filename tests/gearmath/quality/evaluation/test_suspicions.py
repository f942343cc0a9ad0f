"""What a whole measurement looks like beside an error of the gear is said before any figure: zero, tip, seat, u."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import gearmath as gm
from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.quality.evaluation.member import evaluate_member
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import FlankFile, join, write_flank_csv

UM, NASA = 1e-3, "nasa_tp3096_12x36.toml"


@pytest.fixture(scope="module")
def flanks(gear_set) -> dict[str, FlankFile]:
    """Both flanks of tooth 0 in full, with 0.5 um of noise, by member."""
    found = {}
    for k, (name, spec) in enumerate(gear_set.members.items()):
        file = join([nominal_flank(spec, flank, blank_grid(spec)) for flank in FLANKS])
        file = replace(file, deviation=np.zeros(len(file)), uncertainty=np.full(len(file), 0.5 * UM))
        found[name] = moved(file, 0.5 * UM * np.random.default_rng(k).standard_normal(len(file)))
    return found


def moved(file: FlankFile, change: np.ndarray) -> FlankFile:
    return replace(file, point=file.point + change[:, None] * file.normal, deviation=file.deviation + change)


@pytest.mark.parametrize("member", ["pinion", "gear"])
@pytest.mark.parametrize("form_um", [0, 5])
@pytest.mark.parametrize("shift", [0.1, -0.1])
def test_work_off_its_seat_along_the_axis_is_said_first_with_its_size(flanks, gear_set, member, shift, form_um) -> None:
    """Also beside a slope and a twist of the flanks that are larger than what the shift makes of their form."""
    file = flanks[member]
    along, up = (file.col - 4) / 4, (file.row - 2) / 2
    slope = np.where(file.flank == FLANKS[0], 1.0, -0.8)
    file = moved(file, form_um * UM * (slope * along + 0.6 * along * up))
    off = moved(file, shift * file.normal[:, 2])  # a shift along z_w, to first order
    (line,) = evaluate_member(off, gear_set.member(member)).first
    assert line.startswith("the work may be clamped ")
    assert float(line.split()[5]) == pytest.approx(shift * 1000, abs=10 if form_um == 0 else 40)
    assert "check the clamping before a setting is corrected" in line


@pytest.mark.parametrize("member", ["pinion", "gear"])
@pytest.mark.parametrize("offset_um", [300, -60])
def test_points_that_are_all_out_alike_are_said_to_be_first(flanks, gear_set, member, offset_um) -> None:
    file = flanks[member]
    (line,) = evaluate_member(moved(file, np.full(len(file), offset_um * UM)), gear_set.member(member)).first
    assert line.startswith(f"all points of both flanks stand {offset_um:+d} um out, evenly within ")
    assert "tip radius" in line


@pytest.mark.parametrize(("u_um", "said"), [(0.05, True), (0.5, False), (2.0, False)])
def test_uncertainty_far_below_the_scatter_of_the_points_is_said(flanks, gear_set, u_um, said) -> None:
    file = replace(flanks["pinion"], uncertainty=np.full(len(flanks["pinion"]), u_um * UM))
    found = evaluate_member(file, gear_set.pinion).first
    assert [line.startswith(f"u_um of the file, {u_um:g} um, is far below") for line in found] == [True] * said


@pytest.mark.parametrize("member", ["pinion", "gear"])
@pytest.mark.parametrize(
    ("key", "change"),
    [
        ("radial_distance", 0.05),
        ("sliding_base", 0.05),
        ("blank_offset", 0.05),
        ("machine_root_angle", 0.02),
        ("blade_point_radius", 0.05),
        ("ratio_of_roll", 0.003),
    ],
)
def test_error_of_another_setting_is_not_taken_for_the_seat_or_the_zero(gear_set, member, key, change) -> None:
    spec = gm.load_set(NASA).member(member).with_settings(concave={key: change}, convex={key: change})
    file = spec.deviations().file
    noise = 0.5 * UM * np.random.default_rng(1).standard_normal(len(file))
    assert evaluate_member(moved(file, noise), gear_set.member(member)).suspicions == ()


ONE_ERROR = [
    ("crown_gear_formate_14x39", "gear", "sliding_base", 0.05),
    ("crown_gear_formate_14x39", "gear", "sliding_base", -0.05),
    ("crown_gear_universal_14x39", "pinion", "ratio_of_roll", -0.0015),
    ("crown_gear_hobbed_14x39", "pinion", "blank_offset", -0.15),
    ("spiral_7x43", "pinion", "ratio_of_roll", 0.0015),
    ("spiral_7x43", "gear", "machine_root_angle", 0.03),
]


def with_error(name: str, member: str, key: str, change: float) -> FlankFile:
    """Both flanks as a machine cuts them that is off by one setting, on the exact surface, with 0.5 um of noise."""
    spec = gm.load_set(f"{name}.toml").member(member).with_settings(concave={key: change}, convex={key: change})
    file = spec.deviations().file
    return moved(file, 0.5 * UM * np.random.default_rng(1).standard_normal(len(file)))


@pytest.mark.parametrize(("name", "member", "key", "change"), ONE_ERROR)
def test_error_of_one_setting_is_not_taken_for_the_seat_whatever_the_method(name, member, key, change) -> None:
    """Each of them makes a form that a shift of the work along its axis explains by 80 percent and more."""
    spec = gm.load_set(f"{name}.toml").member(member).spec
    found = evaluate_member(with_error(name, member, key, change), spec).suspicions
    assert not [line for line in found if "off along its axis" in line]


@pytest.mark.parametrize("shift", [0.05, -0.05])
def test_cutter_displaced_along_x_of_the_machine_is_not_taken_for_the_seat(gear_set, shift) -> None:
    """On a pinion that is nearly along the axis of the work; the depth of the cut tells them apart."""
    root = np.radians(gear_set.pinion.concave.machine_root_angle)
    along, depth = shift / np.cos(root), shift * np.tan(root)
    change = {"machine_center_to_crossing_point": along, "sliding_base": depth}
    spec = gm.load_set(NASA).pinion.with_settings(concave=change, convex=change)
    file = spec.deviations().file
    file = moved(file, 0.5 * UM * np.random.default_rng(2).standard_normal(len(file)))
    assert not [line for line in evaluate_member(file, gear_set.pinion).suspicions if "seat" in line]


def test_work_far_off_its_seat_is_not_taken_for_an_offset_of_all_points(gear_set) -> None:
    """On a gear of 72 degrees it moves all points out nearly alike."""
    change = {"machine_center_to_crossing_point": -0.18}
    file = gm.load_set(NASA).gear.with_settings(concave=change, convex=change).deviations().file
    file = moved(file, 0.5 * UM * np.random.default_rng(3).standard_normal(len(file)))
    (line,) = evaluate_member(file, gear_set.gear).first
    assert line.startswith("the work may be clamped -18")


def test_compensate_says_first_that_the_work_may_stand_off_its_seat(flanks, command, tmp_path) -> None:
    file, source = flanks["pinion"], tmp_path / "measured.csv"
    write_flank_csv(source, moved(file, 0.1 * file.normal[:, 2]))
    status, out, _ = command("compensate", NASA, "--measured", source, "-o", tmp_path / "corrected.toml")
    assert status == 0
    assert out.startswith("the work may be clamped +")


def test_teeth_and_flanks_that_agree_to_the_last_digit_are_said_to_be_copied(flanks, gear_set) -> None:
    file = flanks["pinion"]
    concave, convex = (file.flank == flank for flank in FLANKS)
    change = np.zeros(len(file))
    change[convex] = file.deviation[concave] - file.deviation[convex]
    (line,) = evaluate_member(moved(file, change), gear_set.pinion).first
    assert line.startswith("both flanks have the same deviations to the last digit")
    turn = 2 * np.pi / 12
    about = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    copy = replace(file, tooth=file.tooth + 1, point=file.point @ about.T, normal=file.normal @ about.T)
    (line,) = evaluate_member(join([file, copy]), gear_set.pinion).first
    assert line.startswith("teeth 0 and 1 have the same deviations to the last digit")
    other = moved(copy, 0.5 * UM * np.random.default_rng(9).standard_normal(len(copy)))
    assert evaluate_member(join([file, other]), gear_set.pinion).first == ()

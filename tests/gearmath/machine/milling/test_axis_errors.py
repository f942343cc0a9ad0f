"""A machine with errors: none change nothing, setting errors act like those settings, index errors become pitch."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from derivations.axes import cradle_tool_pose
from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.errors import ComputationError
from gearmath.kernels import kernel
from gearmath.lowering import lower
from gearmath.machine.milling.axis_errors import (
    index_errors,
    mounted,
    roll_position,
    with_axis_errors,
    with_backlash,
    with_setting_errors,
)
from gearmath.machine.milling.mill import mill_member
from gearmath.machine.planning.path import axis_positions
from gearmath.quality.evaluation.pitch import evaluate_pitch
from gearmath.specs.bevel_set import FLANKS, MEMBERS, SETTINGS, SIDES
from gearmath.specs.simulated_machine import AxisErrors, Harmonic, Mounting, Probe, Screw, SimulatedMachine, WorkAxis

ARCSEC = math.radians(1 / 3600)


@pytest.fixture(scope="module")
def setting_errors_only(shop) -> SimulatedMachine:
    return SimulatedMachine(title="settings", seed=1, pinion=shop.pinion, gear=shop.gear)


@pytest.mark.parametrize("member", MEMBERS)
def test_a_machine_without_errors_changes_nothing(gear_set, mill, member):
    perfect = SimulatedMachine(title="perfect", seed=5)
    true, same = mill(gear_set, member), mill(gear_set, member, errors=perfect)
    np.testing.assert_array_equal(true.deviation, same.deviation)
    np.testing.assert_array_equal(true.point, same.point)
    assert np.isnan(same.uncertainty).all()


@pytest.mark.parametrize("member", MEMBERS)
def test_roll_position_is_recovered_from_x_and_y(gear_set, witness, member):
    for flank in FLANKS:
        settings, theta = gear_set.member(member).flank(flank).vector, np.linspace(-0.5, 0.5, 101)
        axes = witness.vertical_axes(settings, theta, 0.0)
        found, off = roll_position()(settings, axes[:, 0], axes[:, 1], np.zeros(3))
        np.testing.assert_allclose(found, theta, rtol=0, atol=1e-10)
        assert off.max() < 1e-9


@pytest.mark.parametrize("member", MEMBERS)
def test_setting_errors_move_the_axes_to_where_those_settings_have_them(gear_set, shop, witness, member):
    """Positions off the cradle angle by a whole turn of A and an index angle keep both."""
    settings, theta = gear_set.member(member).flank("concave").vector, np.linspace(-0.4, 0.4, 41)
    errors, indexed = shop.setting_errors(member), np.array([0, 0, 0, 2 * np.pi + 0.7, 0])
    meant, expected = (witness.vertical_axes(x, theta, 500.0) + indexed for x in (settings, settings + errors))
    np.testing.assert_allclose(with_setting_errors(meant, settings, errors, np.zeros(3)), expected, rtol=0, atol=1e-8)


@pytest.mark.parametrize("member", MEMBERS)
def test_setting_errors_put_the_cutter_where_those_settings_have_it_also_off_the_pivot(gear_set, shop, member):
    pivot, theta = np.array([12.0, -7.0, 30.0]), np.linspace(-0.2, 0.2, 21)
    flank, errors = gear_set.member(member).concave, shop.setting_errors(member)
    axes = axis_positions(flank, theta, 500.0, pivot)
    shifted = with_setting_errors(axes, flank.vector, errors, pivot)
    found = kernel("tool_pose")(shifted, 500.0, pivot)
    expected = lower(cradle_tool_pose())(flank.vector + errors, theta)
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-8)


@pytest.mark.parametrize("member", MEMBERS)
def test_setting_errors_act_like_cutting_with_those_settings(
    gear_set, mill, setting_errors_only, altered, nominal_settings, member
):
    """The right program on the wrong machine leaves what the wrong program leaves on the right machine."""
    fine = 5e-5  # blocks of the two programs lie differently: each may deviate by this
    on_wrong_machine = mill(gear_set, member, errors=setting_errors_only, tolerance=fine)
    injected = getattr(setting_errors_only, member)
    wrong = gear_set
    for flank in FLANKS:
        spec = gear_set.member(member).flank(flank)
        off = {name: getattr(spec, name) + getattr(injected, name) for name in type(injected).model_fields}
        wrong = altered(wrong, member, flank, design=nominal_settings(spec), **off)
    on_right_machine = mill(wrong, member, tolerance=fine)
    np.testing.assert_allclose(on_wrong_machine.deviation, on_right_machine.deviation, rtol=0, atol=fine)
    assert np.abs(on_wrong_machine.deviation).max() > 0.02


@pytest.mark.parametrize("member", MEMBERS)
def test_first_cut_of_the_shop_errs_as_much_as_that_of_the_source_text(gear_set, mill, shop, witness, member):
    """20 to 30 µm, found by the virtual milling and by brute force on the cradle machine alike.

    The index error of space 0 turns A forward, which is a work rotation offset that is too small.
    """
    file = mill(gear_set, member, errors=shop.model_copy(update={"probe": Probe()}))
    assert 0.02 <= np.abs(file.deviation).max() <= 0.03
    spec = gear_set.member(member)
    for flank in FLANKS:
        nominal = solve_flank(spec, flank, blank_grid(spec))
        wrong = spec.flank(flank).vector + shop.setting_errors(member)
        wrong[SETTINGS.index("work_rotation_offset")] -= index_errors(shop.work_axis, spec.teeth, shop.seed)[0]
        left, _ = witness.left_by_cradle(wrong, SIDES[flank], nominal.point, nominal.normal, nominal.contact[:, 2])
        np.testing.assert_allclose(file.select(flank).deviation, left, rtol=0, atol=1.1e-4)  # straight blocks: 1e-4


def test_position_that_does_not_belong_to_the_settings_is_a_failure(gear_set, shop, witness):
    settings = gear_set.pinion.concave.vector
    axes = witness.vertical_axes(settings, np.linspace(-0.1, 0.1, 3), 500.0)
    axes[1, 0] += 5.0
    sentence = r"^position X .* Y .* is \d\.\d{4} mm off the path of the settings; was the program made from another"
    with pytest.raises(ComputationError, match=sentence):
        with_setting_errors(axes, settings, shop.setting_errors("pinion"), np.zeros(3))


@pytest.mark.parametrize("member", MEMBERS)
def test_index_errors_appear_as_pitch(gear_set, mill, member):
    """Tooth i is turned by the error of its space: s_i = r (ε_i - ε_0), F_p = r (max ε - min ε)."""
    spec = gear_set.member(member)
    work_axis = WorkAxis(first_harmonic_arcsec=60.0, first_harmonic_phase=-20.0, random_arcsec=10.0)
    shaky = SimulatedMachine(title="index", seed=3, work_axis=work_axis)
    file = mill(gear_set, member, range(spec.teeth), shaky)
    errors = index_errors(work_axis, spec.teeth, 3)
    for flank in FLANKS:
        pitch = evaluate_pitch(file, spec.teeth, flank)
        here = file.select(flank, 0)
        middle = (here.row == 2) & (here.col == 4)
        radius = float(np.hypot(*here.point[middle][0, :2]))
        np.testing.assert_allclose(pitch.cumulative, radius * (errors - errors[0]), rtol=0, atol=2e-4)
        assert pitch.total == pytest.approx(radius * np.ptp(errors), abs=2e-4)  # straight blocks, printed decimals


def test_first_harmonic_of_the_work_axis_by_hand():
    """45″ sin(2π i/12 + 30°): half at space 0, all of it at space 2, none at space 5."""
    errors = index_errors(WorkAxis(first_harmonic_arcsec=45.0, first_harmonic_phase=30.0), 12, 1) / ARCSEC
    assert errors[[0, 2, 5, 8, 11]] == pytest.approx([22.5, 45.0, 0.0, -45.0, 0.0], abs=1e-9)


def test_random_index_errors_are_seeded_and_of_their_size():
    axis = WorkAxis(random_arcsec=6.0)
    first, again, other = (index_errors(axis, 400, seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert not np.isclose(first, other).any()
    assert np.std(first) / ARCSEC == pytest.approx(6.0, rel=0.15)


def test_errors_of_a_member_are_in_mm_and_rad_and_the_blades_have_none(shop):
    errors = dict(zip(SETTINGS, shop.setting_errors("gear"), strict=True))
    assert errors["radial_distance"] == -0.075
    assert errors["cradle_angle"] == pytest.approx(0.0225 * math.pi / 180, rel=1e-15)
    assert errors["blade_point_radius"] == errors["blade_pressure_angle"] == 0


def wrong(**what):
    return SimulatedMachine(title="wrong", seed=0, **what)


@pytest.mark.parametrize("member", MEMBERS)
def test_machine_that_stands_too_high_leaves_the_sine_of_the_pressure_angle(gear_set, mill, member):
    """By hand: the cone moves along its own axis, off the metal by d sin α along the normal, on both flanks."""
    file = mill(gear_set, member, errors=wrong(axes=AxisErrors(Z=0.02)))
    for flank in FLANKS:
        alpha = math.radians(gear_set.member(member).flank(flank).blade_pressure_angle)
        np.testing.assert_allclose(file.select(flank).deviation, 0.02 * math.sin(alpha), rtol=0, atol=1.2e-4)


@pytest.mark.parametrize("member", MEMBERS)
def test_offset_of_the_work_axis_turns_every_flank(gear_set, mill, member):
    """δ = ε (z_w × R)·n: 0.01 degrees."""
    file = mill(gear_set, member, errors=wrong(axes=AxisErrors(A=0.01)))
    for flank in FLANKS:
        here = solve_flank(gear_set.member(member), flank, blank_grid(gear_set.member(member)))
        lever = here.point[:, 0] * here.normal[:, 1] - here.point[:, 1] * here.normal[:, 0]
        np.testing.assert_allclose(file.select(flank).deviation, math.radians(0.01) * lever, rtol=0, atol=1.5e-4)


@pytest.mark.parametrize("member", MEMBERS)
def test_eccentric_and_tilted_work_deviates_by_what_it_is_moved_against_the_cutter(gear_set, mill, member):
    """The cutter's surface stays, the nominal one moves by e + ω × R: δ = -(e + ω × R)·n, to first order."""
    seat = Mounting(eccentricity=0.02, eccentricity_direction=35.0, tilt=0.01, tilt_direction=-70.0)
    file = mill(gear_set, member, errors=wrong(mounting=seat))
    at, about = math.radians(35.0), math.radians(-70.0)
    e = 0.02 * np.array([math.cos(at), math.sin(at), 0.0])
    omega = math.radians(0.01) * np.array([math.cos(about), math.sin(about), 0.0])
    for flank in FLANKS:
        here = solve_flank(gear_set.member(member), flank, blank_grid(gear_set.member(member)))
        expected = -((e + np.cross(omega, here.point)) * here.normal).sum(axis=1)
        np.testing.assert_allclose(file.select(flank).deviation, expected, rtol=0, atol=2e-4)
        assert np.ptp(expected) > 1e-3


def by_rigid_motion(witness, spec, flank, height, moved):
    """What is left on the grid where the tool moves by ``moved`` (3,) in the machine at contact, against its teeth.

    ``moved`` gets X Y Z A B (5,) of the contact and its place in the machine p_m = M(B) Rz(-A) p_w, and everything is
    typed from the conventions.
    """
    here = solve_flank(spec, flank, blank_grid(spec))
    axes = witness.vertical_axes(spec.flank(flank).vector, here.contact[:, 2], height)
    left = []
    for at, point, normal in zip(axes, here.point, here.normal, strict=True):
        (c, s), (cb, sb) = ((math.cos(angle), math.sin(angle)) for angle in at[3:])
        into = np.array([[-sb, 0, -cb], [0, 1, 0], [cb, 0, -sb]]) @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
        left.append(moved(at, into @ point) @ (into @ normal))
    return np.array(left)


def against_b(at, place):
    """The work turns by dB: its place moves by M'(B) M(B)^-1 p_m, which the tool does the other way in the work."""
    cb, sb = math.cos(at[4]), math.sin(at[4])
    along = np.array([[-sb, 0, -cb], [0, 1, 0], [cb, 0, -sb]])
    change = np.array([[-cb, 0, sb], [0, 0, 0], [-sb, 0, -cb]])
    return -change @ along.T @ place


#: Straight blocks may leave this much. [mm]
TOLERANCE = 1e-4
#: What is wrong, and how the tool is displaced from the work by it, in the machine.
MOVES = {
    "X": (AxisErrors(X=0.02), lambda at, place: np.array([0.02, 0, 0])),
    "Y": (AxisErrors(Y=-0.02), lambda at, place: np.array([0, -0.02, 0])),
    "Z": (AxisErrors(Z=0.005), lambda at, place: np.array([0, 0, 0.005])),
    "B": (AxisErrors(B=0.01), lambda at, place: math.radians(0.01) * against_b(at, place)),
    "square": (AxisErrors(squareness_x_z_um_per_m=50.0), lambda at, place: np.array([50e-6 * at[2], 0, 0])),
}


@pytest.fixture(scope="module")
def one_space(gear_set, program, vertical):
    """``one_space(member, errors)``: what one and the same program leaves on a machine with errors of its axes."""
    paths = {member: program(gear_set, member, tolerance=TOLERANCE) for member in MEMBERS}

    @cache
    def left(member, errors=None):
        shop = None if errors is None else wrong(axes=errors)
        return mill_member(paths[member], gear_set.member(member), vertical, shop)

    return left


@pytest.mark.parametrize("member", MEMBERS)
@pytest.mark.parametrize("what", MOVES)
def test_axis_that_errs_leaves_what_the_rigid_motion_says(gear_set, one_space, vertical, witness, member, what):
    """To first order δ = u·n, u the tool's way against the work at the contact, all of it worked out in the machine.

    Half the difference of both signs of an error has no second order, half the sum nothing else.
    """
    errors, moved = MOVES[what]
    opposite = AxisErrors(**{key: -getattr(errors, key) for key in (*"XYZAB", "squareness_x_z_um_per_m")})
    files = one_space(member, errors), one_space(member, opposite), one_space(member)
    for flank in FLANKS:
        one, other, nominal = (file.select(flank).deviation for file in files)
        expected = by_rigid_motion(witness, gear_set.member(member), flank, vertical.pivot_height, moved)
        assert np.abs(expected).max() > 10 * TOLERANCE
        np.testing.assert_allclose((one - other) / 2, expected, rtol=0, atol=TOLERANCE / 3)
        np.testing.assert_allclose((one + other) / 2, nominal, rtol=0, atol=TOLERANCE)


def test_axes_out_of_square_and_unevenly_divided_by_hand():
    """100 µm/m over 300 mm of Z is 30 µm of X; 20″ of third order at A = 30° with a phase of 0 is all of it."""
    axes = np.array([[1.0, 2.0, 300.0, math.radians(30.0), 0.5]])
    errors = wrong(
        axes=AxisErrors(Y=0.5, squareness_x_z_um_per_m=100.0, A_harmonics=(Harmonic(order=3, amplitude_arcsec=20.0),))
    )
    moved = with_axis_errors(axes, errors) - axes
    np.testing.assert_allclose(moved, [[0.03, 0.5, 0.0, 20.0 * ARCSEC, 0.0]], rtol=0, atol=1e-12)


def test_ball_screw_errs_with_every_turn_by_hand():
    """A quarter turn of a lead of 8 mm after its zero is all of the 3 µm, on the axis of the screw only."""
    screw = Screw(axis="Y", lead=8.0, amplitude_um=3.0, phase=-90.0)
    axes = np.array([[1.0, 4.0, 300.0, 0.1, 0.5], [1.0, 6.0, 300.0, 0.1, 0.5]])
    moved = with_axis_errors(axes, wrong(axes=AxisErrors(screws=(screw,)))) - axes
    np.testing.assert_allclose(moved[:, 1], [0.003, 0.0], rtol=0, atol=1e-12)
    assert not moved[:, [0, 2, 3, 4]].any()


def test_ball_screw_ripple_does_not_hide_between_the_ends_of_blocks(gear_set, program, vertical):
    """A coarse program, whose blocks are longer than a turn of the screw, and the same with each block in 32 parts."""
    screw = wrong(axes=AxisErrors(screws=(Screw(axis="X", lead=2.0, amplitude_um=5.0),)))
    coarse = program(gear_set, "gear", tolerance=5e-3)
    blocks = np.flatnonzero(~coarse.rapid)
    assert np.abs(np.diff(coarse.axes, axis=0))[blocks - 1, 0].max() > 2.0
    parts = np.where(coarse.rapid, 1, 32)
    own = np.repeat(np.arange(len(coarse.axes)), parts)
    share = np.concatenate([np.arange(1, n + 1) / n for n in parts])[:, None]
    axes = coarse.axes[own - 1] * (1 - share) + coarse.axes[own] * share
    axes[0] = coarse.axes[0]
    others = {name: getattr(coarse, name)[own] for name in ("rapid", "tool", "line", "seconds", "rpm")}
    fine = replace(coarse, axes=axes, inner=np.zeros(len(own), dtype=bool), **others)
    member = gear_set.gear
    none, one, other = (
        mill_member(path, member, vertical, errors).deviation
        for path, errors in ((coarse, None), (coarse, screw), (fine, screw))
    )
    assert np.abs(one - none).max() > 1e-3
    # 24 chords to a period of 5 um leave out 0.04 um
    np.testing.assert_allclose(one, other, rtol=0, atol=6e-5)


def test_backlash_stands_until_the_play_is_taken_up_by_hand():
    """2 units of play: forwards 1 behind, back by 1 nothing moves, by 3 in all it moves by 1, and then 1 ahead."""
    unit = 30.0 * ARCSEC
    told, real = [0.0, 5.0, 4.0, 2.0, 1.0, 2.0, 4.0], [-1.0, 4.0, 4.0, 3.0, 2.0, 2.0, 3.0]
    axes = np.zeros((7, 5))
    axes[:, 3], axes[:, 0] = np.array(told) * unit, np.arange(7.0)
    moved = with_backlash(axes, wrong(axes=AxisErrors(A_backlash_arcsec=60.0)))
    np.testing.assert_allclose(moved[:, 3] / unit, real, rtol=0, atol=1e-9)
    np.testing.assert_array_equal(np.delete(moved, 3, axis=1), np.delete(axes, 3, axis=1))
    turned = with_backlash(axes[:, [0, 1, 2, 4, 3]], wrong(axes=AxisErrors(B_backlash_arcsec=60.0)))
    np.testing.assert_array_equal(turned[:, 4], moved[:, 3])


@pytest.mark.parametrize("member", MEMBERS)
def test_backlash_turns_a_milled_flank_by_half_of_it_against_the_roll(gear_set, program, vertical, member):
    """A work axis that lags by 10 arcsec all through the roll leaves a deviation of 10 arcsec."""
    path = program(gear_set, member)
    cutting = np.flatnonzero(~path.rapid)
    for tool in range(len(path.tools)):
        rows = cutting[path.tool[cutting] == tool]
        steps = np.diff(path.axes[rows, 3])
        (direction,) = set(np.sign(steps[np.abs(steps) > 1e-9]).tolist())
    offset = AxisErrors(A=-direction * 10.0 / 3600)
    one, other, none = (
        mill_member(path, gear_set.member(member), vertical, errors).deviation
        for errors in (wrong(axes=AxisErrors(A_backlash_arcsec=20.0)), wrong(axes=offset), None)
    )
    assert np.abs(one - none).max() > 5e-4
    np.testing.assert_allclose(one, other, rtol=0, atol=2e-5)


def test_work_that_sits_well_stays_where_it_is():
    generator = np.random.default_rng(5)
    point, normal = generator.normal(size=(2, 4, 3))
    np.testing.assert_allclose(mounted(point, normal, Mounting()), (point, normal), rtol=0, atol=1e-15)


@pytest.mark.parametrize(
    ("key", "value"), [("X", 1.5), ("B", -2.0), ("squareness_x_z_um_per_m", 2000.0), ("A_harmonics", ({"order": 0},))]
)
def test_axis_errors_beyond_their_limits_are_refused(key, value):
    with pytest.raises(ValueError, match=key):
        AxisErrors(**{key: value})

"""From settings to program text: indexing, the order of tools and spaces, what the head of the program says."""

from __future__ import annotations

import re

import numpy as np
import pytest

from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.machine.control.executor import execute
from gearmath.machine.milling.mill import mill_member
from gearmath.machine.planning.cut_plan import CuttingJob, pass_count
from gearmath.machine.planning.passes import tooth_angles
from gearmath.machine.writing.cutting import cutting_program
from gearmath.specs.bevel_set import FLANKS, MEMBERS, Motion, load_bevel_set, settings_sha256
from gearmath.specs.toml import bundled


def passes(path):
    """Positions (n,5) of every pass, rapid blocks left out."""
    number = np.cumsum(path.rapid)
    return [path.axes[(number == k) & ~path.rapid] for k in np.unique(number[~path.rapid])]


def test_teeth_are_counted_and_never_summed():
    angles = tooth_angles(7)
    np.testing.assert_allclose(angles, [k * 2 * np.pi / 7 for k in range(7)], rtol=1e-15)
    corrected = tooth_angles(3, np.radians((0.0, 0.5, -0.25)))
    np.testing.assert_allclose(np.degrees(corrected), [0, 120.5, 239.75], rtol=1e-14)


def test_first_pass_goes_where_the_cradle_machine_of_the_witness_goes(gear_set, vertical, witness):
    """The roll of space 0 in the text, against the NumPy machine at the cradle angles that X and Y stand for."""
    path = execute(cutting_program(gear_set, "gear", vertical, "GEAR"), "GEAR.MPF")
    (roll,) = passes(path)
    settings = gear_set.gear.concave.vector
    samples = np.linspace(-0.5, 0.5, 50_001)
    X = witness.vertical_axes(settings, samples, 0.0)[:, 0]  # rises or falls all the way
    order = np.argsort(X)
    theta = np.interp(roll[:, 0], X[order], samples[order])
    expected = witness.vertical_axes(settings, theta, vertical.pivot_height)
    off = roll - expected
    off[:, 3] = (off[:, 3] + np.pi) % (2 * np.pi) - np.pi
    assert np.abs(off[:, :3]).max() < 2e-5  # five printed decimals
    assert np.abs(off[:, 3:]).max() < 2e-7


def test_spaces_are_cut_in_order_by_every_tool_and_differ_in_a_alone(gear_set, vertical):
    path = execute(cutting_program(gear_set, "pinion", vertical, "PINION", CuttingJob((0, 4, 2))), "PINION.MPF")
    assert path.tools == ("PINION_CONCAVE", "PINION_CONVEX")
    rolls = passes(path)
    assert len(rolls) == 6
    for first, *others in (rolls[:3], rolls[3:]):
        for roll, space in zip(others, (4, 2), strict=True):
            np.testing.assert_array_equal(roll[:, [0, 1, 2, 4]], first[:, [0, 1, 2, 4]])
            turned = (roll[:, 3] - first[:, 3] - space * np.pi / 6 + np.pi) % (2 * np.pi) - np.pi
            assert np.abs(turned).max() < np.radians(1.1e-6)  # six printed decimals each


def test_index_correction_turns_its_own_space_alone(gear_set, vertical):
    correction = tuple(0.01 * k for k in range(12))
    corrected = gear_set.model_copy(
        update={"pinion": gear_set.pinion.model_copy(update={"index_correction": correction})}
    )
    plain, turned = (
        passes(execute(cutting_program(s, "pinion", vertical, "PINION", CuttingJob(range(12))), "P.MPF"))
        for s in (gear_set, corrected)
    )
    for k, (before, after) in enumerate(zip(plain, turned, strict=True)):
        shift = np.degrees((after[:, 3] - before[:, 3] + np.pi) % (2 * np.pi) - np.pi)
        np.testing.assert_allclose(shift, 0.01 * (k % 12), rtol=0, atol=1.1e-6)
        np.testing.assert_array_equal(after[:, [0, 1, 2, 4]], before[:, [0, 1, 2, 4]])


def test_head_says_what_the_program_was_made_from_in_plain_ascii(gear_set, vertical):
    odd = gear_set.model_copy(update={"title": "Kegelräder 12×36\n; M30"})
    lines = cutting_program(odd, "gear", vertical, "GEAR", CuttingJob(tolerance=5e-4, feed=250.0)).split("\n")
    head = [line for line in lines[:14] if line.startswith(";")]
    assert "; set: Kegelr?der 12?36?; M30" in head
    assert "; member: gear, 36 teeth, right hand, completing" in head
    assert f"; machine settings sha256: {settings_sha256(gear_set.gear)}" in head
    assert "; flank tolerance: 0.5 um along the tooth normal, by straight blocks and rounding" in head
    assert "; feed: 250 mm/min at the tooth" in head
    assert not re.search(r"\b20\d\d-", "\n".join(head))  # no date: the same settings give the same text


def test_program_is_the_same_text_every_time_and_another_for_other_settings(gear_set, vertical, altered):
    first, again = (cutting_program(gear_set, "gear", vertical, "GEAR") for _ in range(2))
    assert first == again
    other = altered(gear_set, "gear", "concave", radial_distance=72.65)
    assert settings_sha256(other.gear) != settings_sha256(gear_set.gear)
    assert cutting_program(other, "gear", vertical, "GEAR") != first


def test_finer_tolerance_makes_more_blocks(gear_set, vertical):
    coarse, fine = (
        cutting_program(gear_set, "gear", vertical, "GEAR", CuttingJob(tolerance=t)).count("G93") for t in (1e-2, 1e-4)
    )
    assert fine > 5 * coarse


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"spaces": (0, 36)}, r"^gear: space 36: must be a number from 0 to 35$"),
        ({"spaces": ()}, "there is no tooth space to cut"),
        ({"roughing_stock": 6.0}, r"^roughing_stock = 6\.0 mm: must lie between 0 and 5 mm$"),
        ({"finishing_stock": float("nan")}, "^finishing_stock = nan mm: must lie between"),
        ({"roughing_stock": 0.1, "finishing_stock": 0.1}, "roughing_stock = 0.1 mm: must be more than the finishing"),
        ({"tolerance": float("nan")}, "tolerance = nan um: must lie between"),
        ({"feed": 0.0}, "feed = 0.0 mm/min: must be greater than 0"),
        ({"spindle_rpm": 5000.0}, "spindle speed = 5000.0 rpm: .* 20 to 3000 rpm"),
        ({"program_name": "1ST"}, "program name '1ST': must be"),
    ],
)
def test_what_the_control_cannot_run_is_refused(gear_set, vertical, changes, words):
    changes = dict(changes)
    program_name = changes.pop("program_name", "GEAR")
    with pytest.raises(InputError, match=words):
        cutting_program(gear_set, "gear", vertical, program_name, CuttingJob(**changes))


def test_travel_that_is_too_short_is_refused_by_axis_and_limit(gear_set, vertical):
    short = vertical.axes.model_copy(update={"Y": vertical.axes.Y.model_copy(update={"travel": (-10.0, 10.0)})})
    with pytest.raises(
        InputError, match=r"^gear, space 0 .*: axis Y = .* mm at cradle angle -15\.\d* deg: .* -10 to 10 mm"
    ):
        cutting_program(gear_set, "gear", vertical.model_copy(update={"axes": short}), "GEAR")


def test_unknown_member_is_refused(gear_set, vertical):
    with pytest.raises(InputError, match=r"^member = 'wheel': must be pinion or gear$"):
        cutting_program(gear_set, "wheel", vertical, "GEAR")


@pytest.fixture
def left(vertical):
    """``left(gear_set, member, **job)``: deviations (2, 45) [mm] that a program of one space leaves on both flanks."""

    def run(gear_set, member, machine=vertical, **job):
        text = cutting_program(gear_set, member, machine, "PART", CuttingJob(**job))
        file = mill_member(execute(text, "PART.MPF"), gear_set.member(member), machine)
        return np.stack([file.select(flank, 0).deviation for flank in FLANKS])

    return run


@pytest.mark.parametrize("member", MEMBERS)
def test_finishing_stock_stays_on_both_flanks_everywhere(gear_set, left, member):
    """Within the tolerance: the withdrawn cone is parallel to itself. Both blades of the gear have 22 degrees."""
    deviation = left(gear_set, member, finishing_stock=0.15, tolerance=1e-3)
    np.testing.assert_allclose(deviation, 0.15, rtol=0, atol=1e-3)


@pytest.mark.parametrize("member", MEMBERS)
def test_roughing_goes_through_all_spaces_first_and_changes_nothing_of_the_finished_flank(
    gear_set, vertical, left, member
):
    text = cutting_program(gear_set, member, vertical, "PART", CuttingJob((0, 3), roughing_stock=0.3))
    labels = [line.partition(": ")[2] for line in text.split("\n") if line.startswith("; section")]
    passes = [["", *label.partition(", tooth")[0].split()] for label in labels]
    order = [(stage, space) for _, _, space, *_, stage in passes]
    assert order == [("rough", "0"), ("rough", "3"), ("finish", "0"), ("finish", "3")] * (
        2 if member == "pinion" else 1
    )
    deviation = left(gear_set, member, roughing_stock=0.3)
    assert np.abs(deviation).max() <= 1e-4


def test_a_dry_run_is_the_same_program_sixty_millimetres_above_and_without_coolant(gear_set, vertical):
    wet, dry = (cutting_program(gear_set, "gear", vertical, "GEAR", CuttingJob(dry_run=run)) for run in (False, True))
    assert "M8" in wet
    assert "M8" not in dry
    assert "; dry run: Z raised by 60 mm" in dry
    difference = execute(dry, "D.MPF").axes - execute(wet, "W.MPF").axes
    assert (difference[[0, -1]] == 0.0).all()  # from the home of Z, and back to it
    np.testing.assert_allclose(difference[1:-1], np.broadcast_to([0, 0, 60, 0, 0], difference[1:-1].shape), atol=1e-12)


@pytest.mark.parametrize("member", MEMBERS)
def test_program_for_an_apex_off_the_b_axis_cuts_the_same_flanks(gear_set, vertical, left, member):
    """Tilted, so that B moves in the roll and the offset bends the blocks."""
    spec = gear_set.member(member)
    tilted = {f: spec.flank(f).model_copy(update={"cutter_tilt": 0.4, "cutter_swivel": -25.0}) for f in FLANKS}
    changed = gear_set.model_copy(update={member: spec.model_copy(update=tilted)})
    machine = vertical.model_copy(update={"pivot_offset": (35.0, -4.0, 60.0)})
    assert np.abs(left(changed, member, machine)).max() <= 1e-4


def test_formate_plunges_and_dwells_for_more_than_a_turn(gear_set, vertical):
    """The flank is the cone at the bottom: the last position is that of cradle rotation zero."""
    formate = gear_set.model_copy(update={"gear": gear_set.gear.model_copy(update={"generation": "formate"})})
    text = cutting_program(formate, "gear", vertical, "GEAR", CuttingJob(spindle_rpm=60.0))
    path = execute(text, "GEAR.MPF")
    bottom = kernel("axis_transform")(gear_set.gear.concave.vector, 0.0, vertical.pivot_height)[0]
    (roll,) = passes(path)
    np.testing.assert_allclose(roll[-1][[0, 1, 2, 4]], bottom[[0, 1, 2, 4]], rtol=0, atol=6e-6)
    assert np.ptp(roll[:, [0, 1, 3, 4]], axis=0).max() == 0
    assert roll[0, 2] - roll[-1, 2] > 2 * 5.5  # starts above the tooth
    assert "G4 F1.5" in text


def test_one_cutter_with_two_motions_is_refused(gear_set, vertical):
    moving = gear_set.gear.convex.model_copy(update={"motion": Motion(sliding_base=(1.0,))})
    with pytest.raises(InputError, match=r"^gear: motion: one cutter cuts both flanks at once"):
        cutting_program(
            gear_set.model_copy(update={"gear": gear_set.gear.model_copy(update={"convex": moving})}),
            "gear",
            vertical,
            "GEAR",
        )


def test_moving_settings_are_cut_to_tolerance(gear_set, left):
    """Modified roll and helical motion on the pinion: milled from the text against the flanks of chapter 10."""
    motion = Motion(sliding_base=(1.5, -0.8), modified_roll=(0.03, -0.05))
    pinion = gear_set.pinion.model_copy(
        update={f: gear_set.pinion.flank(f).model_copy(update={"motion": motion}) for f in FLANKS}
    )
    assert np.abs(left(gear_set.model_copy(update={"pinion": pinion}), "pinion")).max() <= 1e-4


@pytest.mark.parametrize(
    ("gear_set_name", "member", "job"),
    [
        ("nasa_tp3096_12x36", "pinion", CuttingJob((0, 3, 5), 1e-2, roughing_stock=0.3)),
        ("nasa_tp3096_12x36", "gear", CuttingJob((0, 3), 1e-2)),
        ("crown_gear_hobbed_14x39", "gear", CuttingJob(range(39), 1e-2)),
    ],
)
def test_progress_hears_of_as_many_passes_as_are_announced(vertical, gear_set_name, member, job):
    """Two cutters, two stages and three spaces are twelve; a hobbed member is cut in one."""
    one, heard = load_bevel_set(bundled(f"{gear_set_name}.toml")), []
    cutting_program(one, member, vertical, "PART", job, heard.append)
    assert sum(heard) == pass_count(one.member(member), job)
    assert sum(heard) == {"pinion": 12, "gear": 1 if "hobbed" in gear_set_name else 2}[member]

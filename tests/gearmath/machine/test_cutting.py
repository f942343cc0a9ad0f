"""From settings to program text: indexing, the order of tools and spaces, what the head of the program says."""

from __future__ import annotations

import numpy as np
import pytest

from gearmath.errors import InputError
from gearmath.machine.cutting import cutting_program, tooth_angles
from gearmath.machine.reader import execute
from gearmath.specs.bevel_set import settings_sha256


def passes(path):
    """Positions (n,5) of every pass, rapid blocks left out."""
    number = np.cumsum(path.rapid)
    return [path.axes[(number == k) & ~path.rapid] for k in np.unique(number[~path.rapid])]


def test_teeth_are_counted_and_never_summed():
    angles = tooth_angles(7)
    np.testing.assert_allclose(angles, [k * 2 * np.pi / 7 for k in range(7)], rtol=1e-15)
    corrected = tooth_angles(3, (0.0, 0.5, -0.25))
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
    path = execute(cutting_program(gear_set, "pinion", vertical, "PINION", (0, 4, 2)), "PINION.MPF")
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
        passes(execute(cutting_program(s, "pinion", vertical, "PINION", range(12)), "P.MPF"))
        for s in (gear_set, corrected)
    )
    for k, (before, after) in enumerate(zip(plain, turned, strict=True)):
        shift = np.degrees((after[:, 3] - before[:, 3] + np.pi) % (2 * np.pi) - np.pi)
        np.testing.assert_allclose(shift, 0.01 * (k % 12), rtol=0, atol=1.1e-6)
        np.testing.assert_array_equal(after[:, [0, 1, 2, 4]], before[:, [0, 1, 2, 4]])


def test_head_says_what_the_program_was_made_from_in_plain_ascii(gear_set, vertical):
    odd = gear_set.model_copy(update={"title": "Kegelräder 12×36\n; M30"})
    lines = cutting_program(odd, "gear", vertical, "GEAR", tolerance=5e-4).split("\n")
    head = [line for line in lines[:8] if line.startswith(";")]
    assert "; set: Kegelr?der 12?36?; M30" in head
    assert "; member: gear, 36 teeth, right hand, completing" in head
    assert f"; settings sha256: {settings_sha256(gear_set.gear)}" in head
    assert "; flank tolerance: 0.5 um along the tooth normal" in head


def test_program_is_the_same_text_every_time_and_another_for_other_settings(gear_set, vertical, altered):
    first, again = (cutting_program(gear_set, "gear", vertical, "GEAR") for _ in range(2))
    assert first == again
    other = altered(gear_set, "gear", "concave", radial_distance=72.65)
    assert settings_sha256(other.gear) != settings_sha256(gear_set.gear)
    assert cutting_program(other, "gear", vertical, "GEAR") != first


def test_finer_tolerance_makes_more_blocks(gear_set, vertical):
    coarse, fine = (cutting_program(gear_set, "gear", vertical, "GEAR", tolerance=t).count("G93") for t in (1e-2, 1e-4))
    assert fine > 5 * coarse


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"tolerance": float("nan")}, "tolerance = nan um: must lie between"),
        ({"feed": 0.0}, "feed = 0.0 mm/min: must be greater than 0"),
        ({"spindle_rpm": 5000.0}, "spindle speed = 5000.0 rpm: .* 20 to 3000 rpm"),
        ({"program_name": "1ST"}, "program name '1ST': must be"),
    ],
)
def test_what_the_control_cannot_run_is_refused(gear_set, vertical, changes, words):
    arguments = {"bevel_set": gear_set, "name": "gear", "machine": vertical, "program_name": "GEAR"} | changes
    with pytest.raises(InputError, match=words):
        cutting_program(**arguments)


def test_travel_that_is_too_short_is_refused_by_axis_and_limit(gear_set, vertical):
    short = vertical.axes.model_copy(update={"Y": vertical.axes.Y.model_copy(update={"travel": (-10.0, 10.0)})})
    with pytest.raises(InputError, match=r"axis Y = .* mm at point 0: .* travels -10 to 10 mm"):
        cutting_program(gear_set, "gear", vertical.model_copy(update={"axes": short}), "GEAR")


def test_unknown_member_is_refused(gear_set, vertical):
    with pytest.raises(InputError, match=r"^member = 'wheel': must be pinion or gear$"):
        cutting_program(gear_set, "wheel", vertical, "GEAR")

"""The check of a probing program from its text: distances by hand, and set-ups that collide."""

from __future__ import annotations

import re

import numpy as np
import pytest

from gearmath.errors import InputError
from gearmath.machine.bodies.profiles import work_profiles
from gearmath.machine.measuring.collision_check import approaches
from gearmath.machine.measuring.probe import ProbeMachine
from gearmath.machine.planning.targets import tip_positions
from gearmath.machine.writing.probing import probing_program
from gearmath.specs.calibration import load_calibration
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.simulated_machine import Fixture
from gearmath.specs.toml import bundled

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
PROBE = load_calibration(bundled("probe.toml"))


@pytest.fixture(scope="module")
def program(gear_set):
    """The topography of tooth 0 of the gear, with the probe of the bundled file."""
    return probing_program(gear_set, "gear", MACHINE, PROBE, "PROBE", pitch=False)


def of(found):
    return {(one.probe, one.work): one for one in found}


def test_cheap_probe_sees_what_the_exact_contact_search_sees(gear_set):
    """Every distance within a step: its touches end where those of the contact search do, to some 5 um."""
    text = probing_program(gear_set, "pinion", MACHINE, PROBE, "PROBE", topography=(), around=(0, 5))
    heard = []
    found = of(approaches(text, "P", gear_set.pinion, MACHINE, PROBE, progress=heard.append))
    moves = 1 + 3 * 2 * (13 + 2 * 4)  # from home; sideways, down, touch: 13 reference points, 2 * 4 corners
    assert moves < sum(heard) <= moves + text.count("\n")
    there = ProbeMachine(gear_set.pinion, MACHINE, PROBE)
    exact = of(approaches(text, "P", gear_set.pinion, MACHINE, PROBE, probe=there))
    assert found.keys() == exact.keys()
    for pair, one in found.items():
        assert one.distance == pytest.approx(exact[pair].distance, abs=0.1)
    assert min(one.distance for one in found.values()) > 0.2


def test_distance_to_the_fixture_is_that_of_the_tip_beside_it_by_hand(gear_set):
    """Tip beside a cylinder of 40 mm radius behind the pinion; the stylus points away from the axis of the work."""
    member, fixture = gear_set.pinion, Fixture(radius=40.0, length=200.0)
    z = work_profiles(member, fixture)["fixture"][:, 0].max() - 60.0
    for gap in (5.0, 0.5, -0.3):
        tip = np.array([[40.0 + PROBE.tip_radius + gap, 0.0, z]])
        X, Y, Z, A, B = tip_positions(tip, np.zeros(1), np.radians(16.87), MACHINE, PROBE)[0]
        words = f"X{X:.6f} Y{Y:.6f} Z{Z:.6f} A=DC({np.degrees(A):.6f}) B{np.degrees(B):.6f}"
        text = f'G17 G40 G90 G710 G94 G54\nT="PROBE" D1\nM6\nSPOS=0\nG0 {words}\nG0 Y{Y:.6f}\nM30\n'
        found = of(approaches(text, "P", member, MACHINE, PROBE, fixture))
        assert found["tip", "fixture"].distance == pytest.approx(gap, abs=2e-6)


def line_down(program, change):
    """The program with the ways down into a space ``change`` mm longer, and the number of their line."""
    lines = program.split("\n")
    k = next(k for k, line in enumerate(lines) if "MEAS=1" in line and "Z=UWAY" in line)
    lines[k] = lines[k].replace("Z=UWAY[UPLACE,2]", f"Z=UWAY[UPLACE,2]-{change}")
    return "\n".join(lines), k + 1


def test_tip_that_goes_down_too_far_is_found_with_its_line(gear_set, program):
    """20 mm too far is in the root."""
    text, line = line_down(program, 20.0)
    found = of(approaches(text, "P", gear_set.gear, MACHINE, PROBE))
    assert found["tip", "teeth"].line == line
    assert found["tip", "teeth"].distance < -1.0


def test_rapid_block_through_far_teeth_is_found(gear_set, program):
    """Y goes 30 mm across the gear at the height at which the tip stands in the space."""
    text = program
    lines = text.split("\n")
    k = next(k for k, line in enumerate(lines) if " G1 X=" in line and "MEAS" not in line)
    lines[k] += "\nG0 Y=UWAY[UPLACE,1]+30"
    found = of(approaches("\n".join(lines), "P", gear_set.gear, MACHINE, PROBE))
    assert found["tip", "teeth"].distance < -0.5
    assert found["tip", "teeth"].line in (k + 2, k + 3)
    assert found["stylus", "teeth"].distance < 0.0


def test_gear_that_stands_half_a_pitch_off_is_met(gear_set, program):
    """The tip goes down into the metal of a tooth."""
    half = re.sub(r"(UTURN\[\d+\]=)(\S+)", lambda m: f"{m[1]}{float(m[2]) + 5.0}", program)
    assert half.count("UTURN") == program.count("UTURN") > 36
    found = of(approaches(half, "P", gear_set.gear, MACHINE, PROBE))
    assert found["tip", "teeth"].distance < -0.5


@pytest.mark.parametrize(("radius", "meets"), [(40.0, False), (120.0, True)])
def test_fixture_close_behind_the_heel_is_met_by_the_spindle_of_a_short_probe(gear_set, radius, meets):
    short = PROBE.model_copy(update={"length": 60.0})
    text = probing_program(gear_set, "pinion", MACHINE, short, "PROBE", pitch=False)
    fixture = Fixture(radius=radius, shank_length=5.0)
    found = of(approaches(text, "P", gear_set.pinion, MACHINE, short, fixture))
    assert (found["spindle", "fixture"].distance < 0.0) is meets
    assert found["spindle", "teeth"].distance > 0.0


def test_spindle_stands_as_far_above_the_teeth_as_the_probe_is_long(gear_set):
    """The gauge line goes up with the length of the probe, and so does the least distance to the work."""
    member = gear_set.pinion
    near, far = (
        of(
            approaches(
                probing_program(gear_set, "pinion", MACHINE, one, "PROBE", topography=()), "P", member, MACHINE, one
            )
        )["spindle", "teeth"].distance
        for one in (PROBE.model_copy(update={"length": length}) for length in (60.0, 200.0))
    )
    assert far - near == pytest.approx(140.0, abs=1e-6)
    edge = work_profiles(member, Fixture())["teeth"]
    depth = np.linalg.norm(edge[-1] - edge[0])  # no touch is deeper under the face cone than the face is wide
    assert 200.0 - depth < far < 200.0


def test_program_that_touches_nothing_is_refused_with_line_and_alarm(gear_set, program):
    lifted = program.replace("Z=UWAY[UPLACE,5] A", "Z=UWAY[UPLACE,5]+50 A")
    assert lifted != program
    with pytest.raises(InputError, match=r"P, line \d+, column 1: the program sets alarm 65001 on the nominal member"):
        approaches(lifted, "P", gear_set.gear, MACHINE, PROBE)


@pytest.mark.parametrize(
    ("length", "fixture", "sentence"),
    [
        (6.0, "", r"PP\.MPF, line \d+: the spindle of the probe meets the teeth, \d\.\d{3} mm deep: .* not written"),
        (60.0, "[fixture]\nradius = 150.0\nshank_length = 5.0\n", r"the spindle of the probe meets the fixture"),
        # the edge of the fixture stands 240 mm above the touches and 138 mm behind them
        (
            200.0,
            "[fixture]\nradius = 300.0\n[cutter_head]\nspindle_radius = 150.0\n",
            r"the spindle of the probe meets the fixture",
        ),
    ],
)
def test_command_refuses_what_collides_and_writes_nothing(refused, command, tmp_path, length, fixture, sentence):
    probe, errors, out = tmp_path / "probe.toml", tmp_path / "shop.toml", tmp_path / "out"
    out.mkdir()
    stylus = f"stylus_radius = 0.5\nstylus_length = {min(length / 2, 30.0)}\n"
    probe.write_text(f'name = "short"\nlength = {length}\ntip_radius = 0.75\n{stylus}')
    errors.write_text(f'title = "big fixture"\nseed = 1\n{fixture}')
    arguments = ["nc", "probe", "nasa_tp3096_12x36.toml", "--member", "pinion", "--no-pitch"]
    refused(sentence, *arguments, "--calibration", probe, "--errors", errors, "-o", out / "PP.MPF")
    assert list(out.iterdir()) == []
    status, said, _ = command(*arguments, "-o", out / "PP.MPF")
    assert status == 0
    least = re.search(r"least clearance: tip (\S+) mm \(\w+\), stylus (\S+) mm \(\w+\), spindle (\S+) mm", said)
    assert all(float(value) > 0.2 for value in least.groups())

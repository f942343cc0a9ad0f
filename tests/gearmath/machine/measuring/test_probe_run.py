"""``gearmath probe``: programs run on the machine model, against plain geometry and the simulated measurement."""

from __future__ import annotations

import json
import math
import re

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.errors import ComputationError, InputError
from gearmath.machine.control.executor import run_program
from gearmath.machine.control.state import Setup
from gearmath.machine.measuring.artefacts import Artefacts
from gearmath.machine.measuring.measurement import measure_member
from gearmath.machine.measuring.probe import ProbeMachine
from gearmath.machine.measuring.probe_run import run_touches, touch_count, touches_artefacts
from gearmath.machine.writing.axis_cycle import axis_program
from gearmath.machine.writing.calibrating import calibration_program
from gearmath.machine.writing.probing import probing_program
from gearmath.quality.evaluation.touches import measured_member
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.calibration import load_calibration
from gearmath.specs.flank_csv import join
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.simulated_machine import AxisErrors, Drift, Mounting, Probe, SimulatedMachine, SimulatedMeasuring
from gearmath.specs.toml import bundled
from gearmath.specs.touch_csv import RING, RING_FACE, SPHERE, read_calibration_csv, read_touch_csv

NASA = "nasa_tp3096_12x36.toml"
MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
PROBE = load_calibration(bundled("probe.toml"))
BENT = PROBE.model_copy(update={"offset": (0.031, -0.047, 0.012), "tip_radius": 0.7432})
OFF_AXIS = MACHINE.model_copy(update={"pivot_offset": (0.12, -0.09, 0.2)})


def shop(**what) -> SimulatedMachine:
    return SimulatedMachine(title="wrong", seed=3, **what)


def calibrated(tmp_path, text, machine, probe, errors=None, run=1):
    (tmp_path / "raw.csv").write_text(run_touches(text, "P.MPF", Artefacts(machine, probe), errors, run=run))
    return read_calibration_csv(tmp_path / "raw.csv")


def test_tip_stops_where_it_touches_ring_face_and_sphere(tmp_path):
    """By plain distances: the program of the believed probe, run with the true one."""
    found = calibrated(tmp_path, calibration_program(MACHINE, PROBE, "CAL"), MACHINE, BENT)
    assert len(found.axes) == 6 + 4 + 25
    tip = found.axes[:, :3] + BENT.offset
    for target, place in zip(found.target, tip, strict=True):
        if target in RING:
            off = np.hypot(*(place - PROBE.ring.center)[:2]) + BENT.tip_radius - PROBE.ring.diameter / 2
        elif target == RING_FACE:
            off = place[2] - BENT.tip_radius - (PROBE.ring.face.seat + PROBE.ring.face.height)
        else:
            assert target == SPHERE
            off = np.linalg.norm(place - PROBE.sphere.center) - BENT.tip_radius - PROBE.sphere.diameter / 2
        assert abs(off) < 1e-8  # the file keeps nine decimals


def test_tip_stops_where_it_touches_the_sphere_that_the_work_axes_carry(tmp_path):
    """p_m = M(B) (Rz(-A) p_w + e), written out: a machine whose axes lie elsewhere than the program believes."""
    found = calibrated(tmp_path, axis_program(MACHINE, PROBE, "AXES"), OFF_AXIS, BENT)
    assert len(found.axes) == 81
    for X, Y, Z, A, B in found.axes:
        turn = np.array([[math.cos(A), math.sin(A), 0], [-math.sin(A), math.cos(A), 0], [0, 0, 1]])
        columns = np.array([[-math.sin(B), 0, math.cos(B)], [0, 1, 0], [-math.cos(B), 0, -math.sin(B)]]).T
        center = columns @ (turn @ [PROBE.work_sphere.radius, 0.0, PROBE.work_sphere.axial] + OFF_AXIS.pivot_offset)
        tip = np.array([X, Y, Z - MACHINE.gauge_line_height - PROBE.length]) + BENT.offset
        assert abs(np.linalg.norm(tip - center) - BENT.tip_radius - PROBE.work_sphere.diameter / 2) < 1e-7


def test_runs_of_one_shop_have_their_own_noise_and_number(tmp_path):
    text, noisy = calibration_program(MACHINE, PROBE, "CAL"), shop(probe=Probe(sigma_um=0.5))
    first, again, other = (calibrated(tmp_path, text, MACHINE, PROBE, noisy, run) for run in (1, 1, 7))
    np.testing.assert_array_equal(first.axes, again.axes)
    assert (first.run, other.run) == (1, 7)
    assert not np.allclose(first.axes, other.axes, rtol=0, atol=1e-7)
    exact = calibrated(tmp_path, text, MACHINE, PROBE)
    off = np.linalg.norm(first.axes[-25:, :3] - exact.axes[-25:, :3], axis=1)
    assert np.sqrt(np.mean(off**2)) == pytest.approx(0.0005, rel=5 / math.sqrt(2 * 25))


def test_clamping_and_drift_of_a_run_are_those_of_the_simulated_measurement(gear_set, tmp_path):
    """Program, machine and touches against the flank file that is moved without any of them.

    The tip rolls by 20 um on flanks of some 20 mm radius: 10 nm; a metal frame that moved the other way would be 40 um.
    """
    member, errors = (
        gear_set.pinion,
        shop(
            measuring=SimulatedMeasuring(
                pinion=Mounting(eccentricity=0.02, eccentricity_direction=40.0, tilt=0.01, tilt_direction=-70.0),
                drift=Drift(X_um=3.0, Y_um=4.0, Z_um=-5.0),
            )
        ),
    )
    text = probing_program(gear_set, "pinion", MACHINE, PROBE, "PP", topography=(0,))
    there = ProbeMachine(member, MACHINE, PROBE, seat=errors.measuring_clamp("pinion"))
    (tmp_path / "raw.csv").write_text(run_touches(text, "PP.MPF", there, errors, touch_count(text, "PP.MPF")))
    seen = measured_member(read_touch_csv(tmp_path / "raw.csv"), member, MACHINE, PROBE)
    files = []
    for flank in FLANKS:
        for tooth in range(12):
            one = nominal_flank(member, flank, blank_grid(member), tooth=tooth)
            one = one.pick((tooth == 0) | ((one.row == 2) & (one.col == 4)))
            one.deviation[:] = 0.0
            files.append(one)
    expected = measure_member(join(files), member, errors)
    for key in ("flank", "tooth", "row", "col"):
        np.testing.assert_array_equal(getattr(seen, key), getattr(expected, key))
    assert np.ptp(expected.deviation) > 0.02
    np.testing.assert_allclose(seen.deviation, expected.deviation, rtol=0, atol=3e-5)


def test_every_touch_of_a_program_is_counted(gear_set):
    text = probing_program(gear_set, "pinion", MACHINE, PROBE, "PP", topography=(), repeat=3)
    assert touch_count(text, "P") == 3 * 26
    assert not touches_artefacts(text)
    assert touches_artefacts(calibration_program(MACHINE, PROBE, "CAL"))
    assert touches_artefacts(axis_program(MACHINE, PROBE, "CAL"))


def test_run_that_ends_in_an_alarm_says_where_and_how_far_it_came(gear_set):
    """The sphere is not where the program looks for it: Z of the machine stands 0.6 mm too high, beyond the search."""
    text = calibration_program(MACHINE, PROBE, "CAL")
    line = next(k for k, block in enumerate(text.split("\n"), 1) if "SETAL(65001)" in block and k > 700)
    with pytest.raises(
        ComputationError, match=r"P\.MPF, line \d+: the run ends with alarm 65001 \(touched nothing\), af"
    ):
        run_touches(text, "P.MPF", Artefacts(MACHINE, PROBE), shop(axes=AxisErrors(Z=0.9)))
    assert line > 700


def test_text_that_is_no_probing_program_is_refused(gear_set):
    with pytest.raises(InputError, match=r"P\.MPF: writes 0 files of touches, must write one"):
        run_touches("G17 G40 G90 G710 G94 G54\nM30\n", "P.MPF", Artefacts(MACHINE, PROBE))
    with pytest.raises(InputError, match=r"P\.MPF, line 1"):
        run_touches("hello\n", "P.MPF", Artefacts(MACHINE, PROBE))


def test_command_names_what_is_missing_and_writes_nothing(command, refused, tmp_path):
    program, calibration, out = tmp_path / "PP.MPF", tmp_path / "CAL.MPF", ("-o", tmp_path / "raw.csv")
    program.write_text(';\nN10 WRITE(UERR,"P_T","run,point,member,flank,tooth,row,col,X,Y,Z,A,B,triggered")\nM30\n')
    calibration.write_text(calibration_program(MACHINE, PROBE, "CAL"))
    refused(r"--set is missing: .*PP\.MPF probes a member", "probe", program, *out)
    refused(r"--member is missing: the set has both", "probe", program, "--set", NASA, *out)
    refused(
        r"--measured .*m\.csv: .*CAL\.MPF touches ring and spheres", "probe", calibration, "--measured", "m.csv", *out
    )
    refused(r"no\.MPF: cannot be read", "probe", tmp_path / "no.MPF", *out)
    refused(r"PP\.MPF, line 2", "probe", program, "--set", NASA, "--member", "pinion", *out)
    bare = tmp_path / "bare.toml"
    bare.write_text("\n".join(bundled("probe.toml").read_text().split("\n[ring]")[:1]))
    status, _, err = command("probe", calibration, "--calibration", bare, *out)
    assert status == 1
    assert re.search(r"CAL\.MPF, line \d+: the run ends with alarm 65001 \(touched nothing\), after 0 touches", err)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["CAL.MPF", "PP.MPF", "bare.toml"]


def test_command_refuses_a_program_that_collides_and_one_of_the_mate(gear_set, refused, tmp_path):
    """The first rapid way down goes 20 mm too deep; and the gear is no pinion."""
    text = probing_program(gear_set, "pinion", MACHINE, PROBE, "PP", topography=())
    program = tmp_path / "PP.MPF"
    program.write_text(text)
    refused(r"PP\.MPF, line \d+", "probe", program, "--set", NASA, "--member", "gear", "-o", tmp_path / "raw.csv")
    first = re.search(r"MEAS=1 G1 X=IC\(0\) Y=IC\(0\) Z(-?\d+\.\d+)", text)
    deep = f"G0 Z{float(first[1]) - 20.0:.5f}\n" + f"N1 G0 Z{float(first[1]) + 20.0:.5f}\n"
    at = text.rindex("\n", 0, first.start()) + 1
    program.write_text(text[:at] + "N1 " + deep + text[at:])
    line = text[:at].count("\n") + 1
    refused(
        rf"PP\.MPF, line ({line}|{line + 1}): the (tip|stylus) of the probe meets the teeth, .* mm deep: it is not run",
        "probe",
        program,
        "--set",
        NASA,
        "--member",
        "pinion",
        "-o",
        tmp_path / "raw.csv",
    )
    assert [path.name for path in tmp_path.iterdir()] == ["PP.MPF"]


def test_a_program_that_touches_nothing_is_refused(gear_set, refused, tmp_path):
    """A cutting program by its words; a probing one that ends before its first touch when it is run."""
    program, out = tmp_path / "PP.MPF", ("--set", NASA, "-o", tmp_path / "raw.csv")
    program.write_text("; PP\nN10 G90 G94 G54\nN20 M30\n")
    refused("PP.MPF: writes no touches", "probe", program, *out)
    text = probing_program(gear_set, "gear", MACHINE, PROBE, "PP", topography=())
    program.write_text(text)
    start = text.index("MEAS=1")
    begin = text.rindex("\n", 0, start) + 1
    program.write_text(text[:begin] + "N9990 M30\n")
    refused("PP.MPF: touches nothing", "probe", program, *out)


def test_time_of_a_probing_program_is_that_of_its_ways(gear_set, command, tmp_path):
    """By hand: from F100 to F50 every touch takes its way / 50 - way / 100 minutes longer, all else is the same."""
    text = probing_program(gear_set, "gear", MACHINE, PROBE, "PP", topography=())
    ways = []

    def met(start, end):
        if np.abs(end - start)[:2].max() > 1e-6 and abs(end[2] - start[2]) > 1e-6:
            ways.append(float(np.linalg.norm((end - start)[:3])))
            return end
        return None

    run_program(text, "PP", met, setup=Setup.of(MACHINE, PROBE.length))
    assert len(ways) == 2 * 36 + 2

    def seconds(text):
        (tmp_path / "PP.MPF").write_text(text)
        status, out, _ = command("nc", "time", tmp_path / "PP.MPF", "--json")
        assert status == 0
        return json.loads(out)

    fast, slow = seconds(text), seconds(text.replace("F100.000", "F50.000"))
    assert fast["touches_counted_to"] == "the end of their ways"
    assert slow["asked_seconds"] - fast["asked_seconds"] == pytest.approx(60 * sum(ways) * (1 / 50 - 1 / 100), rel=1e-6)
    assert fast["total_seconds"] > fast["asked_seconds"] + fast["rapid_seconds"]


def test_time_of_a_calibration_counts_to_the_ring_that_is_there(command, tmp_path):
    (tmp_path / "CAL.MPF").write_text(calibration_program(MACHINE, PROBE, "CAL"))
    status, out, _ = command("nc", "time", tmp_path / "CAL.MPF")
    assert status == 0
    assert "touches counted to where they are met; no host is waited for" in out

"""From raw touches to the measured flank: the whole way from the probing program's text."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.errors import InputError
from gearmath.machine.control.executor import run_program
from gearmath.machine.measuring.probe import ProbeMachine
from gearmath.machine.measuring.probe_errors import ErringProbe
from gearmath.machine.planning.targets import teeth_around
from gearmath.machine.writing.probing import probing_program
from gearmath.quality.evaluation.member import evaluate_member
from gearmath.quality.evaluation.pitch import evaluate_pitch
from gearmath.quality.evaluation.touches import measured_member
from gearmath.specs.bevel_set import FLANKS, MEMBERS
from gearmath.specs.calibration import load_calibration
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.simulated_machine import Probe, SimulatedMachine
from gearmath.specs.toml import bundled
from gearmath.specs.touch_csv import read_touch_csv

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
PROBE = load_calibration(bundled("probe.toml"))
BENT = PROBE.model_copy(update={"offset": (0.031, -0.047, 0.012), "tip_radius": 0.7432})
OFF_AXIS = MACHINE.model_copy(update={"pivot_offset": (1.5, -2.25, 30.0)})


def measured(gear_set, tmp_path, member, machine=MACHINE, probe=PROBE, stock=None, **options):
    """Program text, read back and run against the member, its result file read and evaluated."""
    spec = gear_set.member(member)
    text = probing_program(gear_set, member, machine, probe, "PROBE", **options)
    there = ProbeMachine(spec, machine, probe, *([stock] if stock else []))
    done = run_program(text, "PROBE.MPF", there)
    assert done.alarm is None
    file = tmp_path / "raw.csv"
    file.write_text(done.files["PROBE_T"])
    return measured_member(read_touch_csv(file), spec, machine, probe)


@pytest.mark.parametrize("member", MEMBERS)
@pytest.mark.parametrize(("machine", "probe"), [(MACHINE, PROBE), (OFF_AXIS, BENT)], ids=["plain", "offsets"])
def test_probing_the_nominal_member_gives_back_exactly_its_flanks(gear_set, tmp_path, member, machine, probe):
    """0.01 um is asked; the text of the result file keeps nine decimals."""
    spec = gear_set.member(member)
    file = measured(gear_set, tmp_path, member, machine, probe)
    assert len(file) == 2 * (45 + spec.teeth - 1 + 5)  # tooth 0 again at the end, as tooth z
    assert np.abs(file.deviation).max() <= 1e-5  # mm
    for flank in FLANKS:
        nominal = solve_flank(spec, flank, blank_grid(spec))
        for tooth in range(spec.teeth + 1):
            turn = 2 * math.pi * tooth / spec.teeth
            c, s = math.cos(turn), math.sin(turn)
            here = file.select(flank, tooth)
            places = here.row * 9 + here.col
            expected = nominal.point[places] @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
            assert len(here) == (45 if tooth == 0 else 5 if tooth == spec.teeth else 1)
            assert np.isnan(here.uncertainty).all()  # one touch says nothing of its scatter
            # beside the normal the printed program moves the point by its five decimals, which is no deviation
            np.testing.assert_allclose(here.point, expected, rtol=0, atol=2e-5)


def test_corners_on_eight_teeth_around_tell_how_the_work_sits(gear_set, tmp_path):
    """With them tilt and eccentricity are told, here as none; without them the tilt is not."""
    spec, around = gear_set.pinion, teeth_around(12)
    assert around == [0, 2, 3, 4, 6, 8, 9, 10]
    file = measured(gear_set, tmp_path, "pinion", around=around)
    assert len(file) == 2 * (45 + 11 + 7 * 4 + 5)
    seat = evaluate_member(file, spec).registration
    assert seat.tilt_found
    assert seat.eccentricity < 1e-5  # mm
    assert seat.tilt * spec.blank.mean_cone_distance < 1e-5
    middle = (file.row == 2) & (file.col == 4)
    lacking = evaluate_member(file.pick((file.tooth % 12 == 0) | middle), spec).registration
    assert not lacking.tilt_found


def test_metal_left_on_comes_back_as_pitch_and_deviation(gear_set, tmp_path):
    """7 um on every convex flank, and tooth 3 a further 4 um: single pitch by the lever of the normal."""

    def stock(flank, tooth, place=None):
        return (0.007 if flank == "convex" else 0.0) + (0.004 if tooth == 3 else 0.0)

    spec = gear_set.member("pinion")
    file = measured(gear_set, tmp_path, "pinion", stock=stock)
    for flank in FLANKS:
        expected = np.array([stock(flank, tooth) for tooth in file.select(flank).tooth])
        np.testing.assert_allclose(file.select(flank).deviation, expected, rtol=0, atol=1e-5)
        pitch = evaluate_pitch(file, spec.teeth, flank)
        here = file.select(flank, 0)
        middle = (here.row == 2) & (here.col == 4)
        point, normal = here.point[middle][0], here.normal[middle][0]
        arc = 0.004 / (np.cross([0, 0, 1], point) @ normal) * math.hypot(*point[:2])
        np.testing.assert_allclose(pitch.cumulative, np.where(np.arange(12) == 3, arc, 0.0), rtol=0, atol=3e-5)


def test_wrong_tip_radius_shifts_every_deviation_by_its_error(gear_set, tmp_path):
    """Touched with 0.75 mm, evaluated with 0.74 mm: 10 um of metal everywhere."""
    text = probing_program(gear_set, "gear", MACHINE, PROBE, "PROBE", pitch=False)
    spec = gear_set.member("gear")
    file = tmp_path / "raw.csv"
    file.write_text(run_program(text, "P", ProbeMachine(spec, MACHINE, PROBE)).files["PROBE_T"])
    smaller = PROBE.model_copy(update={"tip_radius": 0.74})
    result = measured_member(read_touch_csv(file), spec, MACHINE, smaller)
    np.testing.assert_allclose(result.deviation, 0.01, rtol=0, atol=1e-5)
    assert result.header["tip_radius_mm"] == "0.74"


def test_touches_of_another_member_or_set_up_are_refused(gear_set, tmp_path):
    text = probing_program(gear_set, "gear", MACHINE, PROBE, "PROBE", topography=(), pitch=True)
    spec = gear_set.member("gear")
    file = tmp_path / "raw.csv"
    file.write_text(run_program(text, "P", ProbeMachine(spec, MACHINE, PROBE)).files["PROBE_T"])
    touches = read_touch_csv(file)
    with pytest.raises(InputError, match="the touches are of the gear, not of the pinion"):
        measured_member(touches, gear_set.member("pinion"), MACHINE, PROBE)
    longer = PROBE.model_copy(update={"length": 210.0})
    with pytest.raises(InputError, match=r"concave flank, tooth 0, row 2, col 4: the touch lies 10\.0.. mm from"):
        measured_member(touches, spec, MACHINE, longer)
    for key, value in (("row", 5), ("col", 9), ("tooth", 37)):
        wrong = replace(touches, **{key: np.full(len(touches), value)})
        with pytest.raises(InputError, match=f"{key} = {value}"):
            measured_member(wrong, spec, MACHINE, PROBE)


def test_lobes_of_the_probe_are_taken_off_by_the_direction_of_the_touch(gear_set, tmp_path):
    """Measured with lobes of 3 um: known to the calibration nothing is left, unknown what they make of each normal."""
    spec = gear_set.member("pinion")
    text = probing_program(gear_set, "pinion", MACHINE, PROBE, "PROBE", topography=())
    lobes = SimulatedMachine(title="lobes", seed=1, probe=Probe(lobing_um=3.0, lobing_phase=20.0))
    there = ErringProbe(ProbeMachine(spec, MACHINE, PROBE), lobes)
    file = tmp_path / "raw.csv"
    file.write_text(run_program(text, "PROBE.MPF", there).files["PROBE_T"])
    touches = read_touch_csv(file)
    known = PROBE.model_copy(update={"lobing_um": 3.0, "lobing_phase": 20.0})
    right, wrong = (measured_member(touches, spec, MACHINE, probe) for probe in (known, PROBE))
    np.testing.assert_allclose(right.deviation, 0.0, rtol=0, atol=1e-5)
    assert 1e-3 < np.abs(wrong.deviation).max() <= 3.01e-3


def test_commands_go_from_calibration_to_measured_flank(gear_set, tmp_path, command, artefacts):
    """nc calibrate -> calibrate -> nc probe -> touches -> evaluate, file by file, with a tip that nobody knew."""
    raw, tip = tmp_path / "cal.csv", tmp_path / "tip.toml"
    assert command("nc", "calibrate", "-o", tmp_path / "CAL.MPF")[0] == 0
    text = (tmp_path / "CAL.MPF").read_text()
    raw.write_text(run_program(text, "CAL", artefacts(BENT)).files["CAL_T"])
    status, out, _ = command("calibrate", raw, "-o", tip)
    assert status == 0
    assert "tip radius 0.74320 mm, u 0.000 um" in out
    assert "offset Y -0.04700 mm, u 0.000 um" in out
    assert "25 touches: noise 0.000 um, largest residual 0.000 um" in out
    found = load_calibration(tip)
    assert found.tip_radius == pytest.approx(0.7432, abs=1e-6)
    machine = ["--calibration", tip]
    status, out, _ = command(
        "nc", "probe", bundled("nasa_tp3096_12x36.toml"), "--member", "pinion", *machine, "-o", tmp_path / "PP.MPF"
    )
    assert (status, out.split(": ")[1].split(",")[0]) == (0, "178 touches")
    there = ProbeMachine(gear_set.member("pinion"), MACHINE, BENT)
    raw.write_text(run_program((tmp_path / "PP.MPF").read_text(), "PP", there).files["PP_T"])
    status, out, _ = command("touches", raw, "--set", "nasa_tp3096_12x36.toml", *machine, "-o", tmp_path / "M.csv")
    assert status == 0
    assert "178 points of run 1, largest deviation 0.000 um" in out
    status, out, _ = command("evaluate", tmp_path / "M.csv", "--set", "nasa_tp3096_12x36.toml")
    assert status == 0
    assert "F_p_um" in out


def test_command_writes_repeated_touches(tmp_path, command, refused):
    """The reference points of twelve teeth, tooth 0 again: 26 points, three touches each."""
    nasa, target = "nasa_tp3096_12x36.toml", tmp_path / "PP.MPF"
    status, out, _ = command(
        "nc",
        "probe",
        nasa,
        "--member",
        "pinion",
        "--topography",
        "none",
        "--no-registration",
        "--repeat",
        3,
        "-o",
        target,
    )
    assert (status, out.split(": ")[1].split(",")[0]) == (0, "78 touches")
    assert "; 26 points, each touched 3 times" in target.read_text()
    refused("--repeat", "nc", "probe", nasa, "--member", "pinion", "--repeat", 0, "-o", tmp_path / "P2.MPF")


def test_bad_input_of_the_commands_is_one_sentence(tmp_path, refused):
    empty = tmp_path / "empty.csv"
    empty.write_text("")
    nasa = "nasa_tp3096_12x36.toml"
    out = ["-o", tmp_path / "M.csv"]
    refused("empty.csv: holds no touch", "touches", empty, "--set", nasa, *out)
    refused("empty.csv: holds no touch", "calibrate", empty, *out)
    refused("no_such.csv", "touches", tmp_path / "no_such.csv", "--set", nasa, *out)
    probe = ["nc", "probe", nasa, "--member", "gear"]
    refused("--topography 99: must be all, none, or numbers from 0 to 35", *probe, "--topography", "99", *out)
    refused("there is nothing to probe", *probe, "--topography", "none", "--no-pitch", "-o", tmp_path / "PP.MPF")
    refused("program name '1P'", *probe, "-o", tmp_path / "1P.MPF")
    bare = tmp_path / "bare.toml"
    bare.write_text("\n".join(bundled("probe.toml").read_text().split("\n[ring]")[:1]))
    calibrate = ["nc", "calibrate", "--calibration", bare, "-o", tmp_path / "BARE.MPF"]
    refused("bare.toml: the calibration file has neither ring nor sphere", *calibrate)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bare.toml", "empty.csv"]

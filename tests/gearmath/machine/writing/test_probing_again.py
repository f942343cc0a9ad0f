"""Probing programs that are continued, guarded, short, and one-sided: what a shop relies on beside the touches."""

from __future__ import annotations

import itertools
import math
import re

import numpy as np
import pytest

from gearmath.errors import InputError
from gearmath.machine.control.executor import run_program
from gearmath.machine.control.state import Setup
from gearmath.machine.measuring import collision_check as probe_check
from gearmath.machine.measuring.artefacts import Artefacts
from gearmath.machine.measuring.probe import ProbeMachine
from gearmath.machine.measuring.probe_errors import ErringProbe
from gearmath.machine.measuring.probe_run import touch_count
from gearmath.machine.planning.targets import probe_targets, teeth_around
from gearmath.machine.writing.axis_cycle import axis_program
from gearmath.machine.writing.calibrating import calibration_program
from gearmath.machine.writing.probe_words import DEFLECTED, FILE_SIZE, NOT_WRITTEN, TOUCHED_TOO_EARLY
from gearmath.machine.writing.probing import probing_program
from gearmath.machine.writing.words import Positions, block_count
from gearmath.quality.evaluation.touches import measured_member
from gearmath.specs.calibration import load_calibration
from gearmath.specs.control import ControlSettings
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.simulated_machine import AxisErrors, SimulatedMachine
from gearmath.specs.toml import bundled
from gearmath.specs.touch_csv import planned_touches, read_calibration_csv, read_touch_csv

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
PROBE = load_calibration(bundled("probe.toml"))
COARSE = MACHINE.model_copy(update={"control": ControlSettings()})


def with_a(**changes):
    return MACHINE.model_copy(
        update={"axes": MACHINE.axes.model_copy(update={"A": MACHINE.axes.A.model_copy(update=changes)})}
    )


COUNTING = with_a(modulo=False, travel=(-10.0, 700.0))
TIP = MACHINE.model_copy(update={"z_reference": "tip"})


def touching(start, end):
    """A probe that triggers where touches end: ways across and in Z with A and B at rest."""
    moved = np.abs(end - start) > 1e-7
    return end if moved[:2].any() and moved[2] and not moved[3:].any() else None


def run(text, probe=touching, **options):
    setup = options.pop("setup", Setup())
    return run_program(text, "PROBE.MPF", probe, setup=setup, **options)


@pytest.fixture(scope="module")
def pitch_program(gear_set):
    return probing_program(gear_set, "pinion", MACHINE, PROBE, "PROBE", topography=(), around=(0, 5), repeat=2)


@pytest.mark.parametrize(
    ("machine", "name", "options"),
    [
        (COARSE, "gear", {"topography": range(36), "pitch": False}),
        (MACHINE, "pinion", {"around": teeth_around(12)}),
        (COUNTING, "gear", {"topography": (3, 35)}),
        (TIP, "pinion", {"topography": ()}),
    ],
    ids=["coarse", "fine", "counting", "tip"],
)
def test_loop_makes_the_very_touches_of_its_points_one_by_one(gear_set, machine, name, options):
    """Every touch of the list, each rounded to the increments by itself: nothing adds up from tooth to tooth."""
    targets = probe_targets(gear_set.member(name), machine, PROBE, **options)
    made = []

    def probe(start, end):
        if touching(start, end) is not None:
            made.append((start, end))
            return end
        return None

    done = run(
        probing_program(gear_set, name, machine, PROBE, "PROBE", **options),
        probe,
        setup=Setup.of(machine, PROBE.length),
    )
    assert done.alarm is None
    assert len(made) == len(targets)
    positions = Positions.of(machine, PROBE.length)
    for k, wanted in enumerate((targets.start, targets.end)):
        single = positions.printed(wanted) + np.array([0, 0, positions.length, 0, 0])
        really = np.array([one[k] for one in made])
        really[:, 3:] = np.degrees(really[:, 3:])
        off = really - single
        off[:, 3] -= 360.0 * np.round(off[:, 3] / 360.0)
        if k == 1:  # a touch that would be level goes down by one increment
            level = np.abs(off[:, 2]) > 1e-9
            assert np.allclose(off[level, 2], -(10.0 ** -machine.control.decimals[0]))
            off[level, 2] = 0.0
        assert np.abs(off).max() < 1e-9


def test_full_topography_is_a_few_hundred_blocks(gear_set):
    """5x9 points of both flanks of all 36 teeth; one by one that were 117 000."""
    text = probing_program(gear_set, "gear", MACHINE, PROBE, "PROBE", topography=range(36))
    assert "# planned: 3250 touches" in text
    assert block_count(text) < 500


@pytest.mark.parametrize("options", [{"repeat": 3}, {"topography": (), "repeat": 100}, {"topography": range(12)}])
def test_steps_that_a_plan_allows_are_enough_for_it(gear_set, monkeypatch, options):
    """Very many touches take more steps than other programs may: so many for each that is planned."""
    monkeypatch.setattr(probe_check, "STEP_LIMIT", 10)
    text = probing_program(gear_set, "pinion", MACHINE, PROBE, "PROBE", **options)
    assert touch_count(text, "PROBE") == planned_touches(text) > 300


def test_run_that_was_aborted_is_continued_at_its_point_and_joined(pitch_program, tmp_path):
    """Whole and continued runs have the same touches; in between, the file says what it holds."""
    whole = run(pitch_program)
    count = itertools.count()

    def lost(start, end):
        return touching(start, end) if touching(start, end) is None or next(count) < 21 else None

    aborted = run(pitch_program, lost, parameters={102: 3})
    assert aborted.messages[-1] == "point 11: touched nothing"
    begun = tmp_path / "begun.csv"
    begun.write_text(aborted.files["PROBE_T"])
    assert len(read_touch_csv(begun)) == 21
    again = run(pitch_program, parameters={102: 4, 90: 11}, files=aborted.files)
    assert again.alarm is None
    assert again.messages[0] == "only points 11 to 0 of 42 (0: open): NC start goes on"
    assert (again.parameters[90], again.parameters[91]) == (0.0, 0.0)
    assert "# points: 21 to 84\n" in again.files["PROBE_T"]
    files = {name: tmp_path / f"{name}.csv" for name in ("whole", "again")}
    files["whole"].write_text(whole.files["PROBE_T"])
    files["again"].write_text(again.files["PROBE_T"])
    expected, joined = read_touch_csv(files["whole"]), read_touch_csv(files["again"])
    assert joined.joined == "joined of 84: touches 1 to 20 of run 4, touches 21 to 84 of run 5"
    for key in ("flank", "tooth", "row", "col", "axes", "planned"):
        np.testing.assert_array_equal(getattr(joined, key), getattr(expected, key))
    alone = read_touch_csv(files["again"], run=5)
    assert len(alone) == 64
    assert alone.joined == "touches 21 to 84 of 84 only"


def test_part_of_another_plan_is_not_joined(pitch_program, gear_set, tmp_path):
    other = probing_program(gear_set, "pinion", MACHINE, PROBE, "PROBE", topography=(), repeat=2)
    done = run(pitch_program, parameters={102: 1, 90: 40}, files=run(other).files)
    file = tmp_path / "raw.csv"
    file.write_text(done.files["PROBE_T"])
    found = read_touch_csv(file)
    assert (len(found), found.planned) == (6, 84)


def test_touches_command_says_what_was_joined_and_refuses_what_lacks_points(gear_set, command, refused, tmp_path):
    text = probing_program(gear_set, "pinion", MACHINE, PROBE, "PROBE", topography=())
    first = run(text, parameters={102: 0, 91: 10})
    assert first.files["PROBE_T"].splitlines()[1] == "# points: 1 to 10"
    arguments = ("touches", tmp_path / "raw.csv", "--set", "nasa_tp3096_12x36.toml", "-o", tmp_path / "m.csv")
    rest = run(text, parameters={102: 1, 90: 12}, files=first.files)
    (tmp_path / "raw.csv").write_text(rest.files["PROBE_T"])
    refused(
        r"run 2, the last one, is not whole: it has 25 touches, its program makes 26.*"
        r"\(joined of 26: touches 1 to 10 of run 1, touches 12 to 26 of run 2\)",
        *arguments,
    )
    rest = run(text, parameters={102: 2, 90: 11, 91: 11}, files=rest.files)
    (tmp_path / "raw.csv").write_text(rest.files["PROBE_T"])
    status, said, _ = command(*arguments)
    assert status == 0
    assert "touches 1 to 10 of run 1, touches 11 to 11 of run 3, touches 12 to 26 of run 2" in said


def test_every_run_from_the_first_point_on_opens_the_file_anew(pitch_program):
    first = run(pitch_program, parameters={102: 6})
    again = run(pitch_program, parameters=first.parameters, files=first.files)
    assert again.parameters[102] == 8
    assert len(again.files["PROBE_T"]) == len(first.files["PROBE_T"])
    assert again.files["PROBE_T"].splitlines()[2].startswith("8,1,")


def test_points_that_there_are_not_are_refused_before_the_first_motion(pitch_program):
    for wrong in ({90: 43}, {90: 5, 91: 4}, {91: -1}):
        done = run(pitch_program, parameters=wrong)
        assert done.alarm is not None
        assert "R90 and R91: first and last point must be 1 to 42, or 0" in done.messages
        assert len(done.path.axes) == 0
        assert done.files == {}


def test_control_that_cannot_hold_the_result_is_found_before_the_first_motion(pitch_program):
    """84 touches of at most 125 characters, and some lines more; a file that is full all the same is no touch lost."""
    needed = int(re.search(r"IF \$MN_LEN_PROTOCOL_FILE<(\d+)", pitch_program)[1])
    assert 84 * 100 < 1000 * needed < 94 * 130
    done = run(pitch_program, setup=Setup(result_file_kB=needed - 1))
    assert (done.alarm[0], len(done.path.axes)) == (FILE_SIZE, 0)
    whole = run(pitch_program, setup=Setup(result_file_kB=needed))
    assert whole.alarm is None
    assert len(whole.files["PROBE_T"]) <= 1000 * needed
    full = run(pitch_program.replace(f"FILE<{needed}", "FILE<1"), setup=Setup(result_file_kB=2))
    assert full.alarm[0] == NOT_WRITTEN
    assert 1900 < len(full.files["PROBE_T"]) <= 2000


def test_program_whose_result_would_be_too_long_is_refused_with_the_key(gear_set):
    small = MACHINE.model_copy(update={"control": MACHINE.control.model_copy(update={"result_file_kB": 10})})
    probing_program(gear_set, "pinion", small, PROBE, "PROBE", topography=())
    with pytest.raises(InputError, match=r"PROBE: 3250 touches need 408 kB .* has \[control\] result_file_kB = 10"):
        probing_program(gear_set, "gear", small, PROBE, "PROBE", topography=range(36))


def test_probe_is_looked_at_before_every_motion_of_it(gear_set, pitch_program):
    """Deflected from the n-th motion on, whichever it is: nothing but Z upwards follows."""
    calibrations = calibration_program(MACHINE, PROBE, "CAL"), axis_program(MACHINE, PROBE, "CAL")
    for text, probe in ((pitch_program, touching), *((one, Artefacts(MACHINE, PROBE)) for one in calibrations)):
        last = int(np.flatnonzero(run(text, probe).path.measuring)[-1])
        for late in (1, *range(4, last, 1 + last // 5)):
            heard = []
            done = run(text, probe, moved=heard.append, deflected=lambda at, h=heard, n=late: len(h) >= n)
            assert done.alarm is not None
            assert done.alarm[0] in (DEFLECTED, TOUCHED_TOO_EARLY)
            # the way back of a touch, and Z upwards
            after = np.diff(done.path.axes[late - 1 :], axis=0)
            assert len(after) <= 4
            assert not np.abs(after[1:, [0, 1, 3, 4]]).max(initial=0.0) > 25.0
            assert not done.path.measuring[late:].any()


@pytest.mark.parametrize("which", range(3))
def test_what_stands_in_the_way_stops_every_motion_to_a_point(pitch_program, which):
    """A probe that meets something from home, sideways or on the way in: alarm, and where it happened."""
    said = ("on the way down from home", "on the way to a point", "on the way in")[which]

    def probe(start, end):
        moved = np.abs(end - start) > 1e-7
        down, aside = not moved[[0, 1, 3, 4]].any(), not moved[2]
        kind = 0 if down and start[2] > MACHINE.home - 1e-6 else 1 if aside else 2 if down else None
        return start + 0.5 * (end - start) if kind == which else touching(start, end)

    done = run(pitch_program, probe)
    assert done.alarm[0] == TOUCHED_TOO_EARLY
    assert done.messages[-1].endswith(f"touched something {said}")
    assert done.files["PROBE_T"].count("\n") == 2


def test_every_motion_below_the_home_of_z_is_measuring_or_goes_the_way_back(pitch_program):
    path = run(pitch_program).path
    for k in range(1, len(path.axes)):
        first, last = path.axes[k - 1], path.axes[k]
        if min(first[2], last[2]) > MACHINE.home - 1e-6 or path.measuring[k]:
            continue
        straight_up = np.abs(last - first)[[0, 1, 3, 4]].max() < 1e-9 and last[2] >= first[2]
        assert straight_up or np.allclose(last, path.axes[k - 2], atol=1e-9)


def test_calibration_is_continued_at_a_section(tmp_path):
    text, probe = calibration_program(MACHINE, PROBE, "CAL"), Artefacts(MACHINE, PROBE)
    whole = run(text, probe)
    part = run(text, probe, parameters={102: 1, 90: 1, 91: 2})
    rest = run(text, probe, parameters={102: 2, 90: 3}, files=part.files)
    assert [done.messages[-1] for done in (whole, part)] == [
        "section 3 of 3: sphere",
        "section 2 of 3: face of the ring",
    ]
    for name, done in (("whole", whole), ("rest", rest)):
        (tmp_path / name).write_text(done.files["CAL_T"])
    expected, joined = (read_calibration_csv(tmp_path / name) for name in ("whole", "rest"))
    np.testing.assert_array_equal(joined.axes, expected.axes)
    np.testing.assert_array_equal(joined.target, expected.target)
    assert joined.joined == "joined of 35: touches 1 to 10 of run 2, touches 11 to 35 of run 3"


BACKLASH = 30.0


def pitch_scatter(gear_set, tmp_path, machine, errors):
    """Largest difference [um] between the deviations of one flank's reference points over all teeth."""
    text = probing_program(gear_set, "gear", machine, PROBE, "PROBE", topography=(), around=(0, 12, 24))
    there = ErringProbe(ProbeMachine(gear_set.gear, machine, PROBE), errors)
    done = run(text, there, moved=there.follow)
    assert done.alarm is None
    (tmp_path / "raw.csv").write_text(done.files["PROBE_T"])
    seen = measured_member(read_touch_csv(tmp_path / "raw.csv"), gear_set.gear, machine, PROBE)
    middle = (seen.row == 2) & (seen.col == 4)
    return max(np.ptp(seen.deviation[middle & (seen.flank == flank)]) for flank in ("concave", "convex")) * 1000


@pytest.mark.slow
def test_one_sided_approach_takes_backlash_out_of_the_measured_pitch(gear_set, tmp_path):
    """30 arcsec at some 80 mm are 11 um along the flank of the teeth that A comes to backwards; one-sided, none."""
    errors = SimulatedMachine(title="worn", seed=1, axes=AxisErrors(A_backlash_arcsec=BACKLASH))
    both, one = (
        pitch_scatter(gear_set, tmp_path, machine, errors) for machine in (MACHINE, with_a(one_sided_approach=2.0))
    )
    member = gear_set.gear
    radius = member.blank.mean_cone_distance * math.sin(math.radians(member.blank.pitch_angle))
    most = math.radians(BACKLASH / 3600) * radius * 1000
    assert 0.3 * most < both < most
    assert one < 0.02


def test_one_sided_approach_turns_forwards_before_every_touch(gear_set):
    text = probing_program(gear_set, "gear", with_a(one_sided_approach=2.0), PROBE, "PROBE", topography=(), around=(0,))
    heard, before = [], []

    def probe(start, end):
        if touching(start, end) is None:
            return None
        turns = np.diff([position[3] for position in heard])
        before.append(turns[np.abs(turns) > 1e-9][-1])
        return end

    assert run(text, probe, moved=heard.append).alarm is None
    assert len(before) == 2 * (37 + 4)
    np.testing.assert_allclose(np.degrees(before), 2.0, atol=1e-9)

"""The motion of a control against closed forms: trapezoids, S-curves, corners, circles; and the command."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearmath import cli
from gearmath.errors import InputError
from gearmath.machine.control.executor import execute
from gearmath.machine.control.state import Setup
from gearmath.machine.judging.look_ahead import RoundedCorners, follow
from gearmath.machine.judging.parabolic import follow_parabolic
from gearmath.machine.judging.trajectory import trajectory
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.machine.writing.cutting import cutting_program
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.milling_machine import MillingMachine, load_milling_machine
from gearmath.specs.toml import bundled

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
NO_JERK = replace(MACHINE.limits(5), max_jerk=np.full(5, np.inf))
A, V, J = 3000.0, 20000.0 / 60, 60000.0
JERK = replace(NO_JERK, max_jerk=np.full(5, J))
WITHIN = RoundedCorners(1e-3, 1e-3)


def line(*points: tuple[float, float]) -> np.ndarray:
    """Positions X Y, the others zero."""
    return np.array([[x, y, 0.0, 0.0, 0.0] for x, y in points])


def run(where: np.ndarray, asked: float | np.ndarray = 0.0, limits=NO_JERK, corners=WITHIN, curved=None, how=follow):
    n = len(where) - 1
    given_times = np.broadcast_to(np.asarray(asked, dtype=float), n)
    if how is follow_parabolic:
        return how(where, given_times, limits, corners)
    return how(where, given_times, np.zeros(n - 1, dtype=bool) if curved is None else curved, limits, corners)


@pytest.mark.parametrize("how", [follow, follow_parabolic])
def test_one_block_is_a_trapezoid_or_a_triangle(how):
    long, short, slow = 300.0, 10.0, 50.0
    assert run(line((0, 0), (long, 0)), how=how).seconds.sum() == pytest.approx(long / V + V / A, rel=2e-3)
    assert run(line((0, 0), (short, 0)), how=how).seconds.sum() == pytest.approx(2 * math.sqrt(short / A), rel=2e-3)
    asked = long / slow  # the block asks for 50 mm/s
    assert run(line((0, 0), (long, 0)), asked, how=how).seconds.sum() == pytest.approx(asked + slow / A, rel=2e-3)


def test_jerk_adds_the_time_in_which_the_acceleration_comes_up():
    long = 300.0
    expected = long / V + V / A + A / J  # S-curve with constant speed and constant acceleration in it
    assert run(line((0, 0), (long, 0)), limits=JERK).seconds.sum() == pytest.approx(expected, rel=2e-3)


def test_collinear_blocks_are_one_and_exact_stops_part_them():
    whole, parts = line((0, 0), (300, 0)), line((0, 0), (100, 0), (150, 0), (300, 0))
    assert run(parts).seconds.sum() == pytest.approx(run(whole).seconds.sum(), rel=2e-3)
    stops = run(parts, corners=RoundedCorners(0.0, 0.0))
    alone = [run(line((0, 0), (length, 0))).seconds.sum() for length in (100, 50, 150)]
    np.testing.assert_allclose(stops.seconds, alone, rtol=1e-9)
    assert (stops.speed == 0.0).all()


@pytest.mark.parametrize("tolerance", [1e-4, 1e-3, 1e-2])
def test_a_square_corner_is_as_slow_as_its_tolerance_asks(tolerance):
    """A parabola between both legs, run here by its own positions, comes no nearer to the corner than the tolerance."""
    found = run(line((0, 0), (100, 0), (100, 100)), corners=RoundedCorners(tolerance, tolerance))
    v = found.speed[1]
    assert v == pytest.approx(math.sqrt(8 * tolerance * A / math.sqrt(2)), rel=1e-3)
    time = np.linspace(0.0, v / A, 2001)
    x, y = v * time - A * time**2 / 2 - v**2 / (2 * A), A * time**2 / 2  # X brakes to the corner while Y starts
    assert np.hypot(x, y).min() == pytest.approx(tolerance, rel=1e-3)
    assert found.rounded[0] == pytest.approx(tolerance, rel=1e-3)


def test_a_curve_is_as_fast_as_its_bend_allows():
    """On a circle v²/R is the acceleration, and v³/R² the jerk."""
    radius = 30.0
    angle = np.linspace(0, 2 * np.pi, 1441)
    circle = line(*np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]))
    curved = np.ones(len(circle) - 2, dtype=bool)
    middle = slice(600, 800)
    assert run(circle, curved=curved).speed[middle].min() == pytest.approx(math.sqrt(A * radius), rel=3e-3)
    soft = replace(NO_JERK, max_jerk=np.full(5, 20000.0))
    slow = run(circle, limits=soft, curved=curved).speed[middle].min()
    assert slow == pytest.approx(np.cbrt(20000.0 * radius**2), rel=3e-3)


PLACE = st.integers(-50, 50).map(lambda k: k / 10)


@settings(max_examples=20)
@given(st.lists(st.tuples(PLACE, PLACE), min_size=3, max_size=8, unique=True))
def test_more_tolerance_is_never_slower_and_no_axis_is_too_fast(points):
    where = line(*points)
    steps, stops = np.abs(np.diff(where, axis=0)), RoundedCorners(0.0, 0.0)
    for limits in (NO_JERK, JERK):
        times = [run(where, 0.0, limits, RoundedCorners(t, t)).seconds for t in (1e-4, 1e-3, 1e-2)]
        for seconds in times:
            assert (steps <= limits.max_speed * seconds[:, None] * (1 + 1e-6)).all()
        totals = [float(seconds.sum()) for seconds in (run(where, 0.0, limits, stops).seconds, *times)]
        assert all(later <= earlier * (1 + 1e-6) for earlier, later in pairwise(totals))


@pytest.fixture(scope="module")
def programs() -> dict[str, str]:
    bevel_set = load_bevel_set(bundled("nasa_tp3096_12x36.toml"))
    return {
        kind: cutting_program(bevel_set, "pinion", MACHINE, "CUT", CuttingJob((0,), 1e-4, 3000.0, blocks=kind))
        for kind in ("g1", "poly")
    }


def of(text: str, machine: MillingMachine = MACHINE, **control: object):
    changed = machine.model_copy(update={"control": machine.control.model_copy(update=control)})
    return trajectory(execute(text, "CUT", Setup.of(machine)), changed)


def test_polynomials_are_run_without_corners_and_straight_blocks_are_not(programs):
    straight, curved = of(programs["g1"]), of(programs["poly"])
    assert curved.polynomial_blocks <= 12
    assert curved.blocks == curved.polynomial_blocks + 2  # and a plunge to each roll
    assert straight.corners > 10 * curved.corners
    assert curved.slow_corners <= 2  # where the plunge ends
    assert curved.path_error_um <= straight.path_error_um


def test_exact_stops_take_longer_than_a_tolerance(programs):
    stops = of(re.sub(r"G642 CTOL=\S+ OTOL=\S+", "G60", programs["g1"]))
    assert stops.feed_seconds > of(programs["g1"]).feed_seconds
    assert stops.path_error_um == 0.0


def test_linuxcnc_leaves_the_corner_before_a_stop_farther_by_the_whole_acceleration_behind_it():
    """Blends taken step by step: half of the acceleration before and behind the corners, but all of it at the last."""
    bend, tolerance, half = 0.02, 1e-2, A / 2
    heading = bend * np.array([-1.5, -0.5, 0.5, 1.5])
    ends = 10.0 * np.cumsum(np.stack([np.cos(heading), np.sin(heading)], axis=1), axis=0)
    got = run(line((0, 0), *ends), how=follow_parabolic, corners=RoundedCorners(tolerance, tolerance))
    for left, speed, behind in zip(got.rounded, got.speed[1:-1], (half, half, A), strict=True):
        t = np.linspace(0.0, speed / half, 10001)
        before_corner, past_corner = (speed - half * t) ** 2 / (2 * half), behind * t**2 / 2
        off = np.minimum(before_corner, past_corner).max() * math.sin(bend)
        assert left == pytest.approx(off, rel=5e-3)


def test_a_program_without_motion_takes_no_time():
    done = trajectory(execute("; nothing moves\nM30\n", "NONE"), MACHINE)
    assert (done.total_seconds, done.corners) == (0.0, 0)


def test_linuxcnc_reads_no_polynomials(programs):
    with pytest.raises(InputError, match=r"^line \d+ is a block of POLY: LinuxCNC, which .* has, reads none$"):
        of(programs["poly"], kind="linuxcnc")


def test_the_command_prints_a_table_and_the_same_figures_as_json(programs, tmp_path, capsys):
    program = tmp_path / "CUT.MPF"
    program.write_text(programs["poly"])
    cli.main(["nc", "time", str(program), "--json", "--plot", str(tmp_path / "speed.png")])
    found = json.loads(capsys.readouterr().out)
    assert (tmp_path / "speed.png").read_bytes().startswith(b"\x89PNG")
    parts = sum(found[key] for key in ("feed_seconds", "rapid_seconds", "dwell_seconds"))
    assert found["total_seconds"] == pytest.approx(parts)
    assert found["dwell_seconds"] == 6.0  # twice the start of the spindle
    assert found["control"] == "sinumerik"

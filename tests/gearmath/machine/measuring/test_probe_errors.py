"""A probe that errs, against the simulated measurement that makes the same of a flank file without any machine."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.errors import InputError
from gearmath.machine.control.executor import run_program
from gearmath.machine.measuring.measurement import measure_member
from gearmath.machine.measuring.probe import ProbeMachine
from gearmath.machine.measuring.probe_errors import ErringProbe
from gearmath.machine.writing.probing import probing_program
from gearmath.quality.evaluation.touches import measured_member
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.calibration import load_calibration
from gearmath.specs.flank_csv import flank_file, join
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.simulated_machine import AxisErrors, Drift, Probe, SimulatedMachine, SimulatedMeasuring
from gearmath.specs.toml import bundled
from gearmath.specs.touch_csv import read_touch_csv

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
PROBE = load_calibration(bundled("probe.toml"))


def shop(**what) -> SimulatedMachine:
    return SimulatedMachine(title="wrong", seed=3, **what)


def probed(gear_set, tmp_path, errors, touches=None, run=1, spoil=lambda text: text, **options):
    """The pinion probed by the program's text on a machine that errs, its touches evaluated as if it did not."""
    member = gear_set.pinion
    text = probing_program(gear_set, "pinion", MACHINE, PROBE, "PROBE", **options)
    there = ErringProbe(ProbeMachine(member, MACHINE, PROBE), errors, touches, run)
    done = run_program(text, "PROBE.MPF", there)
    assert done.alarm is None
    file = tmp_path / "raw.csv"
    file.write_text(spoil(done.files["PROBE_T"]))
    assert touches in (None, there.count)
    return measured_member(read_touch_csv(file), member, MACHINE, PROBE)


def nominal(gear_set, places):
    """The pinion without a deviation at the points of a measured file, but for tooth z."""
    grid, files = blank_grid(gear_set.pinion), []
    for flank in FLANKS:
        for tooth in range(12):
            one = nominal_flank(gear_set.pinion, flank, grid, tooth=tooth)
            here = places.select(flank, tooth)
            keep = here.row * 9 + here.col
            files.append(
                flank_file(
                    one.header,
                    "pinion",
                    flank,
                    tooth,
                    one.row[keep],
                    one.col[keep],
                    one.point[keep],
                    one.normal[keep],
                    np.zeros(len(keep)),
                )
            )
    return join(files)


@pytest.mark.slow
def test_drift_and_lobes_are_those_of_the_simulated_measurement(gear_set, tmp_path):
    """Program, machine and touches leave what the flank file is changed by: two ways that share the seat only."""
    errors = shop(
        measuring=SimulatedMeasuring(drift=Drift(X_um=3.0, Y_um=4.0, Z_um=-5.0)),
        probe=Probe(lobing_um=2.0, lobing_phase=10.0),
    )
    seen = probed(gear_set, tmp_path, errors, touches=2 * (45 + 11 + 5))
    expected = measure_member(nominal(gear_set, seen), gear_set.pinion, errors)
    for key in ("flank", "tooth", "row", "col"):
        np.testing.assert_array_equal(getattr(seen, key), getattr(expected, key))
    # the tip rolls by 5 um on the flank; straight ways of five decimals
    np.testing.assert_allclose(seen.deviation, expected.deviation, rtol=0, atol=3e-6)
    assert np.ptp(expected.deviation) > 5e-3


def test_axis_that_stands_off_shows_as_metal_along_it(gear_set, tmp_path):
    """Told X, the machine stands at X + 0.01: what it touches seems to stand 0.01 lower in X."""
    seen = probed(gear_set, tmp_path, shop(axes=AxisErrors(X=0.01)), topography=())
    B = math.radians(gear_set.pinion.blank.root_angle)
    for k in range(0, len(seen), 2):
        assert [seen.tooth[k], *seen.flank[[k, k + 1]]] == [seen.tooth[k + 1], *FLANKS]
        x, y = seen.point[[k, k + 1]].sum(axis=0)[:2]
        for j in (k, k + 1):
            radial = seen.normal[j][:2] @ [x, y] / math.hypot(x, y)
            toward_x = -math.sin(B) * radial - math.cos(B) * seen.normal[j][2]
            assert seen.deviation[j] == pytest.approx(-0.01 * toward_x, abs=1e-5)


def test_scatter_of_repeated_touches_is_the_noise_of_the_probe(gear_set, tmp_path):
    """0.5 um in every touch: u = s/2 of four, s from 3 * 26 spare touches, within five of its standard deviations."""
    noisy = shop(probe=Probe(sigma_um=0.5))
    seen = probed(gear_set, tmp_path, noisy, topography=(), repeat=4)
    again = probed(gear_set, tmp_path, noisy, topography=(), repeat=4)
    other = probed(gear_set, tmp_path, noisy, topography=(), repeat=4, run=2)
    np.testing.assert_array_equal(seen.deviation, again.deviation)
    assert not np.isclose(seen.deviation, other.deviation, rtol=0, atol=1e-9).any()
    assert len(seen) == 26
    assert len(set(seen.uncertainty)) == 1
    assert seen.uncertainty[0] == pytest.approx(0.00025, rel=5 / math.sqrt(2 * 78))
    assert np.std(seen.deviation) == pytest.approx(0.00025, rel=5 / math.sqrt(2 * 26))


def test_touch_that_is_not_like_its_repetitions_is_named(gear_set, tmp_path):
    def chip(text):
        """Z of the second touch of the third point, 0.2 mm too high."""
        lines = text.splitlines()
        cells = lines[8].split(",")
        cells[9] = f"{float(cells[9]) + 0.2:.6f}"
        return "\n".join([*lines[:8], ",".join(cells), *lines[9:]]) + "\n"

    sentence = (
        r"concave flank, tooth 1, row 2, col 4: one of its touches lies .* um from their mean, the limit is 20 um"
    )
    with pytest.raises(InputError, match=sentence):
        probed(gear_set, tmp_path, shop(), topography=(), repeat=3, spoil=chip)

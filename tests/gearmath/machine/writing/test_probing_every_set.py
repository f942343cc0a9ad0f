"""Probing programs of both members of every bundled set: executed, they touch where they should and stay clear."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.machine.control.executor import run_program
from gearmath.machine.measuring.collision_check import approaches
from gearmath.machine.measuring.probe import ProbeMachine
from gearmath.machine.writing.probing import probing_program
from gearmath.quality.evaluation.touches import measured_member
from gearmath.specs.bevel_set import FLANKS, MEMBERS, load_bevel_set
from gearmath.specs.calibration import load_calibration
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled
from gearmath.specs.touch_csv import read_touch_csv

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
PROBE = load_calibration(bundled("probe.toml"))
SETS = (
    "nasa_tp3096_12x36",
    "spiral_7x43",
    "crown_gear_formate_14x39",
    "crown_gear_universal_14x39",
    "crown_gear_hobbed_14x39",
)


@pytest.mark.slow
@pytest.mark.parametrize("name", MEMBERS)
@pytest.mark.parametrize("gear_set", SETS)
def test_program_touches_gives_back_nominal_and_collides_with_nothing(gear_set, name, tmp_path):
    """Touches within 1 um, nominal points through the evaluation within 0.01 um; tip, stylus and spindle stay clear."""
    bevel_set = load_bevel_set(bundled(f"{gear_set}.toml"))
    member = bevel_set.member(name)
    there = ProbeMachine(member, MACHINE, PROBE)
    text = probing_program(bevel_set, name, MACHINE, PROBE, "PROBE")
    done = run_program(text, "PROBE.MPF", there)
    assert done.alarm is None
    touches = tmp_path / "touches.csv"
    touches.write_text(done.files["PROBE_T"])
    measured = measured_member(read_touch_csv(touches, None), member, MACHINE, PROBE)
    assert len(measured) >= 2 * (45 + member.teeth - 1)
    assert np.abs(measured.deviation).max() <= 1e-5  # mm
    targets = []
    for flank in FLANKS:
        nominal = solve_flank(member, flank, blank_grid(member))
        for tooth in range(member.teeth):
            angle = 2 * np.pi * tooth / member.teeth
            c, s = np.cos(angle), np.sin(angle)
            about = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
            targets.append((nominal.point + PROBE.tip_radius * nominal.normal) @ about.T)
    assert cKDTree(np.concatenate(targets)).query(np.array(there.touches))[0].max() <= 1e-3
    near = {(one.probe, one.work): one.distance for one in approaches(text, "P", member, MACHINE, PROBE)}
    assert {probe for probe, _ in near} == {"tip", "stylus", "spindle"}
    assert {work for _, work in near} == {"teeth", "hub", "shank", "fixture"}
    assert min(near.values()) > 0.0

"""Whole programs on whole tooth spaces: no gouge where none is, and a wrong tool seen where it cuts."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.tooth import SHARP_EDGE, tooth_space
from gearmath.machine.judging.report import milling_report
from gearmath.machine.milling.run import runs_of
from gearmath.machine.milling.surfaces import generated_root, nominal_surfaces, surface_states
from gearmath.specs.bevel_set import FLANKS, MEMBERS

SURFACES = ("concave flank", "concave fillet", "convex flank", "convex fillet", "root")


@pytest.fixture(scope="module")
def gear_runs(gear_set, program, vertical):
    path = program(gear_set, "gear", (0, 1, 2))
    space = tooth_space(gear_set.gear, 5)
    return path, runs_of(path, gear_set.gear, vertical, None, space, SHARP_EDGE)


@pytest.fixture(scope="module")
def states(gear_set, vertical, host_compiler):
    def of(path, runs, spaces=(0, 1, 2)):
        found = surface_states(path, gear_set.gear, vertical, spaces=spaces, columns=5, runs=runs)
        return {(state.space, state.surface): state for state in found}

    return of


@pytest.mark.slow
@pytest.mark.parametrize("member", MEMBERS)
def test_whole_program_leaves_fillets_roots_and_neighbours_of_every_space_without_gouge(
    gear_set, program, vertical, host_compiler, member
):
    """0.1 µm on flanks from tip to fillet and on the root, 0.12 µm on the fillet, which a corner of the cutter cuts."""
    spec = gear_set.member(member)
    path = program(gear_set, member, range(spec.teeth))
    report = milling_report(path, spec, vertical, columns=5)
    assert {(s.space, s.surface) for s in report.surfaces} == {(k, s) for k in range(spec.teeth) for s in SURFACES}
    assert report.collisions == ()
    for state in report.surfaces:
        limit = 1.2e-4 if state.surface.endswith("fillet") else 1e-4  # mm
        assert -limit <= state.lowest, state
        assert state.highest <= limit, state


def test_root_lies_on_the_root_cone_where_the_cutter_is_not_tilted(gear_set, host_compiler):
    """By hand: turned with the work, the tip plane touches the cone cos Γ r - sin Γ z_w = X_b - X_p sin Γ.

    The search begins 50 µm beside it.
    """
    for name in MEMBERS:
        member = gear_set.member(name)
        space = tooth_space(member, 5)
        *_, ruled = nominal_surfaces(member, space)
        ruled = replace(ruled, point=ruled.point + 0.05 * ruled.normal)
        root = generated_root(ruled, member, space)
        heights = []
        for flank in FLANKS:
            spec = member.flank(flank)
            gamma = math.radians(spec.machine_root_angle)
            plane = spec.machine_center_to_crossing_point * math.sin(gamma) - spec.sliding_base
            radial = np.hypot(root.point[:, 0], root.point[:, 1])
            heights.append(math.cos(gamma) * radial - math.sin(gamma) * root.point[:, 2] + plane)
        deepest = np.min(np.abs(heights), axis=0)
        assert deepest.max() < 2e-6, name  # mm: the way is divided 1500 times
        assert np.abs(root.point - ruled.point).max() > 0.03


def test_larger_cutter_gouges_one_flank_and_leaves_stock_on_the_other(gear_set, gear_runs, states):
    """By hand: the cones move by Δr cos α along the normal, in by the outer blade and out by the inner one."""
    path, runs = gear_runs
    larger = [replace(run, cutter=run.cutter.shifted(0.05)) for run in runs]
    seen = states(path, larger, (1,))
    by_hand = 0.05 * math.cos(math.radians(22.0))
    gouged, left = seen[1, "concave flank"], seen[1, "convex flank"]
    assert gouged.lowest == pytest.approx(-by_hand, abs=2e-3)
    assert gouged.gouged == gouged.points
    assert left.highest == pytest.approx(by_hand, abs=6e-3)
    assert (left.gouged, left.uncut) == (0, left.points)
    assert seen[1, "root"].gouged == 0


def test_one_shifted_pass_is_seen_in_its_space_only_with_the_line_that_did_it(gear_runs, states):
    """Space 1 turned by 50 µm at 80 mm radius: one of its flanks is gouged, the neighbours keep theirs."""
    path, (run,) = gear_runs
    axes = run.axes.copy()
    axes[run.space == 1, 3] += 0.05 / 80
    before, after = states(path, [run]), states(path, [replace(run, axes=axes)])
    gouged = {key for key, state in after.items() if state.lowest < before[key].lowest - 5e-3}
    assert {space for space, _ in gouged} == {1}
    flanks = [surface for _, surface in gouged if surface.endswith("flank")]
    assert len(flanks) == 1
    worst = after[1, flanks[0]]
    assert worst.line in run.line[run.space == 1]
    for space in (0, 2):
        for surface in SURFACES:
            assert after[space, surface] == before[space, surface]


def test_pass_far_off_its_space_cuts_into_the_neighbour(gear_runs, states):
    """Turned by 0.4 of a pitch, the pass of space 1 eats the flank that space 2 has next to it."""
    path, (run,) = gear_runs
    axes = run.axes.copy()
    axes[run.space == 1, 3] += 0.4 * 2 * math.pi / 36
    seen = states(path, [replace(run, axes=axes)])
    hurt = [surface for surface in SURFACES if seen[2, surface].lowest < -0.05]
    assert hurt
    assert all(seen[2, surface].line in run.line[run.space == 1] for surface in hurt)
    assert not any(seen[0, surface].lowest < -0.05 for surface in SURFACES)


def test_surfaces_begin_their_lines_within_the_tooth(gear_set):
    for surface in nominal_surfaces(gear_set.pinion, tooth_space(gear_set.pinion, 5)):
        assert (surface.start < 0).all()
        assert (surface.start > -10).all()
        np.testing.assert_allclose(np.linalg.norm(surface.normal, axis=1), 1.0, atol=1e-9)


def test_command_writes_the_report_beside_the_flank_file(command, tmp_path, host_compiler):
    program, report = tmp_path / "GEAR.MPF", tmp_path / "gear.json"
    gear_set = "nasa_tp3096_12x36.toml"
    assert command("nc", "cut", gear_set, "--member", "gear", "--spaces", "0,1", "-o", program)[0] == 0
    status, out, err = command(
        "mill", gear_set, "--member", "gear", "--program", program, "--report", report, "-o", tmp_path / "gear.csv"
    )
    assert status == 0, err
    assert "0 collisions" in out
    found = json.loads(report.read_text())
    keys = {"member", "tolerance", "flank_tolerance", "surfaces", "surfaces_of_settings", "collisions", "timing"}
    assert set(found) == keys
    assert (found["flank_tolerance"], found["tolerance"]) == (pytest.approx(1e-4), 1e-3)  # as the header states; 1 um
    assert found["surfaces_of_settings"] == []  # the set is not corrected
    assert len(found["surfaces"]) == 2 * len(SURFACES)
    assert found["timing"]["feed_seconds"] > 1
    # stated finer than it is made: said with both figures, by the blocks and by the report
    text = program.read_text()
    program.write_text(text.replace("; flank tolerance: 0.1 um", "; flank tolerance: 0.05 um"))
    given = ("mill", gear_set, "--program", program, "-o", tmp_path / "gear.csv", "--report", report)
    status, _, err = command(*given)
    assert status == 1
    assert re.search(r"2 flanks gouged by up to -0\.0[5-9]\d um, the program states 0\.05 um", err), err
    status, _, err = command(*given, "--report-tolerance-um", "0.06")
    assert re.search(r"2 flanks gouged by up to -0\.0[6-9]\d um, --report-tolerance-um allows 0\.06 um", err), err
    # without its header nobody knows what it was made for
    program.write_text("\n".join(line for line in text.split("\n") if line[:1] != ";" or line.startswith("; spaces")))
    status, out, err = command(*given, "--member", "gear")
    assert "within 1 um, as none is stated" in out, err
    assert json.loads(report.read_text())["flank_tolerance"] == 1e-3

"""Whole programs with one thing wrong in them: each is refused, or seen, or shown to be harmless; none is left unseen.

What ``gearmath mill`` says is asked block by block (``whole_program``); whatever passes is given to ``mill`` whole if
it does harm. What does harm is said by ``dense_check``, which shares no code with ``mill``. Here a sample is tried,
``python tests/all_mutants.py`` tries them all.
"""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from gearmath.bevel.tooth import SHARP_EDGE
from gearmath.errors import InputError
from gearmath.machine.control.executor import execute
from gearmath.machine.control.state import Setup
from gearmath.machine.judging.program import faults_of
from gearmath.machine.milling.run import runs_of
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.machine.writing.cutting import cutting_program
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.toml import bundled
from tests.gearmath.machine.judging.dense_check import MACHINE, TOLERANCE, Blade, Dense
from tests.gearmath.machine.judging.mutants import others, sample_of, trial, wrong_digits
from tests.gearmath.machine.judging.whole_program import Whole

SETS = ("nasa_tp3096_12x36", "spiral_7x43", "crown_gear_universal_14x39", "crown_gear_formate_14x39")
CASES = [(name, member) for name in SETS for member in ("pinion", "gear")]
#: Spaces of the programs in CI, and mutants of each of them: blocks, wrong digits in each of them, and everything else.
SPACES = (0, 1)
BLOCKS, PER_BLOCK, OTHERS = 40, 75, 40


@pytest.fixture(scope="module", params=CASES, ids=["-".join(case) for case in CASES])
def case(request, witness):
    """A right program of a bundled member, what judges it, and the dense check."""
    whole = Whole(*request.param, SPACES)
    dense = Dense(*request.param, witness, whole.lines)
    assert [row.line for row in dense.rows] == whole.path.line.tolist()
    np.testing.assert_allclose(dense.axes, whole.path.axes, atol=1e-9)
    return whole, dense


@pytest.mark.slow
def test_no_wrong_word_of_a_whole_program_is_left_unseen(case):
    whole, dense = case
    random = np.random.default_rng(CASES.index((whole.name, whole.member)))
    changed = [*wrong_digits(whole, BLOCKS, PER_BLOCK, random), *sample_of(others(whole), OTHERS, random)]
    count, unseen = trial(whole, dense, changed)
    kinds = sorted({kind for kind, _ in count})
    print(f"\n{whole.name} {whole.member}, {len(changed)} mutants, {len(unseen)} unseen; refused or seen + harmless:")
    print("; ".join(f"{kind} {count[kind, 'seen']} + {count[kind, 'harmless']}" for kind in kinds))
    assert unseen == []
    assert sum(count[kind, "seen"] for kind in kinds) > 100


@pytest.mark.slow
def test_dense_check_finds_no_harm_in_the_right_program(case):
    """Where the edges of blades are rounded, a sharp cutter would cut under the foot of the flank, in the fillet."""
    _, dense = case
    assert list(dense.gouging()) == []


@pytest.mark.parametrize("side", [1, -1])
def test_edges_of_dense_check_touch_tip_plane_and_cone(side):
    """The circle in the corner of two lines lies as far from each as from the other, and touches where it ends."""
    angle, edge = np.radians(15.75), 0.5
    blade = Blade(side, 115.9, np.tan(angle), edge)
    height = np.linspace(0.0, 1.0, 2001)
    within = side * (115.9 - blade.reach(height))  # from the end of the cone into the blade
    corner = (np.pi / 2 + angle) / 2  # half of the angle between tip plane and cone, in the blade
    arc = height < edge * (1 - np.sin(angle))
    away = np.hypot(within[arc] - edge / np.tan(corner), height[arc] - edge)
    np.testing.assert_allclose(away, edge, atol=1e-12)
    np.testing.assert_allclose(within[~arc], -height[~arc] * np.tan(angle), atol=1e-12)
    assert np.abs(np.diff(within, 2)[100:]).max() < 1e-5


def ends(dense, line, new):
    """The rows of a cutting block as it was and as it is changed; None for others."""
    right = dense.rows[np.searchsorted([row.line for row in dense.rows], line)]
    words = replace(dense.states[line - 1], now=dict(dense.states[line - 1].now))
    wrong = words.read(new[0], line)
    return None if right.line != line or right.rapid or wrong is None else (right, wrong)


def moved(whole, dense, line, new):
    """How far [mm] the end of a cutting block goes from where it belongs, at the back of the teeth; 0 for others."""
    if (found := ends(dense, line, new)) is None:
        return 0.0
    reach = whole.spec.blank.mean_cone_distance + whole.spec.blank.face_width / 2
    right, wrong = (np.array(row.at) for row in found)
    return float(np.abs((wrong - right) * [1, 1, 1, reach, reach]).max())


def raised(dense, line, new):
    """How far [mm] the end of a cutting block goes up along its axis from a point of the flank, and not down."""
    right, wrong = ends(dense, line, new)
    points, _ = dense.points[right.tool]
    turn, point = dense.turn_of(dense.space_of(right)), points[len(points) // 4]
    heights = [dense.seen(np.array(row.at) - turn, point)[2] for row in (right, wrong)]
    return heights[0] - heights[1]


@pytest.mark.slow
def test_dense_check_is_not_blind_to_what_mill_sees(case):
    """Of blocks that are moved by more than twice the tolerance, down or aside, nearly all gouge, whatever the machine
    says. The others slide along the flank, or end in the 2 degrees by which the roll goes beyond it at both ends.

    Blocks that are raised off the flank leave metal where those before and behind do not take it: on flanks of a gear,
    which roll little, in a third of them.
    """
    whole, dense = case
    random = np.random.default_rng(100)
    changed = [
        (line, new)
        for kind, line, new in wrong_digits(whole, 30, 4, random)
        if kind in ("axis digit", "sign") and moved(whole, dense, line, new) > 2 * TOLERANCE
    ]
    seen, _ = whole.alone(changed)
    harm = np.array([dense.harm_of(*changed[mutant], machine=False) is not None for mutant in sorted(seen)])
    up = np.array([raised(dense, *changed[mutant]) > TOLERANCE for mutant in sorted(seen)])
    print(f"\n{whole.name} {whole.member}: {len(changed)} moved, {len(seen)} seen")
    print(f"{sum(harm & ~up)} of {sum(~up)} down or aside, {sum(harm & up)} of {sum(up)} raised spoil the part")
    assert len(harm) > (40 if whole.spec.generation == "generated" else 3)  # Formate: two blocks a space cut
    assert sum(harm) > 0.7 * len(harm)
    assert sum(harm & ~up) > 0.8 * sum(~up)
    assert sum(harm & up) > 0.25 * sum(up)


@pytest.mark.slow
def test_blocks_judged_among_their_neighbors_are_judged_as_in_the_whole_program(case):
    whole, _ = case
    random = np.random.default_rng(200)
    changed = [*wrong_digits(whole, 5, 1, random), *sample_of(others(whole), 7, random)]
    seen, open_ = whole.alone([(line, new) for _, line, new in changed])
    told = [mutant for mutant in range(len(changed)) if mutant not in open_]
    assert len(told) > 5
    # what shows only where a part of the program is run alone is none of the blocks'
    said = {mutant: whole.faults(whole.with_lines(*changed[mutant][1:])) for mutant in told}
    as_a_whole = {k: [fault for fault in some if "with R90=" not in fault] for k, some in said.items()}
    assert [mutant for mutant, some in as_a_whole.items() if some] == sorted(seen)


@pytest.mark.slow
def test_numbers_put_into_rows_at_once_are_judged_as_reader_and_control_take_them(case):
    whole, _ = case
    random = np.random.default_rng(400)
    changed = [(line, new) for _, line, new in wrong_digits(whole, 30, 10, random)]
    some = range(len(changed))
    at_once, (*_, rows) = whole.at_once(changed, some) if whole.rolls else (set(), ({},))
    assert len(at_once) > (100 if whole.rolls else -1)
    refused, open_, parts = whole.by_control(changed, some)
    by_control = {int(part["mutant"][0]): part for part in parts}
    for mutant in at_once:
        for key, values in by_control[mutant].items():
            np.testing.assert_allclose(rows[key][rows["mutant"] == mutant], values, rtol=0, atol=1e-9, err_msg=key)
    found = refused | whole.seen(parts)
    assert whole.alone(changed) == (found, open_ - found)


@pytest.mark.slow
def test_dense_check_says_the_same_of_one_end_and_of_all_ends_of_a_block_together(case):
    whole, dense = case
    changed = [(line, new) for _, line, new in wrong_digits(whole, 10, 25, np.random.default_rng(500))]
    together = dense.harms_of_ends(changed)
    assert len(together) > (100 if whole.rolls else -1)
    # of several kinds of harm another one may be met first
    harmless = {mutant for mutant, harm in together.items() if harm is None}
    assert harmless == {mutant for mutant in together if dense.harm_of(*changed[mutant]) is None}


@pytest.mark.slow
def test_what_changed_blocks_spoil_is_what_mill_finds_of_the_whole_part(case):
    """Also where another check sees the block already: of metal alone no more than one change in a hundred is seen."""
    whole, _ = case
    random = np.random.default_rng(600)
    changed = [(line, new) for _, line, new in wrong_digits(whole, 40, 1, random)]
    spoils = [one for one in changed if one[0] in whole.rolls and whole.spoils(*one)]
    if whole.rolls:
        assert len(spoils) > 5
    for line, new in spoils[:: max(len(spoils) // 2, 1)][:2]:
        path = execute(whole.with_lines(line, new), "CUT", Setup.of(MACHINE))
        assert whole.metal(runs_of(path, whole.spec, MACHINE, None, whole.space, SHARP_EDGE))


def hobbed_path(text, spec):
    """The path of a hobbing program, (n,6) and the time of every block; None if mill refuses it or sees something."""
    try:
        path = execute(text, "CUT", Setup.of(MACHINE))
        runs = runs_of(path, spec, MACHINE, None, None, SHARP_EDGE)
        if faults_of(text, path, runs, spec, MACHINE):
            return None
    except InputError:
        return None
    return np.column_stack([path.axes, path.cutter]), path.seconds


@pytest.mark.slow
@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_what_passes_of_wrong_hobbing_programs_is_the_right_path_within_the_tolerance(member):
    """Harmless is here: the same positions within 1.5 times the tolerance, and no block faster. In the plunge, at one
    place of X Y B, Z may stand anywhere above its end: what it takes away too early is taken away later.

    No dense check follows the blades of face hobbing one by one; what mill says of the metal is not asked.
    """
    bevel_set, tolerance = load_bevel_set(bundled("crown_gear_hobbed_14x39.toml")), 5e-4
    spec = bevel_set.member(member)
    text = cutting_program(bevel_set, member, MACHINE, "CUT", CuttingJob(range(spec.teeth), tolerance=tolerance))
    right, seconds = hobbed_path(text, spec)
    assert np.nan_to_num(np.diff(right, axis=0)).any(axis=1).all()
    cuts = seconds > 0
    fastest = np.nanmax(np.abs(np.diff(right[:, 5]))[cuts[1:]] / seconds[cuts])
    reach = spec.blank.mean_cone_distance + spec.blank.face_width / 2
    whole = SimpleNamespace(lines=text.split("\n"), path=execute(text, "CUT", Setup.of(MACHINE)))
    random = np.random.default_rng(300)
    changed = [*wrong_digits(whole, 20, 1, random), *sample_of(others(whole), 14, random)]
    passed = 0
    for kind, line, new in changed:
        found = hobbed_path("\n".join([*whole.lines[: line - 1], *new, *whole.lines[line:]]), spec)
        if found is None:
            continue
        passed += 1
        axes, times = found
        moves = np.append(True, np.nan_to_num(np.diff(axes, axis=0)).any(axis=1))
        axes, times = axes[moves], times[moves]
        assert len(axes) == len(right), (kind, whole.lines[line - 1], new)
        off = axes - right
        off[:, 3::2] = (off[:, 3::2] + np.pi) % (2 * np.pi) - np.pi
        plunges = np.append(False, ~np.diff(right[:, :2], axis=0).any(axis=1))
        off[plunges, 2] = np.minimum(axes[plunges, 2] - right[plunges, 2].min(), 0.0)
        off *= [1, 1, 1, reach, reach, spec.flank("concave").blade_point_radius]
        assert np.nanmax(np.abs(off)) < 1.5 * tolerance, (kind, whole.lines[line - 1], new)
        cuts = times > 0
        rate = np.abs(np.diff(axes[:, 5]))[cuts[1:]] / times[cuts]
        assert np.nanmax(rate) < 1.02 * fastest, (kind, whole.lines[line - 1], new)
    print(f"\nhobbed {member}: {len(changed)} mutants, {passed} harmless")
    assert passed < 0.6 * len(changed)

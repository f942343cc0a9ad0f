"""Cutting programs for LinuxCNC with one thing wrong in them: refused, seen, or shown to be harmless; none unseen.

As in ``test_mutations``: numbers of blocks that roll are put into the rows of the right program at once, and of all
other changes ``mill`` is asked whole.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from gearmath.machine.control.executor import execute
from gearmath.machine.control.state import Setup
from gearmath.machine.planning.cut_plan import cutting_plan
from gearmath.machine.writing.linuxcnc.cutting import program_of
from tests.gearmath.machine.judging.dense_check import MACHINE, Dense, NgcWords
from tests.gearmath.machine.judging.mutants import others, sample_of, trial, wrong_digits
from tests.gearmath.machine.judging.whole_program import Whole

#: In CI: a member of which both flanks are cut apart, one that is completed at once, and one that does not roll.
CASES = [("nasa_tp3096_12x36", "pinion"), ("spiral_7x43", "gear"), ("crown_gear_formate_14x39", "gear")]
SPACES = (0, 1)
ROLLING, PER_BLOCK, PER_KIND = 12, 75, 1


@dataclass
class NgcWhole(Whole):
    """A right program for LinuxCNC, and what ``mill`` says of others."""

    roll: ClassVar[re.Pattern] = re.compile(r"G1 X(\S+) Y(\S+) Z(\S+) A(\S+) B(\S+) F(\S+)")

    def written(self, bevel_set, job):
        return program_of(cutting_plan(bevel_set, self.member, MACHINE, job), "CUT")

    def _run_right(self):
        """Nothing is kept of the way there: only blocks that roll are judged among their neighbors."""

    def turn(self, values, at):
        return values[:, 5] > 0.0  # A stands as it is written

    def by_control(self, changed, some):
        return set(), set(some), []

    def changed(self, line, new):
        found, at, values = self.numbers([(line, new)], [0])
        if not len(found):
            return None
        (k,) = at.tolist()
        own = {key: getattr(self.path, key)[k : k + 1].copy() for key in ("axes", "rapid", "tool", "line", "rpm")}
        own |= {"axes": values[:, :5], "seconds": 60.0 / values[:, 5], "measuring": self.path.measuring[k : k + 1]}
        return own, k, k + 1, True


def sample(whole, rolling, per_block, per_kind, random):
    """Numbers of blocks that roll, and of all other changes as many of each kind."""
    blocks = random.choice(list(whole.rolls), min(rolling, len(whole.rolls)), replace=False) if whole.rolls else []
    found = {line: [] for line in sorted(np.array(blocks, int).tolist())}
    apart = {}
    for one in (*wrong_digits(whole, len(whole.lines), 10**6, random), *others(whole)):
        kind, line, new = one
        if line in whole.rolls and len(new) == 1 and whole.roll.fullmatch(new[0]):
            if line in found:
                found[line].append(one)
        else:
            apart.setdefault(kind, []).append(one)
    within = [one for some in found.values() for one in sample_of(some, per_block, random)]
    return [*within, *(one for kind in sorted(apart) for one in sample_of(apart[kind], per_kind, random))]


def told(whole, dense, changed):
    """Who sees the changes, as a sentence, and those that nobody sees."""
    count, unseen = trial(whole, dense, changed)
    kinds = sorted({kind for kind, _ in count})
    print(f"\n{whole.name} {whole.member}, {len(changed)} mutants, {len(unseen)} unseen; refused or seen + harmless:")
    print("; ".join(f"{kind} {count[kind, 'seen']} + {count[kind, 'harmless']}" for kind in kinds))
    return count, unseen


@pytest.fixture(scope="module", params=CASES, ids=["-".join(case) for case in CASES])
def case(request, witness):
    whole = NgcWhole(*request.param, SPACES)
    dense = Dense(*request.param, witness, whole.lines, NgcWords)
    assert [row.line for row in dense.rows] == whole.path.line.tolist()
    np.testing.assert_allclose(dense.axes, whole.path.axes, atol=1e-9)
    assert [row.tool for row in dense.rows] == [whole.path.tools[k] for k in whole.path.tool]
    return whole, dense


@pytest.mark.slow
def test_no_wrong_word_of_a_program_for_linuxcnc_is_left_unseen(case):
    whole, dense = case
    random = np.random.default_rng(CASES.index((whole.name, whole.member)))
    count, unseen = told(whole, dense, sample(whole, ROLLING, PER_BLOCK, PER_KIND, random))
    assert unseen == []
    assert sum(number for (_, who), number in count.items() if who == "seen") >= 5


@pytest.mark.slow
def test_numbers_put_into_rows_at_once_are_what_the_reader_of_the_dialect_takes(case):
    whole, _ = case
    changed = [one[1:] for one in sample(whole, 5, 1, 0, np.random.default_rng(400))]
    found, at, values = whole.numbers(changed, range(len(changed)))
    assert len(found) == (5 if whole.rolls else 0)
    for mutant, k, value in zip(found, at, values, strict=True):
        path = execute(whole.with_lines(*changed[mutant]), "CUT", Setup.of(MACHINE))
        np.testing.assert_allclose(path.axes[k], value[:5], rtol=0, atol=1e-12)
        assert path.seconds[k] == pytest.approx(60.0 / value[5], rel=1e-12)
        others_ = np.delete(np.arange(len(path.line)), k)
        np.testing.assert_array_equal(path.axes[others_], whole.path.axes[others_])

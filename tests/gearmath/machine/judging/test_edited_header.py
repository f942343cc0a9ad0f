"""A header that was edited makes no wrong program a right one, and an honest one no right program a wrong one."""

from __future__ import annotations

import re

import numpy as np
import pytest

from gearmath.bevel.tooth import SHARP_EDGE, tooth_space
from gearmath.errors import InputError
from gearmath.machine.control.executor import execute
from gearmath.machine.control.state import Setup
from gearmath.machine.judging.program import faults_of, metal_faults
from gearmath.machine.milling.run import runs_of
from gearmath.machine.planning.cut_plan import CuttingJob, cutting_plan
from gearmath.machine.writing.cutting import cutting_program
from gearmath.machine.writing.linuxcnc.cutting import program_of as linuxcnc_program
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
COARSE = MACHINE.model_copy(
    update={"name": "coarse", "control": MACHINE.control.model_copy(update={"increments_per_mm": 1000})}
)
#: A machine whose file says nothing of feeds.
LIMITED = MACHINE.model_copy(update={"max_feed_per_min": 2000.0, "max_feed_per_turn": 10.0, "max_cutting_speed": 300.0})
FREE = MACHINE.model_copy(update=dict.fromkeys(("max_feed_per_min", "max_feed_per_turn", "max_cutting_speed")))
NASA = "nasa_tp3096_12x36", "gear"
FORMATE = "crown_gear_formate_14x39", "gear"


def written(case, machine=MACHINE, control="sinumerik", **job):
    bevel_set = load_bevel_set(bundled(f"{case[0]}.toml"))
    spaces = range(bevel_set.member(case[1]).teeth) if "hobbed" in case[0] else (0,)
    asked = CuttingJob(**({"spaces": spaces} | job))
    if control == "linuxcnc":
        return linuxcnc_program(cutting_plan(bevel_set, case[1], machine, asked), "CUT")
    return cutting_program(bevel_set, case[1], machine, "CUT", asked)


def judged(case, text, machine=MACHINE):
    """The sentences of mill, and the tolerance [mm] that the flanks were compared with."""
    spec = load_bevel_set(bundled(f"{case[0]}.toml")).member(case[1])
    space = None if spec.process == "face_hobbing" else tooth_space(spec, 7)
    path = execute(text, "CUT", Setup.of(machine))
    runs = runs_of(path, spec, machine, None, space, SHARP_EDGE)
    left = metal_faults(text, path, runs, spec, machine, space)
    return [str(one) for one in (*left.faults, *faults_of(text, path, runs, spec, machine))], left.tolerance


def bent(text, pattern, wrong):
    changed, found = re.subn(pattern, wrong, text, count=1, flags=re.MULTILINE)
    assert found
    return changed


def moved(text, axis, by):
    """The block in the middle of the roll, with one axis elsewhere."""
    lines = text.split("\n")
    rows = [k for k, line in enumerate(lines) if " G93 G1 " in line]
    k = rows[len(rows) // 2]
    word = re.search(rf"{axis}(-?[\d.]+)", lines[k])
    lines[k] = lines[k].replace(word[0], f"{axis}{float(word[1]) + by:.5f}")
    return "\n".join(lines)


@pytest.mark.parametrize("case", [NASA, ("spiral_7x43", "pinion")])
def test_raised_tolerance_hides_no_gouge(case):
    """By hand: Z is 2 um too low, where the header says 50 um and the blocks are made for 0.1 um."""
    text = written(case)
    raised = bent(text, r"^; flank tolerance: 0\.1 um", "; flank tolerance: 50 um")
    said, tolerance = judged(case, raised)
    assert said == []
    assert 1e-4 <= tolerance < 4e-4
    said, _ = judged(case, moved(raised, "Z", -0.002))
    assert any(
        re.search(r"leaves -[01]\.\d+ um, the program states 50 um, and its blocks are made f", o) for o in said
    ), said


@pytest.mark.parametrize(
    ("case", "machine", "job"),
    [
        (NASA, MACHINE, {"tolerance": 1e-5}),
        (NASA, MACHINE, {"tolerance": 1e-3}),
        (NASA, MACHINE, {"tolerance": 1e-2, "blocks": "poly"}),
        (NASA, MACHINE, {"tolerance": 0.1}),
        (NASA, MACHINE, {"tolerance": 1e-3, "finishing_stock": 0.1}),
        (NASA, COARSE, {"tolerance": 1e-4}),
        (FORMATE, MACHINE, {"tolerance": 0.05}),
        (("crown_gear_hobbed_14x39", "pinion"), MACHINE, {"tolerance": 5e-3}),
        (NASA, FREE, {"tolerance": 1e-3, "feed": 3000.0}),
        (NASA, FREE, {"tolerance": 1e-2, "feed": 20000.0}),
        (NASA, FREE, {"tolerance": 1e-2, "feed": 2000.0, "blocks": "poly"}),
    ],
    ids=lambda value: (
        value.name if hasattr(value, "name") else "-".join(map(str, getattr(value, "values", lambda: value)()))
    ),
)
def test_honest_header_is_believed(case, machine, job):
    """Whatever is asked: very fine, coarse, far coarser than the blocks come to, rounded by the control, and fast."""
    said, tolerance = judged(case, written(case, machine, **job), machine)
    assert said == []
    assert tolerance > 0.0


def test_raised_feed_hides_no_fast_block():
    """By hand: one block in a tenth of its time, with a header that says ten times the feed."""
    lines = bent(written(NASA), r"^; feed: 300 mm/min", "; feed: 3000 mm/min").split("\n")
    assert judged(NASA, "\n".join(lines), FREE)[0] == []
    rows = [k for k, line in enumerate(lines) if " G93 G1 " in line]
    k = rows[len(rows) // 2]
    lines[k] = re.sub(r"F([\d.]+)$", lambda f: f"F{9 * float(f[1]):.3f}", lines[k])
    said, _ = judged(NASA, "\n".join(lines), FREE)
    assert any(
        re.search(r"at \d{4} mm/min past the tooth, the program states 3000 mm/min, and goes slo", o) for o in said
    ), said


def faster(text, feeds, speeds):
    """A program with all of its feeds and spindle speeds, header and blocks, times so much."""

    def times(factor, places):
        return lambda f: f"{f[1]}{factor * float(f[2]):.{places}f}{f[3]}"

    for pattern, factor, places in (
        (r"^(; feed: )([\d.]+)( mm/min)", feeds, 3),
        (r"^(; spindle: .* plunge: )([\d.]+)( mm/min)", feeds, 3),
        (r"^((?!N\d+ G4 )(?:N\d+|G).* F)([\d.]+)()$", feeds, 6),
        (r"^(; spindle: )([\d.]+)( rpm)", speeds, 3),
        (r"^((?:N\d+ )?S)([\d.]+)( M3.*)$", speeds, 3),
    ):
        text, found = re.subn(pattern, times(factor, places), text, flags=re.MULTILINE)
        assert found, pattern
    return text


@pytest.mark.parametrize(
    ("case", "job", "feeds", "speeds", "what"),
    [
        (NASA, {}, 10.0, 1.0, r"past the tooth by \d{4} mm/min: .* has max_feed_per_min 2000"),
        (NASA, {"blocks": "poly", "tolerance": 1e-2}, 10.0, 1.0, r"past the tooth by \d{4} mm/min"),
        (FORMATE, {"control": "linuxcnc"}, 11.0, 1.0, r"past the tooth by \d{4} mm/min"),
        (FORMATE, {}, 11.0, 1.0, r"past the tooth by \d{4} mm/min: .* has max_feed_per_min 2000"),
        (NASA, {}, 1.0, 0.2, r"by 1[0-2]\.\d mm a turn of it: .* has max_feed_per_turn 10"),
        (NASA, {}, 6.0, 6.0, r"with \d{3} m/min at the tips of its blades: .* has max_cutting_speed 300"),
    ],
)
def test_feeds_and_speeds_raised_in_header_and_blocks_meet_the_limits_of_the_machine(case, job, feeds, speeds, what):
    """By hand: 300 mm/min times 10; 300 / (120 / 5) = 12.5 mm; 2 pi 76 mm 720 rpm = 344 m/min."""
    right = written(case, **job)
    wrong = faster(right, feeds, speeds)
    assert judged(case, right, LIMITED)[0] == []
    assert any(re.search(what, one) for one in judged(case, wrong, LIMITED)[0])
    # and nothing else tells: so it was before the machine file had limits
    assert not any("past the tooth" in one or "speed" in one for one in judged(case, wrong, FREE)[0])


def test_bundled_machine_cuts_at_the_feed_of_dry_cutting_and_not_at_ten_times_that():
    fast = written(NASA, feed=3000.0)
    assert judged(NASA, fast)[0] == []
    assert any("has max_feed_per_min 4000" in one for one in judged(NASA, faster(fast, 10.0, 1.0))[0])


def test_dry_run_that_cuts_is_seen():
    """Without coolant, a header that says dry run let every program pass."""
    said, _ = judged(
        NASA, re.sub(r"(?m)^N\d+ M8\n", "", bent(written(NASA), "^; spaces", "; dry run: Z raised by 60 mm\n; spaces"))
    )
    assert any(re.search(r"is -?0\.000 mm above the path .* states a dry run 60 mm above it", one) for one in said), (
        said
    )
    assert not any("dry run" in one for one in judged(NASA, written(NASA, dry_run=True))[0])


def test_program_that_lost_the_line_with_our_name_is_judged_as_ours():
    nameless = bent(written(NASA), r"^; gearmath .* cutting program\n", "")
    assert judged(NASA, nameless)[0] == []
    said, _ = judged(NASA, re.sub(r"(?m)^N\d+ M8\n", "", nameless))
    assert any("cuts without coolant" in one for one in said)
    plain = re.sub(r"(?m)^N\d+ ", "", nameless)
    said, _ = judged(NASA, re.sub(r"IF \$TC_TP2.*\n(.*\n)*?.*ENDIF\n", "", plain))
    assert any("another tool is in the spindle" in one for one in said)


@pytest.mark.parametrize(
    ("line", "what"),
    [
        ("flank tolerance", "flank tolerance"),
        ("feed", "feed"),
        ("spindle", "spindle"),
        ("finish", "finish"),
        ("spaces", "spaces"),
    ],
)
def test_statement_that_is_missing_is_named(line, what):
    said, _ = judged(NASA, re.sub(rf"(?m)^; {line}: .*\n", "", written(NASA, tolerance=1e-2)))
    assert f"the header does not state: {what}" in said


def test_lines_of_the_header_changed_one_by_one_hide_no_gouge():
    """A figure of a header line ten times as large, with Z 0.02 mm too low in one block."""
    text = moved(written(NASA, tolerance=1e-3), "Z", -0.02)
    lines, random, tried = text.split("\n"), np.random.default_rng(0), 0
    for k, line in enumerate(lines):
        found = list(re.finditer(r"\d+(\.\d+)?", line)) if line.startswith(";") else []
        for one in [found[j] for j in random.permutation(len(found))[: k % 2]]:  # of every second line
            changed = line[: one.start()] + f"{10 * float(one[0]):g}" + line[one.end() :]
            said, _ = judged(NASA, "\n".join([*lines[:k], changed, *lines[k + 1 :]]))
            assert said, changed
            tried += 1
    assert tried > 10


def test_a_header_that_says_a_figure_twice_or_settings_of_another_set_is_refused():
    text = written(NASA)
    twice = bent(text, r"^(; flank tolerance: )0\.1( um.*\n)", r"\g<1>50\2\g<0>")
    assert "the header states more than once: flank tolerance" in judged(NASA, twice)[0]
    other = bent(text, r"^; machine settings sha256: \w{9}", "; machine settings sha256: 123456789")
    said, _ = judged(NASA, other)
    assert any("machine settings sha256: 123456789" in one and "the files of set and machine" in one for one in said)


def test_a_program_stops_on_a_control_that_has_fewer_increments_than_it_was_written_for():
    """The machine file tells what the control has: 1000 per mm, where the program asks for 100 000 before it moves."""
    with pytest.raises(InputError, match="alarm 65011: MN_INT_INCR_PER_MM is less than 100000"):
        execute(written(NASA), "CUT", Setup.of(COARSE))


def test_feed_beyond_that_of_the_machine_is_refused():
    with pytest.raises(InputError, match=r"^feed = 2001 mm/min: must be at most 2000, max_feed_per_min of "):
        written(NASA, LIMITED, feed=2001.0)
    with pytest.raises(InputError, match=r"^feed = 1e\+09 mm/min: must be at most 100000, the limit$"):
        written(NASA, FREE, feed=1e9)

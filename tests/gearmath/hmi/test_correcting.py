"""A correction on the page: accepted into new files beside the old ones, or rejected with a note that is kept."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import gearmath as gm
from gearmath.control.store import MeasurementStore
from gearmath.control.store_run import NOTE
from gearmath.errors import InputError
from gearmath.hmi import correcting
from gearmath.hmi.correcting import accept, charts_before, propose, reject, scale_before
from gearmath.hmi.judged_runs import JudgedRuns
from gearmath.hmi.run_history import past_runs
from tests.gearmath.hmi.stored import FILES


@pytest.fixture
def runs(own_runs: Path) -> JudgedRuns:
    return JudgedRuns(own_runs)


def test_what_is_accepted_cuts_what_was_expected_and_the_old_set_stays(runs: JudgedRuns, own_runs: Path) -> None:
    old = own_runs.with_name("nasa_tp3096_12x36.toml")
    old.write_bytes(b"# an older one\n")
    proposal = propose(runs.evaluated(1))
    made = accept(runs, proposal, own_runs.parent)
    assert (made.gear_set.name, made.program.name) == ("nasa_tp3096_12x36_run1.toml", "PINION_R1.MPF")
    assert old.read_bytes() == b"# an older one\n"
    # the corrected set on the exact surface, added to what was measured
    changed = gm.load_set(made.gear_set).pinion.deviations().file
    flanks = proposal.evaluated.found.flanks
    measured = [flanks[flank].topographies[0].deviation.ravel() for flank in proposal.correction.rms]
    added = np.concatenate(measured) + changed.deviation
    # how the work stood about its axis is open: what a small turn moves along the normals
    turn = np.cross([0.0, 0.0, 1.0], changed.point)
    turn = np.sum(turn * changed.normal, axis=1)
    left = np.split(added - turn * (turn @ added) / (turn @ turn), 2)
    for part, (before, after) in zip(left, proposal.correction.rms.values(), strict=True):
        assert np.sqrt(np.mean(part**2)) == pytest.approx(after, abs=1e-4)
        assert after < 0.2 * before
    assert b"M30" in made.program.read_bytes() or b"M17" in made.program.read_bytes()
    with MeasurementStore.open(own_runs, create=False) as store:
        kept = json.loads(store.run(1).results()[correcting.DECISION])
    assert kept["decision"] == "accepted"
    assert kept["files"]["set"]["sha256"] == hashlib.sha256(made.gear_set.read_bytes()).hexdigest()
    assert past_runs(runs)[-1].decided[-1].files == (made.gear_set.name, made.program.name)


def test_a_correction_that_leaves_every_setting_and_index_changes_nothing(runs: JudgedRuns) -> None:
    proposal = propose(runs.evaluated(1))
    assert not proposal.changes_nothing  # a stock that grows along the tooth
    for change, index, nothing in (([], [], True), ([], [0.0, 0.0], True), ([], [0.0, 0.001], False)):
        values = proposal.values | {"changes": change, "index_correction_deg": index}
        other = replace(proposal)
        other.__dict__["values"] = values
        assert other.changes_nothing is nothing


def test_accepting_twice_writes_over_nothing(
    runs: JudgedRuns,
    own_runs: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def written(member: gm.Member, machine: gm.Machine, name: str) -> gm.Program:
        return gm.Program(member, machine, name, f"; {name}\nM30\n")

    monkeypatch.setattr(correcting, "cutting", written)  # the name is all that counts here
    proposal = propose(runs.evaluated(1))
    first, second = (accept(runs, proposal, own_runs.parent) for _ in range(2))
    assert second.gear_set.name == "nasa_tp3096_12x36_run1_2.toml"
    assert second.program.name == "PINION_R1_2.MPF"
    assert first.gear_set.exists()
    assert first.program.exists()


def test_where_no_program_can_be_written_nothing_is(
    runs: JudgedRuns,
    own_runs: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise InputError("axis Z: out of its travel")

    monkeypatch.setattr(correcting, "cutting", refuse)
    before = set(own_runs.parent.iterdir())
    with pytest.raises(InputError, match="out of its travel"):
        accept(runs, propose(runs.evaluated(1)), own_runs.parent)
    assert {path for path in own_runs.parent.iterdir() if path.suffix in (".toml", ".MPF")} <= before
    assert past_runs(runs)[-1].decided == ()


@pytest.mark.parametrize("name", ["../../evil.toml", "/etc/passwd", "..\\up.toml", "<b>.toml", "", "a/b_run7_2.toml"])
def test_the_name_of_a_set_from_the_store_leads_nowhere_else(name: str) -> None:
    stem = correcting._stem(name)
    assert stem
    assert not set(stem) - set("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-")


def test_every_note_stays_with_the_run(runs: JudgedRuns, own_runs: Path) -> None:
    proposal = propose(runs.evaluated(2), "standard")
    reject(runs, proposal, "work was loose <b>")
    reject(runs, proposal, "once more")
    with pytest.raises(InputError, match=f"must have at most {NOTE}"):
        reject(runs, proposal, "x" * (NOTE + 1))
    for nothing in ("", "  "):
        with pytest.raises(InputError, match="note: is missing: say why"):
            reject(runs, proposal, nothing)
    decided = past_runs(runs)[1].decided
    assert [(one.decision, one.note) for one in decided] == [
        ("rejected", "work was loose <b>"),
        ("rejected", "once more"),
    ]
    with MeasurementStore.open(own_runs, create=False) as store:
        rows = store.execute("SELECT content FROM result WHERE run = 2 AND kind = ?", correcting.DECISION)
    assert [json.loads(content)["note"] for (content,) in rows] == ["work was loose <b>", "once more"]


def test_before_and_after_are_drawn_at_one_scale_and_what_was_drawn_is_not_drawn_again(runs: JudgedRuns) -> None:
    evaluated = runs.evaluated(1)
    kept: dict[tuple[str, float], str] = {}
    before = charts_before(evaluated, scale_before(evaluated), kept)
    charts = propose(evaluated).charts(kept)
    assert {flank: pair[0] for flank, pair in charts.items()} == before
    for old, new in charts.values():
        bars = [svg.split('id="', 1) and _bar(svg) for svg in (old, new)]
        assert bars[0] == bars[1]


def _bar(svg: str) -> tuple[str, str]:
    """The path of the scale bar, and its length in words."""
    path = svg.split("scale bar")[1].split(' d="')[1].split('"')[0]
    words = [part for part in svg.split("</text>") if part.endswith(" µm")]
    return path, words[-1].rsplit(">", 1)[-1]


def test_more_settings_leave_no_more(runs: JudgedRuns) -> None:
    evaluated = runs.evaluated(1)
    few, more = (propose(evaluated, which).values for which in ("few", "standard"))
    for one, other in zip(few["fits"], more["fits"], strict=True):
        assert len(one["settings"]) <= len(other["settings"])
        assert other["reachable_rms_um"] <= one["remaining_rms_um"] + 0.01
    assert FILES["set.toml"] == evaluated.run.start.settings["set.toml"]

"""Stored runs on the page: judged once, shown as the inspection sheet does, compared, and followed over time."""

from __future__ import annotations

import json
import re
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from gearmath.control.store_picture import runs_figure, trend_figure
from gearmath.errors import InputError
from gearmath.hmi.blocks import words_of_charts
from gearmath.hmi.drawing import drawn, translated
from gearmath.hmi.judged_runs import JudgedRuns
from gearmath.hmi.messages import Text
from gearmath.hmi.pages.history import words_of_trend
from gearmath.hmi.result_view import result_of, sure_of
from gearmath.hmi.run_history import comparison, past_runs, trend
from tests.gearmath.hmi.stored import SHARES, stock

Command = Callable[..., tuple[int, str, str]]


@pytest.fixture(scope="module")
def runs(stored_runs: Path) -> JudgedRuns:
    return JudgedRuns(stored_runs)


def test_only_complete_runs_of_a_member_are_to_be_judged(runs: JudgedRuns, tmp_path: Path) -> None:
    assert [one.run for one in runs.of_members()] == [1, 2]
    assert JudgedRuns(tmp_path / "none.db").summaries() == []
    with pytest.raises(InputError, match="run 3: is not whole"):
        runs.evaluated(3)


def test_a_complete_run_is_judged_once_whoever_asks(runs: JudgedRuns) -> None:
    first = runs.evaluated(1)
    found: list[object] = []
    threads = [threading.Thread(target=lambda: found.append(runs.evaluated(1))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(one is first for one in found)


def test_the_topography_shown_is_the_stock_that_was_left(runs: JudgedRuns) -> None:
    for run, share in zip((1, 2), SHARES, strict=True):
        found = runs.evaluated(run).found
        for flank in ("concave", "convex"):
            mean = found.flanks[flank].mean
            assert mean is not None
            points = found.file.select(flank)
            points = points.pick(points.tooth == found.flanks[flank].topographies[0].tooth)
            points = points.pick(np.lexsort((points.col, points.row)))
            left = np.array([stock(flank, 0, np.array([p[2], np.hypot(p[0], p[1])])) for p in points.point])
            # the rotation that both flanks have in common is taken out, about a constant; a touch has 0.5 µm of noise
            difference = mean.deviation.ravel() - share * left
            assert np.std(difference) < 0.0015


def test_the_page_shows_the_figures_of_the_command(own_runs: Path, command: Command, tmp_path: Path) -> None:
    status, out, _ = command("runs", "export", 1, "--store", own_runs, "--format", "files", "-o", tmp_path / "run")
    assert status == 0, out
    raw, measured = tmp_path / "run" / "touches.csv", tmp_path / "measured.csv"
    folder = tmp_path / "run"
    given = ("--machine", folder / "machine.toml", "--calibration", folder / "calibration.toml")
    assert command("touches", raw, "--set", folder / "set.toml", *given, "-o", measured)[0] == 0
    _, out, _ = command("evaluate", measured, "--set", folder / "set.toml", "--json")
    flanks = json.loads(out)["flanks"]
    shown = {(row.name, row.flank): row.cells for row in result_of(JudgedRuns(own_runs), 1).spacing}
    for flank, values in flanks.items():
        assert float(shown["F_p", flank][0]) == pytest.approx(values["F_p_um"], abs=0.005)
        assert float(shown["f_pt", flank][0]) == pytest.approx(values["max_f_pt_um"], abs=0.005)


def test_no_grade_is_shown_without_its_caveat(runs: JudgedRuns) -> None:
    found = result_of(runs, 1)
    assert any(row.cells[2] for row in found.spacing)
    assert "ISO 17485" in found.caveat
    assert set(found.topographies) == {"concave", "convex"}
    assert all(svg.startswith("<svg") for svg in (*found.topographies.values(), *found.pitches.values()))


def test_intervals_hold_the_value_and_the_sheet_is_that_of_the_report(runs: JudgedRuns) -> None:
    found = sure_of(runs, 1)
    for row in found.figures:
        value, u, low, high = map(float, row.cells[:4])
        assert u > 0
        assert low <= value <= high or row.cells[5] != "GUM"
    assert "assumed" in found.source
    sheet = runs.sheet(1)
    assert sheet.startswith("<!doctype html>")
    assert "default-src 'none'" in sheet
    assert "<td>Ann</td>" in sheet


def test_runs_are_listed_newest_first_with_what_a_control_said_as_it_was(runs: JudgedRuns) -> None:
    found = past_runs(runs)
    assert [one.summary.run for one in found] == [3, 2, 1]
    assert found[0].summary.state == "alarm 65001: <script>alert(2)</script>"
    assert {one.decision for one in found} == {""}


def test_a_comparison_sees_the_stock_shrink_and_the_trend_says_what_was_left_out(runs: JudgedRuns) -> None:
    found = comparison(runs, (2, 1))
    assert [one.run.id for one in found.runs] == [1, 2]
    spiral = {row.flank: row for row in found.figures if row.name == "spiral_angle_deviation_um"}
    for flank in ("concave", "convex"):
        first, last = spiral[flank].values
        assert first is not None
        assert last is not None
        assert last / first == pytest.approx(SHARES[1], abs=0.08)
        assert spiral[flank].beyond_noise
    with pytest.raises(InputError, match="two different runs"):
        comparison(runs, (1, 1))
    over_time, left_out = trend(runs, 2)
    assert [one.run.id for one in over_time.runs] == [1, 2]
    assert left_out == []


def test_comparison_and_trend_are_drawn_in_the_language_of_the_page(runs: JudgedRuns) -> None:
    german = Text("de")
    found, (over_time, _) = comparison(runs, (2, 1)), trend(runs, 2)
    words = words_of_charts(german) | words_of_trend(german, over_time)
    for make in (lambda: runs_figure(found), lambda: trend_figure(over_time)):
        shown = " ".join(re.findall(r">([^<>]+)</text>", translated(drawn(make), words)))
        assert "Ritzel, Läufe 1, 2" in shown
        english = (
            r"\b(flank|largest|before|after|deviation|pinion|runs|crowning|twist|residual|rms|max|mean|not|tooth)\b"
        )
        assert re.findall(english, shown) == []
    assert "Spiralwinkelabweichung" in words.values()


def test_words_of_a_drawing_are_translated_and_names_are_not() -> None:
    svg = "<svg><text>root</text><text>zero at the ring, 3 µm</text><text>&lt;root&gt;</text><g id='root'/></svg>"
    found = translated(svg, {"root": "Fuß", "zero at the ring": "null am Ring"})
    assert found == "<svg><text>Fuß</text><text>null am Ring, 3 µm</text><text>&lt;root&gt;</text><g id='root'/></svg>"


def test_drawings_of_one_page_share_no_names() -> None:
    from matplotlib.figure import Figure

    def make() -> Figure:
        figure = Figure(figsize=(1, 1))
        figure.subplots().plot([1, 2])
        return figure

    names = [{part.split('"')[0] for part in drawn(make).split(' id="')[1:]} for _ in range(2)]
    assert names[0]
    assert not names[0] & names[1]

"""What is written on the page Programs replaces nothing, and is of what was saved; without a browser."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
from nicegui import ui

from gearmath.errors import InputError
from gearmath.front.sets import load_set
from gearmath.hmi import programs_work
from gearmath.hmi.programs_work import free_name, write_cutting, write_probing
from gearmath.hmi.state import Choice, Shared
from gearmath.hmi.work import Progress
from gearmath.machine.measuring.checked import ProbingChoice
from gearmath.machine.planning.cut_plan import CuttingJob
from tests.gearmath.hmi.built import Built, build  # noqa: F401


def _press(page: Built, label: str) -> None:
    """As a click on a button that is there to be pressed."""
    (button,) = [one for one in page.client.elements.values() if isinstance(one, ui.button) and one.text == label]
    assert button.enabled, label
    with page.client:
        for listener in list(button._event_listeners.values()):
            listener.handler(None)


def test_a_program_of_another_kind_or_set_is_not_written_over(tmp_path: Path) -> None:
    there = tmp_path / "PROBE_PINION.MPF"
    there.write_text("; another one\n", "utf-8")
    with pytest.raises(InputError, match=r"PROBE_PINION\.MPF: is there already.*: PROBE_PINION_2\.MPF is free"):
        write_cutting(tmp_path, Choice(), "probe_pinion.mpf", CuttingJob(), Progress())
    with pytest.raises(InputError, match="is there already"):
        write_probing(tmp_path, Choice(), "PROBE_PINION", ProbingChoice(), Progress())
    assert there.read_text("utf-8") == "; another one\n"
    assert free_name(tmp_path, Choice(), "probe_pinion") == ("PROBE_PINION.MPF", "PROBE_PINION_2")
    assert free_name(tmp_path, Choice(), "CUT") == ("", "CUT")


def test_of_two_that_write_at_once_the_second_writes_over_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def made(*given: object, file: str, **_: object) -> SimpleNamespace:
        (tmp_path / file).write_text("; of another page\n", "utf-8")
        return SimpleNamespace(blocks=1, touches=1, clearance="", save=lambda path: path.write_text("; mine\n"))

    monkeypatch.setattr(programs_work, "probing", made)
    with pytest.raises(InputError, match=r"PROBE\.MPF: was written by another one in the meantime"):
        write_probing(tmp_path, Choice(), "PROBE", ProbingChoice(), Progress())
    assert (tmp_path / "PROBE.MPF").read_text("utf-8") == "; of another page\n"


def test_the_page_asks_and_writes_beside_what_is_there(
    build: Callable[..., Built],  # noqa: F811
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    written: list[str] = []
    monkeypatch.setattr(programs_work, "write_cutting", lambda folder, choice, name, *_: written.append(name))
    (tmp_path / "CUT_PINION.MPF").write_text("; another one\n", "utf-8")
    shared = Shared(tmp_path / "runs.db")
    page = build(shared, "programs")
    _press(page, "Write cutting program")
    assert "CUT_PINION.MPF is there already and is not written over. Write CUT_PINION_2 beside it?" in page.says()
    assert written == []
    _press(page, "Yes, do it")
    shared.works["programs.cut"].wait(10)
    assert written == ["CUT_PINION_2"]


def test_no_program_is_written_while_settings_are_typed_and_not_saved(
    build: Callable[..., Built],  # noqa: F811
    tmp_path: Path,
) -> None:
    shared = Shared(tmp_path / "runs.db")
    page = build(shared, "programs")
    labels = ("Write cutting program", "Write probing program")
    buttons = [one for one in page.client.elements.values() if isinstance(one, ui.button) and one.text in labels]
    assert [one.enabled for one in buttons] == [True, True]
    shared.desk.typed = {(("concave",), "radial_distance"): 75.0}
    page.look()
    assert [one.enabled for one in buttons] == [False, False]
    assert any("not saved" in words for words in page.says())
    shared.desk.typed = {}
    page.look()
    assert [one.enabled for one in buttons] == [True, True]


def test_a_set_that_is_other_than_nominal_is_said_to_be_where_it_is_milled(tmp_path: Path) -> None:
    """The deviation is from the nominal flanks: of a changed set it is that change, and no verdict on the program."""
    member = load_set(Choice().gear_set).member("pinion")
    assert not programs_work._is_changed(member.spec)
    for name, value in (("radial_distance", 74.9), ("cutter_tilt", 0.1)):
        assert programs_work._is_changed(member.with_values(concave={name: value}).spec)
    assert not programs_work._is_changed(member.with_values(concave={"cutter_tilt": 0.1}).as_nominal().spec)

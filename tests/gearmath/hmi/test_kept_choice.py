"""The choice of the operator outlives the server, and what was typed outlives another choice."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from gearmath.hmi.kept_choice import keep_choice, kept_choice
from gearmath.hmi.state import Choice, Shared
from gearmath.specs.toml import bundled
from tests.gearmath.hmi.built import Built, build  # noqa: F401

TYPED = {(("concave",), "radial_distance"): 75.0}


def test_a_choice_is_there_again_after_a_restart(tmp_path: Path) -> None:
    own = tmp_path / "mine.toml"
    own.write_bytes(bundled("spiral_7x43.toml").read_bytes())
    file = tmp_path / "runs_choice.json"
    assert kept_choice(file) == (Choice(), [])
    shared = Shared(tmp_path / "runs.db", keep=lambda choice: keep_choice(file, choice))
    shared.choose(gear_set=str(own), member="gear")
    assert kept_choice(file) == (Choice(gear_set=str(own), member="gear"), [])
    own.unlink()
    found, lost = kept_choice(file)
    assert found == Choice(member="gear")
    assert len(lost) == 1
    assert "mine.toml" in lost[0]
    assert lost[0].endswith("nasa_tp3096_12x36.toml is chosen instead")


@pytest.mark.parametrize("content", ["", "[[[", "[]", "3", '{"gear_set": 3, "member": "wheel"}', "\0"])
def test_a_damaged_file_chooses_what_comes_with_gearmath(tmp_path: Path, content: str) -> None:
    file = tmp_path / "runs_choice.json"
    file.write_text(content, "utf-8")
    assert kept_choice(file)[0] == Choice()


def test_what_was_typed_is_kept_while_another_tab_chooses_something_else(
    build: Callable[..., Built],  # noqa: F811
    tmp_path: Path,
) -> None:
    shared = Shared(tmp_path / "runs.db")
    shared.desk.typed = dict(TYPED)
    page = build(shared, "gear", wait=False)
    shared.choose(member="gear")
    assert shared.desk.typed == {}
    page.look(wait=False)
    assert any("Typed and not saved: nasa_tp3096_12x36.toml, Pinion." in words for words in page.says())
    shared.choose(machine=shared.choice.machine)
    shared.choose(member="pinion")
    assert shared.desk.typed == TYPED
    page.look(wait=False)
    assert not any("Typed and not saved" in words for words in page.says())

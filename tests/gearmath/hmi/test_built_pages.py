"""What pages say, without a browser."""

from __future__ import annotations

import re
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

from gearmath.hmi import gear_draft
from gearmath.hmi.messages import Text
from gearmath.hmi.shell import PAGES
from gearmath.hmi.state import Choice, Shared
from gearmath.specs.toml import bundled
from tests.gearmath.hmi.built import Built, build  # noqa: F401


def test_what_is_computed_is_named_in_the_language_of_who_looks_not_of_who_has_begun_it(
    build: Callable[..., Built],  # noqa: F811
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    shared, go_on = Shared(tmp_path / "runs.db"), threading.Event()
    known = gear_draft.draft
    monkeypatch.setattr(gear_draft, "draft", lambda *given: go_on.wait(60) and known(*given))
    said = {language: build(shared, "gear", language, wait=False).says() for language in ("en", "de")}
    go_on.set()
    for language, other in (("en", "de"), ("de", "en")):
        assert any(Text(language)("gear.judging") in one for one in said[language])
        assert not any(Text(other)("gear.judging") in one for one in said[language])


#: What may be chosen of each kind, and what the page calls it.
KINDS = {
    "gear_set": ("gear", Choice().gear_set),
    "machine": ("gear", Choice().machine),
    "calibration": ("gear", Choice().calibration),
    "hobber": ("gearbox", "hobbing_plewes.toml"),
}


#: The pages that read each of them before anything is pressed.
READ_BY: dict[str, set[str]] = {
    "gear_set": {"gear", "programs"},
    "machine": {"programs"},
    "calibration": set(),
    "hobber": {"gearbox"},
}


def _damaged(kind: str, path: Path) -> None:
    """A file of another kind in its place."""
    path.write_bytes(bundled("probe.toml" if kind != "calibration" else Choice().machine).read_bytes())


def _folder(kind: str, path: Path) -> None:
    path.unlink()
    path.mkdir()


#: How a file is damaged after it was listed.
DAMAGES: dict[str, Callable[[str, Path], object]] = {
    "no TOML": lambda _, path: path.write_text(path.read_text("utf-8") + "\n[[[", "utf-8"),
    "cut off": lambda _, path: path.write_text("\n".join(path.read_text("utf-8").splitlines()[:6]), "utf-8"),
    "empty": lambda _, path: path.write_bytes(b""),
    "a word for a number": lambda _, path: path.write_text(
        re.sub(r"(?m)^([a-z_]+ *= *)-?\d+\.?\d*", r'\1"none"', path.read_text("utf-8")), "utf-8"
    ),
    "a number for a table": lambda _, path: path.write_text(
        re.sub(r"(?ms)^\[.*", "", path.read_text("utf-8")) + "axes = 1\npinion = 2\nencoder = 3\nstylus = 4\n", "utf-8"
    ),
    "another kind of file": _damaged,
    "not UTF-8": lambda _, path: path.write_bytes(b"# M\xfcller\n" + path.read_bytes()),
    "a zero byte": lambda _, path: path.write_bytes(path.read_bytes() + b"\0"),
    "a folder": _folder,
    "away": lambda _, path: path.unlink(),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("language", ["en", "de"])
def test_a_damaged_file_that_is_chosen_is_refused_in_one_sentence_and_the_one_before_stays(
    build: Callable[..., Built],  # noqa: F811
    tmp_path: Path,
    kind: str,
    language: str,
) -> None:
    name, before = KINDS[kind]
    content, path = bundled(before).read_bytes(), tmp_path / f"own_{kind}.toml"
    path.write_bytes(content)
    shared = Shared(tmp_path / "runs.db")
    page = build(shared, name, language)
    label = Text(language)("gearbox.file" if kind == "hobber" else f"gear.{kind}")
    said = page.says()
    for what, damage in DAMAGES.items():
        damage(kind, path)
        with page.client:
            page.select(label).value = str(path)
            page.look()
            assert page.select(label).value == before, what
            assert shared.choice == Choice(), what
            assert shared.desk.hobber == "hobbing_plewes.toml", what
            assert page.says() == said, what
            (words,) = page.over()
            assert path.name in words, what
            assert len(words.splitlines()) == 1, words
            page.dismiss()
        if path.is_dir():
            path.rmdir()
        path.write_bytes(content)
    with page.client:
        page.select(label).value = str(path)  # repaired
    assert str(path) in (shared.desk.hobber, *vars(shared.choice).values())


@pytest.mark.parametrize("kind", KINDS)
def test_a_file_that_is_damaged_while_it_is_in_use_is_named_on_every_page_and_comes_back_when_it_is_repaired(
    build: Callable[..., Built],  # noqa: F811
    tmp_path: Path,
    kind: str,
) -> None:
    content, path = bundled(KINDS[kind][1]).read_bytes(), tmp_path / f"own_{kind}.toml"
    path.write_bytes(content)
    shared = Shared(tmp_path / "runs.db")
    if kind == "hobber":
        shared.desk.hobber = str(path)
    else:
        shared.choose(**{kind: str(path)})
    for name in PAGES:
        page = build(shared, name)
        said = page.says()
        for what, damage in DAMAGES.items():
            damage(kind, path)
            page.look()
            words = [one for one in page.says() if one not in said and path.name in one]
            assert all(len(one.splitlines()) == 1 for one in words), what
            assert bool(words) == (name in READ_BY[kind]), f"{name}, {what}"
            if path.is_dir():
                path.rmdir()
            path.write_bytes(content)
            page.look()
            assert page.says() == said, what


@pytest.mark.parametrize("name", ["gear", "gearbox"])
@pytest.mark.parametrize("language", ["en", "de"])
def test_a_file_of_the_folder_that_is_in_no_list_is_named_with_the_reason(
    build: Callable[..., Built],  # noqa: F811
    tmp_path: Path,
    name: str,
    language: str,
) -> None:
    for what in ("no TOML", "not UTF-8", "a zero byte"):
        path = tmp_path / f"{what.replace(' ', '_')}.toml"
        path.write_bytes(bundled(Choice().gear_set).read_bytes())
        DAMAGES[what](name, path)
    (tmp_path / "whole.toml").write_bytes(bundled(Choice().gear_set).read_bytes())
    (tmp_path / "other.toml").write_text("a = 1\n", "utf-8")
    begin = Text(language)("gear.unreadable", why="")
    said = [one for one in build(Shared(tmp_path / "runs.db"), name, language).says() if one.startswith(begin)]
    assert [Path(re.findall(r"\S+[.]toml", one)[0]).name for one in said] == [
        "a_zero_byte.toml",
        "no_TOML.toml",
        "not_UTF-8.toml",
    ]
    assert all(len(one.splitlines()) == 1 and not one.endswith(".toml") for one in said)

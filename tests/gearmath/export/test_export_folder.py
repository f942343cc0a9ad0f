"""Folders are written whole, and replaced only where their own manifest lists every file."""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path

import pytest

from gearmath.errors import InputError
from gearmath.export.folder import write_folder


def content(folder: Path) -> dict[str, str]:
    return {p.relative_to(folder).as_posix(): p.read_text() for p in folder.rglob("*") if p.is_file()}


def test_manifest_lists_the_sha256_of_every_file(tmp_path: Path) -> None:
    write_folder(tmp_path / "new" / "out", {"b.c": "β\n", "sub/a.h": "x\n"})
    listed = json.loads((tmp_path / "new" / "out" / "manifest.json").read_text())["sha256"]
    for name, digest in listed.items():
        assert hashlib.sha256((tmp_path / "new" / "out" / name).read_bytes()).hexdigest() == digest
    assert set(listed) == {"b.c", "sub/a.h"}


def test_own_folder_is_replaced_whole_and_nothing_is_left_beside(tmp_path: Path) -> None:
    write_folder(tmp_path / "out", {"old.c": "1", "kept.c": "1"})
    write_folder(tmp_path / "out", {"kept.c": "2"})
    assert set(content(tmp_path / "out")) == {"kept.c", "manifest.json"}
    assert content(tmp_path / "out")["kept.c"] == "2"
    assert os.listdir(tmp_path) == ["out"]


def test_file_that_was_edited_is_named_and_kept(tmp_path: Path) -> None:
    write_folder(tmp_path / "out", {"README.md": "tick the rows off\n", "sub/a.h": "x\n", "gone.c": "1"})
    (tmp_path / "out" / "README.md").write_text("RB1 = 220k\n")
    (tmp_path / "out" / "gone.c").unlink()
    before = content(tmp_path / "out")
    with pytest.raises(InputError, match=r"out: README\.md was changed since gearmath wrote it, .* move it away, or"):
        write_folder(tmp_path / "out", {"README.md": "new\n"})
    assert content(tmp_path / "out") == before
    (tmp_path / "out" / "README.md").rename(tmp_path / "mine.md")
    write_folder(tmp_path / "out", {"README.md": "new\n"})
    assert content(tmp_path / "out")["README.md"] == "new\n"


def test_empty_folder_is_taken(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    write_folder(tmp_path / "out", {"a.c": "1"})
    assert "a.c" in content(tmp_path / "out")


@pytest.mark.parametrize("foreign", ["notes.txt", "sub/notes.txt", ".hidden"])
def test_folder_with_a_foreign_file_is_refused_by_its_name_and_left_alone(tmp_path: Path, foreign: str) -> None:
    write_folder(tmp_path / "out", {"a.c": "1"})
    (tmp_path / "out" / foreign).parent.mkdir(exist_ok=True)
    (tmp_path / "out" / foreign).write_text("mine")
    before = content(tmp_path / "out")
    with pytest.raises(InputError, match=f"out: holds {foreign}, "):
        write_folder(tmp_path / "out", {"a.c": "2"})
    assert content(tmp_path / "out") == before
    assert os.listdir(tmp_path) == ["out"]


@pytest.mark.parametrize("text", ["", "[]", '{"sha256": 1}', "{}", "\xff"])
def test_manifest_that_is_not_ours_protects_the_folder(tmp_path: Path, text: str) -> None:
    (tmp_path / "manifest.json").write_text(text, "latin-1")
    with pytest.raises(InputError, match=r"holds manifest\.json"):
        write_folder(tmp_path, {"a.c": "1"})


def test_first_foreign_file_is_named_where_there_is_no_manifest(tmp_path: Path) -> None:
    for name in ("b.txt", "a.txt"):
        (tmp_path / name).write_text("mine")
    with pytest.raises(InputError, match=r"holds a\.txt"):
        write_folder(tmp_path, {"c.c": "1"})


def test_file_link_and_current_folder_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("mine")
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "real")
    monkeypatch.chdir(tmp_path / "real")
    for name, message in (("file", "is no folder"), ("link", "is no folder"), ("real", "is the current folder")):
        with pytest.raises(InputError, match=message):
            write_folder(tmp_path / name, {"a.c": "1"})
    with pytest.raises(InputError, match="file is a file and not a folder"):
        write_folder(tmp_path / "file" / "below", {"a.c": "1"})


def test_old_folder_comes_back_where_the_exchange_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_folder(tmp_path / "out", {"a.c": "1"})
    rename, calls = os.rename, []

    def fail_once(source: Path, target: Path) -> None:
        calls.append(source)
        if len(calls) == 2:
            raise OSError(28, "No space left on device")
        rename(source, target)

    monkeypatch.setattr(os, "rename", fail_once)
    with pytest.raises(InputError, match="out: cannot be written: No space left on device"):
        write_folder(tmp_path / "out", {"a.c": "2"})
    assert content(tmp_path / "out")["a.c"] == "1"
    assert os.listdir(tmp_path) == ["out"]

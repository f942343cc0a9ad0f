"""Files appear whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from gearmath.errors import InputError
from gearmath.files import read_text, write_bytes, write_text


def test_text_is_utf8_with_line_feeds_on_every_system(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    write_text(path, "φ = 20°\nnext\n")
    assert path.read_bytes() == "φ = 20°\nnext\n".encode()
    assert read_text(path) == "φ = 20°\nnext\n"


def test_new_file_can_be_read_by_others(tmp_path: Path) -> None:
    write_text(tmp_path / "a.txt", "text")
    assert (tmp_path / "a.txt").stat().st_mode & 0o777 == 0o644


def test_old_content_stands_until_the_new_is_complete(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.bin"
    write_bytes(path, b"old")
    seen = []
    replace = os.replace

    def look(source: str, target: Path) -> None:
        seen.append((path.read_bytes(), Path(source).read_bytes()))
        replace(source, target)

    monkeypatch.setattr(os, "replace", look)
    write_bytes(path, b"new")
    assert seen == [(b"old", b"new")]
    assert path.read_bytes() == b"new"


def test_failed_write_leaves_the_old_file_and_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.txt"
    write_text(path, "old")

    def full(descriptor: int, mode: str) -> None:
        os.close(descriptor)
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fdopen", full)
    with pytest.raises(InputError, match=r"a\.txt: cannot be written: No space left on device"):
        write_text(path, "new")
    monkeypatch.undo()
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.txt"]
    assert path.read_text() == "old"


def test_target_that_cannot_be_written_is_named_and_nothing_is_left(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"a\.txt: cannot be written: there is no folder .*absent"):
        write_text(tmp_path / "absent" / "a.txt", "text")
    (tmp_path / "folder").mkdir()
    with pytest.raises(InputError, match="folder: cannot be written: is a folder, name a file"):
        write_text(tmp_path / "folder", "text")
    assert [entry.name for entry in tmp_path.iterdir()] == ["folder"]


def test_a_device_is_not_replaced_by_a_file(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(InputError, match="pipe: cannot be written: is a device, name a file"):
        write_text(tmp_path / "pipe", "text")
    assert (tmp_path / "pipe").is_fifo()
    assert [entry.name for entry in tmp_path.iterdir()] == ["pipe"]


def test_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"absent: cannot be read: No such file"):
        read_text(tmp_path / "absent")
    with pytest.raises(InputError, match=r"cannot be read: is a folder, name a file"):
        read_text(tmp_path)
    (tmp_path / "picture").write_bytes(b"ok \xff\xfe")
    with pytest.raises(InputError, match="picture: is no text file: byte 3 is not UTF-8"):
        read_text(tmp_path / "picture")


@pytest.mark.parametrize(
    ("store", "reason"),
    [
        ("/proc/x.db", "/proc/x.db: cannot be written: "),  # a folder that even root cannot add a file to
        ("missing/x.db", "missing/x.db: cannot be written: "),
        ("", "--store: must name a file, "),
    ],
)
@pytest.mark.parametrize("verb", ["hmi", "runs"])
def test_a_store_that_cannot_be_is_refused_at_once(
    command: Callable[..., tuple[int, str, str]], verb: str, store: str, reason: str
) -> None:
    more = ("--port", 0) if verb == "hmi" else ("list",)
    if verb == "runs" and store:
        reason = store  # it is read only
    status, out, err = command(verb, *more, "--store", store)
    assert (status, out) == (2, "")
    assert err.startswith(f"gearmath: {reason}")
    assert len(err.splitlines()) == 1

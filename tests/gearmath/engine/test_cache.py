"""What the cache gives back: what was put in by this user, whole, and nothing else."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from gearmath.engine import cache


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    monkeypatch.setenv("GEARMATH_CACHE", str(tmp_path / "kept"))
    cache.folder.cache_clear()
    yield tmp_path / "kept"
    cache.folder.cache_clear()


def test_gives_back_what_was_kept(place: Path) -> None:
    assert cache.read("a") is None
    cache.write("a", b"content")
    assert cache.read("a") == b"content"
    assert [path.name for path in place.iterdir()] == ["a"]


@pytest.mark.parametrize(
    "damage", [lambda data: data[:-1], lambda data: data + b"x", lambda data: b"", lambda data: data[64:]]
)
def test_nothing_that_is_damaged(place: Path, damage) -> None:
    cache.write("a", b"content")
    (place / "a").write_bytes(damage((place / "a").read_bytes()))
    assert cache.read("a") is None


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="needs users as POSIX has them")
def test_nothing_that_others_could_have_written(place: Path) -> None:
    cache.write("a", b"content")
    (place / "a").chmod(0o666)
    assert cache.read("a") is None
    (place / "a").chmod(0o600)
    place.chmod(0o777)
    cache.folder.cache_clear()
    assert cache.folder() is None


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes as POSIX has them")
def test_nothing_out_of_a_pipe_and_nobody_waits_for_it(place: Path) -> None:
    cache.write("a", b"content")
    (place / "a").unlink()
    os.mkfifo(place / "a", 0o600)
    assert cache.read("a") is None


def test_a_relative_place_stays_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("GEARMATH_CACHE", "kept")
    cache.folder.cache_clear()
    cache.write("a", b"content")
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert cache.read("a") == b"content"
    monkeypatch.delenv("GEARMATH_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    cache.folder.cache_clear()
    assert sys.platform == "win32" or cache.folder() != tmp_path / "elsewhere" / "relative" / "gearmath"
    cache.folder.cache_clear()


def test_a_place_that_cannot_be_written_is_no_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("GEARMATH_CACHE", str(tmp_path / "file" / "under"))
    cache.folder.cache_clear()
    cache.write("a", b"content")
    assert cache.read("a") is None
    cache.folder.cache_clear()


def test_an_empty_name_means_no_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GEARMATH_CACHE", "")
    cache.folder.cache_clear()
    assert cache.folder() is None
    cache.folder.cache_clear()


def test_a_user_without_a_home_folder_has_no_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    def homeless() -> Path:
        raise RuntimeError("Could not determine home directory.")

    for name in ("GEARMATH_CACHE", "XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(cache.Path, "home", homeless)
    cache.folder.cache_clear()
    assert sys.platform == "win32" or cache.folder() is None
    cache.folder.cache_clear()


def test_keys_tell_apart_where_one_text_ends_and_the_next_begins() -> None:
    assert cache.key("ab", "c") != cache.key("a", "bc") != cache.key("abc")


def test_processes_that_keep_the_same_at_once_leave_it_whole(place: Path) -> None:
    program = (
        "from gearmath.engine import cache\n"
        "for k in range(200): cache.write('a', b'x' * 100_000); assert cache.read('a')"
    )
    running = [subprocess.Popen([sys.executable, "-c", program], env=os.environ) for _ in range(3)]
    assert [process.wait() for process in running] == [0, 0, 0]
    assert cache.read("a") == b"x" * 100_000

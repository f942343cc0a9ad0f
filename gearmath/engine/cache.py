"""A folder of this user for what takes long to make: lowered expressions and compiled kernels.

The name of a file says what it was made from, and it begins with the digest of its content. Nothing is read that
another user owns or could have written, and nothing that is damaged: it is made again.
"""

from __future__ import annotations

import hashlib
import os
import stat
import sys
import tempfile
from functools import cache
from pathlib import Path

_DIGEST = 64  # characters of a sha256
#: Set to a folder to keep the cache there, or to nothing ("") to do without one.
_VARIABLE = "GEARMATH_CACHE"


@cache
def folder() -> Path | None:
    """The cache folder, made on first use; None where there is none that only this user can write."""
    chosen = os.environ.get(_VARIABLE)
    if chosen == "":
        return None
    try:
        place = Path(chosen).absolute() if chosen else _usual()  # the same when the program changes its folder
        place.mkdir(mode=0o700, parents=True, exist_ok=True)
        return place if _own(place.stat()) else None
    except (OSError, RuntimeError):  # a user of a number alone, as in a container, has no home folder
        return None


def _usual() -> Path:
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or tempfile.gettempdir()) / "gearmath" / "cache"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "gearmath"
    named = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(named) if os.path.isabs(named) else Path.home() / ".cache") / "gearmath"  # no other counts, says XDG


def _own(status: os.stat_result) -> bool:
    """Whether a file or folder belongs to this user and nobody else can write it. (Windows keeps that by profile.)"""
    if not hasattr(os, "getuid"):
        return True
    return status.st_uid == os.getuid() and not status.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


def key(*parts: str | bytes) -> str:
    """A name for what is made from these texts."""
    found = hashlib.sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        found.update(f"{len(data)}:".encode() + data)
    return found.hexdigest()[:32]


def read(name: str) -> bytes | None:
    """The content kept under a name; None where there is none, where it is damaged, or where it is not this user's."""
    place = folder()
    if place is None:
        return None
    try:
        with open(place / name, "rb", opener=_at_once) as stream:
            status = os.fstat(stream.fileno())
            if not (_own(status) and stat.S_ISREG(status.st_mode)):
                return None
            content = stream.read()
    except OSError:
        return None
    digest, data = content[:_DIGEST], content[_DIGEST:]
    return data if hashlib.sha256(data).hexdigest().encode() == digest else None


def _at_once(path: str, flags: int) -> int:
    """A file opened without waiting: a pipe would wait for somebody who writes into it."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


def write(name: str, data: bytes) -> None:
    """Keep content under a name, in one step. A cache that cannot be written is no error: the work is done again."""
    place = folder()
    if place is None:
        return
    try:
        handle, temporary = tempfile.mkstemp(dir=place, prefix=".")
        try:
            with os.fdopen(handle, "wb") as stream:
                stream.write(hashlib.sha256(data).hexdigest().encode() + data)
            os.replace(temporary, place / name)
        except OSError:
            os.unlink(temporary)
    except OSError:
        pass

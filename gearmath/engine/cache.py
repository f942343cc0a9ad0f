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
        place = Path(chosen) if chosen else _usual()
        place.mkdir(mode=0o700, parents=True, exist_ok=True)
        return place if _own(place.stat()) else None
    except (OSError, RuntimeError):  # a user of a number alone, as in a container, has no home folder
        return None


def _usual() -> Path:
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or tempfile.gettempdir()) / "gearmath" / "cache"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "gearmath"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "gearmath"


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
        with (place / name).open("rb") as stream:
            if not _own(os.fstat(stream.fileno())):
                return None
            content = stream.read()
    except OSError:
        return None
    digest, data = content[:_DIGEST], content[_DIGEST:]
    return data if hashlib.sha256(data).hexdigest().encode() == digest else None


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

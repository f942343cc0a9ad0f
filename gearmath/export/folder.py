"""A folder of files written in one step, with a manifest that says what is ours.

A folder is replaced only where its own manifest lists every file in it, as it still is: nobody's work is ever deleted.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from gearmath.errors import InputError
from gearmath.version import __version__

MANIFEST = "manifest.json"


@contextmanager
def new_folder(folder: Path) -> Iterator[Path]:
    """A place to build the content of ``folder`` in; on leaving, it gets a manifest and takes the place of the folder.

    If the body raises, nothing has happened. Raises InputError naming the first file that is not listed in the
    manifest of an existing folder, or not as it was written, or why the folder cannot be written.
    """
    target = Path(os.path.abspath(folder))
    if Path.cwd().is_relative_to(target):
        raise InputError(f"{folder}: is the current folder or holds it; name a folder to be made")
    for parent in target.parents:
        if os.path.exists(parent) and not os.path.isdir(parent):
            raise InputError(f"{folder}: {os.path.relpath(parent)} is a file and not a folder")
    try:
        _check_ours(folder, target)
        target.parent.mkdir(parents=True, exist_ok=True)
        beside = Path(tempfile.mkdtemp(dir=target.parent, prefix=f".{target.name}."))
    except OSError as error:
        raise InputError(f"{folder}: cannot be written: {error.strerror}") from error
    try:
        (beside / "new").mkdir()
        yield beside / "new"
        contents = {name: (beside / "new" / name).read_bytes() for name in _names(beside / "new")}
        (beside / "new" / MANIFEST).write_text(_manifest(contents), "utf-8", newline="\n")
        _exchange(beside, target)
    except OSError as error:
        raise InputError(f"{folder}: cannot be written: {error.strerror}") from error
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def write_folder(folder: Path, files: Mapping[str, str]) -> None:
    """Write ``files`` (relative name to text) and their manifest as the folder's whole content: see new_folder."""
    with new_folder(folder) as place:
        for name, text in files.items():
            path = place / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, "utf-8", newline="\n")


def manifest(files: Mapping[str, str]) -> str:
    """JSON text: the SHA-256 of every file, by name."""
    return _manifest({name: text.encode("utf-8") for name, text in files.items()})


def _manifest(contents: Mapping[str, bytes]) -> str:
    hashes = {name: _sha256(contents[name]) for name in sorted(contents)}
    return json.dumps({"written_by": f"gearmath {__version__}", "sha256": hashes}, indent=2) + "\n"


def _names(place: Path) -> list[str]:
    """Every file below a folder, relative to it."""
    return sorted(
        path.relative_to(place).as_posix() for path in place.rglob("*") if path.is_symlink() or not path.is_dir()
    )


def _exchange(beside: Path, target: Path) -> None:
    """Put the new folder in its place; the old one comes back if that fails."""
    if not target.exists():
        os.rename(beside / "new", target)
        return
    os.rename(target, beside / "old")
    try:
        os.rename(beside / "new", target)
    except OSError:
        os.rename(beside / "old", target)
        raise


def _check_ours(folder: Path, target: Path) -> None:
    if target.is_symlink() or (target.exists() and not target.is_dir()):
        raise InputError(f"{folder}: is no folder")
    known = _listed(target)
    for name in _names(target):
        if name == MANIFEST and known:
            continue
        if name not in known:
            raise InputError(
                f"{folder}: holds {name}, which gearmath did not write, and it would be lost; move it away, or name "
                "another folder"
            )
        if _sha256(_read(folder, target / name)) != known[name]:
            raise InputError(
                f"{folder}: {name} was changed since gearmath wrote it, and would be lost; move it away, or name "
                "another folder"
            )


def _listed(target: Path) -> dict[str, str]:
    """The SHA-256 of the files of a folder, by name, by its manifest; none where there is no such."""
    try:
        return dict(json.loads((target / MANIFEST).read_text("utf-8"))["sha256"])
    except (OSError, ValueError, KeyError, TypeError):
        return {}


def _read(folder: Path, path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"{folder}: {path.name} cannot be read: {error.strerror}") from error


def _sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()

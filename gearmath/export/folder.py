"""A folder of files written in one step, with a manifest that says what is ours.

A folder is replaced only where its own manifest lists every file in it: nobody's other work is ever deleted.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

from gearmath import __version__
from gearmath.errors import InputError

MANIFEST = "manifest.json"


def write_folder(folder: Path, files: Mapping[str, str]) -> None:
    """Write ``files`` (relative name to text) and their manifest as the folder's whole content.

    The folder is built beside its place and renamed into it. Raises InputError naming the first file that is not
    listed in the manifest of an existing folder, or why the folder cannot be written.
    """
    target = Path(os.path.abspath(folder))
    if Path.cwd().is_relative_to(target):
        raise InputError(f"{folder}: is the current folder or holds it; name a folder to be made")
    _check_ours(folder, target)
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        beside = Path(tempfile.mkdtemp(dir=target.parent, prefix=f".{target.name}."))
    except OSError as error:
        raise InputError(f"{folder}: cannot be written: {error.strerror}") from error
    try:
        _fill(beside / "new", files)
        _exchange(beside, target)
    except OSError as error:
        raise InputError(f"{folder}: cannot be written: {error.strerror}") from error
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def manifest(files: Mapping[str, str]) -> str:
    """JSON text: the SHA-256 of every file, by name."""
    hashes = {name: hashlib.sha256(files[name].encode("utf-8")).hexdigest() for name in sorted(files)}
    return json.dumps({"written_by": f"gearmath {__version__}", "sha256": hashes}, indent=2) + "\n"


def _fill(place: Path, files: Mapping[str, str]) -> None:
    for name, text in {**files, MANIFEST: manifest(files)}.items():
        path = place / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8", newline="\n")


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
    present = sorted(
        path.relative_to(target).as_posix() for path in target.rglob("*") if path.is_symlink() or not path.is_dir()
    )
    if not present:
        return
    foreign = [name for name in present if name not in _listed(target)]
    if foreign:
        raise InputError(f"{folder}: holds {foreign[0]}, which no {MANIFEST} of gearmath lists; name another folder")


def _listed(target: Path) -> set[str]:
    try:
        hashes = json.loads((target / MANIFEST).read_text("utf-8"))["sha256"]
        return {MANIFEST, *hashes}
    except (OSError, ValueError, KeyError, TypeError):
        return set()

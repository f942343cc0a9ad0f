"""Files that an operator may choose from: those in the folder of the store, and those that come with the package."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import resources
from pathlib import Path
from typing import Any

from gearmath.errors import InputError
from gearmath.files import read_text
from gearmath.front.machines import load_hobber, load_machine, load_probe
from gearmath.front.sets import load_set
from gearmath.specs.toml import find, tables

#: A key, with dots between tables, that a file of each kind has, and no other; one of these.
_KEYS = {
    "gear_set": ("pinion.blank", "gear.blank"),
    "hobber": ("encoder.lines",),
    "machine": ("axes.X",),
    "calibration": ("tip_radius",),
}
_READ: dict[str, Callable[[Path], object]] = {
    "gear_set": load_set,
    "hobber": load_hobber,
    "machine": load_machine,
    "calibration": load_probe,
}
#: Larger files are none of these.
_LARGEST = 1_000_000


def files_of(kind: str, folder: Path) -> dict[str, str]:
    """What may be chosen of a ``kind``, gear_set or hobber: path or bundled name, and the name that is shown.

    A file of the folder comes first; one that is no TOML is none, and :func:`unreadable` says why.
    """
    here = {str(path): path.name for path in _toml(folder) if _is(kind, path)}
    packaged = Path(str(resources.files("gearmath") / "data"))
    return here | {path.name: f"{path.name} *" for path in _toml(packaged) if _is(kind, path)}


def unreadable(folder: Path) -> list[InputError]:
    """Why files of the folder are in no list: each that cannot be read or is no TOML, in a sentence that names it."""
    found = []
    for path in _toml(folder):
        try:
            tables(read_text(path, _LARGEST), str(path))
        except InputError as error:
            found.append(error)
    return found


def check(kind: str, name: str) -> None:
    """Read a file of a ``kind`` that was chosen. Raises InputError for what is none, or is damaged."""
    _READ[kind](find(name))


def changed_at(name: str) -> int:
    """When a file, or the bundled one of this name, was written last [ns]; 0 where it is not there."""
    try:
        return find(name).stat().st_mtime_ns
    except (InputError, OSError):
        return 0


def _toml(folder: Path) -> list[Path]:
    return sorted(path for path in folder.glob("*.toml") if path.is_file() and not path.name.startswith("."))


def _is(kind: str, path: Path) -> bool:
    try:
        values = tables(read_text(path, _LARGEST), str(path))
    except InputError:
        return False
    return any(_has(values, key.split(".")) for key in _KEYS[kind])


def _has(values: Any, key: list[str]) -> bool:
    return not key or (isinstance(values, Mapping) and key[0] in values and _has(values[key[0]], key[1:]))

"""TOML into a checked model: what is missing, unknown, not finite or out of range is refused by file, key and value."""

from __future__ import annotations

import math
import os
import re
import tomllib
from collections.abc import Callable, Mapping
from importlib import resources
from pathlib import Path
from typing import Any, Self, TypeVar

import numpy as np
from pydantic import BaseModel, ConfigDict, ValidationError

from gearmath.errors import InputError
from gearmath.files import read_text
from gearmath.specs.file_kinds import described, kind_of, of_another_kind
from gearmath.specs.refusal import sentence

#: So many characters of a line a message shows.
_SHOWN = 80


class Spec(BaseModel):
    """Base of every file model: frozen, no unknown keys, no NaN, no silent conversion of text to numbers."""

    # built on first use: a file is of one model, its module has a dozen
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False, defer_build=True)

    def rad(self, key: str) -> Any:
        """The angle of a key, or the angles (n,) of a list [rad]; files have degrees."""
        value = getattr(self, key)
        return np.radians(value) if isinstance(value, tuple) else math.radians(value)

    @classmethod
    def keys(cls) -> list[str]:
        """The keys of its table in a file."""
        return list(cls.model_fields)

    @classmethod
    def from_file(cls, values: Mapping[str, Any]) -> Self:
        """The model of the values of a file, where that may say in other words what the model has."""
        return cls.model_validate(values)


SpecT = TypeVar("SpecT", bound=Spec)


def load(path: Path, model: type[SpecT]) -> SpecT:
    """Read a TOML file into ``model``. Raises InputError with file, key, value and limit in one sentence."""
    return parse(read_text(path), model, str(path))


def parse(text: str, model: type[SpecT], name: str) -> SpecT:
    """Check TOML text against ``model``; ``name`` is the file's name in the messages."""
    return _checked(tables(text, name, described(model)), model, model.from_file, name)


def tables(text: str, name: str, wanted: str | None = None) -> dict[str, Any]:
    """What TOML text holds. Raises InputError naming the file, and the line where it is no TOML.

    Text of another kind than ``wanted``, such as a program, is called what it is.
    """
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        kind = kind_of(text)
        if kind is not None and wanted is not None:
            raise InputError(f"{name}: is no TOML: it describes {kind}; the file of {wanted} is wanted") from error
        raise InputError(f"{name}: is no TOML: {error}{_line(text, str(error))}") from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"{name}: is no TOML: a number of thousands of digits, or lists within lists") from error


def _line(text: str, refusal: str) -> str:
    """What is to be said of the line that a refusal names: its key, where that stands twice, or its decimal comma."""
    line, lines = re.search(r"at line (\d+)", refusal), text.splitlines()
    if line is None or int(line[1]) > len(lines):
        return ""
    stands = lines[int(line[1]) - 1].strip()
    if refusal.startswith("Cannot overwrite") and stands.startswith("[["):
        return f"; {stands[:_SHOWN]} is a list of tables, all of which have double brackets"
    if refusal.startswith("Cannot overwrite"):
        return f"; the key {stands.split('=')[0].strip()!r} stands a second time there: {stands[:_SHOWN]}"
    if refusal.startswith("Cannot declare"):
        return f"; the section {stands[:_SHOWN]} stands a second time there"
    number = re.search(r"=\s*([-+]?\d+,\d+)\s*(#.*)?$", stands)
    return f"; {number[1]} has a decimal comma, TOML wants a point" if number else ""


def checked(values: Mapping[str, Any], model: type[SpecT], name: str) -> SpecT:
    """Check values by key against ``model``; ``name`` is what they belong to in the messages."""
    return _checked(values, model, model.model_validate, name)


def rechecked(spec: SpecT, name: str) -> SpecT:
    """A model as it is, if it could be that of a file: a copy with other values was never checked.

    Raises InputError naming key, value and limit.
    """
    made = checked(_tables(spec, f"{name}: "), type(spec), name)
    return spec if made == spec else made


def given(spec: Spec) -> dict[str, Any]:
    """What was given for a model, its tables as they are."""
    return {key: getattr(spec, key) for key in type(spec).model_fields if key in spec.model_fields_set}


def _tables(spec: Spec, where: str) -> dict[str, Any]:
    """What was given for a model, tables within tables. Raises InputError naming a key that there is not."""
    known = type(spec).model_fields
    unknown = next((key for key in vars(spec) if key not in known and key in spec.model_fields_set), None)
    if unknown is not None:
        raise InputError(f"{where}{unknown}: no such key is known here")
    return {
        key: _tables(value, f"{where}{key}.") if isinstance(value, Spec) else value
        for key, value in given(spec).items()
    }


def _checked(
    values: Mapping[str, Any], model: type[SpecT], validate: Callable[[Mapping[str, Any]], SpecT], name: str
) -> SpecT:
    try:
        return validate(values)
    except ValidationError as error:
        raise InputError(f"{name}: {of_another_kind(values, model) or sentence(error, model)}") from error


def bundled(name: str) -> Path:
    """The path of a file that comes with the package, by its name in ``gearmath/data``."""
    path = Path(str(resources.files("gearmath") / "data" / name))
    if not os.path.isfile(path):
        known = sorted(entry.name for entry in path.parent.glob("*.toml"))
        raise InputError(f"{name}: cannot be read: there is no such file; bundled are {', '.join(known)}")
    return path


def find(name: str) -> Path:
    """A file by its path or, where a bare name is no file here, the bundled file of that name."""
    if not name:
        raise InputError("a file must be named, its name is empty")
    path = Path(name)
    # os.path says no where Path raises: of a name too long, and in a folder that this user may not enter
    return path if os.path.isfile(path) or path.name != name else bundled(name)

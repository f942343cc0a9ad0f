"""TOML into a checked model: what is missing, unknown, not finite or out of range is refused by file, key and value."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from importlib import resources
from pathlib import Path
from typing import Any, Self, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from gearmath.errors import InputError
from gearmath.files import read_text


class Spec(BaseModel):
    """Base of every file model: frozen, no unknown keys, no NaN, no silent conversion of text to numbers."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    @classmethod
    def from_file(cls, values: Mapping[str, Any]) -> Self:
        """The model of the values of a file, where that may say in other words what the model has."""
        return cls.model_validate(values)


SpecT = TypeVar("SpecT", bound=Spec)

_SENTENCES = {
    "missing": "the key is missing",
    "extra_forbidden": "no such key is known here",
    "finite_number": "must be a finite number",
}


def load(path: Path, model: type[SpecT]) -> SpecT:
    """Read a TOML file into ``model``. Raises InputError with file, key, value and limit in one sentence."""
    return parse(read_text(path), model, str(path))


def parse(text: str, model: type[SpecT], name: str) -> SpecT:
    """Check TOML text against ``model``; ``name`` is the file's name in the messages."""
    try:
        values = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{name}: is no TOML: {error}") from error
    return _checked(values, model.from_file, name)


def checked(values: Mapping[str, Any], model: type[SpecT], name: str) -> SpecT:
    """Check values by key against ``model``; ``name`` is what they belong to in the messages."""
    return _checked(values, model.model_validate, name)


def _checked(values: Mapping[str, Any], validate: Callable[[Mapping[str, Any]], SpecT], name: str) -> SpecT:
    try:
        return validate(values)
    except ValidationError as error:
        raise InputError(f"{name}: {_sentence(error)}") from error


def bundled(name: str) -> Path:
    """The path of a file that comes with the package, by its name in ``gearmath/data``."""
    path = Path(str(resources.files("gearmath") / "data" / name))
    if not path.is_file():
        known = sorted(entry.name for entry in path.parent.glob("*.toml"))
        raise InputError(f"{name}: cannot be read: there is no such file; bundled are {', '.join(known)}")
    return path


def find(name: str) -> Path:
    """A file by its path or, where a bare name is no file here, the bundled file of that name."""
    path = Path(name)
    return path if path.is_file() or path.name != name else bundled(name)


def _sentence(error: ValidationError) -> str:
    details = error.errors(include_url=False)
    first = details[0]
    key = ".".join(str(part) for part in first["loc"])
    what = _SENTENCES.get(first["type"], first["msg"].removeprefix("Value error, ").removeprefix("Input "))
    value = "" if first["type"] == "missing" or isinstance(first["input"], dict) else f" = {first['input']!r}"
    more = f" (and {len(details) - 1} more)" if len(details) > 1 else ""
    return f"{key}{value}: {what}{more}" if key else f"{what}{more}"

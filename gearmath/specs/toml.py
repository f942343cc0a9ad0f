"""TOML into a checked model: what is missing, unknown, not finite or out of range is refused by file, key and value."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Callable, Mapping
from importlib import resources
from pathlib import Path
from typing import Any, Self, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, ValidationError

from gearmath.errors import InputError
from gearmath.files import read_text


class Spec(BaseModel):
    """Base of every file model: frozen, no unknown keys, no NaN, no silent conversion of text to numbers."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    @classmethod
    def keys(cls) -> list[str]:
        """The keys of its table in a file."""
        return list(cls.model_fields)

    @classmethod
    def from_file(cls, values: Mapping[str, Any]) -> Self:
        """The model of the values of a file, where that may say in other words what the model has."""
        return cls.model_validate(values)


SpecT = TypeVar("SpecT", bound=Spec)

#: How like another a key must be to be taken for a misspelling of it, 1 for the same; "hnad" is 0.75 like "hand".
_LIKENESS = 0.7
_SENTENCES = {
    "extra_forbidden": "no such key is known here",
    "missing": "the key is missing",
    "finite_number": "must be a finite number",
}

#: So many characters of a value a message shows.
_LONGEST = 100


def load(path: Path, model: type[SpecT]) -> SpecT:
    """Read a TOML file into ``model``. Raises InputError with file, key, value and limit in one sentence."""
    return parse(read_text(path), model, str(path))


def parse(text: str, model: type[SpecT], name: str) -> SpecT:
    """Check TOML text against ``model``; ``name`` is the file's name in the messages."""
    try:
        values = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # no TOML, or numbers and nesting beyond all measure
        raise InputError(f"{name}: is no TOML: {error}") from error
    return _checked(values, model, model.from_file, name)


def checked(values: Mapping[str, Any], model: type[SpecT], name: str) -> SpecT:
    """Check values by key against ``model``; ``name`` is what they belong to in the messages."""
    return _checked(values, model, model.model_validate, name)


def _checked(
    values: Mapping[str, Any], model: type[SpecT], validate: Callable[[Mapping[str, Any]], SpecT], name: str
) -> SpecT:
    try:
        return validate(values)
    except ValidationError as error:
        raise InputError(f"{name}: {_sentence(error, model)}") from error


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


def _sentence(error: ValidationError, model: type[Spec]) -> str:
    """What is wrong first of all: a key that is not known may be why another one is missing."""
    details = error.errors(include_url=False)
    unknown = [detail for detail in details if detail["type"] == "extra_forbidden"]
    first = (unknown or details)[0]
    key, place = ".".join(_printed(str(part)) for part in first["loc"]), first["loc"][:-1]
    near = difflib.get_close_matches(str(first["loc"][-1]), _keys(model, place), 1, _LIKENESS) if unknown else []
    if near:
        # the key that is meant is missing, then, and no fault of its own
        others = [detail for detail in details if detail is not first and detail["loc"] != (*place, near[0])]
        return f"{key}: no such key; did you mean {near[0]}?" + (f" (and {len(others)} more)" if others else "")
    what = _SENTENCES.get(first["type"], first["msg"].removeprefix("Value error, ").removeprefix("Input "))
    value = "" if first["type"] == "missing" or isinstance(first["input"], dict) else f" = {_short(first['input'])}"
    more = f" (and {len(details) - 1} more)" if len(details) > 1 else ""
    return f"{key}{value}: {what}{more}" if key else f"{what}{more}"


def _printed(key: str) -> str:
    """A key as it stands, or quoted where it holds what would break the line of a message."""
    return key if key.isprintable() else repr(key)


def _short(value: object) -> str:
    """A value as it stands, cut off where it is a whole table or a long list."""
    text = repr(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def _keys(model: type[Spec], place: tuple[int | str, ...]) -> list[str]:
    """The keys of the table at a place of a model; none where it is no table of a kind."""
    at: Any = model
    for part in place:
        if isinstance(part, int):
            continue  # one table of a list of them
        at = _table(at.model_fields[part].annotation) if part in at.model_fields else None
        if at is None:
            return []
    return at.keys() if issubclass(at, Spec) else []


def _table(annotation: Any) -> type[BaseModel] | None:
    """The model in an annotation such as ``Motion``, ``Design | None`` or ``tuple[Screw, ...]``."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((found for part in get_args(annotation) if (found := _table(part))), None)

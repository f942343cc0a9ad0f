"""What a model refuses, as one sentence: the key, its value, and what it must be, in words of the package's own."""

from __future__ import annotations

import datetime
import difflib
import math
import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, get_args

from pydantic import BaseModel, ValidationError

if TYPE_CHECKING:
    from gearmath.specs.toml import Spec

#: How like another a key must be to be taken for a misspelling of it, 1 for the same; "hnad" is 0.75 like "hand".
_LIKENESS = 0.7
#: So many characters of a value a message shows.
_LONGEST = 100
#: So many missing keys it names beside one that is unknown.
_NAMED = 3

_NUMBER, _WHOLE = "must be a number", "must be a whole number, without a decimal point"
_TABLE, _LIST, _TRUTH = "must be a table of keys", "must be a list in brackets", "must be true or false"
#: What is said of each fault that pydantic knows and a TOML value can have; the names are those of its limits.
_SENTENCES = {
    "extra_forbidden": "no such key is known here",
    "missing": "the key is missing",
    "finite_number": "must be a finite number",
    "greater_than": "must be greater than {gt}",
    "greater_than_equal": "must be at least {ge}",
    "less_than": "must be less than {lt}",
    "less_than_equal": "must be at most {le}",
    "multiple_of": "must be a multiple of {multiple_of}",
    "too_short": "must have at least {min_length} values",
    "too_long": "must have at most {max_length} values",
    "string_too_short": "must have at least {min_length} characters",
    "string_too_long": "must have at most {max_length} characters",
    "literal_error": "must be {expected}",
    "enum": "must be {expected}",
    "string_type": "must be text in quotes",
    **dict.fromkeys(("float_type", "float_parsing"), _NUMBER),
    **dict.fromkeys(("int_type", "int_parsing", "int_from_float"), _WHOLE),
    "int_parsing_size": "has too many digits",
    **dict.fromkeys(("bool_type", "bool_parsing"), _TRUTH),
    **dict.fromkeys(("model_type", "model_attributes_type", "dict_type", "mapping_type"), _TABLE),
    **dict.fromkeys(("tuple_type", "list_type", "iterable_type", "set_type"), _LIST),
}
_OTHERWISE = "is no value that this key can have"


def sentence(error: ValidationError, model: type[Spec]) -> str:
    """What is wrong first of all: a key that is not known may be why another one is missing."""
    details: list[Mapping[str, Any]] = [
        {**detail, "loc": _place(model, detail["loc"])} for detail in error.errors(include_url=False)
    ]
    unknown = [detail for detail in details if detail["type"] == "extra_forbidden"]
    first = (unknown or details)[0]
    loc = first["loc"]
    near = difflib.get_close_matches(str(loc[-1]), _keys(model, loc[:-1]), 1, _LIKENESS) if unknown else []
    others = {detail["loc"]: detail for detail in details if detail["loc"] not in (loc, (*loc[:-1], *near))}
    more = f" (and {len(others)} more)" if others else ""
    # what an unknown key was meant to be, where it is not like it
    lacking = [_dotted(place) for place, detail in others.items() if detail["type"] == "missing"]
    if unknown and lacking and not near:
        more = f"; {' and '.join(lacking[:_NAMED])} {'is' if len(lacking) == 1 else 'are'} missing{more}"
    if near:  # the key that is meant is missing, then, and no fault of its own
        return f"{_dotted(loc)}: no such key; did you mean {near[0]}?{more}"
    what, key = _words([detail for detail in details if detail["loc"] == loc]), _dotted(loc)
    what += _radians(model, first)
    if first["type"] == "value_error" and loc and _names_a_key(what, _keys(model, loc)):
        return f"{key}.{what}{more}"
    if first["type"] == "missing" and loc and isinstance(loc[-1], int):
        what, key = f"value {loc[-1] + 1} of the list is missing", _dotted(loc[:-1])
    elif first["type"] == "missing" and _keys(model, loc):
        what = f"the section [{key}] is missing"
    value = "" if first["type"] == "missing" or isinstance(first["input"], dict) else f" = {_short(first['input'])}"
    return f"{key}{value}: {what}{more}" if key else f"{what}{more}"


def _radians(model: type[Spec], detail: Mapping[str, Any]) -> str:
    """What is said of an angle that is too small, and would not be if it were in radians."""
    value, limits = detail["input"], detail.get("ctx", {})
    at: type[BaseModel] = model
    least = limits.get("ge", limits.get("gt"))
    if least is None or isinstance(value, bool) or not isinstance(value, int | float) or not 0 < value <= math.pi:
        return ""
    *tables, key = detail["loc"] or ("",)
    for part in tables:
        at = (table_in(at.model_fields[part].annotation) if part in at.model_fields else None) or at
    marks = at.model_fields[key].metadata if key in at.model_fields else []
    most = [getattr(one, name) for one in marks for name in ("le", "lt") if hasattr(one, name)]
    degrees = math.degrees(value)
    if not any(getattr(one, "name", "") == "degree" for one in marks) or not least <= degrees <= min(most, default=360):
        return ""
    return f"; angles are in degrees, and {value:g} rad are {degrees:.4g}"


def _names_a_key(what: str, keys: Sequence[str]) -> bool:
    """Whether a table's own check begins with one of its keys: "index = 6: ..."."""
    first = re.match(r"(\w+) = ", what)
    return first is not None and first[1] in keys


def _words(details: Sequence[Mapping[str, Any]]) -> str:
    """What one value must be. Where it may be one thing or another, the limits of what it is, else all it may be."""
    faults = [detail for detail in details if detail["type"] not in ("literal_error", "float_type", "int_type")]
    said = dict.fromkeys(_word(detail) for detail in (faults or details))
    return " or ".join([word if k == 0 else word.removeprefix("must be ") for k, word in enumerate(said)])


def _word(detail: Mapping[str, Any]) -> str:
    if detail["type"] == "value_error":
        return str(detail["ctx"]["error"])
    if _SENTENCES.get(detail["type"]) == _LIST and isinstance(detail["input"], Mapping):
        return f"is one table: write [[{_dotted(detail['loc'])}]] in double brackets, once for each"
    if _SENTENCES.get(detail["type"]) == _TABLE and isinstance(detail["input"], list):
        return f"{_TABLE}: write [{_dotted(detail['loc'])}] in single brackets, once"
    if detail["type"] == "string_too_short" and detail["ctx"]["min_length"] == 1:
        return "must not be empty"
    limits = {name: _number(value) for name, value in detail.get("ctx", {}).items()}
    return _SENTENCES.get(detail["type"], _OTHERWISE).format_map(limits)


def _number(value: object) -> object:
    return f"{value:.12g}" if isinstance(value, float) else value


def _place(model: type[Spec], loc: tuple[int | str, ...]) -> tuple[int | str, ...]:
    """Where a value stands, without the kinds that pydantic tried: below a key that holds no table, numbers alone."""
    at: type[BaseModel] | None = model
    kept: list[int | str] = []
    for part in loc:
        if isinstance(part, int):
            kept.append(part)
        elif at is not None:
            kept.append(part)
            at = table_in(at.model_fields[part].annotation) if part in at.model_fields else None
    return tuple(kept)


def _dotted(loc: Sequence[int | str]) -> str:
    """A key with its tables; of a list, the number of the value, the first being #1."""
    return "".join(f" #{part + 1}" if isinstance(part, int) else f".{_printed(part)}" for part in loc).lstrip(". ")


def _printed(key: str) -> str:
    """A key as it stands, or quoted where it holds what would break the line of a message."""
    return key if key.isprintable() else repr(key)


def _short(value: object) -> str:
    """A value as its file has it, cut off where it is a whole table or a long list."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, datetime.date | datetime.time):
        return value.isoformat()
    text = repr(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def _keys(model: type[Spec], place: Sequence[int | str]) -> list[str]:
    """The keys of the table at a place of a model; none where it is no table of a kind."""
    at: Any = model
    for part in place:
        if isinstance(part, int):
            continue  # one table of a list of them
        at = table_in(at.model_fields[part].annotation) if part in at.model_fields else None
        if at is None:
            return []
    return at.keys() if hasattr(at, "keys") else []


def table_in(annotation: Any) -> type[BaseModel] | None:
    """The model in an annotation such as ``Motion``, ``Design | None`` or ``tuple[Screw, ...]``."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((found for part in get_args(annotation) if (found := table_in(part))), None)

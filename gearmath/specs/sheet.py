"""What a summary sheet says, as a model has it: inches, and degrees with minutes and seconds.

A model that is a ``Sheet`` marks its lengths and angles. Its file may have ``unit = "inch"`` at the top for all of its
lengths, and any angle as text such as "63 56 31.3". All of it becomes mm and decimal degrees once, before the model is
checked; a refusal gives the value as the file has it, with the limit in the same unit.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, Self, get_args

from pydantic import ValidationError
from pydantic_core import InitErrorDetails

from gearmath.specs.ratio import INCH
from gearmath.specs.toml import Spec

#: Length of each unit that a file may have. [mm]
UNITS = {"mm": 1.0, "inch": INCH}


@dataclass(frozen=True)
class Unit:
    """Marks what a number of a model is measured in: mm or degree."""

    name: str


Length = Annotated[float, Unit("mm")]
Angle = Annotated[float, Unit("degree")]

_DMS = re.compile(
    r"([+-]?)\s*(\d+(?:\.\d+)?)\s*(?:°\s*|[:\s]\s*)(?:(\d+(?:\.\d+)?)\s*(?:['′]\s*|[:\s]\s*|$)"
    r"(?:(\d+(?:\.\d+)?)\s*(?:\"|″|''|′′)?)?)?",
    re.ASCII,
)
_LONGEST = 60  # characters of an angle
_LIMITS = ("gt", "ge", "lt", "le")
_PER_MM: ContextVar[float] = ContextVar("per_mm", default=1.0)


def degrees(text: str) -> float:
    """An angle in degrees out of degrees, minutes and seconds: 63 56 31.3, 63°56'31.3", 63:56:31.3, -0 12 30, 63°.

    Raises ValueError with the limit that is broken.
    """
    match = _DMS.fullmatch(text.strip()) if len(text) <= _LONGEST else None
    if match is None:
        raise ValueError("must be a number, or degrees, minutes and seconds such as '63 56 31.3'")
    sign, *parts = match.groups()
    given = [part for part in parts if part is not None]
    for name, part in zip(("minutes", "seconds"), given[1:], strict=False):
        if float(part) >= 60:
            raise ValueError(f"{name} must be below 60")
    if any("." in part for part in given[:-1]):
        raise ValueError("only the last of degrees, minutes and seconds may have decimals")
    size = math.fsum(float(part) / 60**power for power, part in enumerate(given))
    return -size if sign == "-" else size


def angle_text(value: float, like: str) -> str:
    """An angle [degrees] as degrees, minutes and seconds in the manner of ``like``, to a millionth of a second."""
    seconds = round(abs(value) * 3600, 6)
    whole, rest = divmod(seconds, 3600)
    minutes, rest = divmod(rest, 60)
    last = f"{rest:09.6f}".rstrip("0").rstrip(".")
    last = last if "." in last else f"{rest:02.0f}"
    marks = ("°", "'", '"') if "°" in like else (":", ":", "") if ":" in like else (" ", " ", "")
    return f"{'-' if value < 0 else ''}{whole:.0f}{marks[0]}{minutes:02.0f}{marks[1]}{last}{marks[2]}"


def shown(length: float) -> float:
    """A length [mm] in the unit of the file that is being checked, for sentences."""
    return float(f"{length * _PER_MM.get():.12g}")


class Sheet(Spec):
    """Base of a model whose file may be in inches, and may have angles in degrees, minutes and seconds."""

    @classmethod
    def from_file(cls, values: Mapping[str, Any]) -> Self:
        """The model of a file's values. Raises ValidationError in the file's own terms."""
        unit = values.get("unit", "mm")
        if not isinstance(unit, str) or unit not in UNITS:
            raise refusal_of(cls, ("unit",), unit, "must be 'mm' or 'inch'")
        plain = cls.plain({key: value for key, value in values.items() if key != "unit"}, UNITS[unit], ())
        with _shown_in(UNITS[unit]):
            try:
                return cls.model_validate(plain)
            except ValidationError as error:
                raise _as_written(cls, error, values, UNITS[unit]) from error

    @classmethod
    def plain(cls, values: Mapping[str, Any], mm: float, where: tuple[str, ...]) -> dict[str, Any]:
        """The values of a table in mm and degrees; ``mm`` is the length of the file's unit. Unknown keys stay."""
        plain = dict(values)
        for key, value in values.items():
            if key not in cls.model_fields:
                continue
            inner, unit = _inner(cls, key), unit_of(cls, key)
            if inner is not None and isinstance(value, dict):
                plain[key] = inner.plain(value, mm, (*where, key))
            elif unit == "mm" and mm != 1:
                plain[key] = _each(value, lambda item: float(item) * mm if is_number(item) else item)
            elif unit == "degree":
                try:
                    plain[key] = _each(value, lambda item: degrees(item) if _is_dms(item) else item)
                except ValueError as error:
                    raise refusal_of(cls, (*where, key), value, str(error)) from error
        return plain

    @classmethod
    def refusal(cls, detail: Mapping[str, Any], tables: Sequence[Mapping[str, Any]], mm: float) -> Refused:
        """A refusal of one key in the file's terms; ``tables`` are those of the file around the key, from outside."""
        key, *index = detail["loc"]
        value, context = _at(tables[-1], (key, *index), detail["input"]), dict(detail.get("ctx", {}))
        if unit_of(cls, str(key)) == "mm" and mm != 1:
            context |= {name: float(f"{context[name] / mm:.6g}") for name in _LIMITS if name in context}
        return Refused(detail["type"], (key, *index), value, context)


@dataclass(frozen=True)
class Refused:
    """What pydantic says of a value: the type of the fault, the key with its indices, value and limits."""

    type: Any
    loc: tuple[int | str, ...]
    value: Any
    context: dict[str, Any]


@contextmanager
def _shown_in(mm: float) -> Iterator[None]:
    token = _PER_MM.set(1 / mm)
    try:
        yield
    finally:
        _PER_MM.reset(token)


def _as_written(model: type[Sheet], error: ValidationError, values: Mapping[str, Any], mm: float) -> ValidationError:
    """The same refusal with the value that stands in the file, and the limit in its unit."""
    lines: list[InitErrorDetails] = []
    for detail in error.errors(include_url=False):
        loc, within, tables = list(detail["loc"]), model, [values]
        while len(loc) > 1:
            inner, table = _inner(within, str(loc[0])), tables[-1].get(str(loc[0]))
            if inner is None or not isinstance(table, Mapping):
                break
            within, tables, loc = inner, [*tables, table], loc[1:]
        if loc:
            before = detail["loc"][: len(detail["loc"]) - len(loc)]
            said = within.refusal({**detail, "loc": loc}, tables, mm)
            lines.append(InitErrorDetails(type=said.type, loc=(*before, *said.loc), input=said.value, ctx=said.context))
        else:
            lines.append(InitErrorDetails(type=detail["type"], loc=(), input=values, ctx=detail.get("ctx", {})))
    return ValidationError.from_exception_data(model.__name__, lines)


def refusal_of(model: type[Spec], key: tuple[int | str, ...], value: Any, words: str) -> ValidationError:
    """A refusal of one value in words of ours."""
    fault = {"type": "value_error", "loc": key, "input": value, "ctx": {"error": ValueError(words)}}
    return ValidationError.from_exception_data(model.__name__, [InitErrorDetails(**fault)])  # type: ignore[typeddict-item]


@cache  # a refused set is tried with hundreds of slips, each with some hundred keys
def unit_of(model: type[Spec], key: str) -> str | None:
    """mm or degree, where a key of a model is a length or an angle, or several."""
    field = model.model_fields.get(key)
    marks = [] if field is None else [*field.metadata, *_marks(field.annotation)]
    return next((mark.name for mark in marks if isinstance(mark, Unit)), None)


def _marks(annotation: Any) -> Iterator[Any]:
    for part in get_args(annotation):
        yield part
        yield from _marks(part)


@cache
def _inner(model: type[Spec], key: str) -> type[Sheet] | None:
    """The model of a table within a table."""
    field = model.model_fields.get(key)
    candidates = () if field is None else (field.annotation, *_marks(field.annotation))
    return next((part for part in candidates if isinstance(part, type) and issubclass(part, Sheet)), None)


def _at(table: Mapping[str, Any], loc: Sequence[Any], otherwise: Any) -> Any:
    value: Any = table
    for part in loc:
        try:
            value = value[part]
        except (LookupError, TypeError):
            return otherwise
    return value


def _each(value: Any, change: Callable[[Any], Any]) -> Any:
    return [change(item) for item in value] if isinstance(value, list) else change(value)


def is_number(value: Any) -> bool:
    """Whether a value of a TOML file is a number, one that a double can hold."""
    return isinstance(value, float) or (isinstance(value, int) and not isinstance(value, bool) and abs(value) < 1e300)


def _is_dms(value: Any) -> bool:
    """Whether a text is meant as an angle, be it wrong; a number between quotes is none."""
    if not isinstance(value, str):
        return False
    try:
        float(value)
    except ValueError:
        return True
    return False

"""What kind of file it is that was given in place of another: told by the keys that it has, or by its first lines."""

from __future__ import annotations

import importlib
import re
import tomllib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from pydantic import AliasChoices, BaseModel

from gearmath.specs.refusal import table_in

if TYPE_CHECKING:
    from pydantic.fields import FieldInfo

    from gearmath.specs.toml import Spec

#: Kinds of TOML files: what each describes, and its model.
_MODELS = {
    "a gear set": ("bevel_set", "BevelSet"),
    "a milling machine": ("milling_machine", "MillingMachine"),
    "a hobbing machine or lathe": ("hobbing", "HobbingMachine"),
    "a probe": ("calibration", "Calibration"),
    "a simulated shop": ("simulated_machine", "SimulatedMachine"),
    "the uncertainties of measuring": ("measurement", "MeasuringModel"),
    "a connection to a control": ("control_connection", "ControlConnection"),
    "a blank": ("blank_data", "BlankData"),
    "a pair to be designed": ("design", "DesignData"),
}
TOUCHES = "raw touches"
#: Other kinds, by what stands at the beginning of one of their first lines.
_LINES = {
    r"member,flank,tooth,row,col": "points of flanks",
    r"run,point,(member|target)": TOUCHES,
    r"<\?xml|<model": "something in XML, as REXS is",
    r"<!DOCTYPE|<html": "a page of HTML",
    r"%|;|\(|N\d+ |G\d+ |DEF |PROC ": "an NC program",
}
_FIRST = 60


def described(model: type[Spec]) -> str | None:
    """What files of a model describe."""
    at = model.__module__.rpartition(".")[2], model.__name__
    return next((words for words, known in _MODELS.items() if known == at), None)


def of_another_kind(values: Mapping[str, Any], model: type[Spec]) -> str | None:
    """The sentence that refuses a file of another kind than that of ``model``; None where it is of no other."""
    wanted = described(model)
    if wanted is None or _has_keys_of(values, model):  # of its own kind: what is wrong is a value
        return None
    kind = another_kind(values, model)
    unknown = [f"; {key}: no such key is known there" for key in values if key not in _fields(model)]
    return kind and f"describes {kind}; the file of {wanted} is wanted{''.join(unknown[:1])}"


def another_kind(values: Mapping[str, Any], model: type[Spec] | None = None) -> str | None:
    """What a file describes that ``model`` refused, where its keys are just those of another kind; else None."""
    for words, (module, name) in _MODELS.items():
        other = getattr(importlib.import_module(f"gearmath.specs.{module}"), name)
        if other is not model and _has_keys_of(values, other):
            return words
    return None


def kind_of(text: str) -> str | None:
    """What the text of a file describes that was taken for no TOML, or for a table; None where it cannot be told."""
    try:
        values = tomllib.loads(text)
    except (ValueError, RecursionError):
        lines = [line for line in text.splitlines()[:_FIRST] if not line.startswith("#")]
        found = (what for line in lines for start, what in _LINES.items() if re.match(start, line.strip()))
        return next(found, None)
    return another_kind(values)


def told(text: str, own: str = "") -> str:
    """What to add to the refusal of a file: what it describes, where that can be told and is not its ``own`` kind."""
    kind = kind_of(text)
    return "" if kind in (None, own) else f"; it describes {kind}"


def _has_keys_of(values: Mapping[str, Any], model: type[BaseModel]) -> bool:
    """Whether all keys of a file, or of a table in it, are of a model, and those that it needs are there."""
    fields = _fields(model)
    needed = [_names(key, field) for key, field in model.model_fields.items() if field.is_required()]
    if not set(values) <= set(fields) or not all(any(name in values for name in names) for names in needed):
        return False
    tables = ((value, table_in(fields[key].annotation)) for key, value in values.items() if isinstance(value, Mapping))
    return all(inner is None or _has_keys_of(value, inner) for value, inner in tables)


def _fields(model: type[BaseModel]) -> dict[str, FieldInfo]:
    return {name: field for key, field in model.model_fields.items() for name in _names(key, field)}


def _names(key: str, field: FieldInfo) -> list[str]:
    """A key of a model, with the other names that it may have in a file."""
    alias = field.validation_alias
    return [key, *(str(one) for one in alias.choices)] if isinstance(alias, AliasChoices) else [key]

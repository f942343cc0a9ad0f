"""Settings of a flank changed, the nominal ones kept."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

from gearmath.arguments.kinds import Number
from gearmath.errors import InputError
from gearmath.specs.bevel_set import SETTINGS, BevelSet, Design, Flank, Member
from gearmath.specs.toml import Spec, checked


def check_keys(name: str, flank: str, values: Mapping[str, float]) -> None:
    """Raise InputError for a key that is no setting, and for a value that is no number."""
    for key, value in values.items():
        if key not in SETTINGS:
            raise InputError(f"{name}.{flank}.{key}: is no setting; there are {', '.join(SETTINGS)}")
        if not Number().fits(value):
            raise InputError(f"{name}.{flank}.{key} = {value!r}: must be a finite number of mm or degrees")


def changed(spec: Flank, to: Mapping[str, float]) -> dict[str, Any]:
    """The table of a flank with changed settings, the nominal ones under ``design``."""
    design = spec.design or Design(**{key: getattr(spec, key) for key in SETTINGS})
    return {**shallow(spec), **to, "design": design}


_MadeT = TypeVar("_MadeT", BevelSet, Member)


def as_checked(spec: _MadeT, name: str) -> _MadeT:
    """The model as it is, if it could be in a file: a copy with other values was never checked.

    Raises InputError naming key, value and limit.
    """
    made = checked(_tables(spec, f"{name}: "), type(spec), name)
    return spec if made.model_dump() == spec.model_dump(warnings=False) else made


def _tables(spec: Spec, where: str) -> dict[str, Any]:
    """What was given for a model, tables within tables. Raises InputError naming a key that there is not."""
    unknown = next((key for key in vars(spec) if not key.startswith("_") and key not in type(spec).model_fields), None)
    if unknown is not None:
        raise InputError(f"{where}{unknown}: no such key is known here")
    return {
        key: _tables(value, f"{where}{key}.") if isinstance(value, Spec) else value
        for key, value in shallow(spec).items()
    }


def shallow(spec: Spec) -> dict[str, Any]:
    """What was given for a model, its tables as they are."""
    return {key: getattr(spec, key) for key in type(spec).model_fields if key in spec.model_fields_set}

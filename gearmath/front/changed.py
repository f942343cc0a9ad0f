"""Settings of a flank changed, the nominal ones kept."""

from __future__ import annotations

import math
from collections.abc import Mapping
from numbers import Real
from typing import Any

from gearmath.errors import InputError
from gearmath.specs.bevel_set import SETTINGS, BevelSet, Design, Flank, Member


def check_keys(name: str, flank: str, values: Mapping[str, float]) -> None:
    """Raise InputError for a key that is no setting, and for a value that is no number."""
    for key, value in values.items():
        if key not in SETTINGS:
            raise InputError(f"{name}.{flank}.{key}: is no setting; there are {', '.join(SETTINGS)}")
        if not isinstance(value, Real) or isinstance(value, bool) or not math.isfinite(value):
            raise InputError(f"{name}.{flank}.{key} = {value!r}: must be a finite number of mm or degrees")


def changed(spec: Flank, to: Mapping[str, float]) -> dict[str, Any]:
    """The table of a flank with changed settings, the nominal ones under ``design``."""
    design = spec.design or Design(**{key: getattr(spec, key) for key in SETTINGS})
    return {**shallow(spec), **to, "design": design}


def shallow(spec: BevelSet | Member | Flank) -> dict[str, Any]:
    """What was given for a model, its tables as they are."""
    return {key: getattr(spec, key) for key in type(spec).model_fields if key in spec.model_fields_set}

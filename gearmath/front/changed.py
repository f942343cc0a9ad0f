"""Settings of a flank changed, the nominal ones kept."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from gearmath.arguments.kinds import Number
from gearmath.errors import InputError
from gearmath.specs.bevel_set import SETTINGS, Design, Flank
from gearmath.specs.toml import given


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
    return {**given(spec), **to, "design": design}

"""What the operator has chosen, in a file beside the store: it outlives the server."""

from __future__ import annotations

import json
from dataclasses import asdict, fields
from pathlib import Path

from gearmath.errors import ComputationError, InputError
from gearmath.files import read_text, write_text
from gearmath.hmi.catalog import check
from gearmath.hmi.state import Choice
from gearmath.specs.bevel_set import MEMBERS


def kept_choice(file: Path) -> tuple[Choice, list[str]]:
    """The choice that a file keeps, and why something of it holds no more: what comes with gearmath is in its place."""
    if not file.exists():
        return Choice(), []
    try:
        known = json.loads(read_text(file))
    except (InputError, ValueError) as error:
        return Choice(), [f"{file.name}: cannot be read: {error}"]
    found, lost = {}, []
    for key in (field.name for field in fields(Choice)):
        value = known.get(key) if isinstance(known, dict) else None
        try:
            if key != "member" and isinstance(value, str):
                check(key, value)
                found[key] = value
        except (InputError, ComputationError) as error:
            lost.append(f"{error}: {getattr(Choice(), key)} is chosen instead")
        if key == "member" and value in MEMBERS:
            found[key] = value
    return Choice(**found), lost


def keep_choice(file: Path, choice: Choice) -> None:
    """Write the choice. Raises InputError where that cannot be."""
    write_text(file, json.dumps(asdict(choice), indent=1) + "\n")

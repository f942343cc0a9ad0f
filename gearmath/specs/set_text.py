"""A gear set as text: whole, or the text it was read from with corrected settings in it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit

from gearmath.errors import InputError
from gearmath.files import read_text, write_text
from gearmath.specs.bevel_set import ADVANCE, BEYOND, FLANKS, MACHINE_SETTINGS, MEMBERS, SETTINGS, BevelSet, Motion
from gearmath.specs.cut import ANGULAR, CRADLE_PER_WORK, RATIO, STRAIGHT
from gearmath.specs.sheet import UNITS, angle_text, unit_of
from gearmath.specs.toml import checked, parse
from gearmath.version import __version__


def save_corrected(
    source: Path,
    target: Path,
    member: str,
    settings: dict[str, np.ndarray],
    index_correction: np.ndarray | None = None,
    motions: dict[str, np.ndarray] | None = None,
    curvatures: dict[str, float] | None = None,
    check: Callable[[BevelSet], object] = lambda _: None,
    origin: str = "",
) -> None:
    """Write the set of ``source``, comments kept, with new settings (12,) of each flank, to ``target``.

    A setting that stays is left as it is written. The nominal settings are kept under ``design``.
    ``index_correction`` (z,) in rad replaces that of the member, and ``motions`` (10,7) of each flank, without the
    modified roll, its motion, and ``curvatures`` [1/mm] those of its blade. The text is checked as a set, and by
    ``check`` besides, before anything is written. ``origin`` says what it was corrected from: with the time it becomes
    the first line of the file, above those of earlier corrections. Raises InputError naming the target.
    """
    content = read_text(source)
    before, document = parse(content, BevelSet, str(source)).member(member), tomlkit.parse(content)
    table: Any = document[member]
    mm, beyond = UNITS[document.get("unit", "mm")], table["blank"].get(BEYOND, 0.0)
    for flank, vector in settings.items():
        written = _written(table[flank], vector, mm, beyond)
        if "design" not in table[flank]:
            table[flank]["design"] = {key: table[flank][key] for key in written if key in table[flank]}
        changed = vector != before.flank(flank).vector
        for (key, value), new in zip(written.items(), changed, strict=True):
            if new:
                table[flank][key] = value
    for flank, matrix in (motions or {}).items():
        _save_motion(table[flank], matrix, mm)
    for flank, curvature in (curvatures or {}).items():
        _save_curvature(table[flank], curvature, mm)
    if index_correction is not None:
        table["index_correction"] = [round(math.degrees(value), 7) + 0.0 for value in index_correction]
    text = _head(member, origin) + tomlkit.dumps(document)
    corrected = parse(text, BevelSet, str(target))
    try:
        check(corrected)
    except InputError as error:
        raise InputError(f"{target}: {error}") from error
    write_text(target, text)


def _head(member: str, origin: str) -> str:
    if not origin:
        return ""
    now = datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC")
    what = f"Corrected settings of the {member}, from {origin}, {now}, gearmath {__version__}"
    return f"# {what}; nominal ones: under design.\n"


def _written(table: Any, vector: np.ndarray, mm: float, beyond: float) -> dict[str, float | str]:
    """Settings (12,) by key as the table of a flank has them: its unit, its angles, its ratio, its crossing point.

    Nine decimals of a millimetre, or as many digits of an inch.
    """
    written: dict[str, float | str] = {}
    for name, value in zip(SETTINGS, vector.tolist(), strict=True):
        if name in ANGULAR:
            degrees, old = math.degrees(value), table.get(name)
            written[name] = angle_text(degrees, old) if isinstance(old, str) else round(degrees, 9)
        elif name == RATIO:
            inverse = CRADLE_PER_WORK in table
            written[CRADLE_PER_WORK if inverse else RATIO] = round(1 / value, 11) if inverse else round(value, 9)
        else:
            apart = beyond if name == ADVANCE else 0.0
            written[name] = round(value / mm - apart, _decimals(mm))
    return written


def _decimals(mm: float) -> int:
    return 9 if mm == 1 else 11


def _save_motion(table: Any, matrix: np.ndarray, mm: float) -> None:
    """A motion (10,7) into the table of a flank; the nominal one goes under ``design``, the modified roll stays."""
    before = dict(table.get("motion", {}))
    if "motion" not in table["design"]:
        table["design"]["motion"] = before
    motion = {"modified_roll": before["modified_roll"]} if "modified_roll" in before else {}
    for row, name in zip(matrix, MACHINE_SETTINGS, strict=True):
        factor = 1 / mm if unit_of(Motion, name) == "mm" else 1.0
        values = np.trim_zeros(np.round(np.degrees(row) if name in ANGULAR else row * factor, _decimals(mm)), "b")
        if len(values):
            motion[name] = values.tolist()
    table["motion"] = motion


def _save_curvature(table: Any, curvature: float, mm: float) -> None:
    """The curvature [1/mm] of a blade into the table of a flank; the nominal radius goes under ``design``."""
    if "blade_spheric_radius" not in table["design"]:
        table["design"]["blade_spheric_radius"] = table.get("blade_spheric_radius", "straight")
    table.pop("blade_spheric_radius", None)
    if abs(curvature) > 1 / STRAIGHT:
        table["blade_spheric_radius"] = round(1 / curvature / mm, 6 if mm == 1 else 8)


def set_text(gear_set: BevelSet) -> str:
    """A gear set as the text of its file, without what has its default value.

    It reads back as the same set to the last digit: what was measured against its flanks belongs to the file, too.
    """
    values = gear_set.model_dump(exclude_defaults=True)
    for name in (name for name in MEMBERS if name in values):
        if gear_set.member(name).process == "face_hobbing":
            values[name]["indexing_sign"] = gear_set.member(name).indexing_sign  # it has to be stated, whatever it is
    for member in (values[name] for name in MEMBERS if name in values):
        for table in (member[flank] for flank in FLANKS):
            for settings in (table, *([table["design"]] if "design" in table else [])):
                settings[ADVANCE] = _from_crossing(settings[ADVANCE], member["blank"].get(BEYOND, 0.0))
    head = "# Lengths in mm, angles in degrees.\n"
    return head + tomlkit.dumps(_throughout(values, lambda number: number + 0.0))  # without a negative zero


def to_nine_decimals(gear_set: BevelSet, members: Sequence[str]) -> BevelSet:
    """A computed set with the numbers of these members to nine decimals: processors differ in what follows."""
    values = gear_set.model_dump(exclude_unset=True)
    values |= {name: _throughout(values[name], lambda number: round(number, 9)) for name in members if values.get(name)}
    return checked(values, BevelSet, gear_set.title)


def _throughout(value: Any, change: Callable[[float], float]) -> Any:
    """Tables and lists with every decimal number in them changed."""
    if isinstance(value, dict):
        return {key: _throughout(item, change) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_throughout(item, change) for item in value]
    return change(value) if isinstance(value, float) else value


def _from_crossing(advance: float, beyond: float) -> float:
    """X_C from the crossing point that is read as this X_p from the apex, to the last digit where one is."""
    near = advance - beyond
    beside = (near, math.nextafter(near, math.inf), math.nextafter(near, -math.inf))
    return next((one for one in beside if one + beyond == advance), near)

"""The figures of a blank with their symbols and units, as people and programs read them: mm and degrees."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Any

import tomlkit

from derivations import Quantity, notation
from gearmath.bevel.blank import BevelBlank
from gearmath.bevel.slots import Slots
from gearmath.shown import Shown, Shows

#: Where the three values of a slot, a thickness and a top land stand.
PLACES = ("toe", "mean", "heel")
_GREEK = {
    "alpha": "α",
    "beta": "β",
    "delta": "δ",
    "Delta ": "Δ",
    "theta": "θ",
    "nu": "ν",
    "rho": "ρ",
    "Sigma": "Σ",
}
#: What the notation has once for every place.
_SPIRAL = {"outer_spiral_angle": "beta_e", "inner_spiral_angle": "beta_i"}


@dataclass(frozen=True, repr=False)
class TableRow(Shown):
    """One figure of the pair (one value), or of pinion and wheel (two), each a number or three along the tooth."""

    name: str
    symbol: str
    unit: str
    values: tuple[Any, ...]

    def _shown(self) -> tuple[str, list[Shows]]:
        return self.name.replace("_", " "), [(self.symbol, self.values, self.unit)]


def rows(blank: BevelBlank, slots: Slots) -> list[TableRow]:
    """All figures, those of the pair first; angles in degrees."""
    pair = [*_own(blank), *(row for row in _own(slots) if not hasattr(blank, row.name))]
    return [*pair, *_of_members(blank.pinion, blank.wheel), *_of_members(slots.pinion, slots.wheel)]


def by_name(table: list[TableRow]) -> dict[str, dict[str, Any]]:
    """The rows as ``pair``, ``pinion`` and ``wheel``, each by name."""
    values: dict[str, dict[str, Any]] = {"pair": {}, "pinion": {}, "wheel": {}}
    for row in table:
        for owner, value in zip(("pair",) if len(row.values) == 1 else ("pinion", "wheel"), row.values, strict=True):
            values[owner][row.name] = value
    return values


def set_fragment(blank: BevelBlank) -> str:
    """Shaft angle and blanks of both members as a set has them, numbers to nine decimals."""
    members = {"pinion": blank.pinion, "gear": blank.wheel}
    values: dict[str, Any] = {"shaft_angle": round(math.degrees(blank.shaft_angle), 9)}
    for name, member in members.items():
        own = member.spec_blank().model_dump(exclude_defaults=True)
        values[name] = {"blank": {key: round(value, 9) for key, value in own.items()}}
    return "# Lengths in mm, angles in degrees.\n" + tomlkit.dumps(values)


def _own(record: BevelBlank | Slots) -> Iterator[TableRow]:
    """The figures of the pair; what its process does not have is left out."""
    for field in fields(record):
        value = getattr(record, field.name)
        if isinstance(value, int | float):
            yield _row(field.name, value)


def _of_members(pinion: Any, wheel: Any) -> Iterator[TableRow]:
    for field in fields(pinion):
        yield _row(field.name, getattr(pinion, field.name), getattr(wheel, field.name))


def _row(name: str, *values: Any) -> TableRow:
    members = len(values) == 2
    if name in _SPIRAL:
        symbol, unit = f"\\{_SPIRAL[name]}", "rad"
    else:
        quantity = _quantity(name, members)
        symbol, unit = quantity.latex, quantity.unit
        if quantity.name.startswith("pinion_") and members:
            symbol = re.sub(r"_?1(\}?)$", r"\1", symbol)  # both members have it
    shown = {"rad": "degree", "1": ""}.get(unit, unit)
    return TableRow(name, _plain(symbol), shown, tuple(_degrees(value) if unit == "rad" else value for value in values))


def _quantity(name: str, of_member: bool) -> Quantity:
    wanted = (f"pinion_{name}", name) if of_member else (name,)
    return next(getattr(notation, key) for key in wanted if hasattr(notation, key))


def _degrees(value: Any) -> Any:
    return tuple(map(math.degrees, value)) if isinstance(value, tuple) else math.degrees(value)


def _plain(latex: str) -> str:
    for name, letter in _GREEK.items():
        latex = latex.replace(f"\\{name}", letter)
    return re.sub(r"[{}]", "", latex)

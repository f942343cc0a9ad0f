"""The settings of a set as fields: unit, limits, value in the file, and a changed set judged as one physical pair."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from gearmath.bevel.pair import check_pair
from gearmath.front.member import Member
from gearmath.hmi.numbers import Limits
from gearmath.specs.bevel_set import FLANKS, SETTINGS
from gearmath.specs.cut import Settings
from gearmath.specs.set_text import save_corrected
from gearmath.specs.sheet import unit_of

#: A setting of a flank, or of both that share it.
Place = tuple[tuple[str, ...], str]
#: What was typed, by place [mm, degrees, none].
Edits = Mapping[Place, float]
#: Decimals of a field. What a field shows of a value is that value.
DECIMALS = 6
_UNITS = {"mm": "mm", "degree": "°", None: ""}


@dataclass(frozen=True)
class SettingField:
    """One field: ``value`` as the file has it [``unit``], within the ``limits`` of the model of the set."""

    flanks: tuple[str, ...]
    key: str
    unit: str
    value: float
    limits: Limits

    @property
    def place(self) -> Place:
        """By what a change of it is known."""
        return self.flanks, self.key


def setting_fields(member: Member) -> list[SettingField]:
    """A field for each setting of each flank; one for both flanks where a completing cut shares it."""
    found = []
    for key in SETTINGS:
        shared = key in member.spec.shared_settings
        limits = setting_limits(key)
        for flanks in (FLANKS,) if shared else tuple((flank,) for flank in FLANKS):
            value = getattr(member.spec.flank(flanks[0]), key)
            found.append(SettingField(flanks, key, _UNITS[unit_of(Settings, key)], value, limits))
    return found


def setting_limits(key: str) -> Limits:
    """Least and largest value of a setting [mm, degrees, none], as the model of the file has them."""
    found = {name: bound for mark in Settings.model_fields[key].metadata for name, bound in _bounds(mark)}
    low, high = (float(next(found[name] for name in names if name in found)) for names in (("gt", "ge"), ("lt", "le")))
    return Limits(low, high, above="gt" in found, below="lt" in found)


def _bounds(mark: object) -> list[tuple[str, float]]:
    """What a mark of a model's field says of its least and largest value."""
    return [(name, getattr(mark, name)) for name in ("gt", "ge", "lt", "le") if hasattr(mark, name)]


def with_edits(member: Member, edits: Edits) -> Member:
    """The member with edited settings; the settings of the file stay the nominal ones.

    Raises InputError naming key, value and limit, or why the result is no physical pair.
    """
    values: dict[str, dict[str, float]] = {flank: {} for flank in FLANKS}
    for (flanks, key), value in changes(member, edits).items():
        for flank in flanks:
            values[flank][key] = value
    return member.with_values(**values) if any(values.values()) else member


def changes(member: Member, edits: Edits) -> dict[Place, float]:
    """The edits that are other values than those of the file."""
    in_file = {field.place: field.value for field in setting_fields(member)}
    return {place: value for place, value in edits.items() if round(value - in_file[place], DECIMALS)}


def save_edited(source: Path, target: Path, member: Member, edited: Member) -> None:
    """Write the set of ``source``, its comments kept, with the settings of ``edited`` to the new file ``target``.

    Raises InputError where the place cannot be written, or where the file has changed and is no pair with them.
    """
    settings = {
        flank: edited.spec.flank(flank).vector
        for flank in FLANKS
        if edited.spec.flank(flank) != member.spec.flank(flank)
    }
    save_corrected(source, target, member.name, settings, check=check_pair, origin=f"{source.name}, as typed")

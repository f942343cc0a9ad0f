"""What may be exchanged or in another unit in a set file as a whole: hands, tables, units, counts, the method.

Each is the file without the slip, and what to say of it.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any

from gearmath.specs.bevel_set import FLANKS, MEMBERS, SETTINGS, Blank, Flank
from gearmath.specs.ratio import INCH, RADIAN
from gearmath.specs.sheet import unit_of

_OTHER_HAND = {"left": "right", "right": "left"}
#: Counts and numbers beyond these are no slips.
_MOST_TEETH, _LARGEST = 1000, 1e9
#: What a table may have been written in, and how it is said.
_UNITS = (
    ("mm", "lengths", INCH, "in inches"),
    ("mm", "lengths", 1 / INCH, "in mm"),
    ("degree", "angles", RADIAN, "in radians"),
)

Values = dict[str, Any]
Slip = tuple[str, Values]


def changed(values: Values, *changes: tuple[tuple[str, ...], object]) -> Values:
    """The values with some of them changed; tables without a change are those of the original."""
    new = dict(values)
    for place, value in changes:
        table = new
        for part in place[:-1]:
            table[part] = dict(table[part])
            table = table[part]
        table[place[-1]] = value
    return new


def tables_of(values: Values, *names: str) -> Iterator[tuple[tuple[str, str], Values]]:
    """The tables of the members of a file that have one of these names."""
    for member, name in itertools.product(MEMBERS, names):
        table = values.get(member, {}).get(name)
        if isinstance(table, dict):
            yield (member, name), table


def of_tables(values: Values) -> Iterator[Slip]:
    """Hands, units, and tables that are exchanged."""
    stated = {name: values.get(name, {}).get("hand") for name in MEMBERS}
    hands = {name: hand for name, hand in stated.items() if isinstance(hand, str) and hand in _OTHER_HAND}
    for names in (*((name,) for name in hands), tuple(hands)):
        other = {name: _OTHER_HAND[hands[name]] for name in names}
        words = " and ".join(f"{name}.hand = {hand!r}" for name, hand in other.items())
        yield words, changed(values, *(((name, "hand"), hand) for name, hand in other.items()))
    unit = "inch" if values.get("unit", "mm") == "mm" else "mm"
    yield f"unit = {unit!r}", changed(values, (("unit",), unit))
    yield from _of_units(values)
    for name in MEMBERS:
        found = dict(tables_of({name: values.get(name, {})}, *FLANKS))
        if len(found) == len(FLANKS):
            one, two = ((name, flank) for flank in FLANKS)
            exchanged = changed(values, (one, found[two]), (two, found[one]))
            yield f"{name}.concave and {name}.convex exchanged", exchanged
    if all(isinstance(values.get(name), dict) for name in MEMBERS):
        exchanged = changed(values, *(((name,), values[mate(name)]) for name in MEMBERS))
        yield "the tables pinion and gear exchanged", exchanged
    flanks = dict(tables_of(values, *FLANKS))
    if len(flanks) == len(MEMBERS) * len(FLANKS):
        exchanged = changed(values, *(((name, flank), flanks[mate(name), flank]) for name, flank in flanks))
        yield "the settings of pinion and gear exchanged", exchanged


def _of_units(values: Values) -> Iterator[Slip]:
    """All lengths or angles of blanks, of settings or of a whole member in another unit, of both members or of one."""
    of_all = tuple(name for name in MEMBERS if isinstance(values.get(name), dict))
    machine = ("the settings of the machine and the blade radius", FLANKS, SETTINGS)
    for members in (of_all, *((name,) for name in of_all if len(of_all) > 1)):
        where = "" if members == of_all else f" of the {members[0]}"
        blank = ("the blank" if where else "the blanks", ("blank",), None)
        whole = (("all tables", ("blank", *FLANKS), None),) if where else ()  # of both: that is the key unit
        parts = (("the settings", FLANKS, None), machine, blank, *whole)
        for (unit, what, factor, how), (words, names, keys) in itertools.product(_UNITS, parts):
            places = [
                ((*place, key), value * factor)
                for place, table in tables_of({name: values[name] for name in members}, *names)
                for key, value in table.items()
                if unit_in(place[1], key) == unit and is_number(value) and (keys is None or key in keys)
            ]
            if places:
                yield f"the {what} of {words}{where} times {factor:.6g}: they are {how}", changed(values, *places)


def of_counts(values: Values) -> Iterator[Slip]:
    """Tooth counts, the shaft angle, and how a member is cut."""
    for name in MEMBERS:
        teeth = values.get(name, {}).get("teeth")
        if isinstance(teeth, int) and 0 < teeth < _MOST_TEETH and all(each in values for each in MEMBERS):
            for other in dict.fromkeys((teeth + 1, teeth - 1, int(str(teeth)[::-1]))):
                yield f"{name}.teeth = {other}, not {teeth}", changed(values, ((name, "teeth"), other))
    if is_number(values.get("shaft_angle")) and values["shaft_angle"] != 90:
        yield f"shaft_angle = 90, not {values['shaft_angle']}", changed(values, (("shaft_angle",), 90.0))
    for name in (name for name in MEMBERS if name in values):
        given = values[name].get("generation", "generated")
        method = "generated" if given == "formate" else "formate"
        yield f"{name}.generation = {method!r}, not {given!r}", changed(values, ((name, "generation"), method))


def unit_in(table: str, key: str) -> str | None:
    return unit_of(Blank if table == "blank" else Flank, key)


def mate(name: str) -> str:
    return MEMBERS[1 - MEMBERS.index(name)]


def is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < _LARGEST

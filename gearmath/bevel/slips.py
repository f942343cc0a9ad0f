"""Which usual slip makes a refused set file a pair again: of one value, of two exchanged ones, or of a whole table.

A slip is named only where the file without it passes the whole check.
"""

from __future__ import annotations

import copy
import itertools
import math
import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from gearmath.specs.bevel_set import FLANKS, MEMBERS, SETTINGS, Blank, Flank
from gearmath.specs.cut import ANGULAR, RATIO
from gearmath.specs.ratio import INCH
from gearmath.specs.sheet import unit_of

#: What a length, an angle or a ratio may have been written as, the most usual first.
_OF_ALL: tuple[float, ...] = (-1.0, 0.1, 10.0)
_OF_LENGTHS, _OF_ANGLES = (INCH, 1 / INCH), (180 / math.pi, math.pi / 180)
#: What a backlash hangs on as much as on other settings: a smaller one would always do.
_PHASE = "work_rotation_offset"
#: Refusals of no value: nothing in it was a slip of one.
_NO_VALUE = ("no such key", "the key is missing", "is no TOML", "cannot be read")
_OTHER_HAND = {"left": "right", "right": "left"}
#: So many files are tried, and so many that pass are named.
_TRIALS, _SAID = 250, 2
#: Counts and numbers beyond these are no slips.
_MOST_TEETH, _LARGEST = 1000, 1e9

Values = dict[str, Any]
Slip = tuple[str, Values]


def likely_slip(values: Mapping[str, Any], refusal: str, passes: Callable[[Values], bool]) -> str:
    """What to say of the values of a set file that was refused; empty where no slip that is tried makes it pass.

    ``refusal`` is the sentence; of settings, only those of the members and flanks that it names are tried.
    """
    given = dict(values)
    if any(words in refusal for words in _NO_VALUE) or any(
        not isinstance(given.get(name, {}), dict) for name in MEMBERS
    ):
        return ""
    for tried in (_of_tables(given), _of_counts(given), _of_settings(given, refusal)):
        good = list(itertools.islice((words for words, one in itertools.islice(tried, _TRIALS) if passes(one)), _SAID))
        if good:
            return f"; it would be a pair with {', or with '.join(good)}"
    return ""


def _changed(values: Values, *changes: tuple[tuple[str, ...], object]) -> Values:
    new = copy.deepcopy(values)
    for place, value in changes:
        table = new
        for part in place[:-1]:
            table = table[part]
        table[place[-1]] = value
    return new


def _tables(values: Values, *names: str) -> Iterator[tuple[tuple[str, str], Values]]:
    """The tables of the members of a file that have one of these names."""
    for member, name in itertools.product(MEMBERS, names):
        table = values.get(member, {}).get(name)
        if isinstance(table, dict):
            yield (member, name), table


def _of_tables(values: Values) -> Iterator[Slip]:
    """Hands, units, and tables that are exchanged."""
    stated = {name: values.get(name, {}).get("hand") for name in MEMBERS}
    hands = {name: hand for name, hand in stated.items() if isinstance(hand, str) and hand in _OTHER_HAND}
    for names in (*((name,) for name in hands), tuple(hands)):
        other = {name: _OTHER_HAND[hands[name]] for name in names}
        words = " and ".join(f"{name}.hand = {hand!r}" for name, hand in other.items())
        yield words, _changed(values, *(((name, "hand"), hand) for name, hand in other.items()))
    unit = "inch" if values.get("unit", "mm") == "mm" else "mm"
    yield f"unit = {unit!r}", _changed(values, (("unit",), unit))
    for words, names, keys in (
        ("the settings", FLANKS, None),
        ("the settings of the machine and the blade radius", FLANKS, SETTINGS),
        ("the blanks", ("blank",), None),
    ):
        for factor, how in ((INCH, "in inches"), (1 / INCH, "in mm")):
            places = [
                ((*place, key), value * factor)
                for place, table in _tables(values, *names)
                for key, value in table.items()
                if _unit(place[1], key) == "mm" and _is_number(value) and (keys is None or key in keys)
            ]
            yield f"the lengths of {words} times {factor:.6g}: they are {how}", _changed(values, *places)
    for name in MEMBERS:
        tables = dict(_tables({name: values.get(name, {})}, *FLANKS))
        if len(tables) == len(FLANKS):
            one, two = ((name, flank) for flank in FLANKS)
            exchanged = _changed(values, (one, tables[two]), (two, tables[one]))
            yield f"{name}.concave and {name}.convex exchanged", exchanged
    flanks = dict(_tables(values, *FLANKS))
    if len(flanks) == len(MEMBERS) * len(FLANKS):
        exchanged = _changed(values, *(((name, flank), flanks[_mate(name), flank]) for name, flank in flanks))
        yield "the settings of pinion and gear exchanged", exchanged


def _of_counts(values: Values) -> Iterator[Slip]:
    """Tooth counts, the shaft angle, and how a member is cut."""
    for name in MEMBERS:
        teeth = values.get(name, {}).get("teeth")
        if (
            isinstance(teeth, int)
            and 0 < teeth < _MOST_TEETH
            and len([each for each in MEMBERS if each in values]) == len(MEMBERS)
        ):
            for other in (teeth + 1, teeth - 1):
                yield f"{name}.teeth = {other}, not {teeth}", _changed(values, ((name, "teeth"), other))
    if _is_number(values.get("shaft_angle")) and values["shaft_angle"] != 90:
        yield f"shaft_angle = 90, not {values['shaft_angle']}", _changed(values, (("shaft_angle",), 90.0))
    for name in (name for name in MEMBERS if name in values):
        given = values[name].get("generation", "generated")
        method = "generated" if given == "formate" else "formate"
        yield f"{name}.generation = {method!r}, not {given!r}", _changed(values, ((name, "generation"), method))


def _of_settings(values: Values, refusal: str) -> Iterator[Slip]:
    """One setting, a setting of both flanks exchanged, or two of one table."""
    members = set(re.findall(r"\b(pinion|gear)\b", refusal)) or set(MEMBERS)
    named = set(re.findall(r"\b(concave|convex)\b", refusal)) or set(FLANKS)
    tables = {place: table for place, table in _tables(values, *FLANKS) if place[0] in members}
    for (member, flank), table in tables.items():
        if flank not in named:
            continue
        beside = tables.get((member, FLANKS[1 - FLANKS.index(flank)]), {})
        for key in (key for key in SETTINGS if _is_number(table.get(key))):
            old = table[key]
            others = [beside[key]] if _is_number(beside.get(key)) else []
            others += [1 / old] if key == RATIO and old else []
            others += [old * factor for factor in ((-1.0,) if key == _PHASE else (*_OF_ALL, *_factors(key)))]
            for other in dict.fromkeys(value for value in others if value != old):
                words = f"{member}.{flank}.{key} = {other:.6g}, not {old:.6g}"
                yield words, _changed(values, ((member, flank, key), other))
    for member in (name for name in MEMBERS if len([place for place in tables if place[0] == name]) == len(FLANKS)):
        one, two = (tables[member, flank] for flank in FLANKS)
        for key in (key for key in SETTINGS if _is_number(one.get(key)) and _is_number(two.get(key))):
            if one[key] != two[key]:
                changes = [((member, FLANKS[0], key), two[key]), ((member, FLANKS[1], key), one[key])]
                yield f"{key} of {member}.concave and {member}.convex exchanged", _changed(values, *changes)
            if one[key] == two[key] != 0:
                for factor in (-1.0, *_factors(key)):
                    changes = [((member, flank, key), factor * one[key]) for flank in FLANKS]
                    other = f"{factor * one[key]:.6g}, not {one[key]:.6g}"
                    yield f"{member}.concave.{key} and {member}.convex.{key} = {other}", _changed(values, *changes)
    for (member, flank), table in tables.items():
        for one_key, other_key in itertools.combinations([key for key in SETTINGS if _is_number(table.get(key))], 2):
            if flank in named and 0 != table[one_key] != table[other_key] != 0:
                of, to = ((member, flank, key) for key in (one_key, other_key))
                exchanged = _changed(values, (of, table[other_key]), (to, table[one_key]))
                yield f"{member}.{flank}.{one_key} and {other_key} exchanged", exchanged


def _factors(key: str) -> tuple[float, ...]:
    return _OF_ANGLES if key in ANGULAR else () if key == RATIO else _OF_LENGTHS


def _unit(table: str, key: str) -> str | None:
    return unit_of(Blank if table == "blank" else Flank, key)


def _mate(name: str) -> str:
    return MEMBERS[1 - MEMBERS.index(name)]


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < _LARGEST

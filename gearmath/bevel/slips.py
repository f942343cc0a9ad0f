"""Which usual slip makes a refused set file a pair again: of one value, of two exchanged ones, of a table, of a digit.

A slip is named only where the file without it passes the whole check.
"""

from __future__ import annotations

import copy
import itertools
import math
import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from gearmath.bevel.misprints import exchanged_digits, wrong_digits
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
#: So many files are tried of each kind, of wrong digits so many, and so many that pass are named.
_TRIALS, _DIGITS, _SAID = 250, 250, 2
#: A slip makes a pair that uses no more than this part of what mates may differ by; of digits that would all do, those
#: are named that still pass where ever less of it is left, by halves, down to the least.
_WELL, _LEAST = 0.7, 0.05
#: Counts and numbers beyond these are no slips.
_MOST_TEETH, _LARGEST = 1000, 1e9
#: A slip changes a length or an angle by more than this, mm or degrees: less is a correction, by which a set that is
#: just beyond a limit may pass. Of two values that must be one, any difference is a slip.
_NO_CORRECTION = 0.5
_MUST_BE_ONE = "for both flanks, not two"

Values = dict[str, Any]
Slip = tuple[str, Values]


def likely_slip(values: Mapping[str, Any], refusal: str, passes: Callable[[Values, float], bool]) -> str:
    """What to say of the values of a set file that was refused; empty where no slip that is tried makes it pass.

    ``refusal`` is the sentence; of settings, only those of the members and flanks that it names are tried. ``passes``
    says whether values are a pair that uses no more than a part of what mates may differ by.
    """
    given = dict(values)
    if any(words in refusal for words in _NO_VALUE) or any(
        not isinstance(given.get(name, {}), dict) for name in MEMBERS
    ):
        return ""
    for tried in (_of_tables(given), _of_counts(given), _of_blanks(given, refusal), _of_settings(given, refusal)):
        good: list[str] = []
        for words, one in itertools.islice(tried, _TRIALS):
            if len(good) < _SAID and words not in good and passes(one, _WELL):
                good.append(words)
        if good:
            return f"; it would be a pair with {', or with '.join(good)}"
    for change in (exchanged_digits, wrong_digits):
        digits = list(itertools.islice(_of_digits(given, refusal, change), _DIGITS))
        if good := [words for words, _ in _best(digits, passes)]:
            return f"; it would be a pair with {', or with '.join(good)}"
    return ""


def _best(slips: list[Slip], passes: Callable[[Values, float], bool]) -> list[Slip]:
    """Those that leave the least of what mates may differ by; none where more are alike than can be said."""
    share = _WELL
    left = [one for one in slips if passes(one[1], share)]
    while len(left) > 1 and share > _LEAST:
        share /= 2
        better = [one for one in left if passes(one[1], share)]
        if not better:
            break
        left = better
    return left if len(left) <= _SAID else []


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
    if all(isinstance(values.get(name), dict) for name in MEMBERS):
        exchanged = _changed(values, *(((name,), values[_mate(name)]) for name in MEMBERS))
        yield "the tables pinion and gear exchanged", exchanged
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
            for other in dict.fromkeys((teeth + 1, teeth - 1, int(str(teeth)[::-1]))):
                yield f"{name}.teeth = {other}, not {teeth}", _changed(values, ((name, "teeth"), other))
    if _is_number(values.get("shaft_angle")) and values["shaft_angle"] != 90:
        yield f"shaft_angle = 90, not {values['shaft_angle']}", _changed(values, (("shaft_angle",), 90.0))
    for name in (name for name in MEMBERS if name in values):
        given = values[name].get("generation", "generated")
        method = "generated" if given == "formate" else "formate"
        yield f"{name}.generation = {method!r}, not {given!r}", _changed(values, ((name, "generation"), method))


def _of_blanks(values: Values, refusal: str) -> Iterator[Slip]:
    """One value of a blank, alone or of both: the mate's, or in another unit; two exchanged."""
    tables = dict(_tables(values, "blank"))
    for place, key in _blank_keys(values, refusal):
        old, mates = tables[place][key], tables.get((_mate(place[0]), "blank"), {}).get(key)
        others = [old * factor for factor in (*_OF_ALL, *(_OF_LENGTHS if _unit("blank", key) == "mm" else _OF_ANGLES))]
        for other in dict.fromkeys((mates, *others) if _is_number(mates) and mates != old else others):
            yield f"{place[0]}.blank.{key} = {other:.6g}, not {old:.6g}", _changed(values, ((*place, key), other))
            if mates == old:
                both = _changed(values, *(((*each, key), other) for each in tables))
                yield f"{key} of both blanks = {other:.6g}, not {old:.6g}", both
    for place, table in tables.items():
        for one, two in itertools.combinations([key for key, value in table.items() if _is_number(value)], 2):
            exchanged = _changed(values, ((*place, one), table[two]), ((*place, two), table[one]))
            yield f"{place[0]}.blank.{one} and {two} exchanged", exchanged


def _blank_keys(values: Values, refusal: str) -> list[tuple[tuple[str, str], str]]:
    """The values of the blanks that are not zero, first those whose member and key a refusal names."""
    found = [(place, key) for place, table in _tables(values, "blank") for key in table if _is_number(table[key])]
    some = [(place, key) for place, key in found if values[place[0]]["blank"][key]]
    return sorted(some, key=lambda one: (one[1] not in refusal, one[0][0] not in refusal))


def _of_digits(values: Values, refusal: str, change: Callable[[float], Iterator[float]]) -> Iterator[Slip]:
    """Digits of one value of a blank that is named; else of a setting of a flank, of both where one cut gives both."""
    tables = dict(_tables(values, "blank"))
    named = [(place, key) for place, key in _blank_keys(values, refusal) if key in refusal]
    for place, key in named:
        old = tables[place][key]
        for other in change(old):
            yield f"{place[0]}.blank.{key} = {other:.9g}, not {old:.9g}", _changed(values, ((*place, key), other))
    if ".blank." in refusal.partition(":")[0]:
        return
    for key, ((member, flank), table) in itertools.product(SETTINGS, _named(values, refusal)):
        if not _is_number(table.get(key)) or not table[key]:
            continue
        completing = values[member].get("cutting") == "completing"
        shared = completing and all(values[member].get(each, {}).get(key) == table[key] for each in FLANKS)
        if shared and flank == FLANKS[1]:
            continue
        places = [(member, each, key) for each in (FLANKS if shared else (flank,))]
        names = " and ".join(".".join(place) for place in places)
        for other in change(table[key]):
            words = f"{names} = {other:.9g}, not {table[key]:.9g}"
            yield words, _changed(values, *((place, other) for place in places))


def _named(values: Values, refusal: str) -> list[tuple[tuple[str, str], Values]]:
    """The flanks with their tables that a refusal names, all where it names none."""
    members = set(re.findall(r"\b(pinion|gear)\b", refusal)) or set(MEMBERS)
    flanks = set(re.findall(r"\b(concave|convex)\b", refusal)) or set(FLANKS)
    tables = _tables(values, *FLANKS)
    return [(place, table) for place, table in tables if place[0] in members and place[1] in flanks]


def _of_settings(values: Values, refusal: str) -> Iterator[Slip]:
    """One setting, a setting of both flanks exchanged, or two of one table."""
    members, named = ({place[k] for place, _ in _named(values, refusal)} for k in (0, 1))
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
            least = 0.0 if key == RATIO or _MUST_BE_ONE in refusal else _NO_CORRECTION
            for other in dict.fromkeys(value for value in others if abs(value - old) > least):
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

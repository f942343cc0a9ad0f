"""Which usual slip makes a refused set file a pair again: of one value, of two exchanged ones, of a table, of a digit.

A slip is named only where the file without it passes the whole check.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from gearmath.bevel.misprints import exchanged_digits, minutes_as_decimals, wrong_digits
from gearmath.bevel.slip_tables import Slip, Values, changed, is_number, mate, of_counts, of_tables, tables_of, unit_in
from gearmath.specs.bevel_set import FLANKS, MEMBERS, SETTINGS
from gearmath.specs.cut import ANGULAR, RATIO
from gearmath.specs.ratio import DEGREE, INCH, RADIAN

#: What a length, an angle or a ratio may have been written as, the most usual first.
_OF_ALL: tuple[float, ...] = (-1.0, 0.1, 10.0)
_OF_LENGTHS, _OF_ANGLES = (INCH, 1 / INCH), (RADIAN, DEGREE)
#: What a backlash hangs on as much as on other settings: a smaller one would always do.
_PHASE = "work_rotation_offset"
#: A diameter may stand for this one; that of the other hand is 180 degrees less it.
_RADIUS, _SWIVEL = "blade_point_radius", "cutter_swivel"
#: Refusals of no value, and one that says what to do: nothing is looked for beside them.
_NO_VALUE = ("no such key", "the key is missing", "is no TOML", "cannot be read", "flank must be turned by")
#: So many files are tried of each kind, of wrong digits so many, and so many that pass are named.
_TRIALS, _DIGITS, _SAID = 250, 250, 2
#: A slip makes a pair that uses no more than this part of what mates may differ by; of digits that would all do, those
#: are named that still pass where ever less of it is left, by halves, down to the least.
_WELL, _LEAST = 0.7, 0.05
#: A slip changes a length or an angle by more than this, mm or degrees: less is a correction, by which a set that is
#: just beyond a limit may pass. Of two values that must be one, any difference is a slip.
_NO_CORRECTION = 0.5
#: Backlash hangs on a dozen settings by hundredths of a degree or millimetre: there, a slip that changes less than this
#: is as likely as any of these. So is an angle of two decimals that happens to be one of minutes, too.
_OF_BACKLASH, _NONE_OF_BACKLASH, _WITHOUT_SECONDS = "transverse backlash of", 1.0, 2
_MUST_BE_ONE = "for both flanks, not two"


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
    for tried in (of_tables(given), of_counts(given), _of_blanks(given, refusal), _of_settings(given, refusal)):
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


def _of_blanks(values: Values, refusal: str) -> Iterator[Slip]:
    """One value of a blank, alone or of both: the mate's, or in another unit; two exchanged."""
    tables = dict(tables_of(values, "blank"))
    for place, key in _blank_keys(values, refusal):
        old, mates = tables[place][key], tables.get((mate(place[0]), "blank"), {}).get(key)
        others = [
            old * factor for factor in (*_OF_ALL, *(_OF_LENGTHS if unit_in("blank", key) == "mm" else _OF_ANGLES))
        ]
        for other in dict.fromkeys((mates, *others) if is_number(mates) and mates != old else others):
            yield f"{place[0]}.blank.{key} = {other:.6g}, not {old:.6g}", changed(values, ((*place, key), other))
            if mates == old:
                both = changed(values, *(((*each, key), other) for each in tables))
                yield f"{key} of both blanks = {other:.6g}, not {old:.6g}", both
    yield from _of_outer_cones(values, tables)
    for place, table in tables.items():
        for one, two in itertools.combinations([key for key, value in table.items() if is_number(value)], 2):
            exchanged = changed(values, ((*place, one), table[two]), ((*place, two), table[one]))
            yield f"{place[0]}.blank.{one} and {two} exchanged", exchanged


def _of_outer_cones(values: Values, tables: dict[tuple[str, str], Values]) -> Iterator[Slip]:
    """The outer cone distance given for the mean one."""
    mean = {
        place: table["mean_cone_distance"] - table["face_width"] / 2
        for place, table in tables.items()
        if is_number(table.get("mean_cone_distance")) and is_number(table.get("face_width"))
    }
    for places in dict.fromkeys((tuple(mean), *((place,) for place in mean))):
        if places:
            words = " and ".join(f"{place[0]}.blank.mean_cone_distance = {mean[place]:.6g}" for place in places)
            yield (
                f"{words}: what is given is the outer one",
                changed(values, *(((*place, "mean_cone_distance"), mean[place]) for place in places)),
            )


def _blank_keys(values: Values, refusal: str) -> list[tuple[tuple[str, str], str]]:
    """The values of the blanks that are not zero, first those whose member and key a refusal names."""
    found = [(place, key) for place, table in tables_of(values, "blank") for key in table if is_number(table[key])]
    some = [(place, key) for place, key in found if values[place[0]]["blank"][key]]
    return sorted(some, key=lambda one: (one[1] not in refusal, one[0][0] not in refusal))


def _of_digits(values: Values, refusal: str, change: Callable[[float], Iterator[float]]) -> Iterator[Slip]:
    """Digits of one value of a blank that is named; else of a setting of a flank, of both where one cut gives both."""
    tables = dict(tables_of(values, "blank"))
    named = [(place, key) for place, key in _blank_keys(values, refusal) if key in refusal]
    for place, key in named:
        old = tables[place][key]
        for other in change(old):
            yield f"{place[0]}.blank.{key} = {other:.9g}, not {old:.9g}", changed(values, ((*place, key), other))
    if ".blank." in refusal.partition(":")[0]:
        return
    for key, ((member, flank), table) in itertools.product(SETTINGS, _named(values, refusal)):
        if not is_number(table.get(key)) or not table[key]:
            continue
        if key == _PHASE and change is wrong_digits and _OF_BACKLASH in refusal:
            continue
        completing = values[member].get("cutting") == "completing"
        shared = completing and all(values[member].get(each, {}).get(key) == table[key] for each in FLANKS)
        if shared and flank == FLANKS[1]:
            continue
        places = [(member, each, key) for each in (FLANKS if shared else (flank,))]
        names = " and ".join(".".join(place) for place in places)
        for other in change(table[key]):
            if _OF_BACKLASH in refusal and abs(other - table[key]) <= _least(key, refusal):
                continue
            words = f"{names} = {other:.9g}, not {table[key]:.9g}"
            yield words, changed(values, *((place, other) for place in places))


def _named(values: Values, refusal: str) -> list[tuple[tuple[str, str], Values]]:
    """The flanks with their tables that a refusal names, all where it names none."""
    members = set(re.findall(r"\b(pinion|gear)\b", refusal)) or set(MEMBERS)
    flanks = set(re.findall(r"\b(concave|convex)\b", refusal)) or set(FLANKS)
    tables = tables_of(values, *FLANKS)
    return [(place, table) for place, table in tables if place[0] in members and place[1] in flanks]


def _of_settings(values: Values, refusal: str) -> Iterator[Slip]:
    """One setting, a setting of both flanks exchanged, or two of one table."""
    members, named = ({place[k] for place, _ in _named(values, refusal)} for k in (0, 1))
    tables = {place: table for place, table in tables_of(values, *FLANKS) if place[0] in members}
    for (member, flank), table in tables.items():
        if flank not in named:
            continue
        beside = tables.get((member, FLANKS[1 - FLANKS.index(flank)]), {})
        for key in (key for key in SETTINGS if is_number(table.get(key))):
            old = table[key]
            others = [beside[key]] if is_number(beside.get(key)) else []
            others += [old * factor for factor in _OF_ALL if key != _PHASE or factor < 0]
            others += _misread(key, old)
            least = 0.0 if key == RATIO or _MUST_BE_ONE in refusal else _least(key, refusal)
            others = [value for value in others if abs(value - old) > least]
            minutes = _of_minutes(key, old)
            if _OF_BACKLASH in refusal and round(old, _WITHOUT_SECONDS) == old:
                minutes = []
            for other in dict.fromkeys([*others, *minutes]):
                words = f"{member}.{flank}.{key} = {other:.6g}, not {old:.6g}"
                yield words, changed(values, ((member, flank, key), other))
    for member in (name for name in MEMBERS if len([place for place in tables if place[0] == name]) == len(FLANKS)):
        one, two = (tables[member, flank] for flank in FLANKS)
        for key in (key for key in SETTINGS if is_number(one.get(key)) and is_number(two.get(key))):
            if one[key] != two[key]:
                changes = [((member, FLANKS[0], key), two[key]), ((member, FLANKS[1], key), one[key])]
                yield f"{key} of {member}.concave and {member}.convex exchanged", changed(values, *changes)
            if one[key] and two[key] and key != _PHASE:
                yield from _of_both(values, member, key, one[key], two[key])
    for (member, flank), table in tables.items():
        for one_key, other_key in itertools.combinations([key for key in SETTINGS if is_number(table.get(key))], 2):
            if flank in named and 0 != table[one_key] != table[other_key] != 0:
                of, to = ((member, flank, key) for key in (one_key, other_key))
                exchanged = changed(values, (of, table[other_key]), (to, table[one_key]))
                yield f"{member}.{flank}.{one_key} and {other_key} exchanged", exchanged


def _least(key: str, refusal: str) -> float:
    """What a slip changes a setting by at least, mm or degrees."""
    return _NONE_OF_BACKLASH if _OF_BACKLASH in refusal and key != RATIO else _NO_CORRECTION


def _of_both(values: Values, member: str, key: str, *given: float) -> Iterator[Slip]:
    """A setting of both flanks, given with the same slip."""
    for others in zip(*([-old, *_misread(key, old), *_of_minutes(key, old)] for old in given), strict=False):
        changes = [((member, flank, key), other) for flank, other in zip(FLANKS, others, strict=True)]
        places = [f"{member}.{flank}.{key}" for flank in FLANKS]
        if given[0] == given[1]:
            words = f"{' and '.join(places)} = {others[0]:.6g}, not {given[0]:.6g}"
        else:
            parts = zip(places, others, given, strict=True)
            words = " and ".join(f"{place} = {other:.6g}, not {old:.6g}" for place, other, old in parts)
        yield words, changed(values, *changes)


def _misread(key: str, old: float) -> list[float]:
    """What a setting may have been given as: another unit, a reciprocal, a diameter, that of the other hand."""
    if key == RATIO:
        return [1 / old] if old else []
    if key not in ANGULAR:
        return [old * factor for factor in (*_OF_LENGTHS, *((0.5,) if key == _RADIUS else ()))]
    found = [old * factor for factor in (_OF_ANGLES if key != _PHASE else _OF_ANGLES[:1])]
    found += [180 - old] if key == _SWIVEL else []
    return found


def _of_minutes(key: str, old: float) -> list[float]:
    return minutes_as_decimals(old) if key in ANGULAR else []

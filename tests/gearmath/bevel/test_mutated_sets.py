"""Bundled sets with one thing made wrong: each is refused as bad input, or it is a pair all the same.

Wrong are: a sign, inches, a zero, a place of the decimal point, radians in place of degrees, two keys of a table
exchanged, two flanks, two members, tooth counts, hand, method. Whether what passes is a pair is judged by other means
than the check: by the whole grid of points, and by cutting a space of some and measuring it.
"""

from __future__ import annotations

import copy
import hashlib
import itertools
import math
import re
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
import tomlkit

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.pair import check_pair
from gearmath.bevel.tooth import tooth_space
from gearmath.errors import InputError
from gearmath.front.sets import GearSet
from gearmath.specs.bevel_set import FLANKS, MEMBERS, BevelSet, Member
from gearmath.specs.toml import bundled, checked

SETS = (
    "nasa_tp3096_12x36",
    "spiral_7x43",
    "crown_gear_formate_14x39",
    "crown_gear_universal_14x39",
    "crown_gear_hobbed_14x39",
)
#: Mutations of the whole enumeration that are tried; which, is drawn.
TRIED = 2400
#: Tolerance of the programs that cut the accepted ones [mm]: coarse, so that more of them can be cut.
TOLERANCE = 0.005
#: That many are cut: one takes seconds.
CUT = 12
#: Every so many of the single wrong settings are refused for the rate of right blame.
BLAME_EVERY = 2

NUMBERS: dict[str, Callable[[float], float]] = {
    "sign": lambda value: -value,
    "mm for inch": lambda value: value * 25.4,
    "inch for mm": lambda value: value / 25.4,
    "zero": lambda value: 0.0,
    "ten times": lambda value: value * 10,
    "radians": math.radians,
}
COUNTS: dict[str, Callable[[int], int]] = {
    "one more": lambda value: value + 1,
    "one less": lambda value: value - 1,
    "twice": lambda value: 2 * value,
    "200": lambda value: 200,
    "sign": lambda value: -value,
    "zero": lambda value: 0,
}
OTHER = {
    "left": "right",
    "right": "left",
    "completing": "fixed_setting",
    "fixed_setting": "completing",
    "face_milling": "face_hobbing",
    "face_hobbing": "face_milling",
    "generated": "formate",
    "formate": "generated",
}

Place = tuple[str | int, ...]


def leaves(value: object, place: Place = ()) -> Iterator[tuple[Place, object]]:
    """Every value of nested tables and lists with its place."""
    inside = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in inside:
        yield from leaves(item, (*place, key))
    if not isinstance(value, dict | list):
        yield place, value


def at(table: dict, place: Place) -> object:
    for part in place:
        table = table[part]
    return table


def with_values(base: dict, *changes: tuple[Place, object]) -> dict:
    new = copy.deepcopy(base)
    for place, value in changes:
        at(new, place[:-1])[place[-1]] = copy.deepcopy(value)  # type: ignore[index]
    return new


def exchanged(base: dict, one: Place, two: Place) -> dict:
    return with_values(base, (one, at(base, two)), (two, at(base, one)))


def mutations(base: dict) -> Iterator[tuple[str, dict]]:
    """What was made wrong, and the values of the set."""
    for place, value in leaves(base):
        name = ".".join(str(part) for part in place)
        operations = NUMBERS if isinstance(value, float) else COUNTS if isinstance(value, int) else {}
        for what, operation in operations.items():
            yield f"{name}: {what}", with_values(base, (place, operation(value)))  # type: ignore[arg-type]
        if value in OTHER:
            yield f"{name}: other", with_values(base, (place, OTHER[str(value)]))
    yield from _both_flanks(base)
    yield from _opposite(base)
    yield from _motions(base)
    yield from _exchanges(base)


def _both_flanks(base: dict) -> Iterator[tuple[str, dict]]:
    """A key of both flanks at once, as a completing cut needs it; the lengths or the angles of a whole table."""
    for member, (what, operation) in itertools.product(MEMBERS, NUMBERS.items()):
        shared = [key for key, value in base[member]["concave"].items() if isinstance(value, float)]
        for key in shared:
            places = [(member, flank, key) for flank in FLANKS]
            yield f"{member}.both.{key}: {what}", with_values(base, *((p, operation(at(base, p))) for p in places))
        for table in ("blank", *FLANKS):
            angles = {
                key for key in base[member][table] if key.endswith(("angle", "tilt", "swivel", "rotation_offset"))
            }
            numbers = {key for key, value in base[member][table].items() if isinstance(value, float)} - {
                "ratio_of_roll"
            }
            for kind, keys in (("angles", numbers & angles), ("lengths", numbers - angles)):
                places = [(member, table, key) for key in sorted(keys)]
                new = with_values(base, *((p, operation(at(base, p))) for p in places))
                yield f"{member}.{table}.{kind}: {what}", new


#: Opposite changes of both flanks: mm and degrees, the ratio of roll by parts of a hundred.
OPPOSITE = (-6.0, -3.0, -1.5, 1.5, 3.0, 6.0)


def _opposite(base: dict) -> Iterator[tuple[str, dict]]:
    """Errors of the flanks of a member that cancel in the mean of both."""
    for member, step in itertools.product(MEMBERS, OPPOSITE):
        for key, value in base[member]["concave"].items():
            if isinstance(value, float) and isinstance(base[member]["convex"].get(key), float):
                size = step * (0.01 if key == "ratio_of_roll" else 1.0)
                places = [((member, flank, key), sign * size) for flank, sign in zip(FLANKS, (1, -1), strict=True)]
                new = with_values(base, *((place, at(base, place) + by) for place, by in places))  # type: ignore[operator]
                yield f"{member}.opposite.{key}: {step:+g}", new


def _motions(base: dict) -> Iterator[tuple[str, dict]]:
    """A member without its motions, with all of them turned round, and with coefficients out of all measure."""
    for member in MEMBERS:
        places = [(member, flank, "motion") for flank in FLANKS if "motion" in base[member][flank]]
        if places:
            turned = {place: {key: [-v for v in values] for key, values in at(base, place).items()} for place in places}
            yield f"{member}.motion: none", with_values(base, *((place, {}) for place in places))
            yield f"{member}.motion: turned round", with_values(base, *turned.items())
        for key in ("radial_distance", "sliding_base", "cradle_angle", "ratio_of_roll", "modified_roll"):
            wild = [((member, flank, "motion"), {key: [1000.0]}) for flank in FLANKS]
            yield f"{member}.motion.{key}: 1000", with_values(base, *wild)


def _exchanges(base: dict) -> Iterator[tuple[str, dict]]:
    for member in MEMBERS:
        for table in ("blank", *FLANKS):
            numbers = [key for key, value in base[member][table].items() if isinstance(value, float)]
            for one, two in itertools.combinations(numbers, 2):
                yield (
                    f"{member}.{table}: {one} and {two} exchanged",
                    exchanged(base, (member, table, one), (member, table, two)),
                )
        yield f"{member}: flanks exchanged", exchanged(base, (member, "concave"), (member, "convex"))
        for key in base[member]["concave"]:
            new = exchanged(base, (member, "concave", key), (member, "convex", key))
            yield f"{member}: {key} of the flanks exchanged", new
    for table in ("blank", *FLANKS):
        yield f"{table} of the members exchanged", exchanged(base, ("pinion", table), ("gear", table))
        for key in sorted(base["pinion"][table].keys() & base["gear"][table].keys()):
            new = exchanged(base, ("pinion", table, key), ("gear", table, key))
            yield f"{table}.{key} of the members exchanged", new
    yield "members exchanged", exchanged(base, ("pinion",), ("gear",))
    for key in ("teeth", "hand", "cutting"):
        yield f"{key} of the members exchanged", exchanged(base, ("pinion", key), ("gear", key))


@pytest.fixture(scope="module")
def bases() -> dict[str, dict]:
    return {name: tomllib.loads(bundled(f"{name}.toml").read_text("utf-8")) for name in SETS}


def drawn(bases: dict[str, dict]) -> list[tuple[str, str, dict]]:
    """Set, what was made wrong, and values; none that changes nothing."""
    every = [(name, *one) for name in SETS for one in mutations(bases[name]) if one[1] != bases[name]]
    chosen = np.random.default_rng(20261127).permutation(len(every))[:TRIED]
    return [every[k] for k in sorted(chosen)]


def assert_is_a_member(member: Member, what: str) -> None:
    """Space, tooth, top land and hand by the points of the grid alone, all of it found."""
    grid, pitch = blank_grid(member), 2 * math.pi / member.teeth
    concave, convex = (solve_flank(member, flank, grid) for flank in FLANKS)
    angle = [np.arctan2(flank.point[:, 1], flank.point[:, 0]).reshape(grid.shape) for flank in (concave, convex)]
    radius = np.hypot(concave.point[:, 0], concave.point[:, 1])
    around = concave.normal[:, 1] * concave.point[:, 0] - concave.normal[:, 0] * concave.point[:, 1]
    toward = np.sign((around / radius)[len(radius) // 2])
    # counted on from the concave flank, the way its normal points: never folded back by a turn
    space = np.mod(toward * (angle[1] - angle[0]), 2 * math.pi)
    assert (space > 0).all(), what
    assert (space < pitch).all(), what  # a tooth is left at every place
    middle = grid.shape[0] // 2
    hand = 1 if member.hand == "right" else -1
    assert all(hand * (np.unwrap(flank[middle])[-1] - np.unwrap(flank[middle])[0]) > 0 for flank in angle), what
    assert (tooth_space(member, 3).top_land > 0).all(), what


def by_name(case: tuple) -> str:
    """An order that does not change where a figure beside a limit comes out otherwise on another processor."""
    return hashlib.sha256(f"{case[0]} {case[1]} {case[3]}".encode()).hexdigest()


@pytest.mark.slow
def test_mutated_set_is_refused_in_one_sentence_or_is_a_pair(bases, mill, monkeypatch) -> None:
    monkeypatch.setattr("gearmath.bevel.blame.likely", lambda *_: "")  # the advice has its own tests, and takes longer
    originals = {name: checked(values, BevelSet, name) for name, values in bases.items()}
    sentences: list[str] = []
    accepted: list[tuple[str, str, BevelSet]] = []
    cases = drawn(bases)
    for name, what, values in cases:
        try:
            pair = checked(values, BevelSet, name)
            check_pair(pair)
        except InputError as error:
            sentences.append(str(error))
        else:
            accepted.append((name, what, pair))
    print(f"\n{len(cases)} mutated sets: {len(sentences)} refused, {len(accepted)} accepted")
    assert len(cases) >= 2000
    assert [sentence for sentence in sentences if "\n" in sentence or not sentence] == []
    changed = [
        (name, what, pair, member)
        for name, what, pair in accepted
        for member in MEMBERS
        if pair.member(member) != originals[name].member(member)
    ]
    for name, what, pair, member in changed:
        assert_is_a_member(pair.member(member), f"{name}: {what}")
    rolled = [case for case in changed if case[2].member(case[3]).process == "face_milling"]
    refused = []
    for name, what, pair, member in sorted(rolled, key=by_name)[:CUT]:
        try:  # a cutter that gouges the opposite flank of its own space shows only where the program is run
            GearSet(pair).member(member).program(name="CUT", spaces=(0,), tolerance=TOLERANCE)
        except InputError as error:
            refused.append(str(error))
            continue
        left = mill(pair, member, tolerance=TOLERANCE)
        assert np.abs(left.deviation).max() <= TOLERANCE, f"{name}: {what}, {member}"
    assert len(refused) <= CUT / 3, refused


ONE_SETTING = re.compile(r"(pinion|gear)\.(?:concave|convex|both)\.(\w+): ")
BLAMED = re.compile(r"(?:alone explains it is|most of it hangs on) (pinion|gear)\.(?:\w+\.)?(\w+) = ")
#: Both move the work along the cutter's axis, so that the root tells not which of them is wrong.
TWINS = {"sliding_base", "machine_center_to_crossing_point"}


@pytest.mark.slow
def test_of_single_wrong_settings_nine_of_ten_are_named(bases) -> None:
    named = total = 0
    cases = [case for case in drawn(bases) if ONE_SETTING.match(case[1])]
    for name, what, values in cases[::BLAME_EVERY]:
        try:
            check_pair(checked(values, BevelSet, name))
        except InputError as error:
            blamed = BLAMED.search(str(error))
            if blamed is None:
                continue  # the sentence itself says what is wrong
            member, key = ONE_SETTING.match(what).groups()  # type: ignore[union-attr]
            total += 1
            named += blamed[1] == member and (blamed[2] == key or {blamed[2], key} == TWINS)
    print(f"\n{total} refused with a setting to blame: the one that is wrong in {named}")
    assert total >= 50
    assert named >= 0.9 * total


BAD = {
    "schema": ("pinion.blank.face_width", -1.0),
    "cones": ("pinion.teeth", 13),
    "blank": ("gear.blank.clearance", 0.0366),
    "blade": ("gear.convex.blade_edge_radius", 9.0),
    "no contact": ("pinion.convex.ratio_of_roll", 0.32),
    "hand": ("pinion.convex.cradle_angle", 53.926),
    "root": ("pinion.concave.sliding_base", 7.530600388),
    "tooth for space": ("pinion.convex.work_rotation_offset", 0.0),
    "mates": ("gear.concave.blade_pressure_angle", 12.0),
}


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> dict[str, Path]:
    """A measured file, touches and a program of the pinion, which are good."""
    from gearmath.bevel.nominal_file import nominal_flank
    from gearmath.bevel.pair import load_pair
    from gearmath.specs.flank_csv import join, write_flank_csv
    from gearmath.specs.touch_csv import COLUMNS

    folder, pinion = tmp_path_factory.mktemp("good"), load_pair(bundled(f"{SETS[0]}.toml")).pinion
    measured, touched, program = folder / "m.csv", folder / "raw.csv", folder / "PINION.MPF"
    grid = blank_grid(pinion)
    write_flank_csv(measured, join([nominal_flank(pinion, flank, grid) for flank in FLANKS]))
    touched.write_text(f"{','.join(COLUMNS)}\n1,0,pinion,concave,0,0,0,0.0,0.0,0.0,0.0,0.0,1\n", "utf-8")
    program.write_text("G90\nM30\n", "utf-8")
    return {"measured": measured, "touched": touched, "program": program, "folder": folder}


VERBS = {
    "flank": ("flank", "SET", "--member", "pinion", "--flank", "concave", "-o", "OUT"),
    "tooth": ("tooth", "SET", "--member", "pinion", "-o", "OUT"),
    "nc cut": ("nc", "cut", "SET", "--member", "pinion", "-o", "OUT"),
    "nc probe": ("nc", "probe", "SET", "--member", "pinion", "-o", "OUT"),
    "mill": ("mill", "SET", "--member", "pinion", "--program", "program", "-o", "OUT"),
    "touches": ("touches", "touched", "--set", "SET", "-o", "OUT"),
    "evaluate": ("evaluate", "measured", "--set", "SET"),
    "compensate": ("compensate", "SET", "--member", "pinion", "--measured", "measured", "-o", "OUT"),
    "stock": ("stock", "measured", "--set", "SET", "--member", "pinion"),
    "report": ("report", "measured", "--set", "SET", "-o", "OUT"),
    "uncertainty": ("uncertainty", "measured", "--set", "SET", "--member", "pinion", "--sigma-um", "0.5"),
}


@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.parametrize("fault", BAD)
def test_every_verb_refuses_a_set_that_is_no_pair_with_status_2(bases, files, refused, tmp_path, verb, fault) -> None:
    place, value = BAD[fault]
    bad, out = tmp_path / "bad.toml", tmp_path / {"tooth": "OUT.stl", "report": "OUT.html"}.get(verb, "OUT.MPF")
    bad.write_text(tomlkit.dumps(with_values(bases[SETS[0]], (tuple(place.split(".")), value))), "utf-8")
    given = {"SET": bad, "OUT": out, **files}
    refused(r"^gearmath: .*bad\.toml: .*(pinion|gear)", *(given.get(word, word) for word in VERBS[verb]))
    assert not out.exists()

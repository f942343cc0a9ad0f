"""Which setting is to blame when flanks cut no sensible tooth, or none that fits the mate.

A value is advised only where the whole set passes with it. Of the settings that would put a flank right at its mean
point and root, those that move the cutter least are tried first. Distances are compared as lengths: an angle counts
with the arm at which it moves the cutter against the work.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import median

from gearmath.bevel.blank import evaluate
from gearmath.bevel.check_flank import CutFlank
from gearmath.bevel.repair import Repair, Wanted, repairs
from gearmath.specs.bevel_set import FLANKS, SETTINGS, SIDES, Member, Settings

#: Spiral angle where none of the flanks of the set tells it. [rad]
_SPIRAL = math.radians(35)
#: A smaller spiral angle is as likely wrong itself, and does not tell what the others should be. [rad]
_TELLING_SPIRAL = math.radians(10)
#: Arm of the blade's angle and of the roll, in mean cone distances.
_BLADE_ARM, _ROLL_ARM = 0.2, 0.3
_SIGN = "indexing_sign"
#: What is left wrong counts as equal within this step, and then the repair that moves the cutter least is the better.
_STEP = 0.5
#: So many repairs are tried on the whole set, so many of one setting; and so many that pass are said.
_TRIALS, _VALUES, _SAID = 10, 2, 2
#: A repair that leaves more than this part of what is wrong explains nothing.
_EXPLAINED = 0.6
#: Settings that leave at most so many times what the best one leaves may be to blame as well; more than so many of them
#: say nothing.
_ALIKE, _MOST_SAID = 1.5, 3
#: A second repair that passes is said too where it moves the cutter at most so many times as far.
_NO_FARTHER = 1.2

Members = dict[str, Member]
Where = tuple[str, str]


@dataclass(frozen=True)
class Suspect:
    """A setting, its value and what it should be about (mm, degrees, as in the file), and how far apart [mm]."""

    key: str
    value: float
    expected: float
    apart: float
    source: str = "crown gear"

    def __str__(self) -> str:
        return f"{self.key} = {self.value:.6g} ({self.source}: {self.expected:.4g})"


@dataclass(frozen=True)
class _Trial:
    """A repair of one flank, or of ``both``: how far it moves the cutter [mm], how much of what is wrong it leaves."""

    name: str
    flank: str
    both: bool
    repair: Repair
    moved: float
    left: float

    @property
    def place(self) -> str:
        table = self.name if self.repair.key == _SIGN else f"{self.name}.{self.flank}"
        return f"{table}.{self.repair.key}"

    @property
    def where(self) -> str:
        return " on both flanks" if self.both else ""


def likely(
    members: Members,
    where: Sequence[Where],
    cut: Mapping[str, Mapping[str, CutFlank]],
    passes: Callable[[Members], bool],
    slip: Callable[[], str],
) -> str:
    """What to say of the settings of some flanks (member, flank): which of them, changed alone, makes the set pass.

    ``cut`` are the flanks that were found, ``passes`` is the whole check. Where no single setting does, ``slip`` may
    name a slip; else the one is named that would put the mean point and the root of a flank nearest to right, and no
    value is advised.
    """
    found = {(name, flank): one for name, flanks in cut.items() for flank, one in flanks.items()}
    flanks: dict[Where, list[Repair]] = {}
    for name, flank in where:
        member, wanted = members[name], _wanted(members, found, where, name, flank)
        expected = _crown_gear(members, member, flank, abs(wanted.spiral), member.indexing_sign)
        flanks[name, flank] = repairs(member, flank, expected, wanted)
    total = sum(one[0].before for one in flanks.values() if one)
    trials = sorted(_trials(members, flanks, total), key=lambda one: (round(one.left / _STEP), not one.both, one.moved))
    good: list[_Trial] = []
    tried: dict[str, int] = {}
    for one in trials:
        if sum(tried.values()) == _TRIALS or len(good) == _SAID:
            break
        farther = bool(good) and (one.moved > _NO_FARTHER * good[0].moved or one.both != good[0].both)
        if farther or tried.get(one.place, 0) == _VALUES or one.place in [other.place for other in good]:
            continue
        tried[one.place] = tried.get(one.place, 0) + 1
        if passes(_changed(members, one)):
            good.append(one)
    if good:
        said = [f"{one.place} = {one.repair.value:.6g}: {one.repair.other:.6g} would fit{one.where}" for one in good]
        return f"; the setting that alone explains it is {', or '.join(said)}"
    if slipped := slip():
        return slipped
    if trials and total > 1 and (most := _explain_most(trials, total)):
        said = [f"{one.place} = {one.repair.value:.6g}" for one in most]
        return f"; no single setting was found that puts all of it right, most of it hangs on {', or '.join(said)}"
    found_apart = [one for name, flank in where for one in _from_crown_gear(members, found, where, name, flank)]
    farthest = max(found_apart, key=lambda one: one.apart, default=None)
    beside = "" if farthest is None else f", farthest from its crown gear's is {farthest}"
    return f"; no single setting was found that puts it right{beside}"


def _from_crown_gear(
    members: Members, found: Mapping[Where, CutFlank], where: Sequence[Where], name: str, flank: str
) -> list[Suspect]:
    """The settings of a flank, and how far each is from that of its crown gear."""
    member, wanted = members[name], _wanted(members, found, where, name, flank)
    expected = _crown_gear(members, member, flank, abs(wanted.spiral), member.indexing_sign)
    return _suspects(member, f"{name}.{flank}", member.flank(flank).nominal, expected, "crown gear")


def _explain_most(trials: Sequence[_Trial], total: float) -> list[_Trial]:
    """The settings that explain most of what is wrong, the best first; none where they are too many to help."""
    best: dict[str, _Trial] = {}
    for one in trials:
        if one.place not in best or one.left < best[one.place].left:
            best[one.place] = one
    ordered = sorted(best.values(), key=lambda one: (one.left, one.moved))
    least = ordered[0].left
    alike = [one for one in ordered if one.left <= max(least + _STEP, _ALIKE * least)]
    return alike if least <= _EXPLAINED * total and len(alike) <= _MOST_SAID else []


def _trials(members: Members, flanks: Mapping[Where, list[Repair]], total: float) -> Iterator[_Trial]:
    """Repairs of single flanks; of both, where they have a setting in common: the value in the middle of what each of
    them needs, or a slip."""
    for (name, flank), found in flanks.items():
        member = members[name]
        beside = flanks.get((name, FLANKS[1 - FLANKS.index(flank)]), [])
        for one in found:
            shared = one.key in member.shared_settings
            moved, left = _moved(member, flank, one), total - one.before + one.after
            yield _Trial(name, flank, shared, one, moved, left)
            other = next((each for each in beside if (each.key, each.solved) == (one.key, one.solved)), None)
            if one.solved and not shared and flank == FLANKS[0] and other is not None and one.value == other.value:
                middle = replace(one, other=(one.other + other.other) / 2)
                both = left - other.before + other.after
                yield _Trial(name, flank, True, middle, _moved(member, flank, middle), both)


def _wanted(members: Members, found: Mapping[Where, CutFlank], where: Sequence[Where], name: str, flank: str) -> Wanted:
    """Angles that a flank should have: those of its mate, else of the flanks not to blame, else its blade's."""
    member = members[name]
    hand = 1 if member.hand == "right" else -1
    mate = next((other for other in members if other != name), name), FLANKS[1 - FLANKS.index(flank)]
    telling = {place: one for place, one in found.items() if abs(one.spiral_angle) > _TELLING_SPIRAL}
    if mate[0] != name and mate in telling:
        return Wanted(hand * abs(telling[mate].spiral_angle), telling[mate].pressure_angle)
    others = [one for place, one in telling.items() if place not in where] or list(telling.values())
    spiral = median(abs(one.spiral_angle) for one in others) if others else _SPIRAL
    right = [one.pressure_angle for place, one in found.items() if place not in where]
    blade = median(member.flank(each).nominal.alpha for each in FLANKS)
    return Wanted(hand * spiral, median(right) if right else blade)


def _changed(members: Members, trial: _Trial) -> Members:
    """The set with a repair."""
    name, key, other = trial.name, trial.repair.key, trial.repair.other
    if key == _SIGN:  # one crown gear cuts both members
        return {each: one.model_copy(update={_SIGN: other}) for each, one in members.items()}
    return {**members, name: _with(members[name], FLANKS if trial.both else (trial.flank,), key, other)}


def _with(member: Member, flanks: Sequence[str], key: str, value: float) -> Member:
    """A member with another nominal value of a setting of some flanks."""
    update = {}
    for flank in flanks:
        spec = member.flank(flank)
        if spec.design is None:
            update[flank] = spec.model_copy(update={key: value})
        else:
            update[flank] = spec.model_copy(update={"design": spec.design.model_copy(update={key: value})})
    return member.model_copy(update=update)


def _moved(member: Member, flank: str, repair: Repair) -> float:
    """How far [mm] a repair moves the cutter against the work."""
    if repair.key == _SIGN:
        return member.blank.mean_cone_distance
    spec = member.flank(flank).nominal
    (one,) = _suspects(member, "", spec, {repair.key: repair.other}, "")
    return one.apart


def most_changed(member: Member, flank: str) -> Suspect:
    """The setting of a corrected flank that is farthest from its nominal value."""
    spec = member.flank(flank)
    nominal = {key: getattr(spec.nominal, key) for key in SETTINGS}
    suspects = _suspects(member, f"{member.name}.{flank}", spec, nominal, "design")
    return max(suspects, key=lambda suspect: suspect.apart)


def _suspects(member: Member, table: str, spec: Settings, expected: dict[str, float], source: str) -> list[Suspect]:
    R, degree = member.blank.mean_cone_distance, math.radians(1)
    arms = {
        "cradle_angle": R * degree,
        "cutter_tilt": R * degree,
        "machine_root_angle": R * degree,
        "cutter_swivel": R * degree * abs(math.sin(spec.cutter_tilt * degree)),
        "work_rotation_offset": R * degree * math.sin(member.blank.pitch_angle * degree),
        "blade_pressure_angle": _BLADE_ARM * R * degree,
        "ratio_of_roll": _ROLL_ARM * R / spec.ratio_of_roll,
    }
    suspects = []
    for key, wanted in expected.items():
        off = getattr(spec, key) - wanted
        if key in ("cradle_angle", "cutter_swivel"):
            off = math.remainder(off, 360)
        if math.isfinite(off):
            apart = abs(off) * arms.get(key, 1.0)
            suspects.append(Suspect(f"{table}.{key}", getattr(spec, key), wanted, apart, source))
    return suspects


def _crown_gear(
    members: dict[str, Member], member: Member, flank: str, spiral: float, indexing_sign: int
) -> dict[str, float]:
    """The settings of the crown gear by name, mm and degrees as in a file."""
    spec, blank = member.flank(flank).nominal, member.blank
    flanks = [each.flank(name).nominal for each in members.values() for name in FLANKS]
    radius, alpha, blade = (
        median(getattr(one, key) for one in flanks) for key in ("blade_point_radius", "alpha", "blade_pressure_angle")
    )
    # blades of one cutter stand on both sides of its radius, by half the point width
    beside = spec.blade_point_radius - _own_radius(member, flank)
    hand = 1 if member.hand == "right" else -1
    # of the mirrored right-hand member, whose swivel is 180 degrees less that of the left-hand one
    swivel = spec.rad("cutter_swivel") if hand == 1 else math.pi - spec.rad("cutter_swivel")
    angles = {
        "mean_spiral_angle": spiral,
        "pitch_angle": blank.delta,
        "machine_root_angle": blank.delta_f,
        "flank_pressure_angle": alpha,
        "cutter_tilt": spec.rad("cutter_tilt"),
        "tilt_direction": swivel + hand * spec.rad("cradle_angle"),
    }
    values = angles | {
        "hand_sign": hand,
        "side": SIDES[flank],
        "cutter_radius": radius,
        "mean_dedendum": blank.mean_dedendum,
        "mean_cone_distance": blank.mean_cone_distance,
        "index_ratio": indexing_sign * (member.blade_groups or 0) / member.teeth,
    }
    found = evaluate("crown_gear_space" if member.cutting == "completing" else "crown_gear_flank", values)
    wanted = {
        "radial_distance": found["radial_distance"],
        "cradle_angle": math.degrees(found["cradle_angle"]),
        "cutter_tilt": 0.0,
        "blank_offset": 0.0,
        "sliding_base": found["sliding_base"],
        "machine_center_to_crossing_point": 0.0,
        "machine_root_angle": blank.root_angle,
        "blade_point_radius": radius + beside,
        "blade_pressure_angle": blade,
    }
    if spec.cutter_tilt and "cutter_swivel" in found:
        wanted["cutter_swivel"] = math.degrees(found["cutter_swivel"])
    if member.generation == "generated":
        wanted["ratio_of_roll"] = found["ratio_of_roll"]
    return wanted


def _own_radius(member: Member, flank: str) -> float:
    """Point radius [mm] of the cutter of a flank: where it cuts both flanks, that of the middle between its blades."""
    own = [flank] if member.cutting == "fixed_setting" else FLANKS
    return sum(member.flank(each).nominal.blade_point_radius for each in own) / len(own)

"""Which setting of a flank is to blame when it cuts no sensible tooth: the one farthest from the crown gear's value.

Distances are compared as lengths: an angle counts with the arm at which it moves the cutter against the work.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from statistics import median

from gearmath.bevel.blank import evaluate
from gearmath.bevel.repair import Repair, Wanted, repairs
from gearmath.specs.bevel_set import FLANKS, SETTINGS, SIDES, Member, Settings

#: Spiral angle where none of the flanks of the set tells it. [rad]
_SPIRAL = math.radians(35)
#: Arm of the blade's angle and of the roll, in mean cone distances.
_BLADE_ARM, _ROLL_ARM = 0.2, 0.3
_SIGN = "indexing_sign"
#: A setting explains what is wrong if this part of it is left, and no more than this for each flank; settings that
#: leave no more than this above the best one are as good, and the one that is changed least is named.
_EXPLAINED, _FITS, _AS_GOOD = 0.4, 2.5, 0.3
#: Of repairs that are as good, a second one is named too where it moves the cutter at most so many times as far.
_NO_FARTHER = 1.2


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


def farthest(members: dict[str, Member], where: Iterable[tuple[str, str]], spiral: float | None) -> Suspect:
    """The setting of some flanks (member, flank) that is farthest from the crown gear's value.

    The crown gear takes its cutter from all flanks of the set (the middle ones of point radius and blade angle), and
    its ``spiral`` angle [rad] from those that can be solved.
    """
    return max((_worst(members, name, flank, spiral) for name, flank in where), key=lambda suspect: suspect.apart)


def likely(
    members: dict[str, Member], where: Iterable[tuple[str, str]], spiral: float | None, pressure: float | None
) -> str:
    """What to say of the settings of some flanks (member, flank): which of them alone explains that they do not fit.

    ``spiral`` and ``pressure`` [rad] are the angles that the others have. Where none does, that is said, and which is
    farthest from the crown gear's value.
    """
    flanks, angle = list(where), _SPIRAL if spiral is None else spiral
    suspect = farthest(members, flanks, spiral)
    if suspect.key.endswith(_SIGN):
        return f"; the likely cause is {suspect}"
    tried = []
    for name, flank in flanks:
        member = members[name]
        hand = 1 if member.hand == "right" else -1
        alpha = pressure
        if alpha is None:
            alpha = math.radians(median(member.flank(each).nominal.blade_pressure_angle for each in FLANKS))
        expected = _crown_gear(members, member, flank, angle, member.indexing_sign)
        trials = repairs(member, flank, expected, Wanted(hand * angle, alpha))
        tried += [(name, flank, member, one) for one in trials]
    befores = {(name, flank): one.before for name, flank, _, one in tried}
    total = sum(befores.values())
    left = [total - one.before + one.after for *_, one in tried]
    if tried and total > 1 and min(left) <= min(_EXPLAINED * total, _FITS * len(flanks)):
        good = [k for k, value in enumerate(left) if value <= min(left) + _AS_GOOD]
        moved = {k: _moved(tried[k][2], tried[k][1], tried[k][3]) for k in good}
        near = [k for k in sorted(good, key=lambda k: moved[k]) if moved[k] <= _NO_FARTHER * min(moved.values())]
        said = []
        for k in near[:2]:
            name, flank, _, one = tried[k]
            table = name if one.key == _SIGN else f"{name}.{flank}"
            said.append(f"{table}.{one.key} = {one.value:.6g}: {one.other:.6g} would fit")
        return f"; the setting that alone explains it is {', or '.join(said)}"
    # what the mean points and roots do not show, no trial of them can tell
    none = "no single setting explains it, the one" if total > 1 else "the setting"
    return f"; {none} farthest from the crown gear's is {suspect}"


def _moved(member: Member, flank: str, repair: Repair) -> float:
    """How far [mm] a repair moves the cutter against the work."""
    if repair.key == _SIGN:
        return member.blank.mean_cone_distance
    spec = member.flank(flank).nominal
    (one,) = _suspects(member, "", spec, {repair.key: repair.other}, "")
    return one.apart


def _worst(members: dict[str, Member], name: str, flank: str, spiral: float | None) -> Suspect:
    """The worst setting of one flank; in face hobbing the sign of the indexing, where the other one explains more."""
    member, angle = members[name], _SPIRAL if spiral is None else spiral

    def worst(sign: int) -> Suspect:
        expected = _crown_gear(members, member, flank, angle, sign)
        suspects = _suspects(member, f"{name}.{flank}", member.flank(flank).nominal, expected, "crown gear")
        return max(suspects, key=lambda suspect: suspect.apart)

    sign = member.indexing_sign
    found, other = worst(sign), worst(-sign)
    if other.apart < found.apart / 2:
        return Suspect(f"{name}.indexing_sign", sign, -sign, found.apart)
    return found


def most_changed(member: Member, name: str, flank: str) -> Suspect:
    """The setting of a corrected flank that is farthest from its nominal value."""
    spec = member.flank(flank)
    nominal = {key: getattr(spec.nominal, key) for key in SETTINGS}
    suspects = _suspects(member, f"{name}.{flank}", spec, nominal, "design")
    return max(suspects, key=lambda suspect: suspect.apart)


def _suspects(member: Member, table: str, spec: Settings, expected: dict[str, float], source: str) -> list[Suspect]:
    R, degree = member.blank.mean_cone_distance, math.radians(1)
    arms = {
        "cradle_angle": R * degree, "cutter_tilt": R * degree, "machine_root_angle": R * degree,
        "cutter_swivel": R * degree * abs(math.sin(spec.cutter_tilt * degree)),
        "work_rotation_offset": R * degree * math.sin(member.blank.pitch_angle * degree),
        "blade_pressure_angle": _BLADE_ARM * R * degree, "ratio_of_roll": _ROLL_ARM * R / spec.ratio_of_roll,
    }  # fmt: skip
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
    radius, alpha = (
        median(getattr(one, key) for one in flanks) for key in ("blade_point_radius", "blade_pressure_angle")
    )
    # blades of one cutter stand on both sides of its radius, by half the point width
    beside = spec.blade_point_radius - _own_radius(member, flank)
    hand = 1 if member.hand == "right" else -1
    # of the mirrored right-hand member, whose swivel is 180 degrees less that of the left-hand one
    swivel = spec.cutter_swivel if hand == 1 else 180 - spec.cutter_swivel
    angles = {
        "mean_spiral_angle": spiral, "pitch_angle": math.radians(blank.pitch_angle),
        "machine_root_angle": math.radians(blank.root_angle), "flank_pressure_angle": math.radians(alpha),
        "cutter_tilt": math.radians(spec.cutter_tilt),
        "tilt_direction": math.radians(swivel + hand * spec.cradle_angle),
    }  # fmt: skip
    values = angles | {
        "hand_sign": hand, "side": SIDES[flank], "cutter_radius": radius, "mean_dedendum": blank.mean_dedendum,
        "mean_cone_distance": blank.mean_cone_distance,
        "index_ratio": indexing_sign * (member.blade_groups or 0) / member.teeth,
    }  # fmt: skip
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
        "blade_pressure_angle": alpha,
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

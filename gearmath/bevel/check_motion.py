"""Whether the settings of a flank may move as they do: not at all in a Formate cut, else not away from the tooth."""

from __future__ import annotations

import math

import numpy as np

from gearmath.bevel.blank import evaluate
from gearmath.bevel.method import motion_of
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, MACHINE_SETTINGS, Flank, Member
from gearmath.specs.cut import ANGULAR, RATIO

#: A ratio of roll that a Formate cut does not use may be off that of the crown gear by so much of it.
_STILL_ROLL = 0.03
#: A motion may carry a setting so far while the cradle turns from the mean point to an end of the roll [rad]: lengths
#: in mean cone distances, the ratio of roll in itself, angles in degrees. A helical motion of 10 mm/rad, which is a
#: large one, carries the sliding base by half of it.
_SWING, _CARRIED, _CARRIED_ANGLE = math.radians(20), 0.1, 5.0


def check_motions(member: Member) -> None:
    """Refuse motions that cannot be meant. Raises InputError naming member, flank, key, value and limit."""
    for flank in FLANKS:
        spec, table = member.flank(flank), f"{member.name}.{flank}"
        if member.generation == "formate":
            _check_still(spec, table)
            _check_still_roll(member, spec, table)
        else:
            _check_carried(member, spec, table)


def _check_still(spec: Flank, table: str) -> None:
    for key, motion in (("motion", spec.motion), ("design.motion", spec.nominal_motion)):
        if motion.moves:
            moving = next(k for k, values in motion.model_dump().items() if any(values))
            raise InputError(
                f"{table}.{key}.{moving} = {list(getattr(motion, moving))}: the cradle stands still in a Formate "
                "cut, so nothing can move with it; it must be left out"
            )


def _check_still_roll(member: Member, spec: Flank, table: str) -> None:
    """The ratio of a cut that does not roll is that of the crown gear, as a summary may have it, or a mistake."""
    given = spec.nominal.ratio_of_roll
    rolling = evaluate(
        "crown_gear_roll",
        {
            "pitch_angle": member.blank.delta,
            "machine_root_angle": spec.nominal.rad("machine_root_angle"),
        },
    )["ratio_of_roll"]
    if not abs(given - rolling) <= _STILL_ROLL * rolling:
        raise InputError(
            f"{table}.ratio_of_roll = {given:g}: a Formate cut does not roll, so the key has no effect; it must be "
            f"left out, or that of the crown gear, {rolling:.5g} within {_STILL_ROLL:.0%}"
        )


def _check_carried(member: Member, spec: Flank, table: str) -> None:
    for key, motion in (("motion", spec.motion), ("design.motion", spec.nominal_motion)):
        if not motion.moves:
            continue
        rows = dict(zip(MACHINE_SETTINGS, motion.matrix, strict=True))
        rows["modified_roll"] = motion_of(spec, key != "motion")[-1] - motion.matrix[-1]
        for name, row in rows.items():
            angular = name in ANGULAR or name == "modified_roll"
            carried = float(np.abs(row * _SWING ** np.arange(1, len(row) + 1)).max())
            limit, unit = _CARRIED * member.blank.mean_cone_distance, " mm"
            if angular:
                carried, limit, unit = math.degrees(carried), _CARRIED_ANGLE, " degrees"
            elif name == RATIO:
                limit, unit = _CARRIED * spec.nominal.ratio_of_roll, ""
            if not carried <= limit:
                raise InputError(
                    f"{table}.{key}.{name} = {list(getattr(motion, name))}: while the cradle turns by "
                    f"{math.degrees(_SWING):.0f} degrees it moves by {carried:.4g}{unit}, which must be at most "
                    f"{limit:.3g}{unit}"
                )

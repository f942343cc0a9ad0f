"""Sensible basic settings of a member from its blank: the imaginary crown gear of chapter 14.

They cut the mean point rightly: position, pressure angle, spiral angle, the latter in the middle of both flanks where
they are cut at once. Generated members of a pair are mates then, crowned by what their cutters differ in. The mate of a
Formate member needs a design: nothing is done here for what its flanks lack.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

from gearmath.bevel.blank import BevelBlank, MemberBlank, blank_of, evaluate
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, SIDES, BevelSet, Blank, Member
from gearmath.specs.blank_data import BlankData
from gearmath.specs.toml import checked

#: Blade height over the depth of the tooth at the heel: the contact climbs a blade further than the tooth is deep.
_BLADE_RESERVE = 1.8
#: Cutter and crown gear roll on each other from outside, as ISO 23509 has it.
_EPICYCLOID = -1


@dataclass(frozen=True)
class Method:
    """How a member is cut. ``tilt`` and ``tilt_direction`` [rad] belong to a cut of one flank alone.

    With ``alternating`` blades of a hobbing cutter the inner ones follow the outer ones by half of the way to the next
    group, so that half a pitch of the space comes from the turn of the work, and both stand at nearly one radius.
    """

    cutting: Literal["fixed_setting", "completing"] = "completing"
    generation: Literal["generated", "formate"] = "generated"
    tilt: float = 0.0
    tilt_direction: float = 0.0
    alternating: bool = False


@dataclass(frozen=True)
class CrownTooth:
    """What the settings of a member follow from (mm, rad); ``space_width`` is normal, at the mean point."""

    teeth: int
    hand: Literal["left", "right"]
    blank: Blank
    spiral_angle: float
    pressure_angles: dict[str, float]
    cutter_radius: float
    space_width: float
    blade_height: float
    blade_groups: int | None = None

    @property
    def values(self) -> dict[str, float]:
        """The inputs of chapter 14 by name."""
        blank, ratio = self.blank, (self.blade_groups or 0) / self.teeth
        return {
            "hand_sign": 1 if self.hand == "right" else -1,
            "mean_spiral_angle": self.spiral_angle,
            "cutter_radius": self.cutter_radius,
            "mean_cone_distance": blank.mean_cone_distance,
            "pitch_angle": blank.delta,
            "machine_root_angle": blank.delta_f,
            "mean_dedendum": blank.mean_dedendum,
            "index_ratio": _EPICYCLOID * ratio,
        }


def crown_gear_member(tooth: CrownTooth, method: Method = Method()) -> Member:
    """A member with settings of the crown gear.

    Raises InputError where blade groups or cutter do not fit, or where a tilted cut of both flanks is asked for.
    """
    if method.cutting == "completing":
        if method.tilt:
            raise InputError(f"tilt = {math.degrees(method.tilt):.3g}: a cut of both flanks must be untilted")
        flanks = _both_flanks(tooth, method.alternating and tooth.blade_groups is not None)
    else:
        if tooth.blade_groups:
            raise InputError("blade_groups: face hobbing cuts both flanks at once, so cutting must be completing")
        flanks = {flank: _one_flank(tooth, method, flank) for flank in FLANKS}
    hobbing = {"process": "face_hobbing", "blade_groups": tooth.blade_groups, "indexing_sign": _EPICYCLOID}
    values = {
        "teeth": tooth.teeth,
        "hand": tooth.hand,
        "cutting": method.cutting,
        "generation": method.generation,
        "blank": tooth.blank,
        **flanks,
        **(hobbing if tooth.blade_groups else {}),
    }
    return checked(values, Member, f"crown gear of {tooth.teeth} teeth")


def crown_gear_set(
    data: BlankData, pinion: Method = Method(), gear: Method = Method(), hand: Literal["left", "right"] = "left"
) -> BevelSet:
    """A pair with settings of the crown gear from design data; ``hand`` is that of the pinion.

    Raises InputError with key, value and limit where blank or cutter are impossible.
    """
    blank = blank_of(data)
    other: Literal["left", "right"] = "right" if hand == "left" else "left"
    return BevelSet(
        title=data.title,
        source=data.source,
        shaft_angle=data.shaft_angle,
        pinion=crown_gear_member(_tooth(data, blank, blank.pinion, hand), pinion),
        gear=crown_gear_member(_tooth(data, blank, blank.wheel, other), gear),
    )


def _tooth(data: BlankData, pair: BevelBlank, member: MemberBlank, hand: Literal["left", "right"]) -> CrownTooth:
    """A member of the blank; the drive side is the concave flank of the pinion, the convex one of the gear."""
    pitch = math.pi * pair.mean_normal_module
    drive = "concave" if member is pair.pinion else "convex"
    angles = {flank: pair.pressure_angle_drive if flank == drive else pair.pressure_angle_coast for flank in FLANKS}
    return CrownTooth(
        member.teeth,
        hand,
        member.spec_blank(),
        pair.mean_spiral_angle,
        angles,
        pair.cutter_radius,
        pitch - member.mean_normal_thickness,
        math.ceil(_BLADE_RESERVE * member.outer_whole_depth),
        data.cutter.blade_groups,
    )


def _both_flanks(tooth: CrownTooth, alternating: bool) -> dict[str, dict[str, float]]:
    """Both flanks in one cut, the mean radius of the cutter in the middle of the space.

    The root line of a milled space is inclined, which takes from the pressure angle of one flank what it gives to the
    other, θ_f sin ψ. So its blades are of two angles, and stand about a wall that is square to the pitch cone; the
    trade gives the difference as the number of a cutter. Hobbed teeth are of uniform depth.
    """
    if tooth.blade_groups:
        space = evaluate("crown_gear_space", tooth.values)
        if not math.isfinite(space["radial_distance"]):
            raise InputError(
                f"cutter_radius = {tooth.cutter_radius:g}: {tooth.blade_groups} blade groups do not fit on it: "
                "blade_groups times the mean normal module must be below the cutter's diameter"
            )
        space["wall_angle"], blades = 0.0, tooth.pressure_angles
    else:
        space = _untilted(tooth, "convex", 0.0) | {"blade_offset_angle": 0.0, "cutter_swivel": 0.0}
        space["wall_angle"] = space["blade_pressure_angle"]
        blades = {
            flank: _untilted(tooth, flank, tooth.pressure_angles[flank])["blade_pressure_angle"] for flank in FLANKS
        }
    space["space_width"] = tooth.space_width
    turn = 0.0
    if alternating:
        radius = tooth.blank.mean_cone_distance * math.sin(tooth.blank.delta)
        turn = math.pi / tooth.teeth
        space["space_width"] -= turn * radius * math.cos(tooth.spiral_angle)
    turns = {flank: side * tooth.values["hand_sign"] * turn / 2 for flank, side in SIDES.items()}
    return {
        flank: _flank(tooth, space | {"work_rotation_offset": turns[flank]}, blades[flank], SIDES[flank])
        for flank in FLANKS
    }


def _untilted(tooth: CrownTooth, flank: str, pressure_angle: float) -> dict[str, float]:
    """Settings of an untilted blade that cuts this pressure angle [rad] at the mean point (14.3-14.5)."""
    given = {"side": SIDES[flank], "cutter_tilt": 0.0, "tilt_direction": 0.0, "flank_pressure_angle": pressure_angle}
    return evaluate("crown_gear_flank", {**tooth.values, **given})


def _one_flank(tooth: CrownTooth, method: Method, flank: str) -> dict[str, float]:
    """A flank cut alone: half the width of the space from its middle, by turning the work."""
    side = SIDES[flank]
    given = {
        "side": side,
        "flank_pressure_angle": tooth.pressure_angles[flank],
        "cutter_tilt": method.tilt,
        "tilt_direction": method.tilt_direction,
    }
    settings = evaluate("crown_gear_flank", {**tooth.values, **given})
    if not math.isfinite(settings["radial_distance"]):
        raise InputError(f"tilt = {math.degrees(method.tilt):g}: the flank would be square to the cutter's axis")
    radius = tooth.blank.mean_cone_distance * math.sin(tooth.blank.delta)
    turn = side * tooth.values["hand_sign"] * tooth.space_width / math.cos(tooth.spiral_angle) / (2 * radius)
    settings |= {
        "cutter_tilt": method.tilt,
        "blade_offset_angle": 0.0,
        "work_rotation_offset": turn,
        "space_width": 0.0,
        "wall_angle": 0.0,
    }
    if method.tilt == 0:
        settings["cutter_swivel"] = 0.0  # it would turn the cutter about its own axis
    return _flank(tooth, settings, settings["blade_pressure_angle"], side)


def _flank(tooth: CrownTooth, settings: dict[str, float], alpha: float, side: int) -> dict[str, Any]:
    """The flank as its file has it, in mm and degrees."""
    blade = {"cutter_radius": tooth.cutter_radius, "blade_pressure_angle": alpha, "side": side}
    point_radius = evaluate("blade_in_space", {**settings, **blade})["blade_point_radius"]
    _check_cutter(tooth, settings["radial_distance"], point_radius)
    degrees = {
        "cradle_angle": settings["cradle_angle"],
        "cutter_tilt": settings.get("cutter_tilt", 0.0),
        "cutter_swivel": settings.get("cutter_swivel", 0.0),
        "blade_offset_angle": settings["blade_offset_angle"],
        "work_rotation_offset": settings.get("work_rotation_offset", 0.0),
        "blade_pressure_angle": alpha,
    }
    return {
        "radial_distance": settings["radial_distance"],
        "blank_offset": 0.0,
        "sliding_base": settings["sliding_base"],
        "machine_center_to_crossing_point": 0.0,
        "machine_root_angle": tooth.blank.root_angle,
        "ratio_of_roll": settings["ratio_of_roll"],
        "blade_point_radius": point_radius,
        "blade_profile_height": tooth.blade_height,
        **{name: math.degrees(angle) for name, angle in degrees.items()},
    }


def _check_cutter(tooth: CrownTooth, distance: float, radius: float) -> None:
    """The cutter's circle must cross the crown gear from toe to heel."""
    blank = tooth.blank
    toe = blank.mean_cone_distance - blank.face_width / 2
    heel = blank.mean_cone_distance + blank.face_width / 2
    if not abs(distance - radius) < toe or not distance + radius > heel:
        raise InputError(
            f"cutter_radius = {tooth.cutter_radius:g}: set to its spiral angle the cutter sweeps the cone distances "
            f"{abs(distance - radius):.4g} to {distance + radius:.4g} mm, which must take in {toe:.4g} to {heel:.4g} mm"
        )


def with_motion(member: Member, **motion: tuple[float, ...]) -> Member:
    """The member with the same motion of its settings on both flanks, coefficients as its file has them."""
    values = member.model_dump()
    for flank in FLANKS:
        values[flank]["motion"] = motion
    return checked(values, Member, f"motion of a member of {member.teeth} teeth").named(member.name)

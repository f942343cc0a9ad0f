"""The blank of a spiral bevel pair from its design data: the chapters 11 to 13, composed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

from derivations import notation
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import Blank
from gearmath.specs.blank_data import BlankData

#: Largest part of the outer cone distance that the face width may take, of blanks designed here and of those in a set;
#: ISO 23509 advises 0.30, a third has been published (9 x 33 of Litvin).
WIDEST_FACE = 0.35
#: Largest pitch angle: beyond it a member comes close to a flat or an internal gear.
FLATTEST_PITCH = math.radians(87)

Values = dict[str, float]


@dataclass(frozen=True)
class MemberBlank:
    """One member (mm, rad). Names are those of ``derivations.notation``, without the member's name in front."""

    teeth: int
    pitch_angle: float
    face_angle: float
    root_angle: float
    addendum_angle: float
    dedendum_angle: float
    face_apex: float
    root_apex: float
    mean_cone_distance: float
    face_width: float
    mean_addendum: float
    mean_dedendum: float
    clearance: float
    outer_addendum: float
    outer_dedendum: float
    outer_whole_depth: float
    inner_addendum: float
    inner_dedendum: float
    inner_whole_depth: float
    outer_pitch_diameter: float
    mean_pitch_diameter: float
    inner_pitch_diameter: float
    outer_tip_diameter: float
    outer_root_diameter: float
    inner_tip_diameter: float
    inner_root_diameter: float
    crossing_point_to_mean_point: float
    crossing_point_to_crown: float
    crossing_point_to_front_crown: float
    thickness_coefficient: float
    mean_normal_thickness: float
    mean_transverse_thickness: float
    mean_normal_diameter: float
    mean_normal_chordal_thickness: float
    mean_chordal_addendum: float

    def spec_blank(self) -> Blank:
        """The blank as a gear set's file has it; the pitch apex lies in the crossing point, as method 0 has it."""
        components = notation.blank.components
        degrees = {q.name: math.degrees(getattr(self, q.name)) for q in components if q.unit == "rad"}
        # with uniform depth the three angles are one, but for the last bit
        degrees["face_angle"] = max(degrees["face_angle"], degrees["pitch_angle"])
        degrees["root_angle"] = min(degrees["root_angle"], degrees["pitch_angle"])
        return Blank(**degrees, **{q.name: getattr(self, q.name) for q in components if q.unit == "mm"})


@dataclass(frozen=True)
class BevelBlank:
    """The pair (mm, rad). ``cutter_lead_angle`` and ``epicycloid_base_radius`` are None in face milling."""

    process: str
    shaft_angle: float
    gear_ratio: float
    face_width: float
    outer_cone_distance: float
    mean_cone_distance: float
    inner_cone_distance: float
    outer_transverse_module: float
    mean_normal_module: float
    outer_spiral_angle: float
    mean_spiral_angle: float
    inner_spiral_angle: float
    pressure_angle_drive: float
    pressure_angle_coast: float
    mean_normal_pressure_angle: float
    cutter_radius: float
    cutter_lead_angle: float | None
    epicycloid_base_radius: float | None
    profile_shift_coefficient: float
    mean_working_depth: float
    mean_whole_depth: float
    clearance: float
    dedendum_angle_sum: float
    outer_normal_backlash: float
    outer_transverse_backlash: float
    mean_normal_backlash: float
    mean_transverse_backlash: float
    pinion_root_normal_depth: float
    pinion: MemberBlank
    wheel: MemberBlank


def evaluate(name: str, values: Mapping[str, Any], **renamed: Any) -> Values:
    """The outputs by name of one expression, its inputs taken by name from ``renamed`` and ``values``."""
    run, given = kernel(name), {**values, **renamed}
    outputs = run(*(given[quantity.name] for quantity in run.inputs))
    return {quantity.name: float(value) for quantity, value in zip(run.outputs, outputs, strict=True)}


def blank_of(data: BlankData, name: str = "blank data") -> BevelBlank:
    """The blank that follows from design data; ``name`` is their file in the messages.

    Raises InputError with key, value and limit: face width too large, cutter too small, a cone that does not exist.
    """
    values = dict(data.values)
    if "wheel_outer_pitch_diameter" not in values:
        values |= evaluate("wheel_size", values)
    values |= evaluate("pitch_cones", values)
    _check_cones(values, name)
    if data.data_type_2 is not None:
        values |= evaluate("crown_gear_factors", values)
    values |= evaluate("mean_depths", values)
    values |= _spiral_angles(values, name)
    values |= _tapered(values, name)
    ends = {"cone_distance": values["outer_cone_distance"], "spiral_angle": values["outer_spiral_angle"]}
    values |= evaluate("tooth_thickness", values, **ends)
    members = {member: _member(member, values) for member in ("pinion", "wheel")}
    for member, blank in members.items():
        _check_member(member, blank, values, name)
    crown = {"crossing_point_to_crown": members["pinion"].crossing_point_to_crown}
    values |= evaluate("pinion_depth", values, **crown)
    return _filled(BevelBlank, {**values, **members, "process": data.cutter.process})


def _filled(record: type, values: Mapping[str, Any]) -> Any:
    """The dataclass with its fields by name; what a process does not have is None."""
    return record(**{field.name: values.get(field.name) for field in fields(record)})


def _spiral_angles(values: Values, name: str) -> Values:
    """Spiral angles at heel and toe. Raises InputError where the cutter does not reach them."""
    hobbing = "blade_groups" in values
    cutter = {} if not hobbing else evaluate("hobbing_cutter", values)
    if hobbing and not math.isfinite(cutter["cutter_lead_angle"]):
        raise InputError(
            f"{name}: cutter.cutter_radius = {values['cutter_radius']:g}: {values['blade_groups']:g} blade groups of "
            f"module {values['mean_normal_module']:.4g} do not fit: blade_groups * module must be below the diameter"
        )
    spirals = "hobbed_spiral_angle" if hobbing else "milled_spiral_angle"
    for end, steepest in (("outer", math.pi / 2), ("inner", -math.pi / 2)):
        place = {"cone_distance": values[f"{end}_cone_distance"]}
        angle = evaluate(spirals, {**values, **cutter}, **place)["spiral_angle"]
        if not math.isfinite(angle):
            least = evaluate("milled_radius", values, spiral_angle=steepest, **place)["cutter_radius"]
            limit = "a larger radius is needed" if hobbing else f"it must be at least {least:.4g} mm"
            raise InputError(
                f"{name}: cutter.cutter_radius = {values['cutter_radius']:g}: set to the mean spiral angle, the cutter "
                f"does not reach the {end} cone distance of {place['cone_distance']:.4g} mm; {limit}"
            )
        cutter[f"{end}_spiral_angle"] = angle
    return cutter


def _tapered(values: Values, name: str) -> Values:
    """Taper angles of the wheel, face and root angles and apexes of both members."""
    if "depth_taper" in values:
        angles = evaluate("taper_angles", values)
        if angles["dedendum_angle_sum"] < 0:
            least = values["mean_cone_distance"] * math.sin(values["mean_spiral_angle"])
            raise InputError(
                f"{name}: cutter.cutter_radius = {values['cutter_radius']:g}: too small for a duplex taper or a tilted "
                f"root line, whose teeth would be deeper at the toe: it must be at least {least:.4g} mm"
            )
    else:
        angles = {key: values[key] for key in ("wheel_addendum_angle", "wheel_dedendum_angle")}
        angles["dedendum_angle_sum"] = sum(angles.values())
    angles |= evaluate("cone_angles", {**values, **angles})
    return angles | evaluate("cone_apexes", {**values, **angles})


def _member(member: str, values: Values) -> MemberBlank:
    """Everything of one member, out of the values of the pair."""
    own = values | {
        key.removeprefix(f"{member}_"): value for key, value in values.items() if key.startswith(f"{member}_")
    }
    own |= evaluate("blank_ends", own, blank=[own[quantity.name] for quantity in notation.blank.components])
    own |= evaluate("chordal_tooth", own)
    return _filled(MemberBlank, {**own, "teeth": int(own["teeth"])})


def _check_cones(values: Values, name: str) -> None:
    outer, face_width = values["outer_cone_distance"], values["face_width"]
    pitch, flattest = math.degrees(values["wheel_pitch_angle"]), math.degrees(FLATTEST_PITCH)
    if not 0 < pitch <= flattest:
        raise InputError(
            f"{name}: shaft_angle = {math.degrees(values['shaft_angle']):g}: the wheel's pitch angle would be "
            f"{pitch:.4g} degrees, but must be at most {flattest:g}"
        )
    if face_width > WIDEST_FACE * outer:
        raise InputError(
            f"{name}: face_width = {face_width:g}: must be at most {WIDEST_FACE:g} of the outer cone distance, "
            f"{WIDEST_FACE * outer:.4g} mm"
        )


def _check_member(member: str, blank: MemberBlank, values: Values, name: str) -> None:
    limits = (
        ("root angle [degree]", math.degrees(blank.root_angle), 1.0),
        ("90 degrees less face angle", 90 - math.degrees(blank.face_angle), 0.0),
        ("mean thickness [mm]", blank.mean_normal_thickness, 0.0),
        ("inner addendum [mm]", blank.inner_addendum, 0.0),
        ("inner dedendum less clearance [mm]", blank.inner_dedendum - blank.clearance, 0.0),
    )
    for what, value, least in limits:
        if not value > least:
            raise InputError(f"{name}: {member}: {what} = {value:.4g}: must be above {least:g}; change depth or taper")

"""From the file of a member to what the root finder takes: how a flank is generated, and the sections of its blade."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gearmath.bevel.generation import BladeCut, Generation, Section
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import SIDES, Flank, Member, Motion

_WORK_ROTATION_ROW = 9  # of the motion: the last machine setting


def motion_of(spec: Flank, nominal: bool = False) -> np.ndarray:
    """The motion (10,7) of the machine settings of a flank, modified roll included; ``nominal`` before a correction."""
    moving = spec.nominal_motion if nominal else spec.motion
    motion = moving.matrix
    if moving.modified_roll:
        (row,) = kernel("modified_roll")(spec.nominal.ratio_of_roll, moving.roll)
        motion[_WORK_ROTATION_ROW] += row
    return motion


def generation_of(member: Member, flank: str) -> Generation:
    """How the nominal flank of a member comes about."""
    spec = member.flank(flank)
    return Generation(
        settings=spec.nominal.vector,
        side=SIDES[flank],
        motion=motion_of(spec, nominal=True),
        index_ratio=member.indexing_sign * (member.blade_groups or 0) / member.teeth,
        blade_offset_angle=spec.rad("blade_offset_angle"),
        rolling=member.generation == "generated",
    )


def cut_generation_of(member: Member, flank: str) -> Generation:
    """How a flank comes about with the settings and the motion that the machine is really set to, corrections kept."""
    spec = member.flank(flank)
    return replace(generation_of(member, flank), settings=spec.vector, motion=motion_of(spec))


def nominal_cut(member: Member, flank: str) -> BladeCut:
    """What the nominal flank of a member is cut by. Raises ValueError as :func:`blade_sections` does."""
    return BladeCut(generation_of(member, flank), blade_sections(member.flank(flank), SIDES[flank]))


def actual_cut(member: Member, flank: str) -> BladeCut:
    """The same with the settings, the motion and the blade that the machine really has, corrections kept."""
    spec = member.flank(flank).model_copy(update={"design": None})
    return BladeCut(cut_generation_of(member, flank), blade_sections(spec, SIDES[flank]))


def require_plain(member: Member, what: str) -> None:
    """Refuse what so far only knows face milling: a generated flank, settings at rest, a straight blade.

    Raises InputError naming the member, what it was asked for, and what stands against it.
    """
    against = [
        text
        for text, is_so in (
            ("face hobbed", member.process == "face_hobbing"),
            ("Formate cut", member.generation == "formate"),
            ("cut with settings that move", any(member.flank(flank).motion != Motion() for flank in SIDES)),
            ("cut with arc blades", any(member.flank(flank).blade_spheric_radius is not None for flank in SIDES)),
        )
        if is_so
    ]
    if against:
        raise InputError(
            f"{member.name}: {what} is there for plain face milling only; this member is {' and '.join(against)}"
        )


def blade_sections(spec: Flank, side: int) -> dict[str, Section]:
    """The sections of a blade from the tip upwards: ``edge`` (if rounded), ``toprem`` (if there), ``main``.

    Raises ValueError where they do not join: an edge radius that reaches above the Toprem, or above the blade.
    """
    radius, alpha = spec.nominal.blade_point_radius, spec.nominal.alpha
    sections: dict[str, Section] = {}
    bottom = spec.blade_tip_height
    if spec.toprem_angle is not None:
        lowest, bottom, angle = bottom, spec.toprem_height, spec.rad("toprem_angle")
        (toprem_radius,) = kernel("toprem")(radius, alpha, angle, bottom, side)
        sections["toprem"] = Section(lowest, bottom, float(toprem_radius), angle)
    sections["main"] = _main(spec, side, bottom)
    if spec.blade_edge_radius == 0.0:
        return sections
    first = next(iter(sections))
    edge, sections[first] = _rounded(spec.blade_edge_radius, spec.blade_tip_height, side, sections[first])
    return {"edge": edge, **sections}


def _main(spec: Flank, side: int, bottom: float) -> Section:
    """The main section: straight, by height; or the arc, by the angle of its normal."""
    radius, alpha = spec.nominal.blade_point_radius, spec.nominal.alpha
    if spec.nominal_spheric_radius is None:
        return Section(bottom, spec.blade_profile_height, radius, alpha)
    (arc,) = kernel("spheric_blade")(radius, alpha, spec.nominal_spheric_radius, spec.blade_reference_height, side)
    ends = [math.asin((arc[1] - height) / arc[2]) for height in (bottom, spec.blade_profile_height)]
    return Section(min(ends), max(ends), radius, alpha, _triple(arc))


def _rounded(edge_radius: float, tip: float, side: int, lowest: Section) -> tuple[Section, Section]:
    """The rounded edge, and the lowest section of the blade without what the rounding takes away."""
    if lowest.arc is not None:
        arc, joint = kernel("edge_round_of_arc")(np.array(lowest.arc), edge_radius, tip, side)
        # the normal of a convex arc falls from the tip upwards, that of a concave one rises
        start = float(joint)
        rest = replace(lowest, upper=start) if lowest.arc[2] > 0 else replace(lowest, lower=start)
    else:
        arc, height = kernel("edge_round")(lowest.point_radius, lowest.pressure_angle, edge_radius, tip, side)
        rest, start = replace(lowest, lower=float(height)), lowest.pressure_angle
    if rest.lower >= rest.upper:
        raise ValueError(f"blade_edge_radius = {edge_radius}: nothing is left of the section above it")
    return Section(start, math.pi / 2, lowest.point_radius, lowest.pressure_angle, _triple(arc)), rest


def _triple(arc: np.ndarray) -> tuple[float, float, float]:
    return float(arc[0]), float(arc[1]), float(arc[2])

"""What a design has come to: the exact contact of both sides, teeth, backlash; and what of it cannot be accepted."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearmath.bevel.contact.local import LocalContact, local
from gearmath.bevel.contact.mesh import Mesh
from gearmath.bevel.contact.report import ARCSEC, peak_to_peak_arcsec, side_mesh
from gearmath.bevel.contact.system import Assembly, TouchPoint
from gearmath.bevel.contact.thread import Thread, zero
from gearmath.bevel.design.crownings import crownings, miss
from gearmath.bevel.design.local_settings import ACROSS
from gearmath.bevel.design.route import Designed
from gearmath.bevel.design.take_over import advice, reason
from gearmath.bevel.design.tip_edges import HIGHEST_RIDGE
from gearmath.bevel.grid import over_reach
from gearmath.bevel.pair import check_computed
from gearmath.bevel.ridge import ridge
from gearmath.bevel.tooth import mean_backlash, space_widths, tooth_space
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import Member

#: Least top land, in mean normal modules.
LEAST_LAND = 0.2
#: Second derivative of the transmission error at the vertex: what it may be off, unless the shop's steps make it so.
PARABOLA = 0.02
_PLACES = ("toe", "mean", "heel")
#: The vertex is sought among so many rotations of a thread.
_SOUGHT = 41


class EdgeContact(InputError):
    """A pair of teeth does not take over from the one before within the flanks."""


@dataclass(frozen=True)
class Vertex:
    """Where the gear runs furthest ahead within both flanks, and by how much it lags half a pitch on either side [rad].

    NaN where the contact has left both flanks there.
    """

    touch: TouchPoint
    local: LocalContact
    lag: tuple[float, float]
    place: tuple[float, float]


def vertex(run: Mesh) -> Vertex | None:
    """The vertex of the parabola of a pair of teeth, None where the contact within both flanks has none."""
    system, best = run.system, None
    for thread, segment in run.interior:
        rotations = np.linspace(*segment.ends, _SOUGHT)
        lead = system.sense * thread.errors(system, rotations)
        if np.isnan(lead).all():
            continue
        k = int(np.nanargmax(lead))
        found = _flat(run, thread, rotations[max(k - 1, 0)], rotations[min(k + 1, _SOUGHT - 1)])
        if found is not None and (best is None or run.lead(found) > run.lead(best[1])):
            best = (thread, found)
    if best is None:
        return None
    thread, touch = best
    lags = []
    for way in (-1, 1):
        there = thread.at(system, touch.rotation + way * system.pitch / 2)
        lags.append(math.nan if there is None else run.lead(touch) - run.lead(there))
    place = system.gear_place(touch.x)
    return Vertex(touch, local(system, touch, run.assembly), (lags[0], lags[1]), place)


def _flat(run: Mesh, thread: Thread, low: float, high: float) -> TouchPoint | None:
    """The contact between two rotations at which the transmission has the slope of the ratio."""
    system = run.system
    return zero(lambda at: thread.at(system, at), lambda touch: float(touch.tangent[6]) + system.ratio, low, high)


def top_land(member: Member) -> dict[str, float]:
    """Normal top land [mm] at toe, mean and heel."""
    space = tooth_space(member)
    flank = space.concave
    delta = member.blank.delta
    _, spiral, _, _ = kernel("flank_angles")(delta, flank.point[0], flank.normal[0])
    land = space.top_land * np.cos(spiral)
    return dict(zip(_PLACES, (float(land[k]) for k in (0, len(land) // 2, -1)), strict=True))


def verdict(made: Designed) -> tuple[dict[str, Any], dict[str, Mesh]]:
    """The figures of a design by name, and the contact of both sides.

    Raises InputError with the limit that is broken: the pair is none, runs on edges, or has too thin a tooth.
    """
    stepped = any(made.data.shop.model_dump().values())
    try:
        check_computed(made.pair)
    except InputError as error:
        finer = "finer steps in [shop], " * stepped
        raise InputError(
            f"the pair that was found is refused: {error}; {finer}another mean_addendum_factor, thickness_factor, "
            "pressure angle, cutter_radius or method of the gear is needed"
        ) from error
    pinion, gear = made.pair.member("pinion"), made.pair.member("gear")
    module = mean_module(made)
    lands = {name: top_land(member) for name, member in (("pinion", pinion), ("gear", gear))}
    for name, land in lands.items():
        place = min(land, key=lambda one: land[one])
        if not land[place] >= LEAST_LAND * module:
            raise InputError(
                f"{name}: top land of {land[place]:.3g} mm at the {place}: must be at least {LEAST_LAND * module:.3g} "
                f"mm, {LEAST_LAND:g} of the mean normal module; thickness_factor or mean_addendum_factor must change"
            )
    ridges = {name: ridge(made.pair.member(name), tooth_space(made.pair.member(name))) for name in lands}
    for name, height in ridges.items():
        if made.pair.member(name).process == "face_hobbing":
            _check_tips(made.pair.member(name), height)
    cuts = {name: undercut(made.pair.member(name)) for name in lands}
    _check_undercut(cuts)
    figures: dict[str, Any] = {
        "cutter_radius_mm": made.blank_data.cutter.cutter_radius,
        "mean_normal_module_mm": module,
        "data_type_2": None if made.blank_data.data_type_2 is None else made.blank_data.data_type_2.model_dump(),
        "backlash_mm": {"asked": made.backlash, "found": mean_backlash(pinion, gear)},
        "top_land_mm": lands,
        "undercut_mm": cuts,
        "root_ridge_um": {name: 1000 * one if math.isfinite(one) else None for name, one in ridges.items()},
    }
    runs = {side: side_mesh(made.pair, side, Assembly()) for side in made.flanks}
    for side, run in runs.items():
        figures[side] = _side(made, side, run, stepped)
    return figures, runs


def undercut(member: Member) -> float:
    """How far above the reach of the mate's tip [mm] a flank folds back on itself, at the most, up to toe and heel.

    Contact ends at the fold, but what the blade cuts beyond it takes metal from the flank above it, too.
    """
    space = tooth_space(member)
    points = np.concatenate([surface.point[surface.undercut] for surface in (space.concave, space.convex)])
    heights = over_reach(member, points[:, 2], np.hypot(points[:, 0], points[:, 1]))
    return float(np.max(heights, initial=0.0))


def _check_undercut(heights: dict[str, float]) -> None:
    """Refuse members that are undercut where their mates reach, by heights [mm]."""
    for name, height in heights.items():
        if height > 0:
            raise InputError(
                f"{name}: undercut reaches {height:.3g} mm above the lowest place that the tip of the mate reaches, "
                "which must be at most 0 mm: larger pressure angles, a smaller tooth_depth_factor or "
                "mean_addendum_factor, or more teeth are needed"
            )


def _check_tips(member: Member, height: float) -> None:
    """Refuse a hobbed member whose tips leave more between them than the mate passes: a ridge [mm], or a fin."""
    most, root = HIGHEST_RIDGE * member.blank.clearance, space_widths(member)[0]
    if height > most:
        left = f"a ridge of {1000 * height:.0f} um" if math.isfinite(height) else "a fin"
        raise InputError(
            f"{member.name}: {left} stays in the middle of the root, which may be at most {1000 * most:.0f} um high, "
            f"{HIGHEST_RIDGE:g} of the clearance: the root is {root.toe:.3g} mm wide at the toe and {root.heel:.3g} mm "
            f"at the heel, and tips with edges of {member.concave.blade_edge_radius:g} mm that pass the fillets at the "
            "toe do not meet at the heel; a smaller face_width, another thickness_factor or smaller blade_edge_radius "
            "is needed"
        )


def mean_module(made: Designed) -> float:
    """Mean normal module [mm] of the pair."""
    gear = made.pair.member("gear")
    blank, teeth = gear.blank, gear.teeth
    transverse = 2 * blank.mean_cone_distance * math.sin(blank.delta) / teeth
    return transverse * math.cos(made.data.rad("mean_spiral_angle"))


def _side(made: Designed, side: str, run: Mesh, stepped: bool) -> dict[str, Any]:
    """The figures of one side. Raises InputError where it does not run as asked."""
    flank, asked = made.flanks[side], made.data.contact(side)
    found, crowned = vertex(run), asked.lengthwise_crowning is not None
    request = "crownings" if crowned else f"transmission_error = {asked.transmission_error:g} arcsec"
    if run.outcome == "interior contact" and found is None:
        raise InputError(
            f"{side}: {request}: the parabola has no vertex within both flanks; "
            "position must be given, or the path come nearer to 90 degrees"
        )
    if run.outcome != "interior contact" or found is None:
        at = None if found is None else found.touch.rotation
        free, rms = made.data.pinion.may_change, 1000 * flank.fitted.rms
        helps = advice(run.outcome, asked, flank.request, rms, free, stepped)
        raise EdgeContact(f"{side}: {run.outcome}: {reason(run, at)}: {helps} is needed")
    second, wanted = found.local.second_derivative, flank.request.parabola
    if not stepped and not abs(second - wanted) <= PARABOLA * abs(wanted):
        raise InputError(
            f"{side}: {request}: the second derivative at the vertex is "
            f"{second / wanted:.1%} of the one that belongs to it, which must be within {PARABOLA:.0%}"
        )
    lag = [None if math.isnan(one) else one * ARCSEC for one in found.lag]
    crowning, rms = crownings(made.pair, flank.name, flank.request, asked), 1000 * flank.fitted.rms
    return {
        "outcome": run.outcome,
        "remarks": [one for one in (miss(rms, crowning), _parabola_off(second, wanted)) if one],
        "contact_ratio": run.contact_ratio,
        "peak_to_peak_arcsec": peak_to_peak_arcsec(run),
        "second_derivative": {"asked": wanted, "found": second},
        "lag_half_a_pitch_from_vertex_arcsec": lag,
        "vertex": {
            "gear_cone_distance_mm": found.place[0],
            "gear_height_mm": found.place[1],
            "asked_mm": list(_asked_place(made, side)),
        },
        "path_angle_deg": {
            "asked": math.degrees(flank.request.path_angle),
            "found": math.degrees(found.local.path_angle),
        },
        "semi_axes_mm": {"asked_major": flank.request.semi_axis, "found": list(found.local.semi_axes)},
        "crownings_um": crowning,
        "ease_off_rms_um": rms,
        "share_of_flank": flank.share,
        "bounds_reached": ["pattern_length" if one == ACROSS else one for one in flank.fitted.active],
    }


def _parabola_off(second: float, wanted: float) -> str:
    """What to say of a parabola that the steps of the shop make another one; empty where they do not."""
    if abs(second - wanted) <= PARABOLA * abs(wanted):
        return ""
    return (
        f"the steps of [shop] change the second derivative at the vertex by {second / wanted - 1:+.1%}, where "
        f"{PARABOLA:.0%} is no remark, and the transmission error with it: finer steps keep it"
    )


def _asked_place(made: Designed, side: str) -> tuple[float, float]:
    """Cone distance and height on the gear [mm] at which the vertex was asked for."""
    axial, radial = made.flanks[side].request.place
    delta = made.pair.member("gear").blank.delta
    along, deep = kernel("root_place")(np.array([radial, 0.0, axial]), delta)
    return float(along), -float(deep)

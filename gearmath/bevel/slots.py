"""Slot widths, top lands and the edge radius of the cutter to AGMA 929; both members completed."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass

from gearmath.bevel.blank import BevelBlank, MemberBlank, Values, evaluate

#: Half pitches by which the work turns from blade to blade.
ROTATION = {"face_milling": 0.0, "face_hobbing": 1.0}
#: Places along the tooth, in the order of every triple here.
PLACES = ("inner", "mean", "outer")

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class MemberSlots:
    """One member (mm): at toe, mean point and heel the slot width at the root, thickness on the pitch line, top land;
    the blade's tip; and what limits the edge radius: tip of the mate, room on the blade, opposite blade."""

    slot_width: Triple
    normal_thickness: Triple
    top_land: Triple
    blade_point_width: float
    edge_radius_interference: float
    edge_radius_fillet: float
    edge_radius_mutilation: float

    @property
    def maximum_edge_radius(self) -> float:
        return min(self.edge_radius_interference, self.edge_radius_fillet, self.edge_radius_mutilation)

    @property
    def is_pointed(self) -> bool:
        """True where a tooth has no top land left."""
        return min(self.top_land) <= 0


@dataclass(frozen=True)
class Slots:
    """The pair (mm); ``clearance_change`` is that at the toe. ``involute_cone_distance`` is None in face hobbing."""

    normal_pitch: float
    outer_normal_backlash: float
    clearance_change: float
    involute_cone_distance: float | None
    pinion: MemberSlots
    wheel: MemberSlots


def slots_of(blank: BevelBlank, blade_flat: float = 0.2, mutilation: float = 0.05) -> Slots:
    """Slots, top lands and edge radii of a blank; ``blade_flat`` [mm] stays on the blade's tip beside the round,
    ``mutilation`` [mm] is how deep the opposite blade may cut into the fillet."""
    places = [_at(blank, place) for place in PLACES]
    members = {member: _member(blank, member, places, blade_flat, mutilation) for member in ("pinion", "wheel")}
    milled = blank.process == "face_milling"
    involute = evaluate("involute_curvature", asdict(blank)) if milled else {"involute_cone_distance": None}
    return Slots(
        normal_pitch=places[0]["normal_pitch"],
        outer_normal_backlash=places[2]["normal_backlash"],
        clearance_change=places[0]["clearance_change"],
        involute_cone_distance=involute["involute_cone_distance"],
        **members,
    )


def _at(blank: BevelBlank, place: str) -> Values:
    """Slot widths and thicknesses of the pair, with addenda and virtual pitch radii of both members, at one place."""
    pair = {key: value for key, value in asdict(blank).items() if isinstance(value, float)}
    pair |= {"cone_distance": pair[f"{place}_cone_distance"], "spiral_angle": pair[f"{place}_spiral_angle"]}
    pair["slot_rotation_factor"] = ROTATION[blank.process]
    for member in ("pinion", "wheel"):
        own: MemberBlank = getattr(blank, member)
        for name in ("mean_dedendum", "dedendum_angle", "mean_normal_thickness"):
            pair[f"{member}_{name}"] = getattr(own, name)
        pair[f"{member}_addendum_here"] = getattr(own, f"{place}_addendum")
        pair[f"{member}_dedendum_here"] = getattr(own, f"{place}_dedendum")
        gear = evaluate("virtual_gear", pair, pitch_angle=own.pitch_angle)
        pair[f"{member}_virtual_pitch_radius"] = gear["virtual_pitch_radius"]
    return pair | evaluate("slot_widths", pair)


def _member(blank: BevelBlank, member: str, places: list[Values], blade_flat: float, mutilation: float) -> MemberSlots:
    mate = "wheel" if member == "pinion" else "pinion"
    lands = [evaluate("top_land", place, **_of(place, member))["top_land"] for place in places]
    widths = _triple(place[f"{member}_slot_width"] for place in places)
    toe = places[0]
    faced = {
        "mate_virtual_pitch_radius": toe[f"{mate}_virtual_pitch_radius"],
        "mate_addendum_here": toe[f"{mate}_addendum_here"],
    }
    blade = {"minimum_slot_width": min(widths), "blade_flat": blade_flat, "mutilation": mutilation}
    flanks = []
    for angle in (blank.pressure_angle_drive, blank.pressure_angle_coast):
        flank = {"flank_pressure_angle": angle}
        limits = evaluate("running_interference", toe, **_of(toe, member), **faced, **flank)
        flanks.append(limits | evaluate("edge_radii", {**blade, **flank}))
    least = {name: min(flank[name] for flank in flanks) for name in flanks[0]}
    return MemberSlots(
        slot_width=widths,
        normal_thickness=_triple(place[f"{member}_normal_thickness"] for place in places),
        top_land=_triple(lands),
        **{name: least[name] for name in least if name.startswith(("blade", "edge"))},
    )


def _of(place: Values, member: str) -> Values:
    """What the member's own formulas call by a name without the member."""
    names = ("virtual_pitch_radius", "addendum_here", "dedendum_here", "normal_thickness")
    return {name: place[f"{member}_{name}"] for name in names}


def _triple(values: Iterable[float]) -> Triple:
    inner, mean, outer = values
    return inner, mean, outer

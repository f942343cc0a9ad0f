"""The cutter as the annular body it is: outer and inner blade with their sections, rounded edges and the tip between.

A blade with Toprem is the union of two bodies: the Toprem cone from the tip up, and the main section from the Toprem's
height up. Everything else is one body.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearmath.bevel.generation import Section
from gearmath.bevel.method import blade_sections
from gearmath.bevel.ridge import opposite, other_side, point_width
from gearmath.bevel.root import tip_radius
from gearmath.bevel.tooth import ToothSpace
from gearmath.specs.bevel_set import FLANKS, SIDES, Flank, Member

#: Stands for a blade that is not there. [mm]
_AWAY = 1e4


@dataclass(frozen=True)
class CutterProfile:
    """One blade: the cone at its flank, the arc that touches the cone, and the rounded edge. mm, rad.

    ``edge_center`` is the radius of the edge's centre, ``joint`` the angle of the normal where edge and flank join.
    """

    point_radius: float
    pressure_angle: float
    curvature: float = 0.0
    reference_height: float = 0.0
    edge_center: float = math.nan
    edge_radius: float = 0.0
    joint: float = math.nan

    @property
    def vector(self) -> np.ndarray:
        """As ``notation.outer_blade`` (7,); a blade without an edge radius has its edge at the point radius."""
        center = self.point_radius if math.isnan(self.edge_center) else self.edge_center
        joint = self.pressure_angle if math.isnan(self.joint) else self.joint
        return np.array(
            [
                self.point_radius,
                self.pressure_angle,
                self.curvature,
                self.reference_height,
                center,
                self.edge_radius,
                joint,
            ]
        )

    def raised(self, height: float, side: int) -> CutterProfile:
        """The blade from a height up: without the edge below it."""
        radius = self.point_radius + side * height * math.tan(self.pressure_angle)
        return CutterProfile(radius, self.pressure_angle, self.curvature, self.reference_height - height)

    def enclosing_radius(self, side: int, height: float) -> float:
        """Point radius of the parallel cone that holds all of a hollow blade up to a height above the tip."""
        bow = max(0.0, -self.curvature) / 2 * max(abs(self.reference_height), abs(height - self.reference_height)) ** 2
        return self.point_radius + side * bow / math.cos(self.pressure_angle)


@dataclass(frozen=True)
class Body:
    """An annulus whose tip plane stands ``base`` [mm] above that of the cutter."""

    base: float
    outer: CutterProfile
    inner: CutterProfile
    height: float

    @property
    def annulus(self) -> np.ndarray:
        """Sharp cones that hold the body (4,): point radius and slope of the outer blade, then of the inner one."""
        return np.array(
            [
                self.outer.enclosing_radius(1, self.height),
                math.tan(self.outer.pressure_angle),
                self.inner.enclosing_radius(-1, self.height),
                math.tan(self.inner.pressure_angle),
            ]
        )

    @property
    def sharp(self) -> bool:
        """Whether the cones are all there is."""
        return all(p.curvature == 0.0 and p.edge_radius == 0.0 for p in (self.outer, self.inner))


@dataclass(frozen=True)
class Cutter:
    """All that one tool sweeps in a turn; ``height`` [mm] of the blades above the tip plane, where the head begins."""

    bodies: tuple[Body, ...]
    height: float

    @property
    def tip_radius(self) -> float:
        """Radius [mm] of the outer blade at the tip."""
        return self.bodies[0].outer.point_radius

    def shifted(self, radius: float) -> Cutter:
        """The cutter of a diameter that is larger by twice ``radius`` [mm]."""
        bodies = tuple(
            replace(body, outer=_moved(body.outer, radius), inner=_moved(body.inner, radius)) for body in self.bodies
        )
        return replace(self, bodies=bodies)


def one_blade(point_radius: float, pressure_angle: float, side: int, height: float = 60.0) -> Cutter:
    """A cutter that is one infinite cone: the other blade is out of reach."""
    blade = CutterProfile(point_radius, pressure_angle)
    outer, inner = (blade, CutterProfile(0.0, 0.1)) if side == 1 else (CutterProfile(_AWAY, 0.1), blade)
    return Cutter((Body(0.0, outer, inner, height),), height)


def cutter_of(member: Member, flanks: tuple[str, ...], space: ToothSpace | None, edge_radius: float = 0.0) -> Cutter:
    """The tool that cuts ``flanks`` of a member. ``edge_radius`` [mm] is given to blades that state none.

    A completing cutter has a blade for each flank. A fixed-setting cutter has the other flank's pressure angle on its
    other side, at the blade point width of the flank, or where none is stated at the one chosen for the slot of
    ``space``; without a space, that side is out of reach.
    """
    own = {flank: member.flank(flank) for flank in flanks}
    base = min(spec.blade_tip_height for spec in own.values())
    own = {flank: _from_tip(spec, SIDES[flank]) for flank, spec in own.items()}
    height = max(spec.blade_profile_height for spec in own.values())
    if len(flanks) == 1 and space is None:
        spec = own[flanks[0]]
        angle = spec.alpha
        return one_blade(spec.blade_point_radius, angle, SIDES[flanks[0]], spec.blade_profile_height)
    if len(flanks) == 1 and space is not None:
        (flank,) = flanks
        own[opposite(flank)] = other_side(member, flank, point_width(member, flank, space.slots[flank]))
    sections = {flank: blade_sections(_edged(_as_cut(spec), edge_radius), SIDES[flank]) for flank, spec in own.items()}
    toprem = max(sections[flank]["toprem"].upper if "toprem" in sections[flank] else 0.0 for flank in own)
    lowest = [_profile(sections[flank], own[flank], SIDES[flank]) for flank in FLANKS]
    bodies = [Body(base, lowest[0], lowest[1], height)]
    if toprem > 0.0:
        mains = [
            _profile({"main": sections[flank]["main"]}, own[flank], SIDES[flank]).raised(toprem, SIDES[flank])
            for flank in FLANKS
        ]
        bodies.append(Body(toprem, mains[0], mains[1], height - toprem))
    return Cutter(tuple(bodies), height)


def _from_tip(spec: Flank, side: int) -> Flank:
    """A blade whose tip has a height, with that as its plane: all bodies of a cutter begin at its lowest tip."""
    height = spec.blade_tip_height
    if height == 0.0:
        return spec
    values = {"blade_point_radius": tip_radius(spec, side), "blade_tip_height": 0.0}
    return spec.model_copy(update=values | {"blade_reference_height": spec.blade_reference_height - height})


def _as_cut(spec: Flank) -> Flank:
    """The blade as it is, not as its nominal flank wants it."""
    return spec.model_copy(update={"design": None})


def _edged(spec: Flank, radius: float) -> Flank:
    return spec.model_copy(update={"blade_edge_radius": radius}) if spec.blade_edge_radius == 0.0 else spec


def _profile(sections: dict[str, Section], spec: Flank, side: int) -> CutterProfile:
    """The lowest section of a blade with its edge."""
    lowest = next(section for name, section in sections.items() if name != "edge")
    edge = sections.get("edge")
    rounded = {}
    if edge is not None and edge.arc is not None:
        rounded = {"edge_center": edge.arc[0], "edge_radius": edge.arc[2], "joint": edge.lower}
    if lowest.arc is None:
        return CutterProfile(lowest.point_radius, lowest.pressure_angle, **rounded)
    return CutterProfile(
        spec.blade_point_radius,
        spec.alpha,
        1 / lowest.arc[2],
        spec.blade_reference_height,
        **rounded,
    )


def _moved(profile: CutterProfile, by: float) -> CutterProfile:
    return replace(profile, point_radius=profile.point_radius + by, edge_center=profile.edge_center + by)

"""One whole tooth space: both flanks from tip to root with their fillets, what bounds them, and what is wrong.

A column of the surface lies on a line of constant cone distance r in the axial plane, z_w cos δ + r_w sin δ = r; its
rows follow the blade from the tip of the tooth down to the tip plane of the cutter: main section, Toprem, rounded edge.
The root between the two fillets is ruled.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearmath.bevel.generation import Section, SurfacePoints, solve_curve
from gearmath.bevel.method import nominal_cut
from gearmath.bevel.root import ENDS, Widths, mean_place, root_trace, root_widths, slot_widths
from gearmath.bevel.turning import half_turn
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.remembered import remembered
from gearmath.shown import Shown, Shows
from gearmath.specs.bevel_set import FLANKS, Flank, Member

#: A blade without edge radius is taken to have this one: no edge that cuts is sharper. [mm]
SHARP_EDGE = 0.02
DEFAULT_COLUMNS = 25
#: Rows of the parts of a blade that cut a flank.
_ROWS = (("main", 17), ("toprem", 5), ("edge", 9))


@dataclass(frozen=True)
class SpaceFlank:
    """One flank of space 0, rows tip to root, columns toe to heel: points and outward normals (rows, columns, 3).

    ``section`` (rows,) names the part of the blade that cuts a row, ``sense`` (rows, columns) changes its sign where
    the surface folds back on itself: there it is undercut.
    """

    flank: str
    point: np.ndarray
    normal: np.ndarray
    section: tuple[str, ...]
    sense: np.ndarray

    @property
    def lower_limit(self) -> np.ndarray:
        """The last row (columns, 3) that the main section cuts: the lower limit of the usable flank."""
        return self.point[max(k for k, name in enumerate(self.section) if name == "main")]

    @property
    def undercut(self) -> np.ndarray:
        """Which points (rows, columns) of the flank proper lie beyond a singular line."""
        proper = np.array([name != "edge" for name in self.section])
        reference = np.sign(self.sense[0, self.sense.shape[1] // 2])
        return proper[:, None] & (np.sign(self.sense) != reference)


@dataclass(frozen=True, repr=False)
class ToothSpace(Shown):
    """Space 0 of a member: both flanks, with the same number of rows and columns, and the member's pitch [rad].

    ``root`` are the widths of its root between the corners of the blades, ``slots`` the slot widths by the flank at
    whose settings a cutter would leave it.
    """

    concave: SpaceFlank
    convex: SpaceFlank
    pitch: float
    root: Widths
    slots: dict[str, Widths]

    def width(self, row: int) -> np.ndarray:
        """Angle (columns,) [rad] between the flanks, from the one that lies lower about z_w to the other."""
        low, high = self.ordered
        return half_turn(_angle(high.point[row]) - _angle(low.point[row]))

    @property
    def ordered(self) -> tuple[SpaceFlank, SpaceFlank]:
        """The flanks in the order of their angle about z_w, across the space."""
        middle = self.concave.point.shape[1] // 2
        turn = half_turn(_angle(self.convex.point[0, middle]) - _angle(self.concave.point[0, middle]))
        return (self.concave, self.convex) if turn > 0 else (self.convex, self.concave)

    @property
    def top_land(self) -> np.ndarray:
        """Transverse arc (columns,) [mm] that the space leaves of the tip; zero or less where the tooth is pointed."""
        low, _ = self.ordered
        return np.hypot(low.point[0, :, 0], low.point[0, :, 1]) * (self.pitch - self.width(0))

    def _shown(self) -> tuple[str, list[Shows]]:
        rows, columns, _ = self.concave.point.shape
        figures: list[Shows] = [("rows", rows, ""), ("columns", columns, "")]
        return "tooth space", [*figures, ("root width at the mean", self.root.mean, "mm")]


@remembered(16)
def tooth_space(
    member: Member, columns: int = DEFAULT_COLUMNS, rows: tuple[tuple[str, int], ...] = _ROWS
) -> ToothSpace:
    """Space 0 of a member, whatever the method that cuts it; ``rows`` by part of the blade.

    Raises InputError naming member, flank, section, row and column of the first point without a solution.
    """
    surfaces = [flank_surface(member, flank, columns, rows) for flank in FLANKS]
    root, slots = space_widths(member)
    return ToothSpace(surfaces[0], surfaces[1], 2 * math.pi / member.teeth, root, slots)


def space_widths(member: Member) -> tuple[Widths, dict[str, Widths]]:
    """Widths of the root of space 0, and slot widths by flank. Raises InputError naming member and flank."""
    cuts = {flank: nominal_cut(member, flank) for flank in FLANKS}
    starts, traces = {}, {}
    for flank, by in cuts.items():
        starts[flank] = by.at(*mean_place(member)).contact
        found = root_trace(member, flank, by.how, starts[flank])
        if not found.converged[ENDS[0] : ENDS[-1] + 1].all():
            raise InputError(
                f"{member.name} {flank} flank: the tip of the blade does not reach the root from toe to heel"
            )
        traces[flank] = np.where(found.converged[:, None], found.point, np.nan)
    slots = {}
    for flank, mate in zip(FLANKS, reversed(FLANKS), strict=True):
        slots[flank] = slot_widths(member, flank, cuts[flank].how, starts[flank], traces[flank], traces[mate])
    return root_widths(member, *traces.values()), slots


def flank_surface(
    member: Member, flank: str, columns: int = DEFAULT_COLUMNS, rows: tuple[tuple[str, int], ...] = _ROWS
) -> SpaceFlank:
    """One flank of space 0 from the face cone to the bottom of its fillet."""
    by = nominal_cut(member.model_copy(update={flank: sharp_edged(member.flank(flank))}), flank)
    across = np.linspace(0.0, 1.0, columns)
    delta = member.blank.delta
    direction = (math.cos(delta), math.sin(delta))
    axial, radial = kernel("flank_place")(member.blank.vector, across, np.ones(columns))
    distance = axial * direction[0] + radial * direction[1]
    tip = by.at(axial, radial)
    _check(tip, member.name, flank, "main", 1, columns)
    start, top = tip.contact, tip.contact[:, 0]
    points: list[SurfacePoints] = []
    names: list[str] = []
    for part in reversed(by.sections):
        section = by.sections[part]
        first, last = _ends(section, top if part == "main" else None, columns)
        count = dict(rows)[part]
        for fraction in np.linspace(0.0, 1.0, count)[0 if part == "main" else 1 :]:
            u = first + fraction * (last - first)
            if part == "edge" and section.arc is not None:
                start = np.column_stack([u, start[:, 1:]])
            row = solve_curve(by.how, section, u, direction, distance, np.column_stack([u, start[:, 1:]]))
            _check(row, member.name, flank, part, len(points), columns)
            points.append(row)
            names.append(part)
            start = row.contact
    stack = [np.stack([getattr(row, field) for row in points]) for field in ("point", "normal", "sense")]
    return SpaceFlank(flank, stack[0], stack[1], tuple(names), stack[2])


def space_figures(member: Member, space: ToothSpace) -> dict[str, float]:
    """Thickness, top land and faults of a member's teeth, in mm and numbers of points, names as in the JSON.

    Thicknesses are transverse arcs, found on the surfaces themselves: ``mean_`` at the mean point of the pitch cone,
    ``reference_`` at the middle of the grid of flank files, where a measured member is evaluated.
    """
    land = space.top_land
    axial, radial = kernel("flank_place")(member.blank.vector, 0.5, 0.5)
    return {
        "mean_transverse_tooth_thickness_mm": mean_tooth_thickness(member),
        "reference_transverse_tooth_thickness_mm": tooth_thickness(member, float(axial), float(radial)),
        "reference_radius_mm": float(radial),
        "mean_transverse_pitch_mm": mean_pitch_radius(member) * space.pitch,
        "root_width_toe_mm": space.root.toe,
        "root_width_mean_mm": space.root.mean,
        "root_width_heel_mm": space.root.heel,
        "top_land_toe_mm": float(land[0]),
        "top_land_mean_mm": float(land[len(land) // 2]),
        "top_land_heel_mm": float(land[-1]),
        "pointed_columns": float((land <= 0).sum()),
        "undercut_points": float(space.concave.undercut.sum() + space.convex.undercut.sum()),
    }


def mean_pitch_radius(member: Member) -> float:
    """Radius [mm] of the mean point of the pitch cone."""
    return member.blank.mean_cone_distance * math.sin(member.blank.delta)


def mean_tooth_thickness(member: Member) -> float:
    """Transverse arc [mm] of the tooth at the mean point of the pitch cone."""
    axial = member.blank.mean_cone_distance * math.cos(member.blank.delta)
    return tooth_thickness(member, axial, mean_pitch_radius(member))


def tooth_thickness(member: Member, axial: float, radius: float) -> float:
    """Transverse arc [mm] of the tooth at a place on the blank, z_w and radius [mm]: the pitch less the space."""
    angles = []
    for flank in FLANKS:
        points = nominal_cut(member, flank).at(np.array([axial]), np.array([radius]))
        if not points.converged.all():
            raise InputError(f"{flank} flank: no point at z = {axial:.3f}, radius {radius:.3f} mm")
        angles.append(float(_angle(points.point)[0]))
    space = abs(float(half_turn(np.array(angles[1] - angles[0]))))
    return radius * (2 * math.pi / member.teeth - space)


def mean_backlash(pinion: Member, gear: Member) -> float:
    """Transverse backlash [mm] of a pair at the mean point: the pitch less both tooth thicknesses."""
    pitch = 2 * math.pi * mean_pitch_radius(gear) / gear.teeth
    return pitch - mean_tooth_thickness(pinion) - mean_tooth_thickness(gear)


def sharp_edged(spec: Flank) -> Flank:
    """The flank with the smallest edge radius that a blade has, where it states none."""
    return spec.model_copy(update={"blade_edge_radius": SHARP_EDGE}) if spec.blade_edge_radius == 0 else spec


def _ends(section: Section, top: np.ndarray | None, columns: int) -> tuple[np.ndarray, np.ndarray]:
    """Blade parameters (columns,) at the upper and the lower end of a section; ``top`` where the tooth ends first."""
    convex_arc = section.arc is not None and section.arc[2] > 0
    upper, lower = (section.lower, section.upper) if convex_arc else (section.upper, section.lower)
    return (np.full(columns, upper) if top is None else top), np.full(columns, lower)


def _check(points: SurfacePoints, name: str, flank: str, part: str, row: int, columns: int) -> None:
    lost = ~points.converged
    if lost.any():
        column = int(np.argmax(lost))
        raise InputError(
            f"{name} {flank} flank, {part} section, row {row}, column {column} of {columns}: the equation of meshing "
            "has no solution there"
        )


def _angle(points: np.ndarray) -> np.ndarray:
    return np.arctan2(points[..., 1], points[..., 0])

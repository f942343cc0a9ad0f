"""The blades of a face hobbing cutter one by one: the parts of their cutting edges, and where a line meets one.

A blade group has an outer and an inner blade, in the same direction or the inner one behind. The edge of each has its
main part, where there is one its Toprem, its rounding, and the tip, from there to a bit beyond the middle of the
width of the space, so that both tips together leave no ridge.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache

import casadi as ca
import numpy as np

from derivations import Quantity, notation
from gearmath.bevel.generation import Section
from gearmath.bevel.method import blade_sections
from gearmath.bevel.newton import newton_step
from gearmath.bevel.root import Widths, tip_radius
from gearmath.bevel.tip_room import tip_lengths
from gearmath.bevel.tooth import space_widths
from gearmath.engine.kernel import Kernel
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import FLANKS, SIDES, Flank, Member

NEWTON_STEPS = 6
#: Largest change of u [mm or rad], of the fraction of a block, and of the distance [mm] in one step.
_STEP_LIMITS = {False: (6.0, 0.15, 6.0), True: (0.5, 0.15, 6.0)}


@dataclass(frozen=True)
class Edge:
    """A part of the cutting edge of one blade, u from ``lower`` to ``upper``: ``shape`` is a straight_edge or an arc.

    ``part`` is that of :func:`blade_sections`, or ``tip``.

    ``tip_radius`` and ``offset`` [rad] are r_p and η of (17.2), ``side`` that of the blade, ``phase`` [rad] the angle
    about the cutter's axis from the outer blade of its group.
    """

    flank: str
    part: str
    lower: float
    upper: float
    shape: tuple[float, ...]
    tip_radius: float
    offset: float
    side: int
    phase: float = 0.0

    @property
    def is_arc(self) -> bool:
        return len(self.shape) == 3

    @property
    def middle(self) -> tuple[float, float, float]:
        """u, radius and height in the middle of the edge."""
        u = (self.lower + self.upper) / 2
        if self.is_arc:
            radius, height, r = self.shape
            return u, radius + self.side * r * math.cos(u), height - r * math.sin(u)
        radius, height, outwards, upwards = self.shape
        return u, radius + u * outwards, height + u * upwards

    @property
    def half_length(self) -> float:
        """Half the length of the edge [mm]: no point of it is farther from its middle."""
        across = 1.0 if not self.is_arc else abs(self.shape[2])
        slope = 1.0 if self.is_arc else math.hypot(*self.shape[2:])
        return (self.upper - self.lower) / 2 * across * slope

    def parameter(self, radius: np.ndarray, height: np.ndarray) -> np.ndarray:
        """Parameter (n,) of the edge's point nearest to places (n,) beside the cutter axis, within the edge."""
        if self.is_arc:
            center_radius, center_height, r = self.shape
            u = np.arctan2((center_height - height) / r, self.side * (radius - center_radius) / r)
        else:
            first, base, outwards, upwards = self.shape
            u = ((radius - first) * outwards + (height - base) * upwards) / (outwards**2 + upwards**2)
        return np.clip(u, self.lower, self.upper)

    @property
    def arguments(self) -> tuple[float | np.ndarray, ...]:
        """What the kernels take after the pivot offset: offset, r_p, and the shape (of an arc with its side)."""
        given = (self.offset, self.tip_radius, np.array(self.shape))
        return (*given, self.side) if self.is_arc else given


@dataclass(frozen=True)
class Blades:
    """All blades of a cutter: ``groups`` of them at equal angles, with these edges each."""

    groups: int
    teeth: int
    edges: tuple[Edge, ...]


def blades_of(member: Member, edge_radius: float = 0.0) -> Blades:
    """The blades of a face hobbed member as they are; ``edge_radius`` [mm] is given to blades that state none."""
    own = {flank: _as_cut(member.flank(flank), edge_radius) for flank in FLANKS}
    sections = {flank: blade_sections(own[flank], SIDES[flank]) for flank in FLANKS}
    phases = {"concave": 0.0, "convex": blade_phase(member)}
    lengths = tip_lengths(member.model_copy(update=own))
    edges: list[Edge] = []
    for flank in FLANKS:
        parts = [_edge(own[flank], flank, part, section) for part, section in sections[flank].items()]
        parts.append(_tip(own[flank], flank, next(iter(sections[flank].values())), lengths[flank]))
        edges += [replace(edge, phase=phases[flank]) for edge in parts]
    return Blades(member.blade_groups or 1, member.teeth, tuple(edges))


def blade_phase(member: Member) -> float:
    """The angle [rad] of the inner blades from the outer ones of their group: in it the work turns by what the work
    rotation offsets of the flanks differ in (10.2)."""
    if member.blade_groups is None:
        return 0.0
    turn = member.concave.rad("work_rotation_offset") - member.convex.rad("work_rotation_offset")
    return turn * member.teeth / (member.indexing_sign * member.blade_groups)


def slots_between(member: Member) -> dict[str, Widths]:
    """By flank the point width of a cutter that would leave the root between both blades: that of this cutter, or where
    it turns the work in between what the space shows."""
    if not blade_phase(member):
        width = tip_radius(member.concave, SIDES["concave"]) - tip_radius(member.convex, SIDES["convex"])
        return dict.fromkeys(FLANKS, Widths(width, width, width, width, width))
    return space_widths(member)[1]


def _as_cut(spec: Flank, edge_radius: float) -> Flank:
    rounded = spec.blade_edge_radius or edge_radius
    return spec.model_copy(update={"design": None, "blade_edge_radius": rounded})


def _edge(spec: Flank, flank: str, part: str, section: Section) -> Edge:
    side, offset = SIDES[flank], spec.rad("blade_offset_angle")
    line = (section.point_radius, 0.0, side * math.tan(section.pressure_angle), 1.0)
    shape = section.arc or line
    return Edge(flank, part, section.lower, section.upper, shape, spec.blade_point_radius, offset, side)


def _tip(spec: Flank, flank: str, lowest: Section, reach: float) -> Edge:
    """From where the rounding or the blade ends, at its tip, ``reach`` [mm] from its corner towards the other blade."""
    side, height = SIDES[flank], spec.blade_tip_height
    corner = tip_radius(spec, side)
    first = corner if lowest.arc is None else lowest.arc[0]
    last = corner - side * reach
    length = max(side * (first - last), 0.0)
    offset = spec.rad("blade_offset_angle")
    return Edge(flank, "tip", 0.0, length, (first, height, -float(side), 0.0), spec.blade_point_radius, offset, side)


def _quantities(is_arc: bool) -> tuple[Quantity, ...]:
    first, last = (
        Quantity(name, text, "mixed", name, shape=(5,), components=notation.axes.components)
        for name, text in (("axes_first", "axis positions at the start of the block"), ("axes_last", "at its end"))
    )
    turned = tuple(
        Quantity(name, text, "rad", name)
        for name, text in (
            ("C_first", "position of C at the start of the block, with the angle of the blade group"),
            ("C_last", "the same at its end"),
        )
    )
    guess = Quantity(
        "crossing_guess", "start values of u, fraction of the block and distance", "mixed", "w_0", shape=(3,)
    )
    given = _point(is_arc).inputs[3:]
    return (guess, first, last, *turned, *given, notation.line_point, notation.line_direction)


def _point(is_arc: bool) -> Kernel:
    return kernel("arc_edge_point" if is_arc else "straight_edge_point")


@cache
def crossing(is_arc: bool) -> Kernel:
    """Kernel: start values, a block, a blade and a line in; u, fraction and distance of their crossing out, and the
    size of the residual [mm].

    R_e(u, s) = p + t d at the fraction s of a straight block, whose ends are positions of all six axes.
    """
    quantities = _quantities(is_arc)
    _, *given = (ca.SX.sym(q.name, max(q.size, 1)) for q in quantities)
    a, b, first, last, *machine, p, d = given
    w = ca.SX.sym("w", 3)
    u, s, t = w[0], w[1], w[2]
    edge = _point(is_arc).function(u, a + s * (b - a), first + s * (last - first), *machine)
    residual = edge - (p + t * d)
    step = ca.Function("crossing_step", [w, *given], [newton_step(residual, w, _STEP_LIMITS[is_arc])])
    rest = ca.Function("crossing_rest", [w, *given], [ca.norm_2(residual)])
    start, *arguments = (ca.MX.sym(q.name, max(q.size, 1)) for q in quantities)
    solution = start
    for _ in range(NEWTON_STEPS):
        solution = step(solution, *arguments)
    found = Quantity("crossing", "u, fraction of the block and distance of the crossing", "mixed", "w", shape=(3,))
    left = Quantity("crossing_rest", "distance that is left between edge and line", "mm", "r")
    name = "arc_crossing" if is_arc else "straight_crossing"
    function = ca.Function(
        name,
        [start, *arguments],
        [solution, rest(solution, *arguments)],
        [q.name for q in quantities],
        ["crossing", "crossing_rest"],
    )
    return Kernel(
        function,
        f"Where the edge of one blade crosses a line within a block, {NEWTON_STEPS} damped Newton steps.",
        quantities,
        (found, left),
        "(17.2) of a straight block, against a line",
    )

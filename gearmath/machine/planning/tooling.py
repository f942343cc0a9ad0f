"""The cutters of a member as a tool presetter measures them, and how wide the point of a single-flank one may be."""

from __future__ import annotations

from dataclasses import dataclass

from gearmath.bevel.ridge import edge_taken, point_width
from gearmath.bevel.tooth import ToothSpace
from gearmath.machine.bodies.blades import slots_between
from gearmath.machine.bodies.cutter import cutter_of
from gearmath.machine.planning.path import Cut
from gearmath.specs.bevel_set import Flank, Member


@dataclass(frozen=True)
class PointWidth:
    """Between the tips of outer and inner blade [mm].

    A cutter for one flank has limits, the slot widths of the finished space: where its point is wider than the slot
    is at its narrowest, its other side cuts the other flank; where the flat of its tip is narrower than half of the
    slot at its widest, a ridge stays between two such cuts. ``stated`` tells whether the set has the width, or it was
    chosen.
    """

    width: float
    stated: bool
    least: float | None = None
    most: float | None = None

    @property
    def fault(self) -> str | None:
        """What the width would do, None where it is within its limits."""
        if self.least is None or self.most is None:
            return None
        if self.width < self.least:
            return f"a point width of {self.width:.3f} mm may leave a ridge: it is less than {self.least:.3f} mm"
        if self.width > self.most:
            return f"a point width of {self.width:.3f} mm cuts the other flank: it is more than {self.most:.3f} mm"
        return None


@dataclass(frozen=True)
class Tool:
    """One cutter: its blades by the flank that they cut, their height above the tips, and the width of its point."""

    name: str
    blades: dict[str, Flank]
    height: float
    point: PointWidth


def tools_of(member: Member, space: ToothSpace | None) -> tuple[Tool, ...]:
    """The cutters of a member; those for single flanks need the tooth ``space``."""
    found = []
    for cut in Cut.of(member):
        blades = {flank: member.flank(flank) for flank in cut.flanks}
        cutter = cutter_of(member, cut.flanks, space)
        if space is None:
            point = PointWidth(slots_between(member)["concave"].mean, True)
        else:
            ((flank, spec),) = blades.items()
            slot, stated = space.slots[flank], spec.blade_point_width is not None
            least = slot.most / 2 + edge_taken(member, flank)
            point = PointWidth(point_width(member, flank, slot), stated, least, slot.least)
        found.append(Tool(cut.tool, blades, cutter.height, point))
    return tuple(found)

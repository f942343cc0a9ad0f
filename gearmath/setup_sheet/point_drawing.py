"""The point of a cutter in the plane of its axis, to scale: both blades, as they are measured in a presetter."""

from __future__ import annotations

import math

from gearmath.machine.bodies.cutter import Cutter
from gearmath.setup_sheet.svg import LETTER, WIDTH, Drawing

#: Width of the steel at the upper end of the blades, and room for words above and below. [px]
_STEEL, _HIGHEST, _ABOVE, _BELOW = 100.0, 84.0, 8.0, 36.0


def point_drawing(cutter: Cutter) -> str:
    """As SVG: the cutter axis is far to the left, the work below. Rounded edges are not drawn, their radius is said."""
    body = cutter.bodies[0]
    outer, inner = body.outer, body.inner
    top_outer, top_inner = (
        blade.point_radius + side * cutter.height * math.tan(blade.pressure_angle)
        for blade, side in ((outer, 1), (inner, -1))
    )
    scale = min(_STEEL / (top_outer - top_inner), _HIGHEST / cutter.height)
    middle = (outer.point_radius + inner.point_radius) / 2
    drawing = Drawing(middle - WIDTH / 2 / scale, -_BELOW / scale, cutter.height, scale, (0.0, _ABOVE))
    drawing.outline(
        [(inner.point_radius, 0.0), (outer.point_radius, 0.0), (top_outer, cutter.height), (top_inner, cutter.height)],
        "blade",
    )
    level = -14.0 / scale
    for radius in (inner.point_radius, outer.point_radius):
        drawing.line((radius, 0.0), (radius, level - 4 / scale), "2 2")
    drawing.dimension("point width", (inner.point_radius, level), (outer.point_radius, level), "")
    width = outer.point_radius - inner.point_radius
    px, py = drawing.at(middle, level)
    drawing.words(px, py + LETTER + 4, f"point width {width:.3f}", "middle")
    right = max(top_outer, outer.point_radius) + 14 / scale
    drawing.dimension("blade height", (right, 0.0), (right, cutter.height), f"{cutter.height:g}")
    for blade, anchor, off in ((inner, "end", -1), (outer, "start", 1)):
        px, py = drawing.at(blade.point_radius, 0.0)
        place = px + off * (_STEEL / 2 + 8 if off < 0 else _STEEL / 2 + 46)
        rounded = f"edge {blade.edge_radius:g}" if blade.edge_radius else ""
        name = "inner" if off < 0 else "outer"
        for k, text in enumerate(
            (name, f"r {blade.point_radius:.4f}", f"{math.degrees(blade.pressure_angle):.3f}°", rounded)
        ):
            drawing.words(place, py - 58 + k * (LETTER + 3), text, anchor)
    ax, ay = drawing.at(drawing.left, 0.0)
    drawing.words(ax + 2, ay + 28, "← cutter axis")
    return drawing.svg

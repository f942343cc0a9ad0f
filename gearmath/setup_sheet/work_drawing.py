"""The work on its fixture in the plane of its axis, to scale, with the dimensions that are checked before it is cut."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from gearmath.machine.planning.setup_facts import BlankSizes
from gearmath.setup_sheet.silhouette import KINDS, silhouettes
from gearmath.setup_sheet.svg import LETTER, WIDTH, Drawing
from gearmath.specs.obstacles import Fixture

#: Room for the dimension lines below and above the work. [px]
_BELOW, _ABOVE = 112.0, 40.0


def work_drawing(sizes: BlankSizes, profiles: Mapping[str, np.ndarray], fixture: Fixture) -> str:
    """As SVG: the pitch apex at the left end, the axis level. ``profiles`` are those of the collision check."""
    points = np.vstack(list(profiles.values()))
    right, high = float(points[:, 0].max()), float(points[:, 1].max())
    left = min(0.0, float(points[:, 0].min()))
    scale = min((WIDTH - 26.0) / (right - left), 150.0 / high)
    drawing = Drawing(left, -high - _BELOW / scale, high, scale, (12.0, _ABOVE))
    for name, outline in silhouettes(profiles).items():
        drawing.outline(outline, KINDS[name])
    drawing.line((left, 0.0), (right + 8 / scale, 0.0), "10 3 2 3")
    crown, front = sizes.to_crown, sizes.to_front_crown
    outside = sizes.outside_diameter / 2
    for sign in (1.0, -1.0):
        drawing.line((0.0, 0.0), (crown, sign * crown * math.tan(sizes.delta)), "3 2")
    drawing.dot("pitch apex", 0.0, 0.0)
    px, py = drawing.at(0.0, 0.0)
    drawing.words(max(px - 4, 2.0), py - 9, "pitch apex")
    where = min(crown + 0.5 * (right - crown), right)
    drawing.line((crown, outside), (where, outside))
    drawing.line((crown, -outside), (where, -outside))
    drawing.dimension("outside diameter", (where, -outside), (where, outside), f"⌀ {sizes.outside_diameter:.3f}")
    end = sizes.back + fixture.shank_length + fixture.length
    rows = [
        ("pitch apex to toe tip", front, f"{front:.3f} tip at the toe"),
        ("pitch apex to crown", crown, f"{crown:.3f} crown"),
        ("pitch apex to back face", sizes.back, f"{sizes.back:.1f} back face, as checked"),
        ("pitch apex to end of fixture", end, f"{end:.1f} end of the fixture"),
    ]
    for k, (name, stop, text) in enumerate(rows):
        level = -high - (22.0 + 24.0 * k) / scale
        drawing.line((stop, 0.0), (stop, level - 3 / scale), "2 2")
        drawing.dimension(name, (0.0, level), (stop, level), text)
    drawing.line((0.0, 0.0), (0.0, -high - (25.0 + 24.0 * (len(rows) - 1)) / scale), "2 2")
    drawing.words(
        WIDTH / 2, LETTER + 2, f"face angle {sizes.face_angle:.4f}°, root angle {sizes.root_angle:.4f}°", "middle"
    )
    return drawing.svg

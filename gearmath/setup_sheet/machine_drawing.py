"""The machine from the front, to scale: spindle at its home, work at the B of the cut, and from where Z is counted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from gearmath.kernels import kernel
from gearmath.setup_sheet.silhouette import KINDS, silhouettes
from gearmath.setup_sheet.svg import LETTER, WIDTH, Drawing
from gearmath.specs.milling_machine import MillingMachine

#: Height of the drawing, room for words beside it and above it. [px]
_HEIGHT, _WORDS, _ABOVE = 560.0, 190.0, 10.0
#: What the end of a cutter is called.
CUTTER_TIP = "blade tips"
#: Of the spindle above the gauge line. [mm]
_SPINDLE = 40.0


@dataclass(frozen=True)
class DrawnRing:
    """A part of the tool about its axis, between two heights above the tip, with the radii there [mm]."""

    kind: str
    low: float
    high: float
    low_radius: float
    high_radius: float


def machine_drawing(
    machine: MillingMachine,
    profiles: Mapping[str, np.ndarray],
    tool: Sequence[DrawnRing],
    tool_length: float,
    tip: str,
    x: float,
    b: float,
) -> str:
    """As SVG. The spindle stands at X = ``x`` [mm] and at the home of Z, the work at B = ``b`` [rad].

    ``profiles`` are points (n,2) of z_w and radius about the work axis; the ``tool`` is ``tool_length`` mm long, to its
    ``tip``. Level with the B axis is y = 0.
    """
    gauge = machine.home - machine.gauge_line_height
    tips, zero = gauge - tool_length, -machine.gauge_line_height
    outlines = {name: _outline(machine, points, b) for name, points in silhouettes(profiles).items()}
    around = np.vstack(
        [
            *outlines.values(),
            [[x + part.high_radius, tips] for part in tool],
            [[x - part.high_radius, tips] for part in tool],
            [[0.0, zero]],
        ]
    )
    (left, bottom), right, top = around.min(axis=0), around[:, 0].max(), max(gauge + _SPINDLE, zero)
    scale = min((_HEIGHT - 2 * LETTER) / (top - bottom), (WIDTH - _WORDS) / (right - left))
    drawing = Drawing(left, bottom - LETTER / scale, top, scale, (6.0, _ABOVE))
    for name, points in outlines.items():
        drawing.outline(points, KINDS[name])
    _tool(drawing, tool, x, tips, gauge)
    ruler = right + 68.0 / scale
    levels = [(gauge, f"Z = {machine.home:g}, home"), (0.0, f"Z = {machine.gauge_line_height:g}"), (zero, "Z = 0")]
    for height, _ in levels:
        drawing.line((left, height), (ruler + 6 / scale, height), "5 3")
    drawing.line((ruler, bottom), (ruler, top))
    _labels(drawing, ruler, levels)
    where = right + 8.0 / scale
    drawing.dimension("C_t", (where, tips), (where, gauge), f"{_length_name(tip)} {tool_length:g}")
    drawing.dimension("tips above the B axis", (left + 14 / scale, 0.0), (left + 14 / scale, tips), f"tips {tips:g}")
    drawing.dimension("R_d", (ruler, zero), (ruler, 0.0), f"R_d {machine.gauge_line_height:g}")
    drawing.dot("B axis", 0.0, 0.0, 6.0, filled=False)
    apex = places_at(machine, np.zeros((1, 3)), b)[0]
    drawing.dot("pitch apex", float(apex[0]), float(apex[1]), 2.5)
    px, py = drawing.at(0.0, 0.0)
    drawing.words(px + 9, py + LETTER + 4, "B axis,")
    drawing.words(px + 9, py + 2 * LETTER + 6, "pitch apex")
    ax, ay = drawing.at(x, tips)
    drawing.words(ax, ay + LETTER + 2, tip, "middle")
    gx, gy = drawing.at(left, gauge)
    drawing.words(gx + 2, gy - 4, "gauge line")
    return drawing.svg


def _length_name(tip: str) -> str:
    return "C_t" if tip == CUTTER_TIP else "length"


def _labels(drawing: Drawing, ruler: float, levels: Sequence[tuple[float, str]]) -> None:
    """Words beside the levels [mm], no two over each other."""
    below = -np.inf
    for height, text in sorted(levels, reverse=True):
        px, py = drawing.at(ruler, height)
        below = max(py + LETTER / 3, below + LETTER + 1)
        drawing.words(px + 10, below, text)


def _tool(drawing: Drawing, tool: Sequence[DrawnRing], x: float, tips: float, gauge: float) -> None:
    """Tool and spindle, upright at X = ``x``."""
    widest = max(part.high_radius for part in tool)
    last = max(tool, key=lambda part: part.high)
    top, spindle = last.high, last.high_radius
    for part in tool:
        low, high = tips + part.low, tips + part.high
        drawing.outline(
            [
                (x - part.low_radius, low),
                (x + part.low_radius, low),
                (x + part.high_radius, high),
                (x - part.high_radius, high),
            ],
            part.kind,
        )
    drawing.outline(
        [
            (x - spindle, min(tips + top, gauge)),
            (x + spindle, min(tips + top, gauge)),
            (x + spindle, gauge + _SPINDLE),
            (x - spindle, gauge + _SPINDLE),
        ],
        "holder",
    )
    drawing.line((x - widest, gauge), (x + widest, gauge))


def _outline(machine: MillingMachine, outline: np.ndarray, b: float) -> np.ndarray:
    """An outline (n,2) of z_w and x_w as X and height over the B axis."""
    z, r = outline.T
    return places_at(machine, np.column_stack([r, np.zeros(len(r)), z]), b)


def places_at(machine: MillingMachine, points: np.ndarray, b: float) -> np.ndarray:
    """X and height over the B axis (n,2) of points (n,3) of the work at A = 0 (5.4)."""
    axes = np.tile([0.0, 0.0, 0.0, 0.0, b], (len(points), 1))
    (seen,) = kernel("seen_from_tool")(axes, points, 0.0, machine.pivot)
    return seen[:, [0, 2]]

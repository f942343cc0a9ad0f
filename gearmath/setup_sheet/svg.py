"""Drawings to scale as SVG: outlines and dimension lines in mm, words beside them in pixels."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import numpy as np

#: Width of every drawing, and the height of its letters: 8 pt and more where two drawings stand side by side on A4.
WIDTH, LETTER = 420.0, 14.0
_HEAD, _GAP = 7.0, 4.0
#: A letter is on the average this part of its height wide.
_LETTER_WIDTH = 0.55
_COLORS = {"work": "#dfe6ee", "teeth": "#9db6cf", "holder": "#ececec", "tool": "#f0d9b5", "blade": "#d08a2e"}


class Drawing:
    """Grows by one element after the other; ``scale`` is pixels per mm, x to the right and y up in mm."""

    def __init__(self, left: float, bottom: float, top: float, scale: float, margins: tuple[float, float]) -> None:
        """The place (left, bottom) [mm] is ``margins[0]`` px from the left end; ``margins[1]`` px are above ``top``."""
        self.scale = float(scale)
        self.left, self._top = left - margins[0] / scale, top + margins[1] / scale
        self.height = (self._top - bottom) * scale + margins[1]
        self._parts: list[str] = []

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Pixels of a place."""
        return (x - self.left) * self.scale, (self._top - y) * self.scale

    def outline(self, points: np.ndarray | Sequence[tuple[float, float]], kind: str) -> None:
        """A closed area of places [mm]; ``kind`` gives its color."""
        placed = " ".join("{:.2f},{:.2f}".format(*self.at(float(x), float(y))) for x, y in points)
        self._parts.append(
            f'<polygon class="{kind}" points="{placed}" fill="{_COLORS[kind]}" stroke="#444" stroke-width="0.8"/>'
        )

    def line(self, one: tuple[float, float], other: tuple[float, float], dashes: str = "") -> None:
        """A thin line between places [mm]."""
        (x1, y1), (x2, y2) = self.at(*one), self.at(*other)
        dashed = f' stroke-dasharray="{dashes}"' if dashes else ""
        self._parts.append(
            f'<line x1="{x1:.2f}" y1="{y1:.2f}" x2="{x2:.2f}" y2="{y2:.2f}" stroke="#444" stroke-width="0.8"{dashed}/>'
        )

    def dot(self, name: str, x: float, y: float, radius: float = 3.5, filled: bool = True) -> None:
        """A place that has a name."""
        px, py = self.at(x, y)
        fill = "#b3301a" if filled else "#fff"
        self._parts.append(
            f'<circle class="place" data-name="{escape(name)}" cx="{px:.2f}" cy="{py:.2f}" r="{radius}" '
            f'fill="{fill}" stroke="#b3301a" stroke-width="1.4"/>'
        )

    def words(self, px: float, py: float, text: str, anchor: str = "start") -> None:
        """Words at a place in pixels, which is the left or right end, or the middle, of their line."""
        if not text:
            return
        self._parts.append(
            f'<text x="{px:.2f}" y="{py:.2f}" font-size="{LETTER:g}" text-anchor="{anchor}" fill="#111" '
            f'stroke="#fff" stroke-width="3" paint-order="stroke">{escape(text)}</text>'
        )

    def dimension(self, name: str, one: tuple[float, float], other: tuple[float, float], text: str) -> None:
        """A dimension line, upright or level, between places [mm], with arrows, and the text at its middle.

        Where a level line is too short for that, the text stands behind it.
        """
        (x1, y1), (x2, y2) = self.at(*one), self.at(*other)
        upright = abs(x2 - x1) < abs(y2 - y1) or x1 == x2
        sign = np.sign((y2 - y1) if upright else (x2 - x1)) or 1.0
        arrows = []
        for x, y, s in ((x1, y1, sign), (x2, y2, -sign)):
            wings = (
                [(x - 2.5, y + s * _HEAD), (x + 2.5, y + s * _HEAD)]
                if upright
                else [(x + s * _HEAD, y - 2.5), (x + s * _HEAD, y + 2.5)]
            )
            arrows.append("M{:.2f},{:.2f}L{:.2f},{:.2f}L{:.2f},{:.2f}Z".format(x, y, *wings[0], *wings[1]))
        self._parts.append(
            f'<g class="dimension" data-name="{escape(name)}"><line x1="{x1:.2f}" y1="{y1:.2f}" x2="{x2:.2f}" '
            f'y2="{y2:.2f}" stroke="#b3301a" stroke-width="1"/><path d="{"".join(arrows)}" fill="#b3301a"/></g>'
        )
        if upright:
            self.words((x1 + x2) / 2 + _GAP, (y1 + y2) / 2 + LETTER / 3, text)
        elif abs(x2 - x1) < LETTER * len(text) * _LETTER_WIDTH + 4 * _HEAD:
            self.words(max(x1, x2) + _GAP, y1 + LETTER / 3, text)
        else:
            self.words((x1 + x2) / 2, y1 - _GAP, text, "middle")

    @property
    def svg(self) -> str:
        """The whole drawing."""
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {self.height:.1f}" '
            f'data-scale="{self.scale!r}" font-family="sans-serif">' + "\n".join(self._parts) + "</svg>"
        )

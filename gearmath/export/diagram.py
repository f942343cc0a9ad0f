"""Small parts of a wiring diagram: boxes, lines, text, supplies. One place for what schemdraw does by itself."""

from __future__ import annotations

import html
import re
from typing import Literal

from schemdraw import Drawing, elements

Point = tuple[float, float]
Align = Literal["left", "center", "right"]

TEXT, SMALL, TITLE = 11.0, 9.5, 13.0
#: schemdraw sets the text of a label so much above its place, and a centred one a little to the right of it.
_RAISED, _ASIDE = 0.2, 0.15


def box(drawing: Drawing, edges: Point, top: float, bottom: float, title: str, at: float | None = None) -> None:
    drawing.add(elements.Rect(corner1=(edges[0], top), corner2=(edges[1], bottom)).at((0, 0)).theta(0))
    middle = (top + bottom) / 2 if at is None else at
    text(drawing, ((edges[0] + edges[1]) / 2, middle), title, size=TITLE)


def line(drawing: Drawing, start: Point, end: Point) -> None:
    drawing.add(elements.Line().at(start).to(end))


def text(drawing: Drawing, at: Point, words: str, align: Align = "center", size: float = TEXT) -> None:
    """Words on one line, their middle (or their end) at a place. They must hold no sign of XML and no $."""
    label = elements.Label().at((at[0] - (_ASIDE if align == "center" else 0.0), at[1] - _RAISED)).theta(0)
    drawing.add(label.label(words, fontsize=size, halign=align, valign="center", loc="center", ofst=(0, 0)))


def small(drawing: Drawing, at: Point, words: str) -> None:
    text(drawing, at, words, size=SMALL)


def supply(drawing: Drawing, foot: Point, words: str, name: str = "", number: str = "") -> None:
    """A supply at the top of a box; ``name`` and ``number`` are those of the pin below."""
    drawing.add(elements.Vdd().at(foot).label(words, fontsize=TEXT))
    if name:
        text(drawing, (foot[0], foot[1] - 0.35), name)
    if number:
        small(drawing, (foot[0] - 0.25, foot[1] + 0.25), number)


def ground(drawing: Drawing, head: Point, name: str, number: str = "") -> None:
    pin_down(drawing, head, name, number)
    drawing.add(elements.Ground().at(head))


def pin_down(drawing: Drawing, head: Point, name: str, number: str = "") -> None:
    if name:
        text(drawing, (head[0], head[1] + 0.35), name, size=SMALL)
    if number:
        small(drawing, (head[0] + 0.45, head[1] - 0.15), number)


def titled(svg: str, name: str) -> str:
    """The SVG, an element a line and with short numbers, under a title: free text made harmless for XML."""
    short = re.sub(r"\d+\.\d{3,}", lambda number: f"{float(number[0]):.2f}", svg).replace("stroke-dasharray:-;", "")
    lines = re.sub(r"(?=<(?:path|text|circle|ellipse|rect|/svg)\b)", "\n", short)
    title = html.escape("".join(letter if letter.isprintable() else " " for letter in name))
    return re.sub(r"(<svg[^>]*>)", lambda start: f"{start[1]}\n<title>Wiring: {title}</title>", lines, count=1) + "\n"

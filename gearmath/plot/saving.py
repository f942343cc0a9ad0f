"""Figures as PNG, and as SVG for a page."""

from __future__ import annotations

import io
import re
from pathlib import Path

from matplotlib import rc_context
from matplotlib.figure import Figure

from gearmath.files import write_bytes


def png(figure: Figure) -> bytes:
    """A figure as PNG, the same bytes for the same figure."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=130, metadata={"Software": None})
    return stream.getvalue()


def svg(figure: Figure) -> str:
    """A figure as the element ``<svg>`` of an HTML page; its text stays text, and its width is that of its place."""
    stream = io.StringIO()
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "gearmath"}):
        figure.savefig(stream, format="svg", metadata={"Date": None})
    text = stream.getvalue()
    text = re.sub(r"<metadata>.*?</metadata>\s*", "", text[text.index("<svg") :], flags=re.DOTALL)
    text = re.sub(r'\sxmlns(:\w+)?="[^"]*"', "", text)
    for name in ("width", "height"):
        text = re.sub(rf'^<svg([^>]*?) {name}="[^"]*"', r"<svg\1", text)
    return text.strip()


def save(figure: Figure, path: Path) -> None:
    """Write a figure as PNG in one step."""
    write_bytes(path, png(figure))


def save_svg(figure: Figure, path: Path) -> None:
    """Write a figure as SVG in one step; the same bytes for the same figure."""
    stream = io.BytesIO()
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "gearmath"}):
        figure.savefig(stream, format="svg", metadata={"Date": None})
    write_bytes(path, stream.getvalue())

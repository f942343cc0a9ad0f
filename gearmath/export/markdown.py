"""Markdown as text: wrapped paragraphs, lists, tables, and free text that means nothing to it."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator

from gearmath.export.header import plain

_WIDTH = 110


def paragraph(text: str) -> Iterator[str]:
    """The lines of one paragraph, and the empty line behind it."""
    yield from textwrap.wrap(text, _WIDTH, break_long_words=False, break_on_hyphens=False)
    yield ""


def bullets(texts: Iterable[str], numbered: bool = False) -> Iterator[str]:
    """A list, and the empty line behind it."""
    for k, text in enumerate(texts, start=1):
        mark = f"{k}. " if numbered else "- "
        yield from textwrap.wrap(
            text,
            _WIDTH,
            initial_indent=mark,
            subsequent_indent=" " * len(mark),
            break_long_words=False,
            break_on_hyphens=False,
        )
    yield ""


def table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> Iterator[str]:
    """A table, and the empty line behind it."""
    yield "| " + " | ".join(head) + " |"
    yield "|" + "---|" * len(head)
    yield from ("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows)
    yield ""


def escaped(text: str) -> str:
    """Free text on one line, every sign that means something to Markdown or HTML made harmless."""
    line = plain(text).replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    return "".join(f"\\{letter}" if letter in "\\`*_{}[]#|~!$^" else letter for letter in line)

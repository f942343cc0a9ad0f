"""A self-contained HTML page that any browser shows, on paper of A4 and on a telephone: text, tables, drawings.

Whatever text comes from a file is escaped here; no caller writes markup. Drawings are SVG of this program.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from html import escape

_STYLE = """
:root { color-scheme: light }
body { font: 15px/1.45 system-ui, sans-serif; color: #1a1a1a; background: #fff;
  max-width: 66rem; margin: 1.5rem auto; padding: 0 1rem; overflow-wrap: break-word }
h1 { font-size: 1.5rem; margin: 0 0 .2rem }
h2 { font-size: 1.2rem; margin: 2rem 0 .6rem; border-bottom: 2px solid #1a1a1a }
h3 { font-size: 1rem; margin: 1.3rem 0 .3rem }
p { margin: .5rem 0 }
div.wide { overflow-x: auto }
table { border-collapse: collapse; margin: .6rem 0 1rem; font-variant-numeric: tabular-nums; font-size: .93rem }
caption { text-align: left; font-size: .87rem; color: #444; padding-bottom: .25rem }
th, td { padding: .12rem .7rem .12rem 0; border-bottom: 1px solid #ddd; text-align: left; vertical-align: top }
thead th { border-bottom: 1px solid #666; vertical-align: bottom }
td.number, th.number { text-align: right }
td.number, td.short { white-space: nowrap }
table.head { width: 100%; border: 1px solid #1a1a1a }
table.head th, table.head td { border: 1px solid #aaa; padding: .12rem .5rem }
table.head tbody th { width: 9rem; font-weight: normal; color: #444 }
table.head td { min-width: 6rem; height: 1.4em; overflow-wrap: anywhere }
.first { border: 2px solid #b3301a; padding: .3rem .8rem; margin: .8rem 0 }
.first h3 { margin: 0 } .first ul { margin: .2rem 0; padding-left: 1.2rem }
p.warning { border-left: 4px solid #b3301a; padding-left: .8rem }
div.charts { display: grid; grid-template-columns: 1fr; gap: .6rem 1.2rem }
figure { margin: .3rem 0; break-inside: avoid }
figure svg { display: block; width: 100%; height: auto; max-width: 34rem }
figure.whole { overflow-x: auto } figure.whole svg { min-width: 44rem; max-width: none }
figcaption { font-size: .87rem; color: #333; font-weight: 600 }
@media (min-width: 44rem) { div.charts { grid-template-columns: 1fr 1fr } }
@media (max-width: 32rem) { body { padding: 0 .6rem } table { font-size: .82rem } th, td { padding-right: .45rem } }
@page { size: A4; margin: 10mm }
@media print {
  html { font-size: 9.5pt }
  body { font-size: 1rem; line-height: 1.3; max-width: none; margin: 0; padding: 0; print-color-adjust: exact }
  h2, h3, caption { break-after: avoid } table, tr, .first { break-inside: avoid } div.wide { overflow: visible }
  div.columns { columns: 2; column-gap: 6mm; font-size: .85rem; line-height: 1.2 }
  div.columns h3:first-child { margin-top: 0 }
  div.columns table { font-size: .85rem; line-height: 1.15 } div.columns div.long table { break-inside: auto }
  div.columns th, div.columns td { padding: .05rem .25rem .05rem 0 }
  div.columns td:nth-child(-n+2):nth-last-child(-n+5) { white-space: nowrap }
  div.columns p { margin: .3rem 0 }
  h2.new { break-before: page } h2 { margin-top: 1rem } h3 { margin-top: .7rem }
  figure.whole svg { min-width: 0; max-width: 100%; max-height: 260mm }
  p + div.charts { break-before: avoid } div.charts { grid-template-columns: 1fr 1fr; gap: .2rem 5mm }
  div.small svg { max-width: 76mm }
  .first { font-size: .88rem; line-height: 1.2; margin: .4rem 0; padding: .1rem .6rem }
  div.columns div.charts { grid-template-columns: 1fr }
  table.head { margin: .2rem 0 } table.head th, table.head td { padding: .02rem .4rem; height: auto }
  table { margin: .3rem 0 .6rem }
}
"""


#: A table of more rows than this may go on in the next column or page of paper.
_LONG = 12
#: A cell of so many characters that begins with a number stays on one line.
_SHORT = 18


class Page:
    """Grows from top to bottom; ``html`` is the whole text."""

    def __init__(self, title: str) -> None:
        self._title = title
        self._parts = [f"<h1>{escape(title)}</h1>"]
        self._drawings = 0

    def heading(self, text: str, new_sheet: bool = False) -> None:
        """A section begins, on paper at the top of a sheet if ``new_sheet``."""
        opening = '<h2 class="new">' if new_sheet else "<h2>"
        self._parts.append(f"{opening}{escape(text)}</h2>")

    def subheading(self, text: str) -> None:
        """A part of a section begins."""
        self._parts.append(f"<h3>{escape(text)}</h3>")

    def paragraph(self, text: str, warning: bool = False) -> None:
        """A paragraph; a warning has a red bar beside it."""
        opening = '<p class="warning">' if warning else "<p>"
        self._parts.append(f"{opening}{escape(text)}</p>")

    @contextmanager
    def columns(self) -> Iterator[None]:
        """What is written meanwhile stands in two columns on paper."""
        self._parts.append('<div class="columns">')
        yield
        self._parts.append("</div>")

    def first(self, heading: str, sentences: Sequence[str]) -> None:
        """What is to be read before anything else, in a frame."""
        items = "\n".join(f"<li>{escape(sentence)}</li>" for sentence in sentences)
        self._parts.append(f'<div class="first"><h3>{escape(heading)}</h3>\n<ul>{items}</ul></div>')

    def head(self, columns: Sequence[str], rows: Sequence[tuple[str, Sequence[str]]]) -> None:
        """The block at the head of a sheet: a label and its value in each column; what is empty is left to fill in."""
        lines = []
        if len(columns) > 1:
            names = "".join(f"<th>{escape(column)}</th>" for column in ("", *columns))
            lines.append(f"<thead><tr>{names}</tr></thead>")
        for label, values in rows:
            cells = "".join(f"<td>{escape(value)}</td>" for value in values)
            lines.append(f"<tr><th>{escape(label)}</th>{cells}</tr>")
        self._parts.append('<table class="head">\n' + "\n".join(lines) + "\n</table>")

    def table(self, caption: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
        """A table; columns that hold numbers, or nothing, in every row stand to the right."""
        right = [len(rows) > 0 and all(_is_number(row[k]) for row in rows) for k in range(len(head))]
        top = f"<thead>{_row('th', head, right)}</thead>"
        cells = "\n".join(_row("td", row, right) for row in rows)
        wide = "wide long" if len(rows) > _LONG else "wide"
        self._parts.append(
            f'<div class="{wide}"><table><caption>{escape(caption)}</caption>\n{top}\n{cells}\n</table></div>'
        )

    def drawings(self, drawings: Sequence[tuple[str, str]], tall: bool = False, small: bool = False) -> None:
        """Drawings, (svg, caption) each, side by side where there is room; the caption stands above.

        If ``tall``, the others stand below each other beside the first; if ``small``, more of them fit on paper.
        """
        figures = [self._figure(svg, caption, "<figure>") for svg, caption in drawings]
        if tall:
            figures = [figures[0], "<div>" + "\n".join(figures[1:]) + "</div>"]
        kind = "charts small" if small else "charts"
        self._parts.append(f'<div class="{kind}">' + "\n".join(figures) + "</div>")

    def chart(self, svg: str, caption: str) -> None:
        """A drawing of many parts, as wide as the page; on a narrow screen it is moved across to stay legible."""
        self._parts.append(self._figure(svg, caption, '<figure class="whole" tabindex="0">'))

    def _figure(self, svg: str, caption: str, opening: str) -> str:
        self._drawings += 1
        named = f'<svg role="img" aria-label="{escape(caption)}"' + own_names(svg, f"d{self._drawings}-")[4:]
        return f"{opening}<figcaption>{escape(caption)}</figcaption>{named}</figure>"

    @property
    def html(self) -> str:
        """The whole page; nothing in it is fetched from elsewhere, and nothing runs."""
        policy = "default-src 'none'; img-src data:; style-src 'unsafe-inline'"
        return (
            '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
            f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
            '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            f"<title>{escape(self._title)}</title>\n<style>{_STYLE}</style>\n</head>\n<body>\n"
            + "\n".join(self._parts)
            + "\n</body>\n</html>\n"
        )


def own_names(svg: str, prefix: str) -> str:
    """A drawing whose names are of no other drawing of the page."""
    return re.sub(r'(\bid="|\bhref="#|url\(#)', rf"\g<1>{prefix}", svg)


def _row(tag: str, cells: Sequence[str], right: Sequence[bool]) -> str:
    marked = (
        f'<{tag} class="number">' if is_right else f'<{tag} class="short">' if _is_short(cell) else f"<{tag}>"
        for cell, is_right in zip(cells, right, strict=True)
    )
    return (
        "<tr>" + "".join(f"{open_}{escape(cell)}</{tag}>" for open_, cell in zip(marked, cells, strict=True)) + "</tr>"
    )


def _is_short(text: str) -> bool:
    """An interval, or a grade with its range: not to be broken at its blanks."""
    return len(text) <= _SHORT and text.lstrip("-")[:1].isdigit()


def _is_number(text: str) -> bool:
    try:
        float(text.replace("\N{MINUS SIGN}", "-"))
    except ValueError:
        return text == ""
    return True

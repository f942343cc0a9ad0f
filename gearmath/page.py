"""A self-contained HTML page: headings, paragraphs, tables and pictures in one file that any browser shows, or prints.

Whatever text comes from a file is escaped here; no caller writes markup.
"""

from __future__ import annotations

import base64
from collections.abc import Sequence
from html import escape

_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #222; background: #fff;
  max-width: 66rem; margin: 2rem auto; padding: 0 1rem }
h1 { font-size: 1.5rem } h2 { font-size: 1.15rem; margin-top: 2rem; border-bottom: 1px solid #ddd }
table { border-collapse: collapse; margin: 1rem 0; font-variant-numeric: tabular-nums }
caption { text-align: left; font-size: 0.9rem; color: #555; padding-bottom: 0.3rem }
th, td { padding: 0.15rem 0.8rem; border-bottom: 1px solid #e4e4e4; text-align: left }
th { border-bottom: 1px solid #888 } td.number, th.number { text-align: right }
figure { margin: 1rem 0 } img { max-width: 100% } figcaption { font-size: 0.9rem; color: #555 }
p.warning { border-left: 4px solid #c23b22; padding-left: 0.8rem }
@media print { h2 { break-after: avoid } figure, table { break-inside: avoid } }
"""


class Page:
    """Grows from top to bottom; ``html`` is the whole text."""

    def __init__(self, title: str) -> None:
        self._title = title
        self._parts = [f"<h1>{escape(title)}</h1>"]

    def heading(self, text: str) -> None:
        """A section begins."""
        self._parts.append(f"<h2>{escape(text)}</h2>")

    def paragraph(self, text: str, warning: bool = False) -> None:
        """A paragraph; a warning has a red bar beside it."""
        opening = '<p class="warning">' if warning else "<p>"
        self._parts.append(f"{opening}{escape(text)}</p>")

    def table(self, caption: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
        """A table; columns that hold numbers, or nothing, in every row stand to the right."""
        right = [len(rows) > 0 and all(_is_number(row[k]) for row in rows) for k in range(len(head))]
        cells = [_row("th", head, right), *(_row("td", row, right) for row in rows)]
        self._parts.append(f"<table><caption>{escape(caption)}</caption>\n" + "\n".join(cells) + "\n</table>")

    def picture(self, png: bytes, caption: str) -> None:
        """A PNG, held in the page itself."""
        data = base64.b64encode(png).decode("ascii")
        self._parts.append(
            f'<figure><img alt="{escape(caption)}" src="data:image/png;base64,{data}">'
            f"<figcaption>{escape(caption)}</figcaption></figure>"
        )

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


def _row(tag: str, cells: Sequence[str], right: Sequence[bool]) -> str:
    marked = (f'<{tag} class="number">' if is_right else f"<{tag}>" for is_right in right)
    return (
        "<tr>" + "".join(f"{open_}{escape(cell)}</{tag}>" for open_, cell in zip(marked, cells, strict=True)) + "</tr>"
    )


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return text == ""
    return True

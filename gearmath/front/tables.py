"""Tables of figures as Jupyter shows them."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence


def html_table(title: str, head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """An HTML table; every text is escaped, numbers stand to the right."""

    def cell(value: object) -> str:
        style = "" if isinstance(value, str) else ' style="text-align:right"'
        return f"<td{style}>{html.escape(f'{value:.6g}' if isinstance(value, float) else str(value))}</td>"

    lines = [f"<table><caption>{html.escape(title)}</caption>"]
    lines.append("<tr>" + "".join(f"<th>{html.escape(one)}</th>" for one in head) + "</tr>")
    lines += ["<tr>" + "".join(map(cell, row)) + "</tr>" for row in rows]
    return "\n".join((*lines, "</table>"))

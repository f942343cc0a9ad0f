"""How a record looks: one line where it is printed, a short table where Jupyter shows it."""

from __future__ import annotations

import html
import re
from collections.abc import Iterable, Sequence
from fractions import Fraction

#: A figure as it is shown: name, value, unit.
Shows = tuple[str, object, str]
#: Figures in the line of a record, and how long a line may be.
_IN_LINE, _LONGEST = 3, 200


class Shown:
    """A record that a call returns. It says what it is in ``_shown``, and its dataclass has ``repr=False``.

    A field may hold thousands of numbers, which nobody wants to read where a record is printed.
    """

    def _shown(self) -> tuple[str, list[Shows]]:
        """What it is, and its figures, those that matter most first."""
        raise NotImplementedError

    def __repr__(self) -> str:
        what, figures = self._shown()
        parts = [f"{name} {_text(value, 4)} {unit}".rstrip() for name, value, unit in figures[:_IN_LINE]]
        parts += ["..."] if len(figures) > _IN_LINE else []  # Jupyter's table has the others
        line = f"{type(self).__name__}: {', '.join((what, *parts))}"
        return f"<{line if len(line) <= _LONGEST - 2 else line[: _LONGEST - 5] + '...'}>"

    __str__ = __repr__

    def _repr_html_(self) -> str:
        what, figures = self._shown()
        return html_table(what, ["figure", "value", "unit"], figures)


def html_table(title: str, head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """An HTML table; every text is escaped, numbers have six digits and stand to the right, um are µm."""

    def cell(value: object) -> str:
        style = "" if isinstance(value, str | bool) else ' style="text-align:right"'
        return f"<td{style}>{_escaped(_text(value, 6))}</td>"

    lines = [f"<table><caption>{_escaped(title)}</caption>"]
    lines.append("<tr>" + "".join(f"<th>{_escaped(one)}</th>" for one in head) + "</tr>")
    lines += ["<tr>" + "".join(map(cell, row)) + "</tr>" for row in rows]
    return "\n".join((*lines, "</table>"))


def _text(value: object, digits: int) -> str:
    """A value as a person reads it; several with commas."""
    if isinstance(value, tuple | list):
        return ", ".join(_text(one, digits) for one in value)
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float | Fraction):
        return f"{float(value):.{digits}g}"
    return str(value)


def _escaped(text: str) -> str:
    """Micrometers as people write them; JSON, CSV and NC programs keep to ASCII."""
    return html.escape(re.sub(r"\bum\b", "µm", text))

"""DFQ files, read by a reader of its own that follows what the maker of the format publishes."""

from __future__ import annotations

import re
from datetime import datetime

from gearmath.exchange.dfq import Characteristic, DfqPart, Measured, dfq

PART = DfqPart("4711", "bevel pinion, 12 teeth", "machine 3", "probing")
FIGURES = (
    Characteristic("concave f_pt", "largest f_pt, concave flank", "µm", upper=12.0),
    Characteristic("convex mean", "mean, convex flank", "µm"),
    Characteristic("both F_r", "F_r, both flanks", "µm", upper=36.5, decimals=2),
)
TIMES = (datetime(2026, 11, 27, 10, 15, 0), datetime(2026, 11, 28, 9, 5, 59))


def read(content: bytes) -> tuple[dict[str, str], dict[int, dict[str, str]], list[list[tuple[float, int, datetime]]]]:
    """Fields of the part, fields of each characteristic, and the values, attributes and times of every part."""
    part: dict[str, str] = {}
    characteristics: dict[int, dict[str, str]] = {}
    values = []
    lines = content.decode("cp1252").split("\r\n")
    assert lines.pop() == ""
    for line in lines:
        field = re.fullmatch(r"(K\d{4})(?:/(\d+))? (.*)", line)
        if field and field[2]:
            characteristics.setdefault(int(field[2]), {})[field[1]] = field[3]
        elif field:
            part[field[1]] = field[3]
        else:
            cells = [cell.split("\x14") for cell in line.split("\x0f")]
            values.append([(float(v), int(a), datetime.strptime(t, "%d.%m.%Y/%H:%M:%S")) for v, a, t in cells])
    return part, characteristics, values


def test_a_reader_gets_back_names_limits_values_and_times() -> None:
    measured = [Measured(TIMES[0], (2.0184, -0.4331, 2.92)), Measured(TIMES[1], (1.541, 0.5, 36.5))]
    part, characteristics, values = read(dfq(PART, FIGURES, measured))
    assert part == {
        "K0100": "3",
        "K1001": "4711",
        "K1002": "bevel pinion, 12 teeth",
        "K1082": "machine 3",
        "K1086": "probing",
    }
    assert [one["K2001"] for one in characteristics.values()] == ["concave f_pt", "convex mean", "both F_r"]
    assert [one["K2142"] for one in characteristics.values()] == ["µm"] * 3
    assert [float(one["K2111"]) if "K2111" in one else None for one in characteristics.values()] == [12.0, None, 36.5]
    assert {one["K2004"] for one in characteristics.values()} == {"0"}
    assert values == [
        [(2.018, 0, TIMES[0]), (-0.433, 0, TIMES[0]), (2.92, 0, TIMES[0])],
        [(1.541, 0, TIMES[1]), (0.5, 0, TIMES[1]), (36.5, 0, TIMES[1])],
    ]


def test_a_figure_that_is_withheld_is_a_placeholder_and_no_value() -> None:
    _, _, values = read(dfq(PART, FIGURES, [Measured(TIMES[0], (None, 1.0, None))]))
    assert [attribute for _, attribute, _ in values[0]] == [255, 0, 255]


def test_no_text_breaks_the_lines_of_a_file_or_its_code_page() -> None:
    part = DfqPart("A\r\nK0001/1 99\x0f\x14", "☃" * 200, "Müller \N{GREEK SMALL LETTER MU}", "")
    content = dfq(part, FIGURES, [Measured(TIMES[0], (1.0, 2.0, 3.0))])
    read_part, characteristics, values = read(content)
    assert (len(characteristics), len(values)) == (3, 1)
    assert read_part["K1001"] == "A  K0001/1 99"
    assert read_part["K1002"] == "?" * 80
    assert read_part["K1082"] == "Müller ?"

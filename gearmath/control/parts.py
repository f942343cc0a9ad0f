"""The parts of a program, as R90 and R91 choose them: a point with all its touches, or a section of a calibration."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from itertools import groupby

from gearmath.errors import InputError

#: Touches up to the end of each section, in the text of a calibration program.
_SECTION_ENDS = re.compile(r"^(?:N\d+ )?UENDS\[\d+\]=(\d+)\s*$", re.MULTILINE)


def part_of(points: Mapping[int, tuple[str, ...]], text: str) -> dict[int, int]:
    """The part in which each of all ``points`` of a program is touched; points are told by where they are."""
    ends = [int(end) for end in _SECTION_ENDS.findall(text)]
    if ends:
        return {point: 1 + sum(end < point for end in ends) for point in points}
    found, part, before = {}, 0, None
    for point, place in points.items():
        part += place != before
        found[point], before = part, place
    return found


def stretches_of(points: Mapping[int, tuple[str, ...]], text: str, wanted: Sequence[int]) -> list[tuple[int, int]]:
    """First and last part (R90, R91) of each stretch of the points that are ``wanted``, as one NC start can make it;
    ``points`` are all of the program."""
    part = part_of(points, text)
    numbers = sorted({part[point] for point in wanted})
    rows = [list(each) for _, each in groupby(enumerate(numbers), lambda numbered: numbered[1] - numbered[0])]
    return [(row[0][1], row[-1][1]) for row in rows]


def last_in_a_row(points: Collection[int], missing: Sequence[int]) -> int:
    """The last point that follows the first one of ``missing`` without a gap; of all where none is missing."""
    last = missing[0] if missing else max(points)
    while last + 1 in points:
        last += 1
    return last


def base_of(points: Mapping[int, tuple[str, ...]], text: str, missing: Sequence[int]) -> int:
    """What R101 is in a start that makes the first of the ``missing`` points, until its first touch is offered: the
    point before the part of that touch. ``points`` are those of the run."""
    part, base = part_of(points, text), missing[0] - 1
    while part.get(base) == part[missing[0]]:
        base -= 1
    return base


def chosen_points(option: str, text: str, there: Collection[int]) -> list[int]:
    """The numbers in a text such as 3,17-20, each a point that is ``there``; an InputError names ``option``."""
    found: set[int] = set()
    for part in text.split(","):
        stretch = re.fullmatch(r"\s*(\d{1,9})\s*(?:-\s*(\d{1,9})\s*)?", part, re.ASCII)
        if stretch is None:
            raise InputError(
                f"{option} {text}: must be numbers and stretches with commas between them, such as 3,17-20"
            )
        first, last = int(stretch[1]), int(stretch[2] or stretch[1])
        if first not in there or last not in there or first > last:
            raise InputError(f"{option} {text}: {part.strip()}: must be within {min(there)} to {max(there)}")
        found.update(point for point in there if first <= point <= last)
    return sorted(found)

"""The parts of a program, as R90 and R91 choose them: a point with all its touches, or a section of a calibration."""

from __future__ import annotations

import re
from collections.abc import Mapping

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

"""What a probing or calibration program for LinuxCNC will offer: every touch stands in its text by itself."""

from __future__ import annotations

import re

from gearmath.errors import InputError
from gearmath.specs.touch_csv import CALIBRATION_COLUMNS, COLUMNS

_PART = re.compile(r"; (?:point|section) (\d+)\b")
_TOUCH = re.compile(r"\(LOG,%d#\d+,(\d+),(.*?),%\.\d+f#")
_COLUMNS = re.compile(r"\(LOG,(run,point,[A-Za-z,]+)\)")


def touches_of(text: str, program: str, first: int, last: int) -> tuple[tuple[str, ...], dict[int, tuple[str, ...]]]:
    """Columns of the result file, and for each touch of the parts from ``first`` to ``last`` (0, 0: all) its place.

    Raises InputError for a program that makes no touches, or has not these parts.
    """
    head = _COLUMNS.search(text)
    columns = tuple(head[1].split(",")) if head else ()
    if columns not in (COLUMNS, CALIBRATION_COLUMNS):
        raise InputError(f"{program}: offers no touches to a host: is it a program of 'nc probe' or 'nc calibrate'?")
    part, found = 0, {}
    for line in text.splitlines():
        if match := _PART.match(line):
            part = int(match[1])
        elif (match := _TOUCH.match(line)) and part >= first and (last == 0 or part <= last):
            found[int(match[1])] = tuple(match[2].split(","))
    if not (0 <= first <= part and (last == 0 or max(first, 1) <= last <= part) and found):
        raise InputError(f"{program}: has parts 1 to {part}, not {first} to {last}")
    return columns, found

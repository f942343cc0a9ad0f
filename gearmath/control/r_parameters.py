"""R parameters: which there are, which may be set, and how many are read or written in one go."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from gearmath.errors import InputError

#: Point offered, run, point acknowledged: those of the handshake.
_RESERVED = frozenset((101, 102, 103))
_LAST_PARAMETER = 999
#: R parameters of one array.
_ARRAY = 100
_LARGEST = 1e8


def parts_of(items: Sequence[Any], limit: int) -> list[Any]:
    """Items in parts of at most ``limit``; 0 for no limit."""
    size = limit or len(items) or 1
    return [items[k : k + size] for k in range(0, len(items), size)]


def groups_of(numbers: Sequence[int]) -> list[tuple[int, int]]:
    """Numbers as first and count of arrays."""
    groups: list[tuple[int, int]] = []
    for number in sorted(set(numbers)):
        if groups and groups[-1][0] + groups[-1][1] == number and groups[-1][1] < _ARRAY:
            groups[-1] = groups[-1][0], groups[-1][1] + 1
        else:
            groups.append((number, 1))
    return groups


def check_numbers(numbers: Sequence[int]) -> None:
    """Raises InputError for a number that no R parameter has."""
    for number in numbers:
        if not 0 <= number <= _LAST_PARAMETER:
            raise InputError(f"R{number}: R parameters go from 0 to {_LAST_PARAMETER}")


def check_values(values: Mapping[int, float]) -> None:
    """Raises InputError for numbers that there are not, for those of the handshake, and for values that none holds."""
    check_numbers(list(values))
    for number, value in values.items():
        if number in _RESERVED:
            raise InputError(f"R{number} belongs to the handshake: only a measuring run acknowledges")
        if not (math.isfinite(value) and abs(value) < _LARGEST):
            raise InputError(f"R{number} = {value}: must be a number between -{_LARGEST:g} and {_LARGEST:g}")

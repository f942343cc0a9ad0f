"""DFQ, the transfer format of quality data (AQDEF of Q-DAS, ISO/TR 11462-5): figures of parts with their tolerances.

A file is text of code page 1252 with CRLF: fields ``Knnnn value``, those of a characteristic ``Knnnn/i value``, then a
line a part with the values of all characteristics, 0x0F between them and 0x14 between value, attribute and time.

Published by the maker of the format, and followed here: meaning and length of K1001 K1002 K1082 K2001 K2002 K2004
K2022, the attributes 0 (valid) and 255 (placeholder), the form of time. Unconfirmed, for ISO/TR 11462-5 was not read:
that K2111 may stand without K2110 for a figure that has a largest value only, and the length of K2142.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime

_BETWEEN_CHARACTERISTICS, _WITHIN = "\x0f", "\x14"
_VALID, _NO_VALUE = 0, 255
#: Characters that the text of a field may have.
_LENGTHS = {"K1001": 30, "K1002": 80, "K1082": 40, "K1086": 40, "K2001": 40, "K2002": 80, "K2142": 20}
_VARIABLE = 0


@dataclass(frozen=True)
class Characteristic:
    """A figure that is judged: its ``number`` and ``name``, unit, nominal value, and what it may be at most."""

    number: str
    name: str
    unit: str
    nominal: float = 0.0
    upper: float | None = None
    decimals: int = 3


@dataclass(frozen=True)
class DfqPart:
    """What all values are of: number and description of the part, machine, operation."""

    number: str
    description: str
    machine: str
    operation: str


@dataclass(frozen=True)
class Measured:
    """The values of one part, in the order of the characteristics; None where a figure is withheld."""

    at: datetime
    values: tuple[float | None, ...]


def dfq(part: DfqPart, characteristics: Sequence[Characteristic], measured: Sequence[Measured]) -> bytes:
    """The bytes of a DFQ file. Characters that code page 1252 does not have become ``?``; long texts are cut."""
    lines = [*_head(part, characteristics), *(_values(one, characteristics) for one in measured)]
    return "".join(f"{line}\r\n" for line in lines).encode("cp1252", "replace")


def _head(part: DfqPart, characteristics: Sequence[Characteristic]) -> Iterator[str]:
    yield f"K0100 {len(characteristics)}"
    yield _text("K1001", part.number)
    yield _text("K1002", part.description)
    yield _text("K1082", part.machine)
    yield _text("K1086", part.operation)
    for k, one in enumerate(characteristics, 1):
        yield _text("K2001", one.number, k)
        yield _text("K2002", one.name, k)
        yield f"K2004/{k} {_VARIABLE}"
        yield f"K2022/{k} {one.decimals}"
        yield f"K2101/{k} {one.nominal:.{one.decimals}f}"
        if one.upper is not None:
            yield f"K2111/{k} {one.upper:.{one.decimals}f}"
        yield _text("K2142", one.unit, k)


def _text(key: str, text: str, characteristic: int | None = None) -> str:
    """A field of text: one line, no control characters."""
    plain = "".join(letter if letter.isprintable() else " " for letter in text)[: _LENGTHS[key]].strip()
    return f"{key}{'' if characteristic is None else f'/{characteristic}'} {plain}"


def _values(measured: Measured, characteristics: Sequence[Characteristic]) -> str:
    time = measured.at.strftime("%d.%m.%Y/%H:%M:%S")
    cells = []
    for value, one in zip(measured.values, characteristics, strict=True):
        attribute = _NO_VALUE if value is None else _VALID
        cells.append(f"{value or 0.0:.{one.decimals}f}{_WITHIN}{attribute}{_WITHIN}{time}")
    return _BETWEEN_CHARACTERISTICS.join(cells)

"""What the simulated control shows and takes under the names of its variables."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from gearmath.control import sinumerik
from gearmath.control.interface import AXES
from gearmath.control.simulated.nc import PARAMETERS, Nc

#: A name with its unit, first index and how many: [u1,10], [u1, 10], [10], [u1,1,#5]; [u1,1,5] counts to the last.
_NAME = re.compile(
    r"(?P<path>/[A-Za-z]+/[A-Za-z]+/[A-Za-z]+)"
    r"(?:\[\s*(?:u(?P<unit>\d{1,2})\s*,?\s*)?(?:(?P<first>\d{1,4})\s*(?:,\s*(?P<many>#?)(?P<last>\d{1,4})\s*)?)?\])?",
    re.ASCII,
)
_TEXT = {
    sinumerik.SELECTED: lambda nc: _selected(nc),
    sinumerik.RUNNING: lambda nc: _selected(nc) if nc.channel else "",
    sinumerik.MESSAGE: lambda nc: nc.message,
}
_WHOLE = {
    sinumerik.CHANNEL_STATE: lambda nc: nc.channel,
    sinumerik.PROGRAM_STATE: lambda nc: nc.program_state,
    sinumerik.MODE: lambda nc: nc.mode,
    sinumerik.LINE: lambda nc: nc.line,
    sinumerik.ALARM_COUNT: lambda nc: len(nc.alarms),
    sinumerik.LAST_ALARM: lambda nc: int(list(nc.alarms.values())[-1].number) if nc.alarms else 0,
    sinumerik.TOP_ALARM: lambda nc: int(next(iter(nc.alarms.values())).number) if nc.alarms else 0,
    sinumerik.ACCESS_LEVEL: lambda nc: 4,
}


@dataclass(frozen=True)
class Item:
    """One variable: its value is a float, a whole number, a text, or a list of floats."""

    read: Callable[[Nc], Any]
    write: Callable[[Nc, Any], object] | None = None


def item(name: str) -> Item | None:
    """The variable of a name in any of the spellings that the control takes; None where it has none."""
    if name == sinumerik.PROBE.text:
        return Item(lambda nc: int(nc.probe_deflected))
    match = _NAME.fullmatch(name)
    if match is None or (match["unit"] is not None and match["unit"] != "1"):
        return None
    path = match["path"]
    first = int(match["first"] or 1)
    if path.upper() == "/CHANNEL/PARAMETER/R":
        count = None if match["last"] is None else int(match["last"]) - (0 if match["many"] else first - 1)
        return _parameters(first, count) if match["first"] else None
    if path == _path(sinumerik.POSITION) or path == "/Channel/MachineAxis/actToolBasePos":
        count = None if match["last"] is None else int(match["last"]) - (0 if match["many"] else first - 1)
        return _positions(first, count)
    for table in (_TEXT, _WHOLE):
        for known, read in table.items():
            if path == _path(known):
                return Item(read)
    return None


def first_names() -> list[str]:
    """The names that browsing shows: the first element of every area."""
    singles = [name(channel=1) for name in (*_TEXT, *_WHOLE)]
    return [sinumerik.PARAMETER(channel=1, first=1), sinumerik.POSITION(axis=1), *singles]


def _path(name: sinumerik.Confirmed) -> str:
    return name.text.split("[")[0]


def _selected(nc: Nc) -> str:
    if not nc.selected:
        return ""
    stem, kind = nc.selected.rsplit("/", 1)[-1].rsplit(".", 1)
    return sinumerik.PROGRAM_PATH(stem=stem, kind=kind)


def _parameters(first: int, count: int | None) -> Item | None:
    numbers = range(first, first + (1 if count is None else count))
    if not numbers or numbers[-1] >= PARAMETERS:
        return None

    def write(nc: Nc, value: Any) -> None:
        values = value if isinstance(value, list) else [value]
        if len(values) != len(numbers):
            raise ValueError(f"{len(values)} values for {len(numbers)} R parameters")
        nc.write(dict(zip(numbers, map(float, values), strict=True)))

    if count is None:
        return Item(lambda nc: float(nc.parameters.get(first, 0.0)), write)
    return Item(lambda nc: [float(nc.parameters.get(k, 0.0)) for k in numbers], write)


def _positions(first: int, count: int | None) -> Item | None:
    last = first + (1 if count is None else count) - 1
    if not 1 <= first <= last <= len(AXES):
        return None
    if count is None:
        return Item(lambda nc: float(nc.position[first - 1]))
    return Item(lambda nc: [float(value) for value in nc.position[first - 1 : last]])

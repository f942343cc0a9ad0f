"""Whether the result file of a probing or calibration program says what its probe has met, line by line."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from gearmath.errors import counted
from gearmath.machine.judging.faults import Fault
from gearmath.machine.measuring.ways import Watched, Way
from gearmath.specs.touch_csv import CALIBRATION_COLUMNS, COLUMNS, planned_touches

#: A and B may be off by whole turns; positions are written with nine decimals. [mm, degree]
_SAME = 1e-6
_AXES = "XYZAB"
#: Lines before the touches of a whole run: its plan and the columns.
_HEAD = 2

#: What is wrong with the place that a line names, by its cells and the way of the touch; nothing where it is right.
Place = Callable[[dict[str, str], Way], str]


def touch_lines(text: str) -> list[dict[str, str]]:
    """The cells of the lines of touches in a result file, by column; none where it has no column line."""
    columns: tuple[str, ...] = ()
    found = []
    for line in text.splitlines():
        cells = tuple(line.split(","))
        if cells in (COLUMNS, CALIBRATION_COLUMNS):
            columns = cells
        elif columns and not line.startswith("#"):
            found.append(dict(zip(columns, cells, strict=False)))
    return found


def record_faults(text: str, seen: Watched, place: Place) -> Iterator[Fault]:
    """What the whole run writes, compared with where its touches were met."""
    files = [content for content in seen.run.files.values() if touch_lines(content)]
    if len(files) != 1:
        yield Fault(f"writes {len(files)} files of touches, must write one", kind="file")
        return
    lines, touches = touch_lines(files[0]), seen.touches
    if not len(lines) == len(touches) == planned_touches(text):
        planned = planned_touches(text)
        yield Fault(f"plans {counted(planned, 'touch')}, makes {len(touches)} and writes {len(lines)}", kind="count")
        return
    if len(files[0].splitlines()) != len(lines) + _HEAD:
        yield Fault("writes more or less into its file than plan, columns and touches", kind="head")
    for number, (cells, k) in enumerate(zip(lines, touches, strict=True), 1):
        line = int(seen.run.path.line[seen.measuring[k]])
        if (cells.get("run"), cells.get("point"), cells.get("triggered")) != ("1", str(number), "1"):
            yield Fault(
                f"is touch {number} of the run, and is not written so: {','.join(cells.values())}", line, "line"
            )
        elif not _right(cells, seen.ways[k]):
            yield Fault(f"is not written with the position at which the probe met it, as touch {number}", line, "value")
        elif wrong := place(cells, seen.ways[k]):
            yield Fault(f"is written as touch {number}: {wrong}", line, "place")


def _right(cells: dict[str, str], way: Way) -> bool:
    """Whether the position of a line is that of the touch."""
    if way.met is None:
        return False
    try:
        written = np.array([float(cells[axis]) for axis in _AXES])
    except (KeyError, ValueError):
        return False
    off = written - [*way.met[:3], *np.degrees(way.met[3:])]
    off[3:] -= 360.0 * np.round(off[3:] / 360.0)
    return bool((np.abs(off) < _SAME).all())

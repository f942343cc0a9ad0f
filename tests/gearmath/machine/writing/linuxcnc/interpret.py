"""What LinuxCNC's own interpreter makes of a program, as JSON: run by the Python that LinuxCNC was installed for.

python3 interpret.py PROGRAM.ngc PARAMETERS.var TOOL=LENGTH ...
"""

from __future__ import annotations

import ctypes
import json
import sys

import gcode

INCH = 25.4
NO_TOOL = (-1, *([0.0] * 12), 0)


class Canon:
    """Hears of every canonical command; lengths of the interpreter are inches."""

    def __init__(self, parameter_file: str, lengths: dict[int, float]) -> None:
        self.parameter_file, self.lengths = parameter_file, lengths
        self.line, self.tool, self.feed, self.moves, self.said = 0, 0, 0.0, [], []
        self.g5x, self.g92, self.length = [0.0] * 9, [0.0] * 9, [0.0] * 9

    def __getattr__(self, name: str):
        if name.startswith("__"):
            raise AttributeError(name)
        return lambda *values: None

    def next_line(self, state) -> None:
        self.line = state.sequence_number

    def get_external_length_units(self) -> float:
        return 1.0

    def get_external_angular_units(self) -> float:
        return 1.0

    def get_axis_mask(self) -> int:
        return 63

    def get_block_delete(self) -> bool:
        return False

    def check_abort(self) -> bool:
        return False

    def get_tool(self, pocket: int) -> tuple:
        if pocket == 0:
            return (self.tool, *NO_TOOL[1:]) if self.tool == 0 else self._data(self.tool)
        numbers = sorted(self.lengths)
        return self._data(numbers[pocket - 1]) if pocket <= len(numbers) else NO_TOOL

    def _data(self, number: int) -> tuple:
        return (number, 0.0, 0.0, self.lengths[number] / INCH, *([0.0] * 9), 0)

    def change_tool(self, pocket: int) -> None:
        self.tool = sorted(self.lengths)[pocket - 1] if pocket > 0 else 0

    def set_g5x_offset(self, index: int, *values: float) -> None:
        self.g5x = list(values)

    def set_g92_offset(self, *values: float) -> None:
        self.g92 = list(values)

    def tool_offset(self, *values: float) -> None:
        self.length = list(values)

    def set_feed_rate(self, feed: float) -> None:
        self.feed = feed

    def message(self, text: str) -> None:
        self.said.append(text)

    def straight_traverse(self, *values: float) -> None:
        self._move("rapid", values)

    def straight_feed(self, *values: float) -> None:
        self._move("feed", values)

    def straight_probe(self, *values: float) -> None:
        self._move("probe", values)

    def _move(self, kind: str, values: tuple) -> None:
        """Positions in machine coordinates of the gauge line: mm and degrees."""
        at = [v + a + b + c for v, a, b, c in zip(values, self.g5x, self.g92, self.length, strict=True)]
        self.moves.append([kind, self.line, self.tool, self.feed, *(v * INCH for v in at[:3]), *at[3:6]])


ctypes.CDLL("libtooldata.so.0")._Z14tool_mmap_userv()
canon = Canon(sys.argv[2], {int(k): float(v) for k, v in (one.split("=") for one in sys.argv[3:])})
result, line = gcode.parse(sys.argv[1], canon, "G21", "")
error = gcode.strerror(result) if result > gcode.MIN_ERROR else ""
json.dump({"moves": canon.moves, "said": canon.said, "error": error, "line": line}, sys.stdout)

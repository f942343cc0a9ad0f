"""What the tests of the control share: a run of a few touches whose positions are known by the number of the point."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from gearmath.control.interface import RunStart, Touch
from gearmath.control.store import MeasurementStore
from gearmath.specs.touch_csv import COLUMNS


@pytest.fixture
def touch() -> Callable[[int], Touch]:
    """The touch of a point: eight decimals, as a control gives them."""
    return lambda point: Touch(7, 101.23456789 + point, -12.3456789, 150.00012345, 12.0 * (point % 30), 45.0, 1.0)


@pytest.fixture
def start() -> Callable[..., RunStart]:
    """``start(points, **changes)``: what a run begins with: so many points, both flanks in turn, or those given."""

    def make(points: int | dict[int, tuple[str, ...]] = 8, **changes: object) -> RunStart:
        flanks = ("concave", "convex")
        if isinstance(points, int):
            points = {k + 1: ("gear", flanks[k % 2], str(k // 2), "2", "4") for k in range(points)}
        values: dict = {
            "control": "simulated control",
            "program": "PROBE.MPF",
            "program_text": b"; PROBE\nM30\n",
            "columns": COLUMNS,
            "points": points,
            "files": {"set.toml": b'title = "set"\n', "machine.toml": b'name = "machine"\n'},
            "settings": {"repeat": "1"},
            "operator": "operator",
        }
        return RunStart(**(values | changes))

    return make


@pytest.fixture
def store(tmp_path: Path) -> MeasurementStore:
    return MeasurementStore.open(tmp_path / "runs.db")

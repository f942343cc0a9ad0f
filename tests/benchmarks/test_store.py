"""A touch on the disk: the commit of the measurement store beside the one sync of a file that it cannot do without."""

from __future__ import annotations

import os
from collections.abc import Callable
from itertools import count
from pathlib import Path

import pytest

from gearmath.control.interface import RunStart, Touch
from gearmath.control.store import MeasurementStore
from gearmath.specs.touch_csv import CALIBRATION_COLUMNS

POINTS = 1000
TOUCH = Touch(1, 101.23456789, -12.3456789, 150.00012345, 12.0, 45.0, 1.0)


@pytest.fixture
def commit(tmp_path: Path) -> Callable[[], None]:
    points = dict.fromkeys(range(1, POINTS + 1), ("sphere",))
    run = MeasurementStore.open(tmp_path / "runs.db").begin_run(
        RunStart("bench", "P.MPF", b"M30", CALIBRATION_COLUMNS, points)
    )
    numbers = count(1)
    return lambda: run.commit_touch(next(numbers), TOUCH)


@pytest.fixture
def sync(tmp_path: Path) -> Callable[[], None]:
    file = os.open(tmp_path / "log", os.O_CREAT | os.O_WRONLY | os.O_APPEND)
    line = b"1,1,sphere,101.23456789,-12.3456789,150.00012345,12.0,45.0,1\n"

    def write() -> None:
        os.write(file, line)
        os.fsync(file)

    return write


@pytest.mark.benchmark(group="a touch on the disk")
@pytest.mark.parametrize("how", ["commit", "sync"])
def test_touch(benchmark: Callable, how: str, request: pytest.FixtureRequest) -> None:
    benchmark.pedantic(request.getfixturevalue(how), rounds=POINTS - 100, warmup_rounds=100)

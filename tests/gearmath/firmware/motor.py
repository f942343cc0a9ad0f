"""The program motor.c, and its trace replayed by a core elsewhere."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests.gearmath.firmware.conftest import EmulatedCore, core_files

QUICK = {
    "GM_ACCELERATION": 100_000,
    "GM_MOVE_ACCELERATION": 100_000,
    "GM_MOVE_MAX_RATE": 8000,
    "GM_MAX_STEP_RATE": 60_000,
    "GM_MAX_EDGE_RATE": 60_000,
    "GM_STEP_HIGH_TICKS": 1,
    "GM_STEP_LOW_TICKS": 1,
    "GM_DIR_SETUP_TICKS": 1,
    "GM_DIR_HOLD_TICKS": 1,
    "GM_HAS_ESTOP": 0,
    "GM_PROFILE_HOBBING": None,
    "GM_PROFILE_LATHE": 1,
}


@dataclass(frozen=True)
class Motor:
    """Microsteps, and the acceleration [steps/s^2] that it is to be given."""

    microsteps: int
    acceleration: int


MOTORS = (Motor(8, 100_000), Motor(4, 20_000))


def run_motor(
    gcc: str, folder: Path, motor: Motor, given: int, sequences: int, seed: int | None = None
) -> tuple[int, str]:
    """Status and words of motor.c, whose core is told to give ``given``; with a seed it writes a file ``trace``."""
    files = core_files(True, {**QUICK, "GM_ACCELERATION": given, "GM_MOVE_ACCELERATION": given})
    files["motor.c"] = (Path(__file__).parent / "motor.c").read_text("utf-8")
    for name, text in files.items():
        (folder / name).write_text(text, "utf-8")
    names = {"MICROSTEPS": motor.microsteps, "MARGIN": 4.0, "ABRUPT_MARGIN": 6.2}
    names |= {
        "ACCELERATION": float(motor.acceleration),
        "SEQUENCES": sequences,
        "SEED": f"{1 if seed is None else seed}u",
    }
    if seed is not None:
        names["TRACE"] = '"trace"'
    defines = [f"-D{name}={value}" for name, value in names.items()]
    sources = [name for name in files if name.endswith(".c")]
    subprocess.run([gcc, "-std=gnu99", "-O2", *defines, *sources, "-o", "motor", "-lm"], cwd=folder, check=True)
    done = subprocess.run(["./motor"], cwd=folder, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout


INIT, JOB, MOVE_BY, RUN_ON, STOP, ACKNOWLEDGE, PLAY = range(7)


def traced(file: Path) -> Iterator[tuple[int, list[int], np.ndarray, np.ndarray]]:
    """The entries of a trace of motor.c: what was done, its numbers; of a play its edges and steps, tick by tick."""
    data, place = file.read_bytes(), 0
    while place < len(data):
        what, *numbers = np.frombuffer(data, np.int64, 4, place).tolist()
        n, place = numbers[0] if what == PLAY else 0, place + 32
        tapes = np.frombuffer(data, np.int8, 2 * n, place).reshape(2, n)
        place += 2 * n
        yield what, numbers, tapes[0], tapes[1]


def replay(core: EmulatedCore, file: Path) -> int:
    """Do to a core what a trace tells, and compare every step of it, its tick included; the number of sequences."""
    plays = 0
    for what, numbers, edges, steps in traced(file):
        if what == INIT:
            core.init()
        elif what == JOB:
            assert core.job(numbers[0], numbers[1]) == 0
        elif what == MOVE_BY:
            core.move(numbers[0])
        elif what == RUN_ON:
            core.run()
        elif what == STOP:
            core.stop()
        elif what == ACKNOWLEDGE:
            core.acknowledge()
        else:
            assert core.follow(edges, steps) == len(edges)
            status = core.status
            assert (status.pending, status.mode * 16 + status.fault) == (numbers[1], numbers[2])
            plays += 1
    return plays

"""Ten thousand random sequences of the motor of test_motion.py on an emulated Cortex-M4, and as many on a Cortex-M7.

``python tests/motor_on_the_boards.py FILE.jsonl [PROCESSOR ...]``: the motor turns beside the host's core, and the
emulated core must give every step at the same tick. A line for every batch is added to the file, and it goes on behind
the last one. Both processors take about 17 minutes of CPU time; CI runs 33 sequences on either.
"""

from __future__ import annotations

import json
import shutil
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.gearmath.firmware.conftest import PROCESSORS, emulate
from tests.gearmath.firmware.motor import MOTORS, QUICK, replay, run_motor

BATCHES, BATCH = 25, 400  # a tenth more are those in which the hob starts and stops at once


def run(processor: str, batch: int, folder: Path) -> dict:
    """The line of one batch, whose seed is its number."""
    start, motor = time.process_time(), MOTORS[batch % len(MOTORS)]
    host = run_motor(str(shutil.which("gcc")), folder, motor, motor.acceleration, BATCH, batch)
    given = {"GM_ACCELERATION": motor.acceleration, "GM_MOVE_ACCELERATION": motor.acceleration}
    sequences = replay(emulate(processor, True, QUICK | given, folder), folder / "trace")
    line = {"processor": processor, "batch": batch, "host": host, "sequences": sequences}
    return {**line, "cpu_s": round(time.process_time() - start, 1)}


def read(file: Path) -> list[dict]:
    return [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []


def main(file: str, *wanted: str) -> None:
    for processor in wanted or PROCESSORS:
        done = max((one["batch"] for one in read(Path(file)) if one["processor"] == processor), default=0)
        for batch in range(done + 1, BATCHES + 1):
            with tempfile.TemporaryDirectory() as folder, Path(file).open("a") as out:
                out.write(json.dumps(run(processor, batch, Path(folder))) + "\n")
    lines = read(Path(file))
    for processor in PROCESSORS:
        ours = [one for one in lines if one["processor"] == processor]
        stalled = [one for one in ours if one["host"] != [0, ""]]
        sequences, cpu = sum(one["sequences"] for one in ours), sum(one["cpu_s"] for one in ours)
        print(f"{processor}: {sequences} sequences step for step those of the host, {cpu / 60:.1f} min of CPU time")
        for one in stalled:
            print("not as it should be:", one)


if __name__ == "__main__":
    main(*sys.argv[1:])

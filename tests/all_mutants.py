"""Every wrong digit, sign, word and block of the programs of the mutation test, which itself tries a sample of them.

``python tests/all_mutants.py FILE.jsonl [SET-MEMBER ...]`` adds a line of counts for every batch to the file, goes on
behind the last one, and prints the sums. All of them, 1.3 million, take about a quarter of an hour of CPU time.
"""

from __future__ import annotations

import json
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.gearmath.conftest import _vertical_pose
from tests.gearmath.machine.judging.dense_check import Dense
from tests.gearmath.machine.judging.mutants import others, trial, wrong_digits
from tests.gearmath.machine.judging.test_mutations import CASES, SPACES
from tests.gearmath.machine.judging.whole_program import Whole

BATCH = {"digits": 2000, "others": 100}


class Witness:
    """The machine of the witness."""

    vertical_pose = staticmethod(_vertical_pose)


def run(case, file: Path) -> None:
    """Try all mutants of one program that the file does not have yet."""
    key, whole = "-".join(case), Whole(*case, SPACES)
    dense = Dense(*case, Witness, whole.lines)
    for part, found in (
        ("digits", list(wrong_digits(whole, len(whole.lines), 10**6, np.random.default_rng(0)))),
        ("others", list(others(whole))),
    ):
        done = max((one["done"] for one in read(file) if (one["case"], one["part"]) == (key, part)), default=0)
        for begin in range(done, len(found), BATCH[part]):
            start = time.process_time()
            end = min(begin + BATCH[part], len(found))
            count, unseen = trial(whole, dense, found[begin:end])
            line = {
                "case": key,
                "part": part,
                "done": end,
                "of": len(found),
                "cpu_s": round(time.process_time() - start, 1),
                "count": {", ".join(kind): number for kind, number in sorted(count.items())},
                "unseen": [[str(part) for part in one] for one in unseen],
            }
            with file.open("a") as out:
                out.write(json.dumps(line) + "\n")


def read(file: Path) -> list[dict]:
    return [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []


def main(file: str, *wanted: str) -> None:
    for case in CASES:
        if not wanted or "-".join(case) in wanted:
            run(case, Path(file))
    lines, total = read(Path(file)), Counter()
    for one in lines:
        total.update(one["count"])
    for kind, number in sorted(total.items()):
        print(f"{kind}: {number}")
    print(f"{total.total()} judged in {sum(one['cpu_s'] for one in lines) / 60:.1f} min of CPU time")
    for one in lines:
        for unseen in one["unseen"]:
            print("unseen:", one["case"], *unseen)


if __name__ == "__main__":
    main(*sys.argv[1:])

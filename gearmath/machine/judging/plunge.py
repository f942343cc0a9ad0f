"""Whether a pass that ends in its plunge, as those of Formate do, goes round once more before it leaves."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gearmath.machine.control.executor import MachinePath
from gearmath.machine.judging.cut import allowed
from gearmath.machine.judging.faults import Fault
from gearmath.machine.judging.feed import feed_rows
from gearmath.machine.judging.stated import Stated
from gearmath.machine.milling.run import CuttingRun
from gearmath.specs.bevel_set import Member


def plunge_ends(path: MachinePath, runs: list[CuttingRun], member: Member, stated: Stated) -> Iterator[Fault]:
    """Ends of plunges from which the cutter leaves before every blade has been there.

    In the last turn of a plunge each blade comes down as far as the feed has come when it passes: without a turn of
    dwell at the end the flank keeps what the rest of that turn would have taken.
    """
    if member.generation != "formate":
        return
    for run in runs:
        here = np.flatnonzero(path.tool == path.tools.index(run.cut.tool))
        steep = min(member.flank(flank).alpha for flank in run.cut.flanks)
        rows, seconds, rpm = feed_rows(path, run)
        for k, time, speed in zip(rows, seconds, rpm, strict=True):
            if speed == 0.0 or (k + 1 < len(run.cutting) and run.cutting[k + 1]) or run.space[k] < 0:
                continue
            stays = sum(halt.seconds for halt in path.halts if halt.rows == here[k] + 1)
            missing = max(1.0 - stays * speed / 60.0, 0.0)
            a_turn = float(run.axes[k - 1, 2] - run.axes[k, 2]) / time * 60.0 / speed
            left = missing * a_turn * np.sin(steep)
            if left > allowed(stated):
                yield Fault(
                    f"leaves the end of its plunge after {1.0 - missing:.2f} turns of the cutter: the flanks keep up "
                    f"to {left * 1000:.0f} um where no blade has come yet; a turn takes {60.0 / speed:.2f} s",
                    int(run.line[k]),
                    "dwell",
                )

"""What all blocks of a program leave of the lines that are watched on the flanks: extremes, and where they are.

Where a tool stands beside its path although its neighbours cut the flank clean, ``cut.beside_the_path`` says.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from gearmath.bevel.turning import turned
from gearmath.machine.judging.scallops import ridges
from gearmath.machine.judging.watched_lines import WatchedFlank, height_on_blade, lines_on_ridges, watched_flanks
from gearmath.machine.milling.mill import expose
from gearmath.machine.milling.run import CuttingRun
from gearmath.machine.planning.passes import tooth_angles
from gearmath.specs.bevel_set import Member
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.simulated_machine import SimulatedMachine

#: The part of the lines on a flank that says what its blocks are made for.
MOST_LINES = 0.75
#: So many of the highest ridges between lines of a flank get lines of their own, around them by parts of a block.
_RIDGES, _AROUND = 8, np.linspace(-0.2, 0.2, 21)


@dataclass(frozen=True)
class Watch:
    """What all blocks leave: number of lines, extremes [mm] with space, flank and line of the text; ``uncut`` lines.

    Where nothing is cut ``lowest`` is infinite, and ``highest`` minus infinite. ``usual`` [mm] is what three quarters
    of the lines on a flank deviate by at most, on its best space and on the worse of the flanks.
    """

    lines: int
    lowest: float
    lowest_at: tuple[int, str, int]
    highest: float
    highest_at: tuple[int, str, int]
    uncut: int
    usual: float

    @property
    def worst(self) -> tuple[float, tuple[int, str, int]]:
        """The larger extreme and where it is."""
        return max((self.lowest, self.lowest_at), (self.highest, self.highest_at), key=lambda found: abs(found[0]))


def watch(
    runs: list[CuttingRun],
    member: Member,
    machine: MillingMachine,
    errors: SimulatedMachine | None = None,
    progress: Callable[[int], object] = lambda _: None,
    groups: Mapping[int, list[int]] | None = None,
    withdrawn: float = 0.0,
) -> Watch:
    """What the passes of every space leave on the flanks of that space, the ``runs`` with rounded blades.

    The flanks are those that the settings cut, indexed as they are corrected, whatever they are corrected for.

    Rapid blocks that end as low as the tool cuts take metal away like the others, in every space.

    ``progress`` is called for every space exposed. ``groups`` are spaces known to be cut alike, by the one that is
    exposed for all of them; where rapid motion takes metal away, it is every space. A cutter that is ``withdrawn`` [mm]
    for a stock passes above the foot of the flanks: what stays there is root, and does not count as ``highest``.
    """
    flanks = watched_flanks(member, runs, machine)
    reached = {one.flank: height_on_blade(one, member, runs, machine) >= withdrawn for one in flanks}
    numbers = np.concatenate([run.line for run in runs])
    rows: list[tuple[float, float, int, int, int, str, int]] = []
    usual: dict[str, float] = {}
    turns = tooth_angles(member.teeth, member.rad("index_correction"))
    every = {space: [space] for space in sorted({number for run in runs for number in run.spaces})}
    exposed = every if groups is None or any(_rapid_in_metal(run).any() for run in runs) else groups
    for space, like in exposed.items():
        own = [replace(run, cutting=(run.cutting & (run.space == space)) | _rapid_in_metal(run)) for run in runs]
        angle = turns[space]
        for one in flanks:
            lines = (turned(one.point, angle), turned(one.normal, angle), one.start)
            left = expose(own, machine, errors, *lines)
            met = np.isfinite(left.distance)
            low = int(np.argmin(np.where(met, left.distance, np.inf)))
            counts = np.where(met & reached[one.flank], left.distance, -np.inf)
            high = int(np.argmax(counts))
            most_left, left_by = float(counts[high]), int(left.block[high])
            if (more := _on_ridges(one, counts, member, runs)) is not None:
                again = expose(own, machine, errors, turned(more.point, angle), turned(more.normal, angle), more.start)
                whole = np.isfinite(again.distance) & (height_on_blade(more, member, runs, machine) >= withdrawn)
                high = int(np.argmax(np.where(whole, again.distance, -np.inf)))
                most_left, left_by = max((most_left, left_by), (float(again.distance[high]), int(again.block[high])))
            if met.any():
                most = float(np.quantile(np.abs(left.distance[met]), MOST_LINES))
                usual[one.flank] = min(most, usual.get(one.flank, np.inf))
            rows.append(
                (
                    float(left.distance[low]) if met.any() else np.inf,
                    most_left,
                    int(numbers[left.block[low]]),
                    int(numbers[left_by]),
                    int((~met).sum()) * len(like),
                    one.flank,
                    space,
                )
            )
        progress(1)
    deep, full = min(rows, key=lambda row: row[0]), max(rows, key=lambda row: row[1])
    return Watch(
        lines=len(every) * sum(len(one.point) for one in flanks),
        lowest=deep[0],
        lowest_at=(deep[6], deep[5], deep[2]),
        highest=full[1],
        highest_at=(full[6], full[5], full[3]),
        uncut=sum(row[4] for row in rows),
        usual=max(usual.values(), default=0.0),
    )


def _on_ridges(lines: WatchedFlank, left: np.ndarray, member: Member, runs: list[CuttingRun]) -> WatchedFlank | None:
    """Lines on the highest ridges that seem to stand between ``lines``, which keep ``left`` (n,), higher than these."""
    if len(lines.ends) < 2:
        return None
    parts = [slice(*ends) for ends in itertools.pairwise([*lines.curves, len(left)]) if ends[1] - ends[0] > 1]
    found = [ridges(lines.theta[part], left[part], lines.ends) for part in parts]
    peaks, theta = (np.concatenate(part) for part in zip(*found, strict=True))
    chosen = np.argsort(-peaks)[:_RIDGES]
    chosen = chosen[peaks[chosen] > left.max()]
    if not len(chosen):
        return None
    (run,) = (run for run in runs if lines.flank in run.cut.flanks)
    # where a curve is generated is known to a part of a block: lines stand all around
    around = theta[chosen, None] + _AROUND * float(np.median(np.abs(np.diff(lines.ends))))
    return lines_on_ridges(member, run, lines.flank, around)


def _rapid_in_metal(run: CuttingRun) -> np.ndarray:
    """Rapid blocks (n,) that end no higher than the tool cuts: a right program has none."""
    return ~run.cutting & (run.axes[:, 2] <= run.axes[run.cutting, 2].max(initial=-np.inf))

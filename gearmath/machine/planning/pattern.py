"""The touches of a whole member as one pattern: a table of the places of a space, and what every tooth has of it.

A program runs through teeth and places in two loops. A is the sum of the angle of the place in space 0 and the angle of
the tooth, rounded once, so that nothing adds up from tooth to tooth.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, fields

import numpy as np

from gearmath.errors import InputError
from gearmath.machine.planning.path import whole_turns
from gearmath.specs.milling_machine import AXES, UNITS, UNITS_PER_INTERNAL, MillingMachine


@dataclass(frozen=True)
class Targets:
    """n touches in their order: where they are, and positions X Y Z A B (n,5) in mm and rad, A and B standing still."""

    flank: np.ndarray
    tooth: np.ndarray
    row: np.ndarray
    col: np.ndarray
    start: np.ndarray
    touch: np.ndarray
    end: np.ndarray

    def __len__(self) -> int:
        return len(self.tooth)

    def pick(self, keep: np.ndarray) -> Targets:
        return Targets(*(getattr(self, part.name)[keep] for part in fields(self)))

    def turned_by(self, angle: np.ndarray) -> Targets:
        """The same touches with A turned on by angles (n,) [rad]."""
        turn = angle[:, None] * np.array([0, 0, 0, 1, 0])
        positions = (getattr(self, part) + turn for part in ("start", "touch", "end"))
        return Targets(self.flank, self.tooth, self.row, self.col, *positions)

    def place(self, k: int) -> tuple[str, int, int]:
        """Flank, row and column of a touch."""
        return str(self.flank[k]), int(self.row[k]), int(self.col[k])


@dataclass(frozen=True)
class TouchPattern:
    """Places (p) of a space in their order, and teeth (z + 1), tooth z being tooth 0 once more.

    A place is touched on every tooth whose ``kind`` (z + 1,) is at least the ``least`` (p,) of the place. ``turn``
    (z + 1,) is what A of a tooth has beyond that of tooth 0 [rad]. ``places`` are touches of space 0.
    """

    places: Targets
    least: np.ndarray
    kind: np.ndarray
    turn: np.ndarray

    @staticmethod
    def of(targets: Targets, teeth: int, machine: MillingMachine) -> TouchPattern:
        """The pattern that repeats ``targets``, which must be nested: a tooth has all places that a poorer one has."""
        order = sorted({targets.place(k) for k in range(len(targets))})
        first = {targets.place(k): k for k in reversed(range(len(targets)))}
        rows = np.array([first[place] for place in order])
        pitch = 2 * math.pi / teeth
        places = targets.pick(rows).turned_by(-pitch * (targets.tooth[rows] % teeth))
        count = np.bincount(targets.tooth, minlength=teeth + 1)
        sizes = sorted(set(count.tolist()) | {0})
        kind = np.array([sizes.index(one) for one in count.tolist()])
        least = np.full(len(order), len(sizes))
        where = np.array([order.index(targets.place(k)) for k in range(len(targets))])
        np.minimum.at(least, where, kind[targets.tooth])
        turn = pitch * (np.arange(teeth + 1) % teeth)
        pattern = TouchPattern(places, least, kind, turn + _whole_turns(places, turn, machine))
        if list(pattern.order()) != list(zip(targets.tooth.tolist(), where.tolist(), strict=True)):
            raise ValueError("the touches do not repeat one pattern from tooth to tooth")
        return pattern

    def __len__(self) -> int:
        return sum(1 for _ in self.order())

    def order(self) -> Iterator[tuple[int, int]]:
        """Tooth and place of every touch."""
        for tooth, kind in enumerate(self.kind.tolist()):
            yield from ((tooth, int(place)) for place in np.flatnonzero(self.least <= kind))

    def targets(self) -> Targets:
        """All touches, A as a counting axis counts it."""
        tooth, place = np.array(list(self.order())).T
        all_places = self.places.pick(place)
        return Targets(
            all_places.flank, tooth, all_places.row, all_places.col, all_places.start, all_places.touch, all_places.end
        ).turned_by(self.turn[tooth])


def _whole_turns(places: Targets, turn: np.ndarray, machine: MillingMachine) -> np.ndarray:
    """Turns (z + 1,) [rad] that a counting axis needs more, to reach all places of a tooth; none for a modulo axis."""
    low, high = machine.travel[3]
    if not math.isfinite(low):
        return np.zeros(len(turn))
    below = machine.one_sided
    A = places.start[:, 3]
    around = np.concatenate([A[:1], A, A - below])
    return np.array([whole_turns(around + one, low, high, 0.0) for one in turn])


def check_travel(targets: Targets, name: str, machine: MillingMachine, level: float) -> None:
    """Raises InputError naming point, axis and limit where a touch, or the ``level`` above it, is out of travel."""
    low, high = machine.travel.T
    raised = targets.start[:1].copy()
    raised[:, 2] = level
    before = targets.start - machine.one_sided * np.array([0, 0, 0, 1, 0])
    for what, axes in (
        ("the start", targets.start),
        ("the end", targets.end),
        ("the height above", raised),
        ("the way to A", before),
    ):
        outside = np.argwhere((axes < low) | (axes > high))
        if outside.size:
            k, axis = outside[0]
            scale = UNITS_PER_INTERNAL[axis]
            place = f"{targets.flank[k]} flank, tooth {targets.tooth[k]}, row {targets.row[k]}, col {targets.col[k]}"
            raise InputError(
                f"{name} {place}, {what} of the touch: axis {AXES[axis]} = {axes[k, axis] * scale:.5f} {UNITS[axis]}: "
                f"{machine.name} travels {low[axis] * scale:g} to {high[axis] * scale:g} {UNITS[axis]}"
            )

"""What the gear follows: over a pitch the first contact of all pairs of teeth, and how far it runs ahead and behind."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gearmath.bevel.contact.thread import zero

if TYPE_CHECKING:
    from gearmath.bevel.contact.mesh import Mesh

#: Samples of a pitch among which the leading pair is sought before its ends are found exactly.
_SAMPLES = 120
#: Difference of leads [rad] that counts as none, and trials to get there.
_SAME_LEAD, _TRIALS = 1e-12, 40


@dataclass(frozen=True)
class Leads:
    """The first contact over a pitch: the kinds that occur, largest less smallest error; None where there is none.

    ``borders`` are those of both flanks that it runs on.
    """

    kinds: tuple[str, ...]
    peak_to_peak: float | None
    borders: frozenset[int] = frozenset()


def leads_over_a_pitch(run: Mesh) -> Leads:
    """Over one pitch: by samples; its largest and smallest then exactly, where slope or difference is zero."""
    if run.is_line:
        rows = run.rows(np.linspace(-run.system.pitch / 2, run.system.pitch / 2, _SAMPLES + 1))
        return Leads(("interior",), float(np.ptp([row.error for row in rows])) if rows else None)
    system, pitch = run.system, run.system.pitch
    samples = np.linspace(0, pitch, _SAMPLES + 1)
    # whose lead it is: a thread of a tooth pair
    runners = [(thread, k) for thread in run.threads for k in range(math.floor(-run.reach), math.ceil(run.reach) + 2)]
    if not runners:
        return Leads((), None)
    leads = np.stack([system.sense * thread.errors(system, samples - k * pitch) for thread, k in runners])
    if np.isnan(leads).all(axis=0).any():
        return Leads((), None)
    leads = np.where(np.isnan(leads), -np.inf, leads)
    first = leads.argmax(axis=0)
    kinds, borders = set(), set()
    for index in np.unique(first):
        thread, k = runners[index]
        for rotation in samples[first == index] - k * pitch:
            part = next(part for part in thread.segments if part.ends[0] <= rotation <= part.ends[1])
            kinds.add(part.kind)
            borders.update(part.active)

    def value(index: int, rotation: float) -> float:
        thread, k = runners[index]
        touch = thread.at(system, rotation - k * pitch)
        return -math.inf if touch is None else run.lead(touch)

    def flat(index: int, low: float, high: float) -> float:
        """The lead of one runner where its slope is zero, NaN where that is nowhere."""
        thread, k = runners[index]
        found = zero(
            lambda at: thread.at(system, at),
            lambda touch: float(touch.tangent[6]) + system.ratio,
            low - k * pitch,
            high - k * pitch,
        )
        return math.nan if found is None else run.lead(found)

    extremes = []
    for which in (leads.max(axis=0).argmax(), leads.max(axis=0).argmin()):
        low, high = max(which - 1, 0), min(which + 1, _SAMPLES)
        candidates = [value(first[which], samples[which]), flat(first[which], samples[low], samples[high])]
        for left in range(low, high):
            if first[left] != first[left + 1]:
                candidates.append(_crossing(value, first[left], first[left + 1], samples[left], samples[left + 1]))
        extremes.append([one for one in candidates if math.isfinite(one)])
    return Leads(tuple(sorted(kinds)), max(extremes[0]) - min(extremes[1]), frozenset(borders))


def _crossing(value: Callable[[int, float], float], one: int, other: int, low: float, high: float) -> float:
    """The lead at which one runner takes over from another between two rotations: Illinois, halves where one ends."""
    before, after = (value(one, at) - value(other, at) for at in (low, high))
    found, kept = math.nan, 0
    for _ in range(_TRIALS):
        part = before / (before - after) if math.isfinite(before - after) else 0.5
        middle = low + (high - low) * part
        first, second = value(one, middle), value(other, middle)
        found, here = max(first, second), first - second
        if abs(here) < _SAME_LEAD:
            break
        # the end that stays twice counts half
        if here > 0:
            low, before, after, kept = middle, here, after / 2 if kept == 1 else after, 1
        else:
            high, after, before, kept = middle, here, before / 2 if kept == -1 else before, -1
    return found

"""What the gear follows: over a pitch the first contact of all pairs of teeth, and how far it runs ahead and behind."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gearmath.bevel.contact.surface import edges_of
from gearmath.bevel.contact.thread import KINDS, Thread, kind_of, zero

if TYPE_CHECKING:
    from gearmath.bevel.contact.mesh import Mesh

#: Samples of a pitch among which the leading pair is sought before its ends are found exactly.
_SAMPLES = 120
#: Parts of a segment that are samples too.
_WITHIN = np.array([1e-6, 0.5, 1 - 1e-6])
#: Difference of leads [rad] that counts as none, and trials to get there.
_SAME_LEAD, _TRIALS = 1e-12, 40
#: Step [rad] of what the gear follows that counts as one: 0.001 arcsec.
_STEP = 5e-9
#: Difference of leads [rad], by cubics between positions, of contacts that are ahead alike.
_ALIKE = 1e-10


@dataclass(frozen=True)
class Leads:
    """The first contact over a pitch: the kinds that occur, largest less smallest error; None where there is none.

    ``borders`` are the edges of both flanks that it runs on, ``fillets`` the active borders where it runs on a fillet.
    """

    kinds: tuple[str, ...]
    peak_to_peak: float | None
    borders: frozenset[int] = frozenset()
    fillets: frozenset[tuple[int, ...]] = frozenset()


@dataclass(frozen=True)
class Gap:
    """A contact that ends while it is ahead of all others: rotation of its pair [rad] and how far ahead [rad]."""

    rotation: float
    step: float


def gaps_in_the_path(run: Mesh) -> list[Gap]:
    """Where what the gear follows would jump, as the first of all contacts cannot: one that goes on is not known.

    The step is infinite where no other contact is known at all.
    """
    system, found = run.system, []
    pairs = range(-math.ceil(2 * run.reach), math.ceil(2 * run.reach) + 1)
    for thread in run.threads:
        for end in thread.ends:
            own = system.sense * thread.errors(system, np.array([end]))[0]
            there = end - np.array(pairs) * system.pitch
            others = [
                lead
                for one in run.threads
                for k, lead in zip(pairs, system.sense * one.errors(system, there), strict=True)
                if not math.isnan(lead) and not (one is thread and k == 0)
            ]
            step = own - max(others, default=-math.inf)
            if step > _STEP:
                found.append(Gap(end, float(step)))
    return sorted(found, key=lambda one: -one.step)


def leads_over_a_pitch(run: Mesh) -> Leads:
    """Over one pitch: by samples; its largest and smallest then exactly, where slope or difference is zero."""
    if run.is_line:
        rows = run.rows(np.linspace(-run.system.pitch / 2, run.system.pitch / 2, _SAMPLES + 1))
        return Leads(("interior",), float(np.ptp([row.error for row in rows])) if rows else None)
    system, pitch = run.system, run.system.pitch
    # a short segment must not fall between two samples
    within = [part.ends[0] + np.ptp(part.ends) * _WITHIN for thread in run.threads for part in thread.segments]
    samples = np.unique(np.concatenate([np.linspace(0, pitch, _SAMPLES + 1), *(np.mod(one, pitch) for one in within)]))
    # whose lead it is: a thread of a tooth pair
    runners = [(thread, k) for thread in run.threads for k in range(math.floor(-run.reach), math.ceil(run.reach) + 2)]
    if not runners:
        return Leads((), None)
    leads = np.stack([system.sense * thread.errors(system, samples - k * pitch) for thread, k in runners])
    if np.isnan(leads).all(axis=0).any():
        return Leads((), None)
    leads = np.where(np.isnan(leads), -np.inf, leads)
    first = leads.argmax(axis=0)
    on = {
        min((_active(runners[index], rotation, pitch) for index in np.flatnonzero(ahead)), key=_rank)
        for rotation, ahead in zip(samples, (leads > leads.max(axis=0) - _ALIKE).T, strict=True)
    }

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
        low, high = max(which - 1, 0), min(which + 1, len(samples) - 1)
        candidates = [value(first[which], samples[which]), flat(first[which], samples[low], samples[high])]
        for left in range(low, high):
            if first[left] != first[left + 1]:
                candidates.append(_crossing(value, first[left], first[left + 1], samples[left], samples[left + 1]))
        extremes.append([one for one in candidates if math.isfinite(one)])
    kinds = tuple(sorted({kind_of(active) for active in on}))
    borders = frozenset(border for active in on for border in edges_of(active))
    fillets = frozenset(active for active in on if kind_of(active) == "fillet")
    return Leads(kinds, max(extremes[0]) - min(extremes[1]), borders, fillets)


def _active(runner: tuple[Thread, int], rotation: float, pitch: float) -> tuple[int, ...]:
    """The active borders of a thread of a tooth pair at a rotation."""
    thread, k = runner
    at = rotation - k * pitch
    return next(part.active for part in thread.segments if part.ends[0] <= at <= part.ends[1])


def _rank(active: tuple[int, ...]) -> int:
    """Of contacts that are ahead alike the mildest kind counts."""
    return KINDS.index(kind_of(active))


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

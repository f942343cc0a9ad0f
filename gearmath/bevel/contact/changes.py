"""Where the contact of one pair of teeth changes its kind: along a thread, and where another thread comes ahead."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gearmath.bevel.contact.system import System
from gearmath.bevel.contact.thread import Thread

#: Positions among which the thread that is ahead is sought, and halvings of what lies between two of them.
_SOUGHT, _HALVINGS = 361, 44
#: Difference of leads [rad], by cubics between positions, of contacts that are ahead alike.
_ALIKE = 1e-9


def changes_of_kind(system: System, threads: Sequence[Thread], limit: float) -> list[float]:
    """Rotations [rad] up to ``limit`` to either side at which the kind of contact changes that is ahead."""
    along = [
        (thread, after.ends[0])
        for thread in threads
        for before, after in zip(thread.segments[:-1], thread.segments[1:], strict=True)
        if before.kind != after.kind and abs(after.ends[0]) <= limit
    ]
    found = [at for thread, at in along if _is_ahead(system, threads, thread, at)]
    if len(threads) > 1:
        rotations = np.linspace(-limit, limit, _SOUGHT)
        first = _first(system, threads, rotations)
        for k in np.flatnonzero(first[:-1] != first[1:]):
            at = _passing(system, threads, rotations[k], rotations[k + 1])
            if at is not None:
                found.append(at)
    return found


def _leads(system: System, threads: Sequence[Thread], rotations: np.ndarray) -> np.ndarray:
    leads = np.stack([system.sense * thread.errors(system, rotations) for thread in threads])
    return np.where(np.isnan(leads), -np.inf, leads)


def _first(system: System, threads: Sequence[Thread], rotations: np.ndarray) -> np.ndarray:
    leads = _leads(system, threads, rotations)
    return np.where(np.isfinite(leads).any(axis=0), leads.argmax(axis=0), -1)


def _is_ahead(system: System, threads: Sequence[Thread], thread: Thread, at: float) -> bool:
    leads = _leads(system, threads, np.array([at]))[:, 0]
    own = system.sense * thread.errors(system, np.array([at]))[0]
    return bool(own > leads.max() - _ALIKE)


def _passing(system: System, threads: Sequence[Thread], low: float, high: float) -> float | None:
    """Where one thread comes ahead of another of a different kind; None where the kind stays."""
    before, after = (int(_first(system, threads, np.array([at]))[0]) for at in (low, high))
    if -1 in (before, after):
        return None

    def lead(which: int, at: float) -> float:
        touch = threads[which].at(system, at)
        return -np.inf if touch is None else system.sense * system.transmission_error(touch)

    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if lead(before, middle) > lead(after, middle) else (low, middle)
    kinds = [
        next((part.kind for part in threads[which].segments if part.ends[0] <= high <= part.ends[1]), "")
        for which in (before, after)
    ]
    return high if kinds[0] != kinds[1] else None

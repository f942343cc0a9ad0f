"""How far a pair may be displaced until it runs otherwise: on an edge, on a fillet, with a reversed parabola.

That comes before the pattern reaches an edge where the path does: the marking compound shows where the flanks nearly
touch, and an edge on which the pattern ends already is no limit of it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

from gearmath.bevel.contact.mesh import Mesh, mesh
from gearmath.bevel.contact.system import Assembly

#: Displacement [mm] with which the search begins, by what it grows, and beyond which it ends.
_FIRST, _GROWTH, MOST = 0.01, 1.4, 5.0
#: Displacement [mm] to which a limit is found.
_CLOSE = 2e-5
_WANTED = "interior contact"
#: How often ``outcome_limits`` tells its progress.
SEARCHES = 4


@dataclass(frozen=True)
class Change:
    """A displacement [mm] and the outcome from there on; None where it stays within ``MOST``."""

    value: float
    outcome: str | None


def outcome_limits(
    run: Mesh, progress: Callable[[int], object] = lambda _: None
) -> dict[str, tuple[Change, Change]] | None:
    """By displacement ("V", "H") where the outcome changes to the negative and to the positive side.

    From the assembly as it is; None where the pair does not run within its flanks as it stands.
    """
    if run.outcome != _WANTED:
        return None
    given = Assembly(*run.assembly)

    def outcome(name: str, change: float) -> str:
        return mesh(run.system, replace(given, **{name: getattr(given, name) + change})).outcome

    limits = {}
    for name in ("V", "H"):
        both = []
        for sign in (-1.0, 1.0):
            both.append(_search(partial(outcome, name), sign))
            progress(1)
        limits[name] = (both[0], both[1])
    return limits


def _search(outcome: Callable[[float], str], sign: float) -> Change:
    low, high = 0.0, _FIRST
    while (found := outcome(sign * high)) == _WANTED:
        if high >= MOST:
            return Change(sign * MOST, None)
        low, high = high, min(_GROWTH * high, MOST)
    while high - low > _CLOSE:
        middle = (low + high) / 2
        if (there := outcome(sign * middle)) == _WANTED:
            low = middle
        else:
            high, found = middle, there
    return Change(sign * (low + high) / 2, found)

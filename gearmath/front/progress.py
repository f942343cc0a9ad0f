"""How long work tells of itself: the command line shows it as a bar."""

from __future__ import annotations

from collections.abc import Callable

#: Takes how many steps are done since it was called last.
Progress = Callable[[int], object]
#: Gets the number of steps that are to come, and their unit; gives what hears of those that are done.
Begin = Callable[[int, str], Progress]


def silent(steps: int, unit: str) -> Progress:
    """Tells nobody."""
    return unheard


def unheard(done: int) -> object:
    """Tells nobody."""
    return None

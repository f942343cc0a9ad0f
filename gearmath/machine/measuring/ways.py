"""A probing or calibration program run once, with every way of its probe: the nominal run that is judged."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from gearmath.machine.control.executor import ProgramRun, run_program
from gearmath.machine.control.state import Probe, Setup
from gearmath.machine.measuring.collision_check import enough_steps, is_touch


@dataclass(frozen=True)
class Way:
    """One MEAS block: commanded start and end X Y Z A B (5,) in mm and rad, where it triggered or None.

    ``looked`` is how often the program had asked for $A_PROBE before it, and ``since`` how many motions lie between
    the last time and it.
    """

    start: np.ndarray
    end: np.ndarray
    met: np.ndarray | None
    looked: int
    since: int


class Recorder:
    """Stands between a program and a probe, and keeps all ways."""

    def __init__(self, probe: Probe) -> None:
        self.probe, self.ways = probe, list[Way]()
        self.looked = self.since = 0

    def __call__(self, start: np.ndarray, end: np.ndarray) -> np.ndarray | None:
        met = self.probe(start, end)
        self.ways.append(Way(start.copy(), end.copy(), met, self.looked, self.since))
        return met

    def deflected(self, position: np.ndarray) -> bool:
        """Whether the probe is deflected: never, on a right machine; that it was asked is kept."""
        self.looked, self.since = self.looked + 1, 0
        return False

    def moved(self, position: np.ndarray) -> None:
        self.since += 1


@dataclass(frozen=True)
class Watched:
    """A run and its ways, as many as its path has MEAS blocks."""

    run: ProgramRun
    ways: tuple[Way, ...]

    @property
    def measuring(self) -> np.ndarray:
        """The rows of the path that are MEAS blocks."""
        return np.flatnonzero(self.run.path.measuring)

    @property
    def touches(self) -> list[int]:
        """The ways whose positions the program takes."""
        taken = set(self.run.taken)
        return [k for k, row in enumerate(self.measuring.tolist()) if row in taken]


def watched(
    text: str,
    name: str,
    probe: Probe,
    setup: Setup,
    parameters: Mapping[int, float] | None = None,
    files: Mapping[str, str] | None = None,
) -> Watched:
    """Run a program with its host ready at once. Raises InputError as ``run_program`` does."""
    recorder = Recorder(probe)
    run = run_program(
        text,
        name,
        recorder,
        acknowledged,
        parameters,
        enough_steps(text),
        setup,
        files,
        recorder.deflected,
        recorder.moved,
    )
    return Watched(run, tuple(recorder.ways))


def acknowledged(parameters: Mapping[int, float]) -> dict[int, float]:
    """A host that takes every touch at once: R103 = R101."""
    return {103: parameters.get(101, 0.0)}


def at_the_ends(start: np.ndarray, end: np.ndarray) -> np.ndarray | None:
    """A probe that triggers at the end of every way along a flank, and on no other: what a right program meets."""
    return end if is_touch(start, end) else None


def replayed(ways: tuple[Way, ...], other: int, met: Callable[[Way], np.ndarray | None]) -> Probe:
    """A probe that meets what it met before on all ways but the one of number ``other``, where it meets ``met``.

    Beyond the ways that are known it meets nothing.
    """
    count = -1

    def probe(start: np.ndarray, end: np.ndarray) -> np.ndarray | None:
        nonlocal count
        count += 1
        if count >= len(ways):
            return None
        return met(ways[count]) if count == other else ways[count].met

    return probe

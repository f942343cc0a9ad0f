"""What a step rule does over time: patterns of encoder edges, and the error of the steps in exact integers.

The rule itself is not here. It comes in as the compiled kernel, a callable from edges to steps, so that what is
simulated is the exported C. Beside it runs the floating rule of the public firmware.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, Protocol

import numpy as np

from gearmath.errors import ComputationError, InputError
from gearmath.gearbox.helix import JobRatio
from gearmath.shown import Shown, Shows

Pattern = Literal["forward", "dither", "reversals"]
LONGEST_RUN = 5000  # edges between two reversals, at most
#: A run of so many edges takes days; their counts after the last start stay within 63 bits.
MOST_EDGES, LAST_START = 10**12, 2**62
FEED_EVERY = 8  # in a job of two axes, one edge in so many is one of the feed


class TrainRunner(Protocol):
    """A compiled step rule: int8 edges (+1, -1) and a remainder to int8 steps and the remainder after them."""

    def __call__(
        self, edges: np.ndarray, numerator: int, denominator: int, remainder: int, /
    ) -> tuple[np.ndarray, int]: ...


class AxesRunner(Protocol):
    """The compiled rule of two axes: axes (0 hob, 1 feed), edges, and the ratios of both, to steps and remainder."""

    def __call__(
        self,
        axes: np.ndarray,
        edges: np.ndarray,
        base: tuple[int, int],
        increment: tuple[int, int],
        denominator: int,
        remainder: int,
        /,
    ) -> tuple[np.ndarray, int]: ...


def pattern(kind: Pattern, edges: int, seed: int = 0, chunk: int = 1 << 20) -> Iterator[np.ndarray]:
    """Edges (+1, -1) in chunks of at most ``chunk``, ``edges`` in all.

    forward: always +1. dither: +1, -1, +1, ... about a standing hob. reversals: runs of 1 to 5000 edges, each in the
    other direction than the last, of random length.
    """
    if edges < 1:
        raise InputError(f"edges = {edges}: at least one edge is needed")
    source = _SOURCES[kind](np.random.default_rng(seed), chunk)
    for start in range(0, edges, chunk):
        yield next(source)[: edges - start]


def _forward(_: np.random.Generator, chunk: int) -> Iterator[np.ndarray]:
    while True:
        yield np.ones(chunk, np.int8)


def _dither(_: np.random.Generator, chunk: int) -> Iterator[np.ndarray]:
    first = 0
    while True:
        yield (1 - 2 * ((first + np.arange(chunk)) % 2)).astype(np.int8)
        first += chunk


def _reversals(random: np.random.Generator, chunk: int) -> Iterator[np.ndarray]:
    direction, pending = 1, np.empty(0, np.int8)
    while True:
        parts, size = [pending], len(pending)
        while size < chunk:
            run = np.full(int(random.integers(1, LONGEST_RUN, endpoint=True)), direction, np.int8)
            parts.append(run)
            size += len(run)
            direction = -direction
        joined = np.concatenate(parts)
        yield joined[:chunk]
        pending = joined[chunk:]


_SOURCES: dict[Pattern, Callable[[np.random.Generator, int], Iterator[np.ndarray]]] = {
    "forward": _forward,
    "dither": _dither,
    "reversals": _reversals,
}


def deviations(
    edges: np.ndarray, steps: np.ndarray, numerator: int | np.ndarray, denominator: int, start: int = 0
) -> np.ndarray:
    """p D - N e after every edge, exactly, (n,) int64: the error in units of 1/D step.

    ``numerator`` is N, or (n,) the N of the axis of every edge. ``start`` is the value before the first edge.
    Raises ComputationError where 64 bits could overflow.
    """
    largest = int(np.abs(numerator).max(initial=0)) + int(np.abs(steps).max(initial=1)) * denominator
    if abs(start) + len(edges) * largest >= 2**63:
        raise ComputationError(f"{len(edges)} edges over {denominator} are too many for exact 64-bit sums")
    moves = steps.astype(np.int64) * denominator - edges.astype(np.int64) * numerator
    return start + np.cumsum(moves)


def worst_error(edges: np.ndarray, steps: np.ndarray, numerator: int, denominator: int) -> Fraction:
    """Largest |p - N e/D| in steps over a history, exactly."""
    values = deviations(edges, steps, numerator, denominator)
    return Fraction(int(np.abs(values).max(initial=0)), denominator)


class FloatRule:
    """The floating rule of the public firmware, in float32, vectorised.

    On every edge, in whatever direction, the count goes up; a step follows, in the direction of that edge, where
    round(float32(N/D) * count) exceeds the steps delivered so far, also in float32; at most one step an edge. A
    negative N (which that firmware leaves to its wiring) turns the steps round. It starts after ``count`` edges.
    """

    def __init__(self, numerator: int, denominator: int, count: int = 0) -> None:
        self.factor = np.float32(abs(numerator) / denominator)
        self.sign = -1 if numerator < 0 else 1
        self.count = count
        self.delivered = int(self._product(np.array([count]))[0])

    def __call__(self, edges: np.ndarray) -> np.ndarray:
        """The int8 steps of the next edges."""
        index = np.arange(1, len(edges) + 1)
        wanted = _first_not_below(self._product(self.count + index))
        # delivered[i] = min(delivered[i-1] + 1, wanted[i]), because wanted never falls
        delivered = index + np.minimum(self.delivered, np.minimum.accumulate(wanted - index))
        pulses = np.diff(delivered, prepend=self.delivered)
        self.count += len(edges)
        self.delivered = int(delivered[-1])
        return (self.sign * pulses * edges).astype(np.int8)

    def positions(self, counts: np.ndarray) -> np.ndarray:
        """Steps delivered (n,) after so many edges forward, (n,): as if it had run through all of them."""
        delivered = _first_not_below(self._product(counts))
        coarse = int(np.spacing(np.float32(counts.max(initial=1))))  # whole counts that float32 cannot tell apart
        for before in range(1, 2 * coarse + 2):
            earlier = np.maximum(counts - before, 0)
            delivered = np.minimum(delivered, _first_not_below(self._product(earlier)) + (counts - earlier))
        return self.sign * delivered

    def _product(self, counts: np.ndarray) -> np.ndarray:
        """round(float32(N/D) * count), in float32."""
        product = self.factor * counts.astype(np.float32)
        return np.floor(product.astype(np.float64) + 0.5)


def _first_not_below(wanted: np.ndarray) -> np.ndarray:
    """The smallest whole number that float32 does not round below ``wanted``, which float32 holds exactly."""
    below = np.nextafter(wanted.astype(np.float32), np.float32(-np.inf)).astype(np.float64)
    first = np.ceil((below + wanted) / 2.0)
    return (first + (first.astype(np.float32) < wanted)).astype(np.int64)


@dataclass(frozen=True, repr=False)
class Simulation(Shown):
    """Outcome of one run. Errors in steps; positions at the end in counts and steps.

    The floating rule knows only the hob; its error is against the hob's part of the motion.
    """

    pattern: Pattern
    edges: int
    encoder_position: int
    feed_position: int
    position: int
    worst_error: Fraction
    float_position: int
    float_worst_error: Fraction

    def _shown(self) -> tuple[str, list[Shows]]:
        return f"{self.edges} encoder edges, {self.pattern}", [
            ("worst error", self.worst_error, "steps"),
            ("of the floating rule", self.float_worst_error, "steps"),
            ("position", self.position, "steps"),
            ("of the encoder", self.encoder_position, "counts"),
            ("position of the floating rule", self.float_position, "steps"),
        ]


class Trace:
    """A Record that keeps the largest error of both rules in every stretch of edges, some thousand in all."""

    def __init__(self, edges: int, stretches: int = 1000) -> None:
        self._size = max(1, edges // stretches)
        self._done = 0
        self._parts: list[np.ndarray] = []

    def add(self, exact: np.ndarray, loose: np.ndarray) -> None:
        """The errors (n,) [steps] of the next edges."""
        first = np.arange(0, len(exact), self._size)
        last = np.minimum(first + self._size, len(exact))
        worst = (np.maximum.reduceat(np.abs(errors), first) for errors in (exact, loose))
        self._parts.append(np.stack([self._done + last, *worst]))
        self._done += len(exact)

    @property
    def arrays(self) -> np.ndarray:
        """Edges done at the end of every stretch, and the largest errors of exact and floating rule in it, (3, n)."""
        return np.hstack(self._parts)


#: Takes the errors (n,) of the exact and of the floating rule [steps] of the next edges.
Record = Callable[[np.ndarray, np.ndarray], object]


def simulate(
    run: TrainRunner,
    ratio: tuple[int, int],
    first_remainder: int,
    kind: Pattern,
    edges: int,
    seed: int = 0,
    progress: Callable[[int], object] = lambda done: None,
) -> Simulation:
    """Drive the compiled rule for N <= D and the floating rule through one pattern, at ``ratio`` = (N, D).

    ``progress`` is told the number of edges done after each chunk. Raises ComputationError if the state of the
    compiled rule breaks a + p D = a_0 + N e after a chunk.
    """

    def one_axis(
        axes: np.ndarray, chunk: np.ndarray, base: object, increment: object, denominator: int, remainder: int
    ) -> tuple[np.ndarray, int]:
        return run(chunk, ratio[0], denominator, remainder)

    job = JobRatio(ratio[1], (ratio[0], 0))
    return _drive(one_axis, job, first_remainder, kind, edges, seed, progress, lambda exact, loose: None)


def simulate_job(
    run: AxesRunner,
    job: JobRatio,
    kind: Pattern,
    edges: int,
    seed: int = 0,
    progress: Callable[[int], object] = lambda done: None,
    record: Record = lambda exact, loose: None,
    start: int = 0,
) -> Simulation:
    """The same for any ratio: above 1, negative, or of hob and feed, whose edges then come among those of the hob.

    ``start`` is the count of the hob before the first edge, to begin just below a boundary of the counters.
    Raises InputError where edges or start are more than a run can have.
    """
    for key, value, least, most in (("edges", edges, 1, MOST_EDGES), ("start", start, 0, LAST_START)):
        if not least <= value <= most:
            raise InputError(f"{key} = {value}: must lie between {least} and {most}")
    return _drive(run, job, job.first_remainder, kind, edges, seed, progress, record, start)


def _drive(
    run: AxesRunner,
    job: JobRatio,
    first_remainder: int,
    kind: Pattern,
    edges: int,
    seed: int,
    progress: Callable[[int], object],
    record: Record,
    start: int = 0,
) -> Simulation:
    denominator, base, increment = job.denominator, job.base, job.increment
    numerators = np.array(job.numerators)
    floating = FloatRule(job.numerators[0], denominator, start)
    remainder = (first_remainder + job.numerators[0] * start) % denominator
    deviation = first_remainder - remainder
    float_deviation = floating.sign * floating.delivered * denominator - job.numerators[0] * start
    worst = float_worst = 0
    sums = np.zeros(4, np.int64)
    for axes, chunk in _on_axes(job, kind, edges, seed):
        steps, remainder = run(axes, chunk, base, increment, denominator, remainder)
        exact = deviations(chunk, steps, numerators[axes], denominator, deviation)
        float_steps = np.zeros_like(chunk)
        float_steps[axes == 0] = floating(chunk[axes == 0])
        loose = deviations(chunk, float_steps, np.where(axes == 0, numerators[0], 0), denominator, float_deviation)
        deviation, float_deviation = int(exact[-1]), int(loose[-1])
        if remainder != first_remainder - deviation:
            raise ComputationError(
                f"the step rule at {job.numerators}/{denominator} left a wrong remainder, {remainder}"
            )
        worst = max(worst, int(np.abs(exact).max()))
        float_worst = max(float_worst, int(np.abs(loose).max()))
        parts = (chunk[axes == 0], chunk[axes == 1], steps, float_steps)
        sums += [part.sum(dtype=np.int64) for part in parts]
        record(exact / denominator, loose / denominator)
        progress(len(chunk))
    encoder, feed, position, float_position = map(int, sums)
    return Simulation(
        kind,
        edges,
        encoder,
        feed,
        position,
        Fraction(worst, denominator),
        float_position,
        Fraction(float_worst, denominator),
    )


def _on_axes(job: JobRatio, kind: Pattern, edges: int, seed: int) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """The pattern on the hob; in a job of two axes every FEED_EVERY-th edge is one of the feed, in its own pattern."""
    size = 1 << 20 if job.numerators[1] == 0 else 1 << 18
    feeds = _SOURCES[kind](np.random.default_rng(seed + 1), size)
    for chunk in pattern(kind, edges, seed, size):
        axes = np.zeros(len(chunk), np.int8)
        if job.numerators[1]:
            axes[FEED_EVERY - 1 :: FEED_EVERY] = 1
            chunk = chunk.copy()
            chunk[axes == 1] = next(feeds)[: int(axes.sum())]
        yield axes, chunk

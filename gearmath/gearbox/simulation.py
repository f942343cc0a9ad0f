"""What a step rule does over time: patterns of encoder edges, and the error of the steps in exact integers.

The rule itself is not here. It comes in as the compiled kernel, a callable from edges to steps, so that what is
simulated is the C that leaves the house. Beside it runs the floating rule of the public firmware.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, Protocol

import numpy as np

from gearmath.errors import ComputationError, InputError

Pattern = Literal["forward", "dither", "reversals"]
LONGEST_RUN = 5000  # edges between two reversals, at most


class Runner(Protocol):
    """A compiled step rule: int8 edges (+1, -1) and a remainder to int8 steps and the remainder after them."""

    def __call__(
        self, edges: np.ndarray, numerator: int, denominator: int, remainder: int, /
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


def deviations(edges: np.ndarray, steps: np.ndarray, numerator: int, denominator: int, start: int = 0) -> np.ndarray:
    """p D - N e after every edge, exactly, (n,) int64: the error in units of 1/D step.

    ``start`` is its value before the first edge. Raises ComputationError where 64 bits could overflow.
    """
    if abs(start) + len(edges) * (numerator + denominator) >= 2**63:
        raise ComputationError(f"{len(edges)} edges at {numerator}/{denominator} are too many for exact 64-bit sums")
    moves = steps.astype(np.int64) * denominator - edges.astype(np.int64) * numerator
    return start + np.cumsum(moves)


def worst_error(edges: np.ndarray, steps: np.ndarray, numerator: int, denominator: int) -> Fraction:
    """Largest |p - N e/D| in steps over a history, exactly."""
    values = deviations(edges, steps, numerator, denominator)
    return Fraction(int(np.abs(values).max(initial=0)), denominator)


class FloatRule:
    """The floating rule of the public firmware, in float32, vectorised.

    On every edge, in whatever direction, the count goes up; a step follows, in the direction of that edge, where
    round(float32(N/D) * count) exceeds the steps delivered so far, also in float32; at most one step an edge.
    """

    def __init__(self, numerator: int, denominator: int) -> None:
        self.factor = np.float32(numerator / denominator)
        self.count = 0
        self.delivered = 0

    def __call__(self, edges: np.ndarray) -> np.ndarray:
        """The int8 steps of the next edges."""
        index = np.arange(1, len(edges) + 1)
        product = self.factor * (self.count + index).astype(np.float32)
        wanted = _first_not_below(np.floor(product.astype(np.float64) + 0.5))
        # delivered[i] = min(delivered[i-1] + 1, wanted[i]), because wanted never falls
        delivered = index + np.minimum(self.delivered, np.minimum.accumulate(wanted - index))
        pulses = np.diff(delivered, prepend=self.delivered)
        self.count += len(edges)
        self.delivered = int(delivered[-1])
        return (pulses * edges).astype(np.int8)


def _first_not_below(wanted: np.ndarray) -> np.ndarray:
    """The smallest whole number that float32 does not round below ``wanted``, which float32 holds exactly."""
    below = np.nextafter(wanted.astype(np.float32), np.float32(-np.inf)).astype(np.float64)
    first = np.ceil((below + wanted) / 2.0)
    return (first + (first.astype(np.float32) < wanted)).astype(np.int64)


@dataclass(frozen=True)
class Simulation:
    """Outcome of one run. Errors in steps; positions at the end in counts and steps."""

    pattern: Pattern
    edges: int
    encoder_position: int
    position: int
    worst_error: Fraction
    float_position: int
    float_worst_error: Fraction


def simulate(
    run: Runner,
    ratio: tuple[int, int],
    first_remainder: int,
    kind: Pattern,
    edges: int,
    seed: int = 0,
    progress: Callable[[int], object] = lambda done: None,
) -> Simulation:
    """Drive the compiled rule and the floating rule through one pattern of edges, at ``ratio`` = (N, D).

    ``progress`` is told the number of edges done after each chunk. Raises ComputationError if the state of the
    compiled rule breaks a + p D = a_0 + N e after a chunk.
    """
    numerator, denominator = ratio
    floating = FloatRule(numerator, denominator)
    remainder, worst = first_remainder, 0
    float_worst = deviation = float_deviation = encoder = position = float_position = 0
    for chunk in pattern(kind, edges, seed):
        steps, remainder = run(chunk, numerator, denominator, remainder)
        exact = deviations(chunk, steps, numerator, denominator, deviation)
        float_steps = floating(chunk)
        loose = deviations(chunk, float_steps, numerator, denominator, float_deviation)
        deviation, float_deviation = int(exact[-1]), int(loose[-1])
        if remainder != first_remainder - deviation:
            raise ComputationError(f"the step rule at {numerator}/{denominator} left a wrong remainder, {remainder}")
        worst = max(worst, int(np.abs(exact).max()))
        float_worst = max(float_worst, int(np.abs(loose).max()))
        encoder += int(chunk.sum(dtype=np.int64))
        position += int(steps.sum(dtype=np.int64))
        float_position += int(float_steps.sum(dtype=np.int64))
        progress(len(chunk))
    return Simulation(
        kind, edges, encoder, position, Fraction(worst, denominator),
        float_position, Fraction(float_worst, denominator),
    )  # fmt: skip

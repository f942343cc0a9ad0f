"""What a correction can do, before it is done: which settings the flanks tell apart, and what none of them corrects.

With the Jacobian J of the deviations by the settings, each in parts of its bound, J = U S Vᵀ: a direction whose
singular value is small moves the flank little, and two settings whose columns are parallel cannot be told apart. What
is measured and lies outside of the columns is the projection residual (I - U Uᵀ) δ. It is an estimate of what is left:
to first order, and without bounds. The limit is the optimum on the exact surface (``correction``).
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import TypeVar

import numpy as np

from gearmath.bevel.identify.flank_target import FlankTarget
from gearmath.bevel.identify.identification import RANK
from gearmath.bevel.identify.problem import Problem
from gearmath.bevel.identify.variables import FREE, Bounds, Variable, reading, variables_of
from gearmath.errors import ComputationError

#: What names a block of columns.
Key = TypeVar("Key", bound=Hashable)
#: Columns whose directions agree this well move the flank alike. [cosine]
ALIKE = 0.999
#: A direction with less than this part of the largest singular value is weak.
WEAK = 0.01
#: Settings are chosen until no more is lost than this part of what all of them leave, or what no probe shows [mm], or
#: until the others together take away no more than this many times what as many of them take away of noise.
LOSS_PART, LOSS, _LOSS_NOISE = 0.1, 1e-4, 3.0
#: A probe resolves no less than this: the noise of a deviation is never taken for less when settings are chosen. [mm]
PROBE = 1e-4
#: So many choices of one number of settings are all tried; where there are more, settings are taken one by one.
_MOST_CHOICES = 1100
#: A setting that belongs to a direction has at least this part of its largest component.
_NAMED = 0.2


@dataclass(frozen=True)
class ChosenSettings:
    """The fewest settings that lose little: names in the order in which they were taken, and RMS left [mm] after each.

    ``loss`` is what they leave more than all settings would, in the RMS [mm].
    """

    names: tuple[str, ...]
    left: tuple[float, ...]
    loss: float


@dataclass(frozen=True)
class Analysis:
    """Sensitivity of some targets to free settings, by which any correction is judged beforehand.

    ``jacobian`` (m,p) [mm] is by the variables in parts of their bounds, at the settings as they are; ``deviation``
    (m,) [mm] what was measured.
    """

    names: tuple[str, ...]
    variables: tuple[Variable, ...]
    jacobian: np.ndarray
    deviation: np.ndarray
    measured: np.ndarray

    @cached_property
    def _svd(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return np.linalg.svd(self.jacobian, full_matrices=False)

    @property
    def singular_values(self) -> np.ndarray:
        """(p,) [mm], the largest first: the norm by which a unit change moves the deviations."""
        return self._svd[1]

    @property
    def rank(self) -> int:
        """How many directions of the settings the flanks show at all."""
        return int(np.sum(self.singular_values > RANK * self.singular_values[0]))

    @property
    def rms(self) -> float:
        """RMS of what was measured [mm]."""
        return float(np.sqrt(np.mean(self.measured**2)))

    @property
    def best_rms(self) -> float:
        """RMS of the projection residual [mm]: an estimate, to first order, of what is left without bounds."""
        return self._left(self.jacobian)

    @property
    def noise(self) -> float:
        """Standard deviation [mm] of one deviation, from what no setting shows."""
        return self.best_rms * float(np.sqrt(len(self.deviation) / max(len(self.deviation) - self.rank, 1)))

    def _left(self, jacobian: np.ndarray) -> float:
        return float(np.sqrt(np.mean(projection_residual(jacobian, self.deviation) ** 2)))

    @cached_property
    def alike(self) -> tuple[tuple[str, str, float], ...]:
        """Pairs of settings that move the flank alike, with the cosine of their columns (negative: opposite ways)."""
        size = np.linalg.norm(self.jacobian, axis=0)
        seen = [k for k in range(len(size)) if size[k] > RANK * self.singular_values[0]]
        unit = self.jacobian[:, seen] / size[seen]
        cosine = unit.T @ unit
        return tuple(
            (self.variables[seen[a]].label, self.variables[seen[b]].label, float(cosine[a, b]))
            for a in range(len(seen))
            for b in range(a + 1, len(seen))
            if abs(cosine[a, b]) >= ALIKE
        )

    @property
    def unseen(self) -> tuple[str, ...]:
        """Settings that do not move the flank at all."""
        size = np.linalg.norm(self.jacobian, axis=0)
        return tuple(
            variable.label
            for variable, length in zip(self.variables, size, strict=True)
            if length <= RANK * self.singular_values[0]
        )

    def direction(self, k: int) -> dict[str, float]:
        """The settings that make up direction k, in parts of their bounds, the largest component positive."""
        row = self._svd[2][k]
        row = row * np.sign(row[np.argmax(np.abs(row))])
        named = {v.label: float(c) for v, c in zip(self.variables, row, strict=True) if c and abs(c) >= _NAMED}
        return dict(sorted(named.items(), key=lambda item: -abs(item[1])))

    @property
    def weak(self) -> tuple[int, ...]:
        """The directions whose singular value is below one hundredth of the largest."""
        return tuple(int(k) for k in np.flatnonzero(self.singular_values < WEAK * self.singular_values[0]))

    @property
    def correction(self) -> np.ndarray:
        """The change (p,) in parts of the bounds that takes the deviation away, to first order, with least change."""
        return np.linalg.pinv(self.jacobian, rcond=RANK) @ self.deviation

    @property
    def is_simple(self) -> bool:
        """Whether strong directions alone, within the bounds, take away all that can be: the target is simple.

        A complex target needs weak directions, and with them large changes that nearly cancel each other.
        """
        U, S, V = self._svd
        strong = WEAK * S[0] <= S
        change = V[strong].T @ ((U[:, strong].T @ self.deviation) / S[strong])
        left = self.deviation - self.jacobian @ change
        enough = float(np.sqrt(np.mean(left**2))) <= max(self.best_rms * (1 + LOSS_PART), self.best_rms + LOSS)
        return enough and bool((np.abs(change) <= 1).all())

    def choose(self) -> ChosenSettings:
        """The fewest settings that lose little, by ``fewest``."""
        columns = {
            name: self.jacobian[:, [k for k, variable in enumerate(self.variables) if variable.name == name]]
            for name in self.names
        }
        names, left = fewest(columns, self.deviation)
        nothing = float(np.sqrt(np.mean(self.deviation**2)))
        return ChosenSettings(names, left, (left[-1] if left else nothing) - self.best_rms)


def weak_words(analysis: Analysis, k: int) -> str:
    """Direction k in words: settings changed together by so much, and how little that moves the flank."""
    bounds = {variable.label: variable for variable in analysis.variables}
    changes = []
    for label, part in analysis.direction(k).items():
        factor, unit = reading(bounds[label].name)
        changes.append(f"{label} {part * bounds[label].bound * factor:+.4g} {unit}".rstrip())
    rms = analysis.singular_values[k] / math.sqrt(len(analysis.deviation)) * 1000
    return f"{', '.join(changes)} together move the flank by only {rms:.2g} um (RMS)"


def fewest(
    columns: Mapping[Key, np.ndarray],
    deviation: np.ndarray,
    besides: np.ndarray | None = None,
    noise: float | None = None,
) -> tuple[tuple[Key, ...], tuple[float, ...]]:
    """The fewest blocks of columns (m,k) that explain deviations (m,) nearly as well as all, and RMS left after each.

    Of the least number that is enough, the choice with the least change of settings in parts of their bounds. Where
    there are too many choices to try, they are taken one by one, each that with which the least is left, and then what
    is no more needed is given back. ``besides`` (m,q) explains what it can before any is taken. It is enough where
    little is lost, or where the others gain no more than they would of noise: ``noise`` [mm] of one deviation, or what
    all of them leave, and at least what a probe resolves.
    """
    first = np.zeros((len(deviation), 0)) if besides is None else besides

    def squares(keys: Sequence[Key]) -> float:
        together = np.hstack([first, *(columns[key] for key in keys)])
        left = projection_residual(together, deviation) if together.shape[1] else deviation
        return float(left @ left)

    def change(keys: Sequence[Key]) -> float:
        together = np.hstack([first, *(columns[key] for key in keys)])
        solved, *_ = np.linalg.lstsq(together, deviation, rcond=RANK)
        return float(np.sum(solved[first.shape[1] :] ** 2))

    keys, m = list(columns), len(deviation)
    least, size = squares(keys), first.shape[1] + sum(block.shape[1] for block in columns.values())
    variance = max(least / max(m - size, 1) if noise is None else noise**2, PROBE**2)
    best = np.sqrt(least / m)
    little = m * max(best * (1 + LOSS_PART), best + LOSS) ** 2

    def enough(taken: Sequence[Key], left: float) -> bool:
        others = sum(columns[key].shape[1] for key in keys if key not in taken)
        return left <= max(little, least + _LOSS_NOISE * others * variance)

    def ordered(taken: list[Key]) -> tuple[tuple[Key, ...], tuple[float, ...]]:
        """The one first that alone leaves the least, and so on; and what is left after each."""
        one_by_one: list[Key] = []
        while len(one_by_one) < len(taken):
            rest = [key for key in taken if key not in one_by_one]
            one_by_one.append(min(rest, key=lambda key: squares([*one_by_one, key])))
        left = (float(np.sqrt(squares(one_by_one[: k + 1]) / m)) for k in range(len(taken)))
        return tuple(one_by_one), tuple(left)

    taken: list[Key] = []
    for number in range(len(keys) + 1):
        if math.comb(len(keys), number) > _MOST_CHOICES:
            break
        able = [each for each in map(list, combinations(keys, number)) if enough(each, squares(each))]
        if able:
            return ordered(min(able, key=change))
    while not enough(taken, squares(taken)):
        taken.append(min((key for key in keys if key not in taken), key=lambda key: squares([*taken, key])))
    for key in taken[:-1]:
        fewer = [other for other in taken if other != key]
        if enough(fewer, squares(fewer)):
            taken = fewer
    return ordered(taken)


def analyse(targets: Sequence[FlankTarget], free: Sequence[str] = FREE, bounds: Bounds = "machine") -> Analysis:
    """What the free settings can do to the deviations of some targets, common to all of them."""
    variables = variables_of(free, [target.vector for target in targets], bounds)
    problem = Problem(targets, variables, None, None)
    found = problem.deviations(np.zeros(len(variables)))
    if found is None:
        raise ComputationError("the flank as it was set does not cross the normals of all points")
    return Analysis(tuple(free), variables, found[1], -found[0], problem.measured)


def projection_residual(jacobian: np.ndarray, deviation: np.ndarray) -> np.ndarray:
    """What of deviations (m,) lies outside of the columns of a Jacobian (m,p): to first order none takes it away."""
    U, S, _ = np.linalg.svd(jacobian, full_matrices=False)
    shown = U[:, RANK * S.max(initial=0.0) < S]
    return deviation - shown @ (shown.T @ deviation)

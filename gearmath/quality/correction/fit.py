"""The fit behind a correction: the settings of both flanks of a member, and the rotation of the work left open."""

from __future__ import annotations

from collections.abc import Sequence, Set
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from gearmath.bevel.identify.compensation import identify, nothing_identified
from gearmath.bevel.identify.flank_target import FlankTarget
from gearmath.bevel.identify.identification import Identification
from gearmath.quality.correction.analysis import Analysis, analyse, fewest
from gearmath.quality.correction.unknown_rotation import UnknownRotation, rotation_step, step_of

#: What is left is rounding. [mm]
_ROUNDING = 1e-6
#: The open rotation and the settings are found in so many turns, until it moves no point by more than this [mm].
_TURNS, _AT_REST = 6, 1e-7
#: Trials of the noise, each at most half of the one before.
_NOISE_TRIALS = 6
#: So often other settings are tried in place of those that meet a bound.
_NEXT_BEST = 3
#: A rotation that is left open moves the points by at most so many times the largest deviation measured.
_ROTATION_PART = 3.0


@dataclass(frozen=True)
class CorrectionFit:
    """Both flanks of a member, the groups of them that share settings, and the rotation that is open."""

    targets: dict[str, FlankTarget]
    groups: Sequence[tuple[str, ...]]
    names: tuple[str, ...]
    columns: np.ndarray
    how: dict[str, Any]

    @cached_property
    def analysis(self) -> list[Analysis]:
        return [
            analyse([self.targets[flank] for flank in group], self.names, self.how["bounds"]) for group in self.groups
        ]

    def chosen(
        self, noise: float | None, without: Set[tuple[tuple[str, ...], str]] = frozenset()
    ) -> dict[tuple[str, ...], tuple[str, ...]]:
        """The fewest settings of all groups together that explain both flanks, with the rotation for nothing.

        ``without`` are groups and names of settings that are not taken.
        """
        ends = np.cumsum([0, *(len(one.deviation) for one in self.analysis)])
        columns = {}
        for k, (group, one) in enumerate(zip(self.groups, self.analysis, strict=True)):
            for name in self.names:
                block = one.jacobian[:, [variable.name == name for variable in one.variables]]
                whole_block = np.zeros((ends[-1], block.shape[1]))
                whole_block[ends[k] : ends[k + 1]] = block
                if (group, name) not in without:
                    columns[group, name] = whole_block
        measured = np.concatenate([one.deviation for one in self.analysis])
        taken, _ = fewest(columns, measured, self.columns, noise)
        return {group: tuple(name for one, name in taken if one == group) for group in self.groups}

    def solve_few(self, noise: float | None) -> tuple[dict[tuple[str, ...], Identification], UnknownRotation]:
        """By the fewest settings; where one of them meets its bound, by the next best few, if these leave less.

        What is chosen to first order knows no bounds.
        """
        taken, without = self.chosen(noise), set()
        found, rotation = self.solve(taken, noise)
        for _ in range(_NEXT_BEST):
            held = {(group, name) for group, one in found.items() for name in taken[group] if _is_held(one, name)}
            if not held:
                break
            without |= held
            others = self.chosen(noise, without)
            there, turned = self.solve(others, noise)
            if _squares(there) >= _squares(found):
                break
            taken, found, rotation = others, there, turned
        return found, rotation

    def turned(self, shift: np.ndarray) -> dict[str, FlankTarget]:
        """The targets without what a rotation makes of their points (m,) [mm]."""
        return without_shift(self.targets, shift)

    def solve(
        self, names: dict[tuple[str, ...], tuple[str, ...]], noise: float | None
    ) -> tuple[dict[tuple[str, ...], Identification], UnknownRotation]:
        """Every group by its settings, and the rotation, found in turns until it rests."""
        rotation = self._first(names, noise)
        for _ in range(_TURNS):
            now = self.turned(rotation.shift)
            found = {
                group: changed_settings([now[flank] for flank in group], names[group], noise, self.how)
                for group in self.groups
            }
            step, gain = step_of(self.columns, list(found.values()))
            before, rotation = rotation, self._limited(rotation.angles + step, gain)
            if np.abs(rotation.shift - before.shift).max(initial=0.0) <= _AT_REST:
                break
        return found, rotation

    def _first(self, names: dict[tuple[str, ...], tuple[str, ...]], noise: float | None) -> UnknownRotation:
        """The rotation to first order, before any setting is moved: what settings could do as well is left to it."""
        jacobians = [
            one.jacobian[:, [variable.name in names[group] for variable in one.variables]]
            for group, one in zip(self.groups, self.analysis, strict=True)
        ]
        levels = [one.noise if noise is None else noise for one in self.analysis]
        weights = np.repeat(levels, [jacobian.shape[1] for jacobian in jacobians])
        measured = np.concatenate([one.deviation for one in self.analysis])
        angles, gain = rotation_step(self.columns, jacobians, -measured, np.zeros(len(weights)), weights)
        return self._limited(angles, gain)

    def _limited(self, angles: np.ndarray, gain: np.ndarray) -> UnknownRotation:
        """A rotation that moves no point by much more than was measured: weak settings would turn the work for nothing.

        Errors that shift a flank as a whole change its form by about as much.
        """
        measured = np.concatenate([target.deviation for target in self.targets.values()])
        moved = float(np.abs(self.columns @ angles).max(initial=0.0))
        most = _ROTATION_PART * float(np.abs(measured).max())
        if moved <= most:
            return UnknownRotation(angles, self.columns, gain)
        return UnknownRotation(angles * most / moved, self.columns, np.zeros_like(gain))


def _is_held(found: Identification, name: str) -> bool:
    """Whether a setting stands at a bound, of any flank."""
    return any(variable.name == name and variable.label in found.active for variable in found.variables)


def _squares(found: dict[tuple[str, ...], Identification]) -> float:
    return float(sum(one.residual @ one.residual for one in found.values()))


def without_shift(targets: dict[str, FlankTarget], shift: np.ndarray) -> dict[str, FlankTarget]:
    """The targets of some flanks without a shift (m,) [mm] of their points, one flank after the other."""
    parts = np.split(shift, np.cumsum([len(target.deviation) for target in targets.values()])[:-1])
    return {
        flank: replace(target, deviation=target.deviation - part)
        for (flank, target), part in zip(targets.items(), parts, strict=True)
    }


def changed_settings(
    targets: Sequence[FlankTarget], names: Sequence[str], noise: float | None, how: dict[str, Any]
) -> Identification:
    """The change at the given noise, or at the noise that it leaves itself: at first what no setting shows."""
    if not names:
        return nothing_identified(targets)
    if noise is not None:
        return identify(targets, names, noise=noise, **how)
    level = analyse(targets, names, how["bounds"]).noise
    for _ in range(_NOISE_TRIALS):
        found = identify(targets, names, noise=level, **how)
        free = max(len(found.residual) - found.corrected_parameters, 1.0)
        left = float(np.sqrt(found.residual @ found.residual / free))
        if left > level / 2 or left <= _ROUNDING:
            break
        level = left
    return found

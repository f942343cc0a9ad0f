"""Rotation of the work that nobody knows, as a nuisance of the fit of both flanks together.

Where the work stood about its axis is no property of the gear. Once it was taken out of a file (``phase_zeroed``), by
what both flanks have in common at their reference points, it is not known any more how much of it was the gear's: an
error of a setting shifts the flanks too. So the fit leaves it open. The deviations d (m,) of both flanks are

    d = t(x) + c ω + noise        c: what a rotation of the work, φ_0, makes of every point (20.1)

With one ω for both flanks their thickness stays determined, and the true shift of a flank is found again by the shape
that belongs to it. For flanks that share no settings, ω is found jointly from the settings of both (bounded by the
noise as in ``identify``), taken off, and then each group is fitted for itself; where that moves ω, once more. Where
each flank was set to zero by itself, each has its own ω.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearmath.bevel.identify.flank_target import FlankTarget, located
from gearmath.bevel.identify.identification import Identification, damped_inverse
from gearmath.specs.bevel_set import SETTINGS
from gearmath.specs.flank_csv import COMMON, FlankFile

_PHASE = SETTINGS.index("work_rotation_offset")


@dataclass(frozen=True)
class UnknownRotation:
    """Rotations (q,) [rad] that a fit found, what they make of the points of both flanks (m,q), and their gain (q,m).

    To first order the rotations are ``gain`` times the deviations of all targets, one flank after the other.
    """

    angles: np.ndarray
    columns: np.ndarray
    gain: np.ndarray

    @property
    def shift(self) -> np.ndarray:
        """What the rotations make of the points (m,) [mm]."""
        return self.columns @ self.angles

    @property
    def projector(self) -> np.ndarray:
        """What is left of deviations (m,m) without the rotations that they tell."""
        return np.eye(len(self.columns)) - self.columns @ self.gain


def rotation_columns(targets: Sequence[FlankTarget], file: FlankFile) -> np.ndarray:
    """Columns (m,q) of the rotations that a file leaves open: none, one for both flanks, or one for each flank."""
    zeroed = file.header["phase_zeroed"].lower()
    parts = [located(target, target.vector, moving=False)[1][:, [_PHASE]] for target in targets]
    if zeroed == COMMON:
        return np.concatenate(parts)
    columns = np.zeros((sum(map(len, parts)), len(parts) if zeroed == "true" else 0))
    ends = np.cumsum([0, *map(len, parts)])
    for k in range(columns.shape[1]):
        columns[ends[k] : ends[k + 1], [k]] = parts[k]
    return columns


def rotation_step(
    columns: np.ndarray, jacobians: Sequence[np.ndarray], residual: np.ndarray, values: np.ndarray, noise: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """How the rotations (q,) change by a joint step of the settings of all groups and of them, and their gain (q,m).

    ``jacobians`` (m_g,p_g) are those of the groups, ``residual`` (m,) is predicted less measured, ``values`` (p,) the
    scaled settings of all groups, which cost ``noise`` (p,) [mm] each.
    """
    m, p = len(residual), len(values)
    slopes = np.zeros((m + p, p))
    row = column = 0
    for jacobian in jacobians:
        slopes[row : row + jacobian.shape[0], column : column + jacobian.shape[1]] = jacobian
        row, column = row + jacobian.shape[0], column + jacobian.shape[1]
    slopes[m:] = np.diag(noise)
    back = np.linalg.pinv(columns)
    # what rotation and a setting may both explain is rotation: the settings see what no rotation explains
    blind = np.eye(m + p)
    blind[:m, :m] -= columns @ back
    inverse = (damped_inverse(blind @ slopes) @ blind)[:, :m]
    change = inverse @ (slopes[:m] @ values - residual) - values  # of all that fit alike, the least values
    return -back @ (residual + slopes[:m] @ change), back @ (np.eye(m) - slopes[:m] @ inverse)


def step_of(columns: np.ndarray, found: Sequence[Identification]) -> tuple[np.ndarray, np.ndarray]:
    """``rotation_step`` at what was identified of every group."""
    return rotation_step(
        columns,
        [one.jacobian for one in found],
        np.concatenate([one.residual for one in found]),
        np.concatenate([one.values / one.scale for one in found]),
        np.concatenate([np.full(len(one.values), one.noise) for one in found]),
    )

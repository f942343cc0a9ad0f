"""Deviations of points as coefficients of the cubic surface (6.3): a linear map, for one flank or for several."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gearmath.errors import InputError
from gearmath.kernels import kernel

if TYPE_CHECKING:
    from gearmath.bevel.identify.flank_target import FlankTarget

COEFFICIENTS = 10


def surface_map(targets: Sequence[FlankTarget], weights: np.ndarray | None = None) -> np.ndarray:
    """The matrix (10 t, m) that makes √ω_j c_j of the deviations of t targets, one after the other.

    The objective of the source text is half the sum of squares of its result. Without ``weights`` (10,) a coefficient
    counts as what its term does to the flank: ω_j is the number of points times the mean square of its monomial, so
    that the sum of squares compares with that of the points. Raises InputError where the points do not determine ten
    coefficients.
    """
    blocks = []
    for target in targets:
        if target.place is None:
            raise InputError("objective = surface: the targets have no local coordinates")
        _, monomials = kernel("deviation_surface")(*target.place.T, np.zeros(COEFFICIENTS))
        size = np.sqrt(np.sum(monomials**2, axis=0))
        fit, rank = np.linalg.pinv(monomials / size, rcond=1e-9), np.linalg.matrix_rank(monomials / size, 1e-9)
        if rank < COEFFICIENTS:
            raise InputError(
                f"objective = surface: {len(target.place)} points determine {rank} of the {COEFFICIENTS} coefficients "
                "of the cubic surface"
            )
        factor = np.ones(COEFFICIENTS) if weights is None else np.sqrt(weights) / size
        blocks.append(factor[:, None] * fit)
    rows, columns = COEFFICIENTS * len(blocks), sum(block.shape[1] for block in blocks)
    matrix, at = np.zeros((rows, columns)), 0
    for k, block in enumerate(blocks):
        matrix[COEFFICIENTS * k : COEFFICIENTS * (k + 1), at : at + block.shape[1]] = block
        at += block.shape[1]
    return matrix

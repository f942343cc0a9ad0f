"""When a correction must not be written: points that do not tell the settings, and flanks that it makes worse."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gearmath.bevel.identify.flank_target import FlankTarget
from gearmath.bevel.identify.identification import RANK, Identification
from gearmath.errors import ComputationError, InputError
from gearmath.quality.correction.analysis import analyse

#: What a correction may add to the RMS of a flank that is as good as perfect: no probe shows it. [mm]
_WORSE = 5e-5
#: A point that was left out must be predicted this well: the variance of the prediction against that of one point.
_LEVERAGE = 4.0


def check_determined(name: str, group: Sequence[str], targets: Sequence[FlankTarget], names: Sequence[str]) -> None:
    """Raise InputError where the points that are left do not tell what the settings do at those left out."""
    if all(target.left_out is None for target in targets):
        return
    known = analyse(targets, names).jacobian
    whole_grid = analyse([target.left_out or target for target in targets], names).jacobian
    spread = np.linalg.pinv(known, rcond=RANK)
    worst = float(np.max(np.sum((whole_grid @ spread) ** 2, axis=1)))
    if len(known) < known.shape[1] or worst > _LEVERAGE:
        raise InputError(
            f"{name} {' and '.join(group)}: {len(known)} points are left of "
            f"{sum(target.grid_points for target in targets)}: too few to tell what {len(names)} settings do at the "
            "others; measure them, or name fewer settings with --settings"
        )


def rms_of_flanks(measured: Sequence[np.ndarray], result: Identification) -> list[tuple[float, float]]:
    """RMS [mm] of the deviations of every flank as they were measured, and as they are expected to remain."""
    pieces = np.split(result.residual, np.cumsum([len(one) for one in measured])[:-1])
    return [
        (float(np.sqrt(np.mean(one**2))), float(np.sqrt(np.mean(piece**2))))
        for one, piece in zip(measured, pieces, strict=True)
    ]


def made_worse(group: Sequence[str], measured: Sequence[np.ndarray], result: Identification, noise: float) -> list[str]:
    """The flanks that a correction makes worse, by more than the noise of a point."""
    pairs = zip(group, rms_of_flanks(measured, result), strict=True)
    return [flank for flank, (before, after) in pairs if after > before + max(_WORSE, noise)]


def refuse_worse(
    name: str, group: Sequence[str], measured: Sequence[np.ndarray], result: Identification, noise: float
) -> None:
    """Raise ComputationError where a correction makes one of its flanks worse."""
    if worse := made_worse(group, measured, result, noise):
        figures = ", ".join(
            f"{flank} {before * 1000:.3f} to {after * 1000:.3f} um"
            for flank, (before, after) in zip(group, rms_of_flanks(measured, result), strict=True)
        )
        names = ", ".join(variable.label for variable in result.variables) or "no setting"
        raise ComputationError(
            f"{name}: the correction by {names} makes the {' and '.join(worse)} flank worse (RMS {figures}); nothing "
            "is written; name other settings with --settings"
        )

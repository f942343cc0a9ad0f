"""Stock division: how a precut blank must stand so that both flanks have enough left to be finished.

What a flank has more than its nominal surface is stock. Turned by ε and advanced by a, it changes by the rigid motion
(18.2). The least stock of all points is a concave function of ε, so that its greatest value is found by halving: there
both flanks share. An advance gives stock to both flanks and takes depth; it is chosen where the stock is most even.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gearmath.errors import ComputationError, InputError
from gearmath.kernels import kernel
from gearmath.quality.evaluation.file_checks import check_belongs, check_points
from gearmath.quality.evaluation.nominal import nominal_rows
from gearmath.shown import Shown, Shows
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.flank_csv import FlankFile

#: A blank farther off than this was not probed in its own space. [rad], [mm]
MOST_TURN, MOST_ADVANCE = 0.2, 2.0
#: t_z and ω_z of the rigid motion (18.2).
_ADVANCE, _TURN = 2, 5
_HALVINGS = 80


@dataclass(frozen=True, repr=False)
class Stock(Shown):
    """How the work is turned [rad] and advanced [mm], and by flank its least, mean and most stock [mm] there.

    ``least_before`` is what there is as the work stands now. The turn is right-handed about the work's axis from toe to
    heel; it may be added to the work_rotation_offset of both flanks instead, and the advance be taken away from
    machine_center_to_crossing_point.
    """

    turn: float
    advance: float
    least: dict[str, float]
    mean: dict[str, float]
    most: dict[str, float]
    least_before: dict[str, float]

    def _shown(self) -> tuple[str, list[Shows]]:
        figures: list[Shows] = [("turn", math.degrees(self.turn), "degrees"), ("advance", self.advance, "mm")]
        parts = ("least", self.least), ("mean", self.mean), ("most", self.most), ("least before", self.least_before)
        figures += [(f"{name}, {flank}", value, "mm") for name, by in parts for flank, value in by.items()]
        return "how the blank must stand", figures


def share_stock(member: Member, measured: FlankFile, advance: bool = False, least: float = 0.0) -> Stock:
    """The rotation that leaves the most stock where there is least; with ``advance`` after a shift that makes it even.

    ``measured`` is the probed blank, judged against the flanks to be finished. Raises InputError if the file is not of
    this member, not on its flanks, has no deviations or lacks a flank, and ComputationError if less than ``least`` [mm]
    remains somewhere.
    """
    check_belongs(member, measured)
    check_points(measured, nominal_rows(measured, member), member)
    kept = measured.pick(~np.isnan(measured.deviation))
    for flank in FLANKS:
        if not (kept.flank == flank).any():
            raise InputError(f"{flank} flank: no point has a deviation; stock is shared between both flanks")
    (rates,) = kernel("motion_sensitivity")(kept.point, kept.normal)
    by_turn, by_advance = rates[:, _TURN], rates[:, _ADVANCE]

    def spread(moved: float) -> float:
        """How far the most stock lies above the least, at the turn that brings them closest."""
        stock = kept.deviation + moved * by_advance
        turn = _lowest(lambda angle: float(np.ptp(stock + angle * by_turn)), MOST_TURN)
        return float(np.ptp(stock + turn * by_turn))

    shift = _lowest(spread, MOST_ADVANCE) if advance else 0.0
    advanced = kept.deviation + shift * by_advance
    turn = _highest(lambda angle: float(by_turn[np.argmin(advanced + angle * by_turn)]), MOST_TURN)
    stock = advanced + turn * by_turn
    before = _by_flank(kept, kept.deviation, np.min)
    least_there, mean, most = (_by_flank(kept, stock, how) for how in (np.min, np.mean, np.max))
    found = Stock(turn, shift, least_there, mean, most, before)
    k = int(np.argmin(stock))
    if stock[k] < least:
        raise ComputationError(
            f"{member.name}: does not clean up: {stock[k] * 1000:.1f} um remain on the {kept.flank[k]} flank, tooth "
            f"{kept.tooth[k]}, row {kept.row[k]}, col {kept.col[k]}, where {least * 1000:g} um are needed"
        )
    return found


def _by_flank(file: FlankFile, stock: np.ndarray, how: Callable) -> dict[str, float]:
    return {flank: float(how(stock[file.flank == flank])) for flank in FLANKS}


def _highest(slope: Callable[[float], float], limit: float) -> float:
    """Where a concave piecewise linear function is highest, by the sign of its slope."""
    low, high = -limit, limit
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if slope(middle) > 0 else (low, middle)
    return (low + high) / 2


def _lowest(value: Callable[[float], float], limit: float) -> float:
    """Where a convex function is lowest, by the golden section."""
    ratio = (np.sqrt(5) - 1) / 2
    low, high = -limit, limit
    a, b = high - ratio * (high - low), low + ratio * (high - low)
    at_a, at_b = value(a), value(b)
    for _ in range(_HALVINGS):
        if at_a < at_b:
            high, b, at_b = b, a, at_a
            a = high - ratio * (high - low)
            at_a = value(a)
        else:
            low, a, at_a = a, b, at_b
            b = low + ratio * (high - low)
            at_b = value(b)
    return float((low + high) / 2)

"""A pair as it was measured: which of its flanks have deviations on them, and how it runs on these."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from gearmath.bevel.contact.mesh import Mesh
from gearmath.bevel.contact.report import SIDES
from gearmath.bevel.contact.surface import nominal_surface
from gearmath.bevel.contact.system import System, pair_system
from gearmath.errors import InputError
from gearmath.quality.contact.flank import MeasuredFlank, measured_flank
from gearmath.quality.contact.uncertainty import uncertain_contact
from gearmath.quality.evaluation.member import evaluate_member
from gearmath.specs.bevel_set import FLANKS, MEMBERS, BevelSet
from gearmath.specs.flank_csv import FlankFile


@dataclass(frozen=True)
class MeasuredPair:
    """A set, and its measured flanks by member and flank; a flank that is not there is taken as nominal."""

    pair: BevelSet
    flanks: dict[tuple[str, str], MeasuredFlank | None] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()

    def of(self, side: str) -> tuple[MeasuredFlank | None, MeasuredFlank | None]:
        """The measured flanks of pinion and gear that work on a side."""
        pinion, gear = (self.flanks.get(key) for key in _working(side))
        return pinion, gear

    def system(self, side: str) -> System:
        """Both flanks of a side in the frame of the pair."""
        surfaces = [
            nominal_surface(self.pair.member(name), flank) if measured is None else measured.surface
            for (name, flank), measured in zip(_working(side), self.of(side), strict=True)
        ]
        return pair_system(surfaces[0], surfaces[1], self.pair.rad("shaft_angle"))

    def figures(self, side: str, run: Mesh) -> dict[str, Any]:
        """What was measured on the flanks of a side, and how sure its contact is; nothing for a nominal pair."""
        names = {name for name, _ in self.flanks}
        if not names:
            return {}
        sure = uncertain_contact(run, self.of(side))
        return {
            "measured": {
                name: None if one is None else {"rms_um": _rms(one.deviation), "spline_residual_um": _rms(one.residual)}
                for name, one in zip(MEMBERS, self.of(side), strict=True)
                if name in names
            },
            "uncertainty": None if sure is None else sure.as_dict(),
        }


def flanks_of(
    pair: BevelSet, name: str, file: FlankFile
) -> tuple[dict[tuple[str, str], MeasuredFlank | None], tuple[str, ...]]:
    """The measured flanks of a member by member and flank, and what is to be said of the file first.

    Raises InputError where it is not of the member, or holds no tooth in full.
    """
    member = pair.member(name)
    evaluation = evaluate_member(file, member)
    evaluation.closing.check_topography()
    found = {(name, flank): measured_flank(member, flank, file, evaluation) for flank in FLANKS}
    if all(one is None for one in found.values()):
        raise InputError("holds no tooth that was measured in full, which contact needs")
    return found, evaluation.first


def _working(side: str) -> tuple[tuple[str, str], tuple[str, str]]:
    own = SIDES[side]
    return ("pinion", own), ("gear", FLANKS[1 - FLANKS.index(own)])


def _rms(values: np.ndarray) -> float:
    """In µm."""
    return float(np.sqrt(np.mean(values**2))) * 1000

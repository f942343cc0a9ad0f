"""The flanks that settings are looked for, as points: a flank file of one member, all its teeth on one."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearmath.bevel.generation import Generation, Section, SurfacePoints, solve_section
from gearmath.bevel.turning import turned
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import FlankFile


@dataclass(frozen=True)
class GivenFlank:
    """Points (n,3) of a flank of space 0 in the work frame [mm], outward normals (n,3), their row and column (n,)."""

    point: np.ndarray
    normal: np.ndarray
    row: np.ndarray
    col: np.ndarray

    @property
    def along(self) -> np.ndarray:
        """Cone distances (n,) of the points [mm]."""
        return np.linalg.norm(self.point, axis=1)

    @property
    def up(self) -> np.ndarray:
        """Angles (n,) of the points from the work axis [rad], larger towards the tip of the tooth."""
        return np.arctan2(np.hypot(self.point[:, 0], self.point[:, 1]), self.point[:, 2])

    def places(self, how: Generation) -> SurfacePoints:
        """Where settings cut the places of the points on the blank; the residual marks what they do not cut."""
        blade = Section(0.0, 1.0, float(how.settings[-2]), float(how.settings[-1]))
        return solve_section(how, blade, self.point[:, 2], np.hypot(self.point[:, 0], self.point[:, 1]))

    def cut_by(self, how: Generation) -> GivenFlank:
        """The flank that settings cut at the places of the points which they cut at all."""
        at = self.places(how)
        return GivenFlank(*(one[at.converged] for one in (at.point, at.normal, self.row, self.col)))

    def turned(self, angle: float) -> GivenFlank:
        """The flank turned about z_w by an angle [rad]."""
        return replace(self, point=turned(self.point, angle), normal=turned(self.normal, angle))


def given_flanks(file: FlankFile, teeth: int) -> dict[str, GivenFlank]:
    """Both flanks of a file, its teeth turned onto the first one, each place the mean of all teeth that have it.

    Raises InputError where a flank is missing, the file is of another number of teeth, or its thickness was taken out.
    """
    if file.header["member_teeth"] != str(teeth):
        raise InputError(f"member_teeth = {file.header['member_teeth']}: the {file.member} of the blank has {teeth}")
    if file.header["phase_zeroed"].lower() == "true":
        raise InputError(
            "phase_zeroed = true: each flank was turned to zero at its reference point, so that the points tell no "
            "tooth thickness; it must be false or common"
        )
    found = {flank: _mean_of_teeth(file.select(flank), teeth) for flank in FLANKS}
    for flank, given in found.items():
        if not len(given.point):
            raise InputError(f"holds no point of the {flank} flank, both flanks are needed")
    return found


def _mean_of_teeth(points: FlankFile, teeth: int) -> GivenFlank:
    back = -2 * math.pi * points.tooth / teeth
    keys, place = np.unique(np.stack([points.row, points.col], axis=1), axis=0, return_inverse=True)
    point, normal = np.zeros((len(keys), 3)), np.zeros((len(keys), 3))
    for tooth in np.unique(points.tooth):
        at = points.tooth == tooth
        angle = float(back[at][0])
        np.add.at(point, place.ravel()[at], turned(points.point[at], angle))
        np.add.at(normal, place.ravel()[at], turned(points.normal[at], angle))
    count = np.bincount(place.ravel(), minlength=len(keys))[:, None]
    return GivenFlank(
        point / np.maximum(count, 1), normal / np.linalg.norm(normal, axis=1, keepdims=True), *keys.reshape(-1, 2).T
    )

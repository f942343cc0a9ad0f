"""The pair in mesh: where both members stand in one frame when their driving flanks touch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmath.bevel.contact.mesh import mesh
from gearmath.bevel.contact.report import side_system
from gearmath.bevel.contact.system import Assembly
from gearmath.bevel.solid import member_triangles
from gearmath.bevel.tooth import tooth_space
from gearmath.errors import ComputationError
from gearmath.exchange.body import member_patches
from gearmath.exchange.spline import Patch
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import MEMBERS, BevelSet


@dataclass(frozen=True)
class Pose:
    """How a member stands in the frame of the pair: r = matrix·R + shift [mm]."""

    matrix: np.ndarray
    shift: np.ndarray

    def of(self, points: np.ndarray) -> np.ndarray:
        """Points (..., 3) of the work frame in that of the pair."""
        return points @ self.matrix.T + self.shift


def poses(pair: BevelSet, side: str = "drive", rotation: float = 0.0) -> dict[str, Pose]:
    """Both members in the frame of the pair (pinion axis Z, gear axis X), touching on one side at rotation 0.

    The pinion is turned from there by ``rotation`` [rad], the gear by the ratio of the teeth: as a pair turns, but for
    its transmission error. Raises ComputationError where the flanks of that side do not touch there.
    """
    system = side_system(pair, side)
    turn = mesh(system, Assembly()).reference
    if turn is None:
        raise ComputationError(
            f"the flanks of the {side} side do not touch where both mean points are on the pitch line"
        )
    gear_turn = turn - system.ratio * rotation
    nowhere, still = np.zeros(3), np.zeros(4)
    found = {}
    for name, surface, angle in zip(MEMBERS, (system.pinion, system.gear), (rotation, gear_turn), strict=True):
        place = (system.shaft_angle, system.offset) if name == "gear" else ()
        azimuth = angle + system.phase[MEMBERS.index(name)]
        shift, _ = kernel(f"{name}_in_pair")(nowhere, nowhere, azimuth, surface.apex_beyond, *place, still)
        columns = [
            kernel(f"{name}_in_pair")(nowhere, axis, azimuth, surface.apex_beyond, *place, still)[1]
            for axis in np.eye(3)
        ]
        found[name] = Pose(np.column_stack(columns), shift)
    return found


def pair_patches(pair: BevelSet, side: str = "drive") -> list[tuple[str, list[Patch]]]:
    """Both members in mesh as closed surfaces of patches, by name."""
    return [
        (name, [patch.moved(pose.matrix, pose.shift) for patch in member_patches(pair.member(name))])
        for name, pose in poses(pair, side).items()
    ]


def pair_triangles(pair: BevelSet, side: str = "drive") -> np.ndarray:
    """Both members in mesh as closed surfaces of triangles (n,3,3)."""
    members = {name: pair.member(name) for name in MEMBERS}
    return np.concatenate(
        [
            pose.of(member_triangles(members[name], tooth_space(members[name])))
            for name, pose in poses(pair, side).items()
        ]
    )

"""The nominal points of a flank as a file of measured points has them."""

from __future__ import annotations

import math

import numpy as np

from gearmath.bevel.flank import Grid, solve_flank
from gearmath.bevel.turning import turned
from gearmath.specs.bevel_set import Member, design_sha256
from gearmath.specs.flank_csv import FlankFile, flank_file
from gearmath.specs.margins import OWN, Margins

MARGIN = 0.1


def flank_header(member: Member, shape: tuple[int, int], margin: float | Margins | None = MARGIN) -> dict[str, str]:
    """The header of a flank file of a member and of a grid of this shape; without margins it has own places."""
    rows, columns = shape
    return {
        "member": member.name,
        "member_teeth": str(member.teeth),
        "frame": "w",
        "unit": "mm",
        "grid": f"{rows}x{columns}",
        "margins": OWN if margin is None else str(Margins.alike(margin) if isinstance(margin, float) else margin),
        "reference_point": f"{rows // 2},{columns // 2}",
        "phase_zeroed": "false",
        "tip_radius_mm": "0",
        "settings_sha256": design_sha256(member),
    }


def nominal_flank(
    member: Member, flank: str, grid: Grid, margin: float | Margins | None = MARGIN, tooth: int = 0
) -> FlankFile:
    """The nominal points of one flank of one tooth as a flank file."""
    points = solve_flank(member, flank, grid)
    row, col = (index.ravel() for index in np.indices(grid.shape))
    angle = 2 * math.pi * tooth / member.teeth
    header = flank_header(member, grid.shape, margin)
    return flank_file(
        header, member.name, flank, tooth, row, col, turned(points.point, angle), turned(points.normal, angle)
    )

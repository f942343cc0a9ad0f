"""The closed surface of a whole member as spline patches: flanks, fillets, roots, lands, end faces, inside of the rim.

Every patch between tip and root has a companion on the cone inside the rim, and a ruled one at toe and heel between
both; all have their borders in common. The solid is that of the STL, without its facets.
"""

from __future__ import annotations

from itertools import groupby

import numpy as np

from gearmath.bevel.solid import between, rim
from gearmath.bevel.tooth import SpaceFlank, ToothSpace, tooth_space
from gearmath.bevel.turning import turned
from gearmath.exchange.spline import Patch, through
from gearmath.specs.bevel_set import Member

#: Points across root and land, columns from toe to heel, and rows of the parts of a blade that cut.
_ACROSS, COLUMNS = 7, 21
ROWS = {"main": 11, "toprem": 9, "edge": 17}


def member_patches(member: Member) -> list[Patch]:
    """The patches of a whole member, in its work frame; their normals need not point one way.

    Raises InputError naming member, flank and place where the cutter makes no tooth.
    """
    space = tooth_space(member, COLUMNS, tuple(ROWS.items()))
    grids = space_grids(space)
    patches = []
    for tooth in range(member.teeth):
        for grid in grids:
            patches += _cell(member, turned(grid, tooth * space.pitch))
    return patches


def space_grids(space: ToothSpace) -> list[np.ndarray]:
    """Points (rows, columns, 3) of the parts of one space, across it: each begins where the one before ends."""
    low, high = space.ordered
    down = _parts(low)
    up = [part[::-1] for part in reversed(_parts(high))]
    fractions = np.linspace(0, 1, _ACROSS)
    root = between(low.point[-1], high.point[-1], fractions).transpose(1, 0, 2)
    land = between(high.point[0], turned(low.point[0], space.pitch), fractions).transpose(1, 0, 2)
    return [*down, root, *up, land]


def _parts(surface: SpaceFlank) -> list[np.ndarray]:
    """The rows of a flank by the part of the blade that cuts them, tip to root; neighbors share a row."""
    parts, first = [], 0
    for _, rows in groupby(surface.section):
        last = first + len(list(rows))
        parts.append(surface.point[max(first - 1, 0) : last])
        first = last
    return parts


def _cell(member: Member, grid: np.ndarray) -> list[Patch]:
    """A part of the surface, its companion inside the rim, and the ruled faces between both at toe and heel."""
    inner = rim(member, grid)
    ends = [through(np.stack([grid[:, k], inner[:, k]])) for k in (0, -1)]
    return [through(grid), through(inner), *ends]

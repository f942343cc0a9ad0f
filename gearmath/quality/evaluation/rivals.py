"""What single errors of machine and cutter do to all points of a member, beside a shift of the work along its axis.

Where one of them explains the deviations better, such a shift is not the likeliest cause.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from gearmath.bevel.flank import solve_flank
from gearmath.bevel.grid import file_grid
from gearmath.bevel.identify.blade import by_foot, nominal_curvature
from gearmath.bevel.identify.flank_target import FlankTarget, located
from gearmath.bevel.method import generation_of
from gearmath.errors import InputError
from gearmath.quality.evaluation.topography import grid_shape
from gearmath.specs.bevel_set import FLANKS, MACHINE_SETTINGS, SETTINGS, Member
from gearmath.specs.flank_csv import FlankFile

#: The twin of the shift, and what turns the work alone.
_NO_RIVALS = ("machine_center_to_crossing_point", "work_rotation_offset")
_TWIN, _DEPTH = (SETTINGS.index(key) for key in ("machine_center_to_crossing_point", "sliding_base"))


def rival_columns(file: FlankFile, member: Member) -> Iterator[tuple[str, np.ndarray]]:
    """What it is, and the column (n,) that it makes of the deviations of a file, for an error of each setting alone.

    Of settings of the machine and of blades, alike on both flanks; where each flank has a cut of its own, also on one
    of them; of the X axis of a vertical machine, which moves the cutter in the machine plane; and of the radius of the
    tip of a probe. Raises InputError where a flank cannot be computed.
    """
    rates, along_x = np.zeros((len(file), len(SETTINGS))), np.zeros(len(file))
    for flank in FLANKS:
        here = file.flank == flank
        for tooth in np.unique(file.tooth[here]):
            rows = here & (file.tooth == tooth)
            found = _rates(file, member, flank, int(tooth))
            rates[rows] = found[file.row[rows] * grid_shape(file)[1] + file.col[rows]]
        tilt = member.flank(flank).nominal.rad("machine_root_angle")
        along_x[here] = rates[here, _TWIN] + math.sin(tilt) * rates[here, _DEPTH]
    for k, key in enumerate(SETTINGS):
        if key in _NO_RIVALS:
            continue
        yield key, rates[:, k]
        if not (member.cutting == "completing" and key in MACHINE_SETTINGS):
            for flank in FLANKS:
                yield key, np.where(file.flank == flank, rates[:, k], 0.0)
    yield "the X axis", along_x
    yield "the tip radius", np.ones(len(file))


def _rates(file: FlankFile, member: Member, flank: str, tooth: int) -> np.ndarray:
    """Derivatives (grid,12) of the deviations on the grid of a tooth by the settings."""
    spec = member.flank(flank)
    nominal = by_foot(spec, solve_flank(member, flank, file_grid(file, member, flank, tooth)))
    none = np.zeros(len(nominal.point))
    how, blade = generation_of(member, flank), (nominal_curvature(spec), spec.blade_reference_height)
    target = FlankTarget(how, nominal, none, *blade)
    _, rates, failed = located(target, target.vector, moving=False)
    if failed.any():
        raise InputError(f"{member.name} {flank} flank: a nominal point is not found again")
    return rates[:, : len(SETTINGS)]

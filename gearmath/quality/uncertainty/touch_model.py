"""From how well a machine measures to the covariance of the deviations it measured.

Every touch is seen in the place of the axes where it was made; how its deviation depends on their errors is the
derivative of equation (22.2) at zero error, by CasADi.
"""

from __future__ import annotations

from functools import cache

import casadi as ca
import numpy as np

from gearmath.bevel.flank import Grid, solve_flank
from gearmath.bevel.grid import file_grid
from gearmath.kernels import kernel
from gearmath.machine.bodies.probe_tip import probe_height
from gearmath.machine.planning.targets import tip_positions
from gearmath.quality.evaluation.topography import grid_shape
from gearmath.quality.uncertainty.covariance import Covariance
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.calibration import Calibration
from gearmath.specs.flank_csv import FlankFile
from gearmath.specs.measurement import MeasuringModel
from gearmath.specs.milling_machine import MillingMachine


@cache
def _slopes() -> ca.Function:
    """∂δ_e/∂e (1,6) at zero error, of axes, height, tip offset, point, normal and pivot offset."""
    error = kernel("touch_error").function
    names = error.name_in()
    slope = error.factory("touch_slope", names, [f"jac:{error.name_out(0)}:{names[0]}"])
    given = [ca.MX.sym(name, error.size1_in(k)) for k, name in enumerate(names[1:], 1)]
    return ca.Function("touch_slope_at_zero", given, [slope(ca.DM.zeros(6), *given)])


def sensitivities(
    member: Member, flank: str, grid: Grid, machine: MillingMachine, calibration: Calibration
) -> np.ndarray:
    """Change of the deviation at the points of a flank per unit of X, Y, Z, A, squareness and growth (n,6).

    The same for every tooth: the work turns, and the axes but A stand where they stood. Squareness acts from the height
    at which the tip was calibrated, whose offset in X is that of this height.
    """
    points, opposite = (solve_flank(member, each, grid) for each in (flank, _other(flank)))
    (tip,) = kernel("probe_target")(points.point, points.normal, calibration.tip_radius, 0.0)
    (A,) = kernel("space_azimuth")(points.point, opposite.point)
    axes = tip_positions(tip, A, member.blank.delta_f, machine, calibration)
    n = len(axes)
    slopes = _slopes().map(n)(
        axes.T,
        probe_height(machine, calibration),
        calibration.tip_offset,
        points.point.T,
        points.normal.T,
        machine.pivot,
    )
    found = np.array(slopes).reshape(n, 6)
    artefact = calibration.sphere or calibration.ring
    found[:, 4] -= found[:, 0] * (artefact.center[2] if artefact else 0.0)
    return found


def touch_covariance(
    file: FlankFile, member: Member, how: MeasuringModel, machine: MillingMachine, calibration: Calibration
) -> Covariance:
    """Covariance of the deviations (n,) of a measured file, in its order.

    Raises ComputationError where the nominal flank has no point at a place of the grid.
    """
    place = file.row * grid_shape(file)[1] + file.col
    slope = np.empty((len(file), 6))
    for flank in FLANKS:
        here = file.flank == flank
        if here.any():
            slope[here] = sensitivities(member, flank, file_grid(file, member, flank), machine, calibration)[
                place[here]
            ]
    linear = np.linalg.norm(slope[:, :3], axis=1) * how.position_um / 1000
    shared = [
        ("probe calibration", np.full(len(file), how.pretravel_um / 1000), file.flank == FLANKS[0]),
        ("work axis", slope[:, 3] * how.work_axis, file.tooth % member.teeth),
        ("linear axes", linear, 2 * place + (file.flank == FLANKS[0])),
        ("squareness", slope[:, 4] * how.squareness_um_per_m * 1e-6, np.zeros(len(file))),
        ("temperature", slope[:, 5] * how.growth, np.zeros(len(file))),
    ]
    names, columns_of = [], []
    for source, effect, group in shared:
        for value in np.unique(group):
            column = np.where(group == value, effect, 0.0)
            if column.any():
                names.append(source)
                columns_of.append(column)
    factors = np.stack(columns_of, axis=1) if columns_of else np.empty((len(file), 0))
    return Covariance(np.full(len(file), how.touch**2), factors, tuple(names))


def _other(flank: str) -> str:
    return FLANKS[1 - FLANKS.index(flank)]

"""From raw touches to measured points: corrected for the tip, averaged, with the deviation from the nominal flank."""

from __future__ import annotations

import math

import numpy as np

from gearmath.bevel.flank import Grid, blank_grid, solve_flank
from gearmath.bevel.nominal_file import flank_header
from gearmath.bevel.turning import turned
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.machine.bodies.probe_tip import lobing, probe_height
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.calibration import Calibration
from gearmath.specs.flank_csv import PLANNED, FlankFile
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.touch_csv import Touches

#: A touch this far from its nominal place is of another point, set or set-up. [mm]
_SAME_POINT = 3.0
#: Touches of one point this far from their mean are not all of the flank. [mm]
_SAME_TOUCH = 0.02


def measured_member(touches: Touches, member: Member, machine: MillingMachine, calibration: Calibration) -> FlankFile:
    """The corrected contact points (15.5) of the touches, with their deviations from the nominal flanks.

    Points come in the order in which they were touched; tooth z is tooth 0 again. The touches of one point are
    averaged, and ``uncertainty`` is that of the average, from the scatter of all points; one touch tells none. A point
    that no touch met stays in the file, nominal and without a deviation. How many points the program plans stands in
    its header, where the run says it.
    Raises InputError for touches of another member, off the grid, far from their nominal place or from each other.
    ``search_lines`` tells more of their place.
    """
    grid = blank_grid(member)
    check_on_grid(touches, member, grid)
    tip, _ = kernel("probe_tip")(
        touches.axes, probe_height(machine, calibration), calibration.tip_offset, machine.pivot
    )
    point, normal = _nominal(touches, member, grid)
    # at the origin of the work, without offsets: the normal in the axes of the machine
    (machine_normal,) = kernel("probe_axes")(normal, *touches.axes[:, 3:].T, 0.0, np.zeros(3), np.zeros(3))
    (radius,) = kernel("effective_radius")(machine_normal[:, :3], calibration.tip_radius, lobing(calibration))
    contact, deviation = kernel("touched_point")(tip, radius, point, normal)
    met = touches.triggered
    _check_place((contact - point)[met], touches.pick(met))
    header = {**flank_header(member, grid.shape), "tip_radius_mm": f"{calibration.tip_radius:g}"}
    contact, deviation = np.where(met[:, None], contact, point), np.where(met, deviation, np.nan)
    return _averaged(header, touches, contact, normal, deviation)


def check_on_grid(touches: Touches, member: Member, grid: Grid) -> None:
    """Raise InputError for touches of another member, or off its teeth and its grid."""
    if touches.member != member.name:
        raise InputError(f"the touches are of the {touches.member}, not of the {member.name}")
    rows, columns = grid.shape
    for what, values, last in (
        ("row", touches.row, rows - 1),
        ("col", touches.col, columns - 1),
        ("tooth", touches.tooth, member.teeth),
    ):
        if (values > last).any():
            raise InputError(
                f"{what} = {int(values.max())}: the {member.name} and its grid {rows}x{columns} end at {last}"
            )


def _nominal(touches: Touches, member: Member, grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """Points and normals (n,3) that the touches were meant for."""
    point, normal = np.empty((2, len(touches), 3))
    turn = 2 * math.pi * touches.tooth / member.teeth
    place = touches.row * grid.shape[1] + touches.col
    for flank in (flank for flank in FLANKS if (touches.flank == flank).any()):
        here = touches.flank == flank
        nominal = solve_flank(member, flank, grid)
        point[here], normal[here] = nominal.point[place[here]], nominal.normal[place[here]]
    return turned(point, turn), turned(normal, turn)


def _averaged(
    header: dict[str, str], touches: Touches, contact: np.ndarray, normal: np.ndarray, deviation: np.ndarray
) -> FlankFile:
    """One row a point: means of its touches, and the uncertainty of the mean from the scatter of all points."""
    places = np.stack([touches.flank == FLANKS[0], touches.tooth, touches.row, touches.col])
    first = np.flatnonzero(np.append(True, (np.diff(places.astype(int), axis=1) != 0).any(axis=0)))
    often = np.diff(np.append(first, len(touches)))
    point_of, met = np.repeat(np.arange(len(first)), often), touches.triggered
    count = np.bincount(point_of[met], minlength=len(first))
    known = count > 0
    mean = np.full(len(first), np.nan)
    mean[known] = np.bincount(point_of[met], deviation[met], len(first))[known] / count[known]
    off = (deviation - mean[point_of])[met]
    _check_scatter(off, touches.pick(met))
    more = int(met.sum() - known.sum())
    sigma = math.sqrt(float(off @ off) / more) if more else math.nan
    # of a point that was met, the mean of the touches that met it; else its nominal place
    weight = np.where(known[point_of], met / np.maximum(count, 1)[point_of], 1 / often[point_of])
    if touches.planned is not None:
        header = header | {PLANNED: f"{math.ceil(touches.planned / often.max())} points"}
    return FlankFile(
        header,
        touches.member,
        touches.flank[first],
        touches.tooth[first],
        touches.row[first],
        touches.col[first],
        np.add.reduceat(contact * weight[:, None], first),
        normal[first],
        mean,
        np.where(known, sigma / np.sqrt(np.maximum(count, 1)), np.nan),
    )


def _check_scatter(off: np.ndarray, touches: Touches) -> None:
    wide = np.abs(off) > _SAME_TOUCH
    if wide.any():
        k = int(np.argmax(wide))
        raise InputError(
            f"{touches.name_of(k)}: one of its touches lies {abs(off[k]) * 1000:.1f} um from their mean, the limit is "
            f"{_SAME_TOUCH * 1000:g} um; was there a chip on the flank, or did the probe miss it?"
        )


def _check_place(off: np.ndarray, touches: Touches) -> None:
    distance = np.linalg.norm(off, axis=1)
    far = distance > _SAME_POINT
    if far.any():
        k = int(np.argmax(far))
        raise InputError(
            f"{touches.name_of(k)}: the touch lies {distance[k]:.3f} mm from its nominal place, the limit is "
            f"{_SAME_POINT} mm; is it of this set, machine and calibration?"
        )

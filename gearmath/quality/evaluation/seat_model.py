"""What a registration leaves free, and whether the points still tell the seat: the linear model behind the fit."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearmath.errors import InputError, counted
from gearmath.quality.evaluation.nominal import NominalRows
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.flank_csv import FlankFile

#: Of the components of a small motion (18.2), those of the seat: along x, y and about x, y.
SEAT = [0, 1, 3, 4]
_TURNING = 5
#: Teeth that a registration needs, or all where there are fewer.
LEAST_TEETH = 8
#: The teeth must not leave out more of a turn than this. [rad]
_WIDEST_GAP = math.radians(120)
#: A seat is told from the points where its standard uncertainty is at most this many times that of one touch.
_MOST_AMPLIFIED = 5.0
#: Where tilt is not told: a tilt of 10 µm per 100 mm may pass for this much eccentricity. [mm, rad]
_MOST_FEIGNED, _SMALL_TILT = 0.005, 1e-4
_EACH_FLANK, _BOTH_FLANKS = "every flank of every tooth", "every tooth, both flanks alike"
_TOGETHER = "both flanks of a space are taken as indexed together: the points do not tell more"


@dataclass(frozen=True)
class SeatModel:
    """Columns (n,p) of the components ``found`` of the seat, less what the orthonormal columns ``free`` (n,q) hold."""

    columns: np.ndarray
    free: np.ndarray
    found: tuple[int, ...]
    name: str
    remarks: tuple[str, ...]


def check_teeth(file: FlankFile, rows: NominalRows, member: Member) -> None:
    """Raise InputError unless enough teeth were measured on both flanks, all around."""
    least = min(LEAST_TEETH, member.teeth)
    for flank in FLANKS:
        teeth = np.unique(rows.tooth[(file.flank == flank) & np.isfinite(file.deviation)])
        if len(teeth) < least:
            raise InputError(f"{flank} flank: {_measured(len(teeth))}: registration needs {least} of both flanks")
        gap = np.diff([*teeth, teeth[0] + member.teeth]).max() * 2 * math.pi / member.teeth
        if gap > _WIDEST_GAP:
            raise InputError(
                f"{flank} flank: the teeth that were measured leave out {math.degrees(gap):.0f} degrees of the turn: "
                f"registration allows {math.degrees(_WIDEST_GAP):.0f}"
            )


def _measured(teeth: int) -> str:
    return f"{counted(teeth, 'tooth')} {'was' if teeth == 1 else 'were'} measured"


def seat_model(
    file: FlankFile, rows: NominalRows, columns: np.ndarray, besides: np.ndarray, used: np.ndarray, member: Member
) -> SeatModel:
    """The most general model of the pitch in which the seat is still told from the points.

    ``columns`` (n,6) are those of (18.2), ``besides`` (n,q) what is left free too, ``used`` (n,) the points that count.
    Raises InputError where the eccentricity is not told.
    """
    seat = columns[used][:, SEAT]
    remarks: tuple[str, ...] = ()
    for each_flank in (True, False):
        free = _free_columns(file, rows, columns[:, _TURNING], besides, used, each_flank)
        left = seat - free @ (free.T @ seat)
        if _smallest(left * sizes(member)) * _MOST_AMPLIFIED >= 1.0:
            return SeatModel(left, free, (0, 1, 2, 3), _EACH_FLANK if each_flank else _BOTH_FLANKS, remarks)
        remarks = (_TOGETHER,)
    if _smallest(left[:, :2]) * _MOST_AMPLIFIED < 1.0:
        raise InputError(
            f"{file.member}: the points do not tell eccentricity from uneven pitch; measure three or more places, toe "
            f"to heel and root to tip, on {LEAST_TEETH} teeth around"
        )
    feigned = _SMALL_TILT * _feigned(left, float(rows.point[used, 2].mean()))
    what = f"a tilt of 10 um per 100 mm looks like {feigned * 1000:.1f} um of eccentricity"
    if feigned > _MOST_FEIGNED:
        raise InputError(
            f"{file.member}: most teeth were measured at one place, and there {what}: measure three or more places, "
            f"toe to heel and root to tip, on {LEAST_TEETH} teeth around"
        )
    untold = f"tilt cannot be found where teeth were measured at one place; it is taken as zero, and {what}"
    return SeatModel(left[:, :2], free, (0, 1), _BOTH_FLANKS, (*remarks, untold))


def _smallest(columns: np.ndarray) -> float:
    return float(np.linalg.svd(columns, compute_uv=False)[-1])


def _feigned(left: np.ndarray, height: float) -> float:
    """Eccentricity [mm per rad] that a tilt about a height would be taken for, by the columns (n,4) that are left."""
    about = left[:, 2:] + height * np.stack([left[:, 1], -left[:, 0]], axis=1)
    return float(np.linalg.norm(np.linalg.lstsq(left[:, :2], about, rcond=None)[0], 2))


def sizes(member: Member) -> np.ndarray:
    """What makes eccentricity and tilt alike: tilt counts as its motion at the mean cone distance."""
    return np.array([1.0, 1.0, *[1 / member.blank.mean_cone_distance] * 2])


def _free_columns(
    file: FlankFile, rows: NominalRows, lever: np.ndarray, besides: np.ndarray, used: np.ndarray, each_flank: bool
) -> np.ndarray:
    """Orthonormal columns (n,q) of all that is no seat: form at every point of the grid, turning of every tooth."""
    flank = (file.flank == FLANKS[1]).astype(int)[used]
    width = int(file.col.max()) + 1
    place = (flank * (int(file.row.max()) + 1) + file.row[used]) * width + file.col[used]
    group = rows.tooth[used] * 2 + flank if each_flank else rows.tooth[used]
    form = (place[:, None] == np.unique(place)).astype(float)
    form /= np.linalg.norm(form, axis=0)
    turning = (group[:, None] == np.unique(group)) * lever[used, None] / np.abs(lever).max()
    others = np.hstack([turning, besides[used]])
    others -= form @ (form.T @ others)
    u, sizes, _ = np.linalg.svd(others, full_matrices=False)
    return np.hstack([form, u[:, sizes > 1e-9]])

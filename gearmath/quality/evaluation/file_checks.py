"""Whether a measured file is what it says, of this member and set; if not, what would make most of its rows fit."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from gearmath.errors import InputError
from gearmath.quality.evaluation.digits import file_resolution
from gearmath.quality.evaluation.nominal import NominalRows, nominal_rows
from gearmath.quality.evaluation.pitch import reference_point
from gearmath.quality.evaluation.topography import grid_shape
from gearmath.specs.bevel_set import FLANKS, Member, design_sha256
from gearmath.specs.flank_csv import FlankFile
from gearmath.specs.ratio import INCH

#: A measured point may lie this far beside its nominal normal. [mm]
SAME_POINT = 0.01
#: Its deviation and its place may differ by this much: files that are rounded to the micrometre. [mm]
SAME_DEVIATION = 0.001
#: Least cosine between the normal of a row and the nominal one, 1 degree.
SAME_NORMAL = math.cos(math.radians(1.0))
#: Points are beside their normals alike where so much of them is, by more than this part of the limit each; beyond this
#: distance they are of another flank. [mm]
_MOST_ALIKE, _ALIKE, _SET_UP = 0.8, 0.3, 0.5
#: So many rows at least fit what is named as the cause, and more than as the file has them.
_FIT = 0.95
#: Deviations of another sign or unit are so to this part.
_FACTOR = 0.1
#: What puts touches beside the normals along which they were searched.
WRONG_SET_UP = "work offset or tool length, or another --machine or --calibration than that of the program"


def check_points(file: FlankFile, rows: NominalRows, member: Member) -> None:
    """Raise InputError, with the likeliest cause, where a row is none of its nominal point of a member.

    The normal must be the nominal one, the measured point lie on it, and as far along it as the deviation says.
    """
    off = file.point - rows.point
    along = np.einsum("ij,ij->i", off, file.normal)
    apart = np.where(np.isfinite(file.deviation), np.linalg.norm(off - along[:, None] * file.normal, axis=1), 0.0)
    if (apart > SAME_POINT).any():
        k = int(np.argmax(apart > SAME_POINT))
        raise InputError(
            f"{_place(file, k)}: the measured point lies {apart[k]:.4f} mm beside the nominal normal, the limit is "
            f"{SAME_POINT} mm; {_likeliest_cause(file, rows, apart, member)}"
        )
    turned_away = np.einsum("ij,ij->i", file.normal, rows.normal) < SAME_NORMAL
    if turned_away.any():
        k = int(np.argmax(turned_away))
        inward = int((np.einsum("ij,ij->i", file.normal, rows.normal) < -SAME_NORMAL).sum())
        why = f"{inward} of {len(file)} normals point into the metal" if inward else "is the file of this set and hand?"
        raise InputError(
            f"{_place(file, k)}: nx, ny, nz = {_shown(file.normal[k])}: must be the outward normal, "
            f"{_shown(rows.normal[k])}, within {math.degrees(math.acos(SAME_NORMAL)):.1f} degrees; {why}"
        )
    wrong = np.nan_to_num(np.abs(along - file.deviation))
    if (wrong > SAME_DEVIATION).any():
        k = int(np.argmax(wrong > SAME_DEVIATION))
        raise InputError(
            f"{_place(file, k)}: deviation_um = {file.deviation[k] * 1000:.3f}: x, y, z lie {along[k] * 1000:.3f} um "
            f"out of the nominal flank; both must agree within {SAME_DEVIATION * 1000:g} um{_factor(file, along)}"
        )


def check_phase(file: FlankFile) -> None:
    """Raise InputError where a file says that the phase of each flank was set to zero, and its reference points do not.

    Either the first tooth of a flank has no deviation there, or the mean of its teeth; points without a reading, which
    are NaN, say nothing.
    """
    if file.header["phase_zeroed"].lower() != "true":
        return
    row, col = reference_point(file)
    for flank in FLANKS:
        here = (file.flank == flank) & (file.row == row) & (file.col == col) & np.isfinite(file.deviation)
        if not here.any():
            continue
        at, u = file.deviation[here], np.nan_to_num(file.uncertainty[here][0])
        limit = SAME_DEVIATION + 3 * u
        if min(abs(at[0]), abs(at.mean())) > limit:
            raise InputError(
                f"phase_zeroed = true: the reference point of the {flank} flank, tooth {file.tooth[here][0]}, deviates "
                f"by {at[0] * 1000:+.2f} um, must be 0 within {limit * 1000:g} um: was the flank turned to it? else "
                "write false"
            )


def _place(file: FlankFile, k: int) -> str:
    return f"{file.flank[k]} flank, tooth {file.tooth[k]}, row {file.row[k]}, col {file.col[k]}"


def _shown(vector: np.ndarray) -> str:
    return ", ".join(f"{value:.4f}" for value in vector)


def _factor(file: FlankFile, along: np.ndarray) -> str:
    """What is wrong with the deviations of nearly all points, where one factor or their digits say it; else nothing."""
    if (step := file_resolution(file)) and np.nanmax(np.abs(along - file.deviation)) <= step:
        return f": they are rounded to {step * 1000:g} um, which is too coarse"
    large = np.abs(along) > 2 * SAME_DEVIATION
    ratio = file.deviation[large & np.isfinite(file.deviation)] / along[large & np.isfinite(file.deviation)]
    words = {
        -1.0: "they have the other sign, and metal left on is positive",
        1e-3: "they are mm",
        1e3: "they are nm",
        INCH: "they are of a file in inches",
        1 / INCH: "they are of a file in inches",
    }
    for factor, why in words.items():
        if len(ratio) and np.mean(np.abs(ratio / factor - 1) < _FACTOR) >= _MOST_ALIKE:
            return f": it is {factor:g} times that at nearly all points, {why}"
    return ""


def _likeliest_cause(file: FlankFile, rows: NominalRows, apart: np.ndarray, member: Member) -> str:
    """What would make most of the points fit that lie (n,) [mm] beside their normals."""
    fits = {
        "the numbers are inches: convert the file to mm": file.point * INCH,
        "the file is of the other hand": file.point * [1, -1, 1],
        "x and y are exchanged": file.point[:, [1, 0, 2]],
    }
    for words, point in fits.items():
        if np.median(np.linalg.norm(point - rows.point, axis=1)) < 1.0:
            return words
    measured = apart[np.isfinite(file.deviation)]
    if np.mean(measured > _ALIKE * SAME_POINT) >= _MOST_ALIKE and np.median(measured) < _SET_UP:
        return f"nearly all points are, by {np.median(measured):.3f} mm in the middle: {WRONG_SET_UP}"
    shift = np.linalg.norm(file.point - rows.point, axis=1)
    for words, other in _counted_otherwise(file, member):
        point = nominal_rows(other, member).point
        fit = np.mean(np.linalg.norm(file.point - point, axis=1) < _SET_UP)
        if fit >= _FIT and fit > np.mean(shift < _SET_UP):
            return words
    if np.median(shift) < SAME_POINT:
        return f"{int((shift > SAME_POINT).sum())} of {len(file)} points are off the flank"
    return "is the file of this set, member, hand and grid, in mm?"


def _counted_otherwise(file: FlankFile, member: Member) -> Iterator[tuple[str, FlankFile]]:
    """The file as if its flanks, rows, columns or teeth were meant otherwise, and what is then to be said."""
    (rows, columns), z = grid_shape(file), member.teeth
    again, others = file.tooth == z, {FLANKS[0]: FLANKS[1], FLANKS[1]: FLANKS[0]}
    exchanged = np.array([others[flank] for flank in file.flank])
    yield "concave and convex are exchanged", replace(file, flank=exchanged)
    yield "rows count from tip to root; they must count from root to tip", replace(file, row=rows - 1 - file.row)
    yield "columns count from heel to toe; they must count from toe to heel", replace(file, col=columns - 1 - file.col)
    back = replace(file, tooth=np.where(again, z, -file.tooth % z))
    yield "teeth count the other way; they must count right-handed about z_w, as the set does", back
    yield "teeth are counted from 1; they must be from 0", replace(file, tooth=(file.tooth - 1) % z)


def check_belongs(member: Member, measured: FlankFile) -> None:
    """Raise InputError unless the file is a measurement of this member of this set."""
    if measured.member != member.name:
        raise InputError(f"member = {measured.member!r} in the measured file: must be {member.name!r}")
    if measured.header["member_teeth"] != str(member.teeth):
        raise InputError(
            f"member_teeth = {measured.header['member_teeth']}: the {member.name} of the set has {member.teeth}"
        )
    if measured.header["settings_sha256"] != design_sha256(member):
        raise InputError(
            f"settings_sha256 = {measured.header['settings_sha256'][:12]}...: the file was measured against other "
            f"nominal settings than those of the set ({design_sha256(member)[:12]}...)"
        )

"""A measured member in, its corrected settings out: which flanks share settings, and when nothing may be written."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.method import require_plain
from gearmath.errors import ComputationError, InputError
from gearmath.quality.compensation import FREE, FlankTarget, Identification, identify, predicted
from gearmath.quality.pitch import evaluate_pitch, index_correction
from gearmath.quality.topography import grid_shape
from gearmath.specs.bevel_set import FLANKS, SETTINGS, SIDES, Member, design_sha256
from gearmath.specs.flank_csv import FlankFile

#: Points of the file and of the set must agree this well, or the file belongs to another set. [mm]
_SAME_POINT = 0.01
#: What a correction may add to the RMS of a flank that is as good as perfect: rounding. [mm]
_ROUNDING = 1e-6


@dataclass(frozen=True)
class Correction:
    """Corrected settings (12,) of each flank, what was identified for each group of flanks, and index corrections.

    ``expected`` is the largest deviation [mm] that the model expects to remain, per flank; ``index`` (z,) [rad] is
    None where pitch was not measured.
    """

    settings: dict[str, np.ndarray]
    identified: dict[tuple[str, ...], Identification]
    expected: dict[str, float]
    index: np.ndarray | None


def correct(member: Member, name: str, measured: FlankFile, free: tuple[str, ...] = FREE) -> Correction:
    """The settings that make up for what was measured on a member.

    Flanks of a completing cut share their correction. Raises InputError if the file is not of this member, and
    ComputationError if the correction would make a flank worse.
    """
    check_belongs(member, name, measured)
    require_plain(member, name, "compensation")
    groups = [FLANKS] if member.cutting == "completing" else [(flank,) for flank in FLANKS]
    settings: dict[str, np.ndarray] = {}
    identified: dict[tuple[str, ...], Identification] = {}
    expected: dict[str, float] = {}
    for group in groups:
        targets = [flank_target(member, name, flank, measured) for flank in group]
        found = identify(targets, free)
        if found.rms_after > found.rms_before + _ROUNDING:
            raise ComputationError(
                f"{name} {' and '.join(group)}: no correction makes the flank better "
                f"(RMS {found.rms_before * 1000:.3f} um); nothing is written"
            )
        identified[group] = found
        for flank, target in zip(group, targets, strict=True):
            settings[flank] = member.flank(flank).nominal.vector - found.errors
            remaining = target.deviation - predicted(target, member.flank(flank).vector + found.errors)[0]
            expected[flank] = float(np.abs(remaining).max())
    return Correction(settings, identified, expected, _index(member, measured))


def flank_target(member: Member, name: str, flank: str, measured: FlankFile, tooth: int | None = None) -> FlankTarget:
    """One flank of a file with the nominal points of the set, of the tooth that has most points if none is given.

    Raises InputError if they are not the same points.
    """
    points = measured.select(flank)
    if tooth is None and len(points):
        teeth, counts = np.unique(points.tooth, return_counts=True)
        tooth = int(teeth[np.argmax(counts)])  # the one with the whole grid
    points = measured.select(flank, tooth)
    rows, columns = grid_shape(measured)
    if len(points) != rows * columns:
        raise InputError(f"{flank} flank: {len(points)} points were measured, the grid {rows}x{columns} needs all")
    order = np.lexsort((points.col, points.row))
    deviation = points.deviation[order]
    if np.isnan(deviation).any():
        raise InputError(f"{flank} flank: deviation_um is empty; is this a nominal file?")
    margin = float(measured.header["margins"].split(",")[0])
    nominal = solve_flank(member, name, flank, blank_grid(member, rows, columns, margin))
    turn = 2 * np.pi * int(points.tooth[0]) / member.teeth
    c, s = np.cos(turn), np.sin(turn)
    back = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    touched = points.point[order] @ back.T - deviation[:, None] * nominal.normal
    apart = np.linalg.norm(touched - nominal.point, axis=1)
    if apart.max() > _SAME_POINT:
        k = int(np.argmax(apart))
        raise InputError(
            f"{flank} flank, row {k // columns}, col {k % columns}: the measured point lies {apart[k]:.4f} mm beside "
            f"the nominal normal, the limit is {_SAME_POINT} mm; is the file in mm, and of this set and hand?"
        )
    return FlankTarget(member.flank(flank).vector, SIDES[flank], nominal, deviation)


def check_belongs(member: Member, name: str, measured: FlankFile) -> None:
    """Raise InputError unless the file is a measurement of this member of this set."""
    if measured.member != name:
        raise InputError(f"member = {measured.member!r} in the measured file: must be {name!r}")
    if measured.header["member_teeth"] != str(member.teeth):
        raise InputError(f"member_teeth = {measured.header['member_teeth']}: the {name} of the set has {member.teeth}")
    if measured.header["settings_sha256"] != design_sha256(member):
        raise InputError(
            f"settings_sha256 = {measured.header['settings_sha256'][:12]}...: the file was measured against other "
            f"nominal settings than those of the set ({design_sha256(member)[:12]}...)"
        )


def _index(member: Member, measured: FlankFile) -> np.ndarray | None:
    pitches = [evaluate_pitch(measured, member.teeth, flank) for flank in FLANKS]
    found = [pitch for pitch in pitches if pitch is not None]
    if not found:
        return None
    before = np.radians(member.index_correction) if member.index_correction else np.zeros(member.teeth)
    return before + index_correction(found)


def setting_changes(member: Member, correction: Correction) -> list[tuple[str, str, float, float]]:
    """(flank, setting, old, new) of every setting that changes, mm and rad."""
    return [
        (flank, name, float(old), float(new))
        for flank, vector in correction.settings.items()
        for name, old, new in zip(SETTINGS, member.flank(flank).vector, vector, strict=True)
        if old != new
    ]

"""Axial position of the work: what the mean form says of it, and why nobody can tell it from a setting."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearmath.bevel.flank import solve_places
from gearmath.bevel.method import require_plain
from gearmath.bevel.newton import TOLERANCE
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.quality.evaluation.nominal import NominalRows
from gearmath.specs.bevel_set import FLANKS, SETTINGS, SIDES, Member
from gearmath.specs.flank_csv import FlankFile

#: The setting that does exactly what an axial shift does (6.2).
TWIN = "machine_center_to_crossing_point"
#: Settings of the machine that can stand in for it; tilt and swivel of the cutter are seldom moved.
_OTHERS = (
    "radial_distance",
    "cradle_angle",
    "blank_offset",
    "sliding_base",
    "machine_root_angle",
    "ratio_of_roll",
    "work_rotation_offset",
)


@dataclass(frozen=True)
class Axial:
    """Axial shift [mm] that would explain the mean form best, each flank free to turn, and its standard uncertainty.

    ``explains`` is the part of the sum of squares, each flank turned until it is least, that it takes. ``together`` is
    the shift [mm] with both flanks turned alike, which the thickness of the teeth tells.
    ``share`` says how much of its effect, as part of the sum of squares, others can imitate: the setting that is its
    twin (always all), the other settings together (None where their sensitivities are not known), the clamping.
    """

    shift: float
    uncertainty: float
    share: dict[str, float | None]
    explains: float
    together: float

    def as_dict(self) -> dict[str, Any]:
        return {
            "axial_um": _or_none(self.shift * 1000),
            "u_axial_um": _or_none(self.uncertainty * 1000),
            "confounded_with": TWIN,
            "share_imitated_by": self.share,
        }


def axial_shift(file: FlankFile, member: Member, rows: NominalRows, columns: np.ndarray) -> Axial:
    """What the deviations of a file say of the axial position; ``columns`` (n,6) are those of (18.2)."""
    used = np.isfinite(file.deviation)
    axial, lever, clamping = columns[used, 2], columns[used, 5], columns[used][:, [0, 1, 3, 4]]
    flank = file.flank[used]
    turning = np.stack([np.where(flank == each, lever, 0.0) for each in FLANKS], axis=1)
    left = axial - _projected(turning, axial)
    size = float(left @ left)
    if size <= 1e-12 * float(axial @ axial):
        return Axial(math.nan, math.nan, {TWIN: 1.0, "other settings": None, "clamping": None}, 0.0, math.nan)
    values = file.deviation[used]
    shift = float(left @ values) / size
    rest = values - _projected(np.hstack([turning, axial[:, None]]), values)
    spare = len(values) - 3
    uncertainty = math.sqrt(float(rest @ rest) / spare / size) if spare > 0 else math.nan
    share = {
        TWIN: 1.0,
        "other settings": _by_settings(file, member, rows, used, axial),
        "clamping": _share(clamping, axial),
    }
    before, after = values - _projected(turning, values), float(rest @ rest)
    explains = 1 - after / max(float(before @ before), 1e-18)
    alike = axial - _projected(lever[:, None], axial)
    together = float(alike @ values) / float(alike @ alike)
    return Axial(shift, uncertainty, share, explains, together)


@dataclass(frozen=True)
class Explained:
    """How much of a column is in the deviations of a file, and what is left of their squares [mm²].

    ``of_form`` and ``left_of_form`` with each flank turned by itself, the others with both turned alike.
    """

    of_form: float
    left_of_form: float
    together: float
    left: float


def explained_by(column: np.ndarray, file: FlankFile, columns: np.ndarray) -> Explained:
    """What a column (n,) alone explains of a file; ``columns`` (n,6) are those of (18.2)."""
    used = np.isfinite(file.deviation)
    values, lever, flank, column = file.deviation[used], columns[used, 5], file.flank[used], column[used]
    found = []
    for turning in (np.stack([np.where(flank == each, lever, 0.0) for each in FLANKS], axis=1), lever[:, None]):
        own = column - _projected(turning, column)
        rest = values - _projected(np.hstack([turning, column[:, None]]), values)
        size = float(own @ own)
        found += [float(own @ values) / size if size > 1e-12 * float(column @ column) else 0.0, float(rest @ rest)]
    return Explained(*found)


def _by_settings(
    file: FlankFile, member: Member, rows: NominalRows, used: np.ndarray, axial: np.ndarray
) -> float | None:
    """How much of an axial shift the other settings imitate; each flank has its own where it has its own pass."""
    try:
        require_plain(member, "the sensitivity to settings")
    except InputError:
        return None
    blocks = []
    for flank in FLANKS:
        here = file.flank[used] == flank
        places = np.stack([file.row[used][here], file.col[used][here]], axis=1)
        _, first, of = np.unique(places, axis=0, return_index=True, return_inverse=True)
        point = rows.point[used][here][first]  # the places of the grid, on whatever tooth
        settings = member.flank(flank).nominal.vector
        found, residual = solve_places(settings, SIDES[flank], point[:, 2], np.hypot(point[:, 0], point[:, 1]))
        if not (residual <= TOLERANCE).all():
            return None
        (rates,) = kernel("setting_sensitivity")(*found.contact.T, settings, SIDES[flank])
        block = np.zeros((len(here), len(_OTHERS)))
        block[here] = rates[of.ravel()][:, [SETTINGS.index(other) for other in _OTHERS]]
        blocks.append(block)
    shared = member.cutting == "completing"
    return _share(blocks[0] + blocks[1] if shared else np.hstack(blocks), axial)


def _share(columns: np.ndarray, wanted: np.ndarray) -> float:
    """The part (of the sum of squares) of a column that lies in the span of others."""
    made = _projected(columns, wanted)
    return float(made @ made / (wanted @ wanted))


def _projected(columns: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """The part of a column (n,) in the span of columns (n,p), scaled so that their units do not matter."""
    sizes = np.linalg.norm(columns, axis=0)
    u, singular, _ = np.linalg.svd(columns[:, sizes > 0] / sizes[sizes > 0], full_matrices=False)
    u = u[:, singular > 1e-10]
    return u @ (u.T @ wanted)


def _or_none(value: float) -> float | None:
    return value if math.isfinite(value) else None

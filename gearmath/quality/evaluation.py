"""A measured member judged as a whole: what was left out, how it sat, and the figures of flanks, pitch and spaces."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearmath.errors import InputError
from gearmath.quality.completeness import missing_points
from gearmath.quality.correction import check_belongs
from gearmath.quality.drift import Drift, untold_drift, without_drift
from gearmath.quality.nominal import check_points, completed, nominal_rows
from gearmath.quality.outliers import find_outliers
from gearmath.quality.pitch import Pitch, evaluate_pitch, reference_rows
from gearmath.quality.registration import Registration, register
from gearmath.quality.spaces import Runout, Thickness, evaluate_runout, evaluate_thickness
from gearmath.quality.tolerance import Verdict, judge
from gearmath.quality.topography import Orders, Topography, evaluate_topography, grid_shape, mean_topography, orders
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.flank_csv import FlankFile


@dataclass(frozen=True)
class FlankFigures:
    """One flank: the topography of every tooth measured in full, their mean, its first orders, and its pitch.

    Where no tooth was measured in full, there are no topographies, and ``mean`` and ``orders`` are None.
    """

    topographies: tuple[Topography, ...]
    mean: Topography | None
    orders: Orders | None
    pitch: Pitch | None

    def as_dict(self) -> dict[str, Any]:
        """Figures for people and programs, those of topography of the first tooth in full: µm and degrees."""
        values: dict[str, Any] = {"teeth_in_full": [each.tooth for each in self.topographies]}
        if self.orders is not None:
            first = self.topographies[0]
            values |= {
                "tooth": first.tooth,
                "max_deviation_um": first.extreme * 1000,
                "rms_um": first.rms * 1000,
                "cubic_surface_residual_um": float(np.nanmax(np.abs(first.residual))) * 1000,
                "surface_coefficients": first.coefficients.tolist(),
                "left_out": first.left_out,
                "orders": self.orders.as_dict(),
            }
        if self.pitch is not None:
            values |= {key: self.pitch.as_dict()[key] for key in ("F_p_um", "max_f_pt_um", "cumulative_um")}
        return values


@dataclass(frozen=True)
class Evaluation:
    """A measured member: its points as judged, the figures of both flanks and of the spaces, and what was done to them.

    ``flanks`` and ``runout`` are those of ``file``; ``as_measured`` those before registration, the same without one.
    ``remarks`` are sentences: points left out, what was not found and why.
    """

    member: str
    file: FlankFile
    flanks: dict[str, FlankFigures]
    as_measured: dict[str, FlankFigures]
    runout: Runout | None
    runout_as_measured: Runout | None
    thickness: Thickness | None
    drifts: dict[str, Drift]
    registration: Registration | None
    verdict: Verdict | None
    remarks: tuple[str, ...]

    def as_dict(self) -> dict[str, Any]:
        """All figures for people and programs: µm, mm and degrees."""
        return {
            "member": self.member,
            "flanks": {flank: figures.as_dict() for flank, figures in self.flanks.items()},
            "runout": self.runout.as_dict() if self.runout else None,
            "thickness": self.thickness.as_dict() if self.thickness else None,
            "drift_um": {flank: drift.closure * 1000 for flank, drift in self.drifts.items()},
            "registration": self.registration.as_dict() if self.registration else None,
            "tolerance": self.verdict.as_dict() if self.verdict else None,
            "remarks": list(self.remarks),
        }


#: How often ``evaluate_member`` tells its progress.
STAGES = 3


def evaluate_member(
    file: FlankFile, member: Member, name: str, registered: bool = True,
    progress: Callable[[int], object] = lambda _: None,
) -> Evaluation:  # fmt: skip
    """Judge a measured file of a member, of this machine or of another measuring centre.

    Points that missed are left out, drift is taken out where tooth 0 was measured again, and, if ``registered``, so is
    the clamping where the points tell it. Raises InputError if the file is not of this member, or not in mm on its
    flanks, or if neither a tooth in full nor pitch was measured.
    """
    check_belongs(member, name, file)
    check_points(file, nominal_rows(file, member, name))
    outliers = find_outliers(file, member.teeth)
    progress(1)
    whole, absent = completed(outliers.without(file), member, name)
    measured, drifts = without_drift(whole, member.teeth)
    partly = _partly(measured, member)
    as_measured = _flanks(measured, member, not partly)
    missing = missing_points(file, member.teeth)
    seat, remarks = None, (*outliers.reasons, *absent, *partly, *(f"not whole: {one}" for one in missing))
    if registered:
        try:
            seat = register(measured, member, name, untold_drift(whole, member.teeth))
            remarks += seat.remarks
        except InputError as error:
            remarks += (f"not registered: {error}",)
    progress(1)
    judged = measured if seat is None else seat.file
    flanks = as_measured if seat is None else _flanks(judged, member, not partly)
    before, runout = (None if partly else evaluate_runout(each, member.teeth) for each in (measured, judged))
    verdict = None if missing else _verdict(member, name, flanks, runout)
    zeroed = file.header["phase_zeroed"].lower() == "true"
    if zeroed:
        remarks += ("no tooth thickness: the phase of the flanks was set to zero by turning (phase_zeroed)",)
    thickness = None if zeroed else evaluate_thickness(judged, member.teeth)
    progress(1)
    return Evaluation(name, judged, flanks, as_measured, runout, before, thickness, drifts, seat, verdict, remarks)


def _partly(file: FlankFile, member: Member) -> tuple[str, ...]:
    """Why there is no pitch and no runout, where some but not all of the teeth were measured."""
    try:
        for flank in FLANKS:
            reference_rows(file, member.teeth, flank)
    except InputError as error:
        return (f"no pitch and no runout: {error}",)
    return ()


def _flanks(file: FlankFile, member: Member, pitch: bool) -> dict[str, FlankFigures]:
    return {flank: _figures(file, member, flank, pitch) for flank in FLANKS if (file.flank == flank).any()}


def _figures(file: FlankFile, member: Member, flank: str, pitch: bool) -> FlankFigures:
    spacing = evaluate_pitch(file, member.teeth, flank) if pitch else None
    points = file.select(flank)
    teeth, counts = np.unique(points.tooth, return_counts=True)
    full = teeth[counts == np.prod(grid_shape(file))]
    if not len(full) and spacing is not None:
        return FlankFigures((), None, None, spacing)
    if not len(full):
        full = teeth[[np.argmax(counts)]]  # refused, with the number of its points
    topographies = tuple(evaluate_topography(file, flank, int(tooth)) for tooth in full)
    mean = mean_topography(topographies)
    return FlankFigures(topographies, mean, orders(mean), spacing)


def _verdict(member: Member, name: str, flanks: dict[str, FlankFigures], runout: Runout | None) -> Verdict | None:
    """The grade of pitch and runout; None where pitch was not measured."""
    pitches = [figures.pitch for figures in flanks.values() if figures.pitch is not None]
    if not pitches:
        return None
    measured = {"f_pt": max(p.largest_single for p in pitches), "F_p": max(p.total for p in pitches)}
    if runout is not None:
        measured["F_r"] = runout.total
    return judge(member, name, {key: value for key, value in measured.items() if math.isfinite(value)})

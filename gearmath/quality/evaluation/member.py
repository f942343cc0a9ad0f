"""A measured member judged as a whole: what was left out, its clamping, and the figures of flanks, pitch and spaces."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearmath.errors import InputError, counted
from gearmath.quality.evaluation.closing import Closing, close_run
from gearmath.quality.evaluation.completeness import cut_off, missing_points, silent_points
from gearmath.quality.evaluation.digits import file_resolution
from gearmath.quality.evaluation.drift import MeasuredDrift, untold_drift, without_drift
from gearmath.quality.evaluation.file_checks import check_belongs, check_phase, check_points
from gearmath.quality.evaluation.grades import grade_member
from gearmath.quality.evaluation.nominal import at_one_place, completed, nominal_rows
from gearmath.quality.evaluation.outliers import find_outliers
from gearmath.quality.evaluation.pitch import Pitch, evaluate_pitch, pitch_uncertainties
from gearmath.quality.evaluation.registration import Registration, register, stated_noise
from gearmath.quality.evaluation.rotation import Rotation, common_rotation
from gearmath.quality.evaluation.spaces import Runout, Thickness, evaluate_runout, evaluate_thickness
from gearmath.quality.evaluation.suspicions import Suspicions, suspicions
from gearmath.quality.evaluation.tolerance import Verdict
from gearmath.quality.evaluation.topography import (
    Orders,
    Topography,
    evaluate_topography,
    mean_topography,
    orders,
    teeth_in_full,
    zeroed,
)
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.flank_csv import FlankFile

#: What a maximum that is withheld is called.
_NAMES = {"max_deviation": "largest deviation", "F_p": "F_p", "max_f_pt": "largest f_pt"}


@dataclass(frozen=True)
class FlankFigures:
    """One flank: the topography of every tooth measured in full, their mean, its first orders, and its pitch.

    ``chart`` is the mean as it is drawn: the flank turned until its reference point has no deviation. Where no tooth
    was measured in full, there are no topographies, and ``mean``, ``chart`` and ``orders`` are None. ``reason`` says
    why there is no largest deviation although every point of the tooth has a reading. After a slip there are no
    ``orders`` either.
    """

    topographies: tuple[Topography, ...]
    mean: Topography | None
    chart: Topography | None
    orders: Orders | None
    pitch: Pitch | None
    reason: str | None = None

    @property
    def withheld(self) -> dict[str, str]:
        """Of each maximum that is not given, why."""
        reasons = {}
        if self.topographies and self.topographies[0].left_out:
            first = self.topographies[0]
            points = counted(first.left_out, "point")
            reasons["max_deviation"] = f"{first.flank} flank, tooth {first.tooth}: {points} without a reading"
        elif self.topographies and self.reason:
            reasons["max_deviation"] = self.reason
        if self.pitch is not None and self.pitch.withheld is not None:
            reasons |= dict.fromkeys(("F_p", "max_f_pt"), self.pitch.withheld)
        return reasons

    def as_dict(self) -> dict[str, Any]:
        """Figures for people and programs, those of topography of the first tooth in full: µm and degrees.

        A maximum over data with a gap is None, and ``withheld`` says why.
        """
        values: dict[str, Any] = {"teeth_in_full": [each.tooth for each in self.topographies]}
        if self.mean is not None and self.chart is not None:
            first = self.topographies[0]
            values |= {
                "tooth": first.tooth,
                "max_deviation_um": None if "max_deviation" in self.withheld else first.extreme * 1000,
                "rms_um": first.rms * 1000,
                "cubic_surface_residual_um": float(np.nanmax(np.abs(first.residual))) * 1000,
                "surface_coefficients": first.coefficients.tolist(),
                "left_out": first.left_out,
                "zeroed_at_reference": {
                    "taken_off_um": (self.mean.at_reference - self.chart.at_reference) * 1000,
                    "max_deviation_um": (None if self.chart.left_out or self.reason else self.chart.extreme * 1000),
                    "rms_um": self.chart.rms * 1000,
                },
                "orders": self.orders.as_dict() if self.orders is not None else None,
            }
        if self.pitch is not None:
            values |= {key: self.pitch.as_dict()[key] for key in ("F_p_um", "max_f_pt_um", "cumulative_um")}
        return values | {"withheld": self.withheld}


@dataclass(frozen=True)
class MemberEvaluation:
    """A measured member: its points as judged, the figures of both flanks and of the spaces, and what was done to them.

    ``flanks`` and ``runout`` are those of ``file``, without clamping and the rotation that both flanks have in common;
    ``as_measured`` are those before either was taken out.
    ``registration`` is what was found of the clamping, whether or not it was taken out (``is_significant``).
    ``suspicions`` are sentences on what the whole of it looks like beside an error of the gear.
    ``left_out`` are sentences on the points that were left out, and ``remarks`` all sentences: these, teeth that are
    far off and were kept, what was not found and why.
    """

    member: str
    file: FlankFile
    flanks: dict[str, FlankFigures]
    as_measured: dict[str, FlankFigures]
    runout: Runout | None
    runout_as_measured: Runout | None
    thickness: Thickness | None
    drifts: dict[str, MeasuredDrift]
    closing: Closing
    registration: Registration | None
    rotation: Rotation | None
    verdict: Verdict | None
    left_out: tuple[str, ...]
    remarks: tuple[str, ...]
    suspicions: tuple[str, ...]

    @property
    def first(self) -> tuple[str, ...]:
        """What is to be said before any figure: whether the work moved while it was measured, what was left out, and
        what the whole measurement looks like."""
        return (*self.closing.said, *self.left_out, *self.suspicions)

    @property
    def taken_out(self) -> Registration | None:
        """The clamping that was taken out, None where it is not known or no more than noise."""
        return self.registration if self.registration is not None and self.registration.is_significant else None

    @property
    def withheld(self) -> tuple[str, ...]:
        """Sentences on figures that there are not over data with a gap, those with the same reason together."""
        reasons: dict[str, list[str]] = {}
        for flank, figures in self.flanks.items():
            for name, why in figures.withheld.items():
                reasons.setdefault(why, []).append(f"{_NAMES[name]} of the {flank} flank")
        if self.runout is not None and self.runout.withheld is not None:
            reasons.setdefault(self.runout.withheld, []).append("F_r")
        if self.thickness is not None and self.thickness.withheld is not None:
            reasons.setdefault(self.thickness.withheld, []).append("range of the thickness")
        if self.verdict is not None:
            for name, why in self.verdict.withheld.items():
                reasons.setdefault(why, []).append(f"grade of {name}")
        return tuple(f"withheld: {', '.join(names)}: {why}" for why, names in reasons.items())

    def as_dict(self) -> dict[str, Any]:
        """All figures for people and programs: µm, mm and degrees."""
        return {
            "member": self.member,
            "left_out": list(self.left_out),
            "flanks": {flank: figures.as_dict() for flank, figures in self.flanks.items()},
            "runout": self.runout.as_dict() if self.runout else None,
            "runout_as_measured": self.runout_as_measured.as_dict() if self.runout_as_measured else None,
            "thickness": self.thickness.as_dict() if self.thickness else None,
            "drift_um": {flank: drift.closure * 1000 for flank, drift in self.drifts.items()},
            "closing": self.closing.as_dict(),
            "registration": self.registration.as_dict() if self.registration else None,
            "rotation": self.rotation.as_dict() if self.rotation else None,
            "tolerance": self.verdict.as_dict() if self.verdict else None,
            "remarks": list(self.remarks),
            "suspicions": list(self.suspicions),
        }


#: How often ``evaluate_member`` tells its progress.
STAGES = 4


def evaluate_member(
    file: FlankFile,
    member: Member,
    registered: bool = True,
    progress: Callable[[int], object] = lambda _: None,
    rotated: bool = True,
) -> MemberEvaluation:
    """Judge a measured file of a member, of this machine or of another measuring centre.

    Points that missed are left out, drift is taken out where tooth 0 was measured again, and, if ``registered``, so is
    the clamping where the points tell it beyond their noise; if ``rotated``, so is the rotation that both flanks have
    in common. Raises InputError if the file is not of this member, or not in mm on its flanks, if neither a tooth in
    full nor pitch was measured, or if its phase is not as its header says.
    """
    check_belongs(member, file)
    check_points(file, nominal_rows(file, member), member)
    complete, absent = completed(file, member)
    closing = close_run(complete, member.teeth)
    outliers = find_outliers(closing.straightened(complete), member.teeth)
    progress(1)
    whole = outliers.without(complete)
    check_phase(whole)
    measured, drifts = without_drift(whole, member.teeth, closing.course)
    as_measured = _flanks(measured, member)
    left_out = (*outliers.reasons, *absent, *silent_points(file), *missing_points(file, member.teeth))
    seat, remarks = None, (*closing.said, *left_out, *outliers.kept, *_silent(as_measured))
    if registered:
        try:
            untold = [untold_drift(whole, member.teeth, closing.course)]
            if closing.doubt is not None:
                untold.append(closing.doubt[whole.tooth < member.teeth])
            seat = register(measured, member, np.hstack(untold))
            remarks += (*seat.remarks, *([seat.remark] if seat.remark else []))
        except InputError as error:
            remarks += (f"not registered: {error}",)
    progress(1)
    taken = seat if seat is not None and seat.is_significant else None
    judged, turn = measured if taken is None else taken.file, None
    noise = stated_noise(file) if seat is None else seat.noise
    if rotated:
        try:
            turn = common_rotation(judged, member, noise)
            judged = turn.file
        except InputError as error:
            remarks += (f"rotation of the work not taken out: {error}",)
    progress(1)
    flanks = as_measured if judged is measured else _flanks(judged, member)
    angle = member.blank.delta
    before = evaluate_runout(measured, member.teeth, angle, noise)
    runout = before if judged is measured else evaluate_runout(judged, member.teeth, angle, noise, taken)
    each_zeroed = file.header["phase_zeroed"].lower() == "true"
    if each_zeroed:
        remarks += ("no tooth thickness: the phase of the flanks was set to zero by turning (phase_zeroed)",)
    if closing.topography_withheld:
        remarks += (f"no tooth thickness: {closing.topography_withheld}",)
    unknown = each_zeroed or closing.topography_withheld
    thickness = None if unknown else evaluate_thickness(at_one_place(judged, member), member.teeth)
    cut = cut_off(file)
    flanks = {flank: _without_maxima(figures, cut, closing) for flank, figures in flanks.items()}
    spaces = cut or closing.spaces_withheld
    runout = runout and replace(runout, reason=spaces)
    thickness = thickness and replace(thickness, reason=spaces)
    pitches = {flank: figures.pitch for flank, figures in flanks.items() if figures.pitch is not None}
    suspected = Suspicions((), None)
    if not closing.topography_withheld:
        in_full = {flank: figures.topographies for flank, figures in flanks.items()}
        suspected = suspicions(file, judged, member, in_full, seat)
    sure, rounded = pitch_uncertainties(judged, member.teeth, noise), file_resolution(file)
    verdict = grade_member(member, pitches, runout, closing, sure, suspected.no_grade, rounded)
    progress(1)
    return MemberEvaluation(
        member.name,
        judged,
        flanks,
        as_measured,
        runout,
        before,
        thickness,
        drifts,
        closing,
        seat,
        turn,
        verdict,
        left_out,
        (*remarks, *suspected.said),
        suspected.said,
    )


def _without_maxima(figures: FlankFigures, cut: str | None, closing: Closing) -> FlankFigures:
    """The figures of a flank with the reasons why there are no maxima: a file that was cut off, a pitch not known."""
    pitch = figures.pitch and replace(figures.pitch, reason=cut or closing.withheld)
    moved = closing.topography_withheld
    return replace(figures, pitch=pitch, reason=cut or moved, orders=None if moved else figures.orders)


def _flanks(file: FlankFile, member: Member) -> dict[str, FlankFigures]:
    """The figures of every flank in a file. Raises InputError where there are none of either."""
    found = {flank: _figures(file, member, flank) for flank in FLANKS if (file.flank == flank).any()}
    if not any(figures.topographies or figures.pitch for figures in found.values()):
        flank = next(iter(found))
        teeth, counts = np.unique(file.select(flank).tooth, return_counts=True)
        evaluate_topography(file, flank, int(teeth[np.argmax(counts)]))  # refused, with the number of its points
    return found


def _figures(file: FlankFile, member: Member, flank: str) -> FlankFigures:
    spacing = evaluate_pitch(file, member.teeth, flank)
    topographies = tuple(evaluate_topography(file, flank, tooth) for tooth in teeth_in_full(file, flank))
    if not topographies:
        return FlankFigures((), None, None, None, spacing)
    mean = mean_topography(topographies)
    return FlankFigures(topographies, mean, zeroed(mean, file), orders(mean), spacing)


def _silent(flanks: dict[str, FlankFigures]) -> Iterator[str]:
    """Flanks of which there are points, but no figures."""
    for flank, figures in flanks.items():
        if not figures.topographies and figures.pitch is None:
            yield f"{flank} flank: neither a tooth in full nor two reference points have readings; not judged"

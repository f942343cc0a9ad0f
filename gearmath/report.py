"""The report of one measurement: what the gear is like, which settings mend it, and what cannot be mended and why.

One page for people, self-contained, and its pictures. Nothing is computed here that an evaluation, an uncertainty or a
correction has not said.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from matplotlib.figure import Figure

from gearmath.page import Page
from gearmath.plot import evaluation_figure, member_figure, png
from gearmath.quality.analysis import Analysis
from gearmath.quality.correction import Correction, setting_changes
from gearmath.quality.evaluation import Evaluation
from gearmath.quality.identification import Identification
from gearmath.quality.pitch import Pitch, index_correction, reference_rows
from gearmath.quality.target import flank_target
from gearmath.quality.topography import ORDERS, Topography, grid_shape
from gearmath.quality.uncertainty import Uncertain
from gearmath.quality.variables import reading
from gearmath.specs.bevel_set import Member

#: Deviations below this are said to be nothing. [mm]
_NOTHING = 1e-6


@dataclass(frozen=True)
class Measurement:
    """What a report is made of.

    ``title`` names the set, ``source`` the file; ``figures`` and ``settings`` are those with uncertainties, which come
    from ``how_sure``; ``caused`` is the RMS [mm] that errors of measurement will leave on each flank after the
    correction; ``again`` is the member measured after it was cut with corrected settings, if it was.
    """

    title: str
    source: str
    member: Member
    evaluation: Evaluation
    correction: Correction | None
    figures: Sequence[Uncertain] = ()
    settings: Sequence[Uncertain] = ()
    caused: Mapping[str, float] = field(default_factory=dict)
    how_sure: str = ""
    again: Evaluation | None = None
    remarks: Sequence[str] = ()


@dataclass(frozen=True)
class Report:
    """The page, and its pictures by name (PNG)."""

    html: str
    pictures: dict[str, bytes] = field(default_factory=dict)


def measurement_report(measurement: Measurement) -> Report:
    """The report of a measurement as a page that holds everything, and the pictures once more for other uses."""
    found = measurement.evaluation
    page = Page(f"{measurement.title}: {found.member}")
    pictures = {name: png(figure) for name, figure in _figures(measurement)}
    page.paragraph(f"Measured: {measurement.source}. {_summary(measurement)}")
    page.heading("Flanks and pitch")
    seated = ", and after the clamping was taken out" if found.registration else ""
    captions = {
        "measured": f"As measured{seated}: flanks, pitch and runout.",
        "corrected": "Flanks and pitch before the correction, and "
        + ("as measured after it." if measurement.again else "as expected after it."),
    }
    for name, picture in pictures.items():
        page.picture(picture, captions[name])
    _figures_section(page, measurement)
    _clamping_section(page, found)
    if measurement.correction is not None:
        _settings_section(page, measurement, measurement.correction)
        _limits_section(page, measurement.correction, measurement.caused)
    remarks = (*found.remarks, *measurement.remarks)
    if remarks:
        page.heading("Remarks")
        for remark in remarks:
            page.paragraph(f"{remark[0].upper()}{remark[1:]}.")
    return Report(page.html, pictures)


def expected_topographies(member: Member, found: Evaluation, correction: Correction) -> dict[str, Topography]:
    """What the correction is expected to leave of each flank that it was made for, on the grid [mm]."""
    expected = {}
    for group, result in correction.identified.items():
        targets = [flank_target(member, found.member, flank, found.file) for flank in group]
        ends = np.cumsum([len(target.deviation) for target in targets])[:-1]
        for flank, target, part in zip(group, targets, np.split(-result.residual, ends), strict=True):
            deviation = np.full(target.grid_points, np.nan)
            deviation[slice(None) if target.used is None else target.used] = part
            first = found.flanks[flank].topographies[0]
            expected[flank] = replace(first, deviation=deviation.reshape(grid_shape(found.file)))
    return expected


def _figures(measurement: Measurement) -> Iterator[tuple[str, Figure]]:
    found, correction = measurement.evaluation, measurement.correction
    yield "measured", evaluation_figure(f"{found.member}, {measurement.source}", found)
    before, pitch = _mean(found), _pitches(found)
    if measurement.again is not None:
        after = member_figure(
            f"{found.member}: before and after the correction, both measured", before, _mean(measurement.again), pitch,
            _pitches(measurement.again),
        )  # fmt: skip
        yield "corrected", after
    elif correction is not None:
        first = {flank: figures.topographies[0] for flank, figures in found.flanks.items() if figures.topographies}
        expected = expected_topographies(measurement.member, found, correction)
        indexed = [] if correction.index is None else [_indexed(one, found, measurement.member) for one in pitch]
        yield "corrected", member_figure(f"{found.member}: measured, and expected", first, expected, pitch, indexed)


def _mean(found: Evaluation) -> dict[str, Topography]:
    return {flank: figures.mean for flank, figures in found.flanks.items() if figures.mean is not None}


def _pitches(found: Evaluation) -> list[Pitch]:
    return [figures.pitch for figures in found.flanks.values() if figures.pitch is not None]


def _indexed(one: Pitch, found: Evaluation, member: Member) -> Pitch:
    """The pitch of a flank when every space is turned by the correction of both flanks."""
    turning = one.turning + index_correction(_pitches(found))
    points = reference_rows(found.file, member.teeth, one.flank)
    assert points is not None  # there is a pitch
    return replace(one, turning=turning, cumulative=turning * np.hypot(*points.point[0, :2]))


def _summary(measurement: Measurement) -> str:
    found, correction = measurement.evaluation, measurement.correction
    parts = []
    if means := _mean(found):
        extreme = max((mean.extreme for mean in means.values()), key=abs)
        parts.append(f"the largest deviation of a flank is {extreme * 1000:+.1f} um")
    if pitch := _pitches(found):
        gaps = [one.withheld for one in pitch if one.withheld is not None]
        total = f"{max(one.total for one in pitch) * 1000:.1f} um"
        parts.append(f"the cumulative pitch deviation {f'is withheld ({gaps[0]})' if gaps else total}")
    if correction is not None:
        left = max(correction.expected.values())
        parts.append(f"corrected settings are expected to leave {left * 1000:.1f} um of the flanks")
    text = "; ".join(parts)
    return f"{text[0].upper()}{text[1:]}."


def _figures_section(page: Page, measurement: Measurement) -> None:
    found = measurement.evaluation
    page.heading("Figures")
    if measurement.figures:
        rows = [
            [one.figure.flank, one.figure.name.replace("_", " "),
             *(f"{value * one.figure.factor:.2f}" for value in (one.value, one.uncertainty, *one.interval)),
             one.figure.unit, one.method]
            for one in measurement.figures if not one.figure.name.startswith(("f_pt_", "c_"))
        ]  # fmt: skip
        head = ["flank", "figure", "value", "u", "from", "to", "unit", "by"]
        page.table(f"Standard uncertainties and intervals of 95 %: {measurement.how_sure}", head, rows)
    orders = {flank: figures.orders for flank, figures in found.flanks.items() if figures.orders is not None}
    if orders:
        rows = [[name.replace("_", " "), *(_micro(getattr(one, name)) for one in orders.values())] for name in ORDERS]
        rows.append(["residual (RMS)", *(_micro(one.residual) for one in orders.values())])
        page.table("Mean, first and second order of the flanks, and what they leave", ["figure / um", *orders], rows)
    rows = []
    if found.runout is not None:
        rows.append(["runout F_r", _micro(found.runout.total), "um"])
    if found.thickness is not None:
        rows.append(["tooth thickness at the reference point, arc", f"{found.thickness.arc:.4f}", "mm"])
        rows.append(["its deviation, mean of the teeth", _micro(found.thickness.mean), "um"])
    if found.verdict is not None:
        rows += [[f"grade of {name}", str(grade or "beyond 11"), ""] for name, grade in found.verdict.grades.items()]
        rows += [[f"grade of {name}", f"withheld: {why}", ""] for name, why in found.verdict.withheld.items()]
    if rows:
        page.table("Spaces and teeth", ["figure", "value", "unit"], rows)


def _clamping_section(page: Page, found: Evaluation) -> None:
    seat, turn = found.registration, found.rotation
    if seat is None and turn is None and not found.drifts:
        return
    page.heading("Clamping, rotation and drift, taken out before judging")
    rows = []
    if seat is not None:
        at, about = np.degrees([seat.eccentricity_direction, seat.tilt_direction])
        u = seat.eccentricity_uncertainty
        rows.append(["eccentricity", _micro(seat.eccentricity), _micro(u), "um", f"towards {at:.1f} degrees"])
        if seat.tilt_found:
            tilt, u = seat.tilt * 100, seat.tilt_uncertainty * 100
            rows.append(["tilt", _micro(tilt), _micro(u), "um per 100 mm", f"about {about:.1f} degrees"])
    if turn is not None:
        size = f"common to both flanks: {math.degrees(turn.angle) * 3600:+.2f} arcsec, here its arc at the middle"
        rows.append(["rotation", _micro(turn.arc), _micro(turn.uncertainty * turn.radius), "um", size])
    rows += [
        [f"drift, {flank}", _micro(drift.closure), "", "um", "tooth 0 at the end against the start"]
        for flank, drift in found.drifts.items()
    ]
    page.table("How the work sat while it was measured", ["figure", "value", "u", "unit", ""], rows)


def _settings_section(page: Page, measurement: Measurement, correction: Correction) -> None:
    page.heading("Settings, old and new")
    standard = {(one.figure.flank, one.figure.name): one.uncertainty for one in measurement.settings}
    rows = []
    for flank, name, old, new in setting_changes(measurement.member, correction):
        factor, unit = reading(name)
        u = standard.get((flank, name), math.nan)
        values = (f"{value * factor:.6f}" for value in (old, new, new - old))
        rows.append([flank, name, *values, f"{u * factor:.6f}" if math.isfinite(u) else "", unit])
    page.table("Settings that change", ["flank", "setting", "old", "new", "change", "u", "unit"], rows)
    if correction.index is not None:
        size = math.degrees(np.ptp(correction.index)) * 3600
        page.paragraph(f"The indexing of every tooth is corrected as well, within a range of {size:.1f} arcseconds.")


def _limits_section(page: Page, correction: Correction, caused: Mapping[str, float]) -> None:
    page.heading("What is not corrected, and why")
    rows = []
    for group, result in correction.identified.items():
        values = (result.rms_before, correction.reachable[group], result.rms_after)
        rows.append([" and ".join(group), *map(_micro, values)])
    head = ["flanks", "RMS measured", "best that settings reach", "expected"]
    page.table("RMS of the flanks / um", head, rows)
    for group, analysis in correction.analysis.items():
        result = correction.identified[group]
        for sentence in _limits(" and ".join(group), analysis, result, correction.reachable[group]):
            page.paragraph(sentence)
    for flank, count in correction.left_out.items():
        if count:
            page.paragraph(f"{flank} flank: {count} points of the grid took no part in the correction.", warning=True)
    for flank, rms in caused.items():
        page.paragraph(f"{flank} flank: errors of the measurement itself will leave {rms * 1000:.2f} um RMS.")
    for flank, moved in correction.root.items():
        toe, heel = moved * 1000
        page.paragraph(f"{flank} flank: the root line moves by {toe:+.1f} um at the toe, {heel:+.1f} um at the heel.")


def _limits(flanks: str, analysis: Analysis, found: Identification, reachable: float) -> Iterator[str]:
    """Sentences on what holds a correction back."""
    names = ", ".join(analysis.names)
    yield (
        f"{flanks}: what {names} cannot do within their bounds stays, {reachable * 1000:.2f} um RMS of "
        f"{analysis.rms * 1000:.2f} um."
    )
    if not found.converged:
        yield f"{flanks}: the fit stopped after {found.iterations} steps without converging: less may remain."
    for first, second, cosine in analysis.alike:
        how = "alike" if cosine > 0 else "opposite ways"
        yield f"{flanks}: {first} and {second} move the flank {how} (cosine {cosine:.5f}): no flank tells them apart."
    if analysis.weak:
        what = "; ".join(_direction(analysis, k) for k in analysis.weak)
        yield f"{flanks}: weak directions, which much noise and little flank belong to: {what}."
    if analysis.unseen:
        yield f"{flanks}: without effect: {', '.join(analysis.unseen)}."
    if found.active:
        yield f"{flanks}: held back by the limit of {', '.join(found.active)}."


def _direction(analysis: Analysis, k: int) -> str:
    parts = " ".join(f"{part:+.2f} {name}" for name, part in analysis.direction(k).items())
    return f"{parts} (singular value {analysis.singular_values[k] * 1000:.2g} um)"


def _micro(value: float) -> str:
    """mm as µm, empty for what is not known."""
    if not math.isfinite(value):
        return ""
    return f"{0.0 if abs(value) < _NOTHING else value * 1000:.2f}"

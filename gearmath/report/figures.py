"""Tables of the figures of a member, with their uncertainties, tolerances and grades."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gearmath.page import Page
from gearmath.quality.evaluation.member import FlankFigures, MemberEvaluation
from gearmath.quality.evaluation.tolerance import Verdict, finest_grade, iso17485
from gearmath.quality.evaluation.topography import ORDERS
from gearmath.quality.uncertainty.propagation import Uncertain
from gearmath.report.measurement import ReportedMeasurement, in_words, micro, taken_out, unsure

#: Figures that have a grade: name in the verdict, that of the figure of a flank, and in words.
_SPACING = {
    "f_pt": ("max_f_pt", "f_pt, largest"),
    "F_p": ("F_p", "F_p"),
    "F_r": ("F_r", "F_r"),
}
#: Digits of a figure at most: what is surer than a thousandth of a nanometre has no noise.
_MOST_DIGITS = 6


def spacing_table(page: Page, one: ReportedMeasurement) -> None:
    """Pitch and runout with tolerance and grade beside each value."""
    found = one.evaluation
    rows = [
        [f"{_SPACING[name][1]}, {flank}", *graded, *_again(one, flank, name)]
        for name, flank, graded in spacing_rows(one)
    ]
    if rows:
        caveat = f" {found.verdict.remark}." if found.verdict is not None else ""
        head = ["figure / µm", "value", "95 % interval", "grade found", "tolerance of that grade"]
        page.table(
            "Single pitch f_pt, cumulative pitch F_p, runout F_r; tolerance of the grade that was found, the finest "
            f"that holds the value: none was asked for.{caveat}",
            [*head, *([] if one.again is None else ["measured again", "grade then"])],
            rows,
        )


def thickness_section(page: Page, one: ReportedMeasurement) -> None:
    """What of the runout is noise, then thickness."""
    found = one.evaluation
    if found.runout is not None and np.isfinite(found.runout.of_noise[0]):
        mean, spread = (f"{value * 1000:.1f}" for value in found.runout.of_noise)
        so = ": F_r is mostly noise" if found.runout.mostly_noise else ""
        page.paragraph(f"Noise of the points alone would give F_r {mean} ± {spread} µm{so}.")
    if found.thickness is not None:
        thickness, head = found.thickness, ["figure", "nominal / mm", "deviation / µm"]
        then: list[list[str]] = [[], []]
        if one.again is not None:
            later, head = one.again.thickness, [*head, "measured again / µm"]
            size = np.nan if later is None else later.mean
            then = [[micro(size)], [micro(size * thickness.chord_factor)]]
        page.table(
            "Tooth thickness on the transverse circle through the reference point, radius "
            f"{thickness.radius:.4f} mm, mean of the teeth that have a reading",
            head,
            [
                ["arc", f"{thickness.arc:.4f}", micro(thickness.mean), *then[0]],
                ["chord", f"{thickness.chord:.4f}", micro(thickness.mean * thickness.chord_factor), *then[1]],
            ],
        )


def spacing_rows(one: ReportedMeasurement) -> Iterator[tuple[str, str, list[str]]]:
    """Name (f_pt, F_p, F_r) and flank of a figure, then value [µm], 95 % interval, grade, tolerance of the grade."""
    found = one.evaluation
    for name, (figure, _) in _SPACING.items():
        for flank, value in _values(found, name):
            yield name, flank, _graded(found.verdict, flank, name, value, one.uncertain(flank, figure))


def _values(found: MemberEvaluation, name: str) -> Iterator[tuple[str, float]]:
    """Flank and value [mm] of a figure, of each flank that has it; NaN where it is withheld."""
    if name == "F_r":
        if found.runout is not None:
            yield "both", found.runout.total
        return
    for flank, figures in found.flanks.items():
        if figures.pitch is not None:
            yield flank, figures.pitch.total if name == "F_p" else figures.pitch.largest_single


def _again(one: ReportedMeasurement, flank: str, name: str) -> list[str]:
    """A figure and its grade as measured again, empty where there is none; no cells without a second measurement."""
    if one.again is None:
        return []
    value = next((value for where, value in _values(one.again, name) if where == flank), None)
    if value is None:
        return ["", ""]
    shown, _, grade, _ = _graded(one.again.verdict, flank, name, value, None)
    return [shown, grade]


def _interval(known: Uncertain | None) -> str:
    return "" if known is None else "{} to {}".format(*map(micro, known.interval))


def _graded(verdict: Verdict | None, flank: str, name: str, value: float, known: Uncertain | None) -> list[str]:
    """Value [mm], interval, grade and its tolerance; the grade with that of either end of the interval, if it differs.

    Over data with a gap there is neither value nor grade; outside of the scope of the formulas there is no grade, nor
    where the verdict withholds it.
    """
    if not np.isfinite(value):
        return ["withheld", "", "withheld", ""]
    shown = [micro(value), _interval(known)]
    if verdict is None or verdict.data.outside is not None:
        return [*shown, "", ""]
    if name in verdict.withheld and name not in verdict.flanks.get(flank, {}):
        return [*shown, "withheld", ""]
    data = verdict.data
    grade = finest_grade(data, name, value * 1000)
    words = _grade_words(grade)
    if known is not None:
        ends = [_grade_words(finest_grade(data, name, end * 1000)) for end in known.interval]
        if ends != [words, words]:
            words += f" ({ends[0]} to {ends[1]})"
    if grade is None:
        return [*shown, words, ""]
    return [*shown, words, f"{iso17485(data.mean_normal_module, data.tolerance_diameter, grade).rounded[name]:g}"]


def _grade_words(grade: int | None) -> str:
    return "beyond 11" if grade is None else str(grade)


def flank_section(page: Page, one: ReportedMeasurement) -> None:
    """Size of the deviations and their orders, flank by flank; and again, where it was measured again."""
    if not _with_topography(one.evaluation):
        return
    page.subheading("Figures of the flanks")
    _flank_table(page, one.evaluation, "Deviations")
    if one.again is not None and _with_topography(one.again):
        _flank_table(page, one.again, "Measured again: deviations")


def _with_topography(found: MemberEvaluation) -> dict[str, FlankFigures]:
    return {flank: each for flank, each in found.flanks.items() if each.mean is not None}


def _flank_table(page: Page, found: MemberEvaluation, what: str) -> None:
    flanks = _with_topography(found)
    rows = [
        ["at the reference point", *(micro(each.mean.at_reference) for each in flanks.values() if each.mean)],
        ["largest, with its sign", *(largest_cell(each) for each in flanks.values())],
        ["RMS, tooth thickness in it", *(micro(each.mean.rms) for each in flanks.values() if each.mean)],
        [
            "RMS of the chart, zero at the reference",
            *(micro(each.chart.rms) for each in flanks.values() if each.chart),
        ],
    ]
    orders = {flank: each.orders for flank, each in flanks.items() if each.orders is not None}
    rows += [[name.replace("_", " "), *(micro(getattr(each, name)) for each in orders.values())] for name in ORDERS]
    rows.append(["RMS that the surface of second order leaves", *(micro(each.residual) for each in orders.values())])
    page.table(
        f"{what} of the mean of the teeth measured in full, {taken_out(found)}, but for one row not zeroed at the "
        "reference point: size, mean, first and second order, and what they leave",
        ["figure / µm", *flanks],
        rows,
    )


def largest_cell(figures: FlankFigures) -> str:
    """The largest deviation [µm] with its sign, or that it is withheld."""
    withheld = figures.mean is None or figures.mean.left_out or "max_deviation" in figures.withheld
    return "withheld" if withheld or figures.mean is None else micro(figures.mean.extreme)


def uncertainty_section(page: Page, one: ReportedMeasurement) -> None:
    """All figures with their uncertainties, but those of single teeth and coefficients."""
    if not one.figures:
        return
    page.subheading("Uncertainty of the figures")
    page.paragraph(
        f"Standard uncertainties u and intervals of 95 %: {in_words(one.how_sure)}. Figures with * by Monte Carlo, the "
        "others by propagation (GUM)."
    )
    shown = [known for known in one.figures if not known.figure.name.startswith(("f_pt_", "c_"))]
    for flank in dict.fromkeys(known.figure.flank for known in shown):
        rows = [
            [
                known.figure.name.replace("_", " ") + ("" if known.method == "GUM" else " *"),
                *figure_cells(known),
                in_words(known.figure.unit),
            ]
            for known in shown
            if known.figure.flank == flank
        ]
        words = "both flanks" if flank == "both" else f"{flank} flank"
        page.table(f"Values and uncertainties, {words}", ["figure", "value", "u", "from", "to", "unit"], rows)


def figure_cells(known: Uncertain) -> list[str]:
    """Value, uncertainty and interval, with as many digits as the uncertainty asks for: none of those is zero."""
    values = [value * known.figure.factor for value in (known.value, known.uncertainty, *known.interval)]
    digits = 2
    while digits < _MOST_DIGITS and 0 < values[1] < 0.5 * 10.0**-digits:
        digits += 1
    return [f"{value:.{digits}f}" for value in values]


def clamping_section(page: Page, found: MemberEvaluation) -> None:
    """What was taken out of the deviations before they were judged."""
    seat, turn = found.taken_out, found.rotation
    rows = []
    if seat is not None:
        at, about = np.degrees([seat.eccentricity_direction, seat.tilt_direction])
        u = seat.eccentricity_uncertainty
        rows.append(["eccentricity", micro(seat.eccentricity), unsure(u), "µm", f"towards {at:.1f}°"])
        if seat.tilt_found:
            tilt, u = seat.tilt * 100, seat.tilt_uncertainty * 100
            rows.append(["tilt", micro(tilt), unsure(u), "µm per 100 mm", f"about {about:.1f}°"])
    if turn is not None:
        words = f"of both flanks, {np.degrees(turn.angle) * 3600:+.1f} arcsec; here its arc at the reference point"
        rows.append(["rotation", micro(turn.arc), unsure(turn.uncertainty * turn.radius), "µm", words])
    rows += [
        [f"drift, {flank}", micro(drift.closure), "", "µm", "tooth 0 at the end against the start"]
        for flank, drift in found.drifts.items()
    ]
    if rows:
        page.subheading("Taken out before judging")
        page.table("Clamping, rotation and drift", ["figure", "value", "u by the scatter alone", "unit", ""], rows)

"""Corrected settings on the sheet: old and new, and what they cannot correct and why."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from gearmath.bevel.identify.identification import Identification
from gearmath.bevel.identify.variables import reading
from gearmath.errors import counted
from gearmath.page import Page
from gearmath.quality.correction.analysis import Analysis, weak_words
from gearmath.quality.correction.member import MemberCorrection, setting_changes
from gearmath.report.measurement import ReportedMeasurement, in_words, micro, taken_out


def settings_sections(page: Page, measurement: ReportedMeasurement) -> None:
    """The settings that change, and what is not corrected, where there is a correction."""
    if measurement.correction is not None:
        _settings_section(page, measurement, measurement.correction)
        _limits_section(page, measurement, measurement.correction)


def _settings_section(page: Page, measurement: ReportedMeasurement, correction: MemberCorrection) -> None:
    page.subheading("Settings, old and new")
    standard = {(one.figure.flank, one.figure.name): one.uncertainty for one in measurement.settings}
    rows = []
    for flank, name, old, new in setting_changes(measurement.member, correction):
        factor, unit = reading(name)
        u = standard.get((flank, name), math.nan)
        values = (f"{value * factor:.6f}" for value in (old, new, new - old))
        setting = f"{flank}: {name.replace('_', ' ')}"
        rows.append([setting, *values, _sure(u * factor), unit])
    page.table("Settings that change", ["setting", "old", "new", "change", "u", "unit"], rows)
    if correction.index is not None:
        size = math.degrees(np.ptp(correction.index)) * 3600
        page.paragraph(f"The indexing of every tooth is corrected as well, within a range of {size:.1f} arcseconds.")


def _sure(u: float) -> str:
    """A standard uncertainty with six digits, or fewer significant ones: none is zero."""
    return "" if not math.isfinite(u) else f"{u:.6f}" if u >= 5e-7 or u == 0 else f"{u:.1e}"


def _limits_section(page: Page, measurement: ReportedMeasurement, correction: MemberCorrection) -> None:
    page.subheading("What is not corrected, and why")
    rows = []
    for group, result in correction.identified.items():
        values = (correction.measured_rms(group), correction.reachable[group], result.rms_after)
        rows.append([" and ".join(group), *map(micro, values)])
    head = ["flanks", "RMS of the tooth, turned to the least", "best that settings reach", "expected"]
    turned = ", turned so that least is left" if correction.rotation.angles.any() else ""
    page.table(
        f"RMS of the flanks / µm: of the tooth that was corrected, {taken_out(measurement.evaluation)}{turned}, not "
        "zeroed at the reference point",
        head,
        rows,
    )
    for group, analysis in correction.analysis.items():
        result = correction.identified[group]
        for sentence in _limits(" and ".join(group), analysis, result, correction, group):
            page.paragraph(sentence)
    for flank, count in correction.left_out.items():
        if count:
            page.paragraph(
                f"{flank} flank: {counted(count, 'point')} of the grid took no part in the correction.", warning=True
            )
    for flank, rms in measurement.caused.items():
        page.paragraph(f"{flank} flank: errors of the measurement itself will leave {rms * 1000:.2f} µm RMS.")
    for flank, moved in correction.root.items():
        toe, heel = moved * 1000
        page.paragraph(f"{flank} flank: the root line moves by {toe:+.1f} µm at the toe, {heel:+.1f} µm at the heel.")


def _limits(
    flanks: str, analysis: Analysis, found: Identification, correction: MemberCorrection, group: tuple[str, ...]
) -> Iterator[str]:
    """Sentences on what holds a correction back."""
    names, reachable, measured = ", ".join(analysis.names), correction.reachable[group], correction.measured_rms(group)
    yield (
        f"{flanks}: what {names} cannot do within their bounds stays, {reachable * 1000:.2f} µm RMS of "
        f"{measured * 1000:.2f} µm."
    )
    if not found.converged:
        steps = counted(found.iterations, "step")
        yield f"{flanks}: the fit stopped after {steps} without converging: less may remain."
    for first, second, cosine in analysis.alike:
        how = "alike" if cosine > 0 else "opposite ways"
        yield (
            f"{flanks}: {first} and {second} move the flank {how} (cosine {cosine:.5f}): these points cannot tell one "
            "from the other."
        )
    if analysis.weak:
        what = "; ".join(weak_words(analysis, k) for k in analysis.weak)
        yield in_words(f"{flanks}: the measurement hardly tells these changes of settings: {what}.")
    if analysis.unseen:
        yield f"{flanks}: without effect: {', '.join(analysis.unseen)}."
    if found.active:
        yield f"{flanks}: held back by the limit of {', '.join(found.active)}."

"""Corrected settings on the sheet: old and new, and what they cannot correct and why."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from gearmath.bevel.identify.identification import Identification
from gearmath.bevel.identify.variables import reading
from gearmath.page import Page
from gearmath.quality.correction.analysis import Analysis, weak_words
from gearmath.quality.correction.member import Correction, setting_changes
from gearmath.report.measurement import Measurement, in_words, micro


def settings_sections(page: Page, measurement: Measurement) -> None:
    """The settings that change, and what is not corrected, where there is a correction."""
    if measurement.correction is not None:
        _settings_section(page, measurement, measurement.correction)
        _limits_section(page, measurement.correction, measurement.caused)


def _settings_section(page: Page, measurement: Measurement, correction: Correction) -> None:
    page.subheading("Settings, old and new")
    standard = {(one.figure.flank, one.figure.name): one.uncertainty for one in measurement.settings}
    rows = []
    for flank, name, old, new in setting_changes(measurement.member, correction):
        factor, unit = reading(name)
        u = standard.get((flank, name), math.nan)
        values = (f"{value * factor:.6f}" for value in (old, new, new - old))
        setting = f"{flank}: {name.replace('_', ' ')}"
        rows.append([setting, *values, f"{u * factor:.6f}" if math.isfinite(u) else "", unit])
    page.table("Settings that change", ["setting", "old", "new", "change", "u", "unit"], rows)
    if correction.index is not None:
        size = math.degrees(np.ptp(correction.index)) * 3600
        page.paragraph(f"The indexing of every tooth is corrected as well, within a range of {size:.1f} arcseconds.")


def _limits_section(page: Page, correction: Correction, caused: Mapping[str, float]) -> None:
    page.subheading("What is not corrected, and why")
    rows = []
    for group, result in correction.identified.items():
        values = (correction.measured_rms(group), correction.reachable[group], result.rms_after)
        rows.append([" and ".join(group), *map(micro, values)])
    head = ["flanks", "RMS measured", "best that settings reach", "expected"]
    page.table("RMS of the flanks / µm", head, rows)
    for group, analysis in correction.analysis.items():
        result = correction.identified[group]
        for sentence in _limits(" and ".join(group), analysis, result, correction.reachable[group]):
            page.paragraph(sentence)
    for flank, count in correction.left_out.items():
        if count:
            page.paragraph(f"{flank} flank: {count} points of the grid took no part in the correction.", warning=True)
    for flank, rms in caused.items():
        page.paragraph(f"{flank} flank: errors of the measurement itself will leave {rms * 1000:.2f} µm RMS.")
    for flank, moved in correction.root.items():
        toe, heel = moved * 1000
        page.paragraph(f"{flank} flank: the root line moves by {toe:+.1f} µm at the toe, {heel:+.1f} µm at the heel.")


def _limits(flanks: str, analysis: Analysis, found: Identification, reachable: float) -> Iterator[str]:
    """Sentences on what holds a correction back."""
    names = ", ".join(analysis.names)
    yield (
        f"{flanks}: what {names} cannot do within their bounds stays, {reachable * 1000:.2f} µm RMS of "
        f"{analysis.rms * 1000:.2f} µm."
    )
    if not found.converged:
        yield f"{flanks}: the fit stopped after {found.iterations} steps without converging: less may remain."
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

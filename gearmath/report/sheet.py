"""The inspection sheet from its head to its last remark."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from gearmath.page import Page
from gearmath.quality.evaluation.topography import Topography
from gearmath.report import charts
from gearmath.report.figures import (
    clamping_section,
    flank_section,
    spacing_table,
    thickness_section,
    uncertainty_section,
)
from gearmath.report.measurement import FIELDS, Report, ReportedMeasurement, counted, in_words
from gearmath.report.settings import settings_sections
from gearmath.specs.bevel_set import FLANKS

_ZERO = (
    "The plane net is the nominal flank; up, and +, is metal left on, in µm. Each flank is turned about the work axis "
    "until its reference point (ring) is zero, so that tooth thickness is not in the charts. One scale for the member."
)


#: How often ``inspection_sheet`` tells its progress for each member.
STEPS = 5


def inspection_sheet(
    members: Sequence[ReportedMeasurement], progress: Callable[[int], object] = lambda _: None
) -> Report:
    """The sheet of one member, or of both, as a page that holds everything, and pictures once more for other uses."""
    names = [one.evaluation.member for one in members]
    page = Page(f"Inspection sheet: {' and '.join(names)}")
    page.paragraph(members[0].title)
    _head(page, members)
    _left_out(page, members)
    pictures: dict[str, bytes] = {}
    for k, one in enumerate(members):
        after = charts.after_correction(one)
        _member(page, one, after, progress)
        prefix = "" if k == 0 else f"{names[k]}_"
        pictures |= {prefix + name: picture for name, picture in charts.pictures(one, after).items()}
        progress(1)
    return Report(page.html, pictures)


def _head(page: Page, members: Sequence[ReportedMeasurement]) -> None:
    rows = [(label, [one.head.get(key, "") for one in members]) for key, label in FIELDS.items()]
    headers = [one.evaluation.file.header for one in members]
    facts = {
        "Member": [f"{one.evaluation.member}, {one.member.teeth} teeth, {one.member.hand} hand" for one in members],
        "Measured file": [one.source for one in members],
        "Points": [
            f"grid {header['grid']}, tip radius {header['tip_radius_mm']} mm; {counted(one.evaluation)}"
            for one, header in zip(members, headers, strict=True)
        ],
    }
    page.head([one.evaluation.member for one in members], [*rows, *facts.items()])


def _left_out(page: Page, members: Sequence[ReportedMeasurement]) -> None:
    """Before any figure: what they do not contain, and which of them there are not for that."""
    sentences = []
    for one in members:
        found = one.evaluation
        absent = [f"the {flank} flank was not measured" for flank in FLANKS if flank not in found.flanks]
        absent += [
            f"no tooth was measured in full on the {flank} flank: there is no topography of it"
            for flank, figures in found.flanks.items()
            if not figures.topographies
        ]
        others = [text for text in found.remarks if text not in found.first]
        texts = [*absent, *found.first, *found.withheld, *others, *one.remarks]
        sentences += [f"{found.member}: {in_words(text)}." for text in texts]
        if one.again is not None:
            later = [*one.again.first, *one.again.withheld]
            sentences += [f"{found.member}, measured again: {in_words(text)}." for text in later]
    if sentences:
        page.first("Left out, withheld, or not known", sentences)


def _member(
    page: Page,
    one: ReportedMeasurement,
    after: Mapping[str, Topography],
    progress: Callable[[int], object],
) -> None:
    found = one.evaluation
    page.heading(found.member.capitalize())
    page.subheading("Topography of the flanks")
    if drawings := charts.flank_charts(one, after):
        page.paragraph(_ZERO)
        page.drawings(drawings, small=True)
    else:
        page.paragraph("No tooth was measured in full: there is no topography.")
    progress(1)
    _spacing(page, one)
    progress(1)
    drawings, times = charts.tooth_charts(one)
    if drawings:
        page.subheading("The tooth in perspective")
        page.paragraph(
            f"The part of the tooth that was measured; deviations along the normals, {times:g} times enlarged. "
            "The darker, the more metal is left on."
        )
        page.drawings(drawings, small=True)
    progress(1)
    with page.columns():
        flank_section(page, one)
        clamping_section(page, found)
        settings_sections(page, one)
        uncertainty_section(page, one)
    progress(1)


def _spacing(page: Page, one: ReportedMeasurement) -> None:
    page.subheading("Pitch, runout, thickness")
    if drawings := charts.pitch_charts(one):
        later = "measured again" if one.again else "expected after the correction"
        dashed = f"; hollow bars and dashed lines: {later}" if charts.pitches_after(one) else ""
        page.paragraph(
            f"Teeth are counted from 0; gray bars and full lines: measured{dashed}. Both flanks have the same scale."
        )
        page.drawings(drawings, small=True)
    else:
        page.paragraph("No two teeth were measured on a flank: there is no pitch.")
    if one.again is not None:  # two more columns need the width of the sheet
        spacing_table(page, one)
    with page.columns():
        if drawings and (runout := charts.space_charts(one)):
            page.drawings(runout, small=True)
        if one.again is None:
            spacing_table(page, one)
        thickness_section(page, one)

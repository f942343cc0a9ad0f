"""The charts of one member, each with its caption."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from gearmath.plot import evaluation_figure, member_figure, png, svg
from gearmath.plot.pitch import pitch_limits
from gearmath.plot.sheet import pitch_chart, runout_chart, tooth_chart, topography_chart
from gearmath.plot.tooth import enlargement, tooth_flanks
from gearmath.plot.topography import um_per_row
from gearmath.quality.correction.member import MemberCorrection
from gearmath.quality.correction.target import flank_target
from gearmath.quality.evaluation.member import MemberEvaluation
from gearmath.quality.evaluation.pitch import Pitch, index_correction, reference_rows
from gearmath.quality.evaluation.topography import Topography, grid_shape, zeroed
from gearmath.report.measurement import ReportedMeasurement
from gearmath.specs.bevel_set import Member

#: (svg, caption)
Drawing = tuple[str, str]


def flank_charts(measurement: ReportedMeasurement, after: Mapping[str, Topography]) -> list[Drawing]:
    """Both flanks, each with what it is ``after`` the correction beside it, all at one scale."""
    found = measurement.evaluation
    before = means(found)
    words = "measured again" if measurement.again else "expected after the correction"
    rows = [
        [(zeroed(each, found.file), each, f"{flank} flank, measured: {_teeth(found, flank)}")]
        for flank, each in before.items()
    ]
    for row, flank in zip(rows, before, strict=True):
        if flank in after:
            file = (measurement.again or found).file
            row.append((zeroed(after[flank], file), after[flank], f"{flank} flank, {words}"))
    shown = [one for row in rows for one in row]
    scale = um_per_row([chart for chart, _, _ in shown])
    return [(svg(topography_chart(chart, scale, each.at_reference)), words) for chart, each, words in shown]


def pitch_charts(measurement: ReportedMeasurement) -> list[Drawing]:
    """Single pitch and cumulative pitch of each flank, at one scale, and with them those after the correction."""
    before, after = pitches(measurement.evaluation), pitches_after(measurement)
    limits = pitch_limits([*before, *after])
    later = {one.flank: one for one in after}
    return [
        (svg(pitch_chart(one, later.get(one.flank), limits)), f"{one.flank} flank: single and cumulative pitch")
        for one in before
    ]


def space_charts(measurement: ReportedMeasurement) -> list[Drawing]:
    """Runout, where it was measured."""
    runout = measurement.evaluation.runout
    words = "Runout: a ball in every space, normal to the pitch cone"
    return [] if runout is None else [(svg(runout_chart(runout)), words)]


def tooth_charts(measurement: ReportedMeasurement) -> tuple[list[Drawing], float]:
    """The tooth from either side, and how many times its deviations are enlarged."""
    found = measurement.evaluation
    shown = {flank: zeroed(each, found.file) for flank, each in means(found).items()}
    flanks = tooth_flanks(found.file, shown, measurement.member.teeth)
    if not flanks:
        return [], 1.0
    times = enlargement(flanks)
    return [(svg(tooth_chart(flanks, seen, times)), f"seen from its {seen} flank") for seen in flanks], times


def pictures(measurement: ReportedMeasurement, after: Mapping[str, Topography]) -> dict[str, bytes]:
    """Two pictures of the member as PNG, for other uses than the page: measured, and before and ``after``."""
    found = measurement.evaluation
    drawn = {"measured": png(evaluation_figure(f"{found.member}, {measurement.source}", found))}
    if after:
        words = "both measured" if measurement.again else "measured, and expected after the correction"
        before = means(found) if measurement.again else first(found)
        later = (measurement.again or found).file
        figure = member_figure(
            f"{found.member}: {words}",
            {flank: zeroed(each, found.file) for flank, each in before.items()},
            {flank: zeroed(each, later) for flank, each in after.items()},
            pitches(found),
            pitches_after(measurement),
            {flank: each.at_reference for flank, each in (after if before.keys() == after.keys() else before).items()},
        )
        drawn["corrected"] = png(figure)
    return drawn


def means(found: MemberEvaluation) -> dict[str, Topography]:
    """The mean of the teeth measured in full, of each flank that has one."""
    return {flank: figures.mean for flank, figures in found.flanks.items() if figures.mean is not None}


def first(found: MemberEvaluation) -> dict[str, Topography]:
    """The first tooth measured in full."""
    return {flank: figures.topographies[0] for flank, figures in found.flanks.items() if figures.topographies}


def pitches(found: MemberEvaluation) -> list[Pitch]:
    """The pitch of each flank that has one."""
    return [figures.pitch for figures in found.flanks.values() if figures.pitch is not None]


def after_correction(measurement: ReportedMeasurement) -> Mapping[str, Topography]:
    """The flanks as measured again, or else as the correction is expected to leave them."""
    if measurement.again is not None:
        return means(measurement.again)
    if measurement.correction is None:
        return {}
    return expected_topographies(measurement.member, measurement.evaluation, measurement.correction)


def pitches_after(measurement: ReportedMeasurement) -> list[Pitch]:
    """Pitch as measured again, or else as corrected indexing is expected to leave it."""
    found, correction = measurement.evaluation, measurement.correction
    if measurement.again is not None:
        return pitches(measurement.again)
    if correction is None or correction.index is None:
        return []
    return [_indexed(one, found, measurement.member) for one in pitches(found)]


def expected_topographies(
    member: Member, found: MemberEvaluation, correction: MemberCorrection
) -> dict[str, Topography]:
    """What the correction is expected to leave of each flank that it was made for, on the grid [mm]."""
    expected = {}
    for group, result in correction.identified.items():
        targets = [flank_target(member, flank, found.file) for flank in group]
        ends = np.cumsum([len(target.deviation) for target in targets])[:-1]
        for flank, target, part in zip(group, targets, np.split(result.residual, ends), strict=True):
            if not found.flanks[flank].topographies:
                continue  # corrected from fewer points than a topography needs
            deviation = np.full(target.grid_points, np.nan)
            deviation[slice(None) if target.used is None else target.used] = part
            shape = grid_shape(found.file)
            like = found.flanks[flank].topographies[0]
            # no surface of third degree is expected to remain
            surface = np.zeros_like(like.coefficients)
            deviation = deviation.reshape(shape)
            expected[flank] = replace(like, deviation=deviation, coefficients=surface, residual=deviation)
    return expected


def _indexed(one: Pitch, found: MemberEvaluation, member: Member) -> Pitch:
    """The pitch of a flank when every space is turned by the correction of both flanks."""
    turning = one.turning + index_correction(pitches(found))
    points = reference_rows(found.file, member.teeth, one.flank)
    assert points is not None  # there is a pitch
    return replace(one, turning=turning, cumulative=turning * np.hypot(*points.point[0, :2]))


def _teeth(found: MemberEvaluation, flank: str) -> str:
    teeth = [each.tooth for each in found.flanks[flank].topographies]
    return f"tooth {teeth[0]}" if len(teeth) == 1 else f"mean of {len(teeth)} teeth"

"""A member in one picture: flanks before and after, pitch, runout."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from matplotlib.axes import Axes

from gearmath.plot.figure import Figure
from gearmath.plot.pitch import draw_pitch, draw_runout
from gearmath.plot.style import signed
from gearmath.plot.topography import draw_topography, um_per_row
from gearmath.quality.evaluation.member import MemberEvaluation
from gearmath.quality.evaluation.pitch import Pitch
from gearmath.quality.evaluation.registration import Registration
from gearmath.quality.evaluation.topography import Topography


def member_figure(
    title: str,
    before: Mapping[str, Topography],
    after: Mapping[str, Topography],
    pitch_before: Sequence[Pitch] = (),
    pitch_after: Sequence[Pitch] = (),
    taken: Mapping[str, float] | None = None,
) -> Figure:
    """Both flanks of a member before and after, at one scale, and its pitch, in one picture.

    ``taken`` [mm] of each flank is what was taken off ``before`` at the reference point, where it was turned to zero.
    """
    drawn = _topographies(before, after, taken or {})
    if pitch_before:
        drawn.append(partial(draw_pitch, before=pitch_before, after=pitch_after))
    return _together(title, drawn)


def evaluation_figure(title: str, evaluation: MemberEvaluation) -> Figure:
    """A measured member: flanks as measured and as registered, pitch polygons, runout; what the clamping was.

    Where no clamping was taken out, they are as they are judged, without the rotation that both flanks have in common.
    """
    registered = evaluation.taken_out is not None
    before, after = (evaluation.as_measured, evaluation.flanks) if registered else (evaluation.flanks, {})
    first, last = ({k: f.chart for k, f in each.items() if f.chart is not None} for each in (before, after))
    shown = after or before
    taken = {k: f.mean.at_reference for k, f in shown.items() if f.mean is not None}
    drawn = _topographies(first, last, taken)
    pitches = [[f.pitch for f in each.values() if f.pitch is not None] for each in (before, after)]
    if pitches[0]:
        drawn.append(partial(draw_pitch, before=pitches[0], after=pitches[1]))
    if evaluation.runout_as_measured:
        after_runout = evaluation.runout if registered else None
        drawn.append(partial(draw_runout, before=evaluation.runout_as_measured, after=after_runout))
    return _together(title + _seat_words(evaluation.taken_out), drawn)


def _topographies(
    before: Mapping[str, Topography], after: Mapping[str, Topography], taken: Mapping[str, float]
) -> list[Callable[[Axes], None]]:
    """What draws each flank, all at one scale: after, with its numbers, over before."""
    scale = um_per_row([*before.values(), *after.values()])
    return [
        partial(_flank, before=each, after=after.get(flank), scale=scale, taken=taken.get(flank))
        for flank, each in before.items()
    ]


def _flank(axes: Axes, before: Topography, after: Topography | None, scale: float, taken: float | None) -> None:
    if after is None:
        draw_topography(axes, before, scale=scale, taken=taken)
    else:
        same_grid = after.deviation.shape == before.deviation.shape
        draw_topography(axes, after, before if same_grid else None, scale, taken)
    shown = [("", before)] if after is None else [(" before", before), (" after", after)]
    words = ", ".join(f"{_largest(each)}{when}" for when, each in shown)
    axes.set_title(f"{before.flank} flank\nlargest: {words}", fontsize=9)  # in two lines: flanks stand side by side
    axes.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.08), ncol=3, frameon=False)


def _largest(shown: Topography) -> str:
    return "withheld, a point is missing" if shown.left_out else f"{signed(shown.extreme * 1000)} µm"


def _together(title: str, drawn: Sequence[Callable[[Axes], None]]) -> Figure:
    rows = 2 if len(drawn) > 3 else 1
    columns = -(-len(drawn) // rows)
    figure = Figure(figsize=(4.4 * max(columns, 2), 4.2 * rows), layout="constrained")
    figure.suptitle(title, parse_math=False)
    places = figure.subplots(rows, max(columns, 1), squeeze=False).ravel()
    for place, draw in zip(places, drawn, strict=False):
        draw(place)
    return figure


def _seat_words(seat: Registration | None) -> str:
    if seat is None:
        return ""
    tilt = f", tilt {seat.tilt * 1e5:.1f} µm/100 mm" if seat.tilt_found else ""
    return f"\nbefore and after registration: eccentricity {seat.eccentricity * 1000:.1f} µm{tilt} taken out"

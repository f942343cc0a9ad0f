"""Runs of a member in one picture: flanks and pitch of two of them, or the figures of many in their order."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from matplotlib.axes import Axes

from gearmath.plot.figure import Figure
from gearmath.plot.member import member_figure
from gearmath.plot.style import AFTER, BEFORE, INK
from gearmath.quality.evaluation.member import MemberEvaluation
from gearmath.quality.evaluation.pitch import Pitch
from gearmath.quality.evaluation.topography import Topography

#: A value and its standard uncertainty [µm] for each run, None where there is none.
Course = Sequence[tuple[float | None, float | None]]
_COLUMNS = 3
#: Half the length of a bar, in standard uncertainties.
_BAR = 2.0


def comparison_figure(title: str, before: MemberEvaluation, after: MemberEvaluation) -> Figure:
    """Mean topographies at one scale, as they deviate from the nominal flank, and pitch, as far as both have them."""
    return member_figure(title, _forms(before), _forms(after), _pitches(before), _pitches(after))


def course_figure(title: str, runs: Sequence[int], figures: Mapping[str, Mapping[str, Course]]) -> Figure:
    """Each figure over the runs, in the order given: a line a flank, with bars of 2 u where u is known."""
    rows = -(-len(figures) // _COLUMNS)
    figure = Figure(figsize=(3.6 * _COLUMNS, 2.6 * rows), layout="constrained")
    figure.suptitle(title, parse_math=False)
    places = figure.subplots(rows, _COLUMNS, squeeze=False).ravel()
    for place, (name, by_flank) in zip(places, figures.items(), strict=False):
        _course(place, name, runs, by_flank)
    for place in places[len(figures) :]:
        place.set_axis_off()
    return figure


def _course(axes: Axes, name: str, runs: Sequence[int], by_flank: Mapping[str, Course]) -> None:
    colors = {"concave": BEFORE, "convex": AFTER}
    for k, (flank, course) in enumerate(by_flank.items()):
        y = [math.nan if value is None else value for value, _ in course]
        bars = [0.0 if u is None else _BAR * u for _, u in course]
        # side by side, so that the bars of both flanks can be read
        x = [index + 0.08 * (k - (len(by_flank) - 1) / 2) for index in range(len(runs))]
        axes.errorbar(x, y, bars, color=colors.get(flank, INK), marker="o", markersize=4, capsize=2, label=flank)
    axes.axhline(0.0, color=INK, linewidth=0.5)
    axes.set_title(name, fontsize=9)
    axes.set_ylabel("µm", fontsize=8)
    axes.set_xticks(range(len(runs)), [str(run) for run in runs])
    axes.tick_params(labelsize=8)
    axes.legend(fontsize=7, frameon=False)


def _forms(found: MemberEvaluation) -> dict[str, Topography]:
    return {flank: figures.mean for flank, figures in found.flanks.items() if figures.mean is not None}


def _pitches(found: MemberEvaluation) -> list[Pitch]:
    return [figures.pitch for figures in found.flanks.values() if figures.pitch is not None]

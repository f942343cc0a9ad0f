"""The charts of an inspection sheet, each as wide as half a page of A4 or a telephone."""

from __future__ import annotations

from collections.abc import Mapping

from gearmath.plot.figure import Figure
from gearmath.plot.pitch import draw_cumulative, draw_runout, draw_single_pitch
from gearmath.plot.tooth import ToothFlank, draw_tooth
from gearmath.plot.topography import draw_topography
from gearmath.quality.evaluation.pitch import Pitch
from gearmath.quality.evaluation.spaces import Runout
from gearmath.quality.evaluation.topography import Topography

#: Width of a chart [inch], half of A4 between its margins: letters of 8 pt are 8 pt on paper.
_WIDTH = 3.64

Limits = tuple[tuple[float, float], tuple[float, float]]


def topography_chart(shown: Topography, scale: float, taken: float | None) -> Figure:
    """One flank with its numbers, at a given scale."""
    figure = Figure(figsize=(_WIDTH, 2.9), layout="constrained")
    draw_topography(figure.subplots(), shown, scale=scale, taken=taken)
    return figure


def pitch_chart(pitch: Pitch, after: Pitch | None, limits: Limits) -> Figure:
    """Bars of single pitch above the cumulative curve of one flank, in the given limits [µm]."""
    figure = Figure(figsize=(_WIDTH, 2.7), layout="constrained")
    bars, curve = figure.subplots(2, sharex=True)
    draw_single_pitch(bars, pitch, after)
    draw_cumulative(curve, pitch, after)
    for axes, ends in zip((bars, curve), limits, strict=True):
        axes.set_ylim(*ends)
    return figure


def runout_chart(runout: Runout) -> Figure:
    """Movement of a ball in every space."""
    figure = Figure(figsize=(_WIDTH, 2.15), layout="constrained")
    axes = figure.subplots()
    draw_runout(axes, runout)
    axes.set_ylabel("movement / µm", fontsize=8)  # the caption says of what
    return figure


def tooth_chart(flanks: Mapping[str, ToothFlank], seen: str, times: float) -> Figure:
    """A tooth in perspective from the side of one flank, deviations enlarged so many ``times``."""
    figure = Figure(figsize=(_WIDTH, 1.9), layout="constrained")
    draw_tooth(figure.subplots(), flanks, seen, times)
    return figure

"""The chart of a virtual gear in the layout of a gear inspection machine: profile, helix, pitch and runout."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from gearmath.gearbox.hobbed.inspection import Inspection, MeasuredTrace, PitchRow, Side
from gearmath.gearbox.hobbed.thread import ThreadTrace
from gearmath.plot.figure import Figure
from gearmath.plot.style import AFTER, BEFORE, INK, NOMINAL

#: Rules with their colors: the gear itself, and the one beside it.
_COLORS = (INK, BEFORE)
#: Part of a chart that a row of its legend takes above the lines.
_A_ROW = 0.12
_SIDES: tuple[Side, Side] = ("left", "right")


def inspection_figure(title: str, gears: Sequence[tuple[str, Inspection]]) -> Figure:
    """Chart of one gear, or of two beside each other, (name, inspection) each: traces upwards, metal to the right."""
    figure = Figure(figsize=(8.3, 11.0), layout="constrained")
    figure.suptitle(title, fontsize=10)
    rows = figure.add_gridspec(4, 2, height_ratios=(1.5, 1.5, 1.0, 1.0))
    for row, (kind, name) in enumerate((("profiles", "profile"), ("helices", "helix"))):
        scale = _scale([trace for _, found in gears for trace in getattr(found, kind)])
        for column, side in enumerate(_SIDES):
            axes = figure.add_subplot(rows[row, column])
            _traces(axes, kind, side, gears, scale)
            axes.set_title(f"{name}, {side} flank", fontsize=9)
    for column, side in enumerate(_SIDES):
        axes = figure.add_subplot(rows[2, column])
        _pitch(axes, side, gears)
    _runout(figure.add_subplot(rows[3, :]), gears)
    return figure


def thread_figure(title: str, traces: Sequence[ThreadTrace]) -> Figure:
    """Pitch error of a thread over its length, by rule."""
    figure = Figure(figsize=(8.3, 4.0), layout="constrained")
    axes = figure.subplots()
    for trace, color in zip(traces, _COLORS, strict=False):
        label = f"{trace.rule}: {trace.total * 1000:.1f} µm over the length"
        axes.plot(trace.place, trace.deviation * 1000, color=color, linewidth=0.7, label=label)
    axes.set_title(f"{title}: pitch error", fontsize=9)
    _finish(axes, "along the thread / mm", "deviation / µm")
    return figure


def _scale(traces: Sequence[MeasuredTrace]) -> float:
    """µm between two traces."""
    widest = max(trace.total for trace in traces) * 1000
    return max(1.0, float(np.ceil(1.3 * widest)))


def _traces(axes: Axes, kind: str, side: Side, gears: Sequence[tuple[str, Inspection]], scale: float) -> None:
    for (_, found), color in zip(gears, _COLORS, strict=False):
        for place, trace in enumerate(trace for trace in getattr(found, kind) if trace.side == side):
            middle = float(np.mean(trace.deviation))
            axes.axvline(place * scale, color=NOMINAL, linewidth=0.5)
            axes.plot((trace.deviation - middle) * 1000 + place * scale, trace.place, color=color, linewidth=0.8)
            axes.plot((trace.line - middle) * 1000 + place * scale, trace.place, "--", color=color, linewidth=0.5)
            if color == INK:
                axes.annotate(
                    f"tooth {trace.tooth}\nF {trace.total * 1000:.1f} µm",
                    (place * scale, trace.place[-1]),
                    xytext=(0, 3),
                    textcoords="offset points",
                    fontsize=6,
                    ha="center",
                )
    axes.set_xlabel(f"deviation / µm, {scale:.0f} µm from trace to trace", fontsize=7)
    axes.set_ylabel("length of roll / mm" if kind == "profiles" else "height on the gear / mm", fontsize=7)
    axes.margins(y=0.12)
    axes.tick_params(labelsize=7)


def _pitch(axes: Axes, side: Side, gears: Sequence[tuple[str, Inspection]]) -> None:
    for (name, found), color in zip(gears, _COLORS, strict=False):
        row = next(row for row in found.pitches if row.side == side)
        teeth = np.arange(len(row.position))
        axes.bar(teeth, row.single * 1000, 0.8, color=AFTER if color == INK else BEFORE, alpha=0.5)
        axes.plot(
            teeth, (row.position - row.position.mean()) * 1000, color=color, linewidth=0.9, label=_figures(name, row)
        )
    axes.set_title(f"pitch, {side} flank: bars single, line cumulative", fontsize=9)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    _finish(axes, "tooth", "deviation / µm")


def _figures(name: str, row: PitchRow) -> str:
    return f"{name}: f_pt {row.worst * 1000:.1f}, F_p {row.total * 1000:.1f} µm"


def _runout(axes: Axes, gears: Sequence[tuple[str, Inspection]]) -> None:
    for (name, found), color in zip(gears, _COLORS, strict=False):
        axes.plot(found.ball * 1000, color=color, linewidth=0.9, label=f"{name}: F_r {found.runout * 1000:.1f} µm")
    axes.set_title("runout: ball in every space", fontsize=9)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    _finish(axes, "space", "deviation / µm")


def _finish(axes: Axes, across: str, up: str) -> None:
    axes.axhline(0, color=NOMINAL, linewidth=0.5)
    axes.set_xlabel(across, fontsize=7)
    axes.set_ylabel(up, fontsize=7)
    axes.tick_params(labelsize=7)
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + _A_ROW * (high - low) * len(axes.get_legend_handles_labels()[1]))
    axes.legend(fontsize=7, frameon=False, loc="upper right")

"""Pitch and runout over the teeth, which are numbered as in the flank files, from 0."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from gearmath.plot.style import AFTER, BEFORE, INK, NOMINAL, or_withheld
from gearmath.quality.evaluation.pitch import Pitch
from gearmath.quality.evaluation.spaces import Runout

#: Less than this [µm] is not enlarged.
_LEAST_UM = 1.0
_BAR, _ROOM = 0.8, 1.12


def pitch_limits(pitches: Iterable[Pitch]) -> tuple[tuple[float, float], tuple[float, float]]:
    """The ends of the axes [µm] for single pitch and for the cumulative curve that suit all of these flanks."""
    every = list(pitches)
    return _limits([one.single for one in every]), _limits([one.cumulative for one in every])


def _limits(values: Sequence[np.ndarray]) -> tuple[float, float]:
    known = np.concatenate([[0.0], *(each[np.isfinite(each)] * 1000 for each in values)])
    low, high = float(known.min()), float(known.max())
    room = (_ROOM - 1) * max(high - low, _LEAST_UM)
    return low - room, high + room


def draw_single_pitch(axes: Axes, pitch: Pitch, after: Pitch | None = None) -> None:
    """Single pitch deviation of every tooth as bars, in µm; hollow ones beside them for ``after``."""
    teeth = np.arange(len(pitch.cumulative))
    axes.bar(teeth, np.nan_to_num(pitch.single * 1000), _BAR, color="#8c8c8c", edgecolor=INK, linewidth=0.4)
    if after is not None:
        width = _BAR / 2
        axes.bar(
            teeth,
            np.nan_to_num(after.single * 1000),
            width,
            facecolor="white",
            edgecolor=AFTER,
            linewidth=0.8,
            alpha=0.9,
        )
    _unknown(axes, pitch.single)
    axes.set_ylabel("f_pt / µm", fontsize=8)
    _teeth(axes, len(teeth))


def draw_cumulative(axes: Axes, pitch: Pitch, after: Pitch | None = None) -> None:
    """Cumulative pitch deviation of every tooth as a curve, in µm; a dashed one for ``after``."""
    axes.plot(pitch.cumulative * 1000, color=INK, linewidth=1.2, marker=".", markersize=4, label="measured")
    if after is not None:
        axes.plot(after.cumulative * 1000, "--", color=AFTER, linewidth=1.2, label="after")
    _unknown(axes, pitch.cumulative)
    axes.set_ylabel("cumulative / µm", fontsize=8)
    axes.set_xlabel("tooth", fontsize=8)
    _teeth(axes, len(pitch.cumulative))


def draw_pitch(axes: Axes, before: Sequence[Pitch], after: Sequence[Pitch] = ()) -> None:
    """Cumulative pitch deviation of both flanks in one diagram, in µm."""
    for pitches, color, label in ((before, BEFORE, "before, " if after else ""), (after, AFTER, "after, ")):
        for pitch, style in zip(pitches, ("-", "--"), strict=False):
            text = f"{label}{pitch.flank}: F_p {or_withheld(pitch.total)}"
            axes.plot(pitch.cumulative * 1000, style, color=color, linewidth=1.2, marker=".", markersize=3, label=text)
    axes.axhline(0, color=NOMINAL, linewidth=0.6)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("tooth", fontsize=8)
    axes.set_ylabel("cumulative pitch deviation / µm", fontsize=8)
    axes.tick_params(labelsize=8)
    axes.legend(fontsize=8, frameon=False)


def draw_runout(axes: Axes, before: Runout, after: Runout | None = None) -> None:
    """Movement of a ball in every space, normal to the pitch cone, in µm, and the first harmonic through it, dashed."""
    for runout, color, label in ((before, BEFORE, "before: " if after else ""), (after, AFTER, "after: ")):
        if runout is None:
            continue
        size, direction = runout.eccentricity
        wave = float(np.nanmean(runout.shift)) + size * np.cos(runout.azimuth - direction)
        text = f"{label}F_r {or_withheld(runout.total)}"
        axes.plot(runout.shift * 1000, color=color, linewidth=1.2, marker=".", markersize=3, label=text)
        text = f"harmonic {size * 1000:.1f} µm at {np.degrees(direction):.0f}°"
        axes.plot(wave * 1000, "--", color=color, linewidth=0.8, label=text)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("space", fontsize=8)
    axes.set_ylabel("ball, normal to the pitch cone / µm", fontsize=8)
    axes.tick_params(labelsize=8)
    axes.legend(
        fontsize=8,
        frameon=False,
        loc="lower left",
        bbox_to_anchor=(0, 1),
        ncol=1 if after is None else 2,
        borderaxespad=0.1,
        handlelength=1.5,
        columnspacing=1.0,
        labelspacing=0.2,
    )


def _unknown(axes: Axes, values: np.ndarray) -> None:
    """A cross at zero for every tooth without a value."""
    (absent,) = np.nonzero(~np.isfinite(values))
    if len(absent):
        axes.plot(absent, np.zeros(len(absent)), "x", color=BEFORE, markersize=5, label="no value")


def _teeth(axes: Axes, count: int) -> None:
    axes.axhline(0, color=INK, linewidth=0.6)
    axes.set_xlim(-0.7, count - 0.3)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True, nbins=13))
    axes.tick_params(labelsize=8)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", color="#dddddd", linewidth=0.5)
    axes.set_axisbelow(True)

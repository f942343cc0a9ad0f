"""How sure the figures of a measured member are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from gearmath.plot.figure import Figure
from gearmath.plot.style import AFTER, BEFORE, INK, NOMINAL
from gearmath.quality.uncertainty.propagation import Uncertain

#: Color and marker of each flank, and of what belongs to both.
_LOOKS = {"concave": (BEFORE, "o"), "convex": (AFTER, "s")}
_BOTH = (INK, "D")
#: Height of a diagram of single pitch, and of the line of one figure [inch].
_PITCH, _LINE = 1.7, 0.19
#: More teeth than this have a tick each, but not a number each.
_MOST_NUMBERS = 26


def uncertainty_figure(title: str, found: Sequence[Uncertain]) -> Figure:
    """Single pitch of each flank over the teeth, then every other figure in µm on its own line; intervals of 95 %."""
    um = [one for one in found if one.figure.unit == "um"]
    pitch = [one for one in um if one.figure.name.startswith("f_pt_")]
    flanks = list(dict.fromkeys(one.figure.flank for one in pitch))
    names = list(dict.fromkeys(one.figure.name for one in um))
    rest = sorted((one for one in um if one not in pitch), key=lambda one: names.index(one.figure.name))
    heights = [_PITCH] * len(flanks) + [0.6 + _LINE * len(rest)] * bool(rest)
    figure = Figure(figsize=(6.4, 0.4 + sum(heights)), layout="constrained")
    figure.suptitle(title, fontsize=10, parse_math=False)
    if not heights:
        return figure
    places = figure.subplots(len(heights), squeeze=False, gridspec_kw={"height_ratios": heights})[:, 0]
    for axes, flank in zip(places, flanks, strict=False):
        _draw_pitch(axes, flank, [one for one in pitch if one.figure.flank == flank])
    if rest:
        _draw_figures(places[-1], rest)
    return figure


def _draw_pitch(axes: Axes, flank: str, pitch: Sequence[Uncertain]) -> None:
    """Each at the number of its tooth."""
    teeth = [int(one.figure.name.removeprefix("f_pt_")) for one in pitch]
    value, spread = _with_interval(pitch)
    axes.errorbar(teeth, value, yerr=spread, **_look(flank))
    every = -(-len(teeth) // _MOST_NUMBERS)
    axes.set_xticks(teeth, [str(tooth) if tooth % every == 0 else "" for tooth in teeth])
    axes.set_xlabel("tooth", fontsize=8)
    axes.set_ylabel(f"f_pt {flank} / µm", fontsize=8)
    axes.axhline(0, color=NOMINAL, linewidth=0.6)
    _dress(axes)


def _draw_figures(axes: Axes, rest: Sequence[Uncertain]) -> None:
    """Each on the line of its name and flank."""
    lines = np.arange(len(rest))
    value, spread = _with_interval(rest)
    for flank in dict.fromkeys(one.figure.flank for one in rest):
        here = np.array([one.figure.flank == flank for one in rest])
        axes.errorbar(value[here], lines[here], xerr=spread[:, here], **_look(flank))
    axes.set_yticks(lines, [f"{one.figure.name.replace('_', ' ')}, {one.figure.flank}" for one in rest])
    axes.set_ylim(len(rest) - 0.4, -0.6)
    axes.set_xlabel("µm, with the interval of 95 %", fontsize=8)
    axes.axvline(0, color=NOMINAL, linewidth=0.6)
    _dress(axes)


def _with_interval(some: Sequence[Uncertain]) -> tuple[np.ndarray, np.ndarray]:
    """Values (n,), and how far their intervals reach below and above (2,n) [µm]."""
    value = np.array([one.value for one in some]) * 1000
    return value, np.abs(np.array([one.interval for one in some]).T * 1000 - value)


def _look(flank: str) -> dict:
    color, marker = _LOOKS.get(flank, _BOTH)
    return {"fmt": marker, "color": color, "capsize": 2.5, "markersize": 3.5, "linewidth": 1.0, "label": flank}


def _dress(axes: Axes) -> None:
    axes.tick_params(labelsize=8)
    axes.grid(color="#e4e4e4", linewidth=0.5)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)

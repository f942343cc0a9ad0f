"""How a pair runs: transmission error over three pitches, path with ellipses, ease-off and pattern, side by side."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Patch, Polygon

from gearmath.bevel.contact.local import local
from gearmath.bevel.contact.mesh import REACH, Mesh
from gearmath.bevel.contact.pattern import ContactPattern, envelope, pattern
from gearmath.bevel.contact.report import SIDES, v_h
from gearmath.plot.figure import Figure
from gearmath.plot.style import AFTER, BEFORE, INK, NOMINAL

_ARCSEC = math.degrees(1) * 3600
#: Colors of the kinds of contact.
_KINDS = {"interior": AFTER, "edge": BEFORE, "corner": INK, "fillet": "#d98c00"}
_SAMPLES, _ELLIPSES = 361, 9
#: Leads further behind than this many times what the pair runs on are not drawn.
_SHOWN = 4.0
#: Difference of leads [rad] that counts as none.
_SAME_LEAD = 1e-10
#: Room about the tooth, in parts of its width.
_ROOM = 0.04
#: Contact lines to a pitch.
_CONTACT_LINES = 4


def contact_figure(runs: Mapping[str, Mesh], tolerances: Mapping[str, Any] | None = None) -> Figure:
    """A row for each side: transmission error, path on the projected tooth, pattern over the ease-off, V-H diagram.

    ``tolerances`` by side are the objects ``tolerance_mm`` of the JSON.
    """
    figure = Figure(figsize=(15.5, 3.7 * len(runs)), layout="constrained")
    widths = {"width_ratios": [1, 1, 1, 0.6]}
    rows = figure.subplots(len(runs), 4, squeeze=False, gridspec_kw=widths)
    for places, (side, run) in zip(rows, runs.items(), strict=True):
        found = pattern(run)
        _draw_error(places[0], run, f"{side}, pinion {SIDES[side]}: {run.outcome}")
        _draw_path(places[1], run, found)
        _draw_pattern(places[2], found, run.system.pitch)
        _draw_v_h(places[3], run, (tolerances or {}).get(side))
    return figure


def patterns_figure(states: Mapping[str, Mapping[str, Mesh]]) -> Figure:
    """Patterns of one pair in several states (nominal, measured, corrected): a column a state, a row a side."""
    sides = list(next(iter(states.values())))
    figure = Figure(figsize=(4.6 * len(states), 2.2 * len(sides)), layout="constrained")
    rows = figure.subplots(len(sides), len(states), squeeze=False, sharex=True, sharey=True)
    for places, side in zip(rows, sides, strict=True):
        for axes, (state, runs) in zip(places, states.items(), strict=True):
            _draw_pattern(axes, pattern(runs[side]))
            axes.set_title(f"{state}, {side}", fontsize=8, loc="left")
    return figure


def _draw_v_h(axes: Axes, run: Mesh, limits: dict[str, Any] | None) -> None:
    """V and H for contact at toe, mean and heel, the assembly as it stands, and how far from it an edge is reached."""
    found = {name: at for name, at in v_h(run).items() if at is not None}
    if found:
        line = np.array(list(found.values()))
        axes.plot(line[:, 0], line[:, 1], "o-", color=AFTER, markersize=4, linewidth=1.2)
        for name, place in found.items():
            axes.annotate(name, (place[0], place[1]), textcoords="offset points", xytext=(5, 4), fontsize=7)
    else:
        words = "no V and H bring the contact\nto toe, mean or heel"
        axes.text(0.5, 0.9, words, transform=axes.transAxes, ha="center", va="top", fontsize=8)
    V, H = run.assembly[:2]
    axes.plot([V], [H], "+", color=INK, markersize=9)
    # a pair that runs on edges as it stands has none
    found_limits = limits or {}
    changes = found_limits.get("outcome_changes") or {}
    for name, along in (("v", np.array([1.0, 0.0])), ("h", np.array([0.0, 1.0]))) if changes else ():
        for sense, at in found_limits[name].items():
            value, edge = at["value"], at["edge"]
            end, turns = (np.array([V, H]) + one * along for one in (value, changes[name][sense]["value"]))
            axes.plot([V, end[0]], [H, end[1]], color=BEFORE, linewidth=1.2, marker="|" if along[0] else "_")
            axes.plot([V, turns[0]], [H, turns[1]], color=AFTER, linewidth=3.5, alpha=0.6, solid_capstyle="butt")
            words = edge or f"no edge to {value:+.2g}"
            axes.annotate(words, tuple(end), fontsize=6, color=BEFORE, ha="center")
    axes.axhline(0, color=NOMINAL, linewidth=0.5)
    axes.axvline(0, color=NOMINAL, linewidth=0.5)
    axes.margins(0.25)
    _label(axes, "V-H diagram" + ("; thick: outcome stays" if changes else ""), "V / mm", "H / mm")


def _draw_error(axes: Axes, run: Mesh, title: str) -> None:
    """The error of three pairs of teeth, a color for each kind, under the envelope of all."""
    system, pitch = run.system, run.system.pitch
    rotations = np.linspace(-REACH, REACH, _SAMPLES) * pitch
    zero = run.reference or 0.0
    first = system.sense * envelope(run, rotations)
    if run.is_line:
        axes.plot(np.degrees(rotations), (first - zero) * _ARCSEC, color=AFTER, linewidth=1.5)
    for thread in run.threads:
        for k in (-1, 0, 1):
            errors = thread.errors(system, rotations - k * pitch)
            for kind, color in _KINDS.items():
                here = np.zeros(len(rotations), dtype=bool)
                for part in thread.segments:
                    if part.kind == kind:
                        here |= (rotations - k * pitch >= part.ends[0]) & (rotations - k * pitch <= part.ends[1])
                shown = np.where(here, (errors - zero) * _ARCSEC, np.nan)
                axes.plot(np.degrees(rotations), shown, color=color, linewidth=1.0, alpha=1.0 if k == 0 else 0.45)
    axes.plot(np.degrees(rotations), (first - zero) * _ARCSEC, color=INK, linewidth=3.0, alpha=0.25)
    known = (first[np.isfinite(first)] - zero) * _ARCSEC
    if len(known):
        spread = max(float(np.ptp(known)), 1e-6)
        low, high = float(known.min()), float(known.max())
        below, above = (_SHOWN, 0.3) if system.sense > 0 else (0.3, _SHOWN)
        axes.set_ylim(low - below * spread, high + above * spread)
    for kind, color in _KINDS.items():
        axes.plot([], [], color=color, label=f"{kind} contact")
    axes.plot([], [], color=INK, linewidth=3.0, alpha=0.25, label="gear follows")
    axes.legend(fontsize=6, loc="best", framealpha=0.8, edgecolor="none")
    _label(axes, title, "pinion / degree", "transmission error / arcsec")


def _draw_path(axes: Axes, run: Mesh, found: ContactPattern) -> None:
    """The path of one pair of teeth on the gear, with the contact ellipses along it."""
    tooth = _outline(axes, found)
    step = 3 * run.system.pitch / (_SAMPLES - 1)
    rows = run.path(step)
    ahead = run.system.sense * run.followed(np.array([row.rotation for row in rows]))
    carries = [run.system.sense * row.error > lead - _SAME_LEAD for row, lead in zip(rows, ahead, strict=True)]
    for kind, color in _KINDS.items():
        for carrying, size, alpha in ((False, 1.0, 0.5), (True, 4.0, 1.0)):
            among = [row for row, own in zip(rows, carries, strict=True) if row.kind == kind and own == carrying]
            at = np.array([(row.cone_distance, row.height) for row in among]).reshape(-1, 2)
            axes.plot(*at.T, ".", color=color, markersize=size, alpha=alpha)
    for thread, segment in run.interior:
        for rotation in np.linspace(*segment.ends, _ELLIPSES):
            touch = thread.at(run.system, float(rotation))
            if touch is None:
                continue
            here = local(run.system, touch, run.assembly)
            if not here.definite:
                continue
            turn = np.linspace(0, 2 * np.pi, 60)
            along, across = (np.array([f(here.major_angle) for f in pair]) for pair in _AXES)
            ring = here.semi_axes[0] * along[:, None] * np.cos(turn) + here.semi_axes[1] * across[:, None] * np.sin(
                turn
            )
            center = np.array(run.system.gear_place(touch.x))
            seen = (center[:, None] + here.axial @ ring).T
            ellipse = axes.add_patch(Polygon(seen, fill=False, edgecolor=AFTER, linewidth=0.6, alpha=0.7))
            ellipse.set_clip_path(tooth)
    axes.plot(run.system.gear.blank.mean_cone_distance, 0, "+", color=INK, markersize=7)
    words = "path of one pair of teeth on the gear (thick where it carries), ellipses"
    _label(axes, words, "cone distance / mm (toe left)", "height / mm (tip up)")


_AXES = ((math.cos, math.sin), (lambda a: -math.sin(a), math.cos))


def _draw_pattern(axes: Axes, found: ContactPattern, pitch: float | None = None) -> None:
    """Lines of the ease-off in µm, area within the marking compound; contact lines, four to a ``pitch`` [rad]."""
    _outline(axes, found)
    gap = np.ma.masked_invalid(found.gap * 1000)
    if gap.count():
        axes.contourf(
            found.cone_distance, found.height, gap, levels=[-1e3, found.thickness * 1000], colors=[AFTER], alpha=0.45
        )
    ease_off = np.ma.masked_invalid(found.ease_off * 1000)
    if ease_off.count() and float(np.ptp(ease_off.compressed())) > 1e-3:
        lines = axes.contour(found.cone_distance, found.height, ease_off, levels=10, colors=[NOMINAL], linewidths=0.6)
        axes.clabel(lines, fontsize=6, fmt="%g")
    rotation = np.ma.masked_invalid(found.rotation)
    words = f"pattern at {found.thickness * 1000:.3g} µm, ease-off in µm"
    if pitch is not None and rotation.count():
        steps = _CONTACT_LINES / pitch * np.array([rotation.min(), rotation.max()])
        levels = np.arange(math.ceil(steps[0]), math.floor(steps[1]) + 1) * pitch / _CONTACT_LINES
        if len(levels):
            style: dict[str, Any] = {"colors": [BEFORE], "linewidths": 0.7, "linestyles": "--"}
            axes.contour(found.cone_distance, found.height, rotation, levels=levels, **style)
            words += "; dashed: contact lines"
    _label(axes, words, "cone distance / mm (toe left)", "height / mm (tip up)")


def _outline(axes: Axes, found: ContactPattern) -> Patch:
    """The projected tooth of the gear, from its tip to the lower limit of its working depth."""
    x, y = found.cone_distance, found.height
    rim = [np.concatenate([a[0], a[1:, -1], a[-1, ::-1], a[::-1, 0]]) for a in (x, y)]
    (tooth,) = axes.fill(*rim, facecolor="#f7f7f7", edgecolor=INK, linewidth=0.8, zorder=0)
    axes.set_aspect("equal")
    # an ellipse that runs out on nearly conjugate flanks must not shrink the tooth to a stamp
    for limits, ends in ((axes.set_xlim, x), (axes.set_ylim, y)):
        room = _ROOM * float(np.nanmax(x) - np.nanmin(x))
        limits(float(np.nanmin(ends)) - room, float(np.nanmax(ends)) + room)
    return tooth


def _label(axes: Axes, title: str, x: str, y: str) -> None:
    axes.set_title(title, fontsize=8, loc="left")
    axes.set_xlabel(x, fontsize=7)
    axes.set_ylabel(y, fontsize=7)
    axes.tick_params(labelsize=7)

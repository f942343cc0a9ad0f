"""Pictures: topography before and after, and the pitch of a member. The only module that draws."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gearmath.files import write_bytes
from gearmath.quality.evaluation import Evaluation
from gearmath.quality.pitch import Pitch
from gearmath.quality.registration import Registration
from gearmath.quality.spaces import Runout
from gearmath.quality.topography import Topography
from gearmath.quality.uncertainty import Uncertain

#: Colours of "before" and "after" in every picture of this house.
BEFORE, AFTER = "#c23b22", "#1f6f8b"


def draw_topography(
    axes: Axes, before: Topography, after: Topography | None = None, zeroed: bool = False
) -> None:  # fmt: skip
    """One flank as the measuring room draws it: the nominal grid, and the deviations standing on it, in µm.

    Columns run from toe (left) to heel, rows from root (below) to tip; one row's distance is the size of the largest
    deviation drawn. ``zeroed`` says that the flanks were turned to zero at their reference points.
    """
    rows, columns = before.deviation.shape
    scale = 1.0 / max(abs(before.extreme) * 1000, 1e-9)
    x, y = np.meshgrid(np.arange(columns), np.arange(rows))
    for line_x, line_y in [*zip(x, y, strict=True), *zip(x.T, y.T, strict=True)]:
        axes.plot(line_x, line_y, color="#bbbbbb", linewidth=0.6)
    for topography, color, label in ((before, BEFORE, "before"), (after, AFTER, "after")):
        if topography is None:
            continue
        z = y + topography.deviation * 1000 * scale
        most = "withheld, a point is missing" if topography.left_out else f"{topography.extreme * 1000:+.2f} µm"
        for k in range(rows):
            axes.plot(
                x[k],
                z[k],
                color=color,
                linewidth=1.2,
                label=f"{label}: max {most}" if k == 0 else None,
            )
        for k in range(columns):
            axes.plot(x[:, k], z[:, k], color=color, linewidth=0.5)
    axes.set_xticks([0, columns - 1], ["toe", "heel"])
    axes.set_yticks([0, rows - 1], ["root", "tip"])
    axes.set_title(f"{before.flank} flank{', zero at the reference point' if zeroed else ''}", fontsize=10)
    axes.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.06), ncol=2, frameon=False)
    axes.spines[:].set_visible(False)


def draw_pitch(axes: Axes, before: Sequence[Pitch], after: Sequence[Pitch] = ()) -> None:
    """Cumulative pitch deviation of both flanks over the teeth, in µm."""
    for pitches, color, label in ((before, BEFORE, "before"), (after, AFTER, "after")):
        for pitch, style in zip(pitches, ("-", "--"), strict=False):
            text = f"{label}, {pitch.flank}: F_p {_or_withheld(pitch.total)}"
            axes.plot(pitch.cumulative * 1000, style, color=color, linewidth=1.2, marker=".", markersize=3, label=text)
    axes.axhline(0, color="#bbbbbb", linewidth=0.6)
    axes.set_xlabel("tooth")
    axes.set_ylabel("cumulative pitch deviation / µm")
    axes.legend(fontsize=7, frameon=False)


def member_figure(
    title: str,
    before: Mapping[str, Topography],
    after: Mapping[str, Topography],
    pitch_before: Sequence[Pitch] = (),
    pitch_after: Sequence[Pitch] = (),
) -> Figure:
    """Both flanks of a member before and after, and its pitch, in one picture."""
    figure = Figure(figsize=(12, 4), layout="constrained")
    figure.suptitle(title)
    for place, flank in zip(figure.subplots(1, 3 if pitch_before else 2), [*before, None], strict=False):
        if flank is not None:
            draw_topography(place, before[flank], after.get(flank))
        else:
            draw_pitch(place, pitch_before, pitch_after)
    return figure


def uncertainty_figure(title: str, found: Sequence[Uncertain]) -> Figure:
    """Single pitch of both flanks and the figures in µm beside it, each with its interval of 95 %."""
    figure = Figure(figsize=(12, 4), layout="constrained")
    figure.suptitle(title)
    left, right = figure.subplots(1, 2)
    for flank, color in zip(dict.fromkeys(one.figure.flank for one in found), (BEFORE, AFTER), strict=False):
        here = [one for one in found if one.figure.flank == flank and one.figure.unit == "um"]
        pitch = [one for one in here if one.figure.name.startswith("f_pt_")]
        rest = [one for one in here if one not in pitch]
        for axes, some in ((left, pitch), (right, rest)):
            value = np.array([one.value for one in some]) * 1000
            ends = np.array([one.interval for one in some]).reshape(-1, 2).T * 1000
            spread = np.abs(ends - value)
            axes.errorbar(range(len(some)), value, spread, fmt=".", color=color, capsize=3, label=flank)
        right.set_xticks(range(len(rest)), [one.figure.name for one in rest], rotation=30, fontsize=8)
    left.set_xlabel("tooth")
    left.set_ylabel("single pitch deviation / µm")
    right.set_ylabel("µm, with its interval of 95 %")
    for axes in (left, right):
        axes.axhline(0, color="#bbbbbb", linewidth=0.6)
        axes.legend(fontsize=8, frameon=False)
    return figure


def _or_withheld(value: float) -> str:
    """A maximum [mm] in µm, or that it is withheld: there is none over data with a gap."""
    return "withheld" if np.isnan(value) else f"{value * 1000:.1f} µm"


def draw_runout(axes: Axes, before: Runout, after: Runout | None = None) -> None:
    """Movement of a ball in every space, normal to the pitch cone, in µm, and the first harmonic through it, dashed."""
    for runout, color, label in ((before, BEFORE, "before"), (after, AFTER, "after")):
        if runout is None:
            continue
        size, direction = runout.eccentricity
        wave = float(np.nanmean(runout.shift)) + size * np.cos(runout.azimuth - direction)
        text = f"{label}: F_r {_or_withheld(runout.total)}"
        axes.plot(runout.shift * 1000, color=color, linewidth=1.2, marker=".", markersize=3, label=text)
        text = f"first harmonic {size * 1000:.1f} µm towards {np.degrees(direction):.0f}°"
        axes.plot(wave * 1000, "--", color=color, linewidth=0.8, label=text)
    axes.set_xlabel("space")
    axes.set_ylabel("ball, normal to the pitch cone / µm")
    axes.legend(fontsize=7, frameon=False)


def evaluation_figure(title: str, evaluation: Evaluation) -> Figure:
    """A measured member: flanks as measured and as registered, pitch polygons, runout; what the clamping was."""
    figure = Figure(figsize=(12, 8 if evaluation.runout_as_measured else 4), layout="constrained")
    figure.suptitle(title + _seat_words(evaluation.registration))
    registered = evaluation.registration is not None
    before, after = evaluation.as_measured, evaluation.flanks if registered else {}
    pitches = [[f.pitch for f in each.values() if f.pitch is not None] for each in (before, after)]
    drawn: list[Callable[[Axes], None]] = [
        partial(draw_topography, before=figures.chart, after=after[flank].chart if registered else None, zeroed=True)
        for flank, figures in before.items()
        if figures.chart is not None
    ]
    if pitches[0]:
        drawn.append(partial(draw_pitch, before=pitches[0], after=pitches[1]))
    if evaluation.runout_as_measured:
        after_runout = evaluation.runout if registered else None
        drawn.append(partial(draw_runout, before=evaluation.runout_as_measured, after=after_runout))
    rows = 2 if len(drawn) > 3 else 1
    places = figure.subplots(rows, -(-len(drawn) // rows), squeeze=False).ravel()
    for place, draw in zip(places, drawn, strict=False):
        draw(place)
    return figure


def _seat_words(seat: Registration | None) -> str:
    if seat is None:
        return ""
    tilt = f", tilt {seat.tilt * 1e5:.1f} µm/100 mm" if seat.tilt_found else ""
    return f"\nbefore and after registration: eccentricity {seat.eccentricity * 1000:.1f} µm{tilt} taken out"


def draw_gearbox_error(axes: Axes, seconds: np.ndarray, exact: np.ndarray, floating: np.ndarray) -> None:
    """Largest error of the exact and of the floating rule [steps] in every stretch of time up to ``seconds``, (n,)."""
    axes.plot(seconds, floating, color=BEFORE, linewidth=1.2, label=f"float32 rule: worst {floating.max():.4g} steps")
    axes.plot(seconds, exact, color=AFTER, linewidth=1.2, label=f"exact rule: worst {exact.max():.4g} steps")
    axes.axhline(0.5, color="#bbbbbb", linewidth=0.8, linestyle="--", label="half a step")
    if floating.max() > 20:
        axes.set_yscale("symlog", linthresh=1.0)
        axes.yaxis.set_major_formatter("{x:g}")
    axes.set_ylim(0)
    axes.set_xlabel("time / s")
    axes.set_ylabel("error / motor steps")
    axes.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.15), ncol=3, frameon=False)


def png(figure: Figure) -> bytes:
    """A figure as PNG, the same bytes for the same figure."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=130, metadata={"Software": None})
    return stream.getvalue()


def save(figure: Figure, path: Path) -> None:
    """Write a figure as PNG in one step."""
    write_bytes(path, png(figure))

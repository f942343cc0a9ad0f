"""One flank as gear charts show it: the nominal grid as a plane net, and on it the deviations and their numbers."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes

from gearmath.plot.style import BEFORE, INK, LESS, MORE, NOMINAL, round_length, signed
from gearmath.quality.evaluation.topography import Topography

#: The net is drawn aslant: each row begins so many columns farther right than the one below it.
_SLANT = 0.22
#: The largest deviation is as high as this part of the distance of two rows; less than so many µm are not enlarged.
_REACH, _LEAST_UM = 0.85, 1.0
#: More numbers than this side by side cannot be read.
_MOST_NUMBERS = 9


def reference_of(topography: Topography) -> tuple[int, int]:
    """Row and column of the reference point, the origin of the local system."""
    at = int(np.argmin(topography.along**2 + topography.upward**2))
    row, column = np.unravel_index(at, topography.along.shape)
    return int(row), int(column)


def um_per_row(topographies: Iterable[Topography]) -> float:
    """The scale that suits all of these flanks: how many µm are as high as the distance of two rows."""
    largest = [float(np.nanmax(np.abs(each.deviation))) * 1000 for each in topographies]
    return max([_LEAST_UM, *largest]) / _REACH


def draw_topography(
    axes: Axes,
    shown: Topography,
    earlier: Topography | None = None,
    scale: float | None = None,
    taken: float | None = None,
) -> None:
    """One flank and its numbers; dashed below it the same flank ``earlier``, without numbers.

    Columns run from toe (left) to heel, rows from root (below) to tip; up is metal left on. ``scale`` is that of
    :func:`um_per_row`, by default the one that suits what is drawn. ``taken`` [mm] is what was taken off at the
    reference point to make it zero, None where the flank is shown as it is.
    """
    drawn = [shown] if earlier is None else [shown, earlier]
    scale = um_per_row(drawn) if scale is None else scale
    rows, columns = shown.deviation.shape
    y, x = np.meshgrid(np.arange(rows, dtype=float), np.arange(columns, dtype=float), indexing="ij")
    x = x + _SLANT * y
    _net(axes, x, y, color=NOMINAL, linewidth=0.6, label="nominal")
    if earlier is not None:
        z = y + earlier.deviation * 1000 / scale
        _net(axes, x, z, color=BEFORE, linewidth=0.7, linestyle="--", label="before")
    values = shown.deviation * 1000
    _net(axes, x, y + values / scale, color=INK, linewidth=1.0, label="measured" if earlier is None else "after")
    _sticks(axes, x, y, values, scale)
    _numbers(axes, x, y, values)
    row, column = reference_of(shown)
    axes.plot(x[row, column], y[row, column], "o", markersize=5, markerfacecolor="none", color=INK, gid="reference")
    _edges(axes, x, y)
    _scale_bar(axes, x, scale)
    zero = "not zeroed" if taken is None else f"zero at the ring, {signed(taken * 1000)} µm taken off there"
    count = f"; {shown.left_out} of {values.size} points left out (×)" if shown.left_out else ""
    whose = "" if earlier is None else "numbers: after; "
    axes.set_xlabel(f"{whose}{zero}{count}", fontsize=8, wrap=True)
    axes.set_xlim(-0.65, x.max() + 0.65)
    axes.set_ylim(-1.4, rows - 1 + 1.2)
    axes.set_xticks([])
    axes.set_yticks([])
    axes.spines[:].set_visible(False)


def _net(axes: Axes, x: np.ndarray, y: np.ndarray, label: str, **style: object) -> None:
    for k, (line_x, line_y) in enumerate([*zip(x, y, strict=True), *zip(x.T, y.T, strict=True)]):
        axes.plot(line_x, line_y, label=label if k == 0 else None, **style)  # type: ignore[arg-type]


def _sticks(axes: Axes, x: np.ndarray, y: np.ndarray, values: np.ndarray, scale: float) -> None:
    """The deviation of every point, from its place on the net."""
    for more, color in ((True, MORE), (False, LESS)):
        here = (values > 0) == more
        here &= np.isfinite(values)
        axes.vlines(x[here], y[here], (y + values / scale)[here], color=color, linewidth=2.2, zorder=3)


def _numbers(axes: Axes, x: np.ndarray, y: np.ndarray, values: np.ndarray) -> None:
    """Numbers at the points: below where the deviation goes up, else above."""
    rows, columns = values.shape
    step = -(-columns // _MOST_NUMBERS)
    for row in range(rows):
        for column in range(0, columns, step):
            value = values[row, column]
            text = signed(value) if np.isfinite(value) else "×"
            below = not text.startswith("\N{MINUS SIGN}")
            number = axes.annotate(
                text,
                (x[row, column], y[row, column]),
                (0, -2.5 if below else 2.5),
                textcoords="offset points",
                ha="center",
                va="top" if below else "bottom",
                fontsize=8,
                zorder=5,
                gid=f"node {row},{column}",
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.4, "alpha": 0.75},
            )
            number.set_in_layout(False)  # well within the axes; asking every number takes most of the time
    if step > 1:
        axes.set_title(f"numbers at one column in {step}", fontsize=8)


def _edges(axes: Axes, x: np.ndarray, y: np.ndarray) -> None:
    middle = x.shape[1] // 2
    for text, at, ha, va in (
        ("root", (x[0, middle], y[0, 0] - 0.85), "center", "top"),
        ("tip", (x[-1, middle], y[-1, 0] + 0.75), "center", "bottom"),
        ("toe", (x[0, 0] - 0.4, y[0, 0] - 0.85), "left", "top"),
        ("heel", (x[0, -1] - 0.2, y[0, 0] - 0.85), "right", "top"),
    ):
        axes.text(*at, text, ha=ha, va=va, fontsize=8, style="italic")


def _scale_bar(axes: Axes, x: np.ndarray, scale: float) -> None:
    """A bar in the lower right corner, beside the heel of the root."""
    length, at = round_length(scale), x[0, -1] + 0.85
    axes.plot([at, at], [-0.6, -0.6 + length / scale], color=INK, linewidth=1.4, marker="_", gid="scale bar")
    axes.text(at, -0.85, f"{length:g} µm", fontsize=8, ha="center", va="top")

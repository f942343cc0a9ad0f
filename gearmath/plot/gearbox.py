"""The error of the electronic gearbox over time."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from gearmath.plot.style import AFTER, BEFORE


def draw_gearbox_error(axes: Axes, seconds: np.ndarray, exact: np.ndarray, floating: np.ndarray) -> None:
    """Largest error of the exact and of the floating rule [steps] in every stretch of time up to ``seconds``, (n,)."""
    axes.plot(
        seconds, floating, color=BEFORE, linewidth=1.2, label=f"float32 rule: at most {floating.max():.4g} motor steps"
    )
    axes.plot(seconds, exact, color=AFTER, linewidth=1.2, label=f"exact rule: at most {exact.max():.4g} motor steps")
    axes.axhline(0.5, color="#bbbbbb", linewidth=0.8, linestyle="--", label="half a step")
    if floating.max() > 20:
        axes.set_yscale("symlog", linthresh=1.0)
        axes.yaxis.set_major_formatter("{x:g}")
    axes.set_ylim(0, 1.15 * max(0.5, floating.max(), exact.max()))
    axes.set_xlabel("time / s")
    axes.set_ylabel("error / motor steps")
    axes.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.15), ncol=3, frameon=False, columnspacing=6)

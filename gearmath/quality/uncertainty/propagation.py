"""How sure the figures of a measured member are: the law of propagation where they are smooth, draws where not.

A smooth figure y has the standard uncertainty √(J V J') and the interval y ± k u, and draws confirm it. A maximum or a
range is the largest of differences, linear forms l·δ. Noise makes it too large, and the more so the more forms compete,
so that quantiles of draws about the measured deviations miss the truth Y. What holds for every gear, with errors e,

    y - Y <= max l·e     over the forms l that can be the largest
    Y - y <= -l·e        at the one form l that is the largest in truth

gives the lower end of the interval by draws of the first, and the upper end by the law of propagation for the second.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from gearmath.quality.uncertainty.covariance import Covariance, coverage_factor
from gearmath.quality.uncertainty.figures import Extreme, Figure, Figures
from gearmath.quality.uncertainty.study import monte_carlo, run
from gearmath.shown import Shown, Shows

#: Coverage probability of the intervals.
PROBABILITY = 0.95
#: Two forms are certain to be in the order in which they were measured when they differ by so many of the standard
#: uncertainties of their difference: once for what the truth may be, and once for what the next measurement may say.
_CERTAIN = 9.0


@dataclass(frozen=True, repr=False)
class Uncertain(Shown):
    """A figure with its value, standard uncertainty and interval of 95 % [mm, rad ...]; ``drawn`` is u by Monte Carlo.

    ``drawn`` is None where nothing was drawn.
    """

    figure: Figure
    value: float
    uncertainty: float
    interval: tuple[float, float]
    drawn: float | None

    @property
    def method(self) -> str:
        return "GUM" if self.figure.smooth else "Monte Carlo"

    def as_dict(self) -> dict[str, Any]:
        """In plain numbers by name, in the unit of the figure."""
        factor = self.figure.factor
        return {
            "flank": self.figure.flank,
            "figure": self.figure.name,
            "value": self.value * factor,
            "u": self.uncertainty * factor,
            "from": self.interval[0] * factor,
            "to": self.interval[1] * factor,
            "u_monte_carlo": None if self.drawn is None else self.drawn * factor,
            "unit": self.figure.unit,
            "method": self.method,
        }

    def _shown(self) -> tuple[str, list[Shows]]:
        figure = self.figure
        figures: list[Shows] = [("value", self.value * figure.factor, figure.unit)]
        figures += [("u", self.uncertainty * figure.factor, figure.unit), ("by", self.method, "")]
        return f"{figure.flank}, {figure.name}", figures


def contenders(extreme: Extreme, judged: np.ndarray, covariance: Covariance) -> tuple[np.ndarray, float]:
    """Which of the differences (p,) can be the largest in truth, or could have been when measured; their largest u."""
    base = np.vstack([extreme.jacobian, np.zeros(len(covariance))])  # the last one is the 0 that is added
    shared = covariance.through(base)
    first, second, values = extreme.first, extreme.second, extreme.differences(judged)
    best = int(np.argmax(values))
    with_base = shared[first] - shared[second]
    each = np.arange(len(first))
    variance = with_base[each, first] - with_base[each, second]
    with_best = with_base[:, first[best]] - with_base[:, second[best]]
    apart = np.sqrt(np.maximum(variance - 2 * with_best + variance[best], 0.0))
    chosen = np.flatnonzero(values[best] - values <= _CERTAIN * apart)
    return chosen, float(np.sqrt(max(variance[chosen].max(), 0.0)))


def uncertain_figures(
    figures: Figures,
    covariance: Covariance,
    draws: int = 20_000,
    seed: int = 0,
    executor: Executor | None = None,
    workers: int | None = None,
    results: Path | None = None,
    progress: Callable[[int], object] = lambda _: None,
) -> list[Uncertain]:
    """Every figure with its uncertainty, from the covariance of the deviations that were measured.

    The draws are a study, see :func:`study.run`.
    """
    open_ = {j: contenders(extreme, figures.judged, covariance) for j, extreme in figures.extremes.items()}
    chosen = {j: index for j, (index, _) in open_.items()}
    study = monte_carlo(covariance.drawn(_with_excess(figures, chosen), figures.deviation), draws, seed)
    drawn = run(study, executor, workers, results, progress)
    m, k = len(figures.items), coverage_factor(PROBABILITY)
    excess = dict(zip(open_, np.quantile(drawn[:, m:], (1 + PROBABILITY) / 2, axis=0), strict=True))
    values, gum = figures.values, covariance.standard_uncertainty(figures.jacobian)
    spread = drawn[:, :m].std(axis=0, ddof=1)
    found = []
    for j, figure in enumerate(figures.items):
        value, u = float(values[j]), float(gum[j])
        interval = (value - k * u, value + k * u)
        if not figure.smooth:
            u = float(spread[j])
            interval = (max(0.0, value - float(excess[j])), value + k * open_[j][1])
        found.append(Uncertain(figure, value, u, interval, float(spread[j])))
    return found


def _with_excess(figures: Figures, chosen: dict[int, np.ndarray]) -> ca.Function:
    """The figures of deviations, and for each maximum the largest change of its contenders."""
    moved, at = ca.MX.sym("deviation", len(figures.deviation)), figures.judged
    judged = figures.judging(moved)
    excess = [
        ca.mmax(figures.extremes[j].graph(judged, index) - ca.DM(figures.extremes[j].differences(at)[index]))
        for j, index in chosen.items()
    ]
    return ca.Function("figures_and_excess", [moved], [ca.vertcat(figures.of_judged(judged), *excess)])

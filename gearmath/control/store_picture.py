"""A comparison of stored runs as a picture: two beside each other, or the course of the figures of more."""

from __future__ import annotations

from matplotlib.figure import Figure

from gearmath.control.store_compare import Comparison
from gearmath.plot.runs import comparison_figure, course_figure


def runs_figure(found: Comparison) -> Figure:
    """Flanks and pitch of two runs; of more, the course of their figures."""
    if len(found.runs) == 2:
        first, last = found.runs
        return comparison_figure(_title(found), first.found, last.found)
    return trend_figure(found)


def trend_figure(found: Comparison) -> Figure:
    """The course of every figure over the runs, with bars of 2 u."""
    courses: dict[str, dict[str, list[tuple[float | None, float | None]]]] = {}
    for row in found.figures:
        values = list(zip(row.sizes, row.uncertainties, strict=True))
        courses.setdefault(figure_title(row.name), {})[row.flank] = values
    return course_figure(_title(found), [each.run.id for each in found.runs], courses)


def _title(found: Comparison) -> str:
    return f"{found.runs[0].name}, runs {', '.join(str(each.run.id) for each in found.runs)}"


def figure_title(name: str) -> str:
    """What stands over the course of a figure."""
    return name.removesuffix("_um").replace("_", " ")

"""The course of figures over runs, read back from the axes that are drawn."""

from __future__ import annotations

import numpy as np

from gearmath.plot.runs import course_figure

COURSES = {
    "F p": {"concave": [(9.0, 1.0), (None, None), (3.0, 0.5)], "convex": [(8.0, 1.0), (7.0, 1.0), (2.0, 1.0)]},
    "F r": {"both": [(2.0, None), (3.0, None), (4.0, None)]},
}


def test_every_figure_is_drawn_with_its_values_and_bars_of_2_u() -> None:
    figure = course_figure("pinion", [3, 4, 7], COURSES)
    shown = [axes for axes in figure.axes if axes.axison]
    assert [axes.get_title() for axes in shown] == ["F p", "F r"]
    assert [label.get_text() for label in shown[0].get_xticklabels()] == ["3", "4", "7"]
    concave, convex = shown[0].containers
    np.testing.assert_array_equal(np.asarray(concave[0].get_ydata(), dtype=float), [9.0, np.nan, 3.0])
    np.testing.assert_array_equal(convex[0].get_ydata(), [8.0, 7.0, 2.0])
    ends = [segment[:, 1].tolist() for segment in convex[2][0].get_segments()]
    assert ends == [[6.0, 10.0], [5.0, 9.0], [0.0, 4.0]]

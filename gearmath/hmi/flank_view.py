"""The flanks of a tooth in space with their deviations, as a plotly figure, and flat where there is no WebGL.

A plotly figure is a plain dict here: the library that draws it is in the browser.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from gearmath.bevel.turning import turned
from gearmath.front.member import Member
from gearmath.plot.sheet import topography_chart
from gearmath.plot.style import LESS, MORE
from gearmath.plot.tooth import ToothFlank, enlargement, tooth_flanks
from gearmath.plot.topography import um_per_row
from gearmath.quality.evaluation.member import MemberEvaluation
from gearmath.quality.evaluation.topography import Topography, evaluate_topography

#: From missing to left on: the colors of the flat charts at the ends.
_SHADES = [[0.0, LESS], [0.5, "#dcdcdc"], [1.0, MORE]]
_LINES = "#7d7d7d"
#: Rows and columns of the flanks of settings: in space, and flat, where every point has its number.
_FINE, _PLAIN = (9, 17), (5, 9)
#: The tooth a little from above, with room for its tip above and for the words of the axes below.
_CAMERA = {"eye": {"x": 1.75, "y": 1.5, "z": 0.69}, "center": {"x": 0.0, "y": 0.0, "z": -0.12}}


@dataclass(frozen=True)
class FlankView:
    """Both flanks of a tooth: ``flanks`` in space with deviations [µm], ``forms`` the same flat [mm].

    ``times`` is how many times the deviations are enlarged along the normals.
    """

    flanks: Mapping[str, ToothFlank]
    forms: Mapping[str, Topography]
    times: float

    @property
    def largest_um(self) -> float:
        """Largest deviation in size [µm]."""
        return max(float(np.nanmax(np.abs(one.deviation))) for one in self.flanks.values())


def view_of_settings(member: Member) -> FlankView:
    """The flanks that the settings of a member cut, as deviations from the nominal ones."""
    fine, plain = (member.deviations(grid).file for grid in (_FINE, _PLAIN))
    names = [str(flank) for flank in dict.fromkeys(fine.flank)]
    flanks = tooth_flanks(fine, {name: evaluate_topography(fine, name) for name in names}, member.teeth)
    return FlankView(flanks, {name: evaluate_topography(plain, name) for name in names}, enlargement(flanks))


def view_of_run(found: MemberEvaluation, teeth: int) -> FlankView | None:
    """The flanks as measured: the mean of the teeth measured in full; None where there is none."""
    forms = {flank: one.mean for flank, one in found.flanks.items() if one.mean is not None}
    if not forms:
        return None
    flanks = tooth_flanks(found.file, forms, teeth)
    return FlankView(flanks, forms, enlargement(flanks))


def space_figure(view: FlankView, name: str, names: Mapping[str, str], dark: bool) -> dict[str, Any]:
    """The flanks in space for plotly: deviations as color and, enlarged, as height over the nominal net.

    ``name`` keeps the turned view of the operator while the figure is drawn anew; ``names`` are those of the flanks.
    """
    bound = max(1.0, view.largest_um)
    middle = np.mean([one.point.reshape(-1, 3).mean(axis=0) for one in view.flanks.values()], axis=0)
    # the tooth upright: its axis of symmetry along x
    azimuth = float(np.arctan2(middle[1], middle[0]))
    traces: list[dict[str, Any]] = []
    for flank, one in view.flanks.items():
        lifted = one.point + (np.nan_to_num(one.deviation) * view.times / 1000)[..., None] * one.normal
        x, y, z = (_numbers(part) for part in turned(lifted, -azimuth).reshape(-1, 3).T)
        i, j, k = _triangles(one.deviation).T.tolist()
        deviation = _numbers(one.deviation.ravel())
        traces.append(
            {
                # not a surface: of that plotly makes 128 rows and more, seconds where no graphics card draws them
                "type": "mesh3d",
                "name": names[flank],
                **{"x": x, "y": y, "z": z, "i": i, "j": j, "k": k},
                "intensity": deviation,
                "colorscale": _SHADES,
                **{"cmin": -bound, "cmax": bound, "showscale": not traces},
                "colorbar": {"ticksuffix": " µm", "thickness": 14, "len": 0.8},
                "customdata": deviation,
                "hovertemplate": f"{names[flank]}<br>%{{customdata:.1f}} µm<extra></extra>",
                "lighting": {"ambient": 0.75, "diffuse": 0.4, "specular": 0.05},
            }
        )
        traces.append(_net(turned(one.point, -azimuth)))
    text, ground = ("#e6ebee", "#1b2226") if dark else ("#14191c", "#ffffff")
    axis = {"color": text, "gridcolor": "#8a8a8a", "zeroline": False, "showbackground": False}
    scene = {f"{key}axis": {**axis, "title": {"text": f"{key} / mm"}} for key in "xyz"}
    return {
        "data": traces,
        "layout": {
            "uirevision": name,
            "paper_bgcolor": ground,
            "font": {"color": text},
            "margin": {"l": 0, "r": 0, "t": 0, "b": 0},
            "showlegend": False,
            "scene": {**scene, "aspectmode": "data", "camera": _CAMERA},
        },
        "config": {"displaylogo": False, "responsive": True, "scrollZoom": True},
    }


def flat_figures(view: FlankView) -> dict[str, Figure]:
    """The same flanks as the plane net of a chart, one for each flank, at one scale."""
    scale = um_per_row(view.forms.values())
    return {flank: topography_chart(form, scale, None) for flank, form in view.forms.items()}


def _triangles(deviation: np.ndarray) -> np.ndarray:
    """Two triangles in each mesh of a grid (rows, columns), by numbers of points; none at a point that is missing."""
    number = np.arange(deviation.size).reshape(deviation.shape)
    low, right, left, far = number[:-1, :-1], number[:-1, 1:], number[1:, :-1], number[1:, 1:]
    corners = np.stack([[low, right, far], [low, far, left]], axis=-1).reshape(3, -1, 2)
    found = corners.transpose(1, 2, 0).reshape(-1, 3)
    return found[np.isfinite(deviation.ravel()[found]).all(axis=1)]


def _net(point: np.ndarray) -> dict[str, Any]:
    """The lines of a grid (rows, columns, 3), one after the other with gaps between them."""
    gap = np.full((1, 3), np.nan)
    lines = np.concatenate([np.concatenate([line, gap]) for line in (*point, *point.swapaxes(0, 1))])
    x, y, z = (_numbers(part) for part in lines.T)
    line = {"color": _LINES, "width": 2}
    return {"type": "scatter3d", "mode": "lines", "x": x, "y": y, "z": z, "line": line, "hoverinfo": "skip"}


def _numbers(values: np.ndarray) -> list[Any]:
    """Nested lists, None where there is no number: JSON has none."""
    return np.where(np.isfinite(values), np.round(values, 5), None).tolist()  # type: ignore[call-overload, no-any-return]

"""A tooth in perspective, from either side: the part of its flanks that was measured, with the deviations on it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap

from gearmath.bevel.turning import turned
from gearmath.plot.style import INK, NOMINAL, round_length, signed
from gearmath.quality.evaluation.topography import Topography
from gearmath.specs.flank_csv import FlankFile

#: Darker from missing to left on, so that a print without color shows the sign as well.
_SHADES = LinearSegmentedColormap.from_list("deviation", ["#dceef6", "#a9cdda", "#b0a8a0", "#b96a4e", "#6e1a0e"])
#: The eye, in widths of the face: along the tooth, above it, and away from the flank.
_EYE = np.array([-0.9, 1.7, 3.8])
#: The largest deviation is drawn as large as this part of the face.
_REACH = 0.1


_Projection = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class ToothFlank:
    """One flank on a grid: nominal points and outward normals (rows, columns, 3) [mm], deviations [µm]."""

    point: np.ndarray
    normal: np.ndarray
    deviation: np.ndarray


def tooth_flanks(file: FlankFile, shown: Mapping[str, Topography], teeth: int) -> dict[str, ToothFlank]:
    """The flanks that bound one tooth, of the grid of the tooth space that each topography began with."""
    found = {}
    for flank, topography in shown.items():
        points = file.select(flank)
        counts = np.bincount(points.tooth)
        points = points.pick(points.tooth == int(np.argmax(counts)))
        points = points.pick(np.lexsort((points.col, points.row)))
        nominal = points.point - np.nan_to_num(points.deviation)[:, None] * points.normal
        back = -2 * np.pi * points.tooth[0] / teeth
        shape = (*topography.deviation.shape, 3)
        place, normal = turned(nominal, back).reshape(shape), turned(points.normal, back).reshape(shape)
        found[flank] = ToothFlank(place, normal, topography.deviation * 1000)
    if len(found) == 2:
        first, second = found
        ahead = _azimuth(found[first]) - _azimuth(found[second])
        turn = np.sign((ahead + np.pi) % (2 * np.pi) - np.pi) * 2 * np.pi / teeth
        last = found[second]
        found[second] = ToothFlank(turned(last.point, turn), turned(last.normal, turn), last.deviation)
    return found


def enlargement(flanks: Mapping[str, ToothFlank]) -> float:
    """How many times deviations are enlarged: 1, 2 or 5 times a power of ten."""
    largest = max([1.0, *(float(np.nanmax(np.abs(one.deviation))) for one in flanks.values())]) / 1000
    return round_length(_REACH * max(_face(one) for one in flanks.values()) / largest)


def draw_tooth(axes: Axes, flanks: Mapping[str, ToothFlank], seen: str, times: float) -> None:
    """The tooth from the side of the flank ``seen``, its deviations enlarged so many ``times`` along the normals."""
    front = flanks[seen]
    project = _camera(front)
    for other in flanks.values():
        if other is not front:
            _body(axes, front, other, project)
    nominal = project(front.point)
    _faces(axes, nominal, facecolor="#f2f2f2", edgecolor=NOMINAL, linewidth=0.5, zorder=2)
    lifted = project(front.point + (front.deviation * times / 1000)[..., None] * front.normal)
    bound = max([1.0, *(float(np.nanmax(np.abs(one.deviation))) for one in flanks.values())])
    corners = _corners(front.deviation).mean(axis=1)
    shade = _SHADES(0.5 + corners / (2 * bound))
    known = np.isfinite(corners)
    axes.add_collection(
        PolyCollection(
            _corners(lifted)[known], facecolors=shade[known], edgecolors=INK, linewidths=0.7, alpha=0.85, zorder=4
        )
    )
    sticks = np.stack([nominal, lifted]).reshape(2, -1, 2)
    axes.plot(*np.moveaxis(sticks, -1, 0), color=INK, linewidth=0.6, zorder=3)
    _words(axes, nominal, lifted, front.deviation)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.autoscale_view()
    axes.margins(0.06)


def _words(axes: Axes, nominal: np.ndarray, lifted: np.ndarray, deviation: np.ndarray) -> None:
    """The names of the edges, and the deviations of the corners [µm]."""
    rows, columns = deviation.shape
    row, column = rows // 2, columns // 2
    out = 0.07 * float(np.linalg.norm(nominal[row, -1] - nominal[row, 0]))
    for text, edge, inner, far in (
        ("tip", nominal[-1, column], nominal[0, column], 0.8),
        ("root", nominal[0, column], nominal[-1, column], 1.0),
        ("toe", nominal[row, 0], nominal[row, -1], 1.3),
        ("heel", nominal[row, -1], nominal[row, 0], 1.3),
    ):
        way = (edge - inner) / np.linalg.norm(edge - inner)
        x, y = edge + far * out * way
        axes.text(x, y, text, fontsize=8, style="italic", ha="center", va="center", zorder=6)
    box = {"facecolor": "white", "edgecolor": "none", "pad": 0.4, "alpha": 0.8}
    for row in (0, -1):
        for column in (0, -1):
            if np.isfinite(deviation[row, column]):
                axes.annotate(
                    signed(deviation[row, column]),
                    lifted[row, column],
                    (0, 4 if row else -4),
                    zorder=7,
                    bbox=box,
                    textcoords="offset points",
                    fontsize=8,
                    ha="center",
                    va="bottom" if row else "top",
                )


def _face(one: ToothFlank) -> float:
    return float(np.linalg.norm(one.point[0, -1] - one.point[0, 0]))


def _azimuth(one: ToothFlank) -> float:
    x, y, _ = one.point.reshape(-1, 3).mean(axis=0)
    return float(np.arctan2(y, x))


def _camera(front: ToothFlank) -> _Projection:
    """Central projection (..., 3) -> (..., 2) [mm] from an eye beside the flank, above its tip."""
    rows, columns = front.deviation.shape
    center = front.point.reshape(-1, 3).mean(axis=0)
    out = front.normal[rows // 2, columns // 2]
    along = front.point[rows // 2, -1] - front.point[rows // 2, 0]
    along -= out * (along @ out)
    along /= np.linalg.norm(along)
    up = front.point[-1, columns // 2] - front.point[0, columns // 2]
    up -= out * (up @ out) + along * (up @ along)
    up /= np.linalg.norm(up)
    eye = _face(front) * (_EYE @ np.stack([along, up, out]))
    distance = float(np.linalg.norm(eye))
    back = eye / distance
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    screen = np.stack([right, np.cross(back, right)], axis=1)

    def project(points: np.ndarray) -> np.ndarray:
        away = points - center
        depth = distance - away @ back
        return (away @ screen) * (distance / depth)[..., None]

    return project


def _body(axes: Axes, front: ToothFlank, other: ToothFlank, project: _Projection) -> None:
    """Top land and ends of the tooth between the two flanks, behind the flank that is seen."""
    land = np.stack([project(front.point[-1]), project(other.point[-1])])
    ends = [np.stack([project(front.point[:, k]), project(other.point[:, k])]) for k in (0, -1)]
    for strip, color in ((ends[0], "#dcdcdc"), (ends[1], "#dcdcdc"), (land, "#e9e9e9")):
        outline = np.concatenate([strip[0], strip[1][::-1]])
        axes.add_collection(PolyCollection([outline], facecolors=color, edgecolors="#777777", linewidths=0.6, zorder=1))


def _faces(axes: Axes, places: np.ndarray, **style: object) -> None:
    axes.add_collection(PolyCollection(_corners(places), **style))  # type: ignore[arg-type]


def _corners(grid: np.ndarray) -> np.ndarray:
    """The four corners (n, 4, ...) of every mesh of a grid (rows, columns, ...)."""
    corners = np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], axis=2)
    return corners.reshape(-1, *corners.shape[2:])

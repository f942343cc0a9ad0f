"""The metal of a whole member out of a flank file: what every tooth has beyond its nominal flanks, at any place."""

from __future__ import annotations

from functools import cache

import casadi as ca
import numpy as np

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import Member
from gearmath.specs.flank_csv import FlankFile

#: omega_z of the rigid motion (18.2).
_TURN = 5
_NEWTON_STEPS = 6
_CUBIC = 3


class MilledSurface:
    """Deviation [mm] of a flank of a tooth from its nominal surface, at places (z_w, r_w) of the work.

    Between the points of a grid it is interpolated by cubic splines, and beyond the grid taken as on its edge. A tooth
    that the file has in full has its own grid. Any other one has the form of the nearest tooth in full, turned about
    the work axis until the reference point comes out; what its other points say beyond that is added as the smallest
    surface of second degree through them. ``name`` is that of the file in messages.
    """

    def __init__(self, file: FlankFile, member: Member, name: str) -> None:
        self._member, self._name, self._teeth = member, name, member.teeth
        known = np.isfinite(file.deviation) & (file.tooth < member.teeth)
        self._file = file.pick(known)
        self._shape = _pair(file.header["grid"], "x")
        self._reference = _pair(file.header["reference_point"], ",")
        self._margin = float(file.header["margins"].split(",")[0])
        self._grid = blank_grid(member, *self._shape, self._margin)
        self._surfaces: dict[tuple[str, int], ca.Function] = {}
        self._rates: dict[str, np.ndarray] = {}

    @property
    def lowest(self) -> float:
        """The deviation of all points that is lowest [mm]."""
        return float(self._file.deviation.min(initial=0.0))

    def __call__(self, flank: str, tooth: int, place: np.ndarray) -> float:
        """Raises InputError where the file has no point of this flank of this tooth."""
        if (flank, tooth) not in self._surfaces:
            self._surfaces[flank, tooth] = self._spline(self._values(flank, tooth))
        share = np.array(_share_of_blank()(self._member.blank.vector, place)).ravel()
        last = np.array(self._shape) - 1
        at = np.clip((share - self._margin) / (1 - 2 * self._margin) * last, 0.0, last)
        return float(self._surfaces[flank, tooth](at))

    def _values(self, flank: str, tooth: int) -> np.ndarray:
        """Deviations (rows, columns) of one flank of one tooth."""
        own = self._file.select(flank, tooth)
        if not len(own):
            raise InputError(f"{self._name}: holds no deviation on the {flank} flank of tooth {tooth}")
        if len(own) == self._grid.axial.size:
            return self._table(own)
        form = self._form(flank, tooth)
        rest = own.deviation - form[own.row, own.col]
        rate = self._rate(flank)
        there = np.flatnonzero((own.row == self._reference[0]) & (own.col == self._reference[1]))
        if len(there):
            turn = rest[there[0]] / rate[self._reference]
            form = form + turn * rate
            rest = rest - turn * rate[own.row, own.col]
        every = self._monomials()
        least, *_ = np.linalg.lstsq(every[own.row, own.col], rest, rcond=None)
        return form + every @ least

    def _form(self, flank: str, tooth: int) -> np.ndarray:
        """The grid of the nearest tooth in full, zero where there is none."""
        points = self._file.select(flank)
        teeth, counts = np.unique(points.tooth, return_counts=True)
        full = teeth[counts == self._grid.axial.size]
        if not len(full):
            return np.zeros(self._shape)
        away = np.abs(full - tooth)
        nearest = full[np.argmin(np.minimum(away, self._teeth - away))]
        return self._table(points.pick(points.tooth == nearest))

    def _table(self, points: FlankFile) -> np.ndarray:
        values = np.empty(self._shape)
        values[points.row, points.col] = points.deviation
        return values

    def _rate(self, flank: str) -> np.ndarray:
        """How fast the grid (rows, columns) of a flank rises along its normals as the tooth is turned [mm/rad]."""
        if flank not in self._rates:
            points = solve_flank(self._member, flank, self._grid)
            (rates,) = kernel("motion_sensitivity")(points.point, points.normal)
            self._rates[flank] = rates[:, _TURN].reshape(self._shape)
        return self._rates[flank]

    def _monomials(self) -> np.ndarray:
        """Monomials of second degree (rows, columns, 6) of the way from the reference point, in parts of the grid."""
        row, col = np.indices(self._shape)
        u, v = (row - self._reference[0]) / self._shape[0], (col - self._reference[1]) / self._shape[1]
        return np.stack([np.ones(self._shape), u, v, u * v, u**2, v**2], axis=-1)

    def _spline(self, values: np.ndarray) -> ca.Function:
        lines = [np.arange(float(count)) for count in self._shape]
        degree = [min(_CUBIC, count - 1) for count in self._shape]
        return ca.interpolant("deviation", "bspline", lines, values.ravel(order="F"), {"degree": degree})


@cache
def _share_of_blank() -> ca.Function:
    """Shares of working depth and face width (2,) of a place (z_w, r_w) (2,): ``flank_place`` inverted by Newton."""
    blank, place = (ca.SX.sym(name, size) for name, size in (("blank", _blank_size()), ("place", 2)))
    share = ca.SX.sym("share", 2)
    off = ca.vertcat(*kernel("flank_place").function(blank, share[1], share[0])) - place
    step = ca.Function("step", [share, blank, place], [share - ca.solve(ca.jacobian(off, share), off)])
    found = ca.SX([0.5, 0.5])
    for _ in range(_NEWTON_STEPS):
        found = step(found, blank, place)
    return ca.Function("share_of_blank", [blank, place], [found])


def _blank_size() -> int:
    return kernel("flank_place").inputs[0].size


def _pair(text: str, mark: str) -> tuple[int, int]:
    first, second = (int(part) for part in text.split(mark))
    return first, second

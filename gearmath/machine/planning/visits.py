"""How far the cradle may roll in one turn of the work, so that of two visits of a blade one always comes near enough.

In face hobbing every point of a flank is visited once in a turn of the work, and the blade that visits it is farther
off the more the cradle has still to roll, or has rolled on, since it stood where the point is generated. How far it is
off is asked of its whole edge: where a flank ends and the rounding of the blade begins, the main section comes near on
one side only, and half of the parabola (17.4) is not there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearmath.bevel.tooth import SHARP_EDGE
from gearmath.kernels import kernel
from gearmath.machine.bodies.blades import Edge, blades_of, crossing
from gearmath.machine.planning.path import below_the_flank, six_axes, whole_flank
from gearmath.specs.bevel_set import FLANKS, Flank, Member

#: The blade is followed in so many steps away from its contact, and the one that goes too far is halved so often.
_STEPS, _HALVED = 16, 6
#: For the parabola it is followed this far before and behind. [rad]
_BESIDE = 2e-3
#: What is met within this angle of the cutter is what a blade cuts in one visit. [rad]
_VISIT = 0.2
#: Places across the face where a section of a blade ends.
_ACROSS = 13
#: A crossing may lie off the end of its edge by this [mm or rad], and leaves no more than this to the line. [mm]
_SLACK, _RESIDUAL = 1e-7, 1e-7


def roll_in_a_turn(member: Member, index_ratio: float, sense: int, scallop: float) -> float:
    """The farthest [rad] that the cradle may roll in a turn of the work, for flanks that keep ``scallop`` [mm] at most.

    ``index_ratio`` is the turn of the work for one of the cutter, ``sense`` that of the cutter about its axis.
    """
    steps = []
    for flank in FLANKS:
        roll, turned = Approach.of(member, flank, index_ratio).within(scallop)
        # the blade meets a place earlier or later in the turn, the farther the cradle has rolled
        steps.append(roll / (1.0 + sense * abs(index_ratio) * turned / (2 * math.pi)))
    return float(np.concatenate(steps).min())


@dataclass(frozen=True)
class Approach:
    """How a blade comes near places of one flank: all over it, and at the lower ends of the parts that cut it.

    The places are points with normals (n,3), and u, β, θ (n,3) of the ``part`` (n,) of the blade that makes them.
    """

    spec: Flank
    edges: tuple[Edge, ...]
    index_ratio: float
    part: np.ndarray
    contact: np.ndarray
    point: np.ndarray
    normal: np.ndarray

    @staticmethod
    def of(member: Member, flank: str, index_ratio: float) -> Approach:
        """The approach to a flank as it is cut; blades that state no edge radius are taken as sharp."""
        edges = tuple(edge for edge in blades_of(member, SHARP_EDGE).edges if edge.flank == flank)
        main = next(edge for edge in edges if edge.part == "main")
        whole = whole_flank(member, flank)
        on = (main.lower <= whole.contact[:, 0]) & (whole.contact[:, 0] <= main.upper)
        found = [(np.full(int(on.sum()), "main", object), whole.contact[on], whole.point[on], whole.normal[on])]
        for part, row, _ in below_the_flank(member, flank, np.linspace(0.0, 1.0, _ACROSS)):
            if part != "edge":
                there, count = row.converged, int(row.converged.sum())
                found.append((np.full(count, part, object), row.contact[there], row.point[there], row.normal[there]))
        places = (np.concatenate(values) for values in zip(*found, strict=True))
        return Approach(member.flank(flank), edges, index_ratio, *places)

    def within(self, scallop: float) -> tuple[np.ndarray, np.ndarray]:
        """By how much (n,) [rad] the cradle rolls while the blade comes within ``scallop`` [mm] of places, and by how
        much the angle of the cutter at which it meets them grows.

        To either side it is followed no farther than the parabola of the worst place is wide.
        """
        (widths,) = kernel("roll_per_turn")(scallop, self.curvature())
        farthest, count = float(np.nanmin(widths)), len(self.part)
        roll, turned = np.zeros(count), np.zeros(count)
        for way in (-farthest, farthest):
            last, over = np.zeros(count), np.zeros(count, dtype=bool)
            for share in np.linspace(0.0, 1.0, _STEPS + 1)[1:]:
                over |= self.met(np.full(count, share * way))[0] > scallop
                last = np.where(over, last, share)
            part = np.where(over, 1.0 / _STEPS, 0.0)
            for _ in range(_HALVED):
                part = part / 2
                last = np.where(self.met((last + part) * way)[0] <= scallop, last + part, last)
            roll += last * farthest
            turned += math.copysign(1.0, way) * self.met(last * way)[1]
        return roll, turned

    def met(self, roll: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """How far (n,) [mm] the blade stays off places that it visits ``roll`` (n,) [rad] from their contacts, and the
        angle (n,) of the cutter at which it meets the normal there; infinite and 0 where no part of it does.
        """
        off, angle = np.full(len(roll), np.inf), np.zeros(len(roll))
        for edge in self.edges:
            u, beta, distance, rest = self._crossing(edge, roll)
            on = (rest < _RESIDUAL) & (u > edge.lower - _SLACK) & (u < edge.upper + _SLACK) & (distance < off)
            off, angle = np.where(on, distance, off), np.where(on, beta, angle)
        return off, angle

    def curvature(self) -> np.ndarray:
        """c (n,) [mm/rad²] of (17.4), by the part of the blade that makes the place, which goes on beyond its ends.

        NaN where the flank is undercut: there the blade cuts into it before and behind its contact.
        """
        bend = np.zeros(len(self.part))
        for edge in self.edges:
            before, at, after = (self._crossing(edge, np.full(len(bend), roll))[2] for roll in (-_BESIDE, 0.0, _BESIDE))
            bend = np.where(self.part == edge.part, (before - 2 * at + after) / _BESIDE**2, bend)
        return np.where(bend > 0.0, bend, np.nan)

    def _crossing(self, edge: Edge, roll: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Where an edge, which goes on beyond its ends, crosses the normals while the cradle stands still ``roll`` (n,)
        from their contacts and cutter and work turn: u, angle of the cutter, distance, what is left between them.
        """
        u, beta, theta = self.contact.T
        own = np.where(self.part == edge.part, u, (edge.lower + edge.upper) / 2)
        start = np.column_stack([own, np.full(len(u), 0.5), np.zeros(len(u))])
        order = np.argsort(theta + roll, kind="stable")  # ψ and A are made continuous from row to row
        ends = []
        for off in (-_VISIT, _VISIT):
            axes = np.empty((len(u), 6))
            axes[order] = six_axes(
                self.spec, (theta + roll)[order], beta[order] + off, self.index_ratio, 0.0, np.zeros(3)
            )
            ends.append(axes)
        (first, last), line = ends, (self.point, self.normal)
        found, rest = crossing(edge.is_arc)(
            start, first[:, :5], last[:, :5], first[:, 5], last[:, 5], 0.0, np.zeros(3), *edge.arguments, *line
        )
        return found[:, 0], beta + (2 * found[:, 1] - 1.0) * _VISIT, found[:, 2], rest

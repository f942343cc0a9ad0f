"""A witness of a flank with the fillet below it: one azimuth over the axial plane, in two patches that join.

Points come from the general solver, at parameters of the blade and cone distances, so that neither patch has to reach
beyond its end: where the flank would turn back on itself below its root, no surface over the axial plane could.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from gearmath.bevel.generation import solve_curve, solve_section
from gearmath.bevel.method import blade_sections, generation_of
from gearmath.specs.bevel_set import SIDES, Member
from tests.gearmath.bevel.contact.conftest import _heights

#: Degrees along the tooth and up the blade; parts of the face width beyond either end.
_DEGREES, _BEYOND = (11, 23), 0.02
#: Part of the quarter turn from the flank's end to the bottom of the space that the lower patch does not reach. [rad]
_BOTTOM = 0.3


@dataclass(frozen=True)
class Patch:
    """Height over the pitch cone and azimuth of what one section of the blade cuts, over (across, part of the section).

    Parts -1 to 1 lead upwards.
    """

    height: np.ndarray
    azimuth: np.ndarray

    @classmethod
    def of(cls, member: Member, flank: str, name: str, ends: tuple[float, float]) -> Patch:
        how, sections = generation_of(member, flank), blade_sections(member.flank(flank), SIDES[flank])
        blank, delta = member.blank, math.radians(member.blank.pitch_angle)
        nodes = [np.cos(np.pi * (np.arange(n + 1) + 0.5) / (n + 1)) for n in _DEGREES]
        x, y = (one.ravel() for one in np.meshgrid(*nodes, indexing="ij"))
        distance = blank.mean_cone_distance + x / 2 * (1 + 2 * _BEYOND) * blank.face_width
        u = ends[0] + (y + 1) / 2 * (ends[1] - ends[0])
        along = (math.cos(delta), math.sin(delta))
        middle = solve_section(how, sections["main"], *(np.array([blank.mean_cone_distance * one]) for one in along))
        begin = np.column_stack([u, np.tile(middle.contact[0, 1:], (len(u), 1))])
        found = solve_curve(how, sections[name], u, along, distance, begin)
        assert found.converged.all()
        radius = np.hypot(found.point[:, 0], found.point[:, 1])
        shape = tuple(n + 1 for n in _DEGREES)
        height = (radius * along[0] - found.point[:, 2] * along[1]).reshape(shape)
        azimuth = np.unwrap(np.unwrap(np.arctan2(found.point[:, 1], found.point[:, 0]).reshape(shape)), axis=0)
        one, other = (np.linalg.inv(chebyshev.chebvander(at, n)) for at, n in zip(nodes, _DEGREES, strict=True))
        return cls(one @ height @ other.T, one @ azimuth @ other.T)

    def at(self, x: np.ndarray, height: np.ndarray) -> np.ndarray:
        """Azimuths at heights: which part of the section has them is found by Newton's method."""
        y, rate = np.zeros(x.shape), chebyshev.chebder(self.height, axis=1)
        for _ in range(9):
            off = chebyshev.chebval2d(x, y, self.height) - height
            y = np.clip(y - off / chebyshev.chebval2d(x, y, rate), -1.0, 1.02)
        return chebyshev.chebval2d(x, y, self.azimuth)


@dataclass(frozen=True)
class Filleted:
    """A flank with its fillet, to be rolled in the place of a ``Field`` that ends with the flank."""

    member: Member
    flank: Patch
    fillet: Patch
    lowest: float = -0.2

    @classmethod
    def of(cls, member: Member, flank: str) -> Filleted:
        sections = blade_sections(member.flank(flank), SIDES[flank])
        edge, main, blank = sections["edge"], sections["main"], member.blank
        top = main.lower + (blank.mean_addendum + blank.mean_dedendum) * 1.3
        upper = Patch.of(member, flank, "main", (main.lower, top))
        return cls(member, upper, Patch.of(member, flank, "edge", (edge.upper - _BOTTOM, edge.lower)))

    def azimuth(self, across: np.ndarray, up: np.ndarray) -> np.ndarray:
        x = (2 * across - 1) / (1 + 2 * _BEYOND)
        blank = self.member.blank
        bottom, tip = _heights(self.member, blank.mean_cone_distance + (across - 0.5) * blank.face_width)
        height = bottom + up * (tip - bottom)
        joint = chebyshev.chebval2d(x, np.ones(x.shape), self.fillet.height)
        return np.where(height < joint, self.fillet.at(x, height), self.flank.at(x, height))

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
_DEGREES, _BEYOND = (11, 31), 0.02
#: Part of the quarter turn from the flank's end to the bottom of the space that the lower patch does not reach. [rad]
_BOTTOM = 0.3


@dataclass(frozen=True)
class Patch:
    """Azimuth of what one section of the blade cuts, over (across, part of its height), parts -1 to 1 upwards.

    ``ends`` are the heights over the pitch cone of both parts.
    """

    azimuth: np.ndarray
    ends: tuple[np.ndarray, np.ndarray]

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
        high, turn = (one @ values @ other.T for values in (height, azimuth))
        # the same by height: which part of the blade has it is found by Newton's method
        low, top = (np.array([chebyshev.chebval(end, row) for row in high]) for end in (-1.0, 1.0))
        wanted = _between(chebyshev.chebval(x, low), chebyshev.chebval(x, top), y)
        rate = chebyshev.chebder(high, axis=1)
        for _ in range(30):
            y = np.clip(y - (chebyshev.chebval2d(x, y, high) - wanted) / chebyshev.chebval2d(x, y, rate), -1.0, 1.0)
        assert np.abs(chebyshev.chebval2d(x, y, high) - wanted).max() < 1e-9
        return cls(one @ chebyshev.chebval2d(x, y, turn).reshape(shape) @ other.T, (low, top))

    def at(self, x: np.ndarray, height: np.ndarray) -> np.ndarray:
        low, top = (chebyshev.chebval(x, end) for end in self.ends)
        return chebyshev.chebval2d(x, np.clip(2 * (height - low) / (top - low) - 1, -1.0, 1.0), self.azimuth)


def _between(low: np.ndarray, top: np.ndarray, part: np.ndarray) -> np.ndarray:
    return low + (part + 1) / 2 * (top - low)


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
        joint = chebyshev.chebval(x, self.fillet.ends[1])
        return np.where(height < joint, self.fillet.at(x, height), self.flank.at(x, height))

"""A witness of the contact of two flanks: both are rolled on each other as dense surfaces, without any condition.

Each flank is the azimuth of its points over the axial plane, a polynomial through points of the flank's own solver. At
a rotation of the pinion, every point of the gear turns about its axis until it lies on the pinion's flank; where the
gear is stopped first, the grid is refined, down to micrometers and beyond. There are no normals, no equation of
contact, no derivative: edges and corners come out because the grid ends there.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.polynomial import chebyshev

from gearmath.bevel.flank import Grid, nominal_points
from gearmath.specs.bevel_set import FLANKS, BevelSet, Member
from gearmath.specs.toml import checked

_DEGREE = 21
#: The surface reaches beyond the blank by these parts of its face width and depth.
_BEYOND_ACROSS, _BEYOND_UP = 0.02, 0.05
_GRID, _SHRINK, _LEVELS = 25, 0.6, 31
#: The pair of uniform depth: teeth, cone distance, spiral and pressure angle, cutter radius, depth below the pitch.
_TEETH, _CONE, _SPIRAL, _ALPHA, _RADIUS, _DEPTH = (14, 39), 80.0, math.radians(35), math.radians(20), 100.0, 4.0


#: Deviation [mm] along the outward normal at places z_w, r_w (n,) of nominal points.
Deviation = Callable[[np.ndarray, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Field:
    """A flank as its azimuth over (across, up) of the blank: 0 to 1 from toe to heel, from the clearance to the tip.

    It begins at the height ``lowest``, below which an undercut flank is no function of its place.
    """

    member: Member
    coefficients: np.ndarray
    lowest: float

    @classmethod
    def of(cls, member: Member, flank: str, lowest: float = 0.0, deviation: Deviation | None = None) -> Field:
        nodes = np.cos(np.pi * (np.arange(_DEGREE + 1) + 0.5) / (_DEGREE + 1))
        x, y = np.meshgrid(nodes, nodes, indexing="ij")
        axial, radial = _place(member, *_fractions(x, y, lowest))
        at = np.stack([axial, radial])
        for _ in range(1 if deviation is None else 6):
            points, residual = nominal_points(member, flank, Grid(*at))
            assert (residual < 1e-9).all()
            point = points.point
            if deviation is not None:  # which nominal place comes to stand on this one
                off = deviation(*(one.ravel() for one in at))
                point = point + off[:, None] * points.normal
                here = np.stack([point[:, 2], np.hypot(point[:, 0], point[:, 1])]).reshape(at.shape)
                at = at + np.stack([axial, radial]) - here
        azimuth = np.unwrap(np.unwrap(np.arctan2(point[:, 1], point[:, 0]).reshape(x.shape)), axis=0)
        matrix = np.linalg.inv(chebyshev.chebvander(nodes, _DEGREE))
        return cls(member, matrix @ azimuth @ matrix.T, lowest)

    def azimuth(self, across: np.ndarray, up: np.ndarray) -> np.ndarray:
        x = (2 * across - 1) / (1 + 2 * _BEYOND_ACROSS)
        y = (2 * (up - self.lowest) / (1 - self.lowest) - 1) / (1 + 2 * _BEYOND_UP)
        # as a product of matrices, many times faster than NumPy's chebval2d
        of_x, of_y = (chebyshev.chebvander(one, _DEGREE) for one in (x, y))
        return np.einsum("...j,...j->...", of_x @ self.coefficients, of_y).reshape(np.shape(across))


def _fractions(x: np.ndarray, y: np.ndarray, lowest: float) -> tuple[np.ndarray, np.ndarray]:
    up = (y * (1 + 2 * _BEYOND_UP) + 1) / 2
    return (x * (1 + 2 * _BEYOND_ACROSS) + 1) / 2, lowest + up * (1 - lowest)


def _heights(member: Member, distance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Heights over the pitch cone of the lower limit and of the tip, at cone distances."""
    blank = member.blank
    off = distance - blank.mean_cone_distance
    angle, face, root = (math.radians(a) for a in (blank.pitch_angle, blank.face_angle, blank.root_angle))
    tip = blank.mean_addendum + off * math.tan(face - angle)
    bottom = blank.clearance - blank.mean_dedendum - off * math.tan(angle - root)
    return bottom, tip


def _place(member: Member, across: np.ndarray, up: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    blank = member.blank
    distance = blank.mean_cone_distance + (across - 0.5) * blank.face_width
    bottom, tip = _heights(member, distance)
    height, angle = bottom + up * (tip - bottom), math.radians(blank.pitch_angle)
    return (
        distance * math.cos(angle) - height * math.sin(angle),
        distance * math.sin(angle) + height * math.cos(angle),
    )


def _blank_place(member: Member, axial: np.ndarray, radial: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    blank, angle = member.blank, math.radians(member.blank.pitch_angle)
    distance = axial * math.cos(angle) + radial * math.sin(angle)
    height = radial * math.cos(angle) - axial * math.sin(angle)
    bottom, tip = _heights(member, distance)
    across = (distance - blank.mean_cone_distance) / blank.face_width + 0.5
    return across, (height - bottom) / (tip - bottom)


def _mean(field: Field) -> float:
    """Azimuth of the flank at the mean point of the pitch cone."""
    blank, angle = field.member.blank, math.radians(field.member.blank.pitch_angle)
    place = (np.array(blank.mean_cone_distance * f(angle)) for f in (math.cos, math.sin))
    return float(field.azimuth(*_blank_place(field.member, *place)))


@dataclass(frozen=True)
class Rolling:
    """Two flanks in the frame of the pair: pinion axis Z, gear axis X, Y = Z x X; V, H, J [mm], shaft [rad] more."""

    pinion: Field
    gear: Field
    shaft_angle: float
    sense: int
    V: float = 0.0
    H: float = 0.0
    J: float = 0.0
    shaft: float = 0.0

    def from_gear(self, across: np.ndarray, up: np.ndarray, rotation: float) -> tuple[np.ndarray, ...]:
        """φ_2 at which points of the gear stop on the pinion; across and up on the gear, then on the pinion."""
        axial, radial = _place(self.gear.member, across, up)
        own = self.gear.azimuth(across, up) - _mean(self.gear) + math.pi
        sigma, zero = self.shaft_angle + self.shaft, _mean(self.pinion)
        turn = np.full(across.shape, -rotation * self.pinion.member.teeth / self.gear.member.teeth)

        def apart(turn: np.ndarray) -> tuple[np.ndarray, ...]:
            x, y, z = radial * np.cos(own + turn), radial * np.sin(own + turn), axial + self.J
            at = np.stack(
                [
                    x * math.cos(sigma) + z * math.sin(sigma),
                    y + self.V,
                    z * math.cos(sigma) - x * math.sin(sigma) - self.H,
                ]
            )
            place = _blank_place(self.pinion.member, at[2], np.hypot(at[0], at[1]))
            return _half(np.arctan2(at[1], at[0]) - self.pinion.azimuth(*place) + zero - rotation), *place

        last, (off, *_) = turn - 1e-4, apart(turn - 1e-4)
        for _ in range(10):
            here, *place = apart(turn)
            if np.abs(here).max() < 1e-13:
                break
            slope = np.where(here == off, 1.0, (here - off) / np.where(turn == last, 1.0, turn - last))
            last, off, turn = turn, here, turn - np.where(here == off, 0.0, np.clip(here / slope, -0.2, 0.2))
        here, *place = apart(turn)
        return np.where(np.abs(here) < 1e-12, turn, np.nan), across, up, *place

    def from_pinion(self, across: np.ndarray, up: np.ndarray, rotation: float) -> tuple[np.ndarray, ...]:
        """φ_2 at which the gear stops on points of the pinion; across and up on the gear, then on the pinion."""
        axial, radial = _place(self.pinion.member, across, up)
        own = self.pinion.azimuth(across, up) - _mean(self.pinion) + rotation
        sigma = self.shaft_angle + self.shaft
        x, y, z = radial * np.cos(own), radial * np.sin(own) - self.V, axial + self.H
        along = x * math.cos(sigma) - z * math.sin(sigma)
        place = _blank_place(self.gear.member, x * math.sin(sigma) + z * math.cos(sigma) - self.J, np.hypot(along, y))
        turn = np.arctan2(y, along) - self.gear.azimuth(*place) + _mean(self.gear) - math.pi
        return _half(turn), *place, across, up

    def first(self, rotation: float) -> tuple[float, float, float] | None:
        """φ_2 [rad] at which the gear is stopped, and cone distance and height of the place on the gear [mm].

        None where the place is at the lowest one that the witness knows of the pinion: it may lie deeper.
        """
        found = self.contact(rotation)
        return None if found is None else found[:3]

    def contact(self, rotation: float) -> tuple[float, float, float, str] | None:
        """The same, and the kind of the contact: how many borders of a member it lies on.

        Points of either member are tried, so that the edges of both are lines of a grid.
        """
        found = [self._refined(points, rotation) for points in (self.from_gear, self.from_pinion)]
        turn, *places = max(found, key=lambda one: self.sense * one[0])
        across, up, _, up_1 = places
        if up_1 < self.pinion.lowest + 1e-3:
            return None
        on = [sum(abs(one - end) < 1e-5 for one, end in ((x, 0), (x, 1), (y, 1))) for x, y in (places[:2], places[2:])]
        blank = self.gear.member.blank
        distance = blank.mean_cone_distance + (across - 0.5) * blank.face_width
        bottom, tip = _heights(self.gear.member, np.array(distance))
        kind = "corner" if max(on) > 1 else "edge" if max(on) else "interior"
        return turn, distance, float(bottom + up * (tip - bottom)), kind

    def _refined(self, points: Callable[..., tuple[np.ndarray, ...]], rotation: float) -> tuple[float, ...]:
        across, up = np.meshgrid(np.linspace(0, 1, 101), np.linspace(0, 1, 41), indexing="ij")
        width, best = 1.0, (math.nan,) * 5
        for _ in range(_LEVELS):
            turn, x, y, x_1, y_1 = points(across, up, rotation)
            inside = np.isfinite(turn) & (x >= 0) & (x <= 1) & (y <= 1) & (x_1 >= 0) & (x_1 <= 1) & (y_1 <= 1)
            inside &= (y >= self.gear.lowest) & (y_1 >= self.pinion.lowest)
            lead = np.where(inside, self.sense * turn, -np.inf)
            k = np.unravel_index(int(lead.argmax()), lead.shape)
            best = (float(turn[k]), float(x[k]), float(y[k]), float(x_1[k]), float(y_1[k]))
            width *= _SHRINK
            window = width * np.linspace(-0.5, 0.5, _GRID)
            across, up = np.meshgrid(np.clip(across[k] + window, 0, 1), np.clip(up[k] + window, 0, 1), indexing="ij")
        return best if np.isfinite(lead[k]) else (-self.sense * math.inf, *(math.nan,) * 4)


def _half(angle: np.ndarray) -> np.ndarray:
    return (angle + math.pi) % (2 * math.pi) - math.pi


@pytest.fixture(scope="session")
def rolling():
    """rolling(set, pinion flank, lowest and deviation of the pinion, V, H, J, shaft): one side of a pair."""

    def make(
        pair: BevelSet, flank: str, lowest: float = 0.0, deviation: Deviation | None = None, **assembly: float
    ) -> Rolling:
        mating = FLANKS[1 - FLANKS.index(flank)]
        pinion, gear = Field.of(pair.pinion, flank, lowest, deviation), Field.of(pair.gear, mating)
        # a left-hand pinion drives with its concave flank, turning clockwise about Z
        sense = 1 if (flank == "concave") == (pair.pinion.hand == "left") else -1
        return Rolling(pinion, gear, math.radians(pair.shaft_angle), sense, **assembly)

    return make


@pytest.fixture(scope="session")
def uniform_pair():
    """uniform_pair(radius, bent): teeth of uniform depth from one crown gear.

    Another cutter radius crowns the pinion along the tooth, and ``bent``, the radius of its blades, up its profile.
    """

    def member(teeth: int, hand: int, radius: float, bent: float | None) -> dict:
        delta = math.atan2(teeth, _TEETH[0] + _TEETH[1] - teeth)
        center = _CONE - radius * cmath.exp(-1j * (math.pi / 2 - _SPIRAL))
        settings = {
            "radial_distance": abs(center),
            "cradle_angle": math.degrees(hand * cmath.phase(center)),
            "cutter_tilt": 0.0,
            "cutter_swivel": 0.0,
            "blank_offset": 0.0,
            "sliding_base": -_DEPTH,
            "machine_center_to_crossing_point": 0.0,
            "machine_root_angle": math.degrees(delta),
            "ratio_of_roll": 1 / math.sin(delta),
            "work_rotation_offset": 0.0,
            "blade_pressure_angle": math.degrees(_ALPHA),
            "blade_profile_height": 17.0,
        }
        if bent is not None:
            settings |= {"blade_spheric_radius": bent, "blade_reference_height": _DEPTH}
        radii = {"concave": radius - _DEPTH * math.tan(_ALPHA), "convex": radius + _DEPTH * math.tan(_ALPHA)}
        angle = math.degrees(delta)
        blank = {
            "pitch_angle": angle,
            "face_angle": angle,
            "root_angle": angle,
            "mean_cone_distance": _CONE,
            "face_width": 20.0,
            "mean_addendum": 3.2,
            "mean_dedendum": _DEPTH,
            "clearance": 0.8,
        }
        return {
            "teeth": teeth,
            "hand": "right" if hand > 0 else "left",
            "cutting": "fixed_setting",
            "blank": blank,
            **{flank: {**settings, "blade_point_radius": radii[flank]} for flank in FLANKS},
        }

    def make(radius: float = _RADIUS, bent: float | None = None) -> BevelSet:
        values = {
            "title": "uniform depth",
            "source": "here",
            "shaft_angle": 90.0,
            "pinion": member(_TEETH[0], -1, radius, bent),
            "gear": member(_TEETH[1], 1, _RADIUS, None),
        }
        return checked(values, BevelSet, "uniform depth")

    return make

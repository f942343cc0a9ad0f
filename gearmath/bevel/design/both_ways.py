"""Ways from the settings that give both flanks their points to those that give both whole flanks their gaps.

Least squares over two whole flanks with one machine have more than one minimum, and the first one met may leave ten
times as much as another. So two ways are gone where the first leaves much, and the one that leaves less is taken.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from gearmath.bevel.design import both_system as system
from gearmath.bevel.design.both_flanks import BothFlanks, FittedBoth, Side, nearest, whole
from gearmath.bevel.design.both_system import index
from gearmath.bevel.generation import Section, solve_section, turning_sense
from gearmath.bevel.identify.flank_target import FlankTarget, locate
from gearmath.bevel.method import blade_sections
from gearmath.bevel.newton import FlankPoints
from gearmath.specs.bevel_set import SIDES, Member

#: Least part of the places of each side that must be cut.
LEAST_SHARE = 0.7
#: A way whose RMS [mm] is no more needs no other one beside it.
_WELL = 2.5e-3


@dataclass(frozen=True)
class _Station:
    """A fit on a way: the part of gap and parabola that is wanted, whether of places about the middle alone, and
    whether the parabolas are held."""

    part: float
    middle: bool = False
    parabolas_held: bool = False


#: The middle first: on the way from there, no place comes to lie beyond a singular line.
_FROM_THE_MIDDLE = (_Station(1.0, middle=True), _Station(1.0), _Station(1.0, parabolas_held=True))
#: Little of the gap first: nearly conjugate flanks lie near the crown gear's, and each next part near the one before.
_BY_PARTS = (*(_Station(part) for part in (0.1, 0.3, 0.6, 1.0)), _Station(1.0, parabolas_held=True))


@dataclass(frozen=True)
class Way:
    """Where a way has ended: the problem with the places that are cut there, what fits best if anything does, where the
    flanks are cut, and which part of the places of each that is."""

    problem: BothFlanks
    fitted: FittedBoth | None
    contacts: tuple[np.ndarray, ...]
    shares: dict[str, float]

    @property
    def off(self) -> float:
        """The greater RMS of both flanks [mm]; infinite where nothing fits."""
        if self.fitted is None or min(self.shares.values()) < LEAST_SHARE:
            return math.inf
        return max(math.sqrt(float(np.mean(off**2))) for off in self.fitted.off.values())


def best_way(start: Member, problem: BothFlanks, inner: Mapping[str, np.ndarray], near: np.ndarray) -> Way:
    """The way that leaves least, from settings (35,) that give both flanks their points, and both parabolas held.

    ``start`` has the blades; ``inner`` (n,) tells by flank which places are about the middle.
    """
    first = _followed(start, problem, inner, near, _FROM_THE_MIDDLE)
    if first.off <= _WELL:
        return first
    return min(first, _followed(start, problem, inner, near, _BY_PARTS), key=lambda way: way.off)


def _followed(
    start: Member,
    problem: BothFlanks,
    inner: Mapping[str, np.ndarray],
    near: np.ndarray,
    stations: tuple[_Station, ...],
) -> Way:
    """Station by station, each from where the one before has ended."""
    for station in stations:
        one, other = (_asking(side, station.part) for side in problem.sides)
        stage = replace(problem, sides=(one, other), parabolas_held=station.parabolas_held)
        near = nearest(stage, near)
        kept, contacts = _reached(start, stage.sides, near, inner if station.middle else None)
        shares = {side.flank: float(places.mean()) for side, places in zip(stage.sides, kept, strict=True)}
        cut, fitted = replace(stage, sides=(one.among(kept[0]), other.among(kept[1]))), None
        if all(places.any() for places in kept):
            fitted = whole(cut, near, contacts)
            near = near if fitted is None else fitted.x
    return Way(cut, fitted, tuple(contacts), shares)


def _asking(side: Side, part: float) -> Side:
    """The side with a part of its gap and of its parabola."""
    return replace(side, gap=part * side.gap, wanted=replace(side.wanted, parabola=part * side.wanted.parabola))


def _reached(
    start: Member, sides: tuple[Side, Side], x: np.ndarray, among: Mapping[str, np.ndarray] | None
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """By side which conjugate places (n,) are cut above the tip of the blade, not undercut, and where (m,3)."""
    kept, contacts = [], []
    for side in sides:
        cut = system.generation(side.how, side.flank, x)
        section = blade_sections(start.flank(side.flank), SIDES[side.flank])["main"]
        blade = Section(section.lower, section.upper, float(cut.settings[-2]), float(cut.settings[-1]))
        places = side.meeting.point[:, 2], np.hypot(*side.meeting.point[:, :2].T)
        at = solve_section(cut, blade, *places)
        own = np.array([[x[index(name, side.flank)] for name in ("u", "beta", "theta")]])
        mean = turning_sense(cut, blade, own)
        reached = at.converged & (at.contact[:, 0] >= section.lower) & (np.sign(at.sense) == np.sign(mean))
        if among is not None:
            reached &= among[side.flank]
        if reached.any():
            # at the border of undercut a line along the normal may not cross the flank
            points = FlankPoints(at.contact, side.meeting.point, side.meeting.normal)
            target = FlankTarget(cut, points, np.zeros(len(reached)))
            with np.errstate(all="ignore"):
                reached &= ~locate(target, target.vector).failed
        kept.append(reached)
        contacts.append(at.contact[reached])
    return kept, contacts

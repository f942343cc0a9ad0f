"""Settings that reproduce given flanks, from a blank and a method alone.

From the crown gear that has the mean points of the flanks (``reverse_start``) to the whole flanks (``reverse_fit``);
where that leaves more than the points scatter, other cutters are tried to start from.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearmath.bevel.design.reverse_fit import NOTHING, FittedFlanks, fitted, left_by, member_of, rms_of
from gearmath.bevel.design.reverse_points import GivenFlank
from gearmath.bevel.design.reverse_start import (
    KnownMember,
    MeanPoint,
    crown_gear_start,
    cutter_radius,
    mean_point,
    noise,
    placed,
    space_turn,
)
from gearmath.errors import ComputationError, InputError
from gearmath.shown import Shown, Shows
from gearmath.specs.bevel_set import FLANKS, Member

#: Settings leave at most so much of a flank, RMS [mm], or they do not reproduce it.
LIMIT = 0.010
#: The noise of the points where they do not tell it. [mm]
_UNKNOWN = 1e-3
#: Cutters to start from, in parts of the radius that is known or that the curvature tells.
_RADII = (1.0, 0.85, 1.2)


@dataclass(frozen=True)
class ReversedFlank:
    """How well a flank is reproduced: by deviations (n,) [mm] from its points, positive outside of them.

    ``before`` are those of the crown gear, NaN where it does not cut; ``after`` those of the settings found.
    ``scatter`` [mm] is that of the points about a smooth surface, ``free`` what was fitted, ``active`` the bounds met,
    ``possible`` whether a gear set may have the settings.
    """

    given: GivenFlank
    before: np.ndarray
    after: np.ndarray
    scatter: float
    free: tuple[str, ...]
    active: tuple[str, ...]
    possible: bool

    @property
    def rms_before(self) -> float:
        """RMS of what the crown gear's settings leave [mm], of the points that they cut."""
        return rms_of(self.before[np.isfinite(self.before)])

    @property
    def rms(self) -> float:
        """RMS of what the settings found leave [mm]."""
        return rms_of(self.after)

    @property
    def not_reproduced(self) -> float:
        """RMS [mm] of what is left, less what the scatter of the points and the fit account for."""
        freedom = max(len(self.after) - len(self.free), 1)
        return math.sqrt(max(float(self.after @ self.after) / freedom - self.scatter**2, 0.0))

    @property
    def largest(self) -> int:
        """The point that is reproduced least."""
        return int(np.argmax(np.abs(self.after)))

    def as_dict(self) -> dict[str, Any]:
        """In plain numbers by name, deviations in um."""
        worst = self.largest
        return {
            "points": len(self.after),
            "rms_before_um": 1000 * self.rms_before,
            "rms_um": 1000 * self.rms,
            "scatter_um": 1000 * self.scatter,
            "not_reproduced_um": 1000 * self.not_reproduced,
            "largest": {
                "deviation_um": 1000 * float(self.after[worst]),
                "row": int(self.given.row[worst]),
                "col": int(self.given.col[worst]),
            },
            "fitted": list(self.free),
            "bounds_reached": list(self.active),
        }


@dataclass(frozen=True, repr=False)
class ReversedMember(Shown):
    """A member that reproduces given flanks, and how well it does, by flank."""

    member: Member
    flanks: dict[str, ReversedFlank]

    def _shown(self) -> tuple[str, list[Shows]]:
        figures: list[Shows] = [(f"{flank}: RMS", 1000 * found.rms, "um") for flank, found in self.flanks.items()]
        return f"member of {self.member.teeth} teeth", figures


def reverse(known: KnownMember, given: dict[str, GivenFlank], name: str) -> ReversedMember:
    """The member whose flanks reproduce the given ones, from nothing but its blank and its method.

    ``name`` is that of the member. Raises InputError where the points are not of this blank or hand, or where no
    settings come within ``LIMIT``, ComputationError where the search finds no settings at all.
    """
    means = {}
    for flank in FLANKS:
        try:
            means[flank] = mean_point(given[flank], known.blank)
        except InputError as error:
            raise InputError(f"{flank} flank: {error}") from error
        _check_place(flank, means[flank], known)
    given, means = _one_space(given, means, known.teeth)
    best: ReversedMember | None = None
    said: Exception | None = None
    radius = known.cutter_radius or cutter_radius(known, given, means)
    for part in _RADII:
        try:
            found = _from_start(crown_gear_start(known, means, part * radius).named(name), given, means)
        except (InputError, ComputationError) as error:
            said = said or error
            continue
        if best is None or _rank(found) < _rank(best):
            best = found
        if _is_enough(best):
            break
    if best is None:
        assert said is not None
        raise said
    _check_near(best)
    return best


def _rank(found: ReversedMember) -> tuple[bool, float]:
    """The less the better: what a set may have, then what leaves less of its worse flank."""
    flanks = found.flanks.values()
    return not all(flank.possible for flank in flanks), max(flank.not_reproduced for flank in flanks)


def _is_enough(found: ReversedMember) -> bool:
    """Whether no other start is worth trying: less is left than the points scatter, or nothing."""
    impossible, left = _rank(found)
    return not impossible and left <= max(NOTHING, *(flank.scatter for flank in found.flanks.values()))


def _check_near(found: ReversedMember) -> None:
    for name, flank in found.flanks.items():
        if flank.rms > LIMIT:
            method = f"{found.member.cutting}, {found.member.generation}, {found.member.process}"
            raise InputError(
                f"{name} flank: no settings ({method}) come nearer to its points than {1000 * flank.rms:.3g} um RMS, "
                f"which must be at most {1000 * LIMIT:g}: is it the method and the blank of this flank?"
            )


def _check_place(flank: str, mean: MeanPoint, known: KnownMember) -> None:
    """Whether the points stand about the mean point of the blank, and are of the flank that they are said to be."""
    blank = known.blank
    off = float(np.linalg.norm(mean.point)) - blank.mean_cone_distance
    if abs(off) > blank.face_width / 2:
        raise InputError(
            f"{flank} flank: the point nearest to the mean point has a cone distance of "
            f"{np.linalg.norm(mean.point):.4g} mm, the blank has {blank.mean_cone_distance:.4g} mm there"
        )
    hollow = mean.curvature[0, 0] > 0
    if hollow != (flank == "concave"):
        raise InputError(
            f"{flank} flank: it is {'hollow' if hollow else 'bulged'} along the tooth; are the names of the flanks "
            "interchanged, or the normals turned inwards?"
        )


def _one_space(
    given: dict[str, GivenFlank], means: dict[str, MeanPoint], teeth: int
) -> tuple[dict[str, GivenFlank], dict[str, MeanPoint]]:
    """The flanks as those of one space: where they bound a tooth, or more, the convex one is turned by pitches."""
    wanted = math.copysign(space_turn(means, teeth), means["concave"].angles[2])
    turn = wanted - (means["convex"].angles[3] - means["concave"].angles[3])
    return (
        {**given, "convex": given["convex"].turned(turn)},
        {**means, "convex": means["convex"].turned(turn)},
    )


def _from_start(start: Member, given: dict[str, GivenFlank], means: dict[str, MeanPoint]) -> ReversedMember:
    hows = placed(start, means)
    flanks, found = {}, {}
    for group in [FLANKS] if start.cutting == "completing" else [(flank,) for flank in FLANKS]:
        first = FittedFlanks({flank: hows[flank] for flank in group}, np.zeros(0), ())
        before = {flank: left_by(hows[flank], given[flank]) for flank in group}
        scatter = {flank: noise(given[flank], before[flank], _UNKNOWN) for flank in group}
        best = fitted(start, first, given, rms_of(np.array(list(scatter.values()))))
        for flank in group:
            found[flank] = best.hows[flank]
            after = left_by(best.hows[flank], given[flank])
            flanks[flank] = ReversedFlank(
                given[flank], before[flank], after, scatter[flank], best.free, best.active, best.possible
            )
            if not np.isfinite(after).all():
                raise ComputationError(f"{flank} flank: the settings found do not cut all of its points")
    return ReversedMember(member_of(start, found), flanks)

"""Settings that reproduce given flanks: from the crown gear of their mean points, by least squares over both flanks.

The deviation of the cut flank from each point, along the normal there, is made least by few settings first, then by
more: tilt and motions of the settings come last, and are taken only where they pay by Schwarz's criterion,

    n ln(Σ t²/n) + p ln n   least                                           (Schwarz 1978, Annals of Statistics 6)

for n points and p settings. Points of the flank do not tell how deep the blade went: the root stays that of the blank.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearmath.bevel.check_flank import check_grid, cut_flank
from gearmath.bevel.design.local_settings import FIRST, MOVING, NAMES
from gearmath.bevel.design.pinion import settings_table
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
from gearmath.bevel.generation import Generation
from gearmath.bevel.identify.compensation import identify
from gearmath.bevel.identify.flank_target import FlankTarget, located
from gearmath.bevel.identify.root_line import root_line
from gearmath.bevel.identify.variables import parts
from gearmath.bevel.misfit import Misfit
from gearmath.bevel.newton import FlankPoints
from gearmath.errors import ComputationError, InputError
from gearmath.specs.bevel_set import FLANKS, SETTINGS, Member
from gearmath.specs.toml import checked

#: Settings leave at most so much of a flank, RMS [mm], or they do not reproduce it.
LIMIT = 0.010
#: Nothing is left where the RMS is below this. [mm]
_NOTHING = 1e-5
#: The root may rise or sink by this part of the clearance, over all stages.
_ROOT = 0.2
#: The noise of the points where they do not tell it. [mm]
_UNKNOWN = 1e-3
#: So often the noise is tried again, where less is left than was expected.
_TRIALS = 3
#: So often a stage is fitted, each time with its bounds about what was found, where one of them was met.
_ROUNDS = 3
#: Cutters to start from, in parts of the radius that is known or that the curvature tells.
_RADII = (1.0, 0.85, 1.2)
#: Part of the points that settings to start from must cut.
_LEAST_CUT = 0.6

_BLADE = ("blade_pressure_angle", "blade_point_radius")
_PLACE = ("machine_root_angle", "sliding_base", "machine_center_to_crossing_point", "blank_offset")
_ROLL = ("work_rotation_offset.2", "work_rotation_offset.3")
_TILT = ("cutter_tilt", "cutter_swivel")


def stages(generation: str) -> list[tuple[str, ...]]:
    """The settings that are free, stage by stage.

    The cradle angle of a generated flank stays, as the work rotation does the same: the mean point is cut with the
    cradle at rest.
    """
    first = ("radial_distance", "work_rotation_offset", *_BLADE)
    if generation == "formate":
        return [(*first, "cradle_angle"), (*first, "cradle_angle", *_PLACE), (*first, "cradle_angle", *_PLACE, *_TILT)]
    second = (*first, *_PLACE, "ratio_of_roll")
    rolled = (*second, *_ROLL)
    return [first, second, rolled, (*rolled, "sliding_base.1"), (*rolled, "sliding_base.1", *_TILT)]


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
        return _rms(self.before[np.isfinite(self.before)])

    @property
    def rms(self) -> float:
        """RMS of what the settings found leave [mm]."""
        return _rms(self.after)

    @property
    def not_reproduced(self) -> float:
        """RMS [mm] of what is left, less what the scatter of the points and the fit account for."""
        freedom = max(len(self.after) - len(self.free), 1)
        return math.sqrt(max(float(self.after @ self.after) / freedom - self.scatter**2, 0.0))

    @property
    def largest(self) -> int:
        """The point that is reproduced least."""
        return int(np.argmax(np.abs(self.after)))


@dataclass(frozen=True)
class ReversedMember:
    """A member that reproduces given flanks, and how well it does, by flank."""

    member: Member
    flanks: dict[str, ReversedFlank]


@dataclass(frozen=True)
class _Found:
    """Settings of a group of flanks after a stage, and what they leave of all its points (m,) [mm]."""

    hows: dict[str, Generation]
    left: np.ndarray
    free: tuple[str, ...]
    active: tuple[str, ...] = ()
    possible: bool = True

    def rank(self) -> tuple[bool, float]:
        """The less the better: what a gear set may have, then Schwarz's criterion; where a point is not cut, last."""
        n = len(self.left)
        if not np.isfinite(self.left).all():
            return True, math.inf
        return not self.possible, n * math.log(max(_rms(self.left), _NOTHING) ** 2) + len(self.free) * math.log(n)


def reverse(known: KnownMember, given: dict[str, GivenFlank], name: str) -> ReversedMember:
    """The member whose flanks reproduce the given ones, from nothing but its blank and its method.

    ``name`` is the member's in messages. Raises InputError where the points are not of this blank or hand, or where no
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
    for part in _RADII:
        radius = part * (known.cutter_radius or cutter_radius(known, given, means))
        try:
            found = _from_start(crown_gear_start(known, means, radius), given, means, name)
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
    return not impossible and left <= max(_NOTHING, *(flank.scatter for flank in found.flanks.values()))


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


def _from_start(start: Member, given: dict[str, GivenFlank], means: dict[str, MeanPoint], name: str) -> ReversedMember:
    hows = placed(start, means)
    flanks, found = {}, {}
    for group in [FLANKS] if start.cutting == "completing" else [(flank,) for flank in FLANKS]:
        first = _Found({flank: hows[flank] for flank in group}, np.zeros(0), ())
        before = {flank: _left(hows[flank], given[flank]) for flank in group}
        scatter = {flank: noise(given[flank], before[flank], _UNKNOWN) for flank in group}
        best = _fitted(start, first, given, _rms(np.array(list(scatter.values()))), name)
        for flank in group:
            found[flank] = best.hows[flank]
            after = _left(best.hows[flank], given[flank])
            flanks[flank] = ReversedFlank(
                given[flank], before[flank], after, scatter[flank], best.free, best.active, best.possible
            )
            if not np.isfinite(after).all():
                raise ComputationError(f"{flank} flank: the settings found do not cut all of its points")
    return ReversedMember(_member(start, found), flanks)


def _fitted(start: Member, first: _Found, given: dict[str, GivenFlank], scatter: float, name: str) -> _Found:
    """The best of all stages, each from the one before: of those that can be cut, else of all.

    Raises ComputationError where none gives settings.
    """
    best: _Found | None = None
    near, chosen = first, stages(start.generation)
    for free in chosen:
        found = None
        for _ in range(_ROUNDS):
            found = _stage(start, near, given, free, scatter, _ROOT / len(chosen) / _ROUNDS, name)
            if found is None:
                break
            near = found
            if best is None or found.rank() < best.rank():
                best = found
            if not found.active:
                break
        if found is not None and _rms(found.left) <= _NOTHING:
            break
    if best is None:
        raise ComputationError(f"{' and '.join(first.hows)} flank: no settings near the crown gear's cut its points")
    return best


def _is_flank(start: Member, hows: dict[str, Generation], name: str) -> bool:
    """Whether the settings cut flanks that a gear set may have: root, roll, tips and motions within their limits."""
    try:
        member = _member(start, hows)
        for flank, how in hows.items():
            cut_flank(member, name, flank, how)
            check_grid(member, name, flank)
    except (Misfit, InputError, ComputationError):
        return False
    return True


def _stage(
    start: Member,
    near: _Found,
    given: dict[str, GivenFlank],
    free: Sequence[str],
    scatter: float,
    root: float,
    name: str,
) -> _Found | None:
    """The settings after the fit of the ``free`` ones from those ``near``; None where there are none."""
    targets = [_target(start, flank, how, given[flank]) for flank, how in near.hows.items()]
    if any(
        len(target.deviation) < _LEAST_CUT * len(given[flank].point)
        for target, flank in zip(targets, near.hows, strict=True)
    ):
        return None
    level = scatter
    for _ in range(_TRIALS):
        try:
            found = identify(
                targets, free, root_limit=root * start.blank.clearance or None, noise=level, bounds="design"
            )
        except (ValueError, ComputationError):  # a point, or the root, is lost at the start already
            return None
        freedom = max(len(found.residual) - len(found.variables), 1)
        left = float(np.sqrt(found.residual @ found.residual / freedom))
        if left > level / 2 or left <= _NOTHING:
            break
        level = left
    hows = {}
    for k, (flank, how) in enumerate(near.hows.items()):
        settings, motion = parts(targets[k].vector + found.change(k))
        hows[flank] = replace(how, settings=settings, motion=motion)
    off = np.concatenate([_left(how, given[flank]) for flank, how in hows.items()])
    return _Found(hows, off, tuple(free), found.active, _is_flank(start, hows, name))


def _target(start: Member, flank: str, how: Generation, given: GivenFlank) -> FlankTarget:
    """The points of a flank that settings cut, as a target."""
    at = given.places(how)
    points = FlankPoints(at.contact, given.point, given.normal)
    kept = at.converged
    points = FlankPoints(*(array[kept] for array in vars(points).values()))
    root = replace(root_line(start, flank, how, points), deepest=True)
    return FlankTarget(how, points, np.zeros(int(kept.sum())), root=root)


def _left(how: Generation, given: GivenFlank) -> np.ndarray:
    """How far (n,) [mm] the flank of settings lies outside of the points, along their normals; NaN where it is not."""
    points = FlankPoints(given.places(how).contact, given.point, given.normal)
    target = FlankTarget(how, points, np.zeros(len(given.point)))
    deviation, _, failed = located(target, target.vector, moving=False)
    return np.where(failed, np.nan, deviation)


def _member(start: Member, hows: dict[str, Generation]) -> Member:
    """The member with the settings and motions that were found."""
    values = start.model_dump()
    for flank, how in hows.items():
        x = np.zeros(len(NAMES))
        x[FIRST : FIRST + len(SETTINGS)] = how.settings
        for name, (setting, power) in MOVING.items():
            x[NAMES.index(name)] = how.motion[SETTINGS.index(setting), power - 1]
        values[flank] = {**values[flank], **settings_table(x)}
    return checked(values, Member, "settings found")


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))

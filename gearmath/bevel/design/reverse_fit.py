"""The least-squares fit behind ``reverse``: few settings first, then more, for one flank or for both at once.

The deviation of the cut flank from each point, along the normal there, is made least. Tilt and motions of the settings
come last, and are taken only where they pay by Schwarz's criterion,

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
from gearmath.bevel.generation import Generation
from gearmath.bevel.identify.compensation import identify
from gearmath.bevel.identify.flank_target import FlankTarget, located
from gearmath.bevel.identify.root_line import root_line
from gearmath.bevel.identify.variables import parts
from gearmath.bevel.method import nominal_cut
from gearmath.bevel.misfit import Misfit
from gearmath.bevel.newton import FlankPoints
from gearmath.errors import ComputationError, InputError
from gearmath.specs.bevel_set import SETTINGS, Member
from gearmath.specs.toml import checked

#: Nothing is left where the RMS is below this. [mm]
NOTHING = 1e-5
#: The root may rise or sink by this part of the clearance, over all stages.
_ROOT = 0.2
#: So often the noise is tried again, where less is left than was expected.
_TRIALS = 3
#: So often a stage is fitted, each time with its bounds about what was found, where one of them was met.
_ROUNDS = 3
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
class FittedFlanks:
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
        return not self.possible, n * math.log(max(rms_of(self.left), NOTHING) ** 2) + len(self.free) * math.log(n)


def fitted(start: Member, first: FittedFlanks, given: dict[str, GivenFlank], scatter: float) -> FittedFlanks:
    """The best of all stages, each from the one before: of those that can be cut, else of all.

    Raises ComputationError where none gives settings.
    """
    best: FittedFlanks | None = None
    near, chosen = first, stages(start.generation)
    for free in chosen:
        found = None
        for _ in range(_ROUNDS):
            found = _stage(start, near, given, free, scatter, _ROOT / len(chosen) / _ROUNDS)
            if found is None:
                break
            near = found
            if best is None or found.rank() < best.rank():
                best = found
            if not found.active:
                break
        if found is not None and rms_of(found.left) <= NOTHING:
            break
    if best is None:
        raise ComputationError(f"{' and '.join(first.hows)} flank: no settings near the crown gear's cut its points")
    return best


def _is_flank(start: Member, hows: dict[str, Generation]) -> bool:
    """Whether the settings cut flanks that a gear set may have: root, roll, tips and motions within their limits."""
    try:
        member = member_of(start, hows)
        for flank, how in hows.items():
            cut_flank(member, flank, replace(nominal_cut(member, flank), how=how))
            check_grid(member, flank)
    except (Misfit, InputError, ComputationError):
        return False
    return True


def _stage(
    start: Member, near: FittedFlanks, given: dict[str, GivenFlank], free: Sequence[str], scatter: float, root: float
) -> FittedFlanks | None:
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
        if left > level / 2 or left <= NOTHING:
            break
        level = left
    hows = {}
    for k, (flank, how) in enumerate(near.hows.items()):
        settings, motion = parts(targets[k].vector + found.change(k))
        hows[flank] = replace(how, settings=settings, motion=motion)
    off = np.concatenate([left_by(how, given[flank]) for flank, how in hows.items()])
    return FittedFlanks(hows, off, tuple(free), found.active, _is_flank(start, hows))


def _target(start: Member, flank: str, how: Generation, given: GivenFlank) -> FlankTarget:
    """The points of a flank that settings cut, as a target."""
    at = given.places(how)
    kept = at.converged
    points = FlankPoints(at.contact[kept], given.point[kept], given.normal[kept])
    root = replace(root_line(start, flank, how, points), deepest=True)
    return FlankTarget(how, points, np.zeros(int(kept.sum())), root=root)


def left_by(how: Generation, given: GivenFlank) -> np.ndarray:
    """How far (n,) [mm] the flank of settings lies outside of the points, along their normals; NaN where it is not."""
    points = FlankPoints(given.places(how).contact, given.point, given.normal)
    target = FlankTarget(how, points, np.zeros(len(given.point)))
    deviation, _, failed = located(target, target.vector, moving=False)
    return np.where(failed, np.nan, deviation)


def member_of(start: Member, hows: dict[str, Generation]) -> Member:
    """The member with the settings and motions that were found."""
    values = start.model_dump()
    for flank, how in hows.items():
        x = np.zeros(len(NAMES))
        x[FIRST : FIRST + len(SETTINGS)] = how.settings
        for name, (setting, power) in MOVING.items():
            x[NAMES.index(name)] = how.motion[SETTINGS.index(setting), power - 1]
        values[flank] = {**values[flank], **settings_table(x)}
    return checked(values, Member, "settings found").named(start.name)


def rms_of(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))

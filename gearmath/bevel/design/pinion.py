"""The pinion's flank that a side asks for: from the crown gear by homotopy, then over its whole flank."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearmath.bevel.design import local_settings as local
from gearmath.bevel.design.local_settings import FIRST, MOVING, NAMES, LocalSystem, WantedPoint
from gearmath.bevel.design.request import Request
from gearmath.bevel.design.rolling import Meeting
from gearmath.bevel.design.whole_flank import Fitted, WholeFlank, fit
from gearmath.bevel.generation import BladeCut, Generation, Section, solve_curve, solve_section, turning_sense
from gearmath.bevel.method import nominal_cut
from gearmath.bevel.root import FLAT_BLADE
from gearmath.bevel.turning import turned
from gearmath.errors import ComputationError, InputError
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import SETTINGS, Member
from gearmath.specs.cut import ANGULAR
from gearmath.specs.toml import checked

#: Bounds of what is left free: pressure angle [rad]; 2C and 6D; motion of the sliding base [mm/rad]; tilt [rad].
_ANGLES = math.radians(10), math.radians(30)
FLATTEST = _ANGLES[1]
_ROLL = 0.15, 1.0
_HELICAL = 5.0
_TILT = math.radians(12)
#: Where more than this is left over the whole flank [mm], the length of the ellipse gives way if nobody asked for it.
_LEFT = 1.5e-3
#: Least part of the places of the gear's flank that the pinion must cut.
_LEAST_SHARE = 0.7
_EXTRA = {
    "blade_pressure_angle": ("blade_pressure_angle",),
    "modified_roll": ("modified_roll_2", "modified_roll_3"),
    "cutter_tilt": ("cutter_tilt", "cutter_swivel"),
    "helical_motion": ("helical_motion",),
}


@dataclass(frozen=True)
class PinionFlank:
    """One flank of the pinion as it was found: settings as x of ``local_settings.NAMES``, and how well they fit.

    ``contact`` is where the first solution is cut, ``share`` the part of the gear's places that the blade reaches:
    there it was fitted.
    """

    name: str
    request: Request
    problem: WholeFlank
    contact: np.ndarray
    fitted: Fitted
    share: float

    @property
    def x(self) -> np.ndarray:
        return self.fitted.local.x


def pinion_flank(start: Member, name: str, asked: Request, free: tuple[str, ...]) -> PinionFlank:
    """The flank of the pinion from that of the crown gear, ``start``.

    Raises ComputationError where the settings cannot be followed that far, InputError where they leave places uncut.
    """
    by = nominal_cut(start, name)
    how, section = by.how, by.main
    x, begin = _crown_gear(start, by, asked)
    end = WantedPoint(
        asked.roll.point,
        asked.roll.normal,
        asked.roll.basis,
        asked.curvature,
        root_of(start)[1],
        begin.cone,
        asked.own_path,
    )
    extra = tuple(extra for name in free for extra in _EXTRA[name])
    found = local.followed(how, x, begin, end, (*local.UNKNOWN, *extra))
    if found is None:
        raise ComputationError(
            f"pinion {name} flank: no settings were found that give the {asked.side} side its path, parabola and "
            f"pattern at the mean point ({asked.words}); ask for a path nearer to 90 degrees, a smaller "
            "transmission error, or less crowning"
        )
    bounds = _bounds(extra, found.x)

    def problem(among: np.ndarray) -> WholeFlank:
        meeting = Meeting(*(array[among] for array in vars(asked.meeting).values()))
        return WholeFlank(how, end, meeting, asked.gap[among], local.UNKNOWN, extra, bounds)

    # first the middle of the flank: on the way from there, no place comes to lie beyond a singular line
    kept, contact = _reached(how, section, found, asked, asked.inner)
    first = fit(problem(kept), found, contact) if kept.any() else None
    near = found if first is None else first.local
    kept, contact = _reached(how, section, near, asked, np.ones_like(kept))
    if not kept.mean() >= _LEAST_SHARE:
        raise InputError(
            f"{asked.side}: {asked.words}: settings of the pinion's {name} flank were found for the mean point, but "
            f"they cut only {kept.mean():.0%} of the places that the side needs, which must be at least "
            f"{_LEAST_SHARE:.0%}: the others lie below the tip of the blade or are undercut"
        )
    whole = problem(kept)
    fitted = fit(whole, near, contact)
    if fitted is None:
        raise InputError(
            f"{asked.side}: {asked.words}: the settings for the mean point leave parts of the pinion's {name} flank "
            "uncut, where none may be; ask for less of the flank, or for a smaller transmission error"
        )
    if fitted.rms > _LEFT and asked.yielding:
        # path and parabola stay (26.6); the gap grows too fast towards the ends, and less of it in the middle helps
        bounds = np.vstack([bounds, [-asked.yielding, 0.0]])
        longer = replace(whole, extra=(*extra, local.ACROSS), bounds=bounds)
        better = fit(longer, fitted.local, contact)
        if better is not None and better.rms < fitted.rms:
            whole, fitted = longer, better
    return PinionFlank(name, asked, whole, contact, fitted, float(kept.mean()))


def refitted(flank: PinionFlank, name: str, value: float) -> PinionFlank:
    """The flank with a setting of the blade at a value [mm, rad], all others found anew.

    One that was left free is held; for another the contact ellipse gives way, path and parabola stay (26.6).
    Raises ComputationError where there is none.
    """
    problem, x = flank.problem, flank.x.copy()
    if name in problem.extra:
        problem = _without(problem, name)
    elif name in problem.free:
        problem = replace(
            _without(problem, local.ACROSS), free=[*(one for one in problem.free if one != name), local.ACROSS]
        )
    x[NAMES.index(name)] = value
    found = local.solve(problem.how, x, problem.wanted, problem.free)
    fitted = None if found is None else fit(problem, found, flank.contact)
    if fitted is None:
        shown = f"{math.degrees(value):.6g} degrees" if name in ANGULAR else f"{value:.6g} mm"
        raise ComputationError(
            f"pinion {flank.name} flank: no settings were found with {name} = {shown}, in steps of the shop"
        )
    return replace(flank, problem=problem, fitted=fitted)


def _without(problem: WholeFlank, name: str) -> WholeFlank:
    kept = [k for k, one in enumerate(problem.extra) if one != name]
    return replace(problem, extra=tuple(problem.extra[k] for k in kept), bounds=problem.bounds[kept])


def _crown_gear(member: Member, by: BladeCut, asked: Request) -> tuple[np.ndarray, WantedPoint]:
    """The crown gear's flank turned to the wanted point, at θ = 0 there: x, and what it has."""
    P, how = asked.roll.point, by.how
    at = by.at(P[2:3], np.array([math.hypot(P[0], P[1])]))
    if not at.converged.all():
        raise ComputationError(f"{asked.side}: the crown gear's flank has no point where contact is wanted")
    turn = math.atan2(P[1], P[0]) - math.atan2(at.point[0, 1], at.point[0, 0])
    u, beta, theta = at.contact[0]
    x = np.zeros(len(NAMES))
    x[:2], x[FIRST : FIRST + len(SETTINGS)] = (u, beta), how.settings
    x[NAMES.index("cradle_angle")] += theta
    x[NAMES.index("work_rotation_offset")] += x[NAMES.index("ratio_of_roll")] * theta - turn
    cone, depth = root_of(member)
    flat = Section(0.0, 1.0, float(how.settings[-2]), FLAT_BLADE)
    direction, around = (math.cos(cone[0]), math.sin(cone[0])), np.array([[0.0, beta, theta]] * 2)
    root = solve_curve(how, flat, np.zeros(2), direction, cone[1:], around)
    x[2:6] = (root.contact[:, 1:] - [0.0, theta]).ravel()
    there = WantedPoint(P, turned(at.normal, turn)[0], asked.roll.basis, asked.curvature, depth, cone, asked.own_path)
    begin = local.between(there, there, 0.0)
    return x, replace(begin, curvature=local.curvature(how, x, begin), depth=local.depth(how, x, begin))


def root_of(member: Member, across: tuple[float, float] = (0.0, 1.0)) -> tuple[np.ndarray, np.ndarray]:
    """Pitch angle and two cone distances (3,), and the depths (2,) of the blank's root there: toe 0, heel 1."""
    blank = member.blank
    delta = blank.delta
    axial, radial = kernel("flank_place")(blank.vector, np.array(across), np.zeros(2))
    along, depth = kernel("root_place")(np.stack([radial, 0 * radial, axial], axis=1), delta)
    return np.array([delta, *along]), depth + blank.clearance


def _reached(
    how: Generation, section: Section, found: LocalSystem, asked: Request, among: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Which conjugate places (n,) the blade reaches above its tip, not undercut, and where it cuts them (m,3)."""
    moved = local.generation(how, found)
    places = asked.meeting.point[:, 2], np.hypot(*asked.meeting.point[:, :2].T)
    blade = Section(section.lower, section.upper, float(found.settings[-2]), float(found.settings[-1]))
    at = solve_section(moved, blade, *places)
    mean = turning_sense(moved, blade, np.array([[*found.x[:2], 0.0]]))
    kept = among & at.converged & (at.contact[:, 0] >= section.lower) & (np.sign(at.sense) == np.sign(mean))
    return kept, at.contact[kept]


def _bounds(extra: tuple[str, ...], x: np.ndarray) -> np.ndarray:
    """Least and largest values (p,2) of what is left free."""
    ratio = x[NAMES.index("ratio_of_roll")]
    table = {
        "blade_pressure_angle": _ANGLES,
        "helical_motion": (-_HELICAL, _HELICAL),
        "cutter_tilt": (-_TILT, _TILT),
        "cutter_swivel": (-math.pi, math.pi),
    }
    for name, most in zip(("modified_roll_2", "modified_roll_3"), roll_rows(ratio, _ROLL), strict=True):
        table[name] = (-abs(most), abs(most))
    return np.array([table[name] for name in extra]).reshape(-1, 2)


def roll_rows(ratio: float, coefficients: tuple[float, ...]) -> np.ndarray:
    """Coefficients of θ², θ³ of the work's rotation for 2C, 6D (10.7)."""
    (row,) = kernel("modified_roll")(ratio, np.pad(np.array(coefficients), (0, 4 - len(coefficients))))
    return np.asarray(row).ravel()[1 : 1 + len(coefficients)]


def settings_table(x: np.ndarray) -> dict[str, Any]:
    """Settings and motion of one flank as its file has them, mm and degrees."""
    values = {
        name: math.degrees(value) if name in ANGULAR else float(value)
        for name, value in zip(SETTINGS, x[FIRST : FIRST + len(SETTINGS)], strict=True)
    }
    values["work_rotation_offset"] = math.remainder(values["work_rotation_offset"], 360.0)
    values["cradle_angle"] = math.remainder(values["cradle_angle"], 360.0)
    moving = dict(zip(MOVING, x[FIRST + len(SETTINGS) :], strict=False))
    motion: dict[str, tuple[float, ...]] = {}
    rows = np.array([moving["modified_roll_2"], moving["modified_roll_3"]])
    if rows.any():
        motion["modified_roll"] = tuple((rows / roll_rows(values["ratio_of_roll"], (1.0, 1.0))).tolist())
    if moving["helical_motion"]:
        motion["sliding_base"] = (float(moving["helical_motion"]),)
    return {**values, "motion": motion}


def with_flank(member: Member, name: str, x: np.ndarray) -> Member:
    """The member with the settings of one flank."""
    values = member.model_dump()
    values[name] = {**values[name], **settings_table(x)}
    return checked(values, Member, f"pinion {name} flank").named("pinion")

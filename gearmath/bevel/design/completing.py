"""A pinion that is cut completing, milled or hobbed: from the crown gear to both flanks that its sides ask for."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial import Polynomial

from gearmath.bevel.design import both_system as system
from gearmath.bevel.design.both_flanks import BothFlanks, FittedBoth, Side, local, moved, of_flank, whole
from gearmath.bevel.design.both_system import NAMES, FlankPoint, index
from gearmath.bevel.design.both_ways import LEAST_SHARE, best_way
from gearmath.bevel.design.designed_flank import DesignedFlank, FlankFit
from gearmath.bevel.design.local_settings import FIRST, ROOT
from gearmath.bevel.design.pinion import roll_rows, root_of
from gearmath.bevel.design.request import Request
from gearmath.bevel.design.rolling import Meeting
from gearmath.bevel.generation import Generation, Section, solve_curve, solve_section
from gearmath.bevel.method import blade_sections, generation_of, nominal_cut
from gearmath.bevel.root import FLAT_BLADE
from gearmath.bevel.tooth import mean_pitch_radius
from gearmath.bevel.turning import half_turn, turned
from gearmath.errors import ComputationError, InputError
from gearmath.specs.bevel_set import FLANKS, SETTINGS, SIDES, Member

#: Bounds of settings that the fit may move: pressure angles [rad], tilt [rad], 2C and 6D, motion of the
#: sliding base in mean transverse modules per rad.
_ANGLES, _TILT, _ROLL, _HELICAL = (math.radians(10), math.radians(30)), math.radians(25), (0.1, 0.7), 0.3
#: Least machine root angle [rad]: that of a tilted cutter is flatter than the root, to a Formate gear about level.
_FLATTEST = math.radians(-10)
#: By this part of the clearance the root may lie off that of the blank; more counts.
_ROOM = 0.15
#: Where the root is held, in parts of the face width: the root that a tilted cutter leaves is hollow.
_ROOT = (0.25, 0.75)
_OFFSET = SETTINGS.index("work_rotation_offset")
#: What is held where it is not left free.
_OPTIONAL = {
    "cutter_tilt": ("cutter_tilt", "cutter_swivel"),
    "modified_roll": ("modified_roll_2", "modified_roll_3"),
    "helical_motion": ("helical_motion",),
}

#: A cradle angle that the points of both flanks are cut so far from is moved to their middle [rad]; what goes with the
#: cradle rotation is a polynomial in it: by rising power, an empty name for a coefficient of 1.
_OFF_CENTER = math.radians(10)
_ALONG_ROLL = (
    ("cradle_angle", ""),
    ("sliding_base", "helical_motion"),
    ("work_rotation_offset", "ratio_of_roll", "modified_roll_2", "modified_roll_3"),
)


@dataclass(frozen=True)
class CompletingPinion:
    """Both flanks of a pinion as they were found: the vector of ``both_system.NAMES`` and how well it fits.

    ``shares`` are the parts of the places of each flank that are cut, ``contacts`` where, as the fit began; ``offsets``
    the work rotation offsets [rad], which differ where the blades of one flank follow those of the other.
    """

    problem: BothFlanks
    requests: dict[str, Request]
    fitted: FittedBoth
    contacts: tuple[np.ndarray, ...]
    shares: dict[str, float]
    offsets: dict[str, float]

    def flank(self, name: str) -> DesignedFlank:
        """One of the flanks."""
        fitted = FlankFit(self.fitted.off[name], self.fitted.active)
        x = of_flank(self.fitted.x, name)
        x[FIRST + _OFFSET] += self.offsets[name]
        return DesignedFlank(name, self.requests[name], x, fitted, self.shares[name])

    def refitted(self, names: Sequence[str], values: Sequence[float]) -> CompletingPinion:
        """The pinion with settings of ``NAMES`` held at values, all others found anew.

        Raises ComputationError where there are none.
        """
        left = tuple(one for one in self.problem.free if one not in names)
        problem = replace(self.problem, free=left)
        x = moved(problem, self.fitted.x, names, values)
        fitted = None if x is None else whole(problem, x, self.contacts)
        if fitted is None:
            raise ComputationError(f"pinion: no settings were found with {' and '.join(names)} in steps of the shop")
        return replace(self, problem=problem, fitted=fitted)

    def centered(self) -> CompletingPinion:
        """The same flanks, with the cradle angle in the middle of where their points are cut, if that lies far off.

        The cradle rotation then counts from elsewhere: what moves with it has the same values as before at every angle.
        """
        x = self.fitted.x.copy()
        off = float(np.mean([x[index("theta", flank)] for flank in FLANKS]))
        if abs(off) < _OFF_CENTER:
            return self
        for own in _ALONG_ROLL:
            places = [index(name) for name in own if name]
            known = np.array([x[index(name)] if name else 1.0 for name in own])
            x[places] = Polynomial(known)(Polynomial([off, 1.0])).coef[: len(places)]
        for flank in FLANKS:
            x[[index(name, flank) for name in ("theta", *ROOT[1::2])]] -= off
        bounds = np.column_stack([np.minimum(self.problem.bounds[:, 0], x), np.maximum(self.problem.bounds[:, 1], x)])
        contacts = tuple(contact - [0.0, 0.0, off] for contact in self.contacts)
        problem, fitted = replace(self.problem, bounds=bounds), replace(self.fitted, x=x)
        return replace(self, problem=problem, fitted=fitted, contacts=contacts)

    def with_settings(self, values: Mapping[str, float]) -> CompletingPinion:
        """The pinion with values of ``NAMES`` in place of what was found, nothing else changed."""
        x = self.fitted.x.copy()
        for name, value in values.items():
            x[NAMES.index(name)] = value
        return replace(self, fitted=replace(self.fitted, x=x))


def completing_pinion(
    start: Member, requests: Mapping[str, Request], free: tuple[str, ...], backlash: float
) -> CompletingPinion:
    """Both flanks from those of the crown gear, ``start``; ``requests`` by flank, ``backlash`` transverse [mm].

    Raises ComputationError where no settings of one machine give both sides what is asked for, InputError where they
    leave places uncut.
    """
    hows = {flank: generation_of(start, flank) for flank in FLANKS}
    turns = _turns(start, requests, backlash)
    # the blades of one flank may follow those of the other: its work rotation offset is taken out, and put back
    own = {flank: float(hows[flank].settings[_OFFSET]) for flank in FLANKS}
    sides = [_side(flank, _at_zero(hows[flank]), requests[flank], turns[flank] + own[flank]) for flank in FLANKS]
    cone, depth = root_of(start, _ROOT)
    x = _crown_gear(start, sides, cone)
    held = [name for option, names in _OPTIONAL.items() if option not in free for name in names]
    names = tuple(one for one in NAMES if one not in ("work_rotation_offset", *held))
    asked = requests[FLANKS[0]]
    half = math.pi / start.teeth
    problem = BothFlanks(
        (sides[0], sides[1]),
        cone,
        depth,
        names,
        _bounds(x, start),
        start.blank.face_width / 4,
        half**2 / 2 * abs(asked.roll.lever),
        _ROOM * start.blank.clearance,
    )
    # the parabolas come last: met before the rest of the flank they lead far away from the crown gear
    found = local(replace(problem, parabolas_held=False), x)
    if found is None:
        raise ComputationError(
            "pinion: no settings of one machine were found that give both flanks their points and parabolas; ask for "
            "paths nearer to 90 degrees, a smaller transmission error, or cutting = 'fixed_setting'"
        )
    best = best_way(start, problem, {flank: requests[flank].inner for flank in FLANKS}, found)
    lost = min(best.shares, key=lambda flank: best.shares[flank])
    if not best.shares[lost] >= LEAST_SHARE:
        raise InputError(
            f"{requests[lost].side}: {requests[lost].words}: settings of the pinion's {lost} flank were found for the "
            f"mean point, but they cut only {best.shares[lost]:.0%} of the places that its mate needs, which must be "
            f"at least {LEAST_SHARE:.0%}: the others lie below the tip of the blade or are undercut"
        )
    if best.fitted is None:
        raise ComputationError(
            "pinion: settings were found that give both flanks their points, but none with the parabolas that both "
            "sides ask for; ask for other paths, a longer pattern, or cutting = 'fixed_setting' in face milling"
        )
    return CompletingPinion(best.problem, dict(requests), best.fitted, best.contacts, best.shares, own)


def _at_zero(how: Generation) -> Generation:
    """The same with no work rotation offset."""
    settings = how.settings.copy()
    settings[_OFFSET] = 0.0
    return replace(how, settings=settings)


def _turns(start: Member, requests: Mapping[str, Request], backlash: float) -> dict[str, float]:
    """By which angle [rad] the points of each request are turned into the one frame of the member.

    At the gear's rotation zero both stand as the teeth of the gear have them; half of the backlash each away, and the
    tooth that is chosen, and its middle, are those of the crown gear.
    """
    wide = backlash / (2 * mean_pitch_radius(start)) * (-1 if start.hand == "right" else 1)
    found, own = {}, {}
    for flank in FLANKS:
        roll = requests[flank].roll
        point = roll.point
        at = nominal_cut(start, flank).at(point[2:3], np.array([math.hypot(point[0], point[1])]))
        if not at.converged.all():
            raise ComputationError(f"pinion {flank} flank: the crown gear has no point where contact is wanted")
        own[flank] = math.atan2(at.point[0, 1], at.point[0, 0]) - math.atan2(point[1], point[0])
        found[flank] = roll.turn / requests[flank].gear.ratio + SIDES[flank] * wide
    one, other = FLANKS
    pitch = 2 * math.pi / start.teeth
    apart = half_turn(found[other] - found[one] - own[other] + own[one])
    found[other] = found[one] + own[other] - own[one] + apart - pitch * round(apart / pitch)
    middle = sum(half_turn(own[flank] - found[flank] - own[one] + found[one]) for flank in FLANKS) / 2
    middle += own[one] - found[one]
    return {flank: found[flank] + middle for flank in FLANKS}


def _side(flank: str, how: Generation, asked: Request, turn: float) -> Side:
    """What is wanted of a flank, turned into the frame of the member."""
    roll, met = asked.roll, asked.meeting
    wanted = FlankPoint(
        turned(roll.point, turn),
        turned(roll.normal, turn),
        turned(roll.basis.T, turn).T,
        roll.gear_curvature,
        asked.curvature,
        roll.vector,
        roll.acceleration,
        roll.lever,
        asked.parabola,
    )
    meeting = Meeting(turned(met.point, turn), turned(met.normal, turn), met.rotation, met.lever)
    return Side(flank, how, wanted, meeting, asked.gap)


def _crown_gear(start: Member, sides: list[Side], cone: np.ndarray) -> np.ndarray:
    """The vector of the crown gear's settings, with its contacts at the wanted places and at the root."""
    x = np.zeros(len(NAMES))
    for side in sides:
        P = side.wanted.point
        section = blade_sections(start.flank(side.flank), SIDES[side.flank])["main"]
        at = solve_section(side.how, section, P[2:3], np.array([math.hypot(P[0], P[1])]))
        x[system.settings_index(side.flank)] = side.how.settings
        for name, value in zip(("u", "beta", "theta"), at.contact[0], strict=True):
            x[index(name, side.flank)] = value
        flat = Section(0.0, 1.0, float(side.how.settings[-2]), FLAT_BLADE)
        around = np.array([[0.0, *at.contact[0, 1:]]] * 2)
        root = solve_curve(side.how, flat, np.zeros(2), (math.cos(cone[0]), math.sin(cone[0])), cone[1:], around)
        x[[index(name, side.flank) for name in ROOT]] = root.contact[:, 1:].ravel()
    return x


def _bounds(x: np.ndarray, start: Member) -> np.ndarray:
    """Least and greatest values (35,2)."""
    bounds = np.tile([-np.inf, np.inf], (len(NAMES), 1))
    for flank in FLANKS:
        bounds[index("blade_pressure_angle", flank)] = _ANGLES
    bounds[index("cutter_tilt")] = -_TILT, _TILT
    bounds[index("machine_root_angle"), 0] = _FLATTEST
    base = _HELICAL * 2 * mean_pitch_radius(start) / start.teeth
    bounds[index("helical_motion")] = -base, base
    rows = roll_rows(float(x[index("ratio_of_roll")]), _ROLL)
    for name, most in zip(("modified_roll_2", "modified_roll_3"), rows, strict=True):
        bounds[index(name)] = -abs(most), abs(most)
    return bounds

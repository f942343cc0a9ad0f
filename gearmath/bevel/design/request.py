"""What one side of a pair asks of its pinion: the place of the contact, its curvature, the gap over the whole flank."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearmath.bevel.contact.local import MARKING
from gearmath.bevel.contact.report import ARCSEC
from gearmath.bevel.contact.surface import ContactSurface
from gearmath.bevel.design.rolling import GearFlank, Meeting, Roll
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import Blank, Member
from gearmath.specs.design import CROWNINGS, ContactRequest

#: Rows and columns of the gear's flank on which the gap is wanted, and heights at which its mate's tip is sought.
_ROWS, _COLUMNS, _HEIGHTS = 7, 13, 41
#: Parts of the height at which the vertex is tried, from, to and how many.
_TRIED = (0.2, 0.8, 7)
#: The middle of a flank reaches so far to either side, in parts of its width and of its height.
_INNER = 0.3
#: Path on the gear where none is asked for [degree]: it leans as lets one pair of teeth touch longest.
_PATH = {"drive": math.radians(50), "coast": math.radians(130)}
#: An ellipse whose length nobody asked for may get longer by this part of it.
_LONGER = 0.1


@dataclass(frozen=True)
class Request:
    """What is wanted of the pinion's flank of one ``side``.

    ``place`` z_w, r_w of the vertex on the gear [mm]; ``parabola`` m' [rad/rad²]; ``path_angle`` on the gear,
    ``own_path`` on the pinion [rad]; ``semi_axis`` [mm]; ``difference`` D (3,) and ``curvature`` K_2 + D (2,2) [1/mm];
    ``roll`` of chapter 26; ``meeting`` and ``gap`` [mm] at ``places`` z_w, r_w (n,) of the gear's flank that the
    pinion's tip reaches, which lie so far ``from_vertex`` in cone distance and height (n,) [mm]; ``inner`` (n,) are
    those about the middle. ``yielding`` is what the curvature across the path may lose
    [1/mm] where the whole flank needs it: nothing if the length of the ellipse is asked for. ``words`` are the keys of
    what is asked.
    """

    side: str
    gear: GearFlank
    roll: Roll
    place: tuple[float, float]
    parabola: float
    path_angle: float
    own_path: float
    semi_axis: float
    difference: np.ndarray
    curvature: np.ndarray
    meeting: Meeting
    gap: np.ndarray
    places: tuple[np.ndarray, np.ndarray]
    from_vertex: tuple[np.ndarray, np.ndarray]
    inner: np.ndarray
    yielding: float
    words: str


def request(
    side: str, asked: ContactRequest, gear: GearFlank, teeth: int, tip: np.ndarray, along_tooth: float = 0.5
) -> Request:
    """What is asked of a side. ``tip`` (4,) is the pinion's border there (25.4), ``along_tooth`` where the vertex lies
    from toe (0) to heel (1) if no position is asked for.

    Raises InputError where no pinion touches the gear as is asked, with the limit.
    """
    blank, surface = gear.surface.blank.vector, gear.surface
    path = _PATH[side] if asked.path_angle is None else asked.rad("path_angle")
    across = along_tooth if asked.position is None else asked.position[0]
    lowest = _reached(gear, across, tip)
    part = _middle(gear, across, lowest, path) if asked.position is None else asked.position[1]
    up = lowest + (1 - lowest) * part
    axial, radial = (float(value) for value in kernel("flank_place")(blank, across, up))
    roll = gear.roll(axial, radial)
    w = roll.vector
    if not math.isfinite(roll.acceleration):
        raise InputError(
            f"{side}: the gear's flank at {across:.0%} of the face width meets no pinion at the constant ratio, or "
            "is not cut there; another position, pressure angle, cutter_radius or more teeth are needed"
        )
    if asked.lengthwise_crowning is None:
        parabola = _parabola(side, asked.transmission_error / ARCSEC, teeth, roll)
        semi_axis = asked.pattern_length * surface.blank.face_width / 2
        given = (w, roll.acceleration, roll.lever)
        own = float(kernel("path_on_pinion")(*given, roll.sliding, parabola, path)[0])
        (D,) = kernel("synthesis")(*given, own, parabola, semi_axis, MARKING)
        _check_ellipse(side, asked, matrix(D), own, surface.blank.face_width)
        yielding = _yielding(asked, w, given[1:], own, parabola, semi_axis)
    else:
        D, own, path, parabola, semi_axis = _crowned(asked, roll, surface.blank)
        yielding = 0.0
    meeting, places, along, inner = _flank(gear, roll, lowest)
    off = _from_vertex(places, (axial, radial), surface.pitch_angle)
    if asked.lengthwise_crowning is None:
        lever = np.full(len(along), abs(roll.lever))
        (gap,) = kernel("wanted_gap")(meeting.rotation, along, D, w, roll.acceleration, np.abs(meeting.lever), lever)
    else:
        (gap,) = kernel("crowned_gap")(*off, *_crownings(asked, surface.blank))
    return Request(
        side,
        gear,
        roll,
        (axial, radial),
        parabola,
        path,
        own,
        semi_axis,
        D,
        roll.gear_curvature + matrix(D),
        meeting,
        gap,
        places,
        off,
        inner,
        yielding,
        _words(asked, path),
    )


def _words(asked: ContactRequest, path: float) -> str:
    """The keys of what is asked of a side, with their values."""
    given = {name: getattr(asked, name) for name in CROWNINGS}
    if asked.lengthwise_crowning is None:
        given = {
            "transmission_error": asked.transmission_error,
            "path_angle": math.degrees(path),
            "pattern_length": asked.pattern_length,
        }
    said = [f"{name} = {value:.6g}" for name, value in given.items()]
    if asked.position is not None:
        said.append(f"position = [{asked.position[0]:g}, {asked.position[1]:g}]")
    return ", ".join(said)


def _yielding(
    asked: ContactRequest, w: np.ndarray, roll: tuple[float, float], own: float, parabola: float, semi_axis: float
) -> float:
    """What the curvature across the path loses [1/mm] where the ellipse gets as much longer as it may."""
    if "pattern_length" in asked.model_fields_set:
        return 0.0
    axes = np.array([semi_axis, (1 + _LONGER) * semi_axis])
    here, there = (
        matrix(kernel("synthesis")(w, *roll, own, parabola, float(axis), MARKING)[0]).trace() for axis in axes
    )
    return float(here - there)


def _crowned(asked: ContactRequest, roll: Roll, blank: Blank) -> tuple[np.ndarray, float, float, float, float]:
    """D (3,) of the crownings, and what they make of path on pinion and gear [rad], parabola and half axis [mm]."""
    (D,) = kernel("crowned")(roll.vector, roll.acceleration, roll.sliding, roll.axial, *_crownings(asked, blank))
    velocity, second = kernel("contact_motion")(roll.vector, roll.acceleration, D, roll.lever)
    on_gear = velocity + roll.sliding
    (axes,) = kernel("contact_ellipse")(D, MARKING)
    own, path = (math.atan2(one[1], one[0]) for one in (velocity, on_gear))
    return D, own % math.pi, path % math.pi, float(second), float(np.max(axes))


def _crownings(asked: ContactRequest, blank: Blank) -> tuple[float, ...]:
    """Face width, working depth and the three crownings [mm]."""
    return (*face_and_depth(blank), *((getattr(asked, name) or 0.0) / 1000 for name in CROWNINGS))


def face_and_depth(blank: Blank) -> tuple[float, float]:
    """Face width and working depth [mm]."""
    return blank.face_width, blank.mean_addendum + blank.mean_dedendum - blank.clearance


def matrix(components: np.ndarray) -> np.ndarray:
    """The symmetric matrix (2,2) of its three components."""
    return components[[0, 1, 1, 2]].reshape(2, 2)


def _reached(gear: GearFlank, across: float, tip: np.ndarray) -> float:
    """The part of the gear's working depth from which on the pinion's tip reaches its flank."""
    up = np.linspace(0.0, 1.0, _HEIGHTS)
    places = kernel("flank_place")(gear.surface.blank.vector, np.full(_HEIGHTS, across), up)
    inside = _inside(gear.meeting(places[0], places[1], 0.0), tip)
    if not (inside > 0).any():
        return 0.0
    first = int(np.argmax(inside > 0))
    if first == 0:
        return 0.0
    below, above = inside[first - 1 : first + 1]
    if not math.isfinite(below):  # the gear is not cut there, or meets no pinion
        return float(up[first])
    return float(up[first - 1] + (up[first] - up[first - 1]) * below / (below - above))


def _middle(gear: GearFlank, across: float, lowest: float, path: float) -> float:
    """How high the vertex lies on the flank that the mate reaches so that both halves of a straight path last as long.

    Each height is tried: how far the pinion turns from there to the tip, and to the lower end, along the path.
    """
    blank, parts = gear.surface.blank, np.linspace(*_TRIED)
    places = kernel("flank_place")(blank.vector, np.full(2, across), np.array([lowest, 1.0]))
    depth = math.hypot(*(float(place[1] - place[0]) for place in places))
    lean = depth / math.tan(path) / blank.face_width
    ups = np.concatenate([lowest + (1 - lowest) * parts, np.ones_like(parts), np.full_like(parts, lowest)])
    shifts = np.concatenate([0 * parts, (1 - parts) * lean, -parts * lean])
    rotation = gear.meeting(*_place(blank.vector, across + shifts, ups), 0.0).rotation
    here, high, low = np.unwrap(rotation).reshape(3, -1)
    balance = high + low - 2 * here
    if not np.isfinite(balance).all() or balance[0] * balance[-1] >= 0:
        return 0.5
    order = np.argsort(balance)
    return float(np.interp(0.0, balance[order], parts[order]))


def _place(blank: np.ndarray, across: np.ndarray, up: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    axial, radial = kernel("flank_place")(blank, across, up)
    return axial, radial


def _inside(meeting: Meeting, tip: np.ndarray) -> np.ndarray:
    """Distance (n,) from the pinion's tip [mm], inside where positive."""
    return tip[1] * meeting.point[:, 2] + tip[2] * np.hypot(*meeting.point[:, :2].T) + tip[3]


def _from_vertex(
    places: tuple[np.ndarray, np.ndarray], vertex: tuple[float, float], pitch_angle: float
) -> tuple[np.ndarray, np.ndarray]:
    """How far places z_w, r_w (n,) of the gear lie from the vertex in cone distance and height (n,) [mm]."""
    z, r = (np.append(place, at) for place, at in zip(places, vertex, strict=True))
    along, deep = kernel("root_place")(np.stack([r, 0 * r, z], axis=1), pitch_angle)  # of radii, which have no sign
    return along[:-1] - along[-1], deep[-1] - deep[:-1]


def _flank(
    gear: GearFlank, roll: Roll, lowest: float
) -> tuple[Meeting, tuple[np.ndarray, np.ndarray], np.ndarray, np.ndarray]:
    """Conjugate places of the gear's flank above ``lowest``, z_w and r_w of each on the gear, how far along the tooth
    each lies [mm], and which are about the middle."""
    up, across = (
        one.ravel() for one in np.meshgrid(np.linspace(lowest, 1, _ROWS), np.linspace(0, 1, _COLUMNS), indexing="ij")
    )
    axial, radial = _place(gear.surface.blank.vector, across, up)
    found = gear.meeting(axial, radial, roll.turn)
    kept = np.isfinite(found.point).all(axis=1)
    found = Meeting(*(array[kept] for array in vars(found).values()))
    inner = (np.abs(across - 0.5) < _INNER) & (np.abs((up - lowest) / (1 - lowest) - 0.5) < _INNER)
    return found, (axial[kept], radial[kept]), (found.point - roll.point) @ roll.basis[:, 0], inner[kept]


def _parabola(side: str, amplitude: float, teeth: int, roll: Roll) -> float:
    """m' [rad/rad²] for an amplitude [rad]. Raises InputError where no contact has such a parabola."""
    found, unit = (float(kernel("wanted_parabola")(one, teeth, roll.lever)[0]) for one in (amplitude, 1.0))
    most = roll.acceleration / (unit * roll.lever)  # there s of (26.6) vanishes
    if not amplitude < most:
        raise InputError(
            f"{side}: transmission_error = {amplitude * ARCSEC:g}: must be below {most * ARCSEC:.4g} arcsec, where the "
            "flanks would no longer roll on each other"
        )
    return found


def _check_ellipse(side: str, asked: ContactRequest, D: np.ndarray, own: float, face_width: float) -> None:
    """The path needs a curvature along it, and the ellipse must be longer than that alone makes it."""
    along = np.array([math.cos(own), math.sin(own)])
    least = 2 * math.sqrt(2 * MARKING / float(along @ D @ along)) / face_width
    if not asked.pattern_length > least:
        raise InputError(
            f"{side}: pattern_length = {asked.pattern_length:g}: must be above {least:.4g} with this path and "
            f"transmission_error = {asked.transmission_error:g}; the path may come nearer to 90 degrees instead"
        )


def gear_flank(surface: ContactSurface, pinion: Member, shaft_angle: float) -> GearFlank:
    """The gear's flank in its pair; ``shaft_angle`` in degrees."""
    blank = pinion.blank
    return GearFlank(
        surface,
        math.radians(shaft_angle),
        pinion.teeth / surface.teeth,
        blank.delta,
        blank.mean_cone_distance,
        blank.pitch_apex_beyond_crossing_point,
    )

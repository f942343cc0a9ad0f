"""The dimensions of a hobbed gear that people set and measure: swivel, blank, span, chord, and over pins."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import casadi as ca

from gearmath.gearbox.kernels import evaluate, kernel

#: Usual pin diameter in modules.
PIN = 1.68


@dataclass(frozen=True)
class Gear:
    """An involute gear: normal module [mm], normal pressure angle and helix angle [rad], shift in modules."""

    teeth: int
    module: float
    alpha: float
    beta: float = 0.0
    shift: float = 0.0


@dataclass(frozen=True)
class Span:
    """Span over ``teeth`` teeth [mm], and the face width that it needs [mm]."""

    teeth: int
    length: float
    face_width: float


@dataclass(frozen=True)
class Chord:
    """Chordal thickness and the height of the tip above it [mm]."""

    thickness: float
    height: float


@dataclass(frozen=True)
class OverPins:
    """Measurement over two pins of ``pin`` mm (balls, for an odd number of helical teeth) [mm]."""

    pin: float
    length: float


@dataclass(frozen=True)
class Undercut:
    """Teeth below which the hob undercuts the flanks (30.13), and the profile shift in modules that avoids it."""

    least_teeth: float
    needed_shift: float


@dataclass(frozen=True)
class Swivel:
    """Lead angle of the hob and swivel of its axis [degrees], counter-clockwise seen from hob to work."""

    lead_angle: float
    swivel: float


def blank_diameter(gear: Gear) -> float:
    """Outside diameter [mm]."""
    return evaluate("helical_blank", gear.teeth, gear.module, gear.beta, gear.shift)[0]


def straight_height(
    module: float, alpha: float, addendum: float, tip_radius: float, protuberance: float, protuberance_angle: float
) -> float:
    """How far above its reference cylinder the edge of a hob is straight [mm] (30.12, 30.20); lengths [mm]."""
    tip = (addendum, tip_radius, protuberance)
    if not protuberance:
        return evaluate("hob_form", module, *tip, alpha)[0]
    return evaluate("protuberance_form", *tip, alpha, protuberance_angle)[0]


def undercut(gear: Gear, height: float) -> Undercut | None:
    """None where a hob whose edge is straight up to ``height`` [mm] leaves the whole involute (30.13)."""
    shape = (gear.module, gear.alpha, gear.beta)
    none, whole, least = (evaluate("undercut_teeth", height, *shape, x)[0] for x in (0.0, 1.0, gear.shift))
    if gear.teeth >= least:
        return None
    return Undercut(least, (none - gear.teeth) / (none - whole))  # it is linear in the shift


def span(gear: Gear, involute_from: float = 0.0) -> Span | None:
    """The span that touches nearest to the middle of the flanks; None where no span lies on them.

    The flanks are involutes from the radius ``involute_from`` [mm] on.
    """
    (best,) = evaluate("span_teeth", gear.teeth, gear.alpha, gear.beta, gear.shift)
    if not math.isfinite(best):
        return None
    k = max(2, round(best))
    shape = (gear.module, gear.alpha, gear.beta, gear.shift)
    length, touched, face_width = evaluate("span_measurement", k, gear.teeth, *shape)
    if k >= gear.teeth or not 2 * involute_from <= touched < blank_diameter(gear):
        return None
    return Span(k, length, face_width)


def chord(gear: Gear) -> Chord:
    """Chordal thickness and height at the reference cylinder."""
    shape = (gear.module, gear.alpha, gear.beta, gear.shift)
    _, _, thickness, height = evaluate("chordal_thickness", gear.teeth, *shape)
    return Chord(thickness, height)


def over_pins(gear: Gear, pin: float | None = None, involute_from: float = 0.0) -> OverPins | None:
    """Measurement over pins of diameter ``pin`` [mm], 1.68 modules if not given.

    None where such pins do not touch the flanks, which are involutes from the radius ``involute_from`` [mm] on, or
    vanish below the tips.
    """
    size = PIN * gear.module if pin is None else pin
    touched = pin_contact(gear, size)
    if touched is None or touched.radius < involute_from:
        return None
    return OverPins(size, touched.over_pins)


@dataclass(frozen=True)
class PinContact:
    """Where pins touch the flanks: pressure angle at the middle of the pin [rad]; length of roll, radius, M [mm]."""

    angle: float
    roll_length: float
    radius: float
    over_pins: float


def pin_contact(gear: Gear, pin: float) -> PinContact | None:
    """Contact of pins of diameter ``pin`` [mm]; None as for :func:`over_pins`."""
    shape = (gear.module, gear.alpha, gear.beta)
    parameters = (pin, gear.teeth, *shape, gear.shift)
    if evaluate("pin_equation", 0.0, *parameters)[0] >= 0.0:
        return None  # inv of the pin angle would not be positive: the pin does not enter
    angle = float(_pin_angle()(_ABOVE, ca.vertcat(*parameters)))
    length, contact, touched = evaluate("over_pins", angle, gear.teeth % 2, pin, gear.teeth, *shape)
    outside = blank_diameter(gear)
    if contact <= 0.0 or touched >= outside or length <= outside:
        return None
    return PinContact(angle, contact / 2, touched / 2, length)


#: The residual (9.12) rises and curves upwards: Newton's method falls monotonically to the root from above it.
_ABOVE = 1.45


@cache
def _pin_angle() -> ca.Function:
    """Root of (9.12): (start, the other arguments) to the pin angle [rad]."""
    residual = kernel("pin_equation")
    angle, parameters = ca.SX.sym("angle"), ca.SX.sym("parameters", len(residual.inputs) - 1)
    problem = {"x": angle, "p": parameters, "g": residual.function(angle, *ca.vertsplit(parameters))}
    return ca.rootfinder("pin_angle", "newton", problem, {"abstol": 1e-14, "max_iter": 100})


def swivel(gear: Gear, hob_sign: int, helix_sign: int, starts: int, hob_diameter: float) -> Swivel:
    """How the hob must stand; ``hob_diameter`` is its reference diameter [mm]."""
    angles = evaluate("swivel", hob_sign, helix_sign, starts, gear.module, gear.beta, hob_diameter)
    lead_angle, stands = (math.degrees(angle) for angle in angles)
    return Swivel(lead_angle, stands)

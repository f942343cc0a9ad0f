"""Check dimensions: published examples to the digits printed, and measurements on a gear built point by point."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq, minimize

from gearmath.gearbox.dimensions import Gear, blank_diameter, chord, over_pins, pin_contact, span, swivel, undercut

ALPHA = math.radians(20.0)


def test_published_span():
    """SDP/SI handbook: m = 3, z = 24, x = 0.4: 32.8266 mm over 4 teeth."""
    measured = span(Gear(24, 3.0, ALPHA, shift=0.4))
    assert measured is not None
    assert (measured.teeth, f"{measured.length:.4f}", measured.face_width) == (4, "32.8266", 0.0)


def test_published_chordal_thickness():
    """SDP/SI handbook, table 10-1: m = 10, z = 12, x = 0.3: 17.8256 mm, 13.6657 mm below the tip."""
    measured = chord(Gear(12, 10.0, ALPHA, shift=0.3))
    assert (f"{measured.thickness:.4f}", f"{measured.height:.4f}") == ("17.8256", "13.6657")


def test_published_measurement_over_pins():
    """m = 1, z = 20, pins of 1.68 mm: 22.22489 mm."""
    measured = over_pins(Gear(20, 1.0, ALPHA), 1.68)
    assert measured is not None
    assert f"{measured.length:.5f}" == "22.22489"


def test_blanks():
    """(z + 2)/P in inches; a right-angled helix of 60 degrees doubles the reference diameter."""
    assert blank_diameter(Gear(30, 25.4 / 32, ALPHA)) == pytest.approx(25.4, rel=1e-14)
    assert blank_diameter(Gear(20, 1.5, ALPHA, math.radians(60), 0.25)) == pytest.approx(60 + 3 + 0.75, rel=1e-14)


def test_undercut_begins_below_the_published_teeth_and_ends_at_the_published_shift():
    """x = 1 - z sin^2(alpha)/2 of every handbook: 0.2981 for 12 teeth; 17 teeth are short of 17.097, 18 are not."""
    small = undercut(Gear(12, 2.0, ALPHA), 2.0)
    assert small is not None
    assert (f"{small.least_teeth:.3f}", f"{small.needed_shift:.4f}") == ("17.097", "0.2981")
    assert undercut(Gear(17, 2.0, ALPHA), 2.0) is not None
    assert undercut(Gear(18, 2.0, ALPHA), 2.0) is None
    assert undercut(Gear(12, 2.0, ALPHA, shift=0.2982), 2.0) is None
    assert undercut(Gear(12, 2.0, ALPHA, math.radians(30)), 2.0) is None  # 11.54 teeth


def test_pins_that_would_rest_where_the_hob_has_cut_the_involute_away_measure_nothing():
    """4 teeth, m = 1: the formula touches at 1.912 mm, where a generated profile has lost 66 um of flank."""
    few = Gear(4, 1.0, ALPHA)
    assert pin_contact(few, 1.68).radius == pytest.approx(1.912, abs=2e-3)
    assert over_pins(few) is not None
    assert over_pins(few, involute_from=2.01) is None


# --- a gear, point by point ---------------------------------------------------------------------------------------


class Helicoid:
    """The flank at +y of the tooth space about the x axis: involutes of the base circle, turned along the lead."""

    def __init__(self, gear: Gear) -> None:
        self.reference = gear.teeth * gear.module / math.cos(gear.beta) / 2
        transverse = math.atan2(math.tan(gear.alpha), math.cos(gear.beta))
        self.base = self.reference * math.cos(transverse)
        self.twist = math.tan(gear.beta) / self.reference  # rad per mm of height
        # on the reference circle a tooth and a space make a pitch; the shift widens the tooth
        thickness = math.pi / 2 + 2 * gear.shift * math.tan(gear.alpha)
        space = (math.pi - thickness) * gear.module / math.cos(gear.beta)
        self.start = space / 2 / self.reference - (math.tan(transverse) - transverse)

    def point(self, roll: float, height: float) -> np.ndarray:
        """The point unrolled by ``roll`` in the section at ``height``."""
        at = self.start + roll + self.twist * height
        radial, tangent = np.array([math.cos(at), math.sin(at), 0.0]), np.array([-math.sin(at), math.cos(at), 0.0])
        return self.base * (radial - roll * tangent) + np.array([0.0, 0.0, height])

    def distance(self, center: np.ndarray) -> float:
        """From a point to the flank."""

        def squared(at: np.ndarray) -> float:
            return float(((self.point(at[0], at[1]) - center) ** 2).sum())

        roll = math.sqrt(max(float(center @ center) / self.base**2 - 1, 0.0))
        bounds = [(0.0, roll), (-self.base, self.base)]
        found = minimize(
            squared, [roll, 0.0], method="Nelder-Mead", bounds=bounds, options={"xatol": 1e-9, "fatol": 1e-15}
        )
        return math.sqrt(found.fun)


@pytest.mark.parametrize(
    "gear",
    [
        Gear(20, 1.0, ALPHA),
        Gear(30, 1.0, ALPHA, math.radians(20)),
        Gear(24, 2.0, ALPHA, math.radians(35), 0.3),
        Gear(12, 1.0, math.radians(14.5), math.radians(10), 0.2),
    ],
)
def test_ball_in_a_space_touches_the_flank_of_the_solid(gear):
    """A ball on the middle of the space, just as far out as the measurement says, is its radius from the helicoid."""
    measured = over_pins(gear)
    assert measured is not None
    flank, radius = Helicoid(gear), measured.pin / 2
    outwards = brentq(
        lambda x: flank.distance(np.array([x, 0.0, 0.0])) - radius,
        flank.reference + gear.shift * gear.module,
        flank.reference + 3 * gear.module,
    )
    assert measured.length == pytest.approx(2 * outwards + measured.pin, abs=1e-6)


def test_odd_gear_is_measured_across_the_corner():
    """The pins of an odd gear stand 180° - 180°/z apart: a chord, not a diameter."""
    odd = over_pins(Gear(21, 1.0, ALPHA), 1.68)
    assert odd is not None
    flank = Helicoid(Gear(21, 1.0, ALPHA))
    x = brentq(lambda x: flank.distance(np.array([x, 0.0, 0.0])) - 0.84, flank.reference, flank.reference + 2.0)
    first, second = (x * np.array([math.cos(a), math.sin(a)]) for a in (0.0, math.pi - math.pi / 21))
    assert odd.length == pytest.approx(float(np.linalg.norm(first - second)) + 1.68, abs=1e-6)


@pytest.mark.parametrize("beta", [0.0, 0.35])
def test_span_is_the_distance_of_two_parallel_planes_on_the_base_cylinder(beta):
    """The common normal of two flanks lies on a plane that touches the base cylinder, over k - 1 base pitches and one
    base thickness; both taken from the transverse section of the solid."""
    gear = Gear(31, 2.0, ALPHA, beta, 0.2)
    measured = span(gear)
    assert measured is not None
    flank = Helicoid(gear)
    pitch = 2 * math.pi / gear.teeth
    thickness = (pitch - 2 * flank.start) * flank.base  # base circle, transverse
    along = (measured.teeth - 1) * pitch * flank.base + thickness
    base_helix = math.atan(math.tan(beta) * flank.base / flank.reference)
    assert measured.length == pytest.approx(along * math.cos(base_helix), rel=1e-12)
    assert measured.face_width == pytest.approx(measured.length * math.sin(base_helix), abs=1e-9)


def test_swivel_of_a_spur_gear_is_the_lead_angle_with_the_sign_of_the_hob():
    """asin(1 x 1 / 50) = 1.14599°; two starts, about twice that."""
    spur = Gear(30, 1.0, ALPHA)
    right, left = swivel(spur, 1, 1, 1, 50.0), swivel(spur, -1, 1, 1, 50.0)
    assert right.lead_angle == pytest.approx(1.14599, abs=1e-5)
    assert (right.swivel, left.swivel) == (right.lead_angle, -right.lead_angle)
    assert swivel(spur, 1, 1, 2, 50.0).lead_angle == pytest.approx(2.29244, abs=1e-5)


def test_swivel_of_a_helix_is_less_for_the_same_hand_and_more_for_the_opposite():
    gear = Gear(30, 1.0, ALPHA, math.radians(20.0))
    sizes = {(hob, helix): swivel(gear, hob, helix, 1, 50.0).swivel for hob in (1, -1) for helix in (1, -1)}
    assert sizes[1, 1] == -sizes[-1, -1] == pytest.approx(-(20.0 - 1.14599), abs=1e-5)
    assert sizes[1, -1] == -sizes[-1, 1] == pytest.approx(20.0 + 1.14599, abs=1e-5)


@pytest.mark.parametrize("gear", [Gear(1, 1.0, ALPHA, shift=-0.4), Gear(2, 1.0, ALPHA), Gear(4, 1.0, ALPHA)])
def test_where_no_span_lies_on_the_flanks_there_is_none(gear):
    measured = span(gear)
    assert measured is None or measured.length < blank_diameter(gear)
    if gear.teeth <= 2:
        assert measured is None


@pytest.mark.parametrize("pin", [0.1, 0.8, 4.0])
def test_pins_too_thin_or_too_thick_give_no_measurement(pin):
    """Too thin, and they drown in the space; too thick, and they stand on the tips."""
    assert over_pins(Gear(20, 1.0, ALPHA), pin) is None

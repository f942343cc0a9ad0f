"""The bundled set and NASA CR-191009 (Bibel, Reddy, Kumar 1994): settings, blank, and the first point of each flank.

The report prints settings with 7 to 12 digits and, of every flank, the point that toe and root line share, in inch.
Its program had fixed iteration counts and some single precision: another solver meets the printed points to 8.2e-8 in.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, solve_places
from gearmath.specs.bevel_set import SETTINGS, SIDES

INCH = 25.4
TOLERANCE = 1e-7 * INCH  # mm
MEAN_CONE_DISTANCE, FACE_WIDTH = 3.191, 1.0
#: Pitch, addendum and dedendum angle [degrees], clearance [inch].
BLANK = {
    "pinion": (18.4333333, 3.8833334, 1.56666666, 0.03),
    "gear": (71.5666666, 1.5666666, 3.8833333333, 0.0366),
}
#: r, q, psi, s, m_cw, E_m, L_m; inch and degrees.
PRINTED = {
    ("pinion", "concave"): (
        2.96562137806,
        63.9420304635,
        161.954330248,
        2.94780202969,
        0.30838512709,
        0.154575896,
        0.0384999977874,
    ),
    ("pinion", "convex"): (
        3.071306157,
        53.9259945467,
        24.337423854,
        2.80104946,
        0.3220428536,
        -0.17426159493,
        -0.0518138227,
    ),
    ("gear", "concave"): (3.0325, 59.2342023, 158, 2.85995004691, 0.9508646, 0, 0),
    ("gear", "convex"): (2.9675, 59.2342023, 22, 2.85995004691, 0.9508646, 0, 0),
}
POINT = {
    ("pinion", "concave"): (0.7948185893337920, 0.1518771876505158, 2.565573009266192),
    ("pinion", "convex"): (0.7093463178422439, 0.3893983454546772, 2.565573009266191),
    ("gear", "concave"): (2.474433967420987, -0.3395653327372070, 0.9856358798469023),
    ("gear", "convex"): (2.487328996883535, -0.2265447761173172, 0.9856358798469033),
}
#: Mean point [mm], unit normal into the metal, pressure and spiral angle [degrees]: no figures of the report, but of
#: its matrices and its closed form of meshing, solved with these settings by another program.
MEAN = {
    ("pinion", "concave"): (
        (25.3740614705, -3.6026122209, 76.8928321213),
        (-0.031132804324, 0.783057773210, 0.621169278306),
        19.27384719,
        35.24621333,
    ),
    ("pinion", "convex"): (
        (25.3676223671, 3.6476767625, 76.8928321213),
        (-0.433649074852, -0.822702197936, -0.367572541672),
        23.70769370,
        34.71717186,
    ),
    ("gear", "concave"): (
        (76.8019250715, -3.7379045021, 25.6285352137),
        (0.325620502097, -0.766379749453, 0.553744858434),
        24.24966429,
        34.69525743,
    ),
    ("gear", "convex"): (
        (76.8041959969, 3.6909486632, 25.6285352137),
        (-0.657930576611, 0.738039423745, 0.149750343433),
        19.79546867,
        35.20926128,
    ),
}

each_flank = pytest.mark.parametrize("case", list(PRINTED), ids=" ".join)


def toe_root(member: str) -> tuple[float, float]:
    """z and radius [inch] of the printed point, by the report's formula: on the root cone, the clearance above it."""
    mu, _, dedendum, clearance = BLANK[member]
    gamma = math.radians(mu - dedendum)
    along = (MEAN_CONE_DISTANCE - FACE_WIDTH / 2) * math.cos(math.radians(dedendum))
    z = along * math.cos(gamma) - clearance * math.sin(gamma)
    return z, z * math.tan(gamma) + clearance / math.cos(gamma)


def as_printed(gear_set, case) -> np.ndarray:
    """The bundled settings without the turn that makes the pinion's flanks bound a space, not a tooth."""
    settings = gear_set.member(case[0]).flank(case[1]).vector.copy()
    settings[SETTINGS.index("work_rotation_offset")] = 0.0
    return settings


def solved(gear_set, case, z: float, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Point and outward normal at a place [mm]."""
    points, residual = solve_places(as_printed(gear_set, case), SIDES[case[1]], np.array([z]), np.array([radius]))
    assert residual.max() < 1e-9
    return points.point[0], points.normal[0]


@each_flank
def test_bundled_settings_are_the_printed_ones(gear_set, case):
    r, q, psi, s, m_cw, E_m, L_m = PRINTED[case]
    mu, _, dedendum, _ = BLANK[case[0]]
    G = math.radians(mu - dedendum)
    expected = {
        "radial_distance": s * INCH,
        "cradle_angle": math.radians(-q if case[0] == "pinion" else q),
        "cutter_tilt": 0.0,
        "cutter_swivel": 0.0,
        "blank_offset": E_m * INCH,
        "sliding_base": L_m * INCH * math.tan(G),
        "machine_center_to_crossing_point": L_m * INCH / math.cos(G),
        "machine_root_angle": G,
        "ratio_of_roll": 1 / m_cw,
        "work_rotation_offset": 0.0,
        "blade_point_radius": r * INCH,
        "blade_pressure_angle": math.radians(180 - psi if psi > 90 else psi),
    }
    ours = as_printed(gear_set, case)
    np.testing.assert_allclose(ours, [expected[name] for name in SETTINGS], rtol=0, atol=1e-12)


@pytest.mark.parametrize("member", BLANK)
def test_bundled_blank_is_the_printed_one(gear_set, member):
    """Dedendum out of its angle; the addendum up to the root cone of the mate, less the clearance there."""
    blank, mate = gear_set.member(member).blank, "gear" if member == "pinion" else "pinion"
    mu, addendum, dedendum, clearance = BLANK[member]
    assert (blank.pitch_angle, blank.face_width) == (mu, INCH)
    assert blank.mean_cone_distance == pytest.approx(3.191 * INCH, abs=1e-12)
    assert blank.face_angle == pytest.approx(mu + addendum, abs=1e-12)
    assert blank.root_angle == pytest.approx(mu - dedendum, abs=1e-12)
    assert blank.clearance == pytest.approx(clearance * INCH, abs=1e-12)
    assert blank.mean_dedendum == pytest.approx(81.0514 * math.tan(math.radians(dedendum)), abs=1e-12)
    _, _, faced, gap = BLANK[mate]
    to_root = 81.0514 * math.tan(math.radians(faced))
    assert blank.mean_addendum == pytest.approx(to_root - gap * INCH / math.cos(math.radians(faced)), abs=1e-12)


@pytest.mark.parametrize("member", BLANK)
def test_corner_of_the_grid_without_margins_is_the_place_of_the_printed_point(gear_set, member):
    """Toe and lower limit of the usable flank. Toe and clearance are square to the root cone in the report, and square
    to the pitch cone here: by hand, c (1 - cos d) less height and r tan d sin d - c sin d further along the root."""
    grid = blank_grid(gear_set.member(member), 2, 2, 0.0)
    z, radius = (INCH * value for value in toe_root(member))
    mu, _, dedendum, clearance = BLANK[member]
    gamma, d, c = math.radians(mu - dedendum), math.radians(dedendum), clearance * INCH
    beside = grid.axial[0, 0] - z, grid.radial[0, 0] - radius
    lower = beside[0] * math.sin(gamma) - beside[1] * math.cos(gamma)
    further = beside[0] * math.cos(gamma) + beside[1] * math.sin(gamma)
    toe = (MEAN_CONE_DISTANCE - FACE_WIDTH / 2) * INCH
    assert lower == pytest.approx(c * (1 - math.cos(d)), abs=1e-9)
    assert further == pytest.approx(toe * math.tan(d) * math.sin(d) - c * math.sin(d), abs=1e-9)


@each_flank
def test_printed_first_point_is_met(gear_set, case):
    """Along each axis, to 1e-7 in."""
    point, _ = solved(gear_set, case, *(INCH * value for value in toe_root(case[0])))
    np.testing.assert_allclose(point, np.array(POINT[case]) * INCH, rtol=0, atol=TOLERANCE)


@each_flank
def test_mean_point_normal_and_angles_are_those_of_the_closed_form(gear_set, case):
    """Pressure angle asin |n · cone normal|, spiral angle atan(|n · generatrix| / |n · circumference|)."""
    position, into_metal, pressure, spiral = MEAN[case]
    point, normal = solved(gear_set, case, position[2], math.hypot(*position[:2]))
    np.testing.assert_allclose(point, position, rtol=0, atol=1e-7)
    np.testing.assert_allclose(-normal, into_metal, rtol=0, atol=1e-9)
    generatrix = point / np.linalg.norm(point)
    around = np.cross([0, 0, 1], point) / math.hypot(*point[:2])
    over = abs(normal @ np.cross(generatrix, around))
    found = math.asin(over), math.atan2(abs(normal @ generatrix), abs(normal @ around))
    assert np.degrees(found) == pytest.approx((pressure, spiral), abs=1e-7)


@each_flank
def test_printed_first_point_lies_at_its_printed_place(case):
    x, y, z = POINT[case]
    assert (z, math.hypot(x, y)) == pytest.approx(toe_root(case[0]), abs=1e-7)


def test_convex_flank_of_the_pinion_is_turned_by_one_pitch(gear_set):
    """As printed the pinion's flanks bound a tooth; φ_0 = 30° turns the convex one by -30° to bound a space."""
    printed = np.array(POINT["pinion", "convex"]) * INCH
    place = np.array([printed[2]]), np.array([math.hypot(*printed[:2])])
    ours, _ = solve_places(gear_set.pinion.convex.vector, -1, *place)
    c, s = math.cos(math.pi / 6), -math.sin(math.pi / 6)
    turned = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    np.testing.assert_allclose(ours.point[0], turned @ printed, rtol=0, atol=TOLERANCE)

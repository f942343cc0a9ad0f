"""The published gear set: NASA TP-3096 / TM-105150 (Handschuh, Litvin 1991), 12 x 36 teeth, face milled.

Settings and start values as published there, in inch and degrees, with fewer digits than the bundled set, which takes
those of NASA CR-191009 (test_nasa_cr191009.py). The mean points are no published figures: they were computed once with
another program, an envelope solver without the equation of meshing. The radius 2.9656 in of the pinion's concave flank
is published to four decimals only, which is what its larger tolerance is for.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy as sp

from derivations import flank as flank_chapter
from derivations import meshing as meshing_chapter
from gearmath.bevel.flank import FlankPoints, solve_places
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import SETTINGS, SIDES

INCH = 25.4
#: mu and d: pitch and dedendum angle.
ANGLES = {"pinion": (18.4333, 1.5666), "gear": (71.5666, 3.8833)}
#: h = +1 pinion, left hand; -1 gear, right hand.
HAND = {"pinion": 1, "gear": -1}
COLUMNS = ("r", "psi", "L_m", "E_m", "s", "q", "m_cw", "u", "theta", "phi")
PUBLISHED = {
    ("pinion", "concave"): (
        2.9656,
        161.9543,
        0.038499,
        0.154576,
        2.947802,
        63.94,
        0.30838513,
        9.59703,
        126.83544,
        -0.85813,
    ),
    ("pinion", "convex"): (
        3.0713,
        24.33741,
        -0.051814,
        -0.1742616,
        2.8010495,
        53.926,
        0.32204285,
        7.42534,
        124.43689,
        -11.38663,
    ),
    ("gear", "concave"): (3.0325, 158.0, 0, 0, 2.85995, 59.234203, 0.950864, 8.12602, 233.9899, -0.35063),
    ("gear", "convex"): (2.9675, 22.0, 0, 0, 2.85995, 59.234203, 0.950864, 7.89156, 234.9545, -12.3384),
}
#: Residual of the published closed form at the published start values, in inch, as recomputed to two digits.
RESIDUAL = {
    ("pinion", "concave"): 1.0e-4,
    ("pinion", "convex"): 2.4e-6,
    ("gear", "concave"): -4.6e-6,
    ("gear", "convex"): 2e-6,
}
#: Toe point, axial and radius in mm: one for both flanks of a member.
TOE = {"pinion": (65.1657, 20.5534), "gear": (25.0350, 63.4396)}
#: Mean point in mm, unit normal into the metal, pressure and spiral angle in degrees.
MEAN = {
    ("pinion", "concave"): (
        (25.3740301095, -3.5993645803, 76.8915188471),
        (-0.031230444433, 0.783062233383, 0.621158754257),
        19.27366683,
        35.24542432,
    ),
    ("pinion", "convex"): (
        (25.3670231786, 3.6484194437, 76.8915188471),
        (-0.43361623245, -0.822722821424, -0.367565126289),
        23.70753408,
        34.71643802,
    ),
    ("gear", "concave"): (
        (76.8005227546, -3.7387827695, 25.6281819101),
        (0.325603814823, -0.766388458226, 0.553742617893),
        24.24963244,
        34.69472032,
    ),
    ("gear", "convex"): (
        (76.8028878818, 3.6898787234, 25.6281819101),
        (-0.657913564893, 0.73805394103, 0.149753535048),
        19.7955445,
        35.2086364,
    ),
}

each_flank = pytest.mark.parametrize("case", list(PUBLISHED), ids=" ".join)


def published(case) -> dict[str, float]:
    values = dict(zip(COLUMNS, PUBLISHED[case], strict=True))
    return {name: math.radians(v) if name in ("psi", "q", "theta", "phi") else v for name, v in values.items()}


def tolerance_inch(case, concave_pinion: float, others: float) -> float:
    return concave_pinion if case == ("pinion", "concave") else others


def converted(case) -> dict[str, float]:
    """Our settings from the published ones: mm and rad, work rotation offset zero."""
    v, (mu, d) = published(case), np.radians(ANGLES[case[0]])
    return {
        "radial_distance": v["s"] * INCH,
        "cradle_angle": -HAND[case[0]] * v["q"],
        "cutter_tilt": 0.0,
        "cutter_swivel": 0.0,
        "blank_offset": v["E_m"] * INCH,
        "sliding_base": v["L_m"] * INCH * math.tan(mu - d),
        "machine_center_to_crossing_point": v["L_m"] * INCH / math.cos(mu - d),
        "machine_root_angle": mu - d,
        "ratio_of_roll": 1 / v["m_cw"],
        "work_rotation_offset": 0.0,
        "blade_point_radius": v["r"] * INCH,
        "blade_pressure_angle": math.pi - v["psi"] if v["psi"] > math.pi / 2 else v["psi"],
    }


def start_values(case) -> tuple[float, float, float]:
    """u, beta, theta of ours at the published toe point: the height is that of the cone point above the tip plane."""
    v = published(case)
    above = v["u"] * math.cos(v["psi"]) - v["r"] / math.tan(v["psi"])
    return abs(above) * INCH, v["theta"], HAND[case[0]] * v["phi"]


def settings_of(case) -> np.ndarray:
    """The published settings as our vector (12,), mm and rad."""
    ours = converted(case)
    return np.array([ours[name] for name in SETTINGS])


def chain(case) -> np.ndarray:
    """The published matrices M_wa M_ap M_pm M_ms M_sc r_c, multiplied at the published start values [inch]."""
    v, h = published(case), HAND[case[0]]
    mu, d = np.radians(ANGLES[case[0]])
    phi, q, s, psi, w = v["phi"], v["q"], v["s"], v["psi"], h * v["phi"] / v["m_cw"]
    sin, cos = np.sin, np.cos
    across = v["u"] * sin(psi)
    r_c = [v["r"] / math.tan(psi) - v["u"] * cos(psi), across * sin(v["theta"]), across * cos(v["theta"]), 1]
    M_sc = [[1, 0, 0, 0], [0, cos(q), -h * sin(q), -h * s * sin(q)], [0, h * sin(q), cos(q), s * cos(q)], [0, 0, 0, 1]]
    M_ms = [[1, 0, 0, 0], [0, cos(phi), h * sin(phi), 0], [0, -h * sin(phi), cos(phi), 0], [0, 0, 0, 1]]
    M_pm = [
        [cos(d), 0, -sin(d), -v["L_m"] * sin(d)],
        [0, 1, 0, v["E_m"]],
        [sin(d), 0, cos(d), v["L_m"] * cos(d)],
        [0, 0, 0, 1],
    ]
    M_ap = [[cos(mu), 0, sin(mu), 0], [0, 1, 0, 0], [-sin(mu), 0, cos(mu), 0], [0, 0, 0, 1]]
    M_wa = [[cos(w), sin(w), 0, 0], [-sin(w), cos(w), 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    return (np.linalg.multi_dot([np.array(m, float) for m in (M_wa, M_ap, M_pm, M_ms, M_sc)]) @ r_c)[:3]


def mean_point(case) -> FlankPoints:
    """The solver's point on the pitch cone at the mean cone distance."""
    (x, y, z), *_ = MEAN[case]
    points, residual = solve_places(settings_of(case), SIDES[case[1]], np.array([z]), np.array([math.hypot(x, y)]))
    assert residual.max() < 1e-9
    return points


def mean_angles(case) -> tuple[float, float]:
    """Pressure and spiral angle [degrees] on the pitch cone at the mean point."""
    points = mean_point(case)
    point, normal = points.point[0], points.normal[0]
    generatrix = point / np.linalg.norm(point)
    circumference = np.cross([0, 0, 1], point) / math.hypot(point[0], point[1])
    cone = np.cross(generatrix, circumference)
    pressure = math.degrees(math.asin(abs(normal @ cone)))
    spiral = math.degrees(math.atan2(abs(normal @ generatrix), abs(normal @ circumference)))
    return pressure, spiral


@each_flank
def test_bundled_set_is_the_same_pair_printed_with_more_digits(gear_set, case):
    """To one unit of the last digit of TP-3096, which cuts some digits off and rounds others."""
    spec, v, G = gear_set.member(case[0]).flank(case[1]), published(case), math.radians(ANGLES[case[0]][0])
    G -= math.radians(ANGLES[case[0]][1])
    psi = 180 - spec.blade_pressure_angle if case[1] == "concave" else spec.blade_pressure_angle
    ours = {
        "r": spec.blade_point_radius / INCH,
        "psi": psi,
        "L_m": spec.machine_center_to_crossing_point * math.cos(G) / INCH,
        "E_m": spec.blank_offset / INCH,
        "s": spec.radial_distance / INCH,
        "q": -HAND[case[0]] * spec.cradle_angle,
        "m_cw": 1 / spec.ratio_of_roll,
    }
    last = {"r": 1e-4, "psi": 1e-4, "L_m": 1e-6, "E_m": 1e-6, "s": 1e-6, "q": 1e-2, "m_cw": 1e-6}
    for name, value in ours.items():
        given = math.degrees(v[name]) if name in ("psi", "q") else v[name]
        assert value == pytest.approx(given, abs=last[name]), name


@each_flank
def test_published_start_values_satisfy_the_lowered_equation_of_meshing(case):
    (residual,) = kernel("meshing")(*start_values(case), settings_of(case), SIDES[case[1]])
    inch = residual * published(case)["m_cw"] / INCH  # the closed form is ours times m_cw
    assert abs(inch) < tolerance_inch(case, 2e-4, 1e-5)
    assert inch == pytest.approx(RESIDUAL[case], rel=0.06)


@each_flank
def test_published_start_values_satisfy_the_published_closed_form(case):
    h = HAND[case[0]]
    *_, symbols = flank_chapter.nasa_family(h)
    values = {**published(case), **dict(zip(("mu", "d"), np.radians(ANGLES[case[0]]), strict=True))}
    closed_form = sp.lambdify([symbols[name] for name in values], meshing_chapter.nasa_closed_form(h, symbols))
    inch = closed_form(**{symbols[name].name: value for name, value in values.items()})
    assert abs(inch) < tolerance_inch(case, 2e-4, 1e-5)
    (ours,) = kernel("meshing")(*start_values(case), settings_of(case), SIDES[case[1]])
    assert inch == pytest.approx(float(ours) * values["m_cw"] / INCH, abs=1e-9)


@each_flank
def test_opposite_sense_of_the_work_rotation_is_far_from_meshing(case):
    settings = settings_of(case)
    settings[SETTINGS.index("ratio_of_roll")] *= -1
    (residual,) = kernel("meshing")(*start_values(case), settings, SIDES[case[1]])
    assert 4.2 <= abs(residual) / INCH <= 4.5  # in/rad


@each_flank
def test_family_at_the_published_start_values_is_the_published_chain_and_the_toe_point(case):
    point, _ = kernel("flank_family")(*start_values(case), settings_of(case), SIDES[case[1]])
    np.testing.assert_allclose(point, chain(case) * INCH, rtol=0, atol=1e-8)
    axial, radius = TOE[case[0]]
    off = np.hypot(point[2] - axial, math.hypot(point[0], point[1]) - radius)
    assert off < tolerance_inch(case, 2e-4, 2e-5) * INCH


@each_flank
def test_solver_finds_the_toe_point_where_it_was_published(case):
    """The point of the flank at the published place is the published one, along all three directions."""
    expected = chain(case) * INCH
    place = np.array([expected[2]]), np.array([math.hypot(expected[0], expected[1])])
    points, residual = solve_places(settings_of(case), SIDES[case[1]], *place)
    assert residual.max() < 1e-9
    assert np.linalg.norm(points.point[0] - expected) < tolerance_inch(case, 2e-4, 2e-5) * INCH


@each_flank
def test_mean_point_and_its_normal(case):
    points = mean_point(case)
    position, into_metal, *_ = MEAN[case]
    np.testing.assert_allclose(points.point[0], position, rtol=0, atol=1e-7)  # mm
    np.testing.assert_allclose(-points.normal[0], into_metal, rtol=0, atol=1e-9)


@each_flank
def test_pressure_and_spiral_angle_at_the_mean_point(case):
    """asin |n · cone normal| and atan(|n · generatrix| / |n · circumference|) on the pitch cone."""
    assert mean_angles(case) == pytest.approx(MEAN[case][2:], abs=1e-5)


def test_mating_flanks_agree_in_their_angles():
    """Concave of one with convex of the other: within 0.55 degrees in pressure, 0.04 degrees in spiral angle."""
    for first, second in (("concave", "convex"), ("convex", "concave")):
        pinion, gear = (mean_angles(case) for case in (("pinion", first), ("gear", second)))
        assert abs(pinion[0] - gear[0]) < 0.55
        assert abs(pinion[1] - gear[1]) < 0.04

"""Transmission error and place of contact beside surfaces that are rolled on each other; outcomes; conjugate pairs."""

from __future__ import annotations

import math

import casadi as ca
import numpy as np
import pytest

from gearmath.bevel.contact.mesh import Mesh, mesh
from gearmath.bevel.contact.report import ARCSEC, SIDES, figures, side_mesh, side_system
from gearmath.bevel.contact.surface import displaced_surface
from gearmath.bevel.contact.system import Assembly, pair_system
from gearmath.specs.bevel_set import FLANKS, BevelSet, Motion, load_bevel_set
from gearmath.specs.toml import bundled

DISPLACED = {"V": 0.2, "H": -0.15, "J": 0.1, "shaft": math.radians(0.1)}
NASA, FORMATE, HOBBED, UNIVERSAL = (
    "nasa_tp3096_12x36",
    "crown_gear_formate_14x39",
    "crown_gear_hobbed_14x39",
    "crown_gear_universal_14x39",
)
#: Rotations of three pitches, in pitches: none of them a round part of one.
ROTATIONS = (-1.37, -0.63, -0.21, 0.32, 1.44)


def same_as_rolled(run: Mesh, witness) -> int:
    """How many rotations the witness could tell, all within 1e-3 arcsec and 1 µm."""
    told = 0
    for part in ROTATIONS:
        rotation = part * run.system.pitch
        found = witness.first(rotation)
        if found is None:
            continue
        turn, distance, height = found
        (row,) = run.rows(np.array([rotation]))
        assert abs(row.error - run.system.ratio * rotation - turn) * ARCSEC < 1e-3, part
        assert math.hypot(row.cone_distance - distance, row.height - height) < 1e-3, part
        told += 1
    return told


@pytest.mark.parametrize("assembly", [{}, DISPLACED], ids=["true", "displaced"])
@pytest.mark.parametrize("side", SIDES)
def test_nasa_pair_runs_as_its_rolled_surfaces(side: str, assembly: dict, rolling) -> None:
    pair = load_bevel_set(bundled(f"{NASA}.toml"))
    witness = rolling(pair, SIDES[side], **assembly)
    assert same_as_rolled(side_mesh(pair, side, Assembly(**assembly)), witness) == len(ROTATIONS)


@pytest.mark.parametrize(("name", "side"), [(FORMATE, "coast"), (HOBBED, "drive"), (UNIVERSAL, "coast")])
def test_other_methods_run_as_their_rolled_surfaces(name: str, side: str, rolling) -> None:
    pair = load_bevel_set(bundled(f"{name}.toml"))
    witness = rolling(pair, SIDES[side], lowest=0.2, **DISPLACED)
    assert same_as_rolled(side_mesh(pair, side, Assembly(**DISPLACED)), witness) >= 3


@pytest.mark.parametrize("side", SIDES)
def test_crowned_pair_runs_as_its_rolled_surfaces(side: str, rolling, uniform_pair) -> None:
    pair = uniform_pair(CROWNED[side], BENT)
    witness = rolling(pair, SIDES[side], lowest=0.35)
    assert same_as_rolled(side_mesh(pair, side, Assembly()), witness) >= 3


@pytest.mark.parametrize("side", SIDES)
def test_pinion_with_deviations_runs_as_its_rolled_surface(side: str, rolling, gear_set: BevelSet) -> None:
    # a cubic surface of up to some 20 µm, as a measured flank may have
    def deviation(axial, radial):
        x, y = (axial - 77.0) / 10, (radial - 25.6) / 5
        return 0.008 * x - 0.006 * y + 0.004 * x**2 - 0.005 * x * y + 0.003 * y**2 + 0.002 * x**3

    place = ca.SX.sym("place", 2)
    smooth = ca.Function("deviation", [place[0], place[1]], [deviation(place[0], place[1])])
    nominal = side_system(gear_set, side)
    system = pair_system(displaced_surface(nominal.pinion, smooth), nominal.gear, nominal.shaft_angle)
    witness = rolling(gear_set, SIDES[side], deviation=deviation, **DISPLACED)
    assert same_as_rolled(mesh(system, Assembly(**DISPLACED)), witness) == len(ROTATIONS)


@pytest.mark.parametrize("side", SIDES)
def test_nasa_pair_has_a_reversed_parabola_and_runs_on_edges(side: str, gear_set: BevelSet) -> None:
    run = side_mesh(gear_set, side, Assembly())
    assert run.outcome == "reversed parabola"
    assert "edge" in run.leads.kinds


#: Cutter radii of the pinion that crown its flanks along the tooth, and radius of blades that crown its profile.
CROWNED, BENT = {"drive": 103.0, "coast": 97.0}, -800.0


@pytest.mark.parametrize("side", SIDES)
def test_pair_crowned_along_the_tooth_alone_runs_without_error(side: str, uniform_pair) -> None:
    # the profiles stay conjugate where the flanks touch
    run = side_mesh(uniform_pair(CROWNED[side]), side, Assembly())
    assert run.outcome == "interior contact"
    assert run.leads.peak_to_peak * ARCSEC < 1e-5


@pytest.mark.parametrize("side", SIDES)
def test_pair_crowned_both_ways_lags_by_its_parabola(side: str, uniform_pair) -> None:
    run = side_mesh(uniform_pair(CROWNED[side], BENT), side, Assembly())
    assert run.outcome == "interior contact"
    _, here = run.at_mean
    assert run.system.sense * here.second_derivative < 0
    about = abs(here.second_derivative) / 2 * (run.system.pitch / 2) ** 2
    assert run.leads.peak_to_peak == pytest.approx(about, rel=0.2)


def test_peak_to_peak_is_that_of_the_first_of_all_pairs(gear_set: BevelSet) -> None:
    # sampled afresh from the positions of one pair, by the rule that the pair furthest ahead carries
    run = side_mesh(gear_set, "drive", Assembly())
    pitch, parts = run.system.pitch, 400
    rotations = np.arange(-3 * parts // 2, 3 * parts // 2 + 1) * (pitch / parts)
    lead = np.full(len(rotations), -np.inf)
    for row in run.rows(rotations):
        lead[round(row.rotation / pitch * parts) + 3 * parts // 2] = run.system.sense * row.error
    envelope = np.max([lead[k * parts : (k + 1) * parts] for k in range(3)], axis=0)
    assert run.leads.peak_to_peak == pytest.approx(np.ptp(envelope), abs=0.2 / ARCSEC)


@pytest.mark.parametrize("side", SIDES)
def test_pair_of_uniform_depth_from_one_crown_gear_touches_along_lines(side: str, uniform_pair) -> None:
    run = side_mesh(uniform_pair(), side, Assembly())
    check_line_contact(run)


@pytest.mark.parametrize("side", SIDES)
def test_formate_gear_with_its_own_generator_touches_along_lines(side: str) -> None:
    pair = load_bevel_set(bundled(f"{FORMATE}.toml"))
    mating = FLANKS[1 - FLANKS.index(SIDES[side])]
    spec = pair.gear.flank(mating)
    conjugate = {
        **conjugate_generator(spec, 1 if mating == "concave" else -1),
        "ratio_of_roll": 39 / 14,
        "motion": Motion(),
    }
    own = pair.pinion.flank(SIDES[side]).model_copy(update=conjugate)
    pinion = pair.pinion.model_copy(update={SIDES[side]: own})
    # a lower gear: the tip of this one would be conjugate to what the untilted pinion undercuts
    blank = pair.gear.blank.model_copy(update={"mean_addendum": 0.5 * pair.gear.blank.mean_addendum})
    pair = pair.model_copy(update={"gear": pair.gear.model_copy(update={"blank": blank})})
    check_line_contact(side_mesh(pair.model_copy(update={"pinion": pinion}), side, Assembly()))


def check_line_contact(run) -> None:
    assert run.outcome == "line contact"
    found = run.places
    error, lever = found.error[found.common], found.lever[found.common]
    assert np.ptp(error) * np.abs(lever).max() < 1e-9
    result = figures(run, math.radians(1))
    errors = [row["transmission_error_arcsec"] for row in result["path"]]
    assert len(errors) > 20
    assert np.abs(errors).max() < 1e-5
    assert result["peak_to_peak_arcsec"] < 1e-5
    assert result["contact_ratio"] > 1


def conjugate_generator(spec, side: int) -> dict[str, float]:
    """Settings of a pinion's machine whose cradle axis is the gear's axis: the gear's cutter, from its other side.

    The cradle axis points from the gear's back to its apex, so that the gear's own axis is its opposite. Lengths in mm.
    """
    gamma, swing = math.radians(spec.machine_root_angle), math.radians(spec.cradle_angle)
    S, alpha, depth = spec.radial_distance, math.radians(spec.blade_pressure_angle), 20.0
    work = np.array([math.cos(gamma), 0, math.sin(gamma)])
    center = work * spec.machine_center_to_crossing_point - np.array([0, 0, 1]) * spec.sliding_base
    center = center + np.array([S * math.cos(swing), spec.blank_offset + S * math.sin(swing), 0])
    center = center - depth * np.array([0, 0, 1])  # the tip plane of the blades seen from the other side
    # axes of the cradle in the gear's machine: k against the gear's axis, i the pinion's axis over the mean point
    k, i = -work, np.array([math.sin(gamma), 0, -math.cos(gamma)])
    j = np.cross(k, i)
    x, y, z = (float(axis @ center) for axis in (i, j, k))
    axis = np.array([i @ [0, 0, -1], j @ [0, 0, -1], k @ [0, 0, -1]])
    q = math.atan2(y, x)
    return {
        "radial_distance": math.hypot(x, y),
        "cradle_angle": math.degrees(q),
        "sliding_base": -z,
        "cutter_tilt": math.degrees(math.acos(axis[2])),
        "cutter_swivel": math.degrees(math.atan2(axis[1], axis[0]) + math.pi / 2 - q),
        "blank_offset": 0.0,
        "machine_center_to_crossing_point": 0.0,
        "machine_root_angle": 0.0,
        "blade_point_radius": spec.blade_point_radius + side * depth * math.tan(alpha),
        "blade_pressure_angle": spec.blade_pressure_angle,
        "blade_profile_height": 60.0,
    }

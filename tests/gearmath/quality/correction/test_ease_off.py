"""Errors moved to the mate, against the pair itself: both members turned through mesh, and the least gap found."""

from __future__ import annotations

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.generation import solve_section
from gearmath.bevel.identify.flank_target import predicted
from gearmath.bevel.method import blade_sections, cut_generation_of
from gearmath.bevel.nominal_file import flank_header
from gearmath.errors import ComputationError, InputError
from gearmath.quality.correction.ease_off import conjugate_places, moved_to_mate
from gearmath.quality.correction.member import correct
from gearmath.quality.correction.target import target_of
from gearmath.specs.bevel_set import FLANKS, SETTINGS, load_bevel_set
from gearmath.specs.flank_csv import flank_file, join
from gearmath.specs.toml import bundled

SETS = ("nasa_tp3096_12x36", "crown_gear_formate_14x39", "crown_gear_hobbed_14x39")
each_set = pytest.mark.parametrize("set_name", SETS)
#: Errors of the gear's flanks of some 20 um. [mm, rad]
ERRORS = {"sliding_base": 0.03, "radial_distance": -0.05, "cradle_angle": 2e-4, "machine_root_angle": 3e-4}


def errors(scale=1.0):
    return scale * np.array([ERRORS.get(name, 0.0) for name in SETTINGS])


def pair_of(set_name):
    return load_bevel_set(bundled(f"{set_name}.toml"))


def measured(header, member, name, change):
    """The file of a member whose machine was off by ``change`` (12,), on the grid of its flanks."""
    files = []
    for flank in FLANKS:
        nominal = solve_flank(member, flank, blank_grid(member))
        target = target_of(member, flank, nominal)
        deviation, _ = predicted(target, target.settings + change)
        row, col = (index.ravel() for index in np.indices((5, 9)))
        point = nominal.point + deviation[:, None] * nominal.normal
        files.append(flank_file(header(member, name), name, flank, 0, row, col, point, nominal.normal, deviation))
    return join(files)


@pytest.fixture
def header():
    return lambda member, name: flank_header(member, (5, 9), 0.1)


def azimuth(member, flank, change, axial, radial, start):
    """Angle of the flank of changed settings about the member's axis at places (n,)."""
    how = cut_generation_of(member, flank)
    section = blade_sections(member.flank(flank), how.side)["main"]
    settings = how.settings + change
    points = solve_section(
        type(how)(settings, how.side, how.motion, how.index_ratio, how.blade_offset_angle, how.rolling),
        section,
        axial,
        radial,
        start,
    )
    assert points.converged.all()
    return np.unwrap(np.arctan2(points.point[:, 1], points.point[:, 0]))


@each_set
def test_deviation_at_the_conjugate_place_is_what_closes_the_gap_of_the_turning_pair(set_name):
    """No equation of meshing: a pinion point goes round, its place in the gear is met by the gear's own surface.

    The angle between them is least where they would touch; what errors of the gear change of that least angle is, along
    the normal, the deviation that the gear has there.
    """
    pair, flank, other = pair_of(set_name), "convex", "concave"
    sigma, ratio = np.radians(pair.shaft_angle), pair.pinion.teeth / pair.gear.teeth
    gear = solve_flank(pair.gear, flank, blank_grid(pair.gear))
    target = target_of(pair.gear, flank, gear)
    deviation, _ = predicted(target, target.settings + errors())
    k = 22  # the middle
    axial, radial = conjugate_places(pair, pair.gear, pair.pinion, gear.point[[k]], gear.normal[[k]])
    start = solve_flank(pair.pinion, other, blank_grid(pair.pinion)).contact[22]
    how = cut_generation_of(pair.pinion, other)
    section = blade_sections(pair.pinion.flank(other), how.side)["main"]
    (p,) = solve_section(how, section, axial, radial, start[None]).point
    moment = np.cross(gear.point[k], gear.normal[k])

    def gap(change, turns):
        """Angle about the gear's axis from the point to the gear's flank, for angles of the pinion (n,)."""
        az = np.arctan2(p[1], p[0]) + turns
        r = np.hypot(p[0], p[1])
        # pinion axis at sigma from the gear's, towards +x of the gear; azimuth zero looks towards the gear's axis
        across = np.array([-np.cos(sigma), 0, np.sin(sigma)])
        along = np.array([np.sin(sigma), 0, np.cos(sigma)])
        at = p[2] * along + r * (np.cos(az)[:, None] * across + np.sin(az)[:, None] * np.array([0, -1, 0]))
        z, rho = at[:, 2], np.hypot(at[:, 0], at[:, 1])
        surface = azimuth(pair.gear, flank, change, z, rho, np.tile(gear.contact[k], (len(turns), 1)))
        return surface - (np.arctan2(at[:, 1], at[:, 0]) + ratio * (az - np.arctan2(p[1], p[0])))

    around = -np.arctan2(p[1], p[0]) + np.linspace(-0.2, 0.2, 161)
    least = []
    for one in (gap(errors(size), around) for size in (0.0, 1.0)):
        slope = np.diff(one)
        (j,) = np.flatnonzero(slope[1:] * slope[:-1] < 0) + 1  # one turning point, where they touch
        a, b, c = one[j - 1], one[j], one[j + 1]
        least.append(b - (a - c) ** 2 / (8 * (a - 2 * b + c)))
    # a deviation t along the normal turns the gear's flank by t over its lever
    shift = (least[1] - least[0]) * moment[2]
    assert abs(deviation[k]) > 5e-3
    assert shift == pytest.approx(deviation[k], rel=0.02)


@each_set
def test_gear_errors_are_corrected_on_the_pinion_alone(header, set_name):
    """A perfect pinion is given the errors that the gear has at the conjugate places, with the other sign, and nothing
    but what its settings cannot follow is left of them."""
    pair = pair_of(set_name)
    gear, pinion = measured(header, pair.gear, "gear", errors()), measured(header, pair.pinion, "pinion", 0 * errors())
    moved = moved_to_mate(pair, "gear", gear, pinion)
    correction = correct(pair.pinion, pinion, added=moved)
    for flank in FLANKS:
        target = target_of(pair.pinion, flank, solve_flank(pair.pinion, flank, blank_grid(pair.pinion)))
        cut, _ = predicted(target, correction.settings[flank])
        asked = moved[flank]
        assert np.abs(asked).max() > 5e-3
        assert np.sqrt(np.mean((cut + asked) ** 2)) < 0.1 * np.sqrt(np.mean(asked**2))


def test_smooth_errors_are_interpolated_to_a_tenth_of_a_micrometre(header):
    """The gear's own deviation, solved at places conjugate to the pinion's grid, against what came over."""
    pair = pair_of("nasa_tp3096_12x36")
    pinion = measured(header, pair.pinion, "pinion", 0 * errors())
    moved = moved_to_mate(pair, "gear", measured(header, pair.gear, "gear", errors()), pinion)["concave"]
    nominal = solve_flank(pair.gear, "convex", blank_grid(pair.gear, 9, 17))
    axial, radial = conjugate_places(pair, pair.gear, pair.pinion, nominal.point, nominal.normal)
    target = target_of(pair.gear, "convex", nominal)
    deviation, _ = predicted(target, target.settings + errors())
    grid = blank_grid(pair.pinion)
    for k in range(45):
        near = np.argsort(np.hypot(axial - grid.axial.ravel()[k], radial - grid.radial.ravel()[k]))[:6]
        # a plane through the neighbours: good to their spacing squared
        plane = np.stack([np.ones(6), axial[near], radial[near]], axis=1)
        fit = np.linalg.lstsq(plane, deviation[near], rcond=None)[0]
        if np.hypot(axial[near[0]] - grid.axial.ravel()[k], radial[near[0]] - grid.radial.ravel()[k]) < 0.7:
            value = fit @ [1, grid.axial.ravel()[k], grid.radial.ravel()[k]]
            assert moved[k] == pytest.approx(value, abs=3e-4)


def test_file_of_the_wrong_member_and_a_pair_that_does_not_mesh_are_refused(header):
    pair = pair_of("nasa_tp3096_12x36")
    pinion = measured(header, pair.pinion, "pinion", 0 * errors())
    with pytest.raises(InputError, match="member = 'pinion' in the measured file: must be 'gear'"):
        moved_to_mate(pair, "gear", pinion, pinion)
    gear = solve_flank(pair.gear, "convex", blank_grid(pair.gear))
    with pytest.raises(ComputationError, match=r"point \d+ does not meet the mate"):
        conjugate_places(pair, pair.gear, pair.pinion, gear.point * [1, 1, 3], gear.normal)


def test_conjugate_places_do_not_depend_on_where_the_apexes_are_counted():
    """One pair, the apex of each member put elsewhere on its axis: the places move along with it."""
    pair = pair_of("nasa_tp3096_12x36")
    flank = solve_flank(pair.gear, "convex", blank_grid(pair.gear))
    axial, radial = conjugate_places(pair, pair.gear, pair.pinion, flank.point, flank.normal)
    gear, pinion = (
        member.model_copy(
            update={"blank": member.blank.model_copy(update={"pitch_apex_beyond_crossing_point": beyond})}
        )
        for member, beyond in ((pair.gear, 0.3), (pair.pinion, -0.2))
    )
    moved = conjugate_places(pair, gear, pinion, flank.point + np.array([0.0, 0.0, 0.3]), flank.normal)
    np.testing.assert_allclose(moved, (axial - 0.2, radial), rtol=0, atol=1e-9)

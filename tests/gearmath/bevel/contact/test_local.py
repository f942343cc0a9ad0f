"""Curvature, path, parabola and ellipse at a contact, beside finite differences; signs of V, H, J by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from gearmath.bevel.contact.local import MARKING, local, roll
from gearmath.bevel.contact.mesh import mesh
from gearmath.bevel.contact.misalignment import contact_at, sensitivities
from gearmath.bevel.contact.report import ARCSEC, SIDES, side_mesh, side_system
from gearmath.bevel.contact.surface import ContactSurface
from gearmath.bevel.contact.system import Assembly, System
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import BevelSet, load_bevel_set
from gearmath.specs.toml import bundled

FORMATE, HOBBED = "crown_gear_formate_14x39", "crown_gear_hobbed_14x39"
DISPLACED = Assembly(0.2, -0.15, 0.1, math.radians(0.1))


def second_difference(value, step: float) -> float:
    """Second derivative at zero of a function, by two central differences and Richardson's rule."""
    coarse, fine = ((value(h) - 2 * value(0.0) + value(-h)) / h**2 for h in (step, step / 2))
    return (4 * fine - coarse) / 3


def slope(value, step: float):
    coarse, fine = ((value(h) - value(-h)) / (2 * h) for h in (step, step / 2))
    return (4 * fine - coarse) / 3


def contact_of(name: str, side: str):
    """A contact within both flanks, at the assembly that brings it to the mean point."""
    system = side_system(load_bevel_set(bundled(f"{name}.toml")), side)
    found = contact_at(system, system.gear.blank.mean_cone_distance, J=0.1, shaft=math.radians(0.1))
    assembly = Assembly(found.V, found.H, 0.1, math.radians(0.1)).vector
    return system, found.touch, assembly


@pytest.mark.parametrize("name", ["nasa_tp3096_12x36", FORMATE, HOBBED])
@pytest.mark.parametrize("side", SIDES)
def test_second_derivative_is_that_of_differences(name: str, side: str) -> None:
    system, touch, assembly = contact_of(name, side)

    def turn(by: float) -> float:
        return float(system.solve(touch.x + by * touch.tangent, touch.rotation + by, (), assembly).x[6])

    found = local(system, touch, assembly).second_derivative
    assert found == pytest.approx(second_difference(turn, 0.02), rel=1e-5, abs=1e-9)


@pytest.mark.parametrize("name", ["nasa_tp3096_12x36", FORMATE, HOBBED])
@pytest.mark.parametrize("side", SIDES)
def test_ellipse_is_that_of_the_gap_between_the_flanks(name: str, side: str) -> None:
    system, touch, assembly = contact_of(name, side)
    frames = [placed(system, k, touch, assembly) for k in range(2)]
    r, n = frames[1](touch.x[3:6])
    t = np.cross(n, [0.0, 0.0, 1.0])
    tangents = np.stack([t / np.linalg.norm(t), np.cross(n, t / np.linalg.norm(t))])

    def gap(p: float, s: float) -> float:
        """Along the normal, over a point of the tangent plane."""
        over = [
            height(frames[k], touch.x[3 * k : 3 * k + 3], r, n, tangents, (p, s), surface_of(system, k))
            for k in range(2)
        ]
        return over[0] - over[1]

    h = 0.1
    along, across = second_difference(lambda a: gap(a, 0), h), second_difference(lambda a: gap(0, a), h)
    diagonal = second_difference(lambda a: gap(a, a), h)
    mixed = (diagonal - along - across) / 2
    values = np.linalg.eigvalsh([[along, mixed], [mixed, across]])
    wanted = np.sqrt(2 * MARKING / values)
    assert local(system, touch, assembly).semi_axes == pytest.approx(list(wanted), rel=1e-5)


def surface_of(system: System, side: int) -> ContactSurface:
    return (system.pinion, system.gear)[side]


def placed(system: System, side: int, touch, assembly: np.ndarray):
    """Point and outward normal of a flank in the pair, by rotations written out here."""
    turn = (touch.rotation, touch.x[6])[side] + system.phase[side]
    V, H, J, shaft = assembly
    c, s = math.cos(turn), math.sin(turn)
    rotation = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    sigma = system.shaft_angle + shaft
    axes = np.array([[math.cos(sigma), 0, math.sin(sigma)], [0, 1, 0], [-math.sin(sigma), 0, math.cos(sigma)]])

    def at(w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        point, normal, *_ = (np.asarray(one).ravel() for one in surface_of(system, side).function(w))
        if side == 0:
            return rotation @ point + [0, 0, H], rotation @ normal
        return axes @ (rotation @ point + [0, 0, J]) + [0, V, 0], axes @ rotation @ normal

    return at


def height(at, w, r, n, tangents, over, surface: ContactSurface) -> float:
    """Height over the tangent plane at which a flank stands over a point of it, by Newton with differences."""
    w = np.array(w)

    def miss(w: np.ndarray) -> np.ndarray:
        point, _ = at(w)
        return np.array([*(tangents @ (point - r) - over), float(surface.function(w)[2])])

    for _ in range(12):
        step = 1e-6
        J = np.stack([(miss(w + step * e) - miss(w - step * e)) / (2 * step) for e in np.eye(3)], axis=1)
        w = w - np.linalg.solve(J, miss(w))
    assert np.abs(miss(w)).max() < 1e-11
    return float(n @ (at(w)[0] - r))


@pytest.mark.parametrize("offset", [0.0, 20.0, -13.0])
def test_path_and_parabola_of_two_quadrics_are_those_of_differences(offset: float, gear_set: BevelSet) -> None:
    # surfaces known in closed form, in contact at rotation zero: nothing of any cutter is in it
    r, n = np.array([20.0, 6.0, 72.0]), np.array([0.35, -0.86, 0.3712])
    n /= np.linalg.norm(n)  # out of the gear
    t = np.cross(n, [0.0, 0.0, 1.0])
    T = np.stack([t / np.linalg.norm(t), np.cross(n, t / np.linalg.norm(t))])
    bend = np.array([[[0.05, 0.012], [0.012, 0.02]], [[0.004, 0.003], [0.003, -0.006]]])
    axes = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])  # of the gear, at 90 degrees
    surfaces = []
    for side, K in enumerate(bend):
        w = ca.SX.sym("w", 3)
        plane = T.T @ w[:2]
        sag = (K[0, 0] * w[0] ** 2 + 2 * K[0, 1] * w[0] * w[1] + K[1, 1] * w[1] ** 2) / 2
        point = r + plane + sag * n
        rates = ca.jacobian(point, w)[:, :2]
        cross = ca.cross(rates[:, 0], rates[:, 1])
        normal = cross / ca.norm_2(cross)
        normal = normal * (1 if side else -1) * math.copysign(1, float(np.cross(T[0], T[1]) @ n))
        if side:
            point, normal = axes.T @ (point - np.array([0, offset, 0])), axes.T @ normal
        function = ca.Function("quadric", [w], [point, normal, w[2], ca.SX(1)])
        blank = (gear_set.gear if side else gear_set.pinion).blank
        surfaces.append(ContactSurface(function, np.zeros((4, 4)), lambda *_: None, blank, (12, 36)[side]))
    system = System(surfaces[0], surfaces[1], math.pi / 2, offset)
    system.__dict__["sense"] = 1.0
    still = np.zeros(4)
    touch = system.solve(np.zeros(7), 0.0, (), still)
    assert np.abs(touch.x).max() < 1e-12

    def moved(by: float) -> np.ndarray:
        return system.solve(by * touch.tangent, by, (), still).x

    found = local(system, touch, still)
    assert found.second_derivative == pytest.approx(second_difference(lambda a: moved(a)[6], 2e-3), rel=1e-6)
    speed = slope(moved, 1e-3)  # u, β are lengths in the tangent planes
    assert found.path_speed == pytest.approx(float(np.hypot(*speed[3:5])), rel=1e-6)
    values = np.linalg.eigvalsh(bend[0] - bend[1])
    assert found.semi_axes == pytest.approx(list(np.sqrt(2 * MARKING / values)), rel=1e-9)
    # the way back: from the direction of the path, the parabola and the ellipse to the curvatures
    w, beta, D, lever, *_ = (one.ravel() for one in roll(system).at(touch.x, 0.0, still))
    velocity, second = kernel("contact_motion")(w, beta[0], D, lever[0])
    direction = math.atan2(velocity[1], velocity[0])
    (back,) = kernel("synthesis")(w, beta[0], lever[0], direction, second, found.semi_axes[0], MARKING)
    assert back == pytest.approx(D, rel=1e-12)


@pytest.mark.parametrize("side", SIDES)
def test_displacements_turn_the_gear_as_by_hand(side: str, gear_set: BevelSet) -> None:
    system = side_system(gear_set, side)
    run = mesh(system)
    touch, _ = run.at_mean
    r, n = placed(system, 1, touch, np.zeros(4))(touch.x[3:6])
    # X is the gear's axis, Z the pinion's: the gear turns by what the displacement drives along the normal
    lever = n @ np.cross([1.0, 0, 0], r)
    by_hand = {
        "V": -n @ [0.0, 1, 0] / lever,  # the gear goes along Y
        "H": n @ [0.0, 0, 1] / lever,  # the pinion goes along Z
        "J": -n @ [1.0, 0, 0] / lever,  # the gear goes along X
        "shaft": -n @ np.cross([0.0, 1, 0], r) / lever,  # the gear turns about Y, from Z to X
    }
    found = sensitivities(system, touch, np.zeros(4))[2]
    assert found == pytest.approx(list(by_hand.values()), rel=1e-9)
    for name, rate in by_hand.items():
        turns = [system.solve(touch.x, touch.rotation, (), Assembly(**{name: by}).vector).x[6] for by in (1e-4, -1e-4)]
        assert (turns[0] - turns[1]) / 2e-4 == pytest.approx(rate, rel=1e-5)


@pytest.mark.parametrize("side", SIDES)
def test_sensitivity_of_the_place_is_that_of_differences(side: str, gear_set: BevelSet) -> None:
    system = side_system(gear_set, side)
    touch, _ = mesh(system).at_mean
    found = sensitivities(system, touch, np.zeros(4))
    for k, name in enumerate(("V", "H", "J", "shaft")):

        def place(by: float, name: str = name) -> np.ndarray:
            return np.array(
                system.gear_place(system.solve(touch.x, touch.rotation, (), Assembly(**{name: by}).vector).x)
            )

        assert found[:2, k] == pytest.approx(list(slope(place, 1e-3)), rel=1e-4, abs=1e-6)


@pytest.mark.parametrize("side", SIDES)
def test_v_and_h_bring_the_rolled_contact_to_the_mean_point(side: str, gear_set: BevelSet, rolling) -> None:
    system = side_system(gear_set, side)
    mean = system.gear.blank.mean_cone_distance
    found = contact_at(system, mean)
    witness = rolling(gear_set, SIDES[side], V=found.V, H=found.H)
    turn, distance, height = witness.first(found.touch.rotation)
    assert math.hypot(distance - mean, height) < 1e-3
    step = 0.02
    ahead, behind = (witness.first(found.touch.rotation + by)[0] for by in (step, -step))
    curved = local(system, found.touch, np.array([found.V, found.H, 0, 0])).second_derivative
    assert abs(ahead - behind + 2 * step * system.ratio) < 0.01 * abs(curved) * step**2 + 1e-8
    assert ahead + behind - 2 * turn == pytest.approx(curved * step**2, rel=0.02)


@pytest.mark.parametrize("side", SIDES)
def test_v_and_h_of_toe_and_heel_bring_the_contact_there(side: str, gear_set: BevelSet) -> None:
    system = side_system(gear_set, side)
    for distance, inwards in zip(system.gear.ends, (3.0, -3.0), strict=True):
        found = contact_at(system, distance + inwards)
        run = side_mesh(gear_set, side, Assembly(found.V, found.H))
        (row,) = run.rows(np.array([found.touch.rotation]))
        assert (row.cone_distance, row.height) == pytest.approx((distance + inwards, 0.0), abs=1e-7)
        touch, _ = run.at_mean if run.at_mean[0].rotation == found.touch.rotation else (found.touch, None)
        assert abs(touch.tangent[6] + system.ratio) * ARCSEC < 1e-6


@pytest.mark.parametrize(("member", "name", "sign"), [("pinion", "H", -1), ("gear", "J", -1)])
def test_apex_beyond_the_crossing_point_moves_a_member_there(member: str, name: str, sign: int, gear_set) -> None:
    # the same flank, counted from an apex beyond the crossing point, stands so much deeper
    blank = getattr(gear_set, member).blank.model_copy(update={"pitch_apex_beyond_crossing_point": 0.3})
    moved = gear_set.model_copy(update={member: getattr(gear_set, member).model_copy(update={"blank": blank})})
    one, other = side_mesh(moved, "drive", Assembly()), side_mesh(gear_set, "drive", Assembly(**{name: sign * 0.3}))
    rotations = np.radians([-20.0, 0.0, 20.0])
    assert [row.error for row in one.rows(rotations)] == pytest.approx([row.error for row in other.rows(rotations)])


def test_hands_of_a_pair_mirror_its_contact(gear_set: BevelSet) -> None:
    # the other hand of both: rotations, V and the error change their signs
    def mirrored(member):
        flanks = {
            name: getattr(member, name).model_copy(
                update={
                    key: -getattr(getattr(member, name), key)
                    for key in ("cradle_angle", "blank_offset", "work_rotation_offset")
                }
                | {"cutter_swivel": 180 - getattr(member, name).cutter_swivel}
            )
            for name in ("concave", "convex")
        }
        return member.model_copy(update={**flanks, "hand": "left" if member.hand == "right" else "right"})

    other = gear_set.model_copy(update={"pinion": mirrored(gear_set.pinion), "gear": mirrored(gear_set.gear)})
    for side in SIDES:
        own = side_mesh(gear_set, side, DISPLACED)
        seen = side_mesh(other, side, replace(DISPLACED, V=-DISPLACED.V))
        assert seen.outcome == own.outcome
        rows = {round(math.degrees(row.rotation)): row for row in own.rows(np.radians(np.arange(-44, 45, 8.0)))}
        for row in seen.rows(np.radians(np.arange(-44, 45, 8.0))):
            twin = rows[-round(math.degrees(row.rotation))]
            assert row.error == pytest.approx(-twin.error, abs=1e-11)
            assert (row.kind, row.cone_distance, row.height) == (
                twin.kind,
                pytest.approx(twin.cone_distance, abs=1e-7),
                pytest.approx(twin.height, abs=1e-7),
            )

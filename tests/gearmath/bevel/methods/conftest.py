"""A witness of every cutting method in plain NumPy, and the sets that the tests of the methods share.

The witness is typed from the conventions, with its own matrices: one blade edge, moved by cutter, cradle and work.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from gearmath.bevel.crown_gear import Method, crown_gear_set, with_motion
from gearmath.specs.bevel_set import FLANKS, SIDES, BevelSet, Member
from gearmath.specs.blank_data import BlankData

ANGULAR = ("cradle_angle", "cutter_tilt", "cutter_swivel", "machine_root_angle", "work_rotation_offset")
MACHINE = (
    "radial_distance", "cradle_angle", "cutter_tilt", "cutter_swivel", "blank_offset", "sliding_base",
    "machine_center_to_crossing_point", "machine_root_angle", "ratio_of_roll", "work_rotation_offset",
)  # fmt: skip
#: What changes its sign in the mirror, cradle rotation and cutter angle besides.
ODD = ("cradle_angle", "cutter_swivel", "blank_offset", "work_rotation_offset")


COMPLETING = Method()


@dataclass(frozen=True)
class Blade:
    """One blade edge and the machine that moves it; ``moving`` holds x, x_1, ... x_7 of x(θ) of every setting."""

    moving: dict[str, np.ndarray]
    roll: tuple[float, ...]
    point_radius: float
    alpha: float
    offset: float
    side: int
    index: float
    arc: tuple[float, float, float] | None = None

    def edge(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Cutting radius and height."""
        if self.arc is None:
            return self.point_radius + self.side * u * np.tan(self.alpha), u
        center, height, radius = self.arc
        return center + self.side * radius * np.cos(u), height - radius * np.sin(u)

    def at(self, u: np.ndarray, beta: np.ndarray, theta: np.ndarray) -> np.ndarray:
        """The points (...,3) of the edge in the work, at cutter angles β and cradle angles θ."""
        u, beta, theta = np.broadcast_arrays(u, beta, theta)
        x = {name: sum(c * theta**k for k, c in enumerate(row)) for name, row in self.moving.items()}
        rho, height = self.edge(u)
        off = rho - self.point_radius
        blade = np.stack([self.point_radius + off * np.cos(self.offset), off * np.sin(self.offset), -height], axis=-1)
        swing = x["cradle_angle"] + theta
        r = _about("z", swing, _about("z", x["cutter_swivel"], _about("x", x["cutter_tilt"], _about("z", beta, blade))))
        gamma = x["machine_root_angle"]
        axis = np.stack([np.cos(gamma), 0 * gamma, np.sin(gamma)], axis=-1)
        r = r + axis * x["machine_center_to_crossing_point"][..., None]
        r = r + np.stack(
            [
                x["radial_distance"] * np.cos(swing),
                x["blank_offset"] + x["radial_distance"] * np.sin(swing),
                -x["sliding_base"],
            ],
            axis=-1,
        )
        # work axes, then the work's own rotation
        w = np.stack([np.sin(gamma) * r[..., 0] - np.cos(gamma) * r[..., 2], r[..., 1], np.sum(axis * r, axis=-1)], -1)
        c, d, e, f = (*self.roll, 0, 0, 0, 0)[:4]  # 2C, 6D, 24E, 120F
        lag = c / 2 * theta**2 + d / 6 * theta**3 + e / 24 * theta**4 + f / 120 * theta**5
        turned = x["work_rotation_offset"] + x["ratio_of_roll"] * theta - self.moving["ratio_of_roll"][0] * lag
        return _about("z", -(turned + self.index * beta), w)

    @property
    def mirrored(self) -> Blade:
        """The machine of the other hand: x'(θ) = ±x(-θ), and 180° - x(-θ) for the swivel."""
        moving = {}
        for name, row in self.moving.items():
            reversed_ = row * (-1.0) ** np.arange(len(row)) * (-1 if name in ODD else 1)
            moving[name] = reversed_ + (np.pi * (np.arange(len(row)) == 0) if name == "cutter_swivel" else 0)
        roll = tuple(value * (-1) ** (k + 1) for k, value in enumerate(self.roll))
        return Blade(
            moving, roll, self.point_radius, self.alpha, -self.offset, self.side, self.index, self.arc
        )  # fmt: skip


def _about(axis: str, angle: np.ndarray, v: np.ndarray) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    x, y, z = np.moveaxis(v, -1, 0)
    turned = (c * x - s * y, s * x + c * y, z) if axis == "z" else (x, c * y - s * z, s * y + c * z)
    return np.stack(np.broadcast_arrays(*turned), axis=-1)


def blade_of(member: Member, flank: str) -> Blade:
    """The blade and machine of a flank of a file, straight from its keys."""
    spec = member.flank(flank)
    moving = {}
    for name in MACHINE:
        row = np.array([getattr(spec, name), *getattr(spec.motion, name)], dtype=float)
        moving[name] = np.radians(row) if name in ANGULAR else row
    index = member.indexing_sign * member.blade_groups / member.teeth if member.blade_groups else 0.0
    return Blade(
        moving, spec.motion.modified_roll, spec.blade_point_radius, np.radians(spec.blade_pressure_angle),
        np.radians(spec.blade_offset_angle), SIDES[flank], index,
    )  # fmt: skip


def on_lines(
    blade: Blade, p: np.ndarray, d: np.ndarray, theta: np.ndarray, start: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Where the surface that the turning edge sweeps at cradle angles θ crosses lines p + t d: t, and whether it does.

    Newton from ``start`` (...,2) in u and β, with central differences: no derivative of the machine is known here.
    """
    t = np.zeros(np.broadcast_shapes(theta.shape, p.shape[:-1]))
    u, beta = (np.broadcast_to(start[..., k], t.shape).copy() for k in (0, 1))
    h = 1e-4
    for _ in range(7):
        along_u = (blade.at(u + h, beta, theta) - blade.at(u - h, beta, theta)) / (2 * h)
        along_beta = (blade.at(u, beta + h, theta) - blade.at(u, beta - h, theta)) / (2 * h)
        off = blade.at(u, beta, theta) - (p + t[..., None] * d)
        J = np.stack(np.broadcast_arrays(along_u, along_beta, -d), axis=-1)
        step = np.linalg.solve(J, off[..., None])[..., 0]
        u, beta, t = u - step[..., 0], beta - step[..., 1], t - step[..., 2]
    off = np.linalg.norm(blade.at(u, beta, theta) - (p + t[..., None] * d), axis=-1)
    return t, off < 1e-9


def left_on_lines(
    blade: Blade, p: np.ndarray, d: np.ndarray, theta: np.ndarray, start: np.ndarray, width: float, levels: int = 4
) -> tuple[np.ndarray, np.ndarray]:
    """What is left on lines p + t d (n,3) by all cradle angles near theta (n,): the least t, and where it is found.

    Brute force: 21 cradle angles, then again around the best of them.
    """
    best = np.full(len(p), np.inf)
    for _ in range(levels):
        poses = theta[:, None] + width * np.linspace(-1, 1, 21)
        t, crosses = on_lines(blade, p[:, None], d[:, None], poses, start[:, None])
        t = np.where(crosses, t, np.inf)
        k = np.argmin(t, axis=1)
        theta, best = np.take_along_axis(poses, k[:, None], 1)[:, 0], np.minimum(best, t.min(axis=1))
        width /= 8
    return best, theta


@pytest.fixture(scope="session")
def moved_edge() -> SimpleNamespace:
    """The blade of a member, what it leaves on lines, and the mirror image of a member."""
    return SimpleNamespace(blade_of=blade_of, left_on_lines=left_on_lines, on_lines=on_lines, mirrored=mirrored)


def pair_data(**changes: object) -> BlankData:
    """ISO 23509 sample 1's size, 14 x 39, with changes; ``blade_groups`` makes it face hobbed on 76 mm."""
    given = {"pinion_teeth": 14, "wheel_teeth": 39, "mean_spiral_angle": 35.0, "cutter_radius": 114.3, **changes}
    groups = given.pop("blade_groups", None)
    cutter = {"process": "face_hobbing" if groups else "face_milling", "cutter_radius": given.pop("cutter_radius")}
    taper = given.pop("taper", "uniform" if groups else "duplex")
    return BlankData.model_validate(
        {
            "title": "test", "source": "settings generated by gearmath's crown gear, not published",
            "shaft_angle": 90.0, "wheel_outer_pitch_diameter": 176.893, "face_width": 25.4,
            "pressure_angle_drive": 20.0, "pressure_angle_coast": 20.0,
            "cutter": {**cutter, "blade_groups": groups}, "taper": {"kind": taper},
            "data_type_1": {
                "crown_gear_addendum_factor": 1.0, "crown_gear_dedendum_factor": 1.25,
                "profile_shift_coefficient": 0.3, "thickness_modification": 0.03,
            },
            "backlash": {"outer_normal": 0.127}, **given,
        }
    )  # fmt: skip


@pytest.fixture(scope="session")
def pair() -> Callable[..., BevelSet]:
    """``pair(pinion, gear, hand, **changes of the data)``: a pair with settings of the crown gear."""

    def make(pinion: Method = COMPLETING, gear: Method = COMPLETING, hand: str = "left", **changes: object) -> BevelSet:
        return crown_gear_set(pair_data(**changes), pinion, gear, hand)  # type: ignore[arg-type]

    return make


def mirrored(member: Member) -> Member:
    """The member of the other hand, key by key: 180° - x for the swivel, odd and even coefficients of the motion.

    The swivel's 180° turn the blades of the cutter by half a turn, which in face hobbing indexes the work.
    """
    values = member.model_dump()
    values["hand"] = "left" if member.hand == "right" else "right"
    for flank in FLANKS:
        spec = values[flank]
        for name in MACHINE:
            sign = -1 if name in ODD else 1
            spec[name] = sign * spec[name] + (180.0 if name == "cutter_swivel" else 0.0)
            coefficients = spec["motion"][name]
            spec["motion"][name] = tuple(sign * (-1) ** (k + 1) * c for k, c in enumerate(coefficients))
        spec["motion"]["modified_roll"] = tuple(
            (-1) ** (k + 1) * c for k, c in enumerate(spec["motion"]["modified_roll"])
        )
        spec["blade_offset_angle"] *= -1
        spec["work_rotation_offset"] += 180.0 * member.indexing_sign * (member.blade_groups or 0) / member.teeth
    return Member.model_validate(values)


def moved(member: Member, **motion: tuple[float, ...]) -> Member:
    """The member with motion of its settings."""
    return with_motion(member, **motion)


#: Coefficients that move every setting, to the fourth degree.
UNIVERSAL = {
    "radial_distance": (0.6, -0.4, 0.2, 0.1), "cradle_angle": (0.3, 0.5, -0.2), "cutter_tilt": (0.5, 0.2),
    "cutter_swivel": (2.0, -1.0), "blank_offset": (0.5, 0.3), "sliding_base": (0.9, -0.5, 0.3),
    "machine_center_to_crossing_point": (-0.4, 0.2), "machine_root_angle": (0.6, -0.3),
    "ratio_of_roll": (0.01, -0.02), "work_rotation_offset": (0.0, 0.4, -0.3, 0.2),
}  # fmt: skip


@pytest.fixture(scope="session")
def methods() -> dict[str, Member]:
    """One member of every cutting method, by name."""
    plain = crown_gear_set(pair_data(), Method(), Method(generation="formate"))
    tilted = crown_gear_set(pair_data(), Method("fixed_setting", tilt=0.07, tilt_direction=0.6), Method())
    hobbed = crown_gear_set(
        pair_data(blade_groups=13, cutter_radius=76.0), Method(), Method(generation="formate")
    )  # fmt: skip
    return {
        "face mill, generated": plain.pinion,
        "modified roll": moved(plain.pinion, modified_roll=(0.04, -0.2, 0.5, 1.0)),
        "tilt": tilted.pinion,
        "helical motion": moved(tilted.gear, sliding_base=(1.5, -0.8)),
        "universal motion": moved(tilted.pinion, **UNIVERSAL, modified_roll=(0.02, 0.1)),
        "face hob, generated": hobbed.pinion,
        "face hob, universal motion": moved(hobbed.pinion, **UNIVERSAL),
        "Formate mill": plain.gear,
        "Formate hob": hobbed.gear,
    }


#: The methods of both members, by name; every one with motions where it rolls.
METHODS: dict[str, tuple[Method, Method]] = {
    "milled": (Method(), Method()),
    "one flank alone": (Method("fixed_setting"), Method()),
    "tilted": (Method("fixed_setting", tilt=0.06, tilt_direction=0.5), Method()),
    "milled Formate": (Method("fixed_setting"), Method(generation="formate")),
    "hobbed": (Method(), Method()),
    "hobbed Formate": (Method(), Method(generation="formate")),
}


@dataclass(frozen=True)
class Draw:
    """Random numbers in [0, 1] that become a sensible set: see ``random_set``."""

    method: str
    hand: str
    moved: bool
    pinion_teeth: int
    ratio: float
    spiral: float
    radius: float
    groups: float
    shift: float
    width: float
    motion: tuple[float, ...]


def random_set(draw: Draw) -> BevelSet:
    """A sensible pair: ratio 1 to 8 (from 2.5 where Formate), spiral angle 0 to 45 degrees, uniform depth or standard
    taper, face width 0.22 to 0.3 of R_e, cutter radius 0.75 to 1.5 of R_m (milled) or N_b m_n / 2r from 0.12 to 0.4
    (hobbed), profile shift 0 to 0.5 falling with the ratio, and with ``moved`` coefficients of roll, sliding base, root
    angle and cradle angle that move a flank by some tenths of a mm.

    Raises InputError where blank or cutter of the draw are impossible: that draw is rejected.
    """
    ratio = max(draw.ratio, 2.5) if "Formate" in draw.method else draw.ratio
    wheel = max(round(draw.pinion_teeth * ratio), draw.pinion_teeth)
    psi, outer = np.radians(draw.spiral), 150.0
    delta = np.arctan(wheel / draw.pinion_teeth)
    cone = outer / 2 / np.sin(delta)
    face = (0.22 + 0.08 * draw.width) * cone
    mean = cone - face / 2
    module = 2 * mean * np.sin(delta) * np.cos(psi) / wheel
    if "hobbed" in draw.method:
        groups = 5 + round(12 * draw.groups)
        radius = groups * module / 2 / (0.12 + 0.28 * draw.radius)
        changes = {"blade_groups": groups, "cutter_radius": float(np.clip(radius, 0.6 * mean, 2 * mean))}
    else:
        changes = {"cutter_radius": (0.75 + 0.75 * draw.radius) * mean, "taper": "standard"}
    data = pair_data(
        pinion_teeth=draw.pinion_teeth, wheel_teeth=wheel, mean_spiral_angle=draw.spiral, face_width=face,
        wheel_outer_pitch_diameter=outer, backlash={"outer_normal": 0.1}, data_type_1={
            "crown_gear_addendum_factor": 1.0, "crown_gear_dedendum_factor": 1.25, "thickness_modification": 0.0,
            "profile_shift_coefficient": 0.5 * draw.shift * (1 - (draw.pinion_teeth / wheel) ** 2),
        }, **changes,
    )  # fmt: skip
    made = crown_gear_set(data, *METHODS[draw.method], draw.hand)  # type: ignore[arg-type]
    if not draw.moved:
        return made
    a, b, c, d = (2 * value - 1 for value in draw.motion)
    motion = {"modified_roll": (0.04 * a, 0.2 * b), "sliding_base": (1.0 * c,), "cradle_angle": (0.0, 0.3 * d),
              "machine_root_angle": (0.5 * d,)}  # fmt: skip
    moved = {"pinion": with_motion(made.pinion, **motion)}
    if made.gear.generation == "generated":
        moved["gear"] = with_motion(made.gear, **{**motion, "modified_roll": ()})
    return made.model_copy(update=moved)


def random_draw(rng: np.random.Generator) -> Draw:
    """One draw of the generator, seeded."""
    x = rng.random(12)
    method = list(METHODS)[rng.integers(len(METHODS))]
    return Draw(
        method, ("left", "right")[rng.integers(2)], bool(rng.integers(2)), int(rng.integers(7, 26)),
        1 + 7 * x[0], 45 * x[1], x[2], x[3], x[4], x[5], tuple(x[6:10]),
    )  # fmt: skip


@pytest.fixture(scope="session")
def sensible() -> SimpleNamespace:
    """The generator of random sets: ``Draw``, ``random_set(draw)``, ``random_draw(rng)``."""
    return SimpleNamespace(Draw=Draw, random_set=random_set, random_draw=random_draw)


@pytest.fixture(scope="session")
def design() -> Callable[..., BlankData]:
    """``design(**changes)``: the design data of such a pair."""
    return pair_data

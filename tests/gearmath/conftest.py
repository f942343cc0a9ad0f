"""What the tests of the bevel chain share: the bundled files, a witness in plain NumPy, and the machine end to end.

The witness is typed from the conventions on purpose, with Rodrigues' rotation in machine axes and the cone given by its
apex, so that it shares no formula with the derivations. A second one knows every cutting method: one blade edge, moved
by cutter, cradle and work.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from gearmath import cli
from gearmath.machine.control.executor import MachinePath, execute
from gearmath.machine.milling.mill import mill_member
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.machine.planning.path import DEFAULT_TOLERANCE
from gearmath.machine.writing.cutting import cutting_program
from gearmath.specs.bevel_set import FLANKS, SETTINGS, SIDES, BevelSet, Design, Member, Settings, load_bevel_set
from gearmath.specs.flank_csv import FlankFile
from gearmath.specs.milling_machine import MillingMachine, load_milling_machine
from gearmath.specs.simulated_machine import SimulatedMachine, load_simulated_machine
from gearmath.specs.toml import bundled

I, J, K = np.eye(3)
NOWHERE = 1000.0
#: Depth [mm] by which a root of the cone is tried on both sides.
_TRIAL = 1e-4


@pytest.fixture(scope="session")
def gear_set() -> BevelSet:
    return load_bevel_set(bundled("nasa_tp3096_12x36.toml"))


@pytest.fixture(scope="session")
def vertical() -> MillingMachine:
    return load_milling_machine(bundled("vertical_5axis.toml"))


@pytest.fixture(scope="session")
def shop() -> SimulatedMachine:
    return load_simulated_machine(bundled("simulated_shop.toml"))


@pytest.fixture(scope="session")
def witness() -> SimpleNamespace:
    """Cradle machine, vertical machine, cone and envelope in NumPy."""
    return SimpleNamespace(
        pose=_pose,
        surface=_surface,
        vertical_axes=_vertical_axes,
        vertical_pose=_vertical_pose,
        entry=_entry,
        left_by_cradle=_left_by_cradle,
    )


@pytest.fixture(scope="session")
def program(vertical: MillingMachine) -> Callable[..., MachinePath]:
    """``program(gear_set, member, spaces, tolerance)``: the path that the control makes of the program text."""

    def run(
        gear_set: BevelSet, member: str, spaces: Iterable[int] = (0,), tolerance: float = DEFAULT_TOLERANCE
    ) -> MachinePath:
        return execute(
            cutting_program(gear_set, member, vertical, "PART", CuttingJob(tuple(spaces), tolerance)), "PART.MPF"
        )

    return run


@pytest.fixture(scope="session")
def mill(program: Callable[..., MachinePath], vertical: MillingMachine) -> Callable[..., FlankFile]:
    """``mill(gear_set, member, spaces, errors, tolerance)``: what that program leaves on the flanks."""

    def run(
        gear_set: BevelSet,
        member: str,
        spaces: Iterable[int] = (0,),
        errors: SimulatedMachine | None = None,
        tolerance: float = DEFAULT_TOLERANCE,
    ) -> FlankFile:
        path = program(gear_set, member, spaces, tolerance)
        return mill_member(path, gear_set.member(member), vertical, errors)

    return run


@pytest.fixture(scope="session")
def altered() -> Callable[..., BevelSet]:
    """``altered(gear_set, member, flank, design=..., **settings)``: the set with changed settings of one flank."""

    def change(
        gear_set: BevelSet, member: str, flank: str, design: Settings | None = None, **values: float
    ) -> BevelSet:
        spec = gear_set.member(member)
        update = {**values, **({"design": design} if design else {})}
        changed = spec.model_copy(update={flank: spec.flank(flank).model_copy(update=update)})
        return gear_set.model_copy(update={member: changed})

    return change


@pytest.fixture(scope="session")
def nominal_settings() -> Callable[..., Settings]:
    """The settings of a flank as they stand, to be kept as its design."""
    return lambda flank: Design(**{name: getattr(flank, name) for name in SETTINGS})


@pytest.fixture(scope="session")
def moved_edge() -> SimpleNamespace:
    """The blade of a member, what it leaves on lines, and the mirror image of a member."""
    return SimpleNamespace(blade_of=blade_of, left_on_lines=left_on_lines, on_lines=on_lines, mirrored=mirrored)


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str, str]]:
    """Run ``gearmath`` with arguments: status, standard output, standard error."""

    def run(*arguments: object) -> tuple[int, str, str]:
        status = 0
        try:
            cli.main([str(argument) for argument in arguments])
        except SystemExit as stop:
            status = stop.code if isinstance(stop.code, int) else 1
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return run


@pytest.fixture
def refused(command: Callable[..., tuple[int, str, str]]) -> Callable[..., None]:
    """``refused(sentence, *arguments)``: status 2, and one line on standard error that matches the pattern."""

    def check(sentence: str, *arguments: object) -> None:
        status, out, err = command(*arguments)
        assert (status, out) == (2, ""), err
        assert err.count("\n") == 1
        assert re.search(sentence, err), err

    return check


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def _turn(vector: np.ndarray, axis: np.ndarray, angle: np.ndarray | float) -> np.ndarray:
    """Rodrigues' rotation of vectors (...,3) about a unit axis (...,3), component by component."""
    c, s = np.cos(angle), np.sin(angle)
    (x, y, z), (i, j, k) = np.moveaxis(vector, -1, 0), np.moveaxis(axis, -1, 0)
    along = (i * x + j * y + k * z) * (1 - c)
    turned = (
        x * c + (j * z - k * y) * s + i * along,
        y * c + (k * x - i * z) * s + j * along,
        z * c + (i * y - j * x) * s + k * along,
    )
    return np.stack(np.broadcast_arrays(*turned), axis=-1)


def _machine_frame(x: np.ndarray, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Work axis, apex to cutter centre, and the angle by which a point is turned into the work, per pose."""
    S, q, _, _, E_m, X_b, X_p, root, ratio, offset = np.moveaxis(x, -1, 0)[:10]
    at = q + theta
    V_p = np.stack(np.broadcast_arrays(np.cos(root), 0.0, np.sin(root), at)[:3], axis=-1)
    radial = np.stack([S * np.cos(at), S * np.sin(at), np.zeros_like(at)], axis=-1)
    V_ls = V_p * X_p[..., None] - K * X_b[..., None] + J * E_m[..., None] + radial
    return V_p, V_ls, -(offset + ratio * theta)


def _into_work(vector: np.ndarray, V_p: np.ndarray, turned: np.ndarray) -> np.ndarray:
    """Turn about the work axis in the machine, then read off along x_w, y_w, z_w."""
    moved = _turn(vector, V_p, turned)
    x_w = np.cross(np.broadcast_to(J, V_p.shape), V_p)
    return np.stack([_dot(moved, x_w), moved[..., 1], _dot(moved, V_p)], axis=-1)


def _cutter_vector(x: np.ndarray, theta: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """A vector of the cutter frame in machine axes: tilt about i, then swivel, cradle angle and roll about k."""
    i, about_k = x[..., 2] + 0 * theta, x[..., 1] + x[..., 3] + theta
    return _turn(_turn(vector, I, i), K, about_k)


def _pose(x: np.ndarray, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cutter centre and axis in the work, (...,3) each, at settings (12,) or (...,12) and cradle rotations (...)."""
    theta = np.asarray(theta, dtype=float)
    V_p, V_ls, turned = _machine_frame(x, theta)
    V_c = _cutter_vector(x, theta, np.broadcast_to(K, V_p.shape))
    return _into_work(V_ls, V_p, turned), _into_work(V_c, V_p, turned)


def _surface(u: np.ndarray, beta: np.ndarray, theta: np.ndarray, x: np.ndarray, side: int) -> np.ndarray:
    """A point (...,3) of the cutter in the work."""
    u, beta, theta = (np.asarray(value, dtype=float) for value in (u, beta, theta))
    rho = x[..., 10] + side * u * np.tan(x[..., 11])
    V_p, V_ls, turned = _machine_frame(x, theta)
    r = np.stack(np.broadcast_arrays(rho * np.cos(beta), rho * np.sin(beta), -u), axis=-1)
    return _into_work(V_ls + _cutter_vector(x, theta, r), V_p, turned)


def _vertical_axes(x: np.ndarray, theta: np.ndarray, pivot: float) -> np.ndarray:
    """X, Y, Z, A, B of the conventions, A not unwrapped."""
    theta = np.asarray(theta, dtype=float)
    V_p, V_ls, turned = _machine_frame(x, theta)
    k_s = _cutter_vector(x, theta, np.broadcast_to(K, V_p.shape))
    across = np.cross(k_s, V_p)
    sine = np.linalg.norm(across, axis=-1)
    j_s = across / sine[..., None]
    i_s = np.cross(j_s, k_s)
    dA = np.arctan2(k_s[..., 1], _dot(k_s, np.cross(V_p, np.broadcast_to(J, V_p.shape))))
    B = np.pi / 2 - np.arctan2(sine, _dot(k_s, V_p))
    return np.stack([-_dot(V_ls, i_s), _dot(V_ls, j_s), -_dot(V_ls, k_s) + pivot, turned - dA, B], axis=-1)


def _vertical_pose(axes: np.ndarray, pivot: float) -> tuple[np.ndarray, np.ndarray]:
    """Cutter centre and axis in the work out of X, Y, Z, A, B, from p_m = M(B) Rz(-A) p_w."""
    X, Y, Z, A, B = np.moveaxis(axes, -1, 0)
    zero = np.zeros_like(B)
    columns = [
        np.stack(c, axis=-1)
        for c in (
            (-np.sin(B), zero, np.cos(B)),
            (zero, zero + 1, zero),
            (-np.cos(B), zero, -np.sin(B)),
        )
    ]
    centre, down = np.stack([X, Y, Z - pivot], axis=-1), np.stack([zero, zero, zero - 1], axis=-1)
    return tuple(  # type: ignore[return-value]
        _turn(np.stack([_dot(v, column) for column in columns], axis=-1), K, A) for v in (centre, down)
    )


def _entry(
    centre: np.ndarray, axis: np.ndarray, radius: float, alpha: float, side: int, p: np.ndarray, d: np.ndarray
) -> np.ndarray:
    """Where lines p + t d pass from the metal into the cutter: the cone by its apex, each root tried on both sides.

    ``axis`` is a unit vector; all that is asked of a line are its products with the axis and with itself.
    """
    w = p - centre
    along_w, along_d, w_d, w_w, d_d = _dot(w, axis), _dot(d, axis), _dot(w, d), _dot(w, w), _dot(d, d)
    apex, c2 = side * radius / np.tan(alpha), np.cos(alpha) ** 2  # of the cone, along the axis from the centre
    a = along_d**2 - c2 * d_d
    b = (along_w - apex) * along_d - c2 * (w_d - apex * along_d)
    c = (along_w - apex) ** 2 - c2 * (w_w - 2 * apex * along_w + apex**2)
    root = np.sqrt(np.where(b * b >= a * c, b * b - a * c, np.nan))

    def inside(t: np.ndarray) -> np.ndarray:
        height = -(along_w + t * along_d)
        rho = np.sqrt(np.maximum(w_w + t * (2 * w_d + t * d_d) - height**2, 0.0))
        return side * (radius + side * height * np.tan(alpha) - rho) >= 0

    best = np.full(root.shape, np.inf)
    for t in ((-b + root) / a, (-b - root) / a):
        there = np.where(np.isfinite(t), t, 0.0)
        enters = np.isfinite(t) & inside(there + _TRIAL) & ~inside(there - _TRIAL)
        best = np.where(enters & (np.abs(there) < np.abs(best)), there, best)
    at = np.where(np.isfinite(best), best, 0)
    height = -(along_w + at * along_d)
    climb = -along_d
    tip = np.where(climb > 0, at - height / np.where(climb == 0, 1, climb), NOWHERE)
    return np.where(np.isfinite(best), np.where(height >= 0, best, tip), NOWHERE)


def _left_by_cradle(
    x: np.ndarray, side: int, p: np.ndarray, d: np.ndarray, theta: np.ndarray, width: float = 0.05, levels: int = 5
) -> tuple[np.ndarray, np.ndarray]:
    """What the cradle machine leaves on lines (n,): the smallest entry over all cradle rotations near theta (n,).

    Brute force: 41 poses, then again around the best of them. Returns distance and cradle rotation.
    """
    best = np.full(len(p), np.inf)
    for _ in range(levels):
        poses = theta[:, None] + width * np.linspace(-1, 1, 41)
        t = _entry(*_pose(x, poses), x[10], x[11], side, p[:, None], d[:, None])
        k = np.argmin(t, axis=1)
        theta, best = np.take_along_axis(poses, k[:, None], 1)[:, 0], np.minimum(best, t.min(axis=1))
        width /= 15
    return best, theta


ANGULAR = ("cradle_angle", "cutter_tilt", "cutter_swivel", "machine_root_angle", "work_rotation_offset")
MACHINE = (
    "radial_distance",
    "cradle_angle",
    "cutter_tilt",
    "cutter_swivel",
    "blank_offset",
    "sliding_base",
    "machine_center_to_crossing_point",
    "machine_root_angle",
    "ratio_of_roll",
    "work_rotation_offset",
)
#: What changes its sign in the mirror, cradle rotation and cutter angle besides.
ODD = ("cradle_angle", "cutter_swivel", "blank_offset", "work_rotation_offset")


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
        return Blade(moving, roll, self.point_radius, self.alpha, -self.offset, self.side, self.index, self.arc)


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
        moving,
        spec.motion.modified_roll,
        spec.blade_point_radius,
        np.radians(spec.blade_pressure_angle),
        np.radians(spec.blade_offset_angle),
        SIDES[flank],
        index,
    )


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
    return Member.model_validate(values).named(member.name)


@pytest.fixture(scope="session")
def browser(tmp_path_factory):
    """How to start a browser without a window, and with a profile of its own: a second one of the same waits for it."""
    profile = f"--user-data-dir={tmp_path_factory.mktemp('profile')}"
    for name in ("chromium", "chromium-browser", "google-chrome"):
        if path := shutil.which(name):
            return [path, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", profile]
    return pytest.skip("needs chromium")

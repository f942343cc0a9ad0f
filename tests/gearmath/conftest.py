"""What the tests of the bevel chain share: the bundled files, a witness in plain NumPy, and the machine end to end.

The witness is typed from the conventions on purpose, with Rodrigues' rotation in machine axes and the cone given by its
apex, so that it shares no formula with the derivations.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from types import SimpleNamespace

import numpy as np
import pytest

from gearmath import cli
from gearmath.machine.cutting import Job, cutting_program
from gearmath.machine.executor import MachinePath, execute
from gearmath.machine.mill import mill_member
from gearmath.machine.path import DEFAULT_TOLERANCE
from gearmath.specs.bevel_set import SETTINGS, BevelSet, Design, Settings, load_bevel_set
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
        pose=_pose, surface=_surface, vertical_axes=_vertical_axes, vertical_pose=_vertical_pose, entry=_entry,
        left_by_cradle=_left_by_cradle,
    )  # fmt: skip


@pytest.fixture(scope="session")
def program(vertical: MillingMachine) -> Callable[..., MachinePath]:
    """``program(gear_set, member, spaces, tolerance)``: the path that the control makes of the program text."""

    def run(
        gear_set: BevelSet, member: str, spaces: Iterable[int] = (0,), tolerance: float = DEFAULT_TOLERANCE
    ) -> MachinePath:
        return execute(cutting_program(gear_set, member, vertical, "PART", Job(tuple(spaces), tolerance)), "PART.MPF")

    return run


@pytest.fixture(scope="session")
def mill(program: Callable[..., MachinePath], vertical: MillingMachine) -> Callable[..., FlankFile]:
    """``mill(gear_set, member, spaces, errors, tolerance)``: what that program leaves on the flanks."""

    def run(
        gear_set: BevelSet, member: str, spaces: Iterable[int] = (0,), errors: SimulatedMachine | None = None,
        tolerance: float = DEFAULT_TOLERANCE,
    ) -> FlankFile:  # fmt: skip
        path = program(gear_set, member, spaces, tolerance)
        return mill_member(path, gear_set.member(member), member, vertical, errors)

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
    return np.sum(a * b, axis=-1)


def _turn(vector: np.ndarray, axis: np.ndarray, angle: np.ndarray | float) -> np.ndarray:
    """Rodrigues' rotation of vectors (...,3) about a unit axis (...,3)."""
    c, s = np.cos(angle)[..., None], np.sin(angle)[..., None]
    return vector * c + np.cross(axis, vector) * s + axis * _dot(axis, vector)[..., None] * (1 - c)


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
    return _turn(_turn(vector, np.broadcast_to(I, vector.shape), i), np.broadcast_to(K, vector.shape), about_k)


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
    columns = [np.stack(c, axis=-1) for c in (
        (-np.sin(B), zero, np.cos(B)), (zero, zero + 1, zero), (-np.cos(B), zero, -np.sin(B)),
    )]  # fmt: skip
    centre, down = np.stack([X, Y, Z - pivot], axis=-1), np.stack([zero, zero, zero - 1], axis=-1)
    return tuple(  # type: ignore[return-value]
        _turn(np.stack([_dot(v, column) for column in columns], axis=-1), np.broadcast_to(K, v.shape), A)
        for v in (centre, down)
    )


def _entry(
    centre: np.ndarray, axis: np.ndarray, radius: float, alpha: float, side: int, p: np.ndarray, d: np.ndarray
) -> np.ndarray:
    """Where lines p + t d pass from the metal into the cutter: the cone by its apex, each root tried on both sides."""
    apex = centre + side * axis * radius / np.tan(alpha)
    w, c2 = p - apex, np.cos(alpha) ** 2
    a = _dot(d, axis) ** 2 - c2 * _dot(d, d)
    b = _dot(w, axis) * _dot(d, axis) - c2 * _dot(w, d)
    c = _dot(w, axis) ** 2 - c2 * _dot(w, w)
    root = np.sqrt(np.where(b * b >= a * c, b * b - a * c, np.nan))

    def inside(t: np.ndarray) -> np.ndarray:
        r = p + t[..., None] * d - centre
        height = -_dot(r, axis)
        rho = np.linalg.norm(r + height[..., None] * axis, axis=-1)
        return side * (radius + side * height * np.tan(alpha) - rho) >= 0

    best = np.full(root.shape, np.inf)
    for t in ((-b + root) / a, (-b - root) / a):
        t = np.where(np.isfinite(t), t, np.inf)
        enters = np.isfinite(t)
        enters[enters] = (inside(np.where(enters, t, 0) + _TRIAL) & ~inside(np.where(enters, t, 0) - _TRIAL))[enters]
        best = np.where(enters & (np.abs(t) < np.abs(best)), t, best)
    at = np.where(np.isfinite(best), best, 0)
    height = -_dot(p + at[..., None] * d - centre, axis)
    climb = -_dot(d, axis)
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

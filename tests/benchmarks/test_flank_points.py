"""Flank points per second: by the public function, by the kernel as the engine runs it, as exported C, in the VM,
and by scipy.optimize.fsolve, in one run.

All but the first start from the same values and solve the same residual. fsolve takes one point at a time and calls the
residual through CasADi from Python, which is how such a solver is usually written.
"""

from __future__ import annotations

import timeit

import casadi as ca
import numpy as np
import pytest
from scipy.optimize import fsolve

from gearmath.bevel.flank import blank_grid, flank_point, solve_flank
from gearmath.export.host import compile_kernel
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import SIDES, load_bevel_set
from gearmath.specs.toml import bundled

ROWS, COLUMNS = 100, 200
SOLVED_BY_FSOLVE = 400


@pytest.fixture(scope="module")
def places() -> tuple:
    """The arguments of the kernel: start values, settings, side and places of a dense grid on the gear."""
    gear = load_bevel_set(bundled("nasa_tp3096_12x36.toml")).gear
    grid = blank_grid(gear, ROWS, COLUMNS)
    settings, side, place = gear.concave.vector, SIDES["concave"], (grid.axial.ravel(), grid.radial.ravel())
    (start,) = kernel("contact_start")(settings, side, *place)
    return start, settings, side, *place


def place_and_meshing() -> ca.Function:
    """The residual of the solver: off the place along z and along the radius, and the equation of meshing."""
    w, settings, side, axial, radial = (
        ca.SX.sym(name, size) for name, size in zip("wxszr", (3, 12, 1, 1, 1), strict=True)
    )
    unknowns = (w[0], w[1], w[2], settings, side)
    point, _ = kernel("flank_family").function(*unknowns)
    meshing = kernel("meshing").function(*unknowns)
    off_radius = (point[0] ** 2 + point[1] ** 2 - radial**2) / (2 * radial)
    residual = ca.vertcat(point[2] - axial, off_radius, meshing / settings[0])
    return ca.Function("residual", [w, settings, side, axial, radial], [residual])


def by_fsolve(start: np.ndarray, settings: np.ndarray, side: int, axial: np.ndarray, radial: np.ndarray) -> np.ndarray:
    """u, β, θ (n,3), point by point."""
    function = place_and_meshing()

    def solve(k: int) -> np.ndarray:
        given = (settings, side, axial[k], radial[k])
        return fsolve(lambda w: np.asarray(function(w, *given)).ravel(), start[k], xtol=1e-13)

    return np.array([solve(k) for k in range(len(start))])


@pytest.mark.benchmark(group="flank points")
def test_flank_points_per_second_by_every_way(benchmark, places, by_vm, host_compiler, timed) -> None:
    fsolved = SOLVED_BY_FSOLVE if timed else 40
    start, settings, side, axial, radial = places
    n, engine, vm, compiled = len(start), flank_point(), by_vm(flank_point()), compile_kernel(flank_point())
    gear = load_bevel_set(bundled("nasa_tp3096_12x36.toml")).gear
    grid = blank_grid(gear, 300, 300)  # of so many points that the engine compiles
    points = solve_flank(gear, "concave", grid)
    contact, _, _, residual = benchmark(engine, *places)
    assert residual.max() < 1e-9  # mm
    np.testing.assert_array_equal(vm(*places)[0], contact)
    few = np.linspace(0, n - 1, fsolved).astype(int)
    some = (start[few], settings, side, axial[few], radial[few])
    np.testing.assert_allclose(by_fsolve(*some), contact[few], rtol=0, atol=1e-8)  # mm and rad

    def per_second(run, count: int, repeat: int) -> float:
        return count / min(timeit.repeat(run, number=1, repeat=repeat if timed else 1))

    rates = {
        "public": per_second(lambda: solve_flank(gear, "concave", grid), len(points.point), 5),
        "engine": per_second(lambda: engine(*places), n, 7),
        "compiled": per_second(lambda: compiled(*places), n, 7),
        "vm": per_second(lambda: vm(*places), n, 3),
        "fsolve": per_second(lambda: by_fsolve(*some), fsolved, 3),
    }
    for name, rate in rates.items():
        benchmark.extra_info[f"points_per_second_{name}"] = round(rate)
    ratios = {name: rates["public"] / rates[name] for name in ("vm", "fsolve")}
    for name, ratio in ratios.items():
        benchmark.extra_info[f"ratio_to_{name}"] = round(ratio, 1)
    said = ", ".join(f"{name} {rate:.3g}" for name, rate in rates.items())
    print(f"\nflank points per s: {said}; public / vm {ratios['vm']:.1f}, / fsolve {ratios['fsolve']:.0f}")

"""Points per second of the solver of every cutting method: compiled, against the CasADi VM and scipy.optimize.fsolve.

Face milling and face hobbing run through the same kernel, and so do 45 points and a million. The public row is half
a flank and half its fillet, through the functions that check convergence. fsolve takes one point at a time and calls
the residual through CasADi from Python, which is how such a solver is usually written.
"""

from __future__ import annotations

import math
import time
import timeit

import casadi as ca
import numpy as np
import pytest
from scipy.optimize import fsolve

from derivations import generation
from gearmath.bevel.flank import blank_grid
from gearmath.bevel.generation import solve_curve, solve_section
from gearmath.bevel.generation_kernels import generation_point
from gearmath.bevel.method import blade_sections, generation_of
from gearmath.export.host import compile_kernel
from gearmath.kernels import kernel
from gearmath.lowering import lower
from gearmath.specs.bevel_set import Member, load_bevel_set
from gearmath.specs.toml import bundled

SETS = {"milled": "crown_gear_formate_14x39.toml", "hobbed": "crown_gear_hobbed_14x39.toml"}
WITH_EDGE_RADIUS = "spiral_7x43.toml"
SIZES = {45: (5, 9), 2_500: (50, 50), 1_000_000: (1000, 1000)}
BY_VM, BY_FSOLVE = 2_500, 100


def arguments(name: str, shape: tuple[int, int]) -> tuple:
    """The arguments of the kernel for a grid on the concave flank of the pinion."""
    pinion = load_bevel_set(bundled(SETS[name])).pinion
    grid, how = blank_grid(pinion, *shape), generation_of(pinion, "concave")
    how = how.with_blade(blade_sections(pinion.concave, 1)["main"])
    axial, radial = grid.axial.ravel(), grid.radial.ravel()
    conditions = np.zeros((len(axial), 2, 4))
    conditions[:, 0, 1], conditions[:, 0, 3] = 1.0, axial
    conditions[:, 1, 2], conditions[:, 1, 3] = 1.0, radial
    (start,) = compile_kernel(kernel("contact_start"))(how.settings, how.side, axial, radial)
    given = (how.settings, how.motion, how.index_ratio, how.blade_offset_angle, how.side, 1)
    return start, *given, conditions


def flank_and_fillet(pinion: Member, shape: tuple[int, int]) -> int:
    """Number of points that converged on flank and fillet of the concave side, as many on each."""
    grid, how = blank_grid(pinion, *shape), generation_of(pinion, "concave")
    axial, radial = grid.axial.ravel(), grid.radial.ravel()
    sections, delta = blade_sections(pinion.concave, 1), pinion.blank.delta
    flank = solve_section(how, sections["main"], axial, radial)
    direction = (math.cos(delta), math.sin(delta))
    u = np.repeat(np.linspace(sections["edge"].lower, sections["edge"].upper, shape[0]), shape[1])
    distance, start = axial * direction[0] + radial * direction[1], np.column_stack([u, flank.contact[:, 1:]])
    fillet = solve_curve(how, sections["edge"], u, direction, distance, start)
    return int(flank.converged.sum() + fillet.converged.sum())


def by_fsolve(start: np.ndarray, *given: np.ndarray) -> np.ndarray:
    """u, β, θ (n,3), point by point, from the family of chapter 10 alone."""
    family = lower(generation.straight_generation()).function
    *how, _, conditions = given
    w = ca.SX.sym("w", 3)
    settings, motion, index_ratio, offset, side = how
    point, _, meshing = family(w[0], w[1], w[2], settings, motion, index_ratio, offset, side)
    function = ca.Function("residual", [w], [ca.vertcat(point[2], ca.norm_2(point[:2]), meshing / settings[0])])

    def solve(k: int) -> np.ndarray:
        place = np.append(conditions[k, :, 3], 0.0)
        return fsolve(lambda w: np.asarray(function(w)).ravel() - place, start[k], xtol=1e-13)

    return np.array([solve(k) for k in range(len(start))])


@pytest.mark.benchmark(group="generation points")
def test_points_per_second_of_a_million_compiled_against_the_vm_and_fsolve(
    benchmark, by_vm, host_compiler, timed
) -> None:
    top, fsolved = (max(SIZES), BY_FSOLVE) if timed else (BY_VM, 10)
    compiled, vm = compile_kernel(generation_point(False)), by_vm(generation_point(False))
    rates: dict[str, float] = {}
    for name in SETS:
        for count, shape in SIZES.items():
            if count > top:
                continue
            given, seconds = arguments(name, shape), []
            for _ in range(2 if count > 100_000 else 4):
                begin = time.perf_counter()
                residual = compiled(*given)[3]
                seconds.append(time.perf_counter() - begin)
            assert residual.max() < 1e-9  # mm
            rates[f"{name}_{count}"] = count / min(seconds)
    pinion, seconds = load_bevel_set(bundled(WITH_EDGE_RADIUS)).pinion, []
    for _ in range(4):
        begin = time.perf_counter()
        assert flank_and_fillet(pinion, SIZES[2_500]) == 2 * 2_500
        seconds.append(time.perf_counter() - begin)
    rates["public, with fillet"] = 2 * 2_500 / min(seconds)
    given = arguments("milled", SIZES[BY_VM])
    contact = compiled(*given)[0]
    np.testing.assert_allclose(vm(*given)[0], contact, rtol=0, atol=1e-9)
    rates["vm"] = BY_VM / min(timeit.repeat(lambda: vm(*given), number=1, repeat=1))
    few = np.linspace(0, BY_VM - 1, fsolved).astype(int)
    some = (given[0][few], *given[1:-1], given[-1][few])
    np.testing.assert_allclose(by_fsolve(*some), contact[few], rtol=0, atol=1e-7)
    rates["fsolve"] = fsolved / min(timeit.repeat(lambda: by_fsolve(*some), number=1, repeat=1))
    small = arguments("milled", SIZES[45])
    benchmark(compiled, *small)
    for name, rate in rates.items():
        benchmark.extra_info[f"points_per_second_{name}"] = round(rate)
    most, hobbed = rates[f"milled_{top}"], rates[f"hobbed_{top}"]
    print(
        "\ngeneration points per s: "
        + ", ".join(f"{name} {rate:.3g}" for name, rate in rates.items())
        + f"; compiled / VM {most / rates['vm']:.1f}, / fsolve {most / rates['fsolve']:.0f}, "
        f"milled / hobbed {most / hobbed:.2f}"
    )

"""Studies: draws of a whole identification per second, and what threads make of them."""

from __future__ import annotations

import os
import timeit

import casadi as ca
import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.identify.compensation import identify, with_deviations
from gearmath.bevel.identify.flank_target import predicted
from gearmath.quality.correction.batch import compensation_kernel
from gearmath.quality.correction.target import target_of
from gearmath.quality.uncertainty.covariance import independent
from gearmath.quality.uncertainty.study import monte_carlo, run
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.simulated_machine import load_simulated_machine
from gearmath.specs.toml import bundled

FREE = ("radial_distance", "cradle_angle", "machine_center_to_crossing_point", "machine_root_angle")


@pytest.mark.benchmark(group="studies")
def test_draws_of_an_identification(benchmark, timed) -> None:
    """Mapped on all processors, on one, and as a loop over the solver: 45 points, four settings, exact surface."""
    draws, looped = (1000, 20) if timed else (40, 1)
    spec = load_bevel_set(bundled("nasa_tp3096_12x36.toml")).pinion
    one = target_of(spec, "concave", solve_flank(spec, "concave", blank_grid(spec)))
    errors = load_simulated_machine(bundled("simulated_shop.toml")).setting_errors("pinion")
    form, _ = predicted(one, one.settings + errors)
    (target,) = with_deviations([one], form)
    kernel, found = compensation_kernel([target], FREE, steps=2), identify([target], FREE)
    d = ca.MX.sym("measured", 45)
    function = ca.Function("identified", [d], [kernel.function(d, ca.DM(found.values))[0]])
    noise = independent(np.full(45, 0.5e-3))
    study = monte_carlo(noise.drawn(function, form), draws)
    values = benchmark.pedantic(run, (study,), rounds=2 if timed else 1, iterations=1)
    np.testing.assert_array_equal(values, run(study, workers=1))
    threads, single = (
        min(timeit.repeat(lambda n=n: run(study, workers=n), number=1, repeat=2 if timed else 1)) for n in (None, 1)
    )
    by_loop = draws / looped * timeit.timeit(lambda: identify([target], FREE), number=looped)
    print(
        f"\n{draws / threads:.0f} draws/s on {os.cpu_count()} processors: {single / threads:.2f} x one, "
        f"{by_loop / threads:.1f} x a loop over the solver"
    )

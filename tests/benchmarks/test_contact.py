"""Exact contact of both sides of a pair, its ease-off map, and a design; beside seven equations solved one by one.

The peer is scipy.optimize.fsolve on the same equations from Python, each position from the one before, within the
flanks only: no edges, no corners, no neighboring teeth.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import fsolve

from gearmath.bevel.contact.mesh import mesh
from gearmath.bevel.contact.places import places
from gearmath.bevel.contact.report import SIDES, side_system
from gearmath.bevel.design.route import design
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.design import load_design
from gearmath.specs.toml import bundled

POSITIONS = 60
STILL = np.zeros(4)


@pytest.fixture(scope="module")
def systems() -> list:
    """Both sides of the NASA pair, their functions built."""
    pair = load_bevel_set(bundled("nasa_tp3096_12x36.toml"))
    both = [side_system(pair, side) for side in SIDES]
    for system in both:
        assert mesh(system).leads.peak_to_peak > 0
    return both


@pytest.mark.benchmark(group="exact contact of both flanks, 60 positions each")
def test_contact_of_both_flanks_with_edges_and_three_pairs(benchmark, systems) -> None:
    def run() -> list:
        found = [mesh(system) for system in systems]
        return [(one.path(3 * one.system.pitch / POSITIONS), one.leads) for one in found]

    assert all(len(path) > POSITIONS for path, _ in benchmark(run))


@pytest.mark.benchmark(group="exact contact of both flanks, 60 positions each")
def test_seven_equations_by_fsolve_within_the_flanks(benchmark, systems) -> None:
    starts = [mesh(system).interior[0][1].touches[0] for system in systems]

    def run() -> None:
        for system, start in zip(systems, starts, strict=True):
            x = start.x
            for rotation in np.linspace(start.rotation, start.rotation + math.radians(25), POSITIONS):
                x = fsolve(lambda x, at=rotation, of=system: of.equations.at(x, at, STILL)[0][:7, 0], x, xtol=1e-13)

    benchmark(run)


@pytest.mark.benchmark(group="ease-off map")
def test_ease_off_map_of_15_by_15_points(benchmark, systems) -> None:
    found = benchmark(places, systems[0], STILL, 15, 15)
    assert np.isfinite(found.error).all()


@pytest.mark.benchmark(group="design of both flanks")
def test_design_of_the_bundled_7x43_pair(benchmark) -> None:
    asked = load_design(bundled("design_7x43.toml"))
    assert benchmark(design, asked).flanks.keys() == set(SIDES)

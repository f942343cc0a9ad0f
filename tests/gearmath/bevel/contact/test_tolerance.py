"""V and H to the edges beside the pattern on a finer grid and a hand calculation; areas beside those of circles."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.contact.marked import marked_area
from gearmath.bevel.contact.mesh import mesh
from gearmath.bevel.contact.misalignment import sensitivities
from gearmath.bevel.contact.outcome_limits import Change
from gearmath.bevel.contact.pattern import pattern
from gearmath.bevel.contact.report import SIDES, side_mesh, tolerance_figures
from gearmath.bevel.contact.system import Assembly
from gearmath.bevel.contact.tolerance import EDGES, Limit, Tolerance, clearances, tolerance
from gearmath.specs.bevel_set import BevelSet

#: Rim of a grid (root to tip, toe to heel) that an edge of the gear is.
RIM = {"gear tip": np.s_[-1, :], "gear toe": np.s_[:, 0], "gear heel": np.s_[:, -1]}


def test_area_and_center_are_those_of_a_circle() -> None:
    x, y = np.meshgrid(np.linspace(-2, 3, 201), np.linspace(-1, 2, 121))
    found = marked_area(x, y, (x - 0.4) ** 2 + (y - 0.3) ** 2, 0.81)
    assert found.share == pytest.approx(math.pi * 0.81 / 15, rel=1e-3)
    assert found.length == pytest.approx(1.8, rel=1e-3)
    assert found.center == pytest.approx([0.4, 0.3], abs=1e-4)


def test_area_under_a_plane_is_exact_on_a_coarse_grid() -> None:
    x, y = np.meshgrid(np.linspace(0, 3, 4), np.linspace(0, 2, 3))
    found = marked_area(x, y, x, 1.25)
    assert found.share == pytest.approx(1.25 / 3, rel=1e-12)
    assert found.center == pytest.approx([0.625, 1.0], rel=1e-12)
    assert marked_area(x, y, x, -1.0).share == 0
    assert marked_area(x, y, np.full_like(x, np.nan), 1.0).share == 0


def test_pattern_comes_to_the_named_edge_at_the_limit_and_not_before(uniform_pair) -> None:
    run = side_mesh(uniform_pair(94.0, -800.0), "coast", Assembly())
    found = tolerance(run)
    checked = 0
    for name, both in found.limits.items():
        assert both[0].value < 0 < both[1].value
        for limit in both:
            assert limit.edge not in found.reached
            if limit.edge not in RIM:
                continue
            least = []
            for part in (0.9, 1.0):
                moved = mesh(run.system, replace(Assembly(), **{name: part * limit.value}))
                least.append(np.nanmin(pattern(moved, rows=81, columns=81).gap[RIM[limit.edge]]) * 1000)
            assert least[0] > 6.6
            # the limit is found with 41 rows on the edge, this is the least of 81: near a corner the gap is steep
            assert least[1] == pytest.approx(6.35, abs=0.6)
            checked += 1
    assert checked >= 1


def test_edge_on_which_a_pair_runs_counts_as_reached(gear_set: BevelSet) -> None:
    # both sides of the NASA pair run on the tip of the pinion in turn
    for side in SIDES:
        run = side_mesh(gear_set, side, Assembly())
        assert "pinion tip" in {edge for edge, which in EDGES.items() if which in run.leads.borders}
        assert clearances(run)["pinion tip"] < 0


def test_crowned_pair_reaches_its_ends_where_its_sensitivity_says(uniform_pair) -> None:
    # crowned along the tooth alone: the gap is a parabola about the contact, which moves by its sensitivity
    run = side_mesh(uniform_pair(106.0), "drive", Assembly())
    found = tolerance(run)
    touch, _ = run.at_mean
    per_mm = sensitivities(run.system, touch, run.assembly)[0, 0]
    figures = pattern(run).figures
    half = run.system.gear.blank.face_width / 2
    room = half * (1 - figures["length_share"])
    for limit in found.limits["V"]:
        assert limit.edge in ("gear toe", "gear heel", "pinion toe", "pinion heel")
        assert abs(limit.value * per_mm) == pytest.approx(room, rel=0.15)


def test_flanks_that_touch_along_lines_have_no_tolerance(uniform_pair) -> None:
    assert tolerance(side_mesh(uniform_pair(), "drive", Assembly())) is None


def test_json_names_displacement_sense_value_and_edge() -> None:
    both = Limit(-0.2, "gear toe"), Limit(5.0, None)
    changes = Change(-0.01, "edge contact"), Change(0.02, "fillet contact")
    found = tolerance_figures(Tolerance(("pinion tip",), {"V": both, "H": both}), {"V": changes, "H": changes})
    assert found is not None
    assert list(found) == ["reached", "v", "h", "outcome_changes"]
    assert found["outcome_changes"]["h"]["plus"] == {"value": 0.02, "outcome": "fillet contact"}
    assert found["reached"] == ["pinion tip"]
    assert found["v"] == {"minus": {"value": -0.2, "edge": "gear toe"}, "plus": {"value": 5.0, "edge": None}}
    assert tolerance_figures(None) is None

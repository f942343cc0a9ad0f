"""Tips on fillets of their mates beside flank and fillet rolled as one surface; what is followed has no step."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.contact.mesh import OUTCOMES, Mesh, mesh
from gearmath.bevel.contact.outcome_limits import outcome_limits
from gearmath.bevel.contact.report import ARCSEC, SIDES, figures, side_mesh, side_system, tolerance_figures
from gearmath.bevel.contact.system import Assembly
from gearmath.bevel.contact.tolerance import Tolerance
from gearmath.specs.bevel_set import BevelSet, load_bevel_set
from gearmath.specs.toml import bundled
from tests.gearmath.bevel.contact.filleted import Filleted


@pytest.fixture(scope="module")
def spiral() -> BevelSet:
    return load_bevel_set(bundled("spiral_7x43.toml"))


#: The gear pushed in: its tip comes to the end of the pinion's flank, and goes beyond. By J [mm], rotations in pitches
#: at which the pair runs on the kinds named.
PUSHED_IN = {
    -0.20: {-0.57: "edge", -0.495: "fillet", -0.31: "interior"},
    -0.25: {-1.02: "fillet", -0.44: "fillet", -0.17: "interior"},
}


@pytest.mark.parametrize("J", PUSHED_IN)
def test_tip_on_the_fillet_runs_as_the_rolled_surfaces(J: float, rolling, spiral: BevelSet) -> None:
    run = side_mesh(spiral, "coast", Assembly(J=J))
    witness = replace(
        rolling(spiral, SIDES["coast"], lowest=0.4, J=J), pinion=Filleted.of(spiral.pinion, SIDES["coast"])
    )
    for part, kind in PUSHED_IN[J].items():
        rotation = part * run.system.pitch
        turn, distance, height, _ = witness.contact(rotation)
        (row,) = run.rows(np.array([rotation]))
        assert row.kind == kind
        assert abs(row.error - run.system.ratio * rotation - turn) * ARCSEC < 1e-3
        assert math.hypot(row.cone_distance - distance, row.height - height) < 1e-3


def largest_step(run: Mesh) -> float:
    """Of what the gear follows over a pitch [arcsec]: the largest of 60 differences, halved until a step is left."""
    rotations = np.linspace(0, run.system.pitch, 61)
    followed = run.followed(rotations)
    k = int(np.abs(np.diff(followed)).argmax())
    low, high = rotations[k : k + 2]
    for _ in range(24):
        middle = (low + high) / 2
        one, between, other = run.followed(np.array([low, middle, high]))
        low, high = (low, middle) if abs(between - one) > abs(other - between) else (middle, high)
    return float(np.ptp(run.followed(np.array([low, high])))) * ARCSEC


#: V, H, J [mm] and shaft [degree]: single ones up to where tips reach the fillets, and some at once.
ASSEMBLIES = (
    *((0.0, 0.0, J, 0.0) for J in (-0.5, -0.3, -0.2, -0.1, 0.2)),
    *((V, H, J, shaft) for V, H, J, shaft in np.random.default_rng(13).uniform(-0.2, 0.2, (5, 4)) * (1, 1, 1, 0.5)),
)


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("name", ["spiral_7x43.toml", "nasa_tp3096_12x36.toml", "crown_gear_formate_14x39.toml"])
def test_what_the_gear_follows_has_no_step_at_any_assembly(name: str, side: str) -> None:
    system = side_system(load_bevel_set(bundled(name)), side)
    for V, H, J, shaft in ASSEMBLIES:
        run = mesh(system, Assembly(V, H, J, math.radians(shaft)))
        assert run.outcome in OUTCOMES
        assert not run.gaps, (V, H, J, shaft)
        assert largest_step(run) < 1e-3, (V, H, J, shaft)


def test_worse_assembly_has_no_better_outcome(spiral: BevelSet) -> None:
    system, worst = side_system(spiral, "coast"), 0
    order = ["interior contact", "edge contact", "fillet contact", "gap in the path"]
    for J in (0.0, -0.05, -0.1, -0.15, -0.2, -0.25, -0.3, -0.5, -1.0):
        rank = order.index(mesh(system, Assembly(J=J)).outcome)
        assert rank >= worst, J
        worst = rank
    assert worst == len(order) - 1


def test_gap_in_the_path_is_the_step_that_is_seen_and_no_peak_to_peak_is_stated(spiral: BevelSet) -> None:
    # pushed in by more than the clearance: the gear's tip meets the bottom of the pinion's space
    run = side_mesh(spiral, "coast", Assembly(J=-1.0))
    (gap,) = run.gaps
    assert largest_step(run) == pytest.approx(gap.step * ARCSEC, abs=0.1)
    result = figures(run, math.radians(5))
    assert result["outcome"] == "gap in the path"
    assert result["peak_to_peak_arcsec"] is None
    assert result["gaps"][0]["pinion_rotation_deg"] == pytest.approx(math.degrees(gap.rotation))


def test_tip_on_a_fillet_is_named_and_changes_of_kind_are_positions(spiral: BevelSet) -> None:
    result = figures(side_mesh(spiral, "coast", Assembly(J=-0.2)), math.radians(0.5))
    assert result["outcome"] == "fillet contact"
    assert result["on_fillets"] == ["gear tip on the pinion's fillet"]
    rows = result["path"]
    kinds = [row["kind"] for row in rows]
    changes = [k for k in range(1, len(rows)) if kinds[k] != kinds[k - 1]]
    assert [kinds[k] for k in changes] == ["fillet", "interior", "edge"]
    for k in changes:
        assert abs(rows[k]["pinion_rotation_deg"] * 2 - round(rows[k]["pinion_rotation_deg"] * 2)) > 1e-6
        assert abs(rows[k]["transmission_error_arcsec"] - rows[k - 1]["transmission_error_arcsec"]) < 1.0


@pytest.mark.parametrize("side", SIDES)
def test_outcome_changes_at_the_stated_displacements_and_not_before(side: str, spiral: BevelSet) -> None:
    run = side_mesh(spiral, side, Assembly())
    limits = outcome_limits(run)
    for name, both in limits.items():
        for sign, limit in zip((-1, 1), both, strict=True):
            assert limit.value * sign > 0
            assert limit.outcome != "interior contact"
            inside, outside = (
                mesh(run.system, Assembly(**{name: limit.value + part * sign})).outcome for part in (-2e-5, 2e-5)
            )
            assert (inside, outside) == ("interior contact", limit.outcome)


def test_pair_on_its_edges_has_no_displacements_to_another_outcome(spiral: BevelSet) -> None:
    run = side_mesh(spiral, "coast", Assembly(J=-0.1))
    assert outcome_limits(run) is None
    assert tolerance_figures(Tolerance((), {}), None)["outcome_changes"] is None

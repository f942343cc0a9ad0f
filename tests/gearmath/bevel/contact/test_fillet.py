"""Tips on fillets of their mates beside flank and fillet rolled as one surface; what is followed has no step."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.contact.report import ARCSEC, SIDES, side_mesh
from gearmath.bevel.contact.system import Assembly
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

"""Pairs that run on edges are refused with how far one pair of teeth touches, and what is named first lets them run."""

from __future__ import annotations

from typing import Any

import pytest

from gearmath.bevel.design.route import design
from gearmath.bevel.design.verdict import EdgeContact, verdict
from gearmath.specs.design import DesignData
from gearmath.specs.toml import checked

BASE = {
    "title": "14 x 39",
    "pinion_teeth": 14,
    "wheel_teeth": 39,
    "outer_transverse_module": 4.2,
    "face_width": 24.0,
    "cutter": {"cutter_radius": 76.2},
}
FORMATE = {"wheel_teeth": 41, "pinion_teeth": 12, "face_width": 25.0, "gear": {"generation": "formate"}}
#: What is refused, where one pair of teeth touches, what helps first, and values that do that.
CASES: dict[str, tuple[dict[str, Any], str, str, dict[str, Any]]] = {
    "path": (
        {"coast": {"path_angle": 60.0, "transmission_error": 40.0, "pattern_length": 0.4}},
        "from 0.59 pitches before the vertex of its parabola to 0.49 after it, and must do so half a pitch to either",
        "a larger path_angle (now 60 degrees) is needed",
        {"coast": {"path_angle": 120.0, "transmission_error": 40.0, "pattern_length": 0.4}},
    ),
    "bias": (
        {"coast": {"lengthwise_crowning": 60.0, "profile_crowning": 30.0, "bias": -60.0}},
        "from 0.45 pitches before the vertex of its parabola to 0.70 after it",
        "a bias nearer to 0 (now -60 um), a smaller profile_crowning",
        {"coast": {"lengthwise_crowning": 60.0, "profile_crowning": 30.0, "bias": -15.0}},
    ),
    "free": (
        {**FORMATE, "outer_transverse_module": 4.0, "pinion": {"free": ["cutter_tilt"]}},
        "drive: fillet contact: gear tip on the pinion's fillet: a pair of teeth touches within both flanks from 0.77",
        "more settings in pinion.free (3.76 um RMS of the wanted ease-off are left) or",
        {
            **FORMATE,
            "outer_transverse_module": 4.0,
            "pinion": {"free": ["cutter_tilt", "blade_pressure_angle", "modified_roll"]},
        },
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_what_is_named_first_helps(case: str) -> None:
    refused, where, first, helped = CASES[case]
    with pytest.raises(EdgeContact) as error:
        verdict(design(checked({**BASE, **refused}, DesignData, case)))
    assert where in str(error.value)
    assert f": {first}" in str(error.value)
    verdict(design(checked({**BASE, **helped}, DesignData, case)))

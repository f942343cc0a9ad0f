"""A virtual gear of 24 teeth, module 1, 20 mm wide, 12 gashes, feed 1 mm; beside it others that may cost more.

Twice the teeth, half the feed, and one whose machine has every error that a file may state, with who is to blame.
"""

from __future__ import annotations

import pytest

from gearmath.gearbox.hobbed.setup import blame, cut_and_inspect, setup
from gearmath.specs.cutting_errors import CuttingErrors
from gearmath.specs.hobbing import find_hobbing_machine

EVERY_ERROR = {
    "worm": [{"amplitude_arcsec": 40.0}, {"amplitude_arcsec": 10.0, "order": 2, "phase": 30.0}],
    "wheel": [{"amplitude_arcsec": 20.0}],
    "encoder": [{"amplitude_arcsec": 60.0}],
    "speed_ripple": [{"amplitude_percent": 2.0}],
    "motor_time_constant_ms": 5.0,
    "stop_in_cut_mm": 3.0,
    "run_up_seconds": 0.5,
    "microstep_percent": 5.0,
    "backlash_taken_by_cut": True,
    "hob_eccentricity_um": 8.0,
    "hob_axial_runout_um": 4.0,
    "hob_lead_um_per_turn": 2.0,
    "hob_starts_um": [0.0],
    "feed": [{"amplitude_um": 3.0}],
    "blank_eccentricity_um": 10.0,
    "blank_tilt_um_per_100mm": 5.0,
}


@pytest.mark.parametrize(("teeth", "feed"), [(24, 1.0), (48, 1.0), (24, 0.5)])
def test_cut_and_inspect(benchmark, teeth, feed):
    prepared = setup(find_hobbing_machine("hobbing_default.toml"), teeth, hob="m1", feed=feed, face_width=20.0)
    benchmark.group = "virtual hobbing"
    found = benchmark(cut_and_inspect, prepared, "exact")
    assert found.accuracy_class is not None


def test_every_error_and_who_is_to_blame(benchmark):
    errors = CuttingErrors.model_validate(EVERY_ERROR)
    machine = find_hobbing_machine("hobbing_default.toml").model_copy(update={"errors": errors})
    prepared = setup(machine, 24, hob="m1", feed=1.0, face_width=20.0)
    benchmark.group = "virtual hobbing"
    shares = benchmark(lambda: blame(prepared, cut_and_inspect(prepared, "exact")))
    assert shares[0].source == "stop_in_cut_mm"

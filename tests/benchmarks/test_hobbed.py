"""A virtual gear of 24 teeth, module 1, 20 mm wide, 12 gashes, feed 1 mm; beside it one of twice the teeth."""

from __future__ import annotations

import pytest

from gearmath.gearbox.hobbed.setup import cut_and_inspect, setup
from gearmath.specs.hobbing import find_hobbing_machine


@pytest.mark.parametrize("teeth", [24, 48])
def test_cut_and_inspect(benchmark, teeth):
    prepared = setup(find_hobbing_machine("hobbing_default.toml"), teeth, hob="m1", feed=1.0, face_width=20.0)
    benchmark.group = "virtual hobbing"
    found = benchmark(cut_and_inspect, prepared, "exact")
    assert found.accuracy_class is not None

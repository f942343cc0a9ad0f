"""How long a whole cutting program takes, from settings to text."""

from __future__ import annotations

import pytest

from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.machine.writing.cutting import cutting_program
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled


@pytest.mark.benchmark(group="cutting program")
def test_program_of_all_36_teeth(benchmark) -> None:
    gear_set = load_bevel_set(bundled("nasa_tp3096_12x36.toml"))
    machine = load_milling_machine(bundled("vertical_5axis.toml"))
    cutting_program(gear_set, "gear", machine, "GEAR")  # derives and lowers, once per process
    text = benchmark(cutting_program, gear_set, "gear", machine, "GEAR", CuttingJob(range(36)))
    assert text.count("; section") == 36
    if benchmark.stats is not None:  # not with --benchmark-disable
        benchmark.extra_info["blocks"] = text.count("G93")
        print(f"\n36 teeth, {text.count('G93')} blocks in {benchmark.stats['min']:.2f} s (goal 0.5 s)")

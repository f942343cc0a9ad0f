"""Tables and examples of docs/virtual_hobbing.md, cut again."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

from gearmath.gearbox.helix import Helix
from gearmath.gearbox.hobbed.setup import blame, cut_and_inspect, setup
from gearmath.specs.cutting_errors import CuttingErrors
from gearmath.specs.hob import Hob
from gearmath.specs.hobbing import find_hobbing_machine

PAGE = Path(__file__).parents[4].joinpath("docs", "virtual_hobbing.md").read_text("utf-8")
ROWS = re.findall(
    r"^\| (\d+) teeth, module ([\d.]+)(?:, (\d+)° (left|right))? \| `(\w+\.toml)` "
    r"\| (\d+) \| (\d+) \| (\d+) \| (\d+) \| ([\d.]+) \|$",
    PAGE,
    re.MULTILINE,
)


def test_table_of_parts_is_read_as_a_whole():
    assert len(ROWS) == len(re.findall(r"^\| \d+ teeth", PAGE, re.MULTILINE)) == 5


@pytest.mark.parametrize("row", ROWS, ids=lambda row: "-".join(row))
def test_parts_of_the_table_reach_their_class(row):
    teeth, module, angle, hand, name, wanted, microsteps, lines, gashes, feed = row
    machine = find_hobbing_machine(name)
    known = next((hob for hob in machine.hobs if hob.module_mm == float(module)), None)
    hob = (known or Hob(module=float(module), depth_rule="2.25m")).model_copy(update={"gashes": int(gashes)})
    parts = {
        "table": machine.table.model_copy(update={"microsteps": int(microsteps)}),
        "encoder": machine.encoder.model_copy(update={"lines": int(lines)}),
        "hobs": (hob,),
    }
    helix = Helix(float(angle), hand) if angle else None
    prepared = setup(machine.model_copy(update=parts), int(teeth), helix=helix, feed=float(feed))
    assert cut_and_inspect(prepared, "exact").accuracy_class <= int(wanted)


def test_errors_of_the_page_take_the_class_that_it_says():
    section = re.search(r"^```toml\n(\[errors\]\n.*?)^```", PAGE, re.MULTILINE | re.DOTALL)[1]
    said = re.search(r"cuts class (\d+); .*? class (\d+),.* (\d+) %", PAGE, re.DOTALL)
    without, with_errors, share = map(int, said.groups())
    machine = find_hobbing_machine("hobbing_default.toml")
    assert cut_and_inspect(setup(machine, 24, hob="m1"), "exact").accuracy_class == without
    wrong = machine.model_copy(update={"errors": CuttingErrors.model_validate(tomllib.loads(section)["errors"])})
    prepared = setup(wrong, 24, hob="m1")
    gear = cut_and_inspect(prepared, "exact")
    assert gear.accuracy_class == with_errors
    shares = {each.source: each for each in blame(prepared, gear)}
    assert shares["blank_eccentricity_um"].pitch_percent == pytest.approx(share, abs=1.0)

"""Refusals that no other test runs: one sentence that names what is wrong, status 2, nothing written."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.errors import InputError
from gearmath.quality.correction.target import flank_target
from gearmath.specs.flank_csv import write_flank_csv
from gearmath.specs.toml import bundled

SET = "nasa_tp3096_12x36.toml"


def measured(gear_set, flank="concave", tooth=0):
    file = nominal_flank(gear_set.pinion, flank, blank_grid(gear_set.pinion), tooth=tooth)
    return replace(file, deviation=np.zeros(len(file)))


def test_touches_on_an_artefact_that_the_probe_file_does_not_have(refused, tmp_path):
    probe = tmp_path / "bare.toml"
    kept = re.split(r"^\[", bundled("probe.toml").read_text("utf-8"), flags=re.MULTILINE)
    probe.write_text("[".join(part for part in kept if not part.startswith(("ring", "sphere", "work_sphere"))), "utf-8")
    raw = tmp_path / "raw.csv"
    raw.write_text("run,point,target,X,Y,Z,A,B,triggered\n1,1,ring_x_low,-20,0,80,0,0,1\n")
    refused(
        r"bare\.toml has neither the ring nor the sphere that was touched$",
        "calibrate",
        raw,
        "--calibration",
        probe,
        "-o",
        tmp_path / "tip.toml",
    )
    assert not (tmp_path / "tip.toml").exists()


@pytest.mark.parametrize(
    ("key", "value", "sentence"),
    [
        ("margins", "0.1,0.2", r": .*the measured point lies .* mm beside the nominal normal"),  # another grid
        ("member_teeth", "13", r": member_teeth = 13: the pinion of the set has 12"),
        ("settings_sha256", "0" * 64, r": settings_sha256 = 000000000000\.\.\.: .*other nominal settings"),
        ("grid", "4x9", r", line \d+: row = 4: the header allows 0 to 3"),
        ("reference_point", "5,0", r": reference_point = 5,0: must lie in the grid 5x9"),
        ("unit", "inch", r".*: unit = 'inch': must be mm"),
    ],
)
def test_header_that_does_not_fit_the_set(refused, gear_set, tmp_path, key, value, sentence):
    file = measured(gear_set)
    path = tmp_path / "m.csv"
    write_flank_csv(path, replace(file, header=file.header | {key: value}))
    refused(rf"m\.csv{sentence}", "evaluate", path, "--set", SET)


def test_flank_of_which_every_point_is_excluded(gear_set):
    file = measured(gear_set)
    with pytest.raises(InputError, match=r"^concave flank: every point is excluded$"):
        flank_target(gear_set.pinion, "concave", file, excluded=np.ones(len(file), dtype=bool))

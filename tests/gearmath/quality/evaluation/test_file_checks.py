"""Files whose rows are meant otherwise than they say are refused with what most of them would fit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.errors import InputError
from gearmath.quality.evaluation.file_checks import check_points
from gearmath.quality.evaluation.nominal import nominal_rows
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import join


@pytest.fixture(scope="module")
def good(gear_set):
    """A pinion, tooth 0 in full and the reference points of the others, 5 to 45 um of metal left on."""
    files = []
    for flank in FLANKS:
        for tooth in range(12):
            one = nominal_flank(gear_set.pinion, flank, blank_grid(gear_set.pinion), tooth=tooth)
            files.append(one if tooth == 0 else one.pick((one.row == 2) & (one.col == 4)))
    file = join(files)
    left = 1e-3 * (5.0 + 10.0 * file.row)
    return replace(file, deviation=left, point=file.point + left[:, None] * file.normal)


OTHERWISE = {
    "flanks": (
        lambda file: replace(file, flank=np.where(file.flank == FLANKS[0], FLANKS[1], FLANKS[0])),
        "concave and convex are exchanged",
    ),
    "rows": (lambda file: replace(file, row=4 - file.row), "rows count from tip to root"),
    "columns": (lambda file: replace(file, col=8 - file.col), "columns count from heel to toe"),
    "teeth the other way": (lambda file: replace(file, tooth=-file.tooth % 12), "teeth count the other way"),
    "teeth from 1": (lambda file: replace(file, tooth=file.tooth % 12 + 1), "teeth are counted from 1"),
    "other sign": (
        lambda file: replace(file, deviation=-file.deviation),
        "it is -1 times that at nearly all points, they have the other sign",
    ),
    "deviations in mm": (lambda file: replace(file, deviation=file.deviation / 1000), "they are mm"),
    "set-up": (
        lambda file: replace(file, point=file.point + np.array([0.03, 0.02, 0.04])),
        "nearly all points are, by 0.0.. mm in the middle: work offset or tool length",
    ),
}


@pytest.mark.parametrize("name", OTHERWISE)
def test_what_most_rows_would_fit_is_named(gear_set, good, name):
    change, words = OTHERWISE[name]
    file = change(good)
    with pytest.raises(InputError, match=words):
        check_points(file, nominal_rows(file, gear_set.pinion), gear_set.pinion)


def test_one_point_off_is_no_other_way_to_count(gear_set, good):
    point = good.point - good.deviation[:, None] * good.normal
    point[17] += [0.3, 0, 0.3]
    file = replace(good, deviation=0 * good.deviation, point=point)
    with pytest.raises(InputError, match="1 of 112 points are off the flank"):
        check_points(file, nominal_rows(file, gear_set.pinion), gear_set.pinion)


def test_good_file_passes(gear_set, good):
    check_points(good, nominal_rows(good, gear_set.pinion), gear_set.pinion)

"""An indexing error of the tooth that is measured in full is no error of a setting."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.identify.flank_target import predicted
from gearmath.bevel.nominal_file import flank_header, nominal_flank
from gearmath.bevel.turning import turned
from gearmath.quality.correction.member import correct
from gearmath.quality.correction.own_index import teeth_as_indexed_on_average
from gearmath.quality.correction.representative import passed_over, representative_tooth
from gearmath.quality.correction.target import target_of
from gearmath.specs.bevel_set import FLANKS, SETTINGS
from gearmath.specs.flank_csv import flank_file, join

ROW, COL = (index.ravel() for index in np.indices((5, 9)))
PHASE, RADIAL = (SETTINGS.index(name) for name in ("work_rotation_offset", "radial_distance"))
UM = 1e-3


def pinion_with_one_tooth_indexed(gear_set, arcs, noise=0.0, others=True, radial=0.0):
    """Every flank of tooth 0 is cut turned by an arc [mm] at the reference point: exact, by its rotation offset.

    The other teeth have their reference points where they belong. All flanks are off by ``radial`` [mm] besides.
    """
    member, files, random = gear_set.pinion, [], np.random.default_rng(0)
    header = flank_header(member, (5, 9))
    for flank in FLANKS:
        at = solve_flank(member, flank, blank_grid(member))
        target = target_of(member, flank, at)
        for tooth in range(12 if others else 1):
            settings, keep = target.settings.copy(), slice(None) if tooth == 0 else slice(22, 23)
            settings[RADIAL] += radial
            if tooth == 0:
                settings[PHASE] -= arcs[flank] / np.hypot(*at.point[22, :2])
            d = predicted(target, settings)[0][keep]
            d = d + noise * random.standard_normal(len(d))
            point, normal = (turned(each[keep], 2 * np.pi * tooth / 12) for each in (at.point, at.normal))
            files.append(
                flank_file(header, "pinion", flank, tooth, ROW[keep], COL[keep], point + d[:, None] * normal, normal, d)
            )
    return join(files)


@pytest.mark.parametrize("flanks", [FLANKS, ("concave",), ("convex",)], ids="+".join)
@pytest.mark.parametrize("arc", [20, -100])
def test_indexing_error_of_the_measured_tooth_changes_no_setting(gear_set, arc, flanks):
    """20 to 100 um, of both flanks or of one, where nothing of the rotation of the work is left open."""
    arcs = {flank: arc * UM if flank in flanks else 0.0 for flank in FLANKS}
    found = correct(gear_set.pinion, pinion_with_one_tooth_indexed(gear_set, arcs), few=True)
    for flank in FLANKS:
        np.testing.assert_array_equal(found.settings[flank], gear_set.pinion.flank(flank).vector)
        assert found.expected[flank] < 0.02 * UM
    said = [line for line in found.remarks if "is indexed by an arc of" in line]
    assert [line.split()[0] for line in said] == list(flanks)
    assert all(
        f"an arc of {arc:+d}" in line or abs(float(line.split("arc of ")[1].split()[0]) - arc) < 0.5 for line in said
    )


def test_hobbed_member_is_not_told_to_leave_it_to_an_index_that_it_has_not(gear_set):
    """The words alone: the file is that of a milled pinion."""
    file = pinion_with_one_tooth_indexed(gear_set, dict.fromkeys(FLANKS, 20 * UM))
    hobbed = gear_set.pinion.model_copy(update={"blade_groups": 13})
    for member, words in ((gear_set.pinion, "it is left to the index"), (hobbed, "face hobbing cannot turn one tooth")):
        _, remarks = teeth_as_indexed_on_average(member, file)
        assert [words in line for line in remarks] == [True, True]


def test_error_of_a_setting_is_found_under_an_indexing_error_and_noise(gear_set):
    arcs = {"concave": 60 * UM, "convex": 30 * UM}
    file = pinion_with_one_tooth_indexed(gear_set, arcs, noise=0.5 * UM, radial=0.05)
    found = correct(gear_set.pinion, file, few=True, noise=0.5 * UM)
    for flank in FLANKS:
        change = found.settings[flank] - gear_set.pinion.flank(flank).vector
        assert list(np.flatnonzero(change)) == [RADIAL]
        assert change[RADIAL] == pytest.approx(-0.05, abs=0.01)


def test_one_tooth_alone_says_that_its_index_is_not_known(gear_set):
    file = pinion_with_one_tooth_indexed(gear_set, dict.fromkeys(FLANKS, 0.0), others=False)
    found = correct(gear_set.pinion, file, few=True)
    (line,) = found.remarks
    assert line.startswith("concave and convex flank: fewer than 4 teeth")
    assert "the settings are changed for it; measure more teeth" in line


@pytest.mark.parametrize("sign", [1, -1], ids=["thick", "indexed"])
def test_tooth_far_off_the_others_moves_no_setting(gear_set, sign):
    """80 um on both flanks of space 4, which has its reference points only: metal left on, or an error of its index."""
    file = pinion_with_one_tooth_indexed(gear_set, dict.fromkeys(FLANKS, 0.0))
    off = 80 * UM * (file.tooth == 4) * np.where(file.flank == "convex", sign, 1)
    file = replace(file, deviation=file.deviation + off, point=file.point + off[:, None] * file.normal)
    found = correct(gear_set.pinion, file, few=True)
    for flank in FLANKS:
        np.testing.assert_array_equal(found.settings[flank], gear_set.pinion.flank(flank).vector)
        assert f"{flank} flank: without tooth 4, far off the others: the settings are corrected" in " ".join(
            found.remarks
        )


@pytest.mark.parametrize("odd", [0, 2])
def test_tooth_whose_form_is_unlike_the_others_is_not_the_one_that_is_corrected(gear_set, odd):
    """Four teeth in full, one of them with 20 um of spiral angle; of two teeth none is known to be the odd one."""
    files = []
    for tooth in range(4):
        one = nominal_flank(gear_set.pinion, "concave", blank_grid(gear_set.pinion), tooth=tooth)
        files.append(replace(one, deviation=20 * UM * (one.col / 4 - 1) * (tooth == odd) + 5 * UM * tooth))
    right = min(set(range(4)) - {odd})
    assert representative_tooth(join(files), "concave") == right
    said = passed_over(join(files), "concave")
    if odd == 0:
        assert said == (
            "concave flank: the form of tooth 0 deviates by 12.9 um (RMS) from the median of 4 teeth; the settings are "
            "corrected from tooth 1"
        )  # 20 um times the RMS of -1, -0.75 ... 1
    else:
        assert said is None
    assert representative_tooth(join(files[:2]), "concave") == 0

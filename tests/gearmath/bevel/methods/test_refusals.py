"""What cannot be cut is refused in one sentence with the limit, and by the command with status 2."""

from __future__ import annotations

import pytest
import tomlkit

from gearmath.bevel.crown_gear import Method
from gearmath.errors import InputError
from gearmath.specs.toml import bundled

HOBBED, MILLED = bundled("crown_gear_hobbed_14x39.toml"), bundled("crown_gear_formate_14x39.toml")

REFUSALS = {
    "cutter far too small": (
        MILLED,
        ("pinion", "convex"),
        {"blade_point_radius": 6.0, "radial_distance": 20.0},
        r"pinion.*convex: no real contact, .*, or blade_point_radius = 6 between 39\.89 and 122\.7",
    ),
    "machine root angle beyond the blank": (
        MILLED,
        ("gear", "concave"),
        {"machine_root_angle": 80.0},
        r"gear.*concave\.machine_root_angle = 80: beyond the blank, it must be at most face_angle .* \+ 1 = 72\.9787",
    ),
    "root angle of the blank above its pitch angle": (
        MILLED,
        ("pinion", "blank"),
        {"root_angle": 22.0},
        r"pinion\.blank: root_angle 22\.0 <= pitch_angle",
    ),
    "both of one hand": (
        MILLED,
        ("gear",),
        {"hand": "left"},
        r"pinion and gear are both left hand: a pair has one of each hand",
    ),
    "no blade group": (HOBBED, ("pinion",), {"blade_groups": 0}, r"pinion\.blade_groups = 0: must be at least 1"),
    "blade groups of a face mill": (MILLED, ("gear",), {"blade_groups": 5}, r"blade_groups belongs to face_hobbing"),
    "indexing of a face mill": (MILLED, ("gear",), {"indexing_sign": -1}, r"indexing_sign belongs to face_hobbing"),
    "indexing neither way": (HOBBED, ("gear",), {"indexing_sign": 2}, r"gear\.indexing_sign = 2: .*1 or -1"),
    "negative size": (
        MILLED,
        ("pinion", "blank"),
        {"mean_cone_distance": -81.0},
        r"pinion\.blank\.mean_cone_distance = -81\.0: .*greater than 5",
    ),
}


@pytest.mark.parametrize("case", REFUSALS)
def test_set_is_refused_in_one_sentence_with_the_limit(refused, tmp_path, case):
    source, path, changes, sentence = REFUSALS[case]
    document = tomlkit.parse(source.read_text())
    table = document
    for key in path:
        table = table[key]
    table.update(changes)
    target = tmp_path / "set.toml"
    target.write_text(tomlkit.dumps(document))
    refused(sentence, "flank", target, "--member", "pinion", "--flank", "convex", "-o", tmp_path / "flank.csv")
    assert not (tmp_path / "flank.csv").exists()


def test_negative_module_is_refused(design):
    with pytest.raises(ValueError, match="outer_transverse_module"):
        design(wheel_outer_pitch_diameter=None, outer_transverse_module=-4.5)


def test_blade_groups_that_do_not_fit_on_the_cutter_are_refused_with_the_limit(pair):
    with pytest.raises(InputError, match=r"30 blade groups .* must be below the diameter"):
        pair(blade_groups=30, cutter_radius=45.0)


@pytest.mark.parametrize("changes", [{"cutter_radius": 12.0}, {"cutter_radius": 15.0, "blade_groups": 3}])
def test_cutter_smaller_than_the_method_allows_is_refused_with_the_limit(pair, changes):
    with pytest.raises(InputError, match=r"cutter_radius = 1[25]: .*(at least|larger)"):
        pair(**changes)


def test_tilted_cut_of_both_flanks_is_refused(pair):
    with pytest.raises(InputError, match=r"tilt = 5\.73: a cut of both flanks must be untilted"):
        pair(Method("completing", tilt=0.1))


def test_hobbing_one_flank_alone_is_refused(pair):
    with pytest.raises(InputError, match="face hobbing cuts both flanks at once"):
        pair(Method("fixed_setting"), blade_groups=13, cutter_radius=76.0)

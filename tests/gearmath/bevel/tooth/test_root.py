"""Widths of a root and of the slot that a cutter makes, against the cutter's own size and against AGMA 929."""

from __future__ import annotations

import math

import pytest

from gearmath.bevel.blank import blank_of
from gearmath.bevel.crown_gear import Method, crown_gear_set
from gearmath.bevel.root import Widths
from gearmath.bevel.slots import slots_of
from gearmath.bevel.tooth import space_widths
from gearmath.specs.bevel_set import FLANKS, Member, load_bevel_set
from gearmath.specs.blank_data import BlankData
from gearmath.specs.toml import bundled


def member(name: str, which: str) -> Member:
    return load_bevel_set(bundled(f"{name}.toml")).member(which)


def places(widths: Widths) -> list[float]:
    return [widths.toe, widths.mean, widths.heel]


COMPLETING = (
    ("nasa_tp3096_12x36", "gear"),
    ("crown_gear_formate_14x39", "gear"),
    ("crown_gear_universal_14x39", "gear"),
    ("crown_gear_hobbed_14x39", "pinion"),
    ("crown_gear_hobbed_14x39", "gear"),
)


@pytest.mark.parametrize(("name", "which"), COMPLETING)
def test_slot_of_a_cut_of_both_flanks_is_the_point_width_of_its_cutter(name: str, which: str) -> None:
    """Generated or not, milled or hobbed: to what the flat of the blade, taken a tenth of a degree steep, makes of it;
    one blade of a hobbing cutter follows the other."""
    spec = member(name, which)
    width = spec.concave.blade_point_radius - spec.convex.blade_point_radius
    _, slots = space_widths(spec)
    for flank in FLANKS:
        assert places(slots[flank]) == pytest.approx([width] * 3, abs=2e-3 if spec.blade_groups else 5e-4)


def test_root_of_a_formate_space_is_the_point_width_of_its_cutter() -> None:
    """Nothing rolls: the root lies between two circles of the cutter about one axis, here as polygons."""
    spec = member("crown_gear_formate_14x39", "gear")
    width = spec.concave.blade_point_radius - spec.convex.blade_point_radius
    root, _ = space_widths(spec)
    assert [*places(root), root.least, root.most] == pytest.approx([width] * 5, abs=5e-5)


def test_generated_root_is_narrower_than_its_slot_as_the_root_of_the_virtual_gear_is_smaller_than_its_pitch_circle():
    """A flat of a rack that rolls on r leaves an arc of r_f / r of its width on the root circle r_f."""
    spec = member("nasa_tp3096_12x36", "pinion")
    root, slots = space_widths(spec)
    virtual = 81.0514 * math.tan(math.radians(18.4333333)) / math.cos(math.radians(35)) ** 2
    assert root.mean / slots["concave"].mean == pytest.approx(1 - 2.216780765284 / virtual, abs=2e-3)


@pytest.mark.parametrize("ratio", [(14, 39), (17, 40), (20, 31)])
def test_mean_slot_of_a_pinion_cut_flank_by_flank_is_that_of_agma_929(ratio: tuple[int, int]) -> None:
    """To a hundredth of the module. AGMA's slots at toe and heel are those of the mate's tooth, not of two cutters."""
    data = BlankData.model_validate(
        {
            "title": "test",
            "source": "test",
            "shaft_angle": 90.0,
            "wheel_outer_pitch_diameter": 176.893,
            "face_width": 25.4,
            "pressure_angle_drive": 20.0,
            "pressure_angle_coast": 20.0,
            "pinion_teeth": ratio[0],
            "wheel_teeth": ratio[1],
            "mean_spiral_angle": 35.0,
            "cutter": {"process": "face_milling", "cutter_radius": 114.3},
            "taper": {"kind": "duplex"},
            "data_type_1": {
                "crown_gear_addendum_factor": 1.0,
                "crown_gear_dedendum_factor": 1.25,
                "profile_shift_coefficient": 0.3,
                "thickness_modification": 0.03,
            },
            "backlash": {"outer_normal": 0.127},
        }
    )
    pair, blank = crown_gear_set(data, Method("fixed_setting"), Method()), blank_of(data)
    _, wanted, _ = slots_of(blank).pinion.slot_width
    _, slots = space_widths(pair.pinion)
    for flank in FLANKS:
        assert slots[flank].mean == pytest.approx(wanted, abs=0.01 * blank.mean_normal_module)

"""Tooth thickness on request, against teeth whose surfaces are solved again."""

from __future__ import annotations

import numpy as np
import pytest

from gearmath.bevel.flank import Grid, blank_grid, solve_flank
from gearmath.errors import InputError
from gearmath.quality.correction.thickness import with_thickness
from gearmath.specs.bevel_set import FLANKS, SETTINGS, load_bevel_set
from gearmath.specs.toml import bundled

CASES = [
    ("nasa_tp3096_12x36", "pinion", "work_rotation_offset"),
    ("nasa_tp3096_12x36", "pinion", "sliding_base"),
    ("nasa_tp3096_12x36", "gear", "sliding_base"),
    ("crown_gear_formate_14x39", "gear", "sliding_base"),
    ("crown_gear_universal_14x39", "pinion", "work_rotation_offset"),
    ("crown_gear_hobbed_14x39", "pinion", "sliding_base"),
]


def gained(member, settings):
    """What both flanks of other settings have more at the middle of the tooth, along the normals, together."""
    total = 0.0
    grid = blank_grid(member, 3, 3)
    middle = Grid(grid.axial[1:2, 1:2], grid.radial[1:2, 1:2])
    for flank in FLANKS:
        nominal = solve_flank(member, flank, middle)
        names = {
            n: float(np.degrees(v) if unit else v)
            for n, v, unit in zip(
                SETTINGS,
                settings[flank],
                [s.endswith(("angle", "tilt", "swivel", "offset")) and s != "blank_offset" for s in SETTINGS],
                strict=True,
            )
        }
        other = member.model_copy(update={flank: member.flank(flank).model_copy(update=names)})
        t = 0.0
        for _ in range(4):  # the tangent plane of the other surface at the place where the normal is
            on_line = nominal.point + t * nominal.normal
            place = Grid(on_line[:, 2:3], np.hypot(on_line[:, 0:1], on_line[:, 1:2]))
            surface = solve_flank(other, flank, place)
            t += float(np.sum((surface.point - on_line) * surface.normal) / np.sum(surface.normal * nominal.normal))
        total += t
    return total


@pytest.mark.parametrize("change", [0.03, -0.02])
@pytest.mark.parametrize(("set_name", "name", "by"), CASES)
def test_teeth_become_thicker_by_what_was_asked(set_name, name, by, change):
    member = load_bevel_set(bundled(f"{set_name}.toml")).member(name)
    settings = {flank: member.flank(flank).vector for flank in FLANKS}
    found = with_thickness(member, settings, change, by)
    assert gained(member, found) == pytest.approx(change, abs=1e-7)
    moved = {flank: found[flank] - settings[flank] for flank in FLANKS}
    for flank in FLANKS:
        assert list(np.flatnonzero(moved[flank])) == [SETTINGS.index(by)]
    if by == "sliding_base":
        np.testing.assert_array_equal(moved["concave"], moved["convex"])
        assert np.sign(moved["concave"].sum()) == np.sign(change)  # withdrawn: less deep, thicker


def test_what_the_cut_does_not_allow_is_refused():
    pair = load_bevel_set(bundled("nasa_tp3096_12x36.toml"))
    settings = {flank: pair.gear.flank(flank).vector for flank in FLANKS}
    with pytest.raises(InputError, match=r"^gear: one cut makes both flanks, .* from the sliding_base$"):
        with_thickness(pair.gear, settings, 0.01)
    with pytest.raises(InputError, match=r"^thickness = 2 mm: must lie between -0\.5 and 0\.5 mm$"):
        with_thickness(pair.gear, settings, 2.0, "sliding_base")

"""What is expected to remain, against the flank of the corrected settings, solved on the blank by another solver."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.generation import solve_section
from gearmath.bevel.identify.variables import FREE
from gearmath.bevel.method import blade_sections, cut_generation_of
from gearmath.bevel.nominal_file import flank_header
from gearmath.quality.correction.member import ROOT_LIMIT, correct
from gearmath.specs.bevel_set import FLANKS, load_bevel_set
from gearmath.specs.flank_csv import flank_file, join
from gearmath.specs.set_text import save_corrected
from gearmath.specs.toml import bundled

SOURCE = bundled("nasa_tp3096_12x36.toml")
PINION = load_bevel_set(SOURCE).pinion
ROW, COL = (index.ravel() for index in np.indices((5, 9)))
Y, X = ROW / 2 - 1, COL / 4 - 1


def nominal(flank):
    return solve_flank(PINION, flank, blank_grid(PINION))


def measured(shape):
    """Tooth 0 of the pinion with the deviations (45,) [mm] that ``shape(flank)`` says, the work not turned."""
    files = []
    for flank in FLANKS:
        at, d = nominal(flank), shape(flank)
        point = at.point + d[:, None] * at.normal
        files.append(flank_file(flank_header(PINION, (5, 9)), "pinion", flank, 0, ROW, COL, point, at.normal, d))
    return join(files)


def deviation_on_the_blank(member, flank):
    """Deviations (45,) [mm] of the flank that the settings of a member cut: by the solver on the blank.

    Followed from the nominal settings in small changes, as they may be large.
    """
    how, at, t = cut_generation_of(member, flank), nominal(flank), np.zeros(45)
    section, first = blade_sections(member.flank(flank), how.side)["main"], PINION.flank(flank).vector
    contact = at.contact
    for part in np.minimum(np.arange(1, 45) / 40, 1.0):
        x = first + part * (how.settings - first)
        on_line = at.point + t[:, None] * at.normal
        points = solve_section(
            replace(how, settings=x),
            replace(section, point_radius=x[10], pressure_angle=x[11]),
            on_line[:, 2],
            np.hypot(on_line[:, 0], on_line[:, 1]),
            start=contact,
        )
        assert points.converged.all()
        contact, off = points.contact, np.sum((points.point - on_line) * points.normal, axis=1)
        t = t + off / np.sum(at.normal * points.normal, axis=1)
    return t


def ease_off(flank):
    """75 um at two corners: length crowning, profile crowning and twist, as a design asks for it."""
    return 0.075 * (0.4 * X**2 + 0.25 * Y**2 + 0.35 * X * Y)


def large_error(flank):
    """30 um of a machine that is off, with a ripple that no setting takes away."""
    return 0.03 * X * (1 if flank == "concave" else -1) + 0.012 * X**2 + 0.002 * np.sin(2.1 * ROW + 1.3 * COL)


@pytest.mark.parametrize(
    ("shape", "options"),
    [
        (
            ease_off,
            {
                "free": (*FREE, "cutter_tilt", "cutter_swivel", "blade_point_radius", "blade_pressure_angle"),
                "bounds": "design",
                "root_limit": 0.025,
            },
        ),
        (large_error, {}),
        (large_error, {"few": True}),
    ],
    ids=["design", "machine", "few"],
)
def test_what_is_expected_to_remain_is_what_the_written_settings_leave(tmp_path, shape, options):
    """Measured deviations and the flank of the written set together, to a nanometre, point by point."""
    found = correct(PINION, measured(shape), **options)
    save_corrected(SOURCE, tmp_path / "corrected.toml", "pinion", found.settings, None, found.motions)
    written = load_bevel_set(tmp_path / "corrected.toml").pinion
    for flank in FLANKS:
        left = shape(flank) + deviation_on_the_blank(written, flank)
        np.testing.assert_allclose(left, found.identified[(flank,)].residual, rtol=0, atol=1e-6)
        assert np.sqrt(np.mean(left**2)) == pytest.approx(found.rms[flank][1], abs=1e-6)
        assert np.abs(left).max() == pytest.approx(found.expected[flank], abs=1e-6)
        assert found.rms[flank][1] < 0.35 * found.rms[flank][0]


def test_second_correction_goes_on_from_the_settings_of_the_first(tmp_path):
    """The machine was set to corrected values; what is measured then is added to the flank that they cut."""
    first = correct(PINION, measured(large_error))
    save_corrected(SOURCE, tmp_path / "first.toml", "pinion", first.settings, None, first.motions)
    once = load_bevel_set(tmp_path / "first.toml").pinion
    left = {flank: first.identified[(flank,)].residual + 0.004 * X for flank in FLANKS}
    second = correct(once, measured(left.__getitem__), root_limit=ROOT_LIMIT)
    save_corrected(tmp_path / "first.toml", tmp_path / "second.toml", "pinion", second.settings, None, second.motions)
    twice = load_bevel_set(tmp_path / "second.toml").pinion
    for flank in FLANKS:
        change = deviation_on_the_blank(twice, flank) - deviation_on_the_blank(once, flank)
        np.testing.assert_allclose(left[flank] + change, second.identified[(flank,)].residual, rtol=0, atol=1e-6)
        assert second.rms[flank][1] < 0.5 * second.rms[flank][0]


def test_nothing_measured_changes_no_setting_that_was_corrected_before(tmp_path):
    first = correct(PINION, measured(large_error))
    save_corrected(SOURCE, tmp_path / "first.toml", "pinion", first.settings, None, first.motions)
    once = load_bevel_set(tmp_path / "first.toml").pinion
    again = correct(once, measured(lambda flank: np.zeros(45)), few=True)
    for flank in FLANKS:
        np.testing.assert_array_equal(again.settings[flank], once.flank(flank).vector)

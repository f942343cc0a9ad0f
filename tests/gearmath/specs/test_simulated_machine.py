"""The file of a simulated machine: what is not said is perfect, and what cannot be is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearmath.errors import InputError
from gearmath.specs.bevel_set import SETTINGS
from gearmath.specs.simulated_machine import SimulatedMachine, load_simulated_machine
from gearmath.specs.toml import bundled, parse

TEXT = bundled("simulated_shop.toml").read_text("utf-8")


def test_bundled_shop_in_mm_and_rad():
    shop = load_simulated_machine(bundled("simulated_shop.toml"))
    errors = dict(zip(SETTINGS, shop.setting_errors("pinion"), strict=True))
    assert {name: value for name, value in errors.items() if value} == pytest.approx(
        {
            "radial_distance": 0.017,
            "blank_offset": -0.012,
            "sliding_base": 0.007,
            "machine_root_angle": 0.009 * math.pi / 180,
            "ratio_of_roll": 0.00027,
        },
        rel=1e-15,
    )
    assert shop.work_axis.first_harmonic_arcsec == 45
    assert shop.probe.sigma_um == 0.5


def test_what_a_file_does_not_mention_is_perfect():
    perfect = parse('title = "perfect"\nseed = 0\n', SimulatedMachine, "s.toml")
    for member in ("pinion", "gear"):
        np.testing.assert_array_equal(perfect.setting_errors(member), np.zeros(len(SETTINGS)))
    assert (perfect.work_axis.random_arcsec, perfect.probe.sigma_um) == (0, 0)


def test_clamping_drift_and_averaging_in_mm():
    shop = load_simulated_machine(bundled("source_experiment.toml"))
    assert shop.measuring_clamp("gear") == shop.measuring.gear
    np.testing.assert_array_equal(shop.measuring.drift.vector, [0.0, 0.005, 0.0])
    assert shop.probe.sigma == pytest.approx(0.00025, rel=1e-15)


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("seed = 1", "", "seed: the key is missing"),
        ("seed = 1", "seed = -1", "seed = -1: must be at least 0"),
        ("seed = 1", "seed = 1.5", "seed = 1.5: must be a whole number"),
        ("radial_distance = 0.017", "radial_distance = 1.5", r"pinion.radial_distance = 1.5: must be at most"),
        ("radial_distance = 0.017", "radial_distance = nan", "pinion.radial_distance = nan: must be a finite number"),
        (
            "radial_distance = 0.017",
            'radial_distance = "17"',
            "pinion.radial_distance = '17': must be a number",
        ),
        ("radial_distance = 0.017", "radius = 0.017", "pinion.radius = 0.017: no such key is known here"),
        ("radial_distance = 0.017", "blade_point_radius = 0.01", "pinion.blade_point_radius = 0.01: no such key"),
        ("ratio_of_roll = 0.00027", "ratio_of_roll = 0.2", "pinion.ratio_of_roll = 0.2: must be at most"),
        ("sigma_um = 0.5", "sigma_um = -0.5", "probe.sigma_um = -0.5: must be at least 0"),
        ("sigma_um = 0.5", "sigma_um = inf", "probe.sigma_um = inf: must be a finite number"),
        (
            "random_arcsec = 6.0",
            "random_arcsec = 601.0",
            "work_axis.random_arcsec = 601.0: must be at most",
        ),
        ("[probe]", "[prober]", r"prober: no such key; did you mean probe\?"),
        ("sigma_um = 0.5", "touches = 0", "probe.touches = 0: must be at least 1"),
        ("sigma_um = 0.5", "lobing_um = 25.0", "probe.lobing_um = 25.0: must be at most 20"),
        ("[probe]", "[measuring.wheel]\ntilt = 0.1\n[probe]", "measuring.wheel: no such key is known here"),
        ("[probe]", "[measuring.gear]\ntilt = 2.0\n[probe]", "measuring.gear.tilt = 2.0: must be at most"),
        ("[probe]", "[measuring.drift]\nA_um = 2.0\n[probe]", "measuring.drift.A_um: no such key; did you mean Z_um"),
        (
            "[probe]",
            '[[axes.screws]]\naxis = "A"\nlead = 5.0\namplitude_um = 1.0\n[probe]',
            "axes.screws #1.axis = 'A': must be 'X', 'Y' or 'Z'",
        ),
    ],
)
def test_fault_is_refused_by_file_key_value_and_limit(old, new, sentence):
    assert old in TEXT
    with pytest.raises(InputError, match=r"^s\.toml: " + sentence):
        parse(TEXT.replace(old, new, 1), SimulatedMachine, "s.toml")

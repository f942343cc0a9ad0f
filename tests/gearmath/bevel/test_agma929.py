"""AGMA 929-B22, annex C: top land, slot widths and edge radius of the spiral bevel pair 14 x 39, to 0.001 mm.

The example takes depths, thicknesses and cone distances as they stand, rounded from inches, so they replace those of
the blank; what AGMA adds to them is compared.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.blank import BevelBlank, blank_of, evaluate
from gearmath.bevel.slots import slots_of
from gearmath.specs.blank_data import load_blank_data
from gearmath.specs.toml import bundled

PRINTED = 0.001  # mm, the agreement that the issue asks for; the annex prints five decimals

#: Input of annex C. Members: pinion, wheel.
C = {
    "m_mn": 3.21331,
    "b": 25.4,
    "Re": 93.973,
    "Rm": 81.273,
    "delta": (19.7468, 70.2532),
    "theta_f": (2.2259, 6.4935),
    "c": 0.964,
    "ham": (4.83648, 1.58937),
    "hfm": (2.55337, 5.80048),
    "smn": (6.2788, 3.67226),
    "rc0": 114.3,
}
BETA_E, BETA_I = 36.84579, 33.94556  # degrees, output of the annex


@pytest.fixture(scope="module")
def annex() -> BevelBlank:
    """The blank of sample 1 with the numbers of annex C in place of its own."""
    blank = blank_of(load_blank_data(bundled("blank_iso23509_sample1.toml")))
    slope = [math.tan(math.radians(angle)) * C["b"] / 2 for angle in C["theta_f"]]
    members = []
    for own, member in enumerate((blank.pinion, blank.wheel)):
        mate = 1 - own
        members.append(
            replace(
                member,
                pitch_angle=math.radians(C["delta"][own]),
                dedendum_angle=math.radians(C["theta_f"][own]),
                mean_addendum=C["ham"][own],
                mean_dedendum=C["hfm"][own],
                inner_dedendum=C["hfm"][own] - slope[own],
                outer_dedendum=C["hfm"][own] + slope[own],
                inner_addendum=C["hfm"][mate] - slope[mate] - C["c"],
                outer_addendum=C["hfm"][mate] + slope[mate] - C["c"],
                mean_normal_thickness=C["smn"][own],
            )
        )
    return replace(
        blank,
        pinion=members[0],
        wheel=members[1],
        mean_normal_module=C["m_mn"],
        outer_cone_distance=C["Re"],
        mean_cone_distance=C["Rm"],
        inner_cone_distance=C["Re"] - C["b"],
        cutter_radius=C["rc0"],
        outer_spiral_angle=math.radians(BETA_E),
        inner_spiral_angle=math.radians(BETA_I),
        clearance=C["c"],
    )


@pytest.mark.parametrize(("end", "printed"), [("outer", BETA_E), ("inner", BETA_I)])
def test_spiral_angles_are_those_of_the_annex(annex: BevelBlank, end: str, printed: float) -> None:

    values = {"mean_cone_distance": C["Rm"], "mean_spiral_angle": math.radians(35.0), "cutter_radius": C["rc0"]}
    distance = {"outer": C["Re"], "inner": C["Re"] - C["b"]}[end]
    angle = evaluate("milled_spiral_angle", values, cone_distance=distance)["spiral_angle"]
    assert math.degrees(angle) == pytest.approx(printed, abs=5e-6 * 1.01)


def test_pitch_backlash_and_lengthwise_curvature(annex: BevelBlank) -> None:
    slots = slots_of(annex)
    assert slots.normal_pitch == pytest.approx(10.09492, abs=PRINTED)
    assert slots.outer_normal_backlash == pytest.approx(0.15270, abs=PRINTED)
    assert slots.clearance_change == pytest.approx(0.16887, abs=PRINTED)
    assert slots.involute_cone_distance == pytest.approx(148.58600, abs=PRINTED)


#: Inner, mean and outer values; then the blade's tip and the limits of the edge radius.
PINION = {
    "slot_width": (1.87892, 1.95742, 1.87263),
    "normal_thickness": (5.24748, 6.27880, 7.31241),
    "top_land": (2.29128, 1.83117, 1.36288),
    "blade_point_width": 0.96132,
    "edge_radius_interference": 1.23193,
    "edge_radius_fillet": 1.08727,
    "edge_radius_mutilation": 1.92869,
    "maximum_edge_radius": 1.08727,
}
WHEEL = {
    "slot_width": (2.20026, 2.20026, 2.20026),
    "normal_thickness": (3.25536, 3.67226, 3.92816),
    "top_land": (2.45566, 2.50681, 2.39535),
    "blade_point_width": 1.12513,
    "edge_radius_interference": 2.27601,
    "edge_radius_fillet": 1.32122,
    "edge_radius_mutilation": 2.20626,
    "maximum_edge_radius": 1.32122,
}


@pytest.mark.parametrize(("member", "printed"), [("pinion", PINION), ("wheel", WHEEL)])
def test_slots_top_lands_and_edge_radii_are_those_of_the_annex(annex: BevelBlank, member: str, printed: dict) -> None:
    slots = getattr(slots_of(annex), member)
    worst = {name: np.abs(np.subtract(getattr(slots, name), value)).max() for name, value in printed.items()}
    assert max(worst.values()) <= PRINTED, worst
    assert not slots.is_pointed


def test_top_land_is_what_an_involute_drawn_point_by_point_leaves() -> None:
    """Two flanks unrolled from the base circle, in the plane: their distance at the tip radius, as an arc."""

    r, h, s, alphas = 43.0, 4.8, 6.3, (math.radians(18), math.radians(23))
    tip_angles = []
    for alpha in alphas:
        base, unrolled = r * math.cos(alpha), np.linspace(0.0, 1.2, 400_001)
        radius = base * np.hypot(1.0, unrolled)
        polar = unrolled - np.arctan(unrolled)
        tip_angles.append(np.interp(r + h, radius, polar) - np.interp(r, radius, polar))
    drawn = (r + h) * (s / r - sum(tip_angles))
    values = {
        "virtual_pitch_radius": r,
        "addendum_here": h,
        "normal_thickness": s,
        "pressure_angle_drive": alphas[0],
        "pressure_angle_coast": alphas[1],
    }
    assert evaluate("top_land", values)["top_land"] == pytest.approx(drawn, abs=1e-7)


def test_backlash_closed_the_tips_reach_the_profile_at_the_height_of_interference(annex: BevelBlank) -> None:
    """Intermediate figures of the annex: virtual pitch radii at the toe and the limit heights above the root."""

    radii = []
    for member in (annex.pinion, annex.wheel):
        values = {
            "cone_distance": annex.inner_cone_distance,
            "pitch_angle": member.pitch_angle,
            "spiral_angle": annex.inner_spiral_angle,
        }
        radii.append(evaluate("virtual_gear", values)["virtual_pitch_radius"])
    assert radii == pytest.approx([35.76936, 277.57864], abs=PRINTED)
    for own, mate, height in ((0, 1, 0.81059), (1, 0, 1.49757)):
        members = (annex.pinion, annex.wheel)
        values = {
            "virtual_pitch_radius": radii[own],
            "mate_virtual_pitch_radius": radii[mate],
            "mate_addendum_here": members[mate].inner_addendum,
            "dedendum_here": members[own].inner_dedendum,
            "clearance_change": slots_of(annex).clearance_change,
            "flank_pressure_angle": math.radians(20),
        }
        found = evaluate("running_interference", values)["interference_height"]
        assert found == pytest.approx(height, abs=PRINTED)

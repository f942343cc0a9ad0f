"""Work that slips while the tooth that carries the topography is measured is found; form, index, dirt are no slip."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.bevel.turning import turned
from gearmath.errors import InputError
from gearmath.quality.evaluation.closing import close_run
from gearmath.quality.evaluation.member import evaluate_member
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import join, write_flank_csv

UM = 1e-3
CORNERS, MIDDLE, NOTHING = ((0, 0), (0, 8), (2, 4), (4, 0), (4, 8)), ((2, 4),), ()
CASES = {"between the flanks": (45, 20), "convex grid": (67, 20), "concave grid": (22, 6)}


@pytest.fixture(scope="module")
def part(gear_set):
    """``part(again)``: nominal points of a pinion: tooth 0 in full, others at the middle, tooth 0 again at the end."""
    nominal = {flank: nominal_flank(gear_set.pinion, flank, blank_grid(gear_set.pinion)) for flank in FLANKS}

    def make(again=CORNERS):
        parts = []
        for tooth in range(13):
            for flank, one in nominal.items():
                places = set(zip(one.row.tolist(), one.col.tolist(), strict=True))
                if tooth:
                    places = set(MIDDLE if tooth < 12 else again)
                one = one.pick(np.array([place in places for place in zip(one.row, one.col, strict=True)]))
                turn = 2 * math.pi * tooth / 12
                parts.append(
                    replace(
                        one,
                        flank=np.full(len(one), flank),
                        tooth=np.full(len(one), tooth),
                        deviation=np.zeros(len(one)),
                        point=turned(one.point, turn),
                        normal=turned(one.normal, turn),
                        uncertainty=np.full(len(one), np.nan),
                    )
                )
        return join([each for each in parts if len(each)])

    return {again: make(again) for again in (CORNERS, MIDDLE, NOTHING)}


def measured(file, *changes):
    change = sum(changes)
    return replace(file, point=file.point + change[:, None] * file.normal, deviation=file.deviation + change)


def noise(file, seed, sigma=0.45 * UM):
    return sigma * np.random.default_rng(seed).standard_normal(len(file))


def slip(file, row, size_um):
    """Every point from this row of the file on: metal left on the concave flanks, and as much missing on the convex."""
    signs = np.where(file.flank == "concave", 1.0, -1.0)
    return size_um * UM * signs * (np.arange(len(file)) >= row)


def places(file):
    """Places along the tooth and up the profile, from -1 to 1."""
    return (file.col - 4) / 4, (file.row - 2) / 2


@pytest.mark.parametrize("again", [CORNERS, MIDDLE, NOTHING])
@pytest.mark.parametrize(("row", "size_um"), [(67, 20), (22, 6), (30, -9), (60, 60)])
def test_slip_inside_a_grid_is_found_where_it_happened_with_its_size(part, again, row, size_um):
    file = part[again]
    for seed in range(3):
        found = close_run(measured(file, noise(file, seed), slip(file, row, size_um)), 12)
        assert found.slip is not None
        assert found.slip.row == row
        sign = 1 if row < 45 else -1
        assert found.slip.size == pytest.approx(sign * size_um * UM, abs=5 * found.slip.uncertainty)
        assert found.slip.uncertainty < 1 * UM


@pytest.mark.parametrize("again", [CORNERS, MIDDLE])
@pytest.mark.parametrize("size_um", [20, -100])
def test_slip_between_the_flanks_of_the_tooth_in_full_is_told_from_one_after_it(part, again, size_um):
    file = part[again]
    between, after = (close_run(measured(file, noise(file, 4), slip(file, row, size_um)), 12) for row in (45, 90))
    assert between.slip is not None
    assert (between.slip.row, between.slip.before[0], between.slip.after[0]) == (45, "concave", "convex")
    assert after.slip is None
    assert (after.kind, after.teeth, after.beside) == ("step", (0, 1), True)


def test_slip_between_later_teeth_leaves_thickness_and_topography(part, gear_set):
    file = part[CORNERS]
    found = evaluate_member(measured(file, noise(file, 3), slip(file, 104, 40)), gear_set.pinion)
    assert found.closing.kind == "step"
    assert found.thickness is not None
    found.closing.check_topography()


@pytest.mark.parametrize("case", CASES)
def test_slip_in_the_tooth_in_full_withholds_all_that_depends_on_it(part, gear_set, case):
    file = part[CORNERS]
    found = evaluate_member(measured(file, noise(file, 1), slip(file, *CASES[case])), gear_set.pinion)
    values = found.as_dict()
    assert values["closing"]["slip"]["after"]["tooth"] == 0
    assert "slipped by" in found.first[0]
    assert values["thickness"] is None
    assert values["runout"]["F_r_um"] is None
    assert found.verdict.grade is None
    assert set(found.verdict.withheld) == {"f_pt", "F_p", "F_r"}
    for row in values["flanks"].values():
        assert row["max_deviation_um"] is None
        assert row["zeroed_at_reference"]["max_deviation_um"] is None
        assert row["orders"] is None
        assert row["F_p_um"] is None


@pytest.mark.parametrize("case", CASES)
def test_compensate_refuses_a_slipped_measurement_and_says_which_points(part, command, tmp_path, case):
    file, (row, size_um) = part[CORNERS], CASES[case]
    source, target = tmp_path / "measured.csv", tmp_path / "corrected.toml"
    write_flank_csv(source, measured(file, noise(file, 1), slip(file, row, size_um)))
    status, out, said = command("compensate", "nasa_tp3096_12x36.toml", "--measured", source, "-o", target)
    assert (status, out) == (2, "")
    assert "measured.csv: the work or the machine slipped by" in said
    assert f"point {row + 1} of the file and all after it" in said
    assert not target.exists()


def test_motion_of_which_it_is_not_told_when_is_refused(part):
    few = part[CORNERS].pick(part[CORNERS].tooth % 6 == 0)
    turned_off = np.where(few.tooth == 12, 1.0, 0.0) * np.where(few.flank == "concave", 20 * UM, -20 * UM)
    found = close_run(measured(few, noise(few, 0), turned_off), 12)
    assert found.kind == "not told"
    with pytest.raises(InputError, match="not told when"):
        found.check_topography()


def cubic(rng, file):
    x, y = places(file)
    terms = np.stack([x**i * y**j for i in range(4) for j in range(4 - i)])
    return np.where(file.flank == "concave", *(rng.uniform(-3 * UM, 3 * UM, 10) @ terms for _ in FLANKS))


def tip_relief(rng, file):
    return np.where(file.row == 4, -rng.uniform(5, 30) * UM, 0.0)


def burr(rng, file):
    return np.where((file.tooth % 12 == 0) & (file.row == 4) & (file.col > rng.integers(2, 7)), 25 * UM, 0.0)


def one_point_off(rng, file):
    return np.where(
        np.arange(len(file)) == rng.integers(len(file)), rng.choice([-1, 1]) * rng.uniform(8, 100) * UM, 0.0
    )


def index(rng, file):
    return (rng.normal(0, 30 * UM, 12)[file.tooth % 12]) * np.where(file.flank == "concave", 1.0, -1.0)


def narrow_tooth(rng, file):
    return np.where(file.tooth % 12 == 0, -25 * UM, 0.0)


def drift(rng, file):
    return np.linspace(0, rng.uniform(-15, 15) * UM, len(file)) * np.where(file.flank == "concave", 1.0, -1.0)


@pytest.mark.parametrize("error", [cubic, tip_relief, burr, one_point_off, index, narrow_tooth, drift])
@pytest.mark.parametrize("again", [CORNERS, MIDDLE, NOTHING])
def test_form_index_dirt_and_drift_are_no_slip(part, again, error):
    file = part[again]
    for seed in range(1, 11):
        change = error(np.random.default_rng(100 + seed), file)
        found = close_run(measured(file, change, noise(file, seed)), 12)
        assert found.slip is None, (seed, found.said)

"""Points of other measuring machines: what was put on the flank comes back, whatever the axes, order and rotation.

A point p + δ n, with p on the nominal flank and n its normal, has foot p and deviation δ by construction; rotation,
axes, units and order are put on by hand. Places lie where no grid of ours has them.
"""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import Grid, blank_grid, solve_flank
from gearmath.bevel.tooth import tooth_thickness
from gearmath.errors import InputError
from gearmath.quality.correction.member import correct
from gearmath.quality.evaluation.member import evaluate_member
from gearmath.quality.foreign.member import foreign_file
from gearmath.quality.foreign.points import Frame, PointPart
from gearmath.specs.bevel_set import FLANKS, MEMBERS, load_bevel_set
from gearmath.specs.flank_csv import read_flank_csv
from gearmath.specs.toml import bundled

SETS = (
    "nasa_tp3096_12x36.toml",
    "spiral_7x43.toml",
    "crown_gear_formate_14x39.toml",
    "crown_gear_hobbed_14x39.toml",
    "crown_gear_universal_14x39.toml",
)
PLAIN = Frame()
#: Row and column of the reference point of 5x9.
MIDDLE = 2 * 9 + 4


def around(points, angle):
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])


def places(member, rows=5, columns=9, margin=0.13, off=0.03, seed=1):
    """A grid as a measuring machine takes it: of another margin, every place beside it by some 0.03 mm."""
    grid, rng = blank_grid(member, rows, columns, margin), np.random.default_rng(seed)
    return Grid(grid.axial + off * rng.standard_normal(grid.shape), grid.radial + off * rng.standard_normal(grid.shape))


def smooth(count=45):
    """Deviations [mm] of up to some 50 µm, none at the reference point."""
    row, col = np.divmod(np.arange(count), 9)
    return 0.02 * np.sin((col - 4) / 3) + 0.01 * (row - 2) - 0.004 * ((row - 2) * (col - 4) / 4) ** 2


def on_flank(member, flank, deviation, grid=None):
    points = solve_flank(member, flank, places(member) if grid is None else grid)
    return points.point + deviation[:, None] * points.normal, points.normal


def deviations(file, flank, tooth=0):
    points = file.select(flank, tooth)
    return points.deviation[np.argsort(points.row * 9 + points.col)]


@pytest.mark.parametrize("name", MEMBERS)
@pytest.mark.parametrize("bundle", SETS)
def test_deviations_come_back_from_shuffled_turned_points_of_every_set(bundle, name):
    gear_set, rng = load_bevel_set(bundled(bundle)), np.random.default_rng(5)
    member = gear_set.member(name)
    for flank in FLANKS:
        point, normal = on_flank(member, flank, smooth())
        order = rng.permutation(45)
        # the work axis of the file is -y: z_w = -y, and x y z keep their order; the origin lies 30 mm behind the apex
        file = around(point, 2.5)[order] - [0, 0, 30.0]
        file = np.stack([file[:, 1], -file[:, 2], -file[:, 0]], axis=1)
        into = around(-normal, 2.5)[order]
        into = np.stack([into[:, 1], -into[:, 2], -into[:, 0]], axis=1)
        found = foreign_file([PointPart("p.txt", flank, 0, file, into)], Frame("-y", 30.0), gear_set, name)
        assert (found.file.header["grid"], found.file.header["phase_zeroed"]) == ("5x9", "true")
        assert "p.txt: normals point into the metal" in found.remarks
        # 0.01 um is asked; feet are solved to 1e-10 mm
        np.testing.assert_allclose(deviations(found.file, flank), smooth(), rtol=0, atol=1e-8)


def test_axes_of_a_file_are_never_mirrored():
    for axis in ("+x", "-x", "+y", "-y", "+z", "-z"):
        rotation = Frame(axis).in_work(np.eye(3)).T
        np.testing.assert_allclose(rotation.T @ rotation, np.eye(3))
        assert np.linalg.det(rotation) == pytest.approx(1.0)
        unit = np.zeros(3)
        unit["xyz".index(axis[1])] = 1 if axis[0] == "+" else -1
        np.testing.assert_allclose(rotation @ unit, [0, 0, 1])


def test_thickness_and_pitch_stay_where_all_files_share_one_rotation(gear_set):
    """Both flanks 5 µm too thick, tooth 3 shifted by 20 µm of arc on both: only the rotation of the whole goes."""
    member, parts, shifts = gear_set.gear, [], {}
    for flank in FLANKS:
        points = solve_flank(member, flank, places(member))
        for tooth in (0, 3):
            deviation = np.full(45, 0.005)
            extra = 0.020 / np.hypot(*points.point[MIDDLE, :2]) if tooth == 3 else 0.0
            laid = around(points.point + deviation[:, None] * points.normal, 1.1 + extra + 2 * np.pi * tooth / 36)
            parts.append(PointPart(f"{flank}{tooth}.txt", flank, tooth, laid))
        middle, normal = points.point[MIDDLE], points.normal[MIDDLE]
        shifts[flank] = extra * (middle[0] * normal[1] - middle[1] * normal[0])
    found = foreign_file(parts, Frame(), gear_set, "gear")
    assert found.file.header["phase_zeroed"] == "false"
    for flank in FLANKS:
        first, fourth = (deviations(found.file, flank, tooth)[MIDDLE] for tooth in (0, 3))
        assert fourth - first == pytest.approx(shifts[flank], abs=1e-6)
        # thickness: of both flanks together 10 um, the mean of each as much as its normal has of the arc
    mean = [deviations(found.file, flank)[MIDDLE] + deviations(found.file, flank, 3)[MIDDLE] for flank in FLANKS]
    assert sum(mean) / 2 == pytest.approx(0.010, abs=3e-4)
    each = foreign_file(parts, Frame(), gear_set, "gear", "each")
    assert each.file.header["phase_zeroed"] == "true"
    assert max(abs(deviations(each.file, flank, tooth)[MIDDLE]) for flank in FLANKS for tooth in (0, 3)) < 1e-9


def test_rotation_is_kept_on_request(gear_set):
    point, _ = on_flank(gear_set.pinion, "concave", smooth() + 0.007)
    found = foreign_file([PointPart("p.txt", "concave", 0, point)], Frame(), gear_set, "pinion", "kept")
    assert found.file.header["phase_zeroed"] == "false"
    np.testing.assert_allclose(deviations(found.file, "concave"), smooth() + 0.007, rtol=0, atol=1e-9)
    with pytest.raises(InputError, match=r"turned by (20\.0|19\.9)\d\d degrees against tooth 0 .* --phase kept"):
        foreign_file(
            [PointPart("p.txt", "concave", 0, around(point, np.radians(20)))], Frame(), gear_set, "pinion", "kept"
        )


@pytest.mark.parametrize("burr", [3, MIDDLE])
def test_a_burr_is_kept_for_the_evaluation_and_moves_no_other_point(gear_set, burr):
    deviation = smooth()
    deviation[burr] += 0.5
    point, _ = on_flank(gear_set.pinion, "convex", deviation)
    found = foreign_file([PointPart("p.txt", "convex", 0, around(point, -2))], Frame(), gear_set, "pinion")
    others = np.arange(45) != burr
    # where the reference point itself is bad, the smooth surface through the others stands for it
    np.testing.assert_allclose(deviations(found.file, "convex")[others], smooth()[others], rtol=0, atol=1e-3)
    judged = evaluate_member(found.file, gear_set.pinion)
    assert any(f"row {burr // 9}, col {burr % 9}" in remark and "left out" in remark for remark in judged.remarks)


def test_points_far_off_are_left_out_and_counted(gear_set):
    point, normal = on_flank(gear_set.pinion, "concave", smooth())
    point[0] += 40 * normal[0]
    found = foreign_file([PointPart("p.txt", "concave", 0, point)], Frame(), gear_set, "pinion")
    assert "p.txt: 1 point beyond the flank or far off it, left out" in found.remarks
    assert len(found.file) == 44
    judged = evaluate_member(found.file, gear_set.pinion)
    assert any("row 0, col 0: not measured" in remark for remark in judged.remarks)
    assert judged.flanks["concave"].topographies[0].extreme == pytest.approx(smooth()[1], abs=1e-6)


def test_centers_of_the_tip_are_brought_back_by_its_radius(gear_set):
    point, normal = on_flank(gear_set.gear, "convex", smooth())
    found = foreign_file(
        [PointPart("p.txt", "convex", 0, around(point + 1.5 * normal, 0.3))], Frame("+z", 0.0, 1.5), gear_set, "gear"
    )
    np.testing.assert_allclose(deviations(found.file, "convex"), smooth(), rtol=0, atol=1e-8)


def test_scattered_points_are_brought_onto_a_grid_between_them(gear_set):
    """A cubic deviation over 300 random places, with three bad points among them."""
    member, rng = gear_set.gear, np.random.default_rng(2)
    across, up = rng.uniform(0.03, 0.97, (2, 300))
    grid = blank_grid(member, 2, 2, 0.0)

    def mixed(corners):
        """Between the corners of the blank, where lines of the blank are straight."""
        toe, heel = (corners[0, k] * (1 - up) + corners[1, k] * up for k in (0, 1))
        return toe * (1 - across) + heel * across

    spread = Grid(mixed(grid.axial)[None], mixed(grid.radial)[None])

    def form(x, y):
        return 0.03 * (x - 0.5) + 0.02 * (y - 0.5) ** 2 - 0.06 * (x - 0.5) ** 3

    deviation = form(across, up)
    deviation[[7, 70, 170]] += 0.4
    point, _ = on_flank(member, "concave", deviation, spread)
    found = foreign_file([PointPart("p.txt", "concave", 0, around(point, 1))], Frame(), gear_set, "gear")
    assert any("300 points form no grid" in remark for remark in found.remarks)
    assert any("3 points left out, off the others" in remark for remark in found.remarks)
    assert found.file.header["margins"] == "0.1,0.1"
    y, x = (each.ravel() for each in np.meshgrid(np.linspace(0.1, 0.9, 5), np.linspace(0.1, 0.9, 9), indexing="ij"))
    # a rotation of the work adds what its lever adds, nearly the same all over the flank; rest: 0.2 um
    left = deviations(found.file, "concave") - (form(x, y) - form(0.5, 0.5))
    assert np.abs(left).max() < 2e-4
    assert evaluate_member(found.file, member).flanks["concave"].orders.residual < 2e-3


def test_evaluate_judges_points_at_their_own_places(gear_set, command, tmp_path):
    """Text in inches with decimal commas, work axis -x, in; the largest deviation of either flank out."""
    options = []
    for flank in FLANKS:
        point, _ = on_flank(gear_set.pinion, flank, smooth())
        z_on_x = around(point, 0.4) @ np.array([[0, 1, 0], [0, 0, -1], [-1, 0, 0]])
        lines = [";".join(f"{v / 25.4:.9f}".replace(".", ",") for v in row) for row in z_on_x[::-1]]
        (tmp_path / f"{flank}.txt").write_text("X;Y;Z\n" + "\n".join(lines) + "\n")
        options += [tmp_path / f"{flank}.txt", "--flank", flank]
    target = tmp_path / "m.csv"
    set_ = ("--set", SETS[0])
    status, out, err = command(
        "points", *options, *set_, "--member", "pinion", "--unit", "inch", "--axis", "-x", "-o", target, "--json"
    )
    assert status == 0
    assert "and 1 more: after turning, points lie 20.6 um RMS off the nominal flank" in err  # smooth() without its mean
    values = json.loads(out)
    assert [each["turned_deg"] % 360 for each in values["files"]] == pytest.approx([np.degrees(0.4) % 360] * 2, abs=180)
    assert values["margins"] == "own"
    status, out, err = command("evaluate", target, *set_, "--json")
    assert (status, err) == (0, "")
    figures = json.loads(out)["flanks"]
    for flank in FLANKS:
        assert abs(figures[flank]["max_deviation_um"]) == pytest.approx(np.abs(smooth()).max() * 1000, abs=0.01)
        assert figures[flank]["teeth_in_full"] == [0]
    assert read_flank_csv(target).header["tip_radius_mm"] == "0"


def test_thickness_of_foreign_points_is_that_at_one_place_of_both_flanks(gear_set):
    """Flanks measured 0.1 mm apart along the axis: the tooth between them has the thickness of the place in the middle.

    ``tooth_thickness`` is compared with a moving blade edge in the tests of the command ``tooth``.
    """
    grid, parts = places(gear_set.gear, off=0.0), []
    for flank, shift in zip(FLANKS, (0.05, -0.05), strict=True):
        there = Grid(
            grid.axial + shift, grid.radial + 0.01 * np.sign(shift) + 1e-3 * np.sin(np.arange(45)).reshape(5, 9)
        )
        parts.append(PointPart(f"{flank}.txt", flank, 0, on_flank(gear_set.gear, flank, np.zeros(45), there)[0]))
    found = foreign_file(parts, Frame(), gear_set, "gear")
    assert found.file.header["margins"] == "own"
    thickness = evaluate_member(found.file, gear_set.gear).thickness
    radius = grid.radial.ravel()[MIDDLE] + 1e-3 * np.sin(MIDDLE)
    assert thickness.radius == pytest.approx(radius, abs=1e-7)
    assert thickness.arc == pytest.approx(tooth_thickness(gear_set.gear, grid.axial.ravel()[MIDDLE], radius), abs=1e-7)


def test_a_machine_error_is_corrected_from_foreign_points(gear_set, altered):
    """Cut with the cutter 0.05 mm too far out: points on that very flank ask for a radial distance 0.05 mm less."""
    cut = altered(gear_set, "pinion", "concave", radial_distance=gear_set.pinion.concave.radial_distance + 0.05)
    points = solve_flank(cut.pinion, "concave", places(gear_set.pinion)).point
    parts = [PointPart("p.txt", "concave", 0, around(points, 3)[::-1])]
    whole = solve_flank(gear_set.pinion, "convex", places(gear_set.pinion)).point
    parts.append(PointPart("q.txt", "convex", 0, around(whole, 3)))
    file = foreign_file(parts, Frame(), gear_set, "pinion", "each").file
    found = correct(gear_set.pinion, file, ("radial_distance", "work_rotation_offset"))
    change = found.settings["concave"][0] - gear_set.pinion.concave.radial_distance
    assert change == pytest.approx(-0.05, abs=5e-4)
    assert found.expected["concave"] < 5e-4


def refusal(gear_set, part, frame=PLAIN, name="pinion"):
    with pytest.raises(InputError) as refused:
        foreign_file([part], frame, gear_set, name)
    return str(refused.value)


def test_points_of_something_else_are_refused_with_what_would_fit(gear_set):
    point, normal = on_flank(gear_set.pinion, "concave", smooth())
    part = PointPart("p.txt", "concave", 0, around(point, 1.0))
    assert "p.txt: " in refusal(gear_set, replace(part, flank="convex"))
    exact, _ = on_flank(gear_set.pinion, "convex", np.zeros(45))
    exact = PointPart("p.txt", "convex", 0, around(exact, 1.0))  # a slope of the deviations is some 0.5 mm of offset
    cases = {
        "most would fit with --flank concave": (replace(part, flank="convex"), Frame(), "pinion"),
        "most would fit with --unit inch": (replace(part, point=part.point / 25.4), Frame(), "pinion"),
        "most would fit with --unit mm": (replace(part, point=part.point * 25.4), Frame(), "pinion"),
        "most would fit with lengths times 1000: the file is in m": (
            replace(part, point=part.point / 1000),
            Frame(),
            "pinion",
        ),
        "most would fit with --axis -z": (replace(part, point=part.point * [1, -1, -1]), Frame(), "pinion"),
        "most would fit with --axis +x": (replace(part, point=part.point[:, [2, 0, 1]]), Frame(), "pinion"),
        "most would fit with --member pinion": (part, Frame(), "gear"),
        "most would fit with the mirror image: the file is of the other hand, or two of its columns are exchanged": (
            replace(part, point=part.point * [1, -1, 1]),
            Frame(),
            "pinion",
        ),
        "most would fit with --apex-offset 0.0": (exact, Frame("+z", -14.0), "pinion"),
        "with --apex-offset 0.0 more than": (exact, Frame("+z", 5.0), "pinion"),
        "is the file of this set, member and flank": (replace(part, point=part.point * 0.5), Frame(), "pinion"),
    }
    for words, case in cases.items():
        assert words in refusal(gear_set, *case), words
    other, _ = on_flank(gear_set.pinion, "convex", smooth())
    both = replace(part, point=np.concatenate([other, point]))
    assert "it holds the points of both flanks" in refusal(gear_set, both)
    turned_normals = replace(part, normal=around(normal, 1.0)[:, [1, 2, 0]])
    assert "normals lie within 15 degrees" in refusal(gear_set, turned_normals)


def test_a_flank_of_another_tooth_is_named_with_its_tooth(gear_set):
    point, _ = on_flank(gear_set.pinion, "concave", smooth())
    parts = [PointPart(f"{k}.txt", "concave", k, around(point, -2 * np.pi * k / 12)) for k in (0, 1)]
    with pytest.raises(InputError, match=r"1\.txt: .* it would be of tooth 11, counted as the set counts"):
        foreign_file(parts, Frame(), gear_set, "pinion")


def test_half_a_file_is_told_from_a_whole_one(gear_set):
    point, _ = on_flank(gear_set.pinion, "concave", smooth())
    found = foreign_file([PointPart("p.txt", "concave", 0, point[:22])], Frame(), gear_set, "pinion")
    (covered,) = (each for each in found.remarks if "% only: is the file whole?" in each)
    assert "cover the working depth from 1" in covered
    whole = foreign_file([PointPart("p.txt", "concave", 0, point)], Frame(), gear_set, "pinion")
    assert not any("is the file whole?" in each for each in whole.remarks)


@pytest.mark.parametrize("row", [2, 0])
def test_too_few_points_for_a_grid_are_refused(gear_set, row):
    """The lowest row, too, which a trial of another cause may move off the flank altogether."""
    point, _ = on_flank(gear_set.pinion, "concave", smooth())
    point = point[9 * row : 9 * row + 9] + np.array([0.05, 0.0, 0.0])
    assert "its 9 points form no grid, and cover too little" in refusal(
        gear_set, PointPart("p.txt", "concave", 0, point)
    )


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--tooth", 12), r"p\.txt: --tooth 12: the member has teeth 0 to 11"),
        (("--apex-offset", "nan"), r"--apex-offset nan: must lie between"),
        (("--tip-radius", "-1"), r"--tip-radius -1: must lie between 0 and 10 mm"),
        (("--flank", "convex", "--flank", "concave"), r"--flank: given 3 times for 1 files"),
    ],
)
def test_options_out_of_range_are_refused(refused, tmp_path, options, sentence):
    (tmp_path / "p.txt").write_text("1.5 2.5 3.5\n")
    refused(
        sentence,
        "points",
        tmp_path / "p.txt",
        "--set",
        SETS[0],
        "--member",
        "pinion",
        "--flank",
        "concave",
        *options,
        "-o",
        tmp_path / "m.csv",
    )


def test_two_files_of_one_flank_are_refused(refused, tmp_path):
    for name in "ab":
        (tmp_path / f"{name}.txt").write_text("1.5 2.5 3.5\n")
    refused(
        r"b\.txt: is taken for the concave flank of tooth 0, as is \S*a\.txt",
        "points",
        tmp_path / "a.txt",
        tmp_path / "b.txt",
        "--set",
        SETS[0],
        "--member",
        "pinion",
        "--flank",
        "concave",
        "-o",
        tmp_path / "m.csv",
    )


def test_a_set_without_the_mate_gives_the_same_hints(gear_set):
    """The likely cause is sought among the members that there are."""
    alone = gear_set.model_copy(update={"gear": None})
    point, _ = on_flank(gear_set.pinion, "concave", smooth())
    part = PointPart("p.txt", "concave", 0, around(point, 1.0))
    assert "most would fit with --unit inch" in refusal(alone, replace(part, point=part.point / 25.4))
    assert "most would fit with --flank concave" in refusal(alone, replace(part, flank="convex"))
    assert "most would fit with --axis -z" in refusal(alone, replace(part, point=part.point * [1, -1, -1]))


@pytest.mark.parametrize("count", [5, 8, 9, 10, 13, 25])
def test_a_few_points_of_one_end_are_a_file_or_one_sentence(gear_set, count):
    """A row or a little more: the reference point lies beyond them, and nothing is said of it."""
    point, _ = on_flank(gear_set.pinion, "concave", smooth())
    part = PointPart("p.txt", "concave", 0, around(point[:count], 1.0))
    try:
        file = foreign_file([part], Frame(), gear_set, "pinion", "each").file
    except InputError:
        return
    assert np.abs(file.deviation).max() < 0.05


def both_flanks(member, moved=lambda point: point, tip=0.0, flanks=FLANKS):
    """Parts whose points, or centers of the tip, were moved; a third of the form of smooth()."""
    return [
        PointPart(f"{flank}.txt", flank, 0, moved(on_flank(member, flank, smooth() / 3 + tip)[0])) for flank in flanks
    ]


def tilted(degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return lambda point: point @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]).T


@pytest.mark.parametrize("name", MEMBERS)
def test_points_that_stand_right_raise_no_doubt(gear_set, name):
    parts = both_flanks(gear_set.member(name), lambda point: around(point, 1.0))
    assert foreign_file(parts, PLAIN, gear_set, name).doubts == ()


@pytest.mark.parametrize("name", MEMBERS)
def test_centers_of_the_tip_without_its_radius_are_refused_with_it(gear_set, name):
    parts = both_flanks(gear_set.member(name), tip=1.0)
    with pytest.raises(
        InputError, match=r"lie 100\d\.\d um RMS off the nominal flank, .* with --tip-radius 1\.00: are"
    ):
        foreign_file(parts, PLAIN, gear_set, name)
    assert foreign_file(parts, Frame(tip_radius=1.0), gear_set, name).doubts == ()
    (one,) = foreign_file(parts[:1], PLAIN, gear_set, name).doubts  # one flank may be of such a form
    assert "--tip-radius 0." in one
    assert "both flanks do" in one


@pytest.mark.parametrize("name", MEMBERS)
def test_work_that_stands_askew_or_beside_its_axis_is_said_to(gear_set, name):
    """0.2 degrees and 0.2 mm: both flanks tell the size within a quarter, the form of the flanks takes part."""
    member = gear_set.member(name)
    for moved, words, size in (
        (tilted(0.2), r"tilted by (\d\.\d\d) degrees", 0.2),
        (lambda point: point + np.array([0.2, 0.0, 0.0]), r"stands (\d\.\d\d) mm beside the axis", 0.2),
    ):
        (doubt,) = foreign_file(both_flanks(member, moved), PLAIN, gear_set, name).doubts
        assert float(re.search(words, doubt)[1]) == pytest.approx(size, rel=0.25), doubt


def test_doubts_are_said_on_standard_error_and_in_json(command, gear_set, tmp_path):
    for part in both_flanks(gear_set.pinion, tilted(0.2)):
        np.savetxt(tmp_path / part.name, part.point, "%.5f", header="TOOTH 3", comments="")
    files = [tmp_path / "concave.txt", "--flank", "concave", tmp_path / "convex.txt", "--flank", "convex"]
    status, out, err = command(
        "points", *files, "--set", SETS[0], "--member", "pinion", "-o", tmp_path / "m.csv", "--json"
    )
    assert status == 0
    assert "tilted by 0.19 degrees" in err
    assert "convex.txt, line 1: says tooth 3, read as --tooth 0" in err
    assert [each for each in json.loads(out)["remarks"] if each in err.splitlines()] == err.splitlines()


@pytest.mark.parametrize(
    ("head", "sentence"),
    [
        ("FLANK: CONVEX", "line 1: says convex, the options say --flank concave"),
        ("UNITS inch", "line 1: says inch, the options say --unit mm"),
        ("X [in] Y [in] Z [in]", "line 1: says inch, the options say --unit mm"),
        ("MEMBER=GEAR", "line 1: says gear, the options say --member pinion"),
    ],
)
def test_text_that_contradicts_an_option_is_refused(refused, gear_set, tmp_path, head, sentence):
    (part,) = both_flanks(gear_set.pinion, flanks=("concave",))
    np.savetxt(tmp_path / "p.txt", part.point, "%.5f", header=head, comments="")
    refused(
        rf"p\.txt, {sentence}",
        "points",
        tmp_path / "p.txt",
        "--set",
        SETS[0],
        "--member",
        "pinion",
        "--flank",
        "concave",
        "-o",
        tmp_path / "m.csv",
    )


def test_one_point_is_refused(gear_set):
    (part,) = both_flanks(gear_set.pinion, flanks=("concave",))
    assert refusal(gear_set, replace(part, point=part.point[:1])) == "concave.txt: holds 1 point, at least 6 are needed"


def written(tmp_path, parts):
    """Files of points under a line of text, and the arguments that read them."""
    arguments = []
    for part in parts:
        np.savetxt(tmp_path / part.name, part.point, "%.5f", header="POINTS", comments="")
        arguments += [tmp_path / part.name, "--flank", part.flank]
    return ["points", *arguments, "--set", SETS[0], "--member", "pinion", "-o", tmp_path / "m.csv"]


def test_single_point_far_out_is_refused_with_its_line_and_left_out_on_request(command, gear_set, tmp_path):
    """3 mm on one flank, in line 19; 30 um are said, and are for the evaluation to judge."""
    one, other = both_flanks(gear_set.pinion)
    _, normal = on_flank(gear_set.pinion, "concave", smooth())
    for size, refused_ in ((3.0, True), (0.03, False)):
        point = one.point.copy()
        point[17] += size * normal[17]
        arguments = written(tmp_path, [replace(one, point=point), other])
        status, _, err = command(*arguments)
        assert (status == 2) == refused_, err
        said = re.search(r"concave\.txt, line 19: the point is (\d+\.\d) um off the surface through the others", err)
        assert float(said[1]) == pytest.approx(1000 * size, abs=3)
        assert "RMS" not in err  # the other points stand where they should
        assert ("--leave-out takes the other points" in err) == refused_
        assert (tmp_path / "m.csv").exists() != refused_
    point[17] += 3 * normal[17]
    status, _, err = command(*written(tmp_path, [replace(one, point=point), other]), "--leave-out")
    assert (status, "line 19" in err) == (0, True)
    assert len(read_flank_csv(tmp_path / "m.csv")) == 89


@pytest.mark.parametrize("count", [44, 40, 27])
def test_file_cut_at_the_end_of_a_row_is_refused_unless_asked_for(command, gear_set, tmp_path, count):
    one, other = both_flanks(gear_set.pinion)
    arguments = written(tmp_path, [replace(one, point=one.point[:count]), replace(other, point=other.point[:count])])
    status, _, err = command(*arguments)
    assert (status, err.count("\n")) == (2, 1)
    assert re.search(
        r"concave\.txt: its .*: is the file whole\? \(and 1 more\); --leave-out takes the other points", err
    )
    status, _, err = command(*arguments, "--leave-out")
    assert (status, err.count("is the file whole?")) == (0, 2)
    assert len(read_flank_csv(tmp_path / "m.csv")) == 2 * count


UP = np.array([0.0, 0.0, 1.0])


@pytest.mark.parametrize(
    ("moved", "words"),
    [
        (lambda point: 1.003 * point, r"too far from the origin by \+0\.[23]\d %"),
        (lambda point: point + UP * 0.3, r"--apex-offset -0\.(2[5-9]|3[0-5])"),
        (lambda point: point + UP * 0.1, r"--apex-offset -0\.[01]\d"),
    ],
    ids=["scale", "apex by 0.3", "apex by 0.1"],
)
def test_scale_and_apex_are_named_by_size_where_both_flanks_show_them(gear_set, moved, words):
    """Beside the others that the form of the flanks, 6 um RMS, does not tell from them."""
    (doubt,) = foreign_file(both_flanks(gear_set.pinion, moved), PLAIN, gear_set, "pinion").doubts
    assert re.search(words, doubt), doubt


@pytest.mark.parametrize("scale", [1.001, 0.999])
def test_a_scale_is_told_from_form_where_both_flanks_ask_for_it(gear_set, scale):
    """3.4 um of form beside it, as a polynomial that differs from flank to flank; without the scale nothing is said."""
    row, col = np.divmod(np.arange(45), 9)
    y, x = row / 2 - 1, col / 4 - 1
    forms = [0.005 * (x * y - 0.6 * x**2), 0.005 * (0.7 * y**3 + x**3 - 0.6 * x)]
    said = []
    for factor in (scale, 1.0):
        parts = [
            PointPart(f"{flank}.txt", flank, 0, factor * on_flank(gear_set.pinion, flank, form)[0])
            for flank, form in zip(FLANKS, forms, strict=True)
        ]
        said.append(foreign_file(parts, PLAIN, gear_set, "pinion").doubts)
    assert said[1] == ()
    (doubt,) = said[0]
    size = float(re.search(r"too far from the origin by ([+-]\d\.\d\d) %", doubt)[1])
    assert size == pytest.approx(100 * (scale - 1), abs=0.04)


@pytest.mark.parametrize("k", [17, 0, 8, 22, 40])
def test_single_point_off_by_twelve_times_the_noise_is_named_and_kept(gear_set, k):
    """6 um at 0.5 um of noise, inside, at corners and edges: less than a form, so that it is said and nothing more."""
    rng = np.random.default_rng(4)
    parts = []
    for flank in FLANKS:
        deviation = smooth() / 4 + 5e-4 * rng.standard_normal(45)
        deviation[k] += 0.006 * (flank == "convex")
        parts.append(PointPart(f"{flank}.txt", flank, 0, on_flank(gear_set.pinion, flank, deviation)[0]))
    found = foreign_file(parts, PLAIN, gear_set, "pinion")
    (doubt,) = found.doubts
    assert float(re.match(rf"convex\.txt, point {k + 1}: the point is (\d+\.\d) um off", doubt)[1]) > 4
    assert (len(found.file), found.gaps) == (90, ())


def test_noise_and_waves_name_no_point(gear_set):
    """0.5 um of noise, and half a wave less than a face width of 4 um on it: neighbors together are form."""
    rng = np.random.default_rng(7)
    _, col = np.divmod(np.arange(45), 9)
    for wave in (0.0, 0.004):
        parts = [
            PointPart(
                flank,
                flank,
                0,
                on_flank(gear_set.pinion, flank, wave * np.sin(col) + 5e-4 * rng.standard_normal(45))[0],
            )
            for flank in FLANKS
        ]
        assert foreign_file(parts, PLAIN, gear_set, "pinion").doubts == ()


def test_points_kept_as_they_stand_are_said_to_be_turned(gear_set):
    """1 degree is 0.3 mm along the normal; what a tooth is indexed or cut wrong, 20 um, is what is kept."""
    parts = both_flanks(gear_set.pinion, lambda point: around(point, np.radians(1.0)))
    doubts = foreign_file(parts, PLAIN, gear_set, "pinion", "kept").doubts
    words = r"(.*)\.txt: its \1 flank is turned by (\S+) degrees against tooth 0 of the set, .*; --phase common takes"
    said = [re.match(words, doubt) for doubt in doubts]
    assert [one[1] for one in said] == list(FLANKS)
    assert [float(one[2]) for one in said] == pytest.approx([1.0, 1.0], abs=0.01)  # the form of the flanks takes part
    little = both_flanks(gear_set.pinion, lambda point: around(point, 0.02 / 40))
    assert not any("kept so" in doubt for doubt in foreign_file(little, PLAIN, gear_set, "pinion", "kept").doubts)


@pytest.mark.parametrize("drift", [0.0, 0.03])
def test_two_runs_in_one_file_are_said_with_what_they_differ_by(gear_set, drift):
    """Two grids one after the other, the second with 0.5 um of noise and moved along the normals."""
    point, normal = on_flank(gear_set.pinion, "concave", smooth() / 4)
    off = drift + 5e-4 * np.random.default_rng(6).standard_normal(45)
    both = np.concatenate([point, point + off[:, None] * normal])
    doubts = foreign_file([PointPart("c.txt", "concave", 0, both)], PLAIN, gear_set, "pinion").doubts
    (said,) = [doubt for doubt in doubts if "two runs in one file?" in doubt]
    size = re.match(r"c\.txt: 45 places were measured twice, the later points ([+-]\d+\.\d) um off the earlier", said)
    assert float(size[1]) == pytest.approx(1000 * drift, abs=0.4)


def test_grids_of_unlike_size_are_said_to_be(gear_set):
    one, other = both_flanks(gear_set.pinion)
    less = replace(one, point=one.point.reshape(5, 9, 3)[:, 1:].reshape(-1, 3))
    doubts = foreign_file([less, other], PLAIN, gear_set, "pinion").doubts
    assert "concave.txt holds a grid of 5x8, convex.txt one of 5x9: are both whole?" in doubts


@pytest.mark.parametrize(
    ("digits", "said"), [(2, "p.txt: x, y, z are rounded to 10 um: no point is known better"), (4, "")]
)
def test_points_printed_to_too_few_digits_are_said_to_be(gear_set, digits, said):
    point, _ = on_flank(gear_set.pinion, "concave", smooth())
    found = foreign_file([PointPart("p.txt", "concave", 0, np.round(point, digits))], Frame(), gear_set, "pinion")
    assert any("rounded" in doubt for doubt in found.doubts) == bool(said)
    assert not said or found.doubts[0].startswith(said)

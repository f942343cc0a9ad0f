"""``gearmath tooth``: figures and STL of whole teeth, and its thickness beside that of ``gearmath evaluate``.

The thicknesses are found again by a blade edge in plain NumPy that is moved through the machine, at the place of each:
no derivation, no solver of the package has a say in it.
"""

from __future__ import annotations

import json
import math
import re
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.specs.bevel_set import FLANKS, MEMBERS
from gearmath.specs.flank_csv import join, write_flank_csv
from gearmath.specs.toml import bundled

SET = "nasa_tp3096_12x36.toml"
STEP = 1e-4


def figures(command, target, *more, member="gear"):
    status, out, err = command("tooth", SET, "--member", member, "--columns", 9, "--json", "-o", target, *more)
    assert (status, err) == (0, "")
    return json.loads(out)


def azimuth_on_envelope(blade, axial, radial, start):
    """Azimuth where the envelope of the moving edge has (z, r): Newton on z, r and the triple product of tangents."""

    def residual(w):
        tangents = [(blade.at(*(w + e)) - blade.at(*(w - e))) / (2 * STEP) for e in STEP * np.eye(3)]
        p = blade.at(*w)
        return np.array([p[2] - axial, math.hypot(p[0], p[1]) - radial, np.linalg.det(tangents) / 1000])

    w = np.array(start, dtype=float)
    for _ in range(30):
        slope = np.stack([(residual(w + e) - residual(w - e)) / (2 * STEP) for e in STEP * np.eye(3)], axis=1)
        step = np.linalg.solve(slope, residual(w))
        w -= step * min(1.0, 0.2 / np.abs(step[1:]).max()) if np.abs(step[1:]).max() > 0.2 else step
        if np.abs(step).max() < 1e-10:
            break
    assert np.abs(residual(w)).max() < 1e-6
    p = blade.at(*w)
    return math.atan2(p[1], p[0])


def measured(path, gear_set, member):
    """Both flanks of one space, as if measured without a deviation."""
    spec = gear_set.member(member)
    whole = join([nominal_flank(spec, flank, blank_grid(spec)) for flank in FLANKS])
    write_flank_csv(path, replace(whole, deviation=np.zeros(len(whole))))
    return path


@pytest.mark.parametrize("member", MEMBERS)
def test_thickness_of_tooth_and_of_evaluate_are_those_of_a_moving_edge_at_their_places(
    command, gear_set, moved_edge, tmp_path, member
):
    """At the mean point of the pitch cone and at the middle of the grid, which lies beside it."""
    spec = gear_set.member(member)
    blank, teeth = spec.blank, spec.teeth
    found = figures(command, tmp_path / "t.stl", member=member)
    status, out, _ = command("evaluate", measured(tmp_path / "m.csv", gear_set, member), "--set", SET, "--json")
    assert status == 0
    evaluated = json.loads(out)["thickness"]
    assert evaluated["measured_at"] == "reference_point"
    delta = math.radians(blank.pitch_angle)
    # half the working depth: between the addendum and what the clearance leaves of the dedendum
    up = (blank.mean_addendum - blank.mean_dedendum + blank.clearance) / 2
    places = {
        "mean": (blank.mean_cone_distance * math.cos(delta), blank.mean_cone_distance * math.sin(delta)),
        "reference": (
            blank.mean_cone_distance * math.cos(delta) - up * math.sin(delta),
            blank.mean_cone_distance * math.sin(delta) + up * math.cos(delta),
        ),
    }
    thickness = {}
    for where, (axial, radial) in places.items():
        angles = []
        for flank in FLANKS:
            blade = moved_edge.blade_of(spec, flank)
            angles.append(azimuth_on_envelope(blade, axial, radial, start_of(spec, flank, axial, radial)))
        space = abs(math.remainder(angles[0] - angles[1], 2 * math.pi))
        thickness[where] = radial * (2 * math.pi / teeth - space)
        assert found[f"{where}_transverse_tooth_thickness_mm"] == pytest.approx(thickness[where], abs=1e-5)
    assert evaluated["radius_mm"] == pytest.approx(places["reference"][1], abs=1e-9)
    assert evaluated["arc_mm"] == pytest.approx(thickness["reference"], abs=1e-5)
    chord = 2 * evaluated["radius_mm"] * math.sin(thickness["reference"] / (2 * evaluated["radius_mm"]))
    assert evaluated["chord_mm"] == pytest.approx(chord, abs=1e-5)
    assert abs(thickness["mean"] - thickness["reference"]) > 0.01  # two places, two figures


def start_of(spec, flank, axial, radial):
    """Where the search begins: the parameters of the package, roughly."""
    from gearmath.bevel.flank import Grid, nominal_points

    found, _ = nominal_points(spec, flank, Grid(np.array([[axial]]), np.array([[radial]])))
    return np.round(found.contact[0], 1)


def test_table_has_the_figures_of_the_json_and_says_where_they_are_measured(command, tmp_path):
    values = figures(command, tmp_path / "t.stl")
    status, out, err = command("tooth", SET, "--member", "gear", "--columns", 9, "-o", tmp_path / "t.stl")
    assert (status, err) == (0, "")
    rows = dict(line.split() for line in out.splitlines() if len(line.split()) == 2)
    for name, value in values.items():
        if name not in ("triangles", "pair"):
            assert float(rows[name]) == pytest.approx(value, abs=5.1e-5), name
    assert "mean_ at the mean point of the pitch cone" in out
    assert f"{values['triangles']} triangles" in out
    assert values["undercut_points"] == values["pointed_columns"] == 0
    # 2 π R_m sin δ / z with the published cone distance and pitch angle
    pitch = 2 * math.pi * 81.05 * math.sin(math.radians(71.565)) / 36
    assert values["mean_transverse_pitch_mm"] == pytest.approx(pitch, abs=1e-3)


def test_pair_has_its_backlash_angles_and_ease_off(command, tmp_path):
    """Angles of the mates at the mean point by the closed form of CR-191009, solved by another program (test_pair)."""
    both = {member: figures(command, tmp_path / "t.stl", member=member) for member in MEMBERS}
    mates = both["pinion"]["pair"]
    assert mates == both["gear"]["pair"]
    angles = {
        "concave": (19.27384719 - 19.79546867, 35.20926128 - 35.24621333),
        "convex": (23.70769370 - 24.24966429, 34.69525743 - 34.71717186),
    }
    for flank, (pressure, spiral) in angles.items():
        assert mates[flank]["pressure_angle_difference_deg"] == pytest.approx(pressure, abs=1e-7)
        assert mates[flank]["spiral_angle_difference_deg"] == pytest.approx(spiral, abs=1e-7)
    teeth = sum(found["mean_transverse_tooth_thickness_mm"] for found in both.values())
    backlash = both["gear"]["mean_transverse_pitch_mm"] - teeth
    assert mates["mean_transverse_backlash_mm"] == pytest.approx(backlash, abs=1e-9)
    # along the normal: cos β cos α_n, with the means of both flanks of the gear
    normal = backlash * math.cos(math.radians(34.9520)) * math.cos(math.radians(22.0226))
    assert mates["mean_normal_backlash_mm"] == pytest.approx(normal, abs=1e-6)
    # half of the difference of the pressure angles over 80 % of the working depth, along the blade
    height = 0.8 * (4.570064768422 + 2.216780765284 - 0.762) / 2 / math.cos(math.radians(21))
    for flank in FLANKS:
        slope = mates[flank]["ease_off_um"]["profile_slope"]
        assert slope == pytest.approx(1000 * height * math.radians(-angles[flank][0]), rel=0.2)
    _, out, _ = command("tooth", SET, "--member", "gear", "--columns", 9, "-o", tmp_path / "t.stl")
    assert f"normal backlash at the mean point: {normal:.4f} mm" in out
    assert f"{mates['convex']['ease_off_um']['crowning']:+.1f}" in out


def test_single_member_has_no_figures_of_a_pair(command, tmp_path, gear_set):
    alone = tmp_path / "gear.toml"
    text = bundled(SET).read_text("utf-8")
    alone.write_text(text[: text.index("[pinion]")] + text[text.index("[gear]") :], "utf-8")
    status, out, err = command("tooth", alone, "--columns", 9, "--json", "-o", tmp_path / "t.stl")
    assert (status, err) == (0, "")
    assert "pair" not in json.loads(out)


def facets(path):
    """Corners (n,3,3) of a binary STL, read by its published layout."""
    content = path.read_bytes()
    count = int.from_bytes(content[80:84], "little")
    assert len(content) == 84 + 50 * count
    records = np.frombuffer(content[84:], dtype=np.dtype([("v", "<f4", (4, 3)), ("a", "<u2")]), count=count)
    return records["v"][:, 1:]


def test_solid_is_closed_and_a_space_is_open(command, tmp_path):
    """Every edge of a solid belongs to two triangles; the surface of a space has a rim."""
    for more, closed in (((), True), (("--space",), False)):
        target = tmp_path / "t.stl"
        count = figures(command, target, *more)["triangles"]
        corners = facets(target)
        assert len(corners) == count
        edges = Counter(
            tuple(sorted((corner[k].tobytes(), corner[(k + 1) % 3].tobytes()))) for corner in corners for k in range(3)
        )
        assert (set(edges.values()) == {2}) == closed


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("tooth", SET, "--member", "gear"), "Missing option '-o'"),
        (("tooth", SET, "-o", "{target}"), "--member is missing: the set has both"),
        (("tooth", SET, "--member", "gear", "--columns", "2", "-o", "{target}"), "2 is not in the range 3<=x<=400"),
        (("tooth", "absent.toml", "--member", "gear", "-o", "{target}"), r"absent\.toml: cannot be read"),
        (("tooth", SET, "--member", "gear", "-o", "{folder}/absent/t.stl"), r"t\.stl: cannot be written"),
    ],
)
def test_bad_arguments_are_one_line_and_write_nothing(refused, tmp_path, arguments, sentence):
    refused(sentence, *(each.format(target=tmp_path / "t.stl", folder=tmp_path) for each in arguments))
    assert list(tmp_path.iterdir()) == []


def test_far_side_of_a_cutter_that_cuts_the_other_flank_is_told_as_the_judge_of_its_program_finds_it(command, tmp_path):
    """A point of 3.2 mm is narrower than the slot everywhere, but its far side does not run along the other flank."""
    path = tmp_path / "wide.toml"
    radius = "blade_point_radius = 75.326783002724\n"

    def note(width):
        text = bundled(SET).read_text("utf-8").replace(radius, f"{radius}blade_point_width = {width}\n")
        path.write_text(text, "utf-8")
        _, out, _ = command("tooth", path, "--member", "pinion", "--columns", 9, "-o", tmp_path / "t.stl")
        return re.search(r"cuts (\d+) um into the convex flank: blade_point_width must be at most ([\d.]+) mm", out)

    found = note(3.2)
    status, _, err = command("nc", "cut", path, "--member", "pinion", "--spaces", 0, "-o", tmp_path / "CUT.MPF")
    assert status == 2
    (judged,) = re.findall(r"gouges the convex flank of space 0: -([\d.]+) um", err)
    assert float(found[1]) == pytest.approx(float(judged), rel=0.05)
    assert note(found[2]) is None

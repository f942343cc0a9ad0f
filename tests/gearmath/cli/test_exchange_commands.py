"""``gearmath export step|stl|points|rexs`` and ``gearmath rexs``: files that are read back, and what is refused."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from gearmath.bevel.contact.system import Assembly
from gearmath.bevel.solid import member_triangles, volume
from gearmath.bevel.tooth import tooth_space
from gearmath.exchange.in_mesh import poses
from gearmath.specs.bevel_set import BevelSet, load_bevel_set

SET = "nasa_tp3096_12x36.toml"


def test_set_goes_to_rexs_and_back(command, gear_set: BevelSet, tmp_path) -> None:
    there, back = tmp_path / "nasa.rexs", tmp_path / "back.toml"
    assert command("export", "rexs", SET, "-o", there)[0] == 0
    status, out, err = command("rexs", there, "-o", back)
    assert (status, err) == (0, "")
    assert "back.toml: NASA CR-191009" in out
    found = load_bevel_set(back)
    for name, member in gear_set.members.items():
        for flank in ("concave", "convex"):
            # a set file has nine decimals
            assert found.member(name).flank(flank).vector == pytest.approx(member.flank(flank).vector, abs=1e-9)


def test_rexs_that_is_no_pair_is_refused(refused, command, tmp_path) -> None:
    there = tmp_path / "nasa.rexs"
    command("export", "rexs", SET, "-o", there)
    text = there.read_text("utf-8").replace(">36<", ">37<", 1)
    there.write_text(text, "utf-8")
    refused(r"nasa\.rexs: ", "rexs", there, "-o", tmp_path / "back.toml")
    assert not (tmp_path / "back.toml").exists()


def test_points_that_are_exported_are_read_as_a_flank_without_deviation(command, tmp_path) -> None:
    text, csv = tmp_path / "points.txt", tmp_path / "flank.csv"
    arguments = ("--member", "pinion", "--flank", "concave")
    status, out, err = command("export", "points", SET, *arguments, "-o", text)
    assert (status, err) == (0, "")
    assert out == f"{text}: 45 points\n"
    status, _, err = command("points", text, "--set", SET, *arguments, "--phase", "kept", "-o", csv)
    assert (status, err) == (0, "")
    rows = [line.split(",") for line in csv.read_text("utf-8").splitlines() if line.startswith("pinion,")]
    assert len(rows) == 45
    assert max(abs(float(row[11])) for row in rows) < 1e-4  # um


@pytest.mark.parametrize("grid", ["5", "1x9", "5x999999", "axb"])
def test_grids_that_are_none_are_refused(refused, grid: str, tmp_path) -> None:
    refused(
        rf"--grid {grid}: must read like 5x9, two or more each way, at most 1000000 points",
        "export",
        "points",
        SET,
        "--member",
        "pinion",
        "--flank",
        "convex",
        "--grid",
        grid,
        "-o",
        tmp_path / "points.txt",
    )


def test_pair_in_mesh_is_both_members_where_they_touch(command, gear_set: BevelSet, tmp_path) -> None:
    target = tmp_path / "pair.stl"
    status, out, err = command("export", "stl", SET, "-o", target)
    assert (status, err) == (0, "")
    content = target.read_bytes()
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    triangles = np.frombuffer(content[84:], dtype=record)["corners"].astype(float)
    single = [volume(member_triangles(m, tooth_space(m))) for m in gear_set.members.values()]
    assert volume(triangles) == pytest.approx(sum(single), rel=1e-4)
    assert "pinion axis Z" in out


def test_members_in_mesh_touch_on_the_drive_side(gear_set: BevelSet) -> None:
    # a contact of the pair, found in the frames of both works, is one point with opposite normals
    from gearmath.bevel.contact.report import side_mesh

    run, found = side_mesh(gear_set, "drive", Assembly()), poses(gear_set)
    thread, _ = run.interior[0]
    touch = thread.at(run.system, 0.0)
    point, normal = [], []
    for side, name in enumerate(("pinion", "gear")):
        surface = (run.system.pinion, run.system.gear)[side]
        at, along, *_ = (np.asarray(one).ravel() for one in surface.function(touch.x[3 * side : 3 * side + 3]))
        assert found[name].matrix @ found[name].matrix.T == pytest.approx(np.eye(3), abs=1e-12)
        point.append(found[name].of(at))
        normal.append(found[name].matrix @ along)
    assert point[0] == pytest.approx(point[1], abs=1e-9)
    assert normal[0] == pytest.approx(-normal[1], abs=1e-9)


def test_step_without_the_kernel_says_what_to_install(refused, monkeypatch, tmp_path) -> None:
    monkeypatch.setitem(sys.modules, "OCP.STEPControl", None)
    refused(
        r"STEP needs the CAD kernel: install it with pip install '\.\[cad\]'$",
        "export",
        "step",
        SET,
        "--member",
        "pinion",
        "-o",
        tmp_path / "pinion.step",
    )

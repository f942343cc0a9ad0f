"""``gearmath demo``: the table of the source text, the files it leaves, and a folder it will not take."""

from __future__ import annotations

import re

import numpy as np
import pytest

from gearmath.demo import run_demo
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.flank_csv import read_flank_csv


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The demo once: its folder and what it printed."""
    said: list[str] = []
    folder = tmp_path_factory.mktemp("demo") / "out"
    run_demo(folder, said.append)
    return folder, "\n".join(said)


def figures(text: str) -> dict[str, tuple[float, float]]:
    """The rows of the table: initial and compensated, in µm."""
    rows = re.findall(r"^(max profile error|cumulative pitch error) \((\w+)\) +(-?[\d.]+) +(-?[\d.]+)$", text, re.M)
    return {f"{what}, {member}": (float(old), float(new)) for what, member, old, new in rows}


@pytest.mark.slow
@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_table_shows_a_first_cut_like_that_of_the_source_text_and_a_far_better_second(run, member):
    table = figures(run[1])
    assert len(table) == 4
    first, second = table[f"max profile error, {member}"]
    assert 20 <= abs(first) <= 30
    assert abs(second) <= 1.5  # what 0.5 µm of probe noise leads to
    first, second = table[f"cumulative pitch error, {member}"]
    assert second <= 2.5
    assert first >= 4 * second


@pytest.mark.slow
def test_table_holds_the_figures_of_the_measured_files(run):
    """The noise of the probe apart: five sigma of 0.5 µm."""
    folder, text = run
    for member in ("pinion", "gear"):
        file = read_flank_csv(folder / f"{member}_measured.csv").select("concave", 0)
        other = read_flank_csv(folder / f"{member}_measured.csv").select("convex", 0)
        seen = max(np.abs(part.deviation).max() for part in (file, other)) * 1000
        assert seen == pytest.approx(abs(figures(text)[f"max profile error, {member}"][0]), abs=2.5)


@pytest.mark.slow
def test_every_product_is_there(run):
    folder, _ = run
    for member in ("pinion", "gear"):
        for name in (
            f"{member.upper()}_1.MPF",
            f"{member.upper()}_2.MPF",
            f"{member}_measured.csv",
            f"{member}_measured_again.csv",
            f"{member}_corrected.toml",
        ):
            assert (folder / name).stat().st_size > 0, name
        assert (folder / f"{member}.png").read_bytes().startswith(b"\x89PNG")
        corrected = load_bevel_set(folder / f"{member}_corrected.toml").member(member)
        assert corrected.concave.design is not None
        assert len(corrected.index_correction) == corrected.teeth
    for library in ("teensy", "cnc"):
        assert list((folder / library).rglob("gm_*.c"))
        assert (folder / library / "manifest.json").is_file()


@pytest.mark.slow
def test_correction_brings_the_pattern_of_the_designed_pair_back_within_2_percent_of_the_face_width(run):
    folder, text = run
    shifts = re.findall(r"(drive|coast): the pattern's center is off by ([\d.]+)% -> ([\d.]+)% of the face width", text)
    assert [side for side, *_ in shifts] == ["drive", "coast"]
    for _, before, after in shifts:
        assert float(before) > 2  # the machine that is off moves it
        assert float(after) <= 2
    pair = load_bevel_set(folder / "designed.toml")
    assert (pair.member("pinion").teeth, pair.member("gear").teeth) == (7, 43)
    for name in ("DESIGNED_PINION_1.MPF", "DESIGNED_PINION_2.MPF", "designed_pinion_measured.csv"):
        assert (folder / name).stat().st_size > 0, name


@pytest.mark.slow
def test_demo_shows_each_part_of_the_chain(run):
    _, text = run
    assert re.search(r"^ +10 +3\.183 +3$", text, re.M)  # the last row of the published table, R = 3.142
    assert re.search(r"2000000 edges .*never more than half a step", text)
    assert re.search(r"C to CasADi: (\d+) of \1 numbers are bit-equal", text)


def test_file_where_the_folder_should_be_is_refused(refused, tmp_path):
    taken = tmp_path / "taken"
    taken.write_text("mine")
    refused("taken: ", "demo", "-o", taken)
    assert taken.read_text() == "mine"


def test_folder_with_files_of_somebody_else_is_refused_and_left_alone(refused, tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    refused("mine.txt", "demo", "-o", tmp_path)
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("mine.txt", "mine")]

"""The page of the file layouts and the help say what the readers take: columns, header keys, and examples they read."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from gearmath.quality.evaluation.file_checks import check_belongs, check_points
from gearmath.quality.evaluation.nominal import nominal_rows
from gearmath.specs import flank_csv, point_text, touch_csv
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.toml import bundled

PAGE = (Path(__file__).parents[3] / "docs" / "files.md").read_text("utf-8")
LAYOUTS = {
    "Flank CSV": (flank_csv.COLUMNS, flank_csv.read_flank_csv),
    "Touch CSV": (touch_csv.COLUMNS, touch_csv.read_touch_csv),
    "Calibration touches": (touch_csv.CALIBRATION_COLUMNS, touch_csv.read_calibration_csv),
}
#: Which help names which layout.
VERBS = {
    "Flank CSV": (
        "flank",
        "points",
        "touches",
        "mill",
        "evaluate",
        "compensate",
        "report",
        "uncertainty",
        "stock",
    ),
    "Touch CSV": ("touches",),
    "Calibration touches": ("calibrate",),
}


def section(title):
    return re.split(r"^## ", PAGE, flags=re.MULTILINE)[[*re.findall(r"^## (.*)$", PAGE, re.MULTILINE)].index(title) + 1]


def first_cells(text, head):
    """The first cells of the table that begins with a head, without their quotes."""
    body = re.split(rf"^\| {head} \|.*\n\|[-|]*\n", text, flags=re.MULTILINE)[1].split("\n\n")[0]
    return tuple(re.findall(r"^\| `(.*?)` \|", body, re.MULTILINE))


def example(text, tmp_path):
    path = tmp_path / "example.txt"
    path.write_text(re.search(r"```(?:csv|text)\n(.*?)```", text, re.DOTALL)[1], "utf-8")
    return path


@pytest.mark.parametrize("title", LAYOUTS)
def test_page_lists_the_columns_of_the_reader_in_their_order(title):
    assert first_cells(section(title), "column") == LAYOUTS[title][0]


def test_page_lists_the_header_keys():
    assert first_cells(section("Flank CSV"), "key") == flank_csv.HEADER


@pytest.mark.parametrize("title", LAYOUTS)
def test_examples_of_the_page_are_read(title, tmp_path):
    assert LAYOUTS[title][1](example(section(title), tmp_path)) is not None


def test_example_of_measured_points_is_of_the_bundled_set_that_it_names(tmp_path):
    file = flank_csv.read_flank_csv(example(section("Flank CSV"), tmp_path))
    pinion = load_bevel_set(bundled("nasa_tp3096_12x36.toml")).member("pinion")
    check_belongs(pinion, file)
    check_points(file, nominal_rows(file, pinion), pinion)


def test_example_of_a_point_text_is_read_to_the_points_of_the_flank_csv(tmp_path):
    text = point_text.read_point_text(example(section("Point text"), tmp_path))
    file = flank_csv.read_flank_csv(example(section("Flank CSV"), tmp_path))
    assert text.point == pytest.approx(file.point, abs=1e-4)
    assert text.normal == pytest.approx(file.normal, abs=1e-5)


def test_page_names_every_target_and_unit():
    for names in touch_csv._NAMES.values():
        assert all(f"`{name}`" in PAGE for name in names)
    assert set(point_text.UNITS) == {"mm", "inch"}


@pytest.mark.parametrize(("title", "verb"), [(title, verb) for title, verbs in VERBS.items() for verb in verbs])
def test_help_of_each_verb_names_its_layout_and_the_page(command, title, verb):
    status, out, _ = command(verb, "--help")
    assert status == 0
    words = " ".join(out.split())
    assert ", ".join(LAYOUTS[title][0]) in words
    assert "docs/files.md" in words


def test_help_of_points_says_what_a_row_is(command):
    words = " ".join(command("points", "--help")[1].split())
    assert "rows 'x y z' or 'x y z i j k'" in words
    assert "docs/files.md" in words

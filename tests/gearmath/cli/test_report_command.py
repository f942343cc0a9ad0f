"""``gearmath report``: the page says what is known of the gear, holds its pictures, and refuses what is not of it."""

from __future__ import annotations

import base64
import json
import re
from dataclasses import replace
from html import unescape

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.machine.mill import nominal_flank
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import join, write_flank_csv
from gearmath.specs.toml import bundled

SET = "nasa_tp3096_12x36.toml"
#: The work sits off by 12 µm towards 50 degrees; its flanks are 4 µm too thick, and 3 µm fuller towards the heel.
SEAT = 0.012 * np.array([np.cos(np.radians(50)), np.sin(np.radians(50)), 0.0])


def written(path, gear_set, seat=SEAT, flanks=FLANKS):
    """A pinion, tooth 0 measured in full, the others at middle and corners, with noise of 0.2 µm."""
    grid = blank_grid(gear_set.pinion)
    whole = join(
        [nominal_flank(gear_set.pinion, "pinion", flank, grid, tooth=k) for k in range(12) for flank in flanks]
    )
    corner = np.isin(whole.row, (0, 4)) & np.isin(whole.col, (0, 8))
    whole = whole.pick((whole.tooth == 0) | corner | ((whole.row == 2) & (whole.col == 4)))
    noise = 2e-4 * np.random.default_rng(3).standard_normal(len(whole))
    deviation = 4e-3 + 3e-3 * (whole.col - 4) / 8 + whole.normal @ seat + noise
    point = whole.point + deviation[:, None] * whole.normal
    write_flank_csv(path, replace(whole, point=point, deviation=deviation, uncertainty=np.full(len(whole), 2e-4)))
    return path


@pytest.fixture(scope="module")
def measured(tmp_path_factory, gear_set):
    return written(tmp_path_factory.mktemp("measured") / "m.csv", gear_set)


def tables(html):
    """Rows of cells of every table, by its caption."""
    found = {}
    for caption, body in re.findall(r"<table><caption>(.*?)</caption>(.*?)</table>", html, re.DOTALL):
        rows = re.findall(r"<tr>(.*?)</tr>", body)
        found[unescape(caption)] = [
            [unescape(c) for c in re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row)] for row in rows
        ]
    return found


@pytest.fixture
def page(command, measured, tmp_path):
    target = tmp_path / "report.html"
    status, _, err = command("report", measured, "--set", SET, "-o", target)
    assert (status, err) == (0, "")
    return target


def test_page_finds_the_clamping_and_the_form_that_were_put_in(page):
    found = tables(page.read_text("utf-8"))
    _, eccentricity, tilt, *_ = found["How the work sat while it was measured"]
    assert eccentricity[0] == "eccentricity"
    assert float(eccentricity[1]) == pytest.approx(12.0, abs=3 * float(eccentricity[2]))
    assert float(eccentricity[4].split()[1]) == pytest.approx(50.0, abs=3 * np.degrees(float(eccentricity[2]) / 12))
    assert abs(float(tilt[1])) < 4 * float(tilt[2])
    rows = {row[0]: row[1:] for row in found["Mean, first and second order of the flanks, and what they leave"]}
    # of tooth 0, which keeps what the seat is not known to
    assert [float(value) for value in rows["mean"]] == pytest.approx([4.0, 4.0], abs=3 * float(eccentricity[2]))
    # columns of the grid are not quite lines of equal X, hence a tenth
    assert [float(value) for value in rows["spiral angle deviation"]] == pytest.approx([3.0, 3.0], abs=0.3)
    assert max(abs(float(value)) for value in rows["profile crowning"]) < 0.3


def test_page_says_the_same_as_evaluate_and_compensate(page, command, measured, tmp_path):
    found = tables(page.read_text("utf-8"))
    figures = json.loads(command("evaluate", measured, "--set", SET, "--json")[1])
    sure = next(rows for caption, rows in found.items() if caption.startswith("Standard uncertainties"))
    pitch = {row[0]: float(row[2]) for row in sure if row[1] == "F p"}
    assert pitch == pytest.approx({flank: figures["flanks"][flank]["F_p_um"] for flank in FLANKS}, abs=0.005)
    (rms,) = (rows for caption, rows in found.items() if caption.startswith("RMS"))
    assert [row[0] for row in rms[1:]] == list(FLANKS)  # fixed settings: one pass a flank
    assert all(float(row[3]) < 0.1 * float(row[1]) for row in rms[1:])
    changes = found["Settings that change"][1:]
    assert {row[0] for row in changes} == set(FLANKS)
    for row in changes:
        old, new, change, u = (float(cell) for cell in row[2:6])
        assert new - old == pytest.approx(change, abs=2e-6)
        assert u > 0


def test_pictures_are_in_the_page_and_beside_it(page):
    inside = re.findall(r'src="data:image/png;base64,([^"]*)"', page.read_text("utf-8"))
    beside = [page.with_name(f"report_{name}.png").read_bytes() for name in ("measured", "corrected")]
    assert [base64.b64decode(data) for data in inside] == beside
    assert all(data.startswith(b"\x89PNG\r\n") for data in beside)


def test_a_second_measurement_takes_the_place_of_what_is_expected(command, measured, gear_set, tmp_path):
    again = written(tmp_path / "again.csv", gear_set, 0 * SEAT)
    target = tmp_path / "report.html"
    assert command("report", measured, "--set", SET, "--again", again, "-o", target)[0] == 0
    assert "as measured after it" in target.read_text("utf-8")


def test_a_member_that_cannot_be_corrected_has_a_report_that_says_why(command, gear_set, tmp_path):
    half = written(tmp_path / "half.csv", gear_set, flanks=("concave",))
    target = tmp_path / "report.html"
    status, _, err = command("report", half, "--set", SET, "-o", target)
    assert (status, err) == (0, "")
    text = target.read_text("utf-8")
    assert "No corrected settings: " in text
    assert "Settings that change" not in text


def test_free_text_of_the_set_cannot_become_markup(command, measured, tmp_path):
    text = bundled(SET).read_text("utf-8")
    nasty = re.sub(r'^title = ".*"$', "title = '<img src=x onerror=alert(1)>'", text, flags=re.MULTILINE)
    assert nasty != text
    (tmp_path / "set.toml").write_text(nasty, "utf-8")
    target = tmp_path / "report.html"
    assert command("report", measured, "--set", tmp_path / "set.toml", "-o", target)[0] == 0
    assert "<img src=x" not in target.read_text("utf-8")


def test_another_member_s_file_is_refused_and_nothing_is_written(command, measured, tmp_path):
    target = tmp_path / "report.html"
    status, _, err = command("report", measured, "--set", "crown_gear_7x43.toml", "-o", target)
    assert status == 2
    assert "member_teeth = 12: the pinion of the set has 7" in err
    assert list(tmp_path.iterdir()) == []

"""``gearmath report``: the sheet says what is known of the gear and no more, and what was left out before all else."""

from __future__ import annotations

import json
import re
import subprocess
from dataclasses import replace
from html import unescape

import numpy as np
import pytest

from gearmath import cli
from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.plot import evaluation_figure
from gearmath.quality.evaluation.member import evaluate_member
from gearmath.report.charts import flank_charts
from gearmath.report.measurement import ReportedMeasurement
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import join, read_flank_csv, write_flank_csv
from gearmath.specs.toml import bundled

SET = "nasa_tp3096_12x36.toml"
#: The work sits off by 12 µm towards 50 degrees; its flanks are 4 µm too thick, and 3 µm fuller towards the heel.
SEAT = 0.012 * np.array([np.cos(np.radians(50)), np.sin(np.radians(50)), 0.0])


def written(path, gear_set, seat=SEAT, flanks=FLANKS, member="pinion"):
    """A member, tooth 0 measured in full, the others at middle and corners, with noise of 0.2 µm."""
    spec = gear_set.member(member)
    grid = blank_grid(spec)
    whole = join([nominal_flank(spec, flank, grid, tooth=k) for k in range(spec.teeth) for flank in flanks])
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


def cells(body):
    """Rows of cells of a table."""
    rows = re.findall(r"<tr>(.*?)</tr>", body, re.DOTALL)
    return [[unescape(c) for c in re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row, re.DOTALL)] for row in rows]


def tables(html):
    """Rows of cells of every table, by its caption."""
    found = re.findall(r"<table><caption>(.*?)</caption>(.*?)</table>", html, re.DOTALL)
    return {unescape(caption): cells(body) for caption, body in found}


def head(html):
    """What stands at the head of the sheet: the values of every label."""
    (body,) = re.findall(r'<table class="head">(.*?)</table>', html, re.DOTALL)
    return {label: values for label, *values in cells(body)}


def drawings(html):
    """The texts of every drawing, by its caption."""
    figures = re.findall(r"<figure><figcaption>(.*?)</figcaption><svg(.*?)</svg></figure>", html, re.DOTALL)
    return {
        unescape(caption): [unescape(text) for text in re.findall(r"<text[^>]*>(.*?)</text>", body)]
        for caption, body in figures
    }


def number(text):
    return float(text.replace("\N{MINUS SIGN}", "-"))


def run(*arguments):
    cli.gearmath.main([str(argument) for argument in arguments], standalone_mode=False)


@pytest.fixture(scope="module")
def page(measured, tmp_path_factory):
    target = tmp_path_factory.mktemp("sheet") / "report.html"
    run("report", measured, "--set", SET, "-o", target)
    return target


def test_page_finds_the_clamping_and_the_form_that_were_put_in(page):
    found = tables(page.read_text("utf-8"))
    _, eccentricity, tilt, *_ = found["Clamping, rotation and drift"]
    assert eccentricity[0] == "eccentricity"
    assert float(eccentricity[1]) == pytest.approx(12.0, abs=3 * float(eccentricity[2]))
    assert float(eccentricity[4].split()[1].rstrip("°")) == pytest.approx(
        50.0, abs=3 * np.degrees(float(eccentricity[2]) / 12)
    )
    assert abs(float(tilt[1])) < 4 * float(tilt[2])
    (orders,) = (rows for caption, rows in found.items() if "first and second order" in caption)
    rows = {row[0]: [float(value) for value in row[1:]] for row in orders[1:]}
    # of tooth 0, which keeps what the seat is not known to
    assert rows["mean"] == pytest.approx([4.0, 4.0], abs=3 * float(eccentricity[2]))
    # columns of the grid are not quite lines of equal X, hence a tenth
    assert rows["spiral angle deviation"] == pytest.approx([3.0, 3.0], abs=0.3)
    assert rows["profile crowning"] == pytest.approx([0.0, 0.0], abs=0.3)


def test_page_says_the_same_as_evaluate_and_compensate(page, command, measured, tmp_path):
    found = tables(page.read_text("utf-8"))
    figures = json.loads(command("evaluate", measured, "--set", SET, "--json")[1])
    sure = {flank: found[f"Values and uncertainties, {flank} flank"] for flank in FLANKS}
    pitch = {flank: float(row[1]) for flank, rows in sure.items() for row in rows if row[0].startswith("F p")}
    assert pitch == pytest.approx({flank: figures["flanks"][flank]["F_p_um"] for flank in FLANKS}, abs=0.005)
    (rms,) = (rows for caption, rows in found.items() if caption.startswith("RMS"))
    assert [row[0] for row in rms[1:]] == list(FLANKS)  # fixed settings: one pass a flank
    assert all(float(row[3]) < 0.1 * float(row[1]) for row in rms[1:])
    changes = found["Settings that change"][1:]
    assert {row[0].split(":")[0] for row in changes} == set(FLANKS)
    for row in changes:
        old, new, change, u = (float(cell) for cell in row[1:5])
        assert new - old == pytest.approx(change, abs=2e-6)
        assert u > 0


def test_drawings_are_in_the_page_and_two_pictures_beside_it(page):
    text = page.read_text("utf-8")
    assert len(drawings(text)) == text.count("<svg") == 4 + 2 + 1 + 2  # topography, pitch, runout, tooth
    assert "src=" not in text
    beside = {path.name: path.read_bytes() for path in page.parent.iterdir() if path != page}
    assert set(beside) == {"report_measured.png", "report_corrected.png"}
    assert all(data.startswith(b"\x89PNG\r\n") for data in beside.values())


def test_sheet_of_a_member_prints_on_few_pages_of_a4_with_nothing_cut_off(browser, page, tmp_path):
    """With every section there is. No table of the printed layout, 190 mm wide, is wider than its column."""
    options = ["--no-pdf-header-footer", f"--print-to-pdf={tmp_path / 'sheet.pdf'}", page.as_uri()]
    subprocess.run([*browser, *options], check=True, capture_output=True, timeout=120)
    assert 2 <= len(re.findall(rb"/MediaBox", (tmp_path / "sheet.pdf").read_bytes())) <= 3
    text = page.read_text("utf-8").replace("@media print", "@media screen")
    script = (
        "<script>addEventListener('load', () => { document.title = JSON.stringify("
        "[...document.querySelectorAll('div.columns table')].map(t => t.scrollWidth - t.parentNode.clientWidth))})"
        "</script></body>"
    )
    policy = re.search(r'<meta http-equiv="Content-Security-Policy"[^>]*>', text)[0]
    (tmp_path / "wide.html").write_text(text.replace(policy, "").replace("</body>", script), "utf-8")
    options = ["--window-size=718,2000", "--virtual-time-budget=5000", "--dump-dom", (tmp_path / "wide.html").as_uri()]
    dom = subprocess.run([*browser, *options], check=True, capture_output=True, timeout=120, text=True).stdout
    beyond = json.loads(unescape(re.search(r"<title>(.*?)</title>", dom)[1]))
    assert len(beyond) >= 7
    assert max(beyond) <= 0


def test_every_point_of_both_flanks_has_its_deviation_with_the_reference_point_at_zero(page, gear_set):
    """What was put in, less a turn about the work axis by hand; the numbers go by row, then column."""
    found = drawings(page.read_text("utf-8"))
    for flank in FLANKS:
        texts = [
            text for text in found[f"{flank} flank, measured: tooth 0"] if re.fullmatch(r"[+\u2212]?\d+\.\d", text)
        ]
        values = np.array([number(text) for text in texts]).reshape(5, 9)
        assert values[2, 4] == 0
        nominal = nominal_flank(gear_set.pinion, flank, blank_grid(gear_set.pinion))
        turning = np.sum(np.cross([0, 0, 1], nominal.point) * nominal.normal, axis=1).reshape(5, 9)
        put_in = np.broadcast_to(4.0 + 3.0 * (np.arange(9) - 4) / 8, (5, 9))
        wanted = put_in - 4.0 * turning / turning[2, 4]
        np.testing.assert_allclose(values, wanted, atol=1.2)  # noise of 0.2 of two points, and of the seat
        assert np.mean(values - wanted, axis=0) == pytest.approx(np.zeros(9), abs=0.6)


def test_flanks_have_the_same_scale_bar_before_and_after(page):
    found = drawings(page.read_text("utf-8"))
    bars = {
        caption: [text for text in texts if re.fullmatch(r"[\d.]+ µm", text)]
        for caption, texts in found.items()
        if "flank, " in caption
    }
    assert len(bars) == 4
    assert len(set(map(tuple, bars.values()))) == 1


def test_a_grade_stands_beside_its_tolerance_and_the_caveat_and_never_in_a_headline(page):
    text = page.read_text("utf-8")
    (caption,) = (caption for caption in tables(text) if "tolerance of the grade" in caption)
    assert caption.endswith("ISO 17485 formulas unconfirmed: no conformity claimed.")
    header, *rows = tables(text)[caption]
    assert [row[0].split(",")[0] for row in rows] == ["f_pt", "f_pt", "F_p", "F_p", "F_r"]
    for row in rows:
        heads = ("value", "grade found", "tolerance of that grade")
        value, grade, tolerance = (row[header.index(name)] for name in heads)
        if row[0].startswith("F_r"):  # 0.25 um of noise, and nothing else: see test_grades
            assert (grade, tolerance) == ("withheld", "")
            assert "grade of F_r: noise of the points alone gives F_r" in text
            continue
        assert 2 <= int(grade.split()[0]) <= 11
        assert float(value) <= float(tolerance)
    headlines = re.findall(r"<(?:h\d|title)[^>]*>(.*?)</", text)
    assert headlines[:2] == ["Inspection sheet: pinion"] * 2
    assert not any(word in line.lower() for line in headlines for word in ("grade", "within", "pass", "good"))


def test_what_is_not_known_at_the_head_is_blank_and_never_made_up(page):
    found = head(page.read_text("utf-8"))
    for label in ("Part number", "Date", "Operator", "Machine", "Probe"):
        assert found[label] == [""]
    assert found["Points"] == [
        "grid 5x9, tip radius 0 mm; 200 of 200 used"
    ]  # on each flank 45 of tooth 0, and 5 of eleven others
    assert found["Measured file"] == ["m.csv"]


@pytest.fixture(scope="module")
def second_page(measured, tmp_path_factory):
    """A point 80 µm off its neighbors, a tooth missing, and markup for the title of the set and for the operator."""
    folder = tmp_path_factory.mktemp("bad")
    file = read_flank_csv(measured)
    (k,) = np.flatnonzero((file.flank == "convex") & (file.tooth == 0) & (file.row == 1) & (file.col == 6))
    file.deviation[k] += 0.08
    file.point[k] += 0.08 * file.normal[k]
    write_flank_csv(folder / "bad.csv", file.pick((file.flank == "convex") | (file.tooth != 7)))
    text = bundled(SET).read_text("utf-8")
    nasty = re.sub(r'^title = ".*"$', "title = '<img src=x onerror=alert(1)>'", text, flags=re.MULTILINE)
    assert nasty != text
    (folder / "set.toml").write_text(nasty, "utf-8")
    target = folder / "sheet.html"
    run("report", folder / "bad.csv", "--set", folder / "set.toml", "--operator", "<b>Lee</b> & co", "-o", target)
    return target.read_text("utf-8")


def test_what_was_left_out_stands_before_every_figure(second_page):
    frame = second_page.index('<div class="first">')
    assert "convex flank, tooth 0, row 1, col 6" in second_page[frame : second_page.index("</div>", frame)]
    assert all(frame < second_page.index(mark) for mark in ("<h2>", "<svg", "<caption>"))
    assert head(second_page)["Points"][0].endswith("194 of 195 used, 1 left out")


def test_what_a_gap_withholds_is_said_first_with_its_reason_and_has_no_value_and_no_grade(second_page):
    frame = unescape(second_page[second_page.index('<div class="first">') : second_page.index("<h2>")])
    assert re.search(r"withheld: F_p of the concave flank, .*: concave flank: no reading of tooth 7 \(1 of 12\)", frame)
    assert "withheld: largest deviation of the convex flank" in frame
    (rows,) = (rows for caption, rows in tables(second_page).items() if "tolerance of the grade" in caption)
    withheld = {row[0]: row[1:] for row in rows if "withheld" in row}
    assert set(withheld) == {"f_pt, largest, concave", "F_p, concave", "F_r, both"}
    assert all(row == ["withheld", "", "withheld", ""] for row in withheld.values())
    (sizes,) = (rows for caption, rows in tables(second_page).items() if "first and second order" in caption)
    (largest,) = (row for row in sizes if row[0].startswith("largest"))
    assert [cell == "withheld" for cell in largest[1:]] == [False, True]


def test_free_text_of_set_and_options_cannot_become_markup(second_page):
    assert "<img" not in second_page
    assert "&lt;img src=x onerror=alert(1)&gt;" in second_page
    assert head(second_page)["Operator"] == ["<b>Lee</b> & co"]
    assert "<b>" not in second_page


def _check_values_again(found, command, again):
    """Every figure of the second measurement as a value, the same as evaluate says of that file."""
    _, out, _ = command("evaluate", again, "--set", SET, "--json")
    figures = json.loads(out[out.index("{") :])
    (spacing,) = (rows for caption, rows in found.items() if caption.startswith("Single pitch"))
    assert spacing[0][5:] == ["measured again", "grade then"]
    later = {row[0]: row[5] for row in spacing[1:]}
    assert {flank: float(later[f"F_p, {flank}"]) for flank in FLANKS} == pytest.approx(
        {flank: figures["flanks"][flank]["F_p_um"] for flank in FLANKS}, abs=0.006
    )
    assert float(later["F_r, both"]) == pytest.approx(figures["runout"]["F_r_um"], abs=0.006)
    (thick,) = (rows for caption, rows in found.items() if caption.startswith("Tooth thickness on the transverse"))
    assert float(thick[1][3]) == pytest.approx(figures["thickness"]["arc_deviation_um"], abs=0.006)
    (orders,) = (
        rows for caption, rows in found.items() if caption.startswith("Measured again: deviations of the mean")
    )
    rows = {row[0]: [float(value) for value in row[1:]] for row in orders[1:]}
    assert rows["mean"] == pytest.approx([figures["flanks"][f]["orders"]["mean_um"] for f in FLANKS], abs=0.006)


def test_every_rms_says_what_was_taken_out_of_it(page):
    """Of the mean before and after it is zeroed, and of the tooth that is corrected: each in its own table or row."""
    found = tables(page.read_text("utf-8"))
    taken = "clamping and the rotation that both flanks have in common taken out"
    captions = [caption for caption, rows in found.items() if any("RMS" in row[0] for row in rows) or "RMS" in caption]
    assert captions
    assert all(taken in caption or caption.startswith("Values") for caption in captions), captions
    (sentence,) = set(re.findall(r"concave: what .*? stays, \S+ µm RMS of (\S+) µm", page.read_text("utf-8")))
    (rms,) = (rows for caption, rows in found.items() if caption.startswith("RMS"))
    assert sentence == rms[1][1]


def test_no_uncertainty_on_the_sheet_is_zero(page):
    for caption, rows in tables(page.read_text("utf-8")).items():
        for row in rows[1:]:
            for name, cell in zip(rows[0], row, strict=False):
                assert not (name == "u" and cell and not re.search("[1-9]", cell)), (caption, row)


@pytest.mark.parametrize("seat", [SEAT, 0 * SEAT], ids=["clamped", "in a good seat"])
def test_sheet_and_picture_take_the_same_off_at_the_ring(gear_set, tmp_path, seat):
    """Whether or not a clamping was taken out: the rotation that both flanks have in common is in neither."""
    file = written(tmp_path / "m.csv", gear_set, seat)
    found = evaluate_member(read_flank_csv(file), gear_set.pinion)
    sheet = flank_charts(ReportedMeasurement("t", "m.csv", gear_set.pinion, found, None), {})
    words = [unescape(re.search(r">([^<]*taken off there[^<]*)<", svg)[1]) for svg, _ in sheet]
    labels = [axes.get_xlabel() for axes in evaluation_figure("t", found).axes]
    assert [label.partition(": after; ")[2] or label for label in labels if "taken off" in label] == words


@pytest.mark.slow
def test_both_members_stand_on_one_sheet_with_what_is_known_of_each(command, browser, measured, gear_set, tmp_path):
    mate, again = tmp_path / "gear.csv", tmp_path / "again.csv"
    written(mate, gear_set, 0.5 * SEAT, member="gear")
    comments = "# Part number: 0815-G\n# operator: K. <i>Lee</i>\n# probe: 2 mm ruby\n"
    mate.write_text(comments + mate.read_text("utf-8"), "utf-8")
    written(again, gear_set, 0 * SEAT)
    target = tmp_path / "sheet.html"
    run(
        "report",
        measured,
        "--set",
        SET,
        "--mate",
        mate,
        "--again",
        again,
        "--part-number",
        "4711-P",
        "--date",
        "2026-11-27",
        "-o",
        target,
    )
    text = target.read_text("utf-8")
    found = head(text)
    assert found[""] == ["pinion", "gear"]
    assert found["Part number"] == ["4711-P", "0815-G"]
    assert found["Date"] == ["2026-11-27", "2026-11-27"]
    assert found["Operator"] == ["", "K. <i>Lee</i>"]
    assert found["Probe"] == ["", "2 mm ruby"]
    assert found["Machine"] == ["", ""]
    assert "<i>" not in text
    assert re.findall(r"<h2[^>]*>(.*?)</h2>", text) == ["Pinion", "Gear"]
    pinion, gear = text[text.index("Pinion</h2>") : text.index("Gear</h2>")], text[text.index("Gear</h2>") :]
    assert "concave flank, measured again" in drawings(pinion)
    _check_values_again(tables(pinion), command, again)
    assert not any("again" in caption.lower() for caption in tables(gear))
    assert "concave flank, expected after the correction" in drawings(gear)
    assert {path.name for path in tmp_path.iterdir() if path.suffix == ".png"} == {
        f"sheet_{name}.png" for name in ("measured", "corrected", "gear_measured", "gear_corrected")
    }
    options = ["--no-pdf-header-footer", f"--print-to-pdf={tmp_path / 'sheet.pdf'}", target.as_uri()]
    subprocess.run([*browser, *options], check=True, capture_output=True, timeout=120)
    assert len(re.findall(rb"/MediaBox", (tmp_path / "sheet.pdf").read_bytes())) <= 6  # three of each member


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        (("--mate", "M"), r"m\.csv: member = 'pinion': --mate must be of the other member"),
        (("--again", "M", "--again", "M"), r"m\.csv: member = 'pinion': is there twice"),
        (("--part-number", "1", "--part-number", "2"), r"--part-number: given 2 times, for 1 measured file"),
    ],
)
def test_files_that_do_not_belong_on_the_sheet_are_refused(refused, measured, tmp_path, more, sentence):
    more = [measured if part == "M" else part for part in more]
    refused(sentence, "report", measured, "--set", SET, *more, "-o", tmp_path / "sheet.html")
    assert list(tmp_path.iterdir()) == []


def test_a_member_that_cannot_be_corrected_has_a_report_that_says_why(command, gear_set, tmp_path):
    half = written(tmp_path / "half.csv", gear_set, flanks=("concave",))
    target = tmp_path / "report.html"
    status, _, err = command("report", half, "--set", SET, "-o", target)
    assert (status, err) == (0, "")
    text = target.read_text("utf-8")
    frame = text[text.index('<div class="first">') : text.index("<h2>")]
    assert "the convex flank was not measured" in frame
    assert "no corrected settings: " in frame
    assert "Settings that change" not in text


def test_another_member_s_file_is_refused_and_nothing_is_written(command, measured, tmp_path):
    target = tmp_path / "report.html"
    status, _, err = command("report", measured, "--set", "spiral_7x43.toml", "-o", target)
    assert status == 2
    assert "member_teeth = 12: the pinion of the set has 7" in err
    assert list(tmp_path.iterdir()) == []

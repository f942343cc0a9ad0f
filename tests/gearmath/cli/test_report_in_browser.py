"""The sheet in a real browser: A4 when printed; every word inside and readable on a telephone and on a screen."""

from __future__ import annotations

import json
import re
import subprocess
from html import escape, unescape

import numpy as np
import pytest

from gearmath.page import Page
from gearmath.plot import svg
from gearmath.plot.pitch import pitch_limits
from gearmath.plot.sheet import pitch_chart, topography_chart
from gearmath.plot.topography import um_per_row
from gearmath.quality.evaluation.pitch import Pitch
from gearmath.quality.evaluation.topography import Topography

#: Measures the page in a frame: its width, and of every word of the drawings the height and the ends; and where the
#: drawings stand, which of them overlap, and how much of the width the widest element takes.
MEASURE = """
addEventListener('load', () => {
  const frame = document.querySelector('iframe'), page = frame.contentDocument;
  const words = [...page.querySelectorAll('svg text')], boxes = words.map(word => word.getBoundingClientRect());
  const sizes = words.map(word =>
    parseFloat(frame.contentWindow.getComputedStyle(word).fontSize) *
    Math.hypot(word.getScreenCTM().a, word.getScreenCTM().b));
  const charts = [...page.querySelectorAll('svg')].map(chart => chart.getBoundingClientRect());
  const beside = (a, b) => a.right <= b.left + 1 || b.right <= a.left + 1;
  const apart = (a, b) => beside(a, b) || a.bottom <= b.top + 1 || b.bottom <= a.top + 1;
  const overlapping = charts.filter((a, k) => charts.slice(k + 1).some(b => !apart(a, b))).length;
  document.title = JSON.stringify({
    charts: charts.length, overlapping, rows: new Set(charts.map(chart => Math.round(chart.top))).size,
    width: page.documentElement.scrollWidth, words: words.length, smallest: Math.min(...sizes),
    left: Math.min(...boxes.map(box => box.left)), right: Math.max(...boxes.map(box => box.right))});
});
"""


@pytest.fixture(scope="module")
def sheet():
    """A page with one of everything, and a name and a table that are too wide for a telephone."""
    page = Page("Inspection sheet: pinion")
    page.head(["pinion", "gear"], [("Part number", ["4711-" + 60 * "x", ""]), ("Date", ["", ""])])
    page.first("Left out", ["pinion: concave flank, tooth 0, row 0, col 3: left out."])
    page.heading("Pinion")
    page.paragraph("The plane net is the nominal flank.")
    up, along = np.meshgrid(np.arange(-2.0, 3), np.arange(-4.0, 5), indexing="ij")
    high = np.full((5, 9), 88.8e-3)
    flank = Topography("concave", 0, high, np.zeros(10), high, along, up)
    pitch = Pitch("concave", np.zeros(36), 1e-3 * np.sin(np.arange(36)))
    drawing = svg(topography_chart(flank, um_per_row([flank]), 0.0)), "concave flank"
    page.drawings([drawing, drawing, (svg(pitch_chart(pitch, None, pitch_limits([pitch]))), "pitch")])
    page.table("Figures", [f"column {k}" for k in range(12)], [["-1.234567"] * 12] * 40)
    return page.html


def test_sheet_prints_on_a4_in_whole_pages(browser, sheet, tmp_path):
    (tmp_path / "sheet.html").write_text(sheet, "utf-8")
    options = ["--no-pdf-header-footer", f"--print-to-pdf={tmp_path / 'sheet.pdf'}", f"file://{tmp_path}/sheet.html"]
    subprocess.run([*browser, *options], check=True, capture_output=True, timeout=120)
    boxes = re.findall(rb"/MediaBox \[([^\]]*)\]", (tmp_path / "sheet.pdf").read_bytes())
    sizes = [[float(number) for number in box.split()] for box in boxes]
    assert len(sizes) == 2
    for size in sizes:
        assert size == pytest.approx([0, 0, 210 / 25.4 * 72, 297 / 25.4 * 72], abs=1.0)


@pytest.mark.parametrize(("width", "rows"), [(420, 3), (1280, 2)])
def test_sheet_fits_a_telephone_and_a_screen_and_its_smallest_word_can_be_read(browser, sheet, tmp_path, width, rows):
    """The three drawings stand one above the other at 420 px; at 1280 px both flanks stand side by side."""
    frame = f'<iframe style="width: {width}px; height: 3000px; border: 0" srcdoc="{escape(sheet)}"></iframe>'
    (tmp_path / "frame.html").write_text(f"<!doctype html><body>{frame}<script>{MEASURE}</script>", "utf-8")
    size, page = f"--window-size={width + 100},3000", f"file://{tmp_path}/frame.html"
    options = [size, "--virtual-time-budget=5000", "--dump-dom", page]
    dom = subprocess.run([*browser, *options], check=True, capture_output=True, timeout=120, text=True).stdout
    found = json.loads(unescape(re.search(r"<title>(.*?)</title>", dom)[1]))
    assert found["width"] <= width
    assert found["words"] > 2 * 45
    assert found["left"] >= 0
    assert found["right"] <= width
    assert found["smallest"] >= 8.5
    assert (found["charts"], found["overlapping"], found["rows"]) == (3, 0, rows)

"""The pages of the gear side in a real browser, by visible labels, on stored runs; no control is needed."""

from __future__ import annotations

import io
import re
import shutil
import zipfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest
from playwright.sync_api import TimeoutError, expect

import gearmath as gm
from gearmath.hmi.messages import Text
from tests.gearmath.hmi.conftest import PATIENCE, Operator, Served

#: What a browser without WebGL says when it is asked for it.
_NO_WEBGL = """
const known = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
  return kind.includes("webgl") ? null : known.call(this, kind, ...rest);
};
"""


@pytest.fixture(scope="module")
def served(serve: Callable[..., Served], stored_runs: Path) -> Served:
    one = serve()
    shutil.copy(stored_runs, one.folder / "runs.db")
    return one


def test_a_setting_that_is_refused_stays_as_typed_with_the_reason_and_a_good_one_is_shown_against_the_file(
    served: Served, operator: Callable[..., Operator]
) -> None:
    one = operator(served)
    one.context.add_init_script(_NO_WEBGL)
    one.go("gear")
    settings = one.panel("Settings")
    one.sees("This browser has no WebGL: the flanks are shown flat.")
    one.panel("Flanks of a tooth").locator("figure svg").nth(1).wait_for(timeout=PATIENCE)
    one.sees("All settings are those of the file.")
    one.fill("Cutter swivel, convex", "400")
    one.sees("400 °: must lie between -360 and 360 °", settings)
    one.fill("Cutter tilt, convex", "44")
    why = settings.get_by_text("its pressure angle at the mean point", exact=False)
    why.first.wait_for(timeout=PATIENCE)
    assert why.count() == 1  # at its field, and not once more
    refused = "Refused, the field says why: Cutter tilt, convex; Cutter swivel, convex. What is shown is without it."
    for part in ("Settings", "Flanks of a tooth", "Contact of the pair"):
        one.sees(refused, one.panel(part))
    expect(one.page.get_by_role("button", name="Compute contact")).to_be_disabled()
    assert one.page.get_by_label("Cutter tilt, convex", exact=True).input_value() == "44"
    one.fill("Sliding base, concave", "0,36")
    settings.get_by_text("Changed against the file").wait_for(timeout=PATIENCE)
    row = settings.get_by_role("row").filter(has_text="Sliding base, concave").inner_text().split()
    assert row[-5:] == ["concave", "0.296487", "0.360000", "+0.063513", "mm"]
    assert one.page.get_by_label("Cutter swivel, convex", exact=True).input_value() == "400"
    expect(one.page.get_by_role("button", name="Save as new set")).to_be_disabled()
    other = operator(served)  # a second page shows the same
    other.context.add_init_script(_NO_WEBGL)
    other.go("gear")
    other.page.get_by_text("Changed against the file").wait_for(timeout=PATIENCE)
    assert other.page.get_by_label("Sliding base, concave", exact=True).input_value() == "0.36"
    one.picture("gear_refused")
    one.press("Discard changes")
    # at once, before anything is computed: what is typed next is not overwritten
    expect(one.page.get_by_label("Cutter swivel, convex", exact=True)).not_to_have_value("400")
    early = one.page.get_by_label("Sliding base, convex", exact=True)
    of_file = early.input_value()
    early.fill("0.3")
    for both in (one, other):
        both.sees("All settings are those of the file.")
    assert early.input_value() == "0.3"
    early.fill(of_file)
    one.fill("Sliding base, concave", "0.36")
    one.page.get_by_role("button", name="Save as new set").click(timeout=PATIENCE)
    one.sees("nasa_tp3096_12x36_pinion.toml: written")
    saved = gm.load_set(served.folder / "nasa_tp3096_12x36_pinion.toml")
    assert saved.pinion.spec.concave.sliding_base == 0.36


def test_flanks_are_shown_in_space(served: Served, operator: Callable[..., Operator]) -> None:
    one = operator(served)
    drawn = one.panel("Flanks of a tooth").locator("canvas").first
    for visit in ("first", "second"):
        with served.timed(f"3-D view, {visit} visit", 5.0):
            one.go("gear")
            drawn.wait_for(timeout=PATIENCE)
    drawn.scroll_into_view_if_needed()
    where, said = drawn.bounding_box(), one.page.locator(".gm-space .hovertext")
    assert where is not None
    for right, down in ((0.45, 0.4), (0.5, 0.5), (0.4, 0.3), (0.55, 0.6)):  # wherever a flank lies in it
        one.page.mouse.move(where["x"] + right * where["width"], where["y"] + down * where["height"], steps=4)
        with suppress(TimeoutError):
            said.wait_for(timeout=2_000)
            break
    assert re.fullmatch(r"(concave|convex)\s*-?\d+\.\d µm", said.text_content() or "")
    one.picture("gear_space")
    assert one.sticks_out(800, 1280) == []


def test_the_pair_is_shown_in_contact_on_its_measured_flanks(served: Served, operator: Callable[..., Operator]) -> None:
    one = operator(served)
    one.context.add_init_script(_NO_WEBGL)
    one.go("gear")
    one.sees("All settings are those of the file.")
    one.choose("Deviations of", "a measured run")
    one.press("Compute contact")
    rows = one.panel("Contact of the pair").get_by_role("row")
    rows.nth(2).wait_for(timeout=PATIENCE)
    assert [rows.nth(k).inner_text().split()[0] for k in (1, 2)] == ["drive", "coast"]
    assert one.axe() == []
    one.picture("gear_contact")


@pytest.mark.parametrize(("language", "dark", "size"), [("en", False, (1280, 800)), ("de", True, (800, 1280))])
def test_a_result_stands_with_tolerance_caveat_and_uncertainty(
    served: Served, operator: Callable[..., Operator], language: str, dark: bool, size: tuple[int, int]
) -> None:
    one, text = operator(served, "result", language, dark, size), Text(language)
    one.panel(text("result.topography")).locator("svg").nth(1).wait_for(timeout=PATIENCE)
    one.sees(text("result.caveat"))
    one.page.get_by_text(text("result.how_sure")).wait_for(timeout=PATIENCE)
    sure = one.panel(text("result.uncertainty"))
    assert sure.get_by_role("row").count() > 15
    figures = sure.locator("tbody tr td:first-child").all_inner_texts()
    assert text("result.spiral_angle_deviation") + ", " + text("blocks.concave") in figures
    if language == "de":  # no figure is named in English
        assert [name for name in figures if re.search("deviation|mean|crowning|eccentricity|tilt|rotation", name)] == []
        pitch = one.page.locator("figure svg").get_by_text("Gesamtteilung / µm")
        pitch.first.wait_for(state="attached")
    assert one.axe() == []
    assert one.page.evaluate("document.documentElement.scrollWidth") <= size[0]
    one.picture(f"result_{language}")


def test_the_inspection_sheet_is_saved(served: Served, operator: Callable[..., Operator]) -> None:
    one = operator(served, "result")
    with one.page.expect_download(timeout=PATIENCE) as waiting:
        one.press("Save the inspection sheet")
    assert waiting.value.suggested_filename == "inspection_run_2.html"
    assert Path(waiting.value.path()).read_text("utf-8").startswith("<!doctype html>")


def test_the_pair_is_brought_into_contact_at_the_assembly_that_is_typed(
    served: Served, operator: Callable[..., Operator]
) -> None:
    """Drawn out of mesh by 10 mm each, the teeth of 2.2 mm dedendum do not meet; the figures are those of the front."""
    one = operator(served, language="de")
    one.context.add_init_script(_NO_WEBGL)
    one.go("gear")
    panel = one.panel("Tragbild des Paars")
    panel.get_by_label("V: Achse des Rads versetzt", exact=True).wait_for(timeout=PATIENCE)
    one.fill("V: Achse des Rads versetzt", "50,1")
    one.sees("50,1 mm: muss zwischen -50 und 50 mm liegen")
    one.sees("Abgelehnt, den Grund nennt das Feld: V: Achse des Rads versetzt.", panel)
    expect(panel.get_by_role("button", name="Tragbild berechnen")).to_be_disabled()
    assert panel.get_by_text("50.1").count() == 0
    one.fill("V: Achse des Rads versetzt", "0")
    one.fill("H: Ritzel zurückgezogen", "10")
    one.fill("J: Tellerrad zurückgezogen", "10")
    other = operator(served, "gear", "de")  # a second page shows the same
    assert other.page.get_by_label("J: Tellerrad zurückgezogen", exact=True).input_value() == "10"
    one.press("Tragbild berechnen")
    one.page.get_by_text("Berührung verloren").first.wait_for(timeout=PATIENCE)
    drawn = " ".join(panel.locator(".gm-picture text").all_text_contents())
    assert "Berührung verloren" in drawn
    assert re.findall(r"\b(path|pattern|gear|pinion|teeth|contact|ellipses|dashed|tip|toe|bring)\b", drawn) == []
    assert panel.get_by_role("table").get_by_text("V 0, H 10, J 10 mm").count() == 1
    assert one.page.get_by_text("muss zwischen -50 und 50 mm liegen").count() == 0
    other.fill("H: Ritzel zurückgezogen", "0")
    other.fill("J: Tellerrad zurückgezogen", "0")
    panel.get_by_text("Für das Gezeigte nicht berechnet").wait_for()


def test_a_correction_is_seen_before_and_after_then_rejected_with_a_note_and_accepted(
    served: Served, operator: Callable[..., Operator]
) -> None:
    one = operator(served, "correct")
    one.page.get_by_role("combobox", name="Run", exact=True).click()
    one.page.get_by_role("option").filter(has_text=re.compile("^1: ")).click()
    none = one.sees("There is no correction of this run yet: compute it first.")
    for label in ("Accept: write new set and program", "Reject"):
        expect(one.page.get_by_role("button", name=label)).to_be_disabled()
    one.sees("As measured")
    with served.timed("compensation, from the button to the picture", 2.0):
        one.press("Compute correction")
        one.page.get_by_text("concave, expected after the correction").wait_for(timeout=PATIENCE)
    none.wait_for(state="hidden")
    shown = one.panel("Correction")
    assert shown.locator("svg").count() == 4
    assert shown.get_by_role("row").filter(has_text="RMS measured / µm").count() == 1
    one.picture("correct_before_and_after")
    assert one.axe() == []
    one.fill("Note (why it is rejected)", "<img src=x onerror=alert(1)>")
    one.press("Reject")
    one.sees("Rejected: <img src=x onerror=alert(1)>")
    one.press("Compute correction")
    one.page.get_by_text("concave, expected after the correction").wait_for(timeout=PATIENCE)
    one.press("Accept: write new set and program")
    one.page.get_by_text("Written beside the old files: nasa_tp3096_12x36_run1.toml, PINION_R1.MPF").wait_for(
        timeout=PATIENCE
    )
    assert (served.folder / "PINION_R1.MPF").stat().st_size > 10_000
    history = operator(served, "history", "de")
    history.sees("angenommen, nasa_tp3096_12x36_run1.toml, PINION_R1.MPF")


def test_history_shows_what_a_control_said_as_text_compares_two_runs_and_draws_the_trend(
    served: Served, operator: Callable[..., Operator]
) -> None:
    one = operator(served, "history")
    one.sees("alarm 65001: <script>alert(2)</script>", one.panel("Runs"))
    compared = one.panel("Comparison of two runs")
    compared.get_by_text("more than noise").first.wait_for(timeout=PATIENCE)
    one.press("Show the trend of this member")
    one.panel("Trend").locator("svg").first.wait_for(timeout=PATIENCE)
    assert one.axe() == []
    one.picture("history")


def test_a_job_is_planned_refused_simulated_and_its_firmware_taken(
    served: Served, operator: Callable[..., Operator]
) -> None:
    one = operator(served, "gearbox")
    one.sees("544/125")  # 4096 counts x 17 teeth over 16000 steps of the table
    one.fill("Teeth", "17.5")
    one.sees("must be a whole number")
    one.sees("Refused, the field says why: Teeth.", one.panel("Plan"))
    expect(one.page.get_by_text("544/125")).to_have_count(0)  # of another job than the one that is typed
    one.fill("Teeth", "34")
    one.sees("1088/125")
    one.fill("Speed of hob or spindle", "9000")
    one.sees("9000 1/min: must be more than 0 and at most 800 1/min")
    expect(one.page.get_by_role("button", name="Simulate")).to_be_disabled()
    one.fill("Speed of hob or spindle", "")  # the one that the plan proposes
    one.sees("1088/125")
    one.fill("Encoder edges", "20000")
    one.press("Simulate")
    one.panel("Error of the step rule over time").locator("svg").first.wait_for(timeout=PATIENCE)
    with one.page.expect_download() as waiting:
        one.press("Download the firmware folder")
    with zipfile.ZipFile(io.BytesIO(Path(waiting.value.path()).read_bytes())) as packed:
        folders = {name.split("/")[0] for name in packed.namelist()}
        assert folders == {Path(waiting.value.suggested_filename).stem}
    one.picture("gearbox")
    one.choose("Hobbing machine or lathe", "lathe_example.toml *")
    one.fill("Pitch of the thread", "8tpi")
    one.sees("3.175")
    assert one.sticks_out(800, 1280) == []
    assert one.axe() == []

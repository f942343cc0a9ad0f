"""Programs from the page: written, milled, sent; and numbers that are refused and never changed."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import expect

from gearmath.hmi.messages import Text
from gearmath.hmi.numbers import Limits, parsed
from tests.gearmath.control.live.conftest import Live
from tests.gearmath.hmi.conftest import Operator, Served


def test_a_probing_program_is_written_shown_and_sent_as_it_is(
    live: Live, page: Served, operator: Callable[..., Operator]
) -> None:
    one = operator(page, "programs")
    panel = one.panel("Probing program")
    panel.get_by_label("Program name", exact=True).fill("probe_one")
    panel.get_by_role("checkbox", name="Pitch: the reference point of every tooth").click()
    panel.get_by_role("checkbox", name="Clamping: the corners on eight teeth around").click()
    panel.get_by_role("button", name="Write probing program").click()
    # 5 x 9 points of both flanks of tooth 0, and its reference points
    said = one.sees(re.compile(r"PROBE_ONE.MPF: \d+ touches, \d+ blocks"), panel)
    assert "least clearance: tip" in said.inner_text()
    text = (page.folder / "PROBE_ONE.MPF").read_bytes()
    assert text.count(b"MEAS=") > 0
    # the limit is the number of teeth of the pinion; the verdict is not of what is refused, and comes back with it
    teeth = panel.get_by_label("Teeth with whole flanks, from tooth 0 on", exact=True)
    for typed, why in (("13", "13: must lie between 0 and 12"), ("", "a number is missing")):
        teeth.fill(typed)
        one.sees(why, panel)
        one.sees("From other inputs than now: PROBE_ONE.MPF", panel)
    teeth.fill("1")
    one.sees(re.compile("^PROBE_ONE.MPF: "), panel)
    one.sees("Choose a program to mill or send it.")
    for label in ("Mill virtually", "Send to the control"):
        expect(one.page.get_by_role("button", name=label, exact=True)).to_be_disabled()
    one.choose("Program", "PROBE_ONE.MPF")
    one.sees("Text of PROBE_ONE.MPF")
    one.press("Mill virtually")
    one.sees("PROBE_ONE.MPF: is a probing program: only a cutting program can be milled")
    assert text.decode().splitlines()[0] in one.page.locator("pre").inner_text()
    begin = len(live.nc.log)
    # a double click asks once, and its answer counts once
    one.page.get_by_role("button", name="Send to the control", exact=True).dblclick()
    one.sees("It is neither selected nor started.")
    assert one.page.get_by_role("dialog").count() == 1
    one.page.get_by_role("button", name="Yes, do it", exact=True).dblclick()
    one.sees(f"PROBE_ONE.MPF is there, {len(text)} bytes, read back alike.")
    one.picture("programs_sent")
    assert live.nc.files["Part Program/PROBE_ONE.MPF"] == text
    assert live.nc.selected == ""
    assert live.nc.log[begin:] == []
    # a second time it is there already, which the control says
    one.press("Send to the control")
    one.press("Yes, do it")
    one.sees(re.compile("PROBE_ONE.MPF: .*(exists|there already)|there is a file", re.IGNORECASE))
    one.page.get_by_role("checkbox", name="Replace a program of this name on the control").click()
    one.press("Send to the control")
    one.press("Yes, do it")
    one.sees(f"PROBE_ONE.MPF is there, {len(text)} bytes, read back alike.")


def test_a_number_out_of_range_stays_as_it_was_typed_and_is_refused_with_its_limits(
    page: Served, operator: Callable[..., Operator]
) -> None:
    one = operator(page, "programs")
    panel = one.panel("Cutting program")
    field = panel.get_by_label("Feed past the tooth", exact=True)
    for typed, why in (
        ("99999", "99999 mm/min: must lie between 1 and 4000 mm/min"),
        ("-1", "-1 mm/min: must lie between 1 and 4000 mm/min"),
        ("3oo", "3oo is no number"),
        ("", "a number is missing"),
    ):
        field.fill(typed)
        field.press("Tab")
        one.sees(why, panel)
        assert field.input_value() == typed
        panel.get_by_role("button", name="Write cutting program").click()
        assert not (page.folder / "CUT_PINION.MPF").exists()
    field.fill("250,5")
    field.press("Tab")
    panel.get_by_text("a number is missing").wait_for(state="detached")
    assert field.input_value() == "250,5"


@pytest.mark.slow
def test_a_cutting_program_is_written_and_milled_with_progress(page: Served, operator: Callable[..., Operator]) -> None:
    one = operator(page, "programs", language="de", dark=True, size=(800, 1280))
    panel = one.panel("Fräsprogramm")
    written = re.compile("CUT_PINION.MPF: \\d+ Sätze, .* keine Kollision, Grenzen und Toleranz eingehalten")
    # the bar may have come and gone: a second press would ask whether the program shall be replaced
    one.press_until("Fräsprogramm schreiben", panel.get_by_role("progressbar").or_(panel.get_by_text(written)).first)
    one.sees(written, panel)
    one.choose("Programm", "CUT_PINION.MPF")
    one.press("Virtuell fräsen")
    said = one.sees(re.compile("größte Abweichung"))
    # the program's own tolerance, 0.1 um, on a machine without errors
    assert float(re.search(r"Sollflanken ([\d.]+) µm", said.inner_text())[1]) <= 0.1  # type: ignore[index]
    one.picture("programs_milled_de_dark_800x1280")
    assert one.axe() == []


@pytest.mark.parametrize(
    ("typed", "value"),
    [("3", 3.0), (" 3.5 ", 3.5), ("3,5", 3.5), ("-0", 0.0), ("1e1", 10.0), ("10", 10.0), ("0", 0.0)],
)
def test_a_number_is_read_as_it_stands(typed: str, value: float) -> None:
    assert parsed(Text("en"), typed, Limits(0.0, 10.0), "mm") == (value, None)


@pytest.mark.parametrize(("typed", "value"), [("3", 3.0), ("3.0", 3.0), ("0.5", None), ("2,999", None)])
def test_a_count_is_a_whole_number_and_is_never_cut_off(typed: str, value: float | None) -> None:
    found, why = parsed(Text("en"), typed, Limits(0.0, 10.0), "", whole=True)
    assert found == value
    assert why == (None if value is not None else f"{typed}: must be a whole number")


def test_a_limit_without_a_unit_leaves_no_gap_before_the_colon() -> None:
    assert parsed(Text("en"), "-1", Limits(0, 20_000_000), "")[1] == "-1: must lie between 0 and 20000000"


@pytest.mark.parametrize(
    ("typed", "why"),
    [
        ("0", "0 mm: must be more than 0 and less than 10 mm"),
        ("10", "10 mm: must be more than 0 and less than 10 mm"),
        ("1e-9", None),
    ],
)
def test_a_limit_that_is_itself_refused_is_said_to_be(typed: str, why: str | None) -> None:
    limits = Limits(0.0, 10.0, above=True, below=True)
    assert parsed(Text("en"), typed, limits, "mm")[1] == why
    assert limits.hint(Text("en"), "mm") == "> 0 … < 10 mm"


def test_a_large_count_keeps_all_of_its_digits() -> None:
    """2^62 - 1 is none of the numbers that 64 bits of floating point have."""
    limits = Limits(0, 2**62)
    assert parsed(Text("en"), str(2**62 - 1), limits, "", whole=True) == (2**62 - 1, None)
    assert parsed(Text("en"), str(2**62 + 1), limits, "", whole=True)[0] is None
    assert parsed(Text("en"), "1e-999", limits, "", whole=True)[0] is None  # 0 as a float


@pytest.mark.parametrize(
    "typed",
    ["", " ", "10.0001", "-0.0001", "nan", "inf", "1e999", "1_0", "0x1", "1.2.3", "1,2,3", "1 0", "٣", "1e", "."],
)
def test_what_is_no_number_or_out_of_range_is_refused(typed: str) -> None:
    value, why = parsed(Text("en"), typed, Limits(0.0, 10.0), "mm")
    assert value is None
    assert why

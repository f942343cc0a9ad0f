"""The hobbing planner: ratios by hand, refusals, and the firmware as a zip."""

from __future__ import annotations

import io
import json
import math
import re
import tomllib
import zipfile
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import pytest

from gearmath.errors import InputError
from gearmath.gearbox.train import GearboxPlan
from gearmath.hmi import hobbing_job
from gearmath.hmi.blocks import words_of_charts
from gearmath.hmi.drawing import drawn, translated
from gearmath.hmi.hobbing_job import HobbingWish, blank_lines, firmware_zip, plan_lines, planned, predicted, sketch_name
from gearmath.hmi.messages import Text
from gearmath.hmi.words import unit
from gearmath.specs.hobbing import load_hobbing_machine
from gearmath.specs.toml import bundled

Command = Callable[..., tuple[int, str, str]]


def test_the_ratio_is_counts_of_the_encoder_by_steps_of_the_motor_while_the_table_turns_one_tooth() -> None:
    path = bundled("hobbing_metric.toml")
    values = tomllib.loads(path.read_text("utf-8"))
    machine = load_hobbing_machine(path)
    job = planned(machine, HobbingWish(teeth=29, starts=2))
    counts = Fraction(machine.encoder_counts)  # of a turn of the hob, two teeth
    table = values["table"]
    steps = Fraction(table["full_steps"]) * table["microsteps"] * Fraction(table["belt"]) * Fraction(table["worm"])
    lines = {line.key: line for line in plan_lines(job.plan)}
    assert Fraction(lines["ratio"].value) == counts * 29 / (2 * steps)
    assert lines["ratio"].unit == "counts/step"
    assert all(line.unit for line in (*lines.values(), *blank_lines(job.plan.blanks[0])))


def test_rates_stand_beside_their_limits() -> None:
    machine = load_hobbing_machine(bundled("hobbing_metric.toml"))
    lines = {line.key: line for line in plan_lines(planned(machine, HobbingWish(teeth=40, rpm=100.0)).plan)}
    assert lines["rpm"].percent == pytest.approx(100.0 * 100.0 / machine.limits.hob_rpm)
    assert lines["edge_rate"].value == f"{100 / 60 * float(machine.encoder_counts):.0f}"


def test_what_the_machine_cannot_do_is_refused_with_the_limit() -> None:
    machine = load_hobbing_machine(bundled("hobbing_metric.toml"))
    with pytest.raises(InputError, match=r"limits\.hob_rpm"):
        planned(machine, HobbingWish(teeth=40, rpm=1e5))
    for feed in ("x", "5/0", "1e999999999"):  # of the last not even the digits are counted
        with pytest.raises(InputError, match=f"feed = '{feed}': must be a number"):
            planned(machine, HobbingWish(teeth=40, hob=machine.hobs[0].name, helix=10.0, feed=feed))
    with pytest.raises(InputError, match="pitch"):
        planned(load_hobbing_machine(bundled("lathe_example.toml")), HobbingWish(pitch="fine"))


def test_a_decimal_comma_is_a_decimal_point_in_pitch_and_feed() -> None:
    lathe, machine = (load_hobbing_machine(bundled(name)) for name in ("lathe_example.toml", "hobbing_metric.toml"))
    threads = [planned(lathe, HobbingWish(pitch=pitch)).plan for pitch in ("1,25mm", "1.25mm")]
    assert threads[0] == threads[1]
    hob = machine.hobs[0].name
    gears = [planned(machine, HobbingWish(teeth=40, hob=hob, helix=10.0, feed=feed)).plan for feed in ("0,5", "1/2")]
    assert gears[0] == gears[1]


def test_a_helical_gear_has_the_lead_of_its_helix_at_the_pitch_circle() -> None:
    """pi m z / sin(beta), ISO 21771: the lead is one turn along the pitch cylinder of diameter m z / cos(beta)."""
    machine = load_hobbing_machine(bundled("hobbing_helical.toml"))
    hob = machine.hobs[0].name
    for hand in ("right", "left"):
        job = planned(machine, HobbingWish(teeth=17, hob=hob, helix=20.0, hand=hand, cut="conventional"))
        assert isinstance(job.plan, GearboxPlan)
        assert job.plan.helix is not None
        assert (job.plan.helix.hand, job.plan.helix.cut) == (hand, "conventional")
        assert job.plan.helix.lead == pytest.approx(math.pi * 17 / math.sin(math.radians(20)), rel=1e-9)  # module 1


def test_a_thread_is_planned_on_a_lathe() -> None:
    job = planned(load_hobbing_machine(bundled("lathe_example.toml")), HobbingWish(pitch="8tpi", starts=2))
    lines = {line.key: line.value for line in plan_lines(job.plan)}
    assert (lines["pitch"], lines["lead"]) == ("3.175", "6.35")


def test_the_zip_holds_what_the_command_writes_and_is_the_same_every_time(tmp_path: Path, command: Command) -> None:
    machine = load_hobbing_machine(bundled("hobbing_plewes.toml"))
    content = firmware_zip(machine, "gearbox")
    assert content == firmware_zip(machine, "gearbox")
    assert command("export", "teensy", "hobbing_plewes.toml", "-o", tmp_path / "gearbox")[0] == 0
    written = {f"gearbox/{path.name}": path.read_bytes() for path in (tmp_path / "gearbox").iterdir()}
    with zipfile.ZipFile(io.BytesIO(content)) as packed:
        assert packed.testzip() is None
        assert {name: packed.read(name) for name in packed.namelist()} == written


def test_no_name_in_the_zip_leads_out_of_its_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    machine = load_hobbing_machine(bundled("hobbing_plewes.toml"))
    for sketch in ("../gearbox", "a/b", "", "-x"):
        with pytest.raises(InputError):
            firmware_zip(machine, sketch)
    for name in ("../x.c", "a/../b.c", "/etc/x", "..", "a\\b.c"):
        monkeypatch.setattr(hobbing_job, "teensy_files", lambda *_, name=name: {name: "text"})
        with pytest.raises(InputError, match="no plain name"):
            firmware_zip(machine, "gearbox")


def test_every_bundled_machine_has_a_name_for_its_sketch() -> None:
    for name in ("hobbing_default.toml", "hobbing_helical.toml", "hobbing_plewes.toml", "lathe_example.toml"):
        machine = load_hobbing_machine(bundled(name))
        assert len(firmware_zip(machine, sketch_name(machine))) > 10_000


def test_the_quality_that_is_predicted_is_that_of_the_command(command: Command) -> None:
    machine = load_hobbing_machine(bundled("hobbing_metric.toml"))
    name = machine.hobs[0].name
    rows, whole = predicted(machine, HobbingWish(teeth=24, hob=name))
    _, out, _ = command("gearbox", "cut", "hobbing_metric.toml", "--teeth", 24, "--hob", name, "--json")
    gear = json.loads(out)["gears"][0]
    assert whole == gear["accuracy_class"]
    assert [row.figure for row in rows] == [each["figure"] for each in gear["figures"]]
    assert [row.value_um for row in rows] == pytest.approx([each["value_um"] for each in gear["figures"]])
    with pytest.raises(InputError, match="only a gear has a class"):
        predicted(load_hobbing_machine(bundled("lathe_example.toml")), HobbingWish(pitch="8tpi"))


def test_units_and_the_chart_of_the_error_have_german_words_on_a_german_page() -> None:
    german = Text("de")
    assert unit(german, "counts/step") == "Geberschritte/Schritt"
    assert unit(german, "steps / 100 mm") == "Schritte / 100 mm"
    assert unit(german, "1/min") == "1/min"
    machine = load_hobbing_machine(bundled("hobbing_plewes.toml"))
    figure = planned(machine, HobbingWish(teeth=17)).plot(edges=2000)
    words = re.findall(r">([^<>]+)</text>", translated(drawn(lambda: figure), words_of_charts(german)))
    shown = " ".join(words).replace(machine.name, "")
    assert not re.search(r"\b(steps?|count|rpm|rule|most|time|error)\b", shown), shown

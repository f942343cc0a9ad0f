"""What the command line does is at the front door too, in one or two calls, and says the same."""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import click
import numpy as np
import pytest

import gearmath as gm
from gearmath import cli
from gearmath.cli import gearmath as command_line
from gearmath.specs.flank_csv import read_flank_csv

SET = "nasa_tp3096_12x36.toml"
#: Every verb, and the name of the front door that does it.
DOOR = {
    "demo": "run_demo",
    "gearbox plan": "hobbing.plan",
    "gearbox simulate": "hobbing.Job.simulate",
    "gearbox cut": "hobbing.hob",
    "gearbox choose": "hobbing.choose",
    "blank": "load_blank",
    "design": "design",
    "flank": "Member.flank",
    "tooth": "Member.tooth",
    "contact": "GearSet.contact",
    "nc cut": "Member.program",
    "nc time": "Program.time",
    "nc probe": "Member.probing",
    "nc calibrate": "Machine.calibrating",
    "mill": "Program.mill",
    "probe": "results.ProbingProgram.run",
    "touches": "Measurement.from_touches",
    "calibrate": "Machine.calibrate",
    "points": "Measurement.from_points",
    "evaluate": "Measurement.evaluate",
    "compensate": "Measurement.compensate",
    "stock": "Measurement.share_stock",
    "report": "Measurement.report",
    "uncertainty": "Measurement.uncertainty",
    "runs list": "MeasurementStore.runs",
    "runs show": "MeasurementStore.run",
    "runs export": "MeasurementStore.run",
    "runs compare": "evaluate_run",
    "runs resume": "MeasurementStore.resume_run",
    "rexs": "GearSet.from_rexs",
    "export step": "GearSet.to_step",
    "export stl": "GearSet.to_stl",
    "export points": "results.FlankSurface.to_text",
    "export rexs": "GearSet.to_rexs",
    "export summary": "GearSet.to_summary",
    "export teensy": "hobbing.export_teensy",
    "export cnc": "export_cnc",
}
#: They serve or talk to something outside of the process for as long as somebody wants: no call that returns a result.
SERVICES = {"control", "hmi"}


def verbs(group: click.Group, before: str = "") -> Iterator[str]:
    context = click.Context(group)
    for name in group.list_commands(context):
        command = group.get_command(context, name)
        if isinstance(command, click.Group):
            yield from verbs(command, f"{before}{name} ")
        else:
            yield before + name


def test_every_verb_is_at_the_front_door() -> None:
    assert {verb for verb in verbs(command_line) if verb.split()[0] not in SERVICES} == set(DOOR)


@pytest.mark.parametrize(("verb", "path"), DOOR.items())
def test_what_does_a_verb_says_what_it_does(verb: str, path: str) -> None:
    one = gm
    for name in path.split("."):
        one = getattr(one, name)
    assert one.__doc__


#: What reads a file or runs one step of a verb: the command line leaves it to the front door.
BEHIND_THE_DOOR = (
    "load_(pair|milling_machine|calibration|simulated_machine|hobbing_machine)|checked_(cut|probing)|judge_probing|"
    "mill_member|run_touches|trajectory|solve_flank|write_(stl|step)|evaluate_member|correct|save_corrected|blank_of|"
    "covariance_of|uncertain_figures|inspection_sheet|foreign_file|reversed_set|plan_thread|cut_and_inspect"
)
#: Touches and calibrations say more of a run than a measurement does.
SAYS_MORE = {"probe.py"}


def test_the_command_line_is_written_on_the_front_door() -> None:
    found = []
    for path in sorted(Path(cli.__file__).parent.glob("*.py")):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and not (node.module or "").startswith("gearmath.front"):
                found += [f"{path.name}: {one.name}" for one in node.names if re.fullmatch(BEHIND_THE_DOOR, one.name)]
    assert [one for one in found if one.partition(":")[0] not in SAYS_MORE] == []


@pytest.fixture
def pinion() -> gm.Member:
    return gm.load_set(SET).pinion


def test_a_cut_is_the_same_from_both(pinion: gm.Member, command: Callable, tmp_path: Path) -> None:
    target = tmp_path / "CUT.MPF"
    job = ("--spaces", "0", "--tolerance-um", "1", "--finishing-stock", "0.2")
    assert command("nc", "cut", SET, "--member", "pinion", *job, "-o", target)[0] == 0
    program = pinion.program(name="CUT", spaces=[0], tolerance=1e-3, finishing_stock=0.2)
    assert program.text == target.read_text()
    _, out, _ = command("nc", "time", target, "--json")
    assert program.time().to_dict() | {"program": "CUT.MPF"} == json.loads(out)  # a program knows no file
    left = program.mill()
    stock = left.share_stock()
    _, out, _ = command("stock", left.to_csv(tmp_path / "left.csv"), "--set", SET, "--json")
    assert np.degrees(stock.turn) == pytest.approx(json.loads(out)["turn_deg"], abs=1e-5)
    assert 1000 * stock.most["convex"] == pytest.approx(json.loads(out)["most_um"]["convex"], abs=1e-2)


def test_a_measurement_is_the_same_from_both(pinion: gm.Member, command: Callable, tmp_path: Path) -> None:
    program, raw, measured, ours = (tmp_path / name for name in ("PROBE.MPF", "raw.csv", "measured.csv", "ours.csv"))
    few = ("--topography", "none", "--no-registration")
    assert command("nc", "probe", SET, "--member", "pinion", *few, "-o", program)[0] == 0
    shop = ("--errors", "simulated_shop.toml")
    assert command("probe", program, "--set", SET, *shop, "--run", "3", "-o", raw)[0] == 0
    assert command("touches", raw, "--set", SET, "-o", measured)[0] == 0

    made = pinion.probing(name="PROBE", topography=(), registration=False)
    assert made.text == program.read_text()
    assert made.run(ours, shop=gm.load_shop(), number=3).read_text() == raw.read_text()
    found = gm.Measurement.from_touches(ours, pinion.gear_set)
    np.testing.assert_allclose(found.deviation, read_flank_csv(measured).deviation, atol=1e-6)


def test_a_calibration_is_the_same_from_both(command: Callable, tmp_path: Path) -> None:
    program, raw, ours, found = (tmp_path / name for name in ("CAL.MPF", "raw.csv", "ours.csv", "probe.toml"))
    assert command("nc", "calibrate", "-o", program)[0] == 0
    assert command("probe", program, "--errors", "simulated_shop.toml", "-o", raw)[0] == 0
    assert command("calibrate", raw, "-o", found)[0] == 0
    made = gm.load_machine().calibrating(name="CAL")
    assert made.text == program.read_text()
    tip = gm.load_machine().calibrate(made.run(ours, shop=gm.load_shop()))
    assert gm.load_probe(found).tip_radius == pytest.approx(tip.radius, abs=1e-6)


def test_sets_and_points_of_other_programs_are_the_same_from_both(command: Callable, tmp_path: Path) -> None:
    pair = gm.load_set(SET)
    theirs, ours = tmp_path / "theirs", tmp_path / "ours"
    for verb, write in (
        ("rexs", lambda path: pair.to_rexs(path)),
        ("summary", lambda path: pair.to_summary(path)),
        ("stl", lambda path: pair.to_stl(path)),
    ):
        assert command("export", verb, SET, "-o", theirs)[0] == 0
        write(ours)
        one, other = (re.sub(rb'date="[^"]*"', b"", path.read_bytes()) for path in (ours, theirs))  # REXS is dated
        assert one == other, verb
    which = ("--member", "gear", "--flank", "convex")
    assert command("export", "points", SET, *which, "-o", theirs)[0] == 0
    pair.gear.flank("convex").to_text(ours)
    assert ours.read_text() == theirs.read_text()
    read = gm.Measurement.from_points({("convex", 0): ours}, pair.gear)
    assert abs(read.deviation).max() < 1e-5  # mm: the points are nominal, with so many decimals
    pair.to_rexs(ours)
    np.testing.assert_allclose(
        gm.GearSet.from_rexs(ours).gear.flank("convex").point, pair.gear.flank("convex").point, atol=1e-6
    )


def test_a_blank_is_the_same_from_both(command: Callable) -> None:
    _, out, _ = command("blank", "blank_iso23509_sample1.toml", "--json")
    blank = gm.load_blank("blank_iso23509_sample1.toml")
    assert json.loads(json.dumps(blank.to_dict())) == json.loads(out)
    _, out, _ = command("blank", "blank_iso23509_sample1.toml", "--fragment")
    assert blank.fragment() == out
    assert "shaft angle" in blank._repr_html_()

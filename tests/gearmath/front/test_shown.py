"""Every record that a public call returns: one line where it is printed, a table in Jupyter, plain numbers for JSON."""

from __future__ import annotations

import ast
import csv
import importlib
import inspect
import json
import re
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gearmath as gm
from gearmath.quality.calibration.axes import AxisCalibration
from gearmath.quality.calibration.tip import Fit, Tip
from gearmath.shown import Shown

SET = "nasa_tp3096_12x36.toml"
#: A name of a class in an annotation, with what it is a part of: "list[str]" has none.
_CLASS = re.compile(r"[A-Z]\w+")


@cache
def _pair() -> gm.GearSet:
    return gm.load_set(SET)


@cache
def _measured() -> gm.Measurement:
    return _pair().pinion.with_settings(concave={"radial_distance": 0.05}).deviations()


@cache
def _program() -> gm.Program:
    return _pair().pinion.program(spaces=[0], tolerance=1e-3)


@cache
def _job() -> gm.hobbing.Job:
    return gm.hobbing.plan("hobbing_plewes.toml", teeth=17, hob="32dp", helix=20, feed=0.5)


def _fit(values: int) -> Fit:
    return Fit(np.ones(values), np.eye(values) * 1e-6, np.full(30, 1e-3))


def _tip() -> Tip:
    return Tip(2.0, np.zeros(3), (0.001, 0.5), 1e-3, np.full(3, 1e-3), _fit(6))


def _axes() -> AxisCalibration:
    return AxisCalibration(np.zeros(3), 300.0, 0.01, 1e-4, 0.5, 80.0, _fit(8))


def _stored() -> gm.MeasurementStore:
    return gm.MeasurementStore(None, Path("shop.db"))


def _run() -> Any:
    from gearmath.control.interface import RunStart
    from gearmath.control.store_run import StoredRun

    return StoredRun(_stored(), 7, RunStart("sinumerik", "PROBE.MPF", b"N10 " * 9999, (), {}))


def _evaluated_run() -> Any:
    from gearmath.control.store_evaluation import EvaluatedRun

    found = _measured()
    return EvaluatedRun(_run(), _pair().spec, "pinion", found.file, found.evaluate().found)


def _demo() -> Any:
    from gearmath.demo import MemberResult
    from gearmath.quality.evaluation.pitch import Pitch

    found = _measured()
    pitch = Pitch("concave", np.zeros(12), np.zeros(12))
    topography = {flank: one.topographies[0] for flank, one in found.evaluate().found.flanks.items()}
    return MemberResult("pinion", topography, topography, [pitch], [pitch], (found.file, found.file))


def _foreign() -> Any:
    from gearmath.front.judged import ForeignPoints
    from gearmath.quality.foreign.member import Foreign

    return ForeignPoints(_measured(), Foreign(_measured().file, (), ("turned",)))


def _written() -> Any:
    from gearmath.exchange.step import WrittenSolid

    return WrittenSolid(12, 34567.8)


@cache
def _hobbed() -> Any:
    return gm.hobbing.hob("hobbing_plewes.toml", 17)


def _choice() -> Any:
    from gearmath.gearbox.hobbed.choice import Choice, ChosenParts

    return Choice(8, ChosenParts(16, 1024, 12, 0.2), _hobbed().gear, 300.0, 7)


#: One of each record that a call returns.
EXAMPLES: dict[str, Callable[[], Any]] = {
    "GearSet": _pair,
    "Member": lambda: _pair().pinion,
    "FlankSurface": lambda: _pair().pinion.flank("concave"),
    "Tooth": lambda: _pair().pinion.tooth(),
    "Contact": lambda: _pair().contact(sides=("drive",), v=0.05, shaft=0.1),
    "PairDesign": lambda: gm.design("design_7x43.toml"),
    "Blank": lambda: gm.load_blank("blank_iso23509_sample1.toml"),
    "Machine": gm.load_machine,
    "SimulatedMachine": gm.load_shop,
    "Calibration": gm.load_probe,
    "HobbingMachine": gm.hobbing.load_hobber,
    "Program": _program,
    "Judgement": lambda: _program().judge(),
    "MillingReport": lambda: _program().report(),
    "ProgramTime": lambda: _program().time(),
    "ProbingProgram": lambda: _pair().pinion.probing(topography=(), registration=False),
    "Measurement": _measured,
    "Evaluation": lambda: _measured().evaluate(),
    "Correction": lambda: _measured().compensate(),
    "Uncertainty": lambda: _measured().uncertainty(1.0, draws=2000),
    "Stock": lambda: _measured().share_stock(),
    "Tip": _tip,
    "AxisCalibration": _axes,
    "Job": _job,
    "HobbedGear": _hobbed,
    "VirtualGear": lambda: _hobbed().gear,
    "Choice": _choice,
    "Simulation": lambda: _job().simulate(edges=1000),
    "Uncertain": lambda: _measured().uncertainty(1.0, draws=2000).figures[0],
    "TableRow": lambda: gm.load_blank("blank_iso23509_sample1.toml").rows[0],
    "FoundSettings": lambda: gm.settings_of(_measured(), SET),
    "ReversedMember": lambda: gm.settings_of(_measured().file, SET).found,
    "MachinePath": lambda: _program().path,
    "CuttingRun": lambda: _program().runs[0],
    "ToothSpace": lambda: _program().space,
    "HobbedThread": lambda: gm.hobbing.plan("lathe_example.toml", pitch="1.25mm").thread(length=10.0),
    "Kernel": lambda: gm.kernel("motion_sensitivity"),
    "MeasurementStore": _stored,
    "StoredRun": _run,
    "EvaluatedRun": _evaluated_run,
    "MemberResult": _demo,
    "ForeignPoints": _foreign,
    "WrittenSolid": _written,
}


def _public_calls() -> Iterator[tuple[str, Any]]:
    """Functions, and methods of classes, of the front door and of its two modules."""
    for owner, names in ((gm, gm.__all__), (gm.hobbing, gm.hobbing.__all__), (gm.results, gm.results.__all__)):
        for name in names:
            value = getattr(owner, name)
            if inspect.isfunction(value):
                yield name, value
            elif inspect.isclass(value) and issubclass(value, Shown):
                for key, raw in vars(value).items():
                    call = getattr(raw, "fget", None) or getattr(raw, "func", None) or getattr(raw, "__func__", raw)
                    if not key.startswith("_") and inspect.isfunction(call):
                        yield f"{name}.{key}", call


def _imported(module: str) -> dict[str, tuple[str, str]]:
    """Names that a module imports, for type checkers too: from where, and as what."""
    tree = ast.parse(inspect.getsource(importlib.import_module(module)))
    return {
        alias.asname or alias.name: (node.module, alias.name)
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.module
        for alias in node.names
    }


def _returned() -> dict[str, type]:
    """The classes that public calls return, by their names."""
    found = {}
    for _, call in _public_calls():
        for name in _CLASS.findall(str(call.__annotations__.get("return", ""))):
            module = importlib.import_module(call.__module__)
            if hasattr(module, name):
                value = getattr(module, name)
            else:
                home, own = _imported(call.__module__).get(name, (None, name))
                value = getattr(importlib.import_module(home), own) if home else None
            if inspect.isclass(value) and value.__module__.startswith("gearmath") and not hasattr(value, "_repr_png_"):
                found[value.__name__] = value
    return found


def test_every_record_that_a_call_returns_is_shown() -> None:
    returned = _returned()
    assert {"Measurement", "ProgramTime", "Stock", "MillingReport", "MachinePath"} <= set(returned)  # it finds them
    assert sorted(name for name, kind in returned.items() if not issubclass(kind, Shown)) == []
    assert sorted(set(returned) - set(EXAMPLES)) == [], "records without an example here"


@pytest.mark.parametrize("name", EXAMPLES)
def test_a_record_is_a_line_a_table_and_plain_numbers(name: str) -> None:
    record = EXAMPLES[name]()
    assert type(record).__name__ == name
    line = repr(record)
    assert line.startswith(f"<{name}: ")
    assert line.endswith(">")
    assert len(line) <= 200
    assert "\n" not in line
    assert str(record) == line
    page = record._repr_html_()
    assert page.startswith("<table>")
    assert len(page) < 10_000
    assert not re.search(r"\bum\b", page)
    decimals = re.findall(r"-?\d+\.\d+", re.sub(r"<caption>.*?</caption>", "", page))
    assert all(len(value.replace(".", "").lstrip("-0")) <= 6 for value in decimals), decimals
    for call in ("to_dict", "as_dict"):
        if hasattr(record, call):
            json.dumps(getattr(record, call)())


def test_the_line_of_a_measurement_has_its_key_figures() -> None:
    found = _measured()
    largest = found.deviation[np.abs(found.deviation).argmax()] * 1000
    assert "points 90" in repr(found)
    assert f"largest deviation {largest:.4g} um" in repr(found)
    assert f"{largest:.6g}" in found._repr_html_()


def test_every_figure_is_one_that_jupyter_shows() -> None:
    assert _measured().plot()._repr_png_().startswith(b"\x89PNG")  # type: ignore[attr-defined]
    sources = [path.read_text("utf-8") for path in Path(inspect.getfile(gm)).parent.rglob("*.py")]
    drawing = [text for text in sources if re.search(r"\bFigure\(figsize", text)]
    assert len(drawing) > 5
    assert [text for text in drawing if "from gearmath.plot.figure import Figure" not in text] == []


def test_steps_per_count_of_a_job_are_those_that_its_rule_makes() -> None:
    job = gm.hobbing.plan("hobbing_plewes.toml", teeth=17)
    assert "steps per count 125/544" in repr(job)
    assert abs(job.simulate(edges=54_400).position - 54_400 * job.steps_per_count) <= 0.5


@pytest.mark.parametrize("module", [gm, gm.hobbing, gm.results], ids=lambda one: one.__name__)
def test_completion_offers_the_names_of_the_front_door_alone(module: Any) -> None:
    assert set(dir(module)) == set(module.__all__)


def test_a_contact_says_at_which_assembly() -> None:
    assert "V = 0.05, H = 0, J = 0 mm, shaft angle +0.1°" in EXAMPLES["Contact"]()._repr_html_()


def test_figures_as_csv(tmp_path: Path) -> None:
    evaluation = _measured().evaluate()
    with evaluation.to_csv(tmp_path / "e.csv").open() as file:
        rows = {row["figure"]: row["value"] for row in csv.DictReader(file)}
    assert float(rows["flanks.concave.rms_um"]) == evaluation.to_dict()["flanks"]["concave"]["rms_um"]
    uncertainty = _measured().uncertainty(1.0, draws=2000)
    with uncertainty.to_csv(tmp_path / "u.csv").open() as file:
        figures = list(csv.DictReader(file))
    assert [float(row["u"]) for row in figures] == [row["u"] for row in uncertainty.to_dict()["figures"]]

"""Whatever a function of the front door cannot be given, one sentence says so, before any work is done."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gearmath as gm
from gearmath.arguments.call import checked_call
from gearmath.arguments.kinds import Whole
from gearmath.control.store_run import StoredRun
from gearmath.front import contact, corrected, judged, probing

SET = "nasa_tp3096_12x36.toml"
#: The functions that get the ``options`` of a method, and what the method gives them itself.
INNER: dict[str, Callable[..., Any]] = {
    "GearSet.contact": contact.contact,
    "Measurement.compensate": corrected.compensate,
    "Measurement.uncertainty": judged.uncertainty,
    "Member.probing": probing.probing,
    "Machine.calibrating": probing.calibrating,
}
#: Records that users make; those of ``results``, and stores, come from calls.
MADE = {"GearSet", "Member", "Machine", "Program", "Measurement", "Job", "Quantity", "Expression"}
#: Methods of derivations, which know nothing of files or the command line: mathematics, checked by its own tests.
ITS_OWN = ("Expression.", "Kernel.", "Quantity.")
#: Arguments that can be anything of their kind: values of a statement of SQL.
ANYTHING = {
    "MeasurementStore.execute: values",
    "MeasurementStore.execute: sql",
    "MeasurementStore.transaction: failed",
    "Program: text",
}
#: What a sentence calls an argument that the work itself judges.
CALLED = {"wanted": "class", "hob_shift": "hob shift"}


#: Names of annotations that are one of a few words.
LITERALS = {"Literal", "Rule", "Pattern", "Phase", "By", "Bounds", "Hand", "FeedSense"}
#: What a call needs besides, that is none of its required arguments.
NEEDED = {"plan": {"teeth": 17}}


class Odd:
    """No argument can be this."""

    def __repr__(self) -> str:
        return "<odd>"


def _callables() -> Iterator[tuple[str, Callable[..., Any]]]:
    """All public functions, constructors of records and methods, by name."""
    for module, names in ((gm, gm.__all__), (gm.hobbing, gm.hobbing.__all__), (gm.results, gm.results.__all__)):
        for name in names:
            one = getattr(module, name)
            if not isinstance(one, type):
                if callable(one):
                    yield name, one
                continue
            if issubclass(one, Exception):
                continue
            if name in MADE:
                yield name, one
            for inner, method in vars(one).items():
                plain = method.__func__ if isinstance(method, staticmethod | classmethod) else method
                if not inner.startswith("_") and inspect.isfunction(plain):
                    yield f"{name}.{inner}", plain


CALLABLES = {name: one for name, one in _callables() if not name.startswith(ITS_OWN)}


def _parameters(name: str) -> dict[str, inspect.Parameter]:
    """The parameters that a caller gives, those of ``options`` too."""
    found = dict(inspect.signature(CALLABLES[name]).parameters)
    if any(one.kind is one.VAR_KEYWORD for one in found.values()):
        own = [one for one in found if one in ("self", "settings")]
        inner = dict([*inspect.signature(INNER[name]).parameters.items()][1:])  # the first is self
        found = {key: found[key] for key in own} | inner
    return {key: one for key, one in found.items() if key not in ("self", "cls")}


def _wrong(annotation: str, optional: bool) -> list[Any]:
    """Values that an argument of this annotation cannot be."""
    kinds = set(annotation.replace("|", " ").replace("[", " ").replace("]", " ").replace(",", " ").split())
    wrong: list[Any] = [Odd(), {"a": Odd()}]
    if not optional:
        wrong.append(None)
    if kinds & {"int", "float"} and not kinds & {"Mapping", "Sequence", "tuple"}:
        wrong += [True, math.nan, math.inf, -math.inf, [1]]
        wrong += [] if "str" in kinds else ["", "fast"]
        wrong += [10**400] if "float" in kinds else [0.5]
    if not kinds & {"str", *LITERALS}:
        wrong.append("file.toml")
    if kinds & {"bool"}:
        wrong += [0, 1, "no", ""]
    if kinds & {"str", "Path"}:
        wrong += ["", True] if "float" not in kinds else []
    if kinds & LITERALS:
        wrong += ["of-no-kind", "", 7]
    if kinds & {"Sequence", "tuple"} and "Kernel" not in annotation:
        wrong += [5, (Odd(),)]
    return wrong


#: Numbers that an argument must refuse, by its name.
LIMITS: dict[str, list[float]] = {
    **{key: [-1, 0] for key in ("draws", "columns", "workers", "repeat", "number", "run", "teeth", "starts", "edges")},
    **{key: [-1, 0] for key in ("rpm", "pin", "module", "face_width", "length", "feed", "tolerance", "spindle_rpm")},
    **{key: [-1, 0] for key in ("sigma_um", "root_limit", "step", "flank_tolerance")},
    **{key: [-1] for key in ("noise_um", "least", "seed", "start", "seconds", "run_up", "roughing_stock")},
    **{key: [-1] for key in ("finishing_stock", "wanted")},
    "margin": [-0.1, 0.5, 0.6],
    **{key: [-1e6, 1e6] for key in ("v", "h", "j", "shaft", "thickness", "shift", "hob_shift", "helix")},
    "bits": [-1, 8, 16],
    "scale": [-1, 0],
}


def _tries() -> Iterator[Any]:
    for name in CALLABLES:
        for key, one in _parameters(name).items():
            if f"{name}: {key}" in ANYTHING:
                continue
            wrong = [value for value in _wrong(str(one.annotation), one.default is None) if value != one.default]
            wrong += [] if str(one.annotation) == "bool" else LIMITS.get(key, [])
            yield pytest.param(name, key, wrong, id=f"{name}: {key}")


@pytest.fixture(scope="module")
def given(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """A right value of every argument that is needed, and the records whose methods are called."""
    pair = gm.load_set(SET)
    measured = pair.pinion.deviations()
    folder = tmp_path_factory.mktemp("given")
    depth = gm.Quantity("depth", "depth of a cut", "mm", "h")
    return {
        "GearSet": pair,
        "Member": pair.pinion,
        "Machine": gm.load_machine(),
        "Measurement": measured,
        "Job": gm.hobbing.plan("hobbing_plewes.toml", teeth=17),
        "Job.thread": gm.hobbing.plan("lathe_example.toml", pitch="1mm"),
        "path": folder / "file",
        "folder": folder / "folder",
        "pair": pair,
        "gear_set": pair,
        "measured": measured,
        "file": measured.file,
        "flank": "concave",
        "spec": pair.spec,
        "Member: spec": pair.pinion.spec,
        "evaluate_run: run": StoredRun(Odd(), 1, Odd()),
        "Job: machine": gm.hobbing.load_hobber(),
        "Machine: spec": gm.load_machine().spec,
        "member": pair.pinion,
        "name": "pinion",
        "points": folder / "points",
        "data": SET,
        "what": gm.kernel("tool_pose"),
        "paths": {("concave", 0): folder / "points"},
        "machine": "hobbing_plewes.toml",
        "Program: machine": gm.load_machine(),
        "teeth": 17,
        "wanted": 7,
        "module": 1.0,
        "expression": None,
        "text": "",
        "run": 1,
        "start": None,
        "say": print,
        "sql": "SELECT 1",
        "description": "a depth",
        "unit": "mm",
        "latex": "h",
        "inputs": (depth,),
        "outputs": ((gm.Quantity("twice", "twice as deep", "mm", "b"), 2 * depth.symbol),),
        "settings": "few",
    }


def _call(name: str, given: dict[str, Any], options: dict[str, Any]) -> object:
    function, owner = CALLABLES[name], name.partition(".")[0]
    signature = inspect.signature(function).parameters
    if any(one.kind is one.VAR_KEYWORD for one in signature.values()):
        function, first = INNER[name], given[owner]
        signature = inspect.signature(function).parameters
        options = {next(iter(signature)): first} | options
    values = {key: value for key, value in NEEDED.get(name, {}).items() if key not in options} | options
    for key, one in signature.items():
        if one.default is one.empty and one.kind not in (one.VAR_POSITIONAL, one.VAR_KEYWORD) and key not in values:
            own = given.get(name, given.get(owner, Odd())) if key in ("self", "cls") else None
            values[key] = own or given.get(f"{name}: {key}", given.get(key))
    positional = []
    for key, one in signature.items():
        if one.kind is one.VAR_POSITIONAL and key in values:  # what stands before it must be given by position, too
            before = list(signature)[: list(signature).index(key)]
            positional = [values.pop(name) for name in (*before, key)]
    return function(*positional, **values)


@pytest.mark.parametrize(("name", "key", "wrong"), [*_tries()])
def test_what_an_argument_cannot_be_is_refused_in_a_sentence_that_names_it(
    name: str, key: str, wrong: list[Any], given: dict[str, Any], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    for value in wrong:
        with pytest.raises(gm.InputError) as caught:
            _call(name, given, {key: value})
        said = str(caught.value)
        assert "\n" not in said
        assert key in said or CALLED.get(key, key) in said, (value, said)
        inner = value[0] if isinstance(value, tuple) else next(iter(value)) if isinstance(value, dict) else value
        told = {str(inner)[:50], repr(inner)[:50], f"{inner:g}" if isinstance(inner, float) else ""} - {""}
        assert value == "" or any(text in said for text in told), (value, said)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", [name for name in CALLABLES if _parameters(name)])
def test_an_argument_that_there_is_not_is_refused_with_those_there_are(name: str, given: dict[str, Any]) -> None:
    if name in ("Quantity", "Expression"):  # classes of derivations, by Python's own rules
        return
    with pytest.raises(gm.InputError, match="no_such_key = 1: is no argument") as caught:
        _call(name, given, {"no_such_key": 1})
    assert isinstance(caught.value, TypeError)
    there = [key for key in _parameters(name) if key not in ("no_such_key",)]
    assert all(key in str(caught.value) for key in there)


def test_every_public_method_with_options_is_known() -> None:
    open_ones = {
        name
        for name, one in CALLABLES.items()
        if any(key.kind is key.VAR_KEYWORD for key in inspect.signature(one).parameters.values())
    }
    assert open_ones == set(INNER)


def test_an_argument_without_a_kind_is_refused_where_its_function_is_written() -> None:
    with pytest.raises(TypeError, match="nobody_knows: no kind of argument"):

        @checked_call
        def verb(path: str, nobody_knows: int) -> None:
            pass

    @checked_call(nobody_knows=Whole(1))
    def other(nobody_knows: int) -> int:
        return nobody_knows

    assert other(1) == 1
    with pytest.raises(gm.InputError, match="nobody_knows = 0: must be a whole number, at least 1"):
        other(0)


def test_a_file_will_do_wherever_its_record_does(tmp_path: Path) -> None:
    pair = gm.load_set(SET)
    off = pair.pinion.with_settings(concave={"machine_root_angle": 0.02})
    files = [one.deviations((3, 3)).to_csv(tmp_path / f"{one.name}.csv") for one in (off, pair.gear)]
    mine, mates = (gm.load_measurement(file, SET) for file in files)
    found, same = (mine.compensate(mate=mate) for mate in (mates, tmp_path / "gear.csv"))
    assert found.changes == same.changes
    drive = {"sides": ("drive",)}
    assert pair.contact(mine, **drive).to_dict(15) == pair.contact(tmp_path / "pinion.csv", **drive).to_dict(15)
    text = pair.pinion.probing(topography=(), registration=False).text
    files = {"machine": "vertical_5axis.toml", "probe": "probe.toml"}
    assert pair.pinion.probing(topography=(), registration=False, **files).text == text
    np.testing.assert_array_equal(pair.pinion.flank("concave", "3x4").point, pair.pinion.flank("concave", (3, 4)).point)


def test_a_measurement_of_another_set_or_of_the_same_member_is_refused(tmp_path: Path) -> None:
    measured = gm.load_set(SET).pinion.deviations((3, 3))
    file = measured.to_csv(tmp_path / "pinion.csv")
    with pytest.raises(gm.InputError, match=r"pinion.csv: member_teeth = 12: the pinion of the set has 7"):
        gm.load_measurement(file, "spiral_7x43.toml")
    with pytest.raises(gm.InputError, match=r"member = 'pinion': must be the member itself, such as .*\.pinion, or"):
        gm.load_measurement(file, "pinion")
    with pytest.raises(gm.InputError, match="mate: is a measurement of the pinion too"):
        measured.compensate(mate=measured)
    with pytest.raises(gm.InputError, match="settings = 'fewest': must be one of few, standard, all, radial_distance"):
        measured.compensate("fewest")


def test_no_space_is_cut_or_probed_twice() -> None:
    pinion, machine = gm.load_set(SET).pinion, gm.load_machine("vertical_5axis.toml")
    with pytest.raises(gm.InputError, match=r"^spaces: 1 stands there twice$"):
        pinion.program(machine, spaces=[1, 0, 1])
    with pytest.raises(gm.InputError, match=r"^topography: 1 stands there twice$"):
        pinion.probing(machine, "probe.toml", topography=[1, 0, 1])

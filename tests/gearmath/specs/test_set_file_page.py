"""docs/set_file.md, machine_files.md, design.md say what the models of the files take: keys, units, ranges, defaults.

Where a model changes, the failing test prints the rows as they must read; what a key means is written by hand.
"""

from __future__ import annotations

import json
import re
from fractions import Fraction
from pathlib import Path
from types import UnionType
from typing import Any, Literal, Union, get_args, get_origin

import annotated_types as at
import pytest
from pydantic import AfterValidator, BaseModel
from pydantic.fields import FieldInfo

from gearmath.specs import (
    bevel_set,
    blank_data,
    board,
    calibration,
    control,
    design,
    drive,
    drivers,
    hobbing,
    measurement,
    milling_machine,
    simulated_machine,
)
from gearmath.specs.sheet import unit_of
from gearmath.specs.toml import bundled, parse

PAGE = (Path(__file__).parents[3] / "docs" / "set_file.md").read_text("utf-8")
#: The heading of each table of the page, and the model that it is of.
TABLES: dict[str, type[BaseModel]] = {
    "Gear set": bevel_set.BevelSet,
    "`[pinion]` and `[gear]`": bevel_set.Member,
    "`[pinion.blank]` and `[gear.blank]`": bevel_set.Blank,
    "`[pinion.concave]`, `[pinion.convex]`, `[gear.concave]`, `[gear.convex]`": bevel_set.Flank,
    "`[pinion.concave.motion]` and the others": bevel_set.Motion,
    "Design data of a blank": blank_data.BlankData,
    "`[cutter]`": blank_data.BlankCutter,
    "`[taper]`": blank_data.Taper,
    "`[data_type_1]`": blank_data.DataType1,
    "`[data_type_2]`": blank_data.DataType2,
    "`[backlash]`": blank_data.Backlash,
}
#: Keys of a file that no model has: what stands in their place there.
BESIDES = {bevel_set.Flank: {bevel_set.CRADLE_PER_WORK: ("", "at least 0.02, below 10", "or `ratio_of_roll`")}}


def limits(field: FieldInfo) -> str:
    """The range of a number, the words that a text may be, or how many numbers there may be."""
    found = [*field.metadata, *parts(field.annotation)]
    words = next((part for part in found if get_origin(part) is Literal), None)
    if get_origin(field.annotation) is Literal or words is not None:
        return ", ".join(f"`{value!r}`".replace("'", '"') for value in get_args(words or field.annotation))
    if any(isinstance(part, AfterValidator) and part.func is control._known_kind for part in found):
        return ", ".join(f'`"{kind}"`' for kind in control.CONTROLS)
    bounds = {
        at.Gt: ("above {}", "gt"),
        at.Ge: ("at least {}", "ge"),
        at.Lt: ("below {}", "lt"),
        at.Le: ("up to {}", "le"),
        at.MaxLen: ("{} characters at most" if field.annotation is str else "{} numbers at most", "max_length"),
    }
    said = []
    for kind, (text, name) in bounds.items():
        values = [getattr(part, name) for part in found if isinstance(part, kind)]
        if values:
            said.append(text.format(f"{min(values):g}"))
    return ", ".join(said)


def parts(annotation: Any) -> list[Any]:
    """An annotation and all it is made of."""
    inside = () if get_origin(annotation) is Literal else get_args(annotation)
    inner = [part for one in inside for part in parts(one)]
    fields = [item for item in inner if isinstance(item, FieldInfo)]
    return [annotation, *inner, *(mark for field in fields for mark in field.metadata)]


def default(field: FieldInfo) -> str:
    if field.is_required():
        return "required"
    if isinstance(field.json_schema_extra, dict):  # one that nobody is given
        return str(field.json_schema_extra["default"])
    union = get_origin(field.annotation) in (Union, UnionType) and type(None) in get_args(field.annotation)
    value = field.default
    return "" if union or value == () or isinstance(value, BaseModel) else f"`{toml(value)}`"


def toml(value: Any) -> str:
    """A value as a file has it: TOML writes truth, text and lists as JSON does."""
    return json.dumps(value, ensure_ascii=False) if isinstance(value, bool | str | tuple | dict) else repr(value)


def is_table(annotation: Any) -> bool:
    return any(isinstance(part, type) and issubclass(part, BaseModel) for part in parts(annotation))


def rows(model: type[BaseModel]) -> dict[str, tuple[str, str, str]]:
    """Unit, range and default of every key that is no table."""
    found = {}
    for key, field in model.model_fields.items():
        if not is_table(field.annotation):
            unit = unit_of(model, key)  # type: ignore[arg-type]
            found[key] = (unit or "", limits(field), default(field))
    return found | BESIDES.get(model, {})


def printed(heading: str, page: str = PAGE) -> dict[str, tuple[str, str, str]]:
    """The rows under a heading of a page."""
    begin = page.index(f" {heading}\n")
    section = re.split(r"\n#+ ", page[begin:], maxsplit=1)[0]
    lines = [line for line in section.splitlines() if line.startswith("| `")]
    cells = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in lines]
    assert all(len(row) == 5 and row[4] for row in cells), "every row has key, unit, range, default and meaning"
    return {row[0].strip("`"): (row[1], row[2], row[3]) for row in cells}


@pytest.mark.parametrize("heading", TABLES)
def test_page_has_every_key_with_unit_range_and_default(heading):
    assert printed(heading) == rows(TABLES[heading])


def test_page_is_of_every_table_of_the_files():
    """Nothing is nested anywhere that the page does not tell of; a design has the keys of its flank's settings."""
    told, seen = set(TABLES.values()) | {bevel_set.Design}, [bevel_set.BevelSet, blank_data.BlankData]
    for model in seen:
        for field in model.model_fields.values():
            for part in parts(field.annotation):
                if isinstance(part, type) and issubclass(part, BaseModel) and part not in seen:
                    seen.append(part)
    assert set(seen) == told


def test_example_of_the_page_is_a_set():
    """The example in inches, with minutes and seconds, cradle by work and a crossing point: one member alone."""
    (example,) = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    made = parse(example, bevel_set.BevelSet, "example")
    assert list(made.members) == ["gear"]
    ours = parse(bundled("nasa_tp3096_12x36.toml").read_text("utf-8"), bevel_set.BevelSet, "set").member("gear")
    for flank in bevel_set.FLANKS:
        vector = made.member("gear").flank(flank).vector
        assert vector == pytest.approx(ours.flank(flank).vector, abs=2e-6)


DESIGN_PAGE = (Path(__file__).parents[3] / "docs" / "design.md").read_text("utf-8")
DESIGN_TABLES: dict[str, type[BaseModel]] = {
    "Design data": design.DesignData,
    "`[cutter]`": design.DesignCutter,
    "`[pinion]`": design.PinionMethod,
    "`[gear]`": design.GearMethod,
    "`[drive]` and `[coast]`": design.ContactRequest,
    "`[shop]`": design.Shop,
}


@pytest.mark.parametrize("heading", DESIGN_TABLES)
def test_design_page_has_every_key_with_unit_range_and_default(heading):
    assert printed(heading, DESIGN_PAGE) == rows(DESIGN_TABLES[heading])


def test_example_of_the_design_page_is_a_design():
    (example,) = re.findall(r"```toml\n(.*?)```", DESIGN_PAGE, re.DOTALL)
    assert parse(example, design.DesignData, "example").pinion_teeth == 12


MACHINE_PAGE = (Path(__file__).parents[3] / "docs" / "machine_files.md").read_text("utf-8")
MACHINE_FILES: dict[str, type[BaseModel]] = {
    "Machine": milling_machine.MillingMachine,
    "Errors of a shop": simulated_machine.SimulatedMachine,
    "Probe": calibration.Calibration,
    "Measurement": measurement.MeasuringModel,
}
MACHINE_TABLES: dict[str, type[BaseModel]] = MACHINE_FILES | {
    "`[axes.X]`, `[axes.Y]`, `[axes.Z]`, `[axes.B]`": milling_machine.TravelAxis,
    "`[axes.A]`, `[axes.C]`": milling_machine.TurningAxis,
    "`[control]`": milling_machine.ControlSettings,
    "`[pinion]` and `[gear]`": simulated_machine.SettingErrors,
    "`[work_axis]`": simulated_machine.WorkAxis,
    "`[axes]`": simulated_machine.AxisErrors,
    "`[[axes.A_harmonics]]`": simulated_machine.Harmonic,
    "`[[axes.screws]]`": simulated_machine.Screw,
    "`[mounting]`, `[measuring.pinion]`, `[measuring.gear]`": simulated_machine.Mounting,
    "`[measuring.drift]`": simulated_machine.Drift,
    "`[cutter_head]`": simulated_machine.CutterHead,
    "`[fixture]`": simulated_machine.Fixture,
    "`[probe]`": simulated_machine.Probe,
    "`[ring]`": calibration.Ring,
    "`[ring.face]`": calibration.Face,
    "`[sphere]`": calibration.Sphere,
    "`[work_sphere]`": calibration.WorkSphere,
}
#: Tables that hold only tables.
INSIDE = {milling_machine.Axes, simulated_machine.SimulatedMeasuring}


def machine_section(heading):
    begin = re.search(rf"^#+ {re.escape(heading)}\n", MACHINE_PAGE, re.MULTILINE).end()
    return re.split(r"^#", MACHINE_PAGE[begin:], maxsplit=1, flags=re.MULTILINE)[0]


@pytest.mark.parametrize("heading", MACHINE_TABLES)
def test_machine_page_has_every_key_with_range_and_default(heading):
    cells = [line.strip("|\n").split("|") for line in machine_section(heading).splitlines() if line.startswith("| `")]
    told = {key.strip(" `"): (limits.strip(), default.strip()) for key, _, limits, default, _ in cells}
    assert told == {key: (limits, default) for key, (_, limits, default) in rows(MACHINE_TABLES[heading]).items()}
    assert all(meaning.strip() for *_, meaning in cells)


def test_machine_page_is_of_every_table_of_the_files():
    seen = list(MACHINE_FILES.values())
    for model in seen:
        for field in model.model_fields.values():
            for part in parts(field.annotation):
                if isinstance(part, type) and issubclass(part, BaseModel) and part not in seen:
                    seen.append(part)
    assert set(seen) == set(MACHINE_TABLES.values()) | INSIDE
    assert all(is_table(field.annotation) for model in INSIDE for field in model.model_fields.values())


@pytest.mark.parametrize("heading", MACHINE_FILES)
def test_examples_of_the_machine_page_are_read(heading):
    (example,) = re.findall(r"```toml\n(.*?)```", machine_section(heading), re.DOTALL)
    parse(example, MACHINE_FILES[heading], "example")


GEARBOX_PAGE = (Path(__file__).parents[3] / "docs" / "gearbox_file.md").read_text("utf-8")
GEARBOX_TABLES: dict[str, type[BaseModel]] = {
    "The file of a gearbox machine": hobbing.HobbingMachine,
    "`[encoder]`": drive.Encoder,
    "`[table]`": drive.Table,
    "`[lead_screw]`": drive.LeadScrew,
    "`[feed]`": drive.Feed,
    "`[driver]`": drivers.Driver,
    "`[pins]`": board.Pins,
    "`[display]`": board.Display,
    "`[limits]`": hobbing.Limits,
    "`[[hobs]]`": hobbing.Hob,
}


@pytest.mark.parametrize("heading", GEARBOX_TABLES)
def test_gearbox_page_has_every_key_with_range_and_default(heading):
    """Of a hob what the gearbox itself asks for; the page of virtual hobbing has the rest."""
    section = GEARBOX_PAGE.split(f"# {heading}\n", 1)[1].split("\n## ", 1)[0]
    cells = [line.strip("|\n").split("|") for line in section.splitlines() if line.startswith("| `")]
    told = {key.strip(" `"): (limits.strip(), default.strip()) for key, _, limits, default, _ in cells}
    wanted = {
        key: (limits, re.sub(r"Fraction\((\d+), 1\)", r"\1", default))
        for key, (_, limits, default) in rows(GEARBOX_TABLES[heading]).items()
    }
    if heading == "`[[hobs]]`":
        elsewhere = Path(__file__).parents[3].joinpath("docs", "virtual_hobbing.md").read_text("utf-8")
        assert all(f"| `{key}` |" in elsewhere for key in wanted.keys() - told.keys())
        wanted = {key: wanted[key] for key in told}
    assert told == wanted


def test_gearbox_page_names_every_driver():
    section = GEARBOX_PAGE.split("## `[driver]`\n", 1)[1].split("\n| key", 1)[0]
    assert re.findall(r"`(\w+)`", section) == list(drivers.DRIVERS)


def test_example_of_the_gearbox_page_is_a_machine_with_other_pulleys():
    (example,) = re.findall(r"```toml\n(.*?)```", GEARBOX_PAGE, re.DOTALL)
    machine = parse(example, hobbing.HobbingMachine, "example")
    assert machine.encoder_counts == Fraction(40_000, 9)
    assert machine.motor_steps == Fraction(200 * 8 * 90 * 120, 127)

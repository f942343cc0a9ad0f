"""A set as REXS 2.0.0 (.rexs, XML), and back: bevel stage, gears, flanks, and for each flank tool and machine settings.

Names and units are in :mod:`gearmath.exchange.rexs_names`. What REXS has no name for stands in attributes of our own,
so that a file that was written here is read back without loss.
"""

from __future__ import annotations

import datetime
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from gearmath.errors import InputError
from gearmath.exchange.rexs_names import GEAR, MACHINE, OWN, STAGE, TOOL, VERSION, WORDS, right_flank
from gearmath.files import read_text, write_text
from gearmath.specs.bevel_set import ADVANCE, BEYOND, FLANKS, MEMBERS, BevelSet
from gearmath.specs.toml import checked
from gearmath.version import __version__

_Names = Mapping[str, tuple[str, str]]


def write_rexs(path: Path, pair: BevelSet) -> int:
    """Write a set of both members; how many components it became. Raises InputError for a set of one member."""
    values = _plain(pair.model_dump(exclude_defaults=True))
    for name in MEMBERS:
        beyond = pair.member(name).blank.pitch_apex_beyond_crossing_point  # refused by name where there is none
        _shift(values[name], -beyond)
    model = ET.Element(
        "model",
        {
            "version": VERSION,
            "applicationId": "gearmath",
            "applicationVersion": __version__,
            "date": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        },
    )
    writer = _Writer(ET.SubElement(model, "relations"), ET.SubElement(model, "components"))
    stage = writer.component("bevel_stage", pair.title, STAGE, _without(values, *MEMBERS))
    gears = [writer.gear(name, values[name]) for name in MEMBERS]
    writer.relation("stage", {"stage": stage, "gear_1": gears[0], "gear_2": gears[1]})
    ET.indent(model)
    write_text(path, ET.tostring(model, encoding="unicode", xml_declaration=False) + "\n")
    return writer.count


class _Writer:
    """Components and relations with their numbers."""

    def __init__(self, relations: ET.Element, components: ET.Element) -> None:
        self._relations, self._components = relations, components
        self.count = 0

    def gear(self, name: str, values: dict[str, Any]) -> int:
        gear = self.component("bevel_gear", name, GEAR, _without(values, *FLANKS))
        flanks = {}
        for flank in FLANKS:
            own = values[flank]
            flanks[flank] = self.component("bevel_gear_flank", f"{name} {flank}", {}, {"flank": flank})
            tool_keys = {key: value for key, value in own.items() if key in TOOL}
            tool = self.component("bevel_gear_tool", f"{name} {flank}", TOOL, tool_keys)
            rest = _without(own, *TOOL)
            settings = self.component("bevel_gear_manufacturing_settings", f"{name} {flank}", MACHINE, rest)
            roles = {"workpiece": flanks[flank], "tool": tool, "manufacturing_settings": settings}
            self.relation("manufacturing_step", roles, 1)
        right = right_flank(values["hand"])
        left = FLANKS[1 - FLANKS.index(right)]
        self.relation("flank", {"gear": gear, "left": flanks[left], "right": flanks[right]})
        return gear

    def component(self, kind: str, title: str, names: _Names, values: Mapping[str, Any]) -> int:
        self.count += 1
        element = ET.SubElement(self._components, "component", {"id": str(self.count), "type": kind, "name": title})
        for key, value in _leaves(values):
            attribute, unit = names.get(key, (OWN + key, "none"))
            item = ET.SubElement(element, "attribute", {"id": attribute, "unit": unit})
            if isinstance(value, list):
                array = ET.SubElement(item, "array")
                for one in value:
                    ET.SubElement(array, "c").text = _text(one)
            else:
                item.text = _text(value)
        return self.count

    def relation(self, kind: str, roles: Mapping[str, int], order: int | None = None) -> None:
        number = {} if order is None else {"order": str(order)}
        relation = ET.SubElement(
            self._relations, "relation", {"id": str(len(self._relations) + 1), "type": kind, **number}
        )
        for role, which in roles.items():
            ET.SubElement(relation, "ref", {"id": str(which), "role": role})


def read_rexs(path: Path) -> tuple[BevelSet, tuple[str, ...]]:
    """The set of the one bevel stage of a file, and what of its components was left aside.

    Raises InputError naming file, component, attribute, value and what is wrong.
    """
    model = _model(path)
    reader = _Reader(path, model)
    stages = reader.of_type("bevel_stage")
    if len(stages) != 1:
        raise InputError(f"{path}: has {len(stages)} components of type bevel_stage, must have one")
    (number,) = stages
    values = reader.values(number, STAGE)
    values.setdefault("title", model.find(f"./components/component[@id='{number}']").get("name") or path.stem)  # type: ignore[union-attr]
    values.setdefault("source", f"REXS {model.get('version')} of {model.get('applicationId')}")
    gears = reader.relation("stage", "stage", number)
    for name, role in zip(MEMBERS, ("gear_1", "gear_2"), strict=True):
        values[name] = reader.gear(name, gears[role])
        _shift(values[name], float(values[name].get("blank", {}).get(BEYOND, 0.0)))
    return checked(values, BevelSet, str(path)), tuple(reader.left_aside)


class _Reader:
    """Components by number, relations by what they join."""

    def __init__(self, path: Path, model: ET.Element) -> None:
        self._path, self._model = path, model
        self._components = {item.get("id", ""): item for item in model.iterfind("./components/component")}
        self.left_aside: list[str] = []

    def of_type(self, kind: str) -> list[str]:
        return [number for number, item in self._components.items() if item.get("type") == kind]

    def relation(self, kind: str, role: str, number: str) -> dict[str, str]:
        """Component by role of the one relation of a kind that has a component in a role."""
        found = []
        for relation in self._model.iterfind("./relations/relation"):
            roles = {ref.get("role", ""): ref.get("id", "") for ref in relation.iterfind("ref")}
            if relation.get("type") == kind and roles.get(role) == number:
                found.append(roles)
        if len(found) != 1:
            raise InputError(
                f"{self._path}: component {number} is {role} of {len(found)} relations of type {kind}, must be of one"
            )
        missing = {
            "stage": ("gear_1", "gear_2"),
            "flank": ("left", "right"),
            "manufacturing_step": ("tool", "manufacturing_settings"),
        }[kind]
        for other in missing:
            if found[0].get(other) not in self._components:
                raise InputError(f"{self._path}: the relation {kind} of component {number} has no {other}")
        return found[0]

    def gear(self, name: str, number: str) -> dict[str, Any]:
        values = self.values(number, GEAR)
        roles = self.relation("flank", "gear", number)
        right = right_flank(str(values.get("hand")))
        for role, flank in (("right", right), ("left", FLANKS[1 - FLANKS.index(right)])):
            said = self.values(roles[role], {}).get("flank", flank)
            if said != flank:
                raise InputError(f"{self._path}: {name}: its {role} flank is said to be {said}, but must be {flank}")
            step = self.relation("manufacturing_step", "workpiece", roles[role])
            values[flank] = self.values(step["manufacturing_settings"], MACHINE) | self.values(step["tool"], TOOL)
        return values

    def values(self, number: str, names: _Names) -> dict[str, Any]:
        """The values of a component by key of the set, nested."""
        keys = {attribute: (key, unit) for key, (attribute, unit) in names.items()}
        values: dict[str, Any] = {}
        component = self._components[number]
        for item in component.iterfind("attribute"):
            attribute = item.get("id", "")
            where = f"{self._path}: {component.get('type')} {number}, {attribute}"
            if attribute.startswith(OWN):
                key, unit = attribute[len(OWN) :], item.get("unit", "none")
            elif attribute in keys:
                key, unit = keys[attribute]
            elif attribute == "hypoid_offset" and float(item.text or 0) != 0:
                raise InputError(f"{where} = {item.text}: must be 0: pairs with an offset are not read")
            else:
                self.left_aside.append(f"{component.get('type')} {number}: {attribute}")
                continue
            if item.get("unit", unit) != unit:
                raise InputError(f"{where}: unit = {item.get('unit')!r}: must be {unit}")
            _put(values, key.split("."), _value(key, item, where))
        return values


def _model(path: Path) -> ET.Element:
    text = read_text(path)
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise InputError(f"{path}: has a document type or entities, which REXS files have not")
    try:
        model = ET.fromstring(text)
    except ET.ParseError as error:
        raise InputError(f"{path}: is no XML: {error}") from error
    if model.tag != "model" or model.find("components") is None:
        raise InputError(f"{path}: is no REXS file: it must have the element model with components")
    version = model.get("version", "")
    if version.split(".")[0] != VERSION.split(".")[0]:
        raise InputError(f"{path}: version = {version!r}: must be 2.0.0, or another of version 2")
    return model


def _value(key: str, item: ET.Element, where: str) -> Any:
    array = item.find("array")
    if array is not None:
        return [_number(cell.text or "", where) for cell in array.iterfind("c")]
    text = (item.text or "").strip()
    return text if key.split(".")[-1] in WORDS else _number(text, where, words=key not in GEAR)


def _number(text: str, where: str, words: bool = False) -> Any:
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    if words and text:
        return text
    raise InputError(f"{where} = {text!r}: must be a number")


def _leaves(values: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    """Keys with dots, and their values, of nested tables."""
    for key, value in values.items():
        if isinstance(value, Mapping):
            yield from _leaves(value, f"{before}{key}.")
        else:
            yield before + key, value


def _put(values: dict[str, Any], path: list[str], value: Any) -> None:
    for key in path[:-1]:
        values = values.setdefault(key, {})
    values[path[-1]] = value


def _shift(member: dict[str, Any], by: float) -> None:
    """Settings count from the pitch apex, files from the crossing point."""
    for table in (member[flank] for flank in FLANKS):
        for settings in (table, *([table["design"]] if "design" in table else [])):
            if by and isinstance(settings.get(ADVANCE), float | int):
                settings[ADVANCE] += by


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(one) for key, one in value.items()}
    return list(value) if isinstance(value, tuple) else value


def _without(values: Mapping[str, Any], *keys: str) -> dict[str, Any]:
    return {key: value for key, value in values.items() if key not in keys}


def _text(value: Any) -> str:
    return value if isinstance(value, str) else repr(value)

"""The summary sheet of a gear set and how its cutters are built: in mm and degrees, in inches and minutes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from derivations import notation
from gearmath.bevel.ridge import point_width
from gearmath.bevel.tooth import ToothSpace, mean_backlash, tooth_space
from gearmath.machine.bodies.blades import blade_phase
from gearmath.page import Page
from gearmath.setup_sheet.dimensions import Dimension, dimensions
from gearmath.specs.bevel_set import (
    ADVANCE,
    FLANKS,
    MACHINE_SETTINGS,
    MEMBERS,
    BevelSet,
    Flank,
    Member,
    settings_sha256,
)
from gearmath.specs.cut import ANGULAR, RATIO, Motion
from gearmath.specs.sheet import angle_text, unit_of
from gearmath.version import __version__

#: What summary sheets call the settings, with the symbol; those of the list stand under their own name.
_TRADE = {
    "radial_distance": "radial distance (cutter radial), S",
    "cradle_angle": "cradle angle, q",
    "cutter_tilt": "tilt angle, i",
    "cutter_swivel": "swivel angle, j",
    "blank_offset": "blank offset (work offset), E_m",
    "sliding_base": "sliding base, X_b",
    ADVANCE: "machine center to crossing point, X_C",
    "machine_root_angle": "machine root angle",
    RATIO: "ratio of roll, work by cradle",
    "work_rotation_offset": "work rotation offset",
}
#: What a positive value does, by chapters 1 and 2.
_SENSE = {component.name: component.description for component in notation.settings.components}
_ROLL = ("2C", "6D", "24E", "120F")
_ROLL_SENSE = "derivative of -(work rotation / ratio of roll) by the cradle rotation"
_INCH = 25.4
_BLADES = {"concave": "outside blade", "convex": "inside blade"}


@dataclass(frozen=True)
class SheetUnit:
    """How a sheet writes numbers: its length in mm, digits of it, and whether angles have minutes and seconds."""

    name: str
    mm: float
    digits: int
    minutes: bool

    def length(self, value: float) -> str:
        """A length [mm]."""
        return f"{value / self.mm + 0.0:.{self.digits}f}"

    def angle(self, value: float) -> str:
        """An angle [degree], to a tenth of a second where it is written in minutes."""
        return angle_text(round(value * 36000) / 36000, "°") if self.minutes else f"{value + 0.0:.5f}"


UNITS = (SheetUnit("mm and degrees", 1.0, 4, False), SheetUnit("inches and degrees, minutes, seconds", _INCH, 5, True))


def summary_sheet(pair: BevelSet) -> str:
    """The page of a set as HTML: blank, machine settings and cutters of its members, each in both units."""
    page = Page(f"Summary sheet: {pair.title}")
    page.paragraph(pair.source)
    page.paragraph(f"Shaft angle {pair.shaft_angle:g} degrees. Made by gearmath {__version__}.")
    if len(pair.members) == len(MEMBERS):
        backlash = mean_backlash(*(pair.member(name) for name in MEMBERS))
        page.paragraph(
            f"Transverse backlash of the pair at the mean point: {backlash:.3f} mm, {backlash / _INCH:.4f} in."
        )
    for k, (name, member) in enumerate(pair.members.items()):
        space = tooth_space(member)
        page.heading(name.capitalize(), new_sheet=k > 0)
        method = (member.process, member.generation, member.cutting)
        page.head(
            [name],
            [
                ("Teeth, hand", [f"{member.teeth}, {member.hand}"]),
                ("Cut", [", ".join(word.replace("_", " ") for word in method)]),
                ("Settings", [f"sha256 {settings_sha256(member)[:16]}"]),
            ],
        )
        if any(member.flank(flank).design is not None for flank in FLANKS):
            page.paragraph("The settings are corrected ones; those of the nominal flanks stand in the set file.")
        for unit in UNITS:
            page.table(f"Blank, from the pitch apex; {unit.name}", ["figure", "value"], list(_blank(member, unit)))
        found = dimensions(member)
        for unit in UNITS:
            page.table(f"Dimensions of the teeth; {unit.name}", ["figure", "value"], list(_dimensions(found, unit)))
        for unit in UNITS:
            rows = [[label, *_both(values), sense] for label, values, sense in _settings(member, unit)]
            page.table(f"Machine settings; {unit.name}", ["setting", *FLANKS, "positive"], rows)
        page.subheading(f"Cutters of the {name}")
        for unit in UNITS:
            page.table(
                f"Cutter build; {unit.name}",
                ["", *(f"{_BLADES[flank]}, {flank} flank" for flank in FLANKS)],
                [[label, *_both(values)] for label, values in _cutter(member, space, unit)],
            )
        chosen = [flank for flank in FLANKS if _chosen_width(member, flank)]
        if chosen:
            page.paragraph(
                f"The set states no point width for the {' and '.join(_BLADES[flank] for flank in chosen)}: the width "
                "above is the one that gearmath nc cut takes, from the slot of the root."
            )
    return page.html


def _both(values: dict[str, str]) -> list[str]:
    return [values[flank] for flank in FLANKS]


def _blank(member: Member, unit: SheetUnit) -> Iterator[list[str]]:
    """Every figure of the blank that is stated."""
    for key in type(member.blank).model_fields:
        value = getattr(member.blank, key)
        is_angle = unit_of(type(member.blank), key) == "degree"
        yield [key.replace("_", " "), unit.angle(value) if is_angle else unit.length(value)]


def _dimensions(found: list[Dimension], unit: SheetUnit) -> Iterator[list[str]]:
    for one in found:
        yield [one.label, unit.length(one.value) if one.kind == "length" else unit.angle(math.degrees(one.value))]


def _chosen_width(member: Member, flank: str) -> bool:
    """Whether the point width of a cutter for one flank is left to the planner."""
    return member.cutting == "fixed_setting" and member.flank(flank).blade_point_width is None


def _settings(member: Member, unit: SheetUnit) -> Iterator[tuple[str, dict[str, str], str]]:
    """Machine settings of both flanks by name, and what a positive value is; then what moves with the cradle."""
    for name in MACHINE_SETTINGS:
        if name == RATIO and member.generation == "formate":
            continue
        yield _TRADE[name], {flank: _setting(member, member.flank(flank), name, unit) for flank in FLANKS}, _SENSE[name]
        if name == RATIO:
            inverse = {flank: f"{1 / member.flank(flank).ratio_of_roll:.7f}" for flank in FLANKS}
            yield "ratio of roll, cradle by work", inverse, "cradle rotation per work rotation"
    for k, label in enumerate(_ROLL):
        values = {flank: member.flank(flank).motion.roll[k] for flank in FLANKS}
        if any(values.values()):
            yield f"modified roll, {label}", {flank: f"{value:.6f}" for flank, value in values.items()}, _ROLL_SENSE
    for name in MACHINE_SETTINGS:
        given = {flank: getattr(member.flank(flank).motion, name) for flank in FLANKS}
        for power in range(max(map(len, given.values()))):
            values = {flank: row[power] if power < len(row) else 0.0 for flank, row in given.items()}
            if any(values.values()):
                shown = {flank: _coefficient(name, value, unit) for flank, value in values.items()}
                per = f"{'degree' if name in ANGULAR else 'length'} per rad^{power + 1} of cradle rotation"
                yield f"{_TRADE[name]}: order {power + 1}", shown, per


def _coefficient(name: str, value: float, unit: SheetUnit) -> str:
    """A coefficient of a motion: angles in decimal degrees, whatever the sheet."""
    if unit_of(Motion, name) == "mm":
        return f"{value / unit.mm:.{unit.digits + 2}f}"
    return f"{value:.6f}"


def _setting(member: Member, spec: Flank, name: str, unit: SheetUnit) -> str:
    value = getattr(spec, name)
    if name in ANGULAR:
        return unit.angle(value)
    if name == RATIO:
        return f"{value:.7f}"
    # as sheets have it, from the crossing point and not from the pitch apex
    return unit.length(value - (member.blank.pitch_apex_beyond_crossing_point if name == ADVANCE else 0.0))


def _cutter(member: Member, space: ToothSpace, unit: SheetUnit) -> Iterator[tuple[str, dict[str, str]]]:
    """What the one who builds the cutters sets, by blade; what is not stated is left empty."""
    specs = {flank: member.flank(flank) for flank in FLANKS}

    yield ("point radius", {flank: unit.length(spec.blade_point_radius) for flank, spec in specs.items()})
    yield ("point diameter", {flank: unit.length(2 * spec.blade_point_radius) for flank, spec in specs.items()})
    yield ("pressure angle", {flank: unit.angle(spec.blade_pressure_angle) for flank, spec in specs.items()})
    yield ("edge radius", {flank: _stated(spec.blade_edge_radius, unit) for flank, spec in specs.items()})
    width = {flank: unit.length(point_width(member, flank, space.slots[flank])) for flank in FLANKS}
    if member.cutting == "completing":
        between = specs["concave"].blade_point_radius - specs["convex"].blade_point_radius
        width = dict.fromkeys(FLANKS, unit.length(between) if "work_rotation_offset" in member.shared_settings else "")
    yield ("point width", width)
    if any(spec.blade_tip_height for spec in specs.values()):
        yield ("height of the tip", {flank: unit.length(spec.blade_tip_height) for flank, spec in specs.items()})
    yield ("blade height", {flank: unit.length(spec.blade_profile_height) for flank, spec in specs.items()})
    if any(spec.toprem_angle is not None for spec in specs.values()):
        angles = {flank: spec.toprem_angle for flank, spec in specs.items()}
        yield ("Toprem angle", {flank: "" if one is None else unit.angle(one) for flank, one in angles.items()})
        yield ("Toprem height", {flank: _stated(spec.toprem_height, unit) for flank, spec in specs.items()})
    if any(spec.blade_spheric_radius is not None for spec in specs.values()):
        radii = {flank: spec.blade_spheric_radius for flank, spec in specs.items()}
        yield ("spheric radius", {flank: "" if one is None else unit.length(one) for flank, one in radii.items()})
        heights = {flank: unit.length(spec.blade_reference_height) for flank, spec in specs.items()}
        yield ("reference height of it", heights)
    if member.blade_groups is not None:
        yield ("blade groups", dict.fromkeys(FLANKS, str(member.blade_groups)))
        yield ("blade offset angle", {flank: unit.angle(spec.blade_offset_angle) for flank, spec in specs.items()})
        if "work_rotation_offset" not in member.shared_settings:
            behind = unit.angle(math.degrees(blade_phase(member)))
            yield ("from the outer to the inner blade", {"concave": "", "convex": behind})
    elif any(spec.blade_count is not None for spec in specs.values()):
        yield ("blades", {flank: str(spec.blade_count or "") for flank, spec in specs.items()})


def _stated(length: float, unit: SheetUnit) -> str:
    """A length [mm] that a file may leave out, as 0."""
    return unit.length(length) if length else ""

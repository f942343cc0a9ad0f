"""Pairs from design data and from measured flanks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearmath.arguments.call import checked_call
from gearmath.bevel.blank import BevelBlank, blank_of
from gearmath.bevel.blank_table import TableRow, by_name, rows, set_fragment
from gearmath.bevel.contact.mesh import Mesh
from gearmath.bevel.contact.report import shown_runs
from gearmath.bevel.design.accepted import accepted
from gearmath.bevel.design.reverse import ReversedMember
from gearmath.bevel.design.reverse_route import ReversedSet, load_known, reversed_set
from gearmath.bevel.slots import slots_of
from gearmath.errors import about
from gearmath.front.measured import Measurement
from gearmath.front.progress import Begin, silent
from gearmath.front.sets import GearSet, set_of
from gearmath.shown import Shown, Shows, html_table
from gearmath.specs.bevel_set import MEMBERS
from gearmath.specs.blank_data import load_blank_data
from gearmath.specs.design import load_design
from gearmath.specs.flank_csv import FlankFile, read_flank_csv
from gearmath.specs.set_text import to_nine_decimals
from gearmath.specs.toml import find

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class PairDesign(Shown):
    """A designed pair; ``figures`` has what was asked and found, ``runs`` the exact contact of each side."""

    gear_set: GearSet
    figures: dict[str, Any]
    runs: Mapping[str, Mesh]

    def to_dict(self) -> dict[str, Any]:
        """As ``gearmath design --json`` prints it, but for the name of the file."""
        return self.figures

    def plot(self) -> Figure:
        """Transmission error, path and pattern of both sides."""
        from gearmath.plot.contact import contact_figure

        return contact_figure(dict(self.runs))

    def _shown(self) -> tuple[str, list[Shows]]:
        return self.gear_set.title, shown_runs(self.runs)


@checked_call
def design(path: str | Path, gear: GearSet | str | Path | None = None, begin: Begin = silent) -> PairDesign:
    """A pair that runs as the file of design data asks, or a pinion to a given ``gear``; docs/design.md.

    Raises InputError naming key, value and limit of what cannot be, ComputationError where no settings are found.
    """
    source = find(str(path))
    asked = load_design(source)
    progress = begin(1, "design")
    with about(source):
        made, figures, runs = accepted(asked, str(source), None if gear is None else set_of(gear).spec)
        progress(1)
    pair = to_nine_decimals(made.pair, MEMBERS if gear is None else ("pinion",))  # a given gear stays what it is
    return PairDesign(GearSet(pair), figures, runs)


@dataclass(frozen=True, repr=False)
class FoundSettings(Shown):
    """The settings of a member that was measured: ``found`` says by flank how well they make its points [mm].

    ``title`` is that of the file of its blank.
    """

    title: str
    gear_set: GearSet
    how: ReversedSet

    @property
    def found(self) -> ReversedMember:
        """How well the settings make the points, by flank."""
        return self.how.found

    def to_dict(self) -> dict[str, Any]:
        """As ``gearmath design --reverse --json`` prints it, but for the name of the file; deviations in um."""
        member, how = self.found.member, self.how
        stated = {key: getattr(member, key) for key in ("cutting", "process", "generation")}
        flanks = {flank: found.as_dict() for flank, found in self.found.flanks.items()}
        place = {
            "tooth_thickness_mm": dict(zip(("found", "blank"), how.thickness, strict=True)),
            "middle_cone_distance_mm": dict(zip(("points", "blank"), how.middle, strict=True)),
        }
        return {"member": how.name, **stated, **place, "notes": list(how.notes), **flanks}

    def _shown(self) -> tuple[str, list[Shows]]:
        _, figures = self.found._shown()
        for flank, found in self.found.flanks.items():
            figures.append((f"{flank}: largest in size", 1000 * float(abs(found.after).max()), "um"))
        return f"settings of the {self.how.name}, {self.title}", figures


@checked_call
def settings_of(points: str | Path | Measurement | FlankFile, data: str | Path, begin: Begin = silent) -> FoundSettings:
    """The settings of the member with these flanks, and how well they make them, as ``gearmath design --reverse``.

    ``points`` is a measurement, a flank file or its name; ``data`` a file of design data, of a blank, or a gear set:
    blank and method are taken of it. Raises InputError.
    """
    known = load_known(find(str(data)))
    name = Path(points if isinstance(points, str | Path) else "points")
    given = points.file if isinstance(points, Measurement) else points
    file = given if isinstance(given, FlankFile) else read_flank_csv(name)
    progress = begin(1, "member")
    with about(name):
        found = reversed_set(known, file, f"settings found from the points of {name.name}")
    progress(1)
    return FoundSettings(known.title, GearSet(to_nine_decimals(found.pair, (found.name,))), found)


@dataclass(frozen=True, repr=False)
class Blank(Shown):
    """The blank of a pair: ``spec`` has its figures to ISO 23509 in mm and rad."""

    title: str
    spec: BevelBlank

    @property
    def rows(self) -> list[TableRow]:
        """Its figures [mm, degrees] with their symbols, and slot widths and edge radii to AGMA 929."""
        return rows(self.spec, slots_of(self.spec))

    def to_dict(self) -> dict[str, Any]:
        """As ``gearmath blank --json`` prints it."""
        return {"title": self.title, "process": self.spec.process, "units": "mm, degree", **by_name(self.rows)}

    def fragment(self) -> str:
        """The part of a gear set file that the blank is, TOML."""
        return set_fragment(self.spec)

    def _shown(self) -> tuple[str, list[Shows]]:
        return f"blank, {self.title}", [(row.name.replace("_", " "), row.values, row.unit) for row in self.rows]

    def _repr_html_(self) -> str:
        return html_table(
            self.title,
            ["figure", "symbol", "unit", "value"],
            [[row.name.replace("_", " "), row.symbol, row.unit, row.values] for row in self.rows],
        )


@checked_call
def load_blank(path: str | Path) -> Blank:
    """The blank of a file of design data, or a bundled one. Raises InputError naming key, value and limit.

    >>> import gearmath as gm
    >>> "pitch_angle" in str(gm.load_blank("blank_iso23509_sample1.toml").to_dict())
    True
    """
    source = find(str(path))
    data = load_blank_data(source)
    return Blank(data.title, blank_of(data, str(source)))

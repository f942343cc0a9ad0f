"""Pairs from design data, from other programs, and from measured flanks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearmath.bevel.blank import BevelBlank, blank_of
from gearmath.bevel.blank_table import by_name, rows, set_fragment
from gearmath.bevel.contact.mesh import Mesh
from gearmath.bevel.design.accepted import accepted
from gearmath.bevel.design.reverse import ReversedMember
from gearmath.bevel.design.reverse_route import load_known, reversed_set
from gearmath.bevel.pair import check_pair
from gearmath.bevel.slots import slots_of
from gearmath.errors import about
from gearmath.exchange.rexs import read_rexs
from gearmath.front.sets import GearSet
from gearmath.front.tables import html_table
from gearmath.specs.blank_data import load_blank_data
from gearmath.specs.design import load_design
from gearmath.specs.flank_csv import FlankFile, read_flank_csv
from gearmath.specs.toml import find

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class PairDesign:
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


def design(path: str | Path, gear: GearSet | None = None) -> PairDesign:
    """A pair that runs as the file of design data asks, or a pinion to a given ``gear``; docs/design.md.

    Raises InputError naming key, value and limit of what cannot be, ComputationError where no settings are found.
    """
    source = find(str(path))
    with about(source):
        made, figures, runs = accepted(load_design(source), str(source), None if gear is None else gear.spec)
    return PairDesign(GearSet(made.pair), figures, runs)


def settings_of(points: str | Path | FlankFile, data: str | Path) -> tuple[GearSet, ReversedMember]:
    """The settings of the member with these flanks, and how well they make them, as ``gearmath design --reverse``.

    ``data`` is a file of design data, of a blank, or a gear set: blank and method are taken of it. Raises InputError.
    """
    file = points if isinstance(points, FlankFile) else read_flank_csv(Path(points))
    name = "points" if isinstance(points, FlankFile) else Path(points).name
    found, how_well = reversed_set(load_known(find(str(data))), file, f"settings found from the points of {name}")
    return GearSet(found), how_well


@dataclass(frozen=True)
class Blank:
    """The blank of a pair: ``spec`` has its figures to ISO 23509 in mm and rad."""

    title: str
    spec: BevelBlank

    def to_dict(self) -> dict[str, Any]:
        """Its figures by name [mm, degrees], with slot widths to AGMA 929."""
        return by_name(rows(self.spec, slots_of(self.spec)))

    def fragment(self) -> str:
        """The part of a gear set file that the blank is, TOML."""
        return set_fragment(self.spec)

    def _repr_html_(self) -> str:
        found = rows(self.spec, slots_of(self.spec))
        return html_table(
            self.title,
            ["figure", "symbol", "unit", "value"],
            [[row.name.replace("_", " "), row.symbol, row.unit, ", ".join(map(str, row.values))] for row in found],
        )


def load_blank(path: str | Path) -> Blank:
    """The blank of a file of design data, or a bundled one. Raises InputError naming key, value and limit.

    >>> import gearmath as gm
    >>> "pitch_angle" in str(gm.load_blank("blank_iso23509_sample1.toml").to_dict())
    True
    """
    source = find(str(path))
    data = load_blank_data(source)
    return Blank(data.title, blank_of(data, str(source)))


def load_rexs(path: str | Path) -> GearSet:
    """The set of the bevel stage in a REXS 2.0.0 file. Raises InputError naming what is missing or no pair."""
    pair, _ = read_rexs(Path(path))
    with about(Path(path)):
        check_pair(pair)
    return GearSet(pair)

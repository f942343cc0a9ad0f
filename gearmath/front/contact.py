"""How a pair runs: nominal or measured flanks in contact, at any assembly."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearmath.arguments.call import checked_call
from gearmath.arguments.kinds import Truth
from gearmath.bevel.contact.mesh import Mesh as Run
from gearmath.bevel.contact.mesh import mesh
from gearmath.bevel.contact.outcome_limits import SEARCHES as CHANGES
from gearmath.bevel.contact.outcome_limits import outcome_limits
from gearmath.bevel.contact.report import SIDES, figures, shown_runs, tolerance_figures
from gearmath.bevel.contact.system import Assembly
from gearmath.bevel.contact.tolerance import SEARCHES
from gearmath.bevel.contact.tolerance import tolerance as search
from gearmath.errors import InputError, about
from gearmath.front.measured import Measurement, measurement_in
from gearmath.front.progress import Begin, silent
from gearmath.front.sets import GearSet
from gearmath.quality.contact.flank import MeasuredFlank
from gearmath.quality.contact.pair import MeasuredPair, flanks_of
from gearmath.shown import Shown, Shows, html_table
from gearmath.specs.bevel_set import MEMBERS

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class Contact(Shown):
    """A pair in contact: ``runs`` has the exact contact of each side, ``drive`` and ``coast``, in mm and rad.

    ``tolerances`` [mm] say by side how far V and H may go until the pattern reaches an edge, and until the
    pair runs otherwise, where that was asked for.
    """

    measured: MeasuredPair
    runs: Mapping[str, Run]
    tolerances: Mapping[str, dict[str, Any] | None] = field(default_factory=dict)

    @checked_call
    def to_dict(self, step: float = 1.0) -> dict[str, Any]:
        """As ``gearmath contact --json`` prints it; positions at multiples of ``step`` [degrees of the pinion]."""
        found = {}
        for side, run in self.runs.items():
            found[side] = figures(run, math.radians(step)) | self.measured.figures(side, run)
            if side in self.tolerances:
                found[side]["tolerance_mm"] = self.tolerances[side]
        return found

    def plot(self) -> Figure:
        """Transmission error, path, pattern and V-H diagram, a row for each side."""
        from gearmath.plot.contact import contact_figure

        return contact_figure(self.runs, {side: self.tolerances.get(side) for side in self.runs})

    def _shown(self) -> tuple[str, list[Shows]]:
        return f"contact at {self._assembly}", shown_runs(self.runs)

    @property
    def _assembly(self) -> str:
        """V, H, J and the growth of the shaft angle that it was computed at."""
        at = next((run.assembly for run in self.runs.values()), Assembly().vector)
        lengths = ", ".join(f"{name} = {value:g}" for name, value in zip("VHJ", at, strict=False))
        return f"{lengths} mm" + (f", shaft angle {math.degrees(at[3]):+g}°" if at[3] else "")

    def _repr_html_(self) -> str:
        rows = [
            [side, found["outcome"], found["contact_ratio"], found["peak_to_peak_arcsec"], found["pattern"]["share"]]
            for side, found in self.to_dict(step=15.0).items()
        ]
        head = ["side", "outcome", "contact ratio", "transmission error (arcsec)", "part of the flank in the pattern"]
        return html_table(f"contact at {self._assembly}", head, rows)


@checked_call(tolerance=Truth())
def contact(
    pair: GearSet,
    *measured: Measurement | str | Path,
    v: float = 0.0,
    h: float = 0.0,
    j: float = 0.0,
    shaft: float = 0.0,
    sides: tuple[str, ...] = tuple(SIDES),
    tolerance: bool = False,
    begin: Begin = silent,
) -> Contact:
    """The contact of a pair; see :meth:`gearmath.GearSet.contact`."""
    for name in MEMBERS:
        pair.spec.member(name)
    flanks: dict[tuple[str, str], MeasuredFlank | None] = {}
    remarks: list[str] = []
    for one in (measurement_in(given, pair) for given in measured):
        with about(one.source):
            if any(name == one.member.name for name, _ in flanks):
                raise InputError(f"measured: two are of the {one.member.name}: one of each member may be")
            found, said = flanks_of(one.member.gear_set.spec, one.member.name, one.file)
        flanks |= found
        remarks += [text if one.source is None else f"{one.source}: {text}" for text in said]
    whole = MeasuredPair(pair.spec, flanks, tuple(remarks))
    given, searches = Assembly(v, h, j, math.radians(shaft)), SEARCHES + CHANGES if tolerance else 0
    progress = begin(len(sides) * (1 + searches), "step")
    runs, limits = {}, {}
    for side in sides:
        with about(pair.source):
            system = whole.system(side)
        runs[side] = mesh(system, given)
        progress(1)
        if tolerance:
            changes = outcome_limits(runs[side], progress)
            limits[side] = tolerance_figures(search(runs[side], progress=progress), changes)
    return Contact(whole, runs, limits)

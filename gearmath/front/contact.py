"""How a pair runs: nominal or measured flanks in contact, at any assembly."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gearmath.bevel.contact.mesh import Mesh as Run
from gearmath.bevel.contact.mesh import mesh
from gearmath.bevel.contact.report import SIDES, figures
from gearmath.bevel.contact.system import Assembly
from gearmath.errors import InputError
from gearmath.front.measured import Measurement
from gearmath.front.sets import GearSet
from gearmath.front.tables import html_table
from gearmath.quality.contact.flank import MeasuredFlank
from gearmath.quality.contact.pair import MeasuredPair, flanks_of
from gearmath.specs.bevel_set import FLANKS

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Contact:
    """A pair in contact: ``runs`` has the exact contact of each side, ``drive`` and ``coast``, in mm and rad."""

    measured: MeasuredPair
    runs: Mapping[str, Run]

    def to_dict(self, step: float = 1.0) -> dict[str, Any]:
        """As ``gearmath contact --json`` prints it; positions at multiples of ``step`` [degrees of the pinion]."""
        return {
            side: figures(run, math.radians(step)) | self.measured.figures(side, run) for side, run in self.runs.items()
        }

    def plot(self) -> Figure:
        """Transmission error, path, pattern and V-H diagram, a row for each side."""
        from gearmath.plot.contact import contact_figure

        return contact_figure(self.runs)

    def _repr_html_(self) -> str:
        rows = [
            [side, found["outcome"], found["contact_ratio"], found["peak_to_peak_arcsec"], found["pattern"]["share"]]
            for side, found in self.to_dict(step=15.0).items()
        ]
        head = ["side", "outcome", "contact ratio", "transmission error (arcsec)", "part of the flank in the pattern"]
        return html_table("contact", head, rows)


def contact(
    pair: GearSet,
    *measured: Measurement,
    v: float = 0.0,
    h: float = 0.0,
    j: float = 0.0,
    shaft: float = 0.0,
    sides: tuple[str, ...] = tuple(SIDES),
) -> Contact:
    """The contact of a pair at an assembly: V, H, J [mm], growth of the shaft angle [degrees]; docs/contact.md.

    With measurements of its members, one or both, on the measured flanks. Raises InputError where the set has one
    member only, or a measurement holds no tooth in full.

    >>> import gearmath as gm
    >>> found = gm.contact(gm.load_set("nasa_tp3096_12x36.toml"), sides=("drive",))
    >>> found.runs["drive"].outcome
    'reversed parabola'
    """
    for side in sides:
        if side not in SIDES:
            raise InputError(f"sides: {side!r}: must be of {', '.join(SIDES)}")
    flanks: dict[tuple[str, str], MeasuredFlank | None] = {}
    for one in measured:
        _check_nominal(pair, one)
        found, _ = flanks_of(one.member.gear_set.spec, one.member.name, one.file)
        flanks |= found
    whole = MeasuredPair(pair.spec, flanks)
    for name in ("pinion", "gear"):
        pair.spec.member(name)
    given = Assembly(v, h, j, math.radians(shaft))
    return Contact(whole, {side: mesh(whole.system(side), given) for side in sides})


def _check_nominal(pair: GearSet, measurement: Measurement) -> None:
    """A measurement counts from its own nominal flanks: they must be those of the pair."""
    name = measurement.member.name
    for flank in FLANKS:
        own, wanted = (
            member.flank(flank).nominal.vector for member in (measurement.member.spec, pair.spec.member(name))
        )
        if not np.allclose(own, wanted, rtol=0, atol=1e-8):  # a set file has nine decimals
            raise InputError(f"{name}.{flank}: was measured against other nominal settings than those of the pair")

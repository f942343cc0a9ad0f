"""Runs of one member side by side: their figures, what was different when they were measured, and point from point."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from gearmath.control.store_evaluation import EvaluatedRun
from gearmath.control.store_summary import summary
from gearmath.errors import InputError
from gearmath.quality.evaluation.topography import ORDER_KEYS
from gearmath.quality.uncertainty.covariance import independent, stated
from gearmath.quality.uncertainty.figures import figures_of
from gearmath.quality.uncertainty.propagation import uncertain_figures
from gearmath.specs.bevel_set import FLANKS, design_sha256

#: Both flanks together, where a figure is of the member.
BOTH = "both"
#: Figures of a flank, beside the orders of its mean topography; of the spaces. Names as in the JSON of evaluate.
_OF_FLANK = ("max_deviation_um", "rms_um", "F_p_um", "max_f_pt_um")
#: What the same figure is called in `figures_of`, where it is not the name without its unit.
_UNCERTAIN = {"arc_deviation_um": "mean_thickness"}
#: A change of more than so many of its standard uncertainties is not noise; draws for those of maxima.
COVERAGE, _DRAWS = 2.0, 2000


@dataclass(frozen=True)
class FigureRow:
    """One figure of all runs and its standard uncertainties by the noise of the touches [µm].

    A value is None where it is withheld or was not measured, an uncertainty also where it is not known.
    """

    flank: str
    name: str
    values: tuple[float | None, ...]
    uncertainties: tuple[float | None, ...]

    @property
    def sizes(self) -> tuple[float | None, ...]:
        """The values; of the largest deviation, whose sign is that of one point, its size."""
        if self.name != "max_deviation_um":
            return self.values
        return tuple(None if value is None else abs(value) for value in self.values)

    @property
    def change(self) -> float | None:
        """From the first run to the last one, in size where a sign says nothing."""
        first, last = self.sizes[0], self.sizes[-1]
        return None if first is None or last is None else last - first

    @property
    def change_uncertainty(self) -> float | None:
        """Of the change: the touches of two runs err independently of each other."""
        first, last = self.uncertainties[0], self.uncertainties[-1]
        return None if first is None or last is None else math.hypot(first, last)

    @property
    def beyond_noise(self) -> bool | None:
        """Whether the change is more than noise; None where that is not known."""
        change, u = self.change, self.change_uncertainty
        return None if change is None or u is None else abs(change) > COVERAGE * u

    def as_dict(self) -> dict[str, Any]:
        return {
            "flank": self.flank,
            "name": self.name,
            "values": list(self.values),
            "uncertainties": list(self.uncertainties),
            "change": self.change,
            "u_change": self.change_uncertainty,
            "beyond_noise": self.beyond_noise,
        }


@dataclass(frozen=True)
class Change:
    """How the mean form of a flank changed from the first run to the last: RMS and largest [µm], with its place."""

    flank: str
    rms_um: float
    largest_um: float
    row: int
    col: int


@dataclass(frozen=True)
class Comparison:
    """Two or more runs: their figures, the change of form, and ``differs``, what was not the same, in sentences."""

    runs: tuple[EvaluatedRun, ...]
    differs: tuple[str, ...]
    figures: tuple[FigureRow, ...]
    changes: tuple[Change, ...]
    noise_um: tuple[float | None, ...]

    def as_dict(self) -> dict[str, Any]:
        """For programs; lengths in µm where the name says so."""
        return {
            "member": self.runs[0].name,
            "runs": [vars(summary(each.run)) for each in self.runs],
            "differs": list(self.differs),
            "figures": [row.as_dict() for row in self.figures],
            "changes": [vars(change) for change in self.changes],
            "noise_um": list(self.noise_um),
        }


def compare(runs: Sequence[EvaluatedRun]) -> Comparison:
    """Compare runs in the order given. Raises InputError for runs of different members or numbers of teeth."""
    figures, sure = side_by_side(runs), [_uncertainties(each) for each in runs]
    rows = tuple(FigureRow(*place, figures[place], tuple(each.get(place) for each in sure)) for place in figures)
    seats = [each.found.registration for each in runs]
    noise = tuple(None if seat is None else seat.as_dict()["noise_um"] for seat in seats)
    return Comparison(tuple(runs), tuple(_differs(runs)), rows, tuple(_changes(runs[0], runs[-1])), noise)


def side_by_side(runs: Sequence[EvaluatedRun]) -> dict[tuple[str, str], tuple[float | None, ...]]:
    """The figures of all runs [µm] by flank and name; None where one is withheld or was not measured.

    Raises InputError for runs of different members or numbers of teeth.
    """
    first = runs[0]
    for other in runs[1:]:
        if (other.name, other.member.teeth) != (first.name, first.member.teeth):
            raise InputError(
                f"run {other.run.id} is of a {other.name} with {other.member.teeth} teeth, run {first.run.id} of a "
                f"{first.name} with {first.member.teeth}: they cannot be compared"
            )
    by_run = [_figures(each) for each in runs]
    places = dict.fromkeys(place for figures in by_run for place in figures)
    return {place: tuple(figures.get(place) for figures in by_run) for place in places}


def _figures(run: EvaluatedRun) -> dict[tuple[str, str], float | None]:
    """The figures of a run [µm] by flank and name, as far as they were measured; None where one is withheld."""
    values = run.found.as_dict()
    found: dict[tuple[str, str], float | None] = {}
    for flank, row in values["flanks"].items():
        found |= {(flank, name): row[name] for name in _OF_FLANK if name in row}
        if row.get("orders"):
            found |= {(flank, name): row["orders"][name] for name in ORDER_KEYS}
    if values["runout"] is not None:
        found[BOTH, "F_r_um"] = values["runout"]["F_r_um"]
    if values["thickness"] is not None:
        found[BOTH, "arc_deviation_um"] = values["thickness"]["arc_deviation_um"]
    return found


def _uncertainties(run: EvaluatedRun) -> dict[tuple[str, str], float]:
    """Standard uncertainties [µm] of the figures, from repeated touches, or else the noise that the clamping leaves.

    Empty where neither tells it.
    """
    covariance, seat = stated(run.file), run.found.registration
    if covariance is None:
        if seat is None or not seat.noise > 0.0:
            return {}
        covariance = independent(np.full(len(run.file), seat.noise))
    found = uncertain_figures(figures_of(run.file, run.member, run.found), covariance, _DRAWS)
    by_name = {(one.figure.flank, one.figure.name): one.uncertainty * 1000 for one in found}
    return {
        (flank, name): by_name[flank, short]
        for flank, name in _figures(run)
        if (flank, short := _UNCERTAIN.get(name, name.removesuffix("_um"))) in by_name
    }


def _changes(first: EvaluatedRun, last: EvaluatedRun) -> Iterator[Change]:
    """Of the flanks that both runs measured in full, on the same grid."""
    for flank in FLANKS:
        forms = [run.found.flanks[flank].mean if flank in run.found.flanks else None for run in (first, last)]
        before, after = forms
        if before is None or after is None or before.deviation.shape != after.deviation.shape:
            continue
        change = (after.deviation - before.deviation) * 1000
        if not np.isfinite(change).any():
            continue
        row, col = np.unravel_index(int(np.nanargmax(np.abs(change))), change.shape)
        yield Change(flank, float(np.sqrt(np.nanmean(change**2))), float(change[row, col]), int(row), int(col))


def _differs(runs: Sequence[EvaluatedRun]) -> Iterator[str]:
    """What of files, program and people was different from each run to the next one."""
    for before, after in pairwise(runs):
        pair = f"runs {before.run.id} and {after.run.id}"
        same_design = design_sha256(before.member) == design_sha256(after.member)
        if not same_design:
            yield f"{pair}: the nominal flanks are not the same: their deviations are from different flanks"
        old, new = before.run.start, after.run.start
        for name in sorted({*old.files, *new.files}):
            if old.files.get(name) != new.files.get(name):
                for change in _file_changes(old.files.get(name), new.files.get(name), same_design):
                    yield f"{pair}: {name}: {change}"
        if old.program_text != new.program_text:
            names = {old.program, new.program}
            yield f"{pair}: the programs are not the same ({', '.join(sorted(names))})"
        for what in ("control", "operator"):
            if getattr(old, what) != getattr(new, what):
                yield f"{pair}: {what} {getattr(old, what) or 'not known'}, then {getattr(new, what) or 'not known'}"


def _file_changes(old: bytes | None, new: bytes | None, same_design: bool) -> Iterator[str]:
    """The keys of a TOML file that changed, with their values; that it changed, where it is no TOML.

    A corrected set keeps its nominal settings under ``design``: no change, where the runs have the ``same_design``.
    """
    if old is None or new is None:
        yield f"is stored with the {'later' if old is None else 'earlier'} run only"
        return
    try:
        before, after = (_flat(tomllib.loads(text.decode("utf-8-sig"))) for text in (old, new))
    except ValueError:
        yield "is not the same"
        return
    keys = [key for key in dict.fromkeys([*before, *after]) if before.get(key) != after.get(key)]
    if same_design:
        keys = [key for key in keys if ".design." not in key]
    if not keys:
        yield "has the same values, written in another way"
    for key in keys:
        first, last = before.get(key, "none"), after.get(key, "none")
        by = f" ({last - first:+.6g})" if isinstance(first, float) and isinstance(last, float) else ""
        yield f"{key} {_shown(first)} -> {_shown(last)}{by}"


def _shown(value: Any) -> str:
    """A value of a file, numbers to eight digits."""
    if isinstance(value, list):
        return "a list"
    return f"{value:.8g}" if isinstance(value, float) else str(value)


def _flat(values: Any, prefix: str = "") -> dict[str, Any]:
    """A tree of tables as keys with dots."""
    if not isinstance(values, dict):
        return {prefix: values}
    found: dict[str, Any] = {}
    for key, value in values.items():
        found |= _flat(value, f"{prefix}.{key}" if prefix else key)
    return found

"""What a page shows of a judged run: charts as they stand on the inspection sheet, and its figures as rows of cells."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from gearmath.hmi.drawing import PENCIL
from gearmath.hmi.judged_runs import JudgedRuns, Progress
from gearmath.quality.evaluation.topography import ORDERS
from gearmath.report.charts import flank_charts, means, pitch_charts, pitches, space_charts
from gearmath.report.figures import figure_cells, largest_cell, spacing_rows
from gearmath.report.measurement import ReportedMeasurement, in_words, micro
from gearmath.specs.bevel_set import FLANKS

#: Figures of single teeth and coefficients: too many to be read.
_NOT_SHOWN = ("f_pt_", "c_")


@dataclass(frozen=True)
class ResultRow:
    """One figure: what it is, of which flank ("both" of the member), and its cells as texts."""

    name: str
    flank: str
    cells: tuple[str, ...]


@dataclass(frozen=True)
class ResultView:
    """A run on the page. Charts are SVG by flank, of the runout under "both"; sentences come as the sheet has them.

    ``spacing`` has value [µm], 95 % interval, grade and its tolerance [µm]; ``thickness`` nominal [mm] and deviation
    [µm]; ``forms`` a value [µm].
    """

    run: int
    topographies: dict[str, str]
    pitches: dict[str, str]
    first: tuple[str, ...]
    others: tuple[str, ...]
    spacing: tuple[ResultRow, ...]
    caveat: str
    thickness: tuple[ResultRow, ...]
    forms: tuple[ResultRow, ...]


def result_of(runs: JudgedRuns, run: int, progress: Progress = lambda _: None) -> ResultView:
    """A stored run evaluated and drawn, without uncertainties. Raises InputError as :meth:`JudgedRuns.evaluated`."""
    evaluated = runs.evaluated(run, progress)
    found = evaluated.found
    one = ReportedMeasurement(evaluated.gear_set.title, f"run {run}", evaluated.member, found, None)
    with PENCIL:
        forms = dict(zip(means(found), (svg for svg, _ in flank_charts(one, {})), strict=True))
        spaces = dict(zip((each.flank for each in pitches(found)), (svg for svg, _ in pitch_charts(one)), strict=True))
        spaces |= dict(zip(("both",), (svg for svg, _ in space_charts(one)), strict=False))
    others = dict.fromkeys(text for text in found.remarks if text not in found.first)
    return ResultView(
        run,
        forms,
        spaces,
        tuple(map(in_words, (*found.first, *found.withheld))),
        tuple(map(in_words, others)),
        tuple(_spacing(one)),
        "" if found.verdict is None else found.verdict.remark,
        tuple(_thickness(one)),
        tuple(_forms(one)),
    )


@dataclass(frozen=True)
class SureView:
    """The figures of a run once more, now with uncertainties: ``spacing`` with intervals and the grades of their ends.

    ``figures`` have value, u, from, to, unit, and how it was found; ``source`` says where the uncertainties come from.
    """

    spacing: tuple[ResultRow, ...]
    figures: tuple[ResultRow, ...]
    source: str


def sure_of(runs: JudgedRuns, run: int, progress: Progress = lambda _: None) -> SureView:
    """How sure the figures of a stored run are: some seconds. Raises InputError as :meth:`JudgedRuns.judged`."""
    one = runs.judged(run, progress)
    return SureView(tuple(_spacing(one)), tuple(_sure(one)), in_words(one.how_sure))


def _spacing(one: ReportedMeasurement) -> Iterator[ResultRow]:
    for name, flank, cells in spacing_rows(one):
        yield ResultRow(name, flank, tuple(cells))


def _thickness(one: ReportedMeasurement) -> Iterator[ResultRow]:
    found = one.evaluation.thickness
    if found is not None:
        yield ResultRow("arc", "both", (f"{found.arc:.4f}", micro(found.mean)))
        yield ResultRow("chord", "both", (f"{found.chord:.4f}", micro(found.mean * found.chord_factor)))


def _forms(one: ReportedMeasurement) -> Iterator[ResultRow]:
    """Size and orders of the mean topography of each flank [µm]."""
    flanks = {flank: each for flank, each in one.evaluation.flanks.items() if each.mean is not None}
    for flank, each in flanks.items():
        assert each.mean is not None  # chosen so
        yield ResultRow("at_reference", flank, (micro(each.mean.at_reference),))
        yield ResultRow("largest", flank, (largest_cell(each),))
        yield ResultRow("rms", flank, (micro(each.mean.rms),))
        if each.orders is not None:
            for name in (*ORDERS, "residual"):
                yield ResultRow(name, flank, (micro(getattr(each.orders, name)),))


def _sure(one: ReportedMeasurement) -> Iterator[ResultRow]:
    """Every figure that has an uncertainty, but those of single teeth."""
    for flank in (*FLANKS, "both"):
        for known in one.figures:
            if known.figure.flank == flank and not known.figure.name.startswith(_NOT_SHOWN):
                cells = (*figure_cells(known), in_words(known.figure.unit), known.method)
                yield ResultRow(known.figure.name, flank, cells)

"""What a measurement says, with how sure it is: figures, inspection sheets, and points of other measuring machines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearmath.arguments.call import checked_call
from gearmath.arguments.kinds import Place
from gearmath.errors import InputError, about
from gearmath.files import csv_text, write_text
from gearmath.front.corrected import effects_um
from gearmath.front.evaluated import Evaluation
from gearmath.front.measured import Measurement
from gearmath.front.member import Member
from gearmath.front.progress import Begin, Progress, silent
from gearmath.quality.evaluation.member import STAGES
from gearmath.quality.foreign.member import Foreign, Phase, foreign_file
from gearmath.quality.foreign.points import Frame, PointPart
from gearmath.quality.uncertainty.corrected import uncertain_correction
from gearmath.quality.uncertainty.figures import figures_of
from gearmath.quality.uncertainty.propagation import Uncertain, uncertain_figures
from gearmath.quality.uncertainty.source import covariance_of
from gearmath.shown import Shown, Shows, html_table
from gearmath.specs.point_text import PointText

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from matplotlib.figure import Figure

    from gearmath.quality.evaluation.member import MemberEvaluation
    from gearmath.quality.uncertainty.settings import Effect
    from gearmath.report import Report

#: The bundled files that say where the probe of a model stands.
_MACHINE, _PROBE = "vertical_5axis.toml", "probe.toml"
#: Steps of the progress of a sheet for the draws and for the correction.
_DRAWING, _CORRECTING = 8, 2


@dataclass(frozen=True, repr=False)
class Uncertainty(Shown):
    """Figures and settings with standard uncertainties, ``source`` says out of what; lengths in mm, angles in rad.

    ``effects`` say what errors of measurement do to each flank, ``draws`` and ``seed`` how maxima were found.
    """

    evaluation: Evaluation
    source: str
    figures: tuple[Uncertain, ...]
    effects: Mapping[str, Effect]
    remarks: tuple[str, ...]
    draws: int
    seed: int

    def to_dict(self) -> dict[str, Any]:
        """As ``gearmath uncertainty --json`` prints it; every figure in its own unit."""
        found = self.evaluation.found
        return {
            "member": found.member,
            "source": self.source,
            "draws": self.draws,
            "seed": self.seed,
            "figures": [one.as_dict() for one in self.figures],
            **effects_um(self.effects),
            "remarks": [*found.first, *self.remarks],
        }

    @checked_call
    def to_csv(self, path: str | Path) -> Path:
        """Write the figures, a line each in its own unit, with the columns of ``figures`` in :meth:`to_dict`."""
        rows = [one.as_dict() for one in self.figures]
        write_text(Path(path), csv_text(tuple(rows[0]), (row.values() for row in rows)))
        return Path(path)

    def plot(self) -> Figure:
        """Every figure in um with its interval of 95 %."""
        from gearmath.plot import uncertainty_figure

        return uncertainty_figure(self.evaluation.title, list(self.figures))

    def _shown(self) -> tuple[str, list[Shows]]:
        figures: list[Shows] = [
            ("figures", len(self.figures), ""),
            ("draws", self.draws, ""),
            ("from", self.source, ""),
        ]
        return f"uncertainties of the {self.evaluation.title}", figures

    def _repr_html_(self) -> str:
        names = ("flank", "figure", "value", "u", "unit")
        rows = [[one.as_dict()[name] for name in names] for one in self.figures]
        return html_table(f"uncertainties from {self.source}", names, rows)


@checked_call(machine=Place(), probe=Place())
def uncertainty(
    measured: Measurement,
    sigma_um: float | None = None,
    model: str | None = None,
    draws: int = 20_000,
    *,
    registered: bool = True,
    rotated: bool = True,
    machine: str = _MACHINE,
    probe: str = _PROBE,
    seed: int = 0,
    workers: int | None = None,
    executor: Executor | None = None,
    resume: str | Path | None = None,
    begin: Begin = silent,
) -> Uncertainty:
    """Standard uncertainties of everything that a measurement says; see :meth:`Measurement.uncertainty`."""
    if sigma_um is not None and model is not None:
        raise InputError("sigma_um and model: only one can say how well the points were measured")
    file, member = measured.file, measured.member.spec
    evaluation = measured.evaluate(registered, rotated)
    with about(measured.source):
        figures = figures_of(file, member, evaluation.found)
        covariance, source = covariance_of(file, member, sigma_um, model, machine, probe)
    heard = begin(draws, "draw")
    kept = None if resume is None else Path(resume)
    sure = uncertain_figures(figures, covariance, draws, seed, executor, workers, kept, heard)
    _, settings, effects, remarks = uncertain_correction(member, file, evaluation.found, covariance, sigma_um)
    return Uncertainty(evaluation, source, (*sure, *settings), effects, tuple(remarks), draws, seed)


def inspection(
    measured: Sequence[Measurement],
    heads: Sequence[Mapping[str, str]],
    again: Sequence[Measurement] = (),
    sigma_um: float | None = None,
    model: str | None = None,
    machine: str = _MACHINE,
    probe: str = _PROBE,
    begin: Begin = silent,
) -> Report:
    """The inspection sheet of one member, or of both: its page, and pictures once more for other uses.

    ``heads`` have part number, date and so on of each; ``again`` are members measured again after the correction. How
    well the points were measured as of :meth:`Measurement.uncertainty`. Raises InputError where measurements are of
    the same member.
    """
    from gearmath.report import STEPS, inspection_sheet  # loads Matplotlib
    from gearmath.report.judged import DRAWS, reported

    names = [one.member.name for one in measured]
    if len(set(names)) < len(names):
        raise InputError(f"both measurements are of the {names[0]}: the mate of the other member is wanted")
    progress = begin(len(again) * STAGES + len(measured) * (STAGES + _DRAWING + _CORRECTING + STEPS), "step")
    seconds: dict[str, MemberEvaluation] = {}
    for one in again:
        if one.member.name not in names or one.member.name in seconds:
            why = "is there twice" if one.member.name in seconds else "has no first measurement on the sheet"
            where = "" if one.source is None else f"{one.source}: "
            raise InputError(f"{where}member = {one.member.name!r}: {why}")
        seconds[one.member.name] = one.evaluate(progress=progress).found
    members = []
    for one, head in zip(measured, heads, strict=True):
        found, spec = one.evaluate(progress=progress).found, one.member.spec
        with about(one.source):
            covariance, source = covariance_of(one.file, spec, sigma_um, model, machine, probe)
            made = reported(
                one.member.gear_set.spec,
                "measurement" if one.source is None else one.source.name,
                one.file,
                found,
                covariance,
                source,
                head,
                sigma_um=sigma_um,
                again=seconds.get(one.member.name),
                drawn=_share(progress, DRAWS),
            )
        progress(_CORRECTING)
        members.append(made)
    return inspection_sheet(members, progress)


def _share(progress: Progress, draws: int) -> Progress:
    """Progress of the draws, as their share of the steps of a bar."""
    done = 0

    def drawn(count: int) -> None:
        nonlocal done
        before, done = done, done + count
        progress(done * _DRAWING // draws - before * _DRAWING // draws)

    return drawn


@dataclass(frozen=True, repr=False)
class ForeignPoints(Shown):
    """Points of another measuring machine as a measurement; ``found`` has how they were turned [rad], and gaps."""

    measurement: Measurement
    found: Foreign

    def _shown(self) -> tuple[str, list[Shows]]:
        title, figures = self.measurement._shown()
        return title, [*figures, *(("remark", text, "") for text in self.found.remarks)]


def foreign_points(
    texts: Mapping[tuple[str, int], PointText],
    member: Member,
    frame: Frame | None = None,
    phase: Phase = "common",
    leave_out: bool = False,
    begin: Begin = silent,
) -> ForeignPoints:
    """Points that were read, laid onto the flanks of a member; see :meth:`gearmath.Measurement.from_points`."""
    parts = [
        PointPart(str(text.path), flank, tooth, text.point, text.normal, text.line)
        for (flank, tooth), text in texts.items()
    ]
    progress = begin(2 * len(parts), "file")
    pair, name = member.gear_set.spec, member.name
    found = foreign_file(parts, frame or Frame(), pair, name, phase, progress, leave_out)
    return ForeignPoints(Measurement(member, found.file), found)

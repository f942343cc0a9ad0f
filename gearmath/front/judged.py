"""What a measurement says, with how sure it is: figures, inspection sheets, and points of other measuring machines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearmath.errors import InputError
from gearmath.files import write_text
from gearmath.front.measured import Measurement
from gearmath.front.sets import Member
from gearmath.front.tables import html_table
from gearmath.quality.foreign.member import Phase, foreign_file
from gearmath.quality.foreign.points import Frame, PointPart
from gearmath.quality.uncertainty.corrected import uncertain_correction
from gearmath.quality.uncertainty.figures import figures_of
from gearmath.quality.uncertainty.propagation import Uncertain, uncertain_figures
from gearmath.quality.uncertainty.source import covariance_of
from gearmath.report import inspection_sheet
from gearmath.report.judged import reported
from gearmath.specs.point_text import read_point_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: The bundled files that say where the probe of a model stands.
_MACHINE, _PROBE = "vertical_5axis.toml", "probe.toml"


@dataclass(frozen=True)
class Uncertainty:
    """Figures and settings with standard uncertainties, ``source`` says out of what; lengths in mm, angles in rad."""

    measurement: Measurement
    source: str
    figures: tuple[Uncertain, ...]

    def to_dict(self) -> dict[str, Any]:
        """By flank and name: value and standard uncertainty in the unit of the figure, um, mm or degrees."""
        found: dict[str, Any] = {}
        for one in self.figures:
            scale = one.figure.factor
            sure = {"value": one.value * scale, "u": one.uncertainty * scale, "unit": one.figure.unit}
            found.setdefault(one.figure.flank, {})[one.figure.name] = sure
        return found

    def plot(self) -> Figure:
        """Every figure in um with its interval of 95 %."""
        from gearmath.plot import uncertainty_figure

        return uncertainty_figure(self.measurement.member.name, list(self.figures))

    def _repr_html_(self) -> str:
        rows = [[flank, name, *sure.values()] for flank, by in self.to_dict().items() for name, sure in by.items()]
        return html_table(f"uncertainties from {self.source}", ["flank", "figure", "value", "u", "unit"], rows)


def uncertainty(measured: Measurement, sigma_um: float | None, model: str | None, draws: int) -> Uncertainty:
    """Standard uncertainties of everything that a measurement says; see :meth:`Measurement.uncertainty`."""
    if sigma_um is not None and model is not None:
        raise InputError("sigma_um and model: only one can say how well the points were measured")
    file, member = measured.file, measured.member.spec
    found = measured.evaluate().found
    covariance, source = covariance_of(file, member, sigma_um, model, _MACHINE, _PROBE)
    sure = uncertain_figures(figures_of(file, member, found), covariance, draws, 0)
    _, settings, _, _ = uncertain_correction(member, file, found, covariance, sigma_um)
    return Uncertainty(measured, source, (*sure, *settings))


def report(measured: Sequence[Measurement], path: Path, head: Mapping[str, str]) -> Path:
    """Write the inspection sheet of one member, or of both; see :meth:`Measurement.report`."""
    names = [one.member.name for one in measured]
    if len(set(names)) < len(names):
        raise InputError(f"both measurements are of the {names[0]}: the mate of the other member is wanted")
    members = []
    for one in measured:
        found = one.evaluate().found
        covariance, source = covariance_of(one.file, one.member.spec, None, None, _MACHINE, _PROBE)
        members.append(reported(one.member.gear_set.spec, path.name, one.file, found, covariance, source, head))
    write_text(path, inspection_sheet(members).html)
    return path


def load_points(
    paths: Mapping[tuple[str, int], str | Path],
    member: Member,
    unit: str = "mm",
    frame: Frame | None = None,
    phase: Phase = "common",
    leave_out: bool = False,
) -> Measurement:
    """Points of another measuring machine, as plain text, by flank and tooth: ``{("concave", 0): "points.txt"}``.

    ``frame`` says how the axes of the files lie, by default z from the apex to the back, ``phase`` whether they are
    turned in common, each, or kept; ``leave_out`` takes files with gaps; docs/files.md. Raises InputError naming file
    and line.
    """
    parts = []
    for (flank, tooth), path in paths.items():
        text = read_point_text(Path(path), unit)
        parts.append(PointPart(str(path), flank, tooth, text.point, text.normal, text.line))
    found = foreign_file(parts, frame or Frame(), member.gear_set.spec, member.name, phase, leave_out=leave_out)
    if found.gaps and not leave_out:
        raise InputError(f"{found.gaps[0]}; leave_out takes the other points")
    return Measurement(member, found.file)

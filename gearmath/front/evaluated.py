"""A measured member evaluated: the record of its figures."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearmath.arguments.call import checked_call
from gearmath.files import csv_text, named, write_text
from gearmath.front.measured import Measurement
from gearmath.quality.evaluation.member import MemberEvaluation as Found
from gearmath.quality.uncertainty.corrected import point_covariance
from gearmath.quality.uncertainty.figures import figures_of
from gearmath.quality.uncertainty.propagation import Uncertain, uncertain_figures
from gearmath.shown import Shown, Shows, html_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Figures of a flank that a person looks at first, by their names in the JSON.
_FIRST = {
    "max_deviation_um": "largest deviation",
    "rms_um": "RMS",
    "F_p_um": "total pitch deviation",
    "max_f_pt_um": "single pitch deviation",
}
#: Enough for the spread of a maximum to 2 %.
_FEW_DRAWS = 2000


@dataclass(frozen=True, repr=False)
class Evaluation(Shown):
    """The figures of a measured member: ``found`` has all in mm, :meth:`to_dict` in µm, as the command's JSON."""

    measurement: Measurement
    found: Found

    @property
    def title(self) -> str:
        """Member and file."""
        name, source = self.measurement.member.name, self.measurement.source
        return name if source is None else f"{name}, {source.name}"

    @property
    def remarks(self) -> tuple[str, ...]:
        """What was left out or taken out, and what should be looked at."""
        return self.found.remarks

    def to_dict(self) -> dict[str, Any]:
        """As ``gearmath evaluate --json`` prints it; lengths in µm where the name says so."""
        return self.found.as_dict()

    @checked_call
    def to_csv(self, path: str | Path) -> Path:
        """Write all figures of :meth:`to_dict` as lines ``figure,value``, the name of a figure as the way to it."""
        write_text(Path(path), csv_text(("figure", "value"), named(self.to_dict())))
        return Path(path)

    def plot(self) -> Figure:
        """Topography of both flanks, pitch and runout as far as they were measured."""
        from gearmath.plot import evaluation_figure

        return evaluation_figure(self.title, self.found)

    @checked_call
    def uncertainties(self, sigma_um: float | None = None) -> list[Uncertain]:
        """The figures with their standard uncertainties, from few draws: of ``sigma_um``, or else by u_um of the file.

        None where neither says how well the points were measured; :meth:`Measurement.uncertainty` says more.
        """
        covariance = point_covariance(self.measurement.file, sigma_um)
        if covariance is None:
            return []
        figures = figures_of(self.measurement.file, self.measurement.member.spec, self.found)
        return uncertain_figures(figures, covariance, _FEW_DRAWS)

    def _shown(self) -> tuple[str, list[Shows]]:
        figures: list[Shows] = []
        for key, name in _FIRST.items():
            for flank, row in self.to_dict()["flanks"].items():
                if key in row:
                    figures.append((f"{flank}: {name}", "withheld" if row[key] is None else row[key], "um"))
        return f"evaluation of the {self.title}", figures

    def _repr_html_(self) -> str:
        flanks = self.to_dict()["flanks"]
        names = [name for name in _FIRST if any(name in row for row in flanks.values())]
        rows = [
            [flank, *("withheld" if row.get(name) is None else row[name] for name in names)]
            for flank, row in flanks.items()
        ]
        return html_table(
            f"{self.measurement.member.name}, as measured", ["flank", *(f"{_FIRST[name]} (um)" for name in names)], rows
        )

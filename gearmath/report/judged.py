"""A measured file judged for the sheet: its figures and corrected settings, each with its uncertainty."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from gearmath.quality.evaluation.member import MemberEvaluation
from gearmath.quality.uncertainty.corrected import uncertain_correction
from gearmath.quality.uncertainty.covariance import Covariance
from gearmath.quality.uncertainty.figures import figures_of
from gearmath.quality.uncertainty.propagation import uncertain_figures
from gearmath.report.measurement import ReportedMeasurement, head_of
from gearmath.specs.bevel_set import BevelSet
from gearmath.specs.flank_csv import FlankFile

#: Of the Monte Carlo for maxima and ranges: their intervals to about one part in a hundred.
DRAWS, _SEED = 20_000, 0


def reported(
    pair: BevelSet,
    source: str,
    file: FlankFile,
    found: MemberEvaluation,
    covariance: Covariance,
    how_sure: str,
    head: Mapping[str, str],
    *,
    sigma_um: float | None = None,
    again: MemberEvaluation | None = None,
    draws: int = DRAWS,
    drawn: Callable[[int], object] = lambda _: None,
) -> ReportedMeasurement:
    """The evaluated ``file`` of a member with its uncertainties and its correction.

    ``covariance`` is of the deviations as measured, and ``how_sure`` says where it comes from; ``sigma_um`` is the
    noise of a point where it was given and not computed; ``drawn`` hears of the draws. Raises InputError where the
    points have no figures.
    """
    member = pair.member(file.member)
    sure = uncertain_figures(figures_of(file, member, found), covariance, draws, _SEED, progress=drawn)
    correction, settings, effects, remarks = uncertain_correction(member, file, found, covariance, sigma_um)
    caused = {flank: effect.caused for flank, effect in effects.items()}
    known = head_of(file, head)
    return ReportedMeasurement(
        pair.title, source, member, found, correction, known, sure, settings, caused, how_sure, again, remarks
    )

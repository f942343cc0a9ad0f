"""The correction of a measured member with what is known of the noise of its points, and how sure its settings are."""

from __future__ import annotations

import numpy as np

from gearmath.errors import ComputationError, InputError
from gearmath.quality.correction.member import MemberCorrection, correct
from gearmath.quality.evaluation.member import MemberEvaluation
from gearmath.quality.uncertainty.covariance import Covariance, independent, stated
from gearmath.quality.uncertainty.judged import judged_by_measured
from gearmath.quality.uncertainty.propagation import Uncertain
from gearmath.quality.uncertainty.settings import Effect, noise_of, uncertain_settings
from gearmath.specs.bevel_set import Member
from gearmath.specs.flank_csv import FlankFile


def point_covariance(file: FlankFile, sigma_um: float | None) -> Covariance | None:
    """Covariance of independent points of ``sigma_um``, or from u_um of the file; None where neither says it."""
    return stated(file) if sigma_um is None else independent(np.full(len(file), sigma_um / 1000))


def noise_of_points(file: FlankFile, member: Member, found: MemberEvaluation, sigma_um: float | None) -> float | None:
    """Noise [mm] of a judged deviation at which settings are chosen: ``sigma_um``, or else by u_um of the file.

    None where neither says it: then it is what the settings leave.
    """
    if sigma_um == 0:
        return 0.0
    covariance = point_covariance(file, sigma_um)
    if covariance is None:
        return None
    return noise_of(member, found.file, covariance.carried(judged_by_measured(file, member, found)))


def uncertain_correction(
    member: Member, file: FlankFile, found: MemberEvaluation, covariance: Covariance, sigma_um: float | None
) -> tuple[MemberCorrection | None, list[Uncertain], dict[str, Effect], list[str]]:
    """The correction of an evaluated member by the fewest settings, these with uncertainties, what errors of
    measurement do to each flank, and remarks: where there is no correction, why.
    """
    judged = covariance.carried(judged_by_measured(file, member, found))
    try:
        found.closing.check_topography()
        correction = correct(
            member,
            found.file,
            few=True,
            noise=noise_of_points(file, member, found, sigma_um),
            indexed=found.closing.withheld is None,
        )
        settings, effects = uncertain_settings(member, found.file, correction, judged)
    except (InputError, ComputationError) as error:
        return None, [], {}, [f"no corrected settings: {error}"]
    return correction, settings, effects, list(correction.remarks)

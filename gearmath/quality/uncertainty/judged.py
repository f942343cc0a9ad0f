"""From what was measured to what is judged: points left out; drift, clamping and rotation taken out, as a linear map.

What ``evaluation`` does to a file, to first order in its deviations; the places of the points count as fixed.
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np

from gearmath.quality.evaluation.drift import without_drift
from gearmath.quality.evaluation.member import MemberEvaluation
from gearmath.quality.evaluation.nominal import completed
from gearmath.quality.evaluation.outliers import find_outliers
from gearmath.specs.bevel_set import Member
from gearmath.specs.flank_csv import FlankFile


def judging_of(file: FlankFile, member: Member, found: MemberEvaluation) -> tuple[ca.Function, np.ndarray]:
    """What is judged, as a function of the deviations measured, and its constant Jacobian (q,n).

    Judged are the deviations of the evaluated file, zero where there are none, then the four components of the seat and
    the rotation common to both flanks.
    """
    at, n = np.nan_to_num(file.deviation), len(found.file)
    slope = np.zeros((n + 5, len(file)))
    slope[:n] = _without_drift(file, member, found)
    deviation = ca.MX.sym("deviation", len(file))
    change = ca.mtimes(ca.sparsify(ca.DM(slope[:n])), deviation - ca.DM(at))
    seat, turn = ca.MX.zeros(4), ca.MX.zeros(1)
    if found.registration is not None:
        gain, columns = found.registration.gain, found.registration.columns
        moved = ca.mtimes(ca.DM(gain), change)
        seat = ca.DM(found.registration.seat) + moved
        slope[n : n + 4] = gain @ slope[:n]
        if found.taken_out is not None:
            change -= ca.mtimes(ca.DM(columns), moved)
            slope[:n] -= columns @ slope[n : n + 4]
    if found.rotation is not None:
        turned = ca.mtimes(ca.DM(found.rotation.gain).T, change)
        turn = found.rotation.angle + turned
        change -= ca.DM(found.rotation.column) * turned
        slope[n + 4] = found.rotation.gain @ slope[:n]
        slope[:n] -= np.outer(found.rotation.column, slope[n + 4])
    now = ca.DM(np.nan_to_num(found.file.deviation)) + change
    return ca.Function("judging", [deviation], [ca.vertcat(now, seat, turn)], ["deviation"], ["judged"]), slope


def judged_by_measured(file: FlankFile, member: Member, found: MemberEvaluation) -> np.ndarray:
    """How the deviations (m,) that were judged depend on those measured (n,): (m,n)."""
    _, slope = judging_of(file, member, found)
    return np.where(np.isfinite(found.file.deviation)[:, None], slope[: len(found.file)], 0.0)


def _without_drift(file: FlankFile, member: Member, found: MemberEvaluation) -> np.ndarray:
    """How the deviations without outliers and drift (m,) depend on those measured (m,n).

    Taking out the drift is linear and homogeneous, so that unit deviations of the nominal points give the columns.
    """
    complete, _ = completed(file, member)
    whole = find_outliers(found.closing.straightened(complete), member.teeth).without(complete)
    known = np.isfinite(whole.deviation)
    kept = whole.tooth < member.teeth
    matrix = (np.eye(len(whole)) * known)[kept][:, : len(file)]
    nominal = nominal_points_of(whole)
    twice = np.isin(whole.tooth, (0, member.teeth)) & known & bool((~kept).any())
    for k in np.flatnonzero(twice[: len(file)]):
        unit = np.where(known, np.eye(len(whole))[k], np.nan)
        moved = replace(whole, deviation=unit, point=nominal + np.nan_to_num(unit)[:, None] * whole.normal)
        matrix[:, k] = np.nan_to_num(without_drift(moved, member.teeth, found.closing.course)[0].deviation)
    return matrix


def nominal_points_of(file: FlankFile) -> np.ndarray:
    """The nominal points (n,3) of a file, as its own deviations and normals say."""
    return file.point - np.nan_to_num(file.deviation)[:, None] * file.normal

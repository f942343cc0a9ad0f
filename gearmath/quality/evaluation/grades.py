"""The grades of a member: of what is known of every tooth, and surer than the step from one grade to the next."""

from __future__ import annotations

import math
from collections.abc import Mapping

from gearmath.quality.evaluation.closing import Closing
from gearmath.quality.evaluation.pitch import Pitch
from gearmath.quality.evaluation.spaces import Runout
from gearmath.quality.evaluation.tolerance import GRADES, Verdict, iso17485, judge
from gearmath.specs.bevel_set import FLANKS, Member


def grade_member(
    member: Member,
    pitches: Mapping[str, Pitch],
    runout: Runout | None,
    closing: Closing,
    uncertainties: Mapping[str, float],
    doubt: str | None = None,
    rounded: float = 0.0,
) -> Verdict | None:
    """The grade of pitch and runout, of what is known of every tooth; None where pitch was not measured.

    There is none where a drift that was taken out is larger than the tolerance of the grade, nor of a figure in which
    it may have left more than the step to the next grade; none of a runout that noise of the points alone makes as
    large, and none of a figure whose standard uncertainty (``uncertainties`` of the pitch of each flank [mm]) is larger
    than the step to the next grade. There is none at all where ``doubt`` says why, and none of a figure whose step to
    the next grade is less than that to which the file is ``rounded`` [mm].
    """
    if not pitches:
        return None
    if doubt is not None:
        return judge(member, {}, dict.fromkeys(("f_pt", "F_p", "F_r"), doubt))
    whole = {flank: pitch for flank, pitch in pitches.items() if pitch.withheld is None}
    of_flanks = {flank: {"f_pt": pitch.largest_single, "F_p": pitch.total} for flank, pitch in whole.items()}
    measured, withheld = {}, {}
    gaps = [
        pitches[flank].withheld or "" if flank in pitches else f"{flank} flank: pitch was not measured"
        for flank in FLANKS
        if flank not in whole
    ]
    for key in ("f_pt", "F_p"):
        if gaps:
            withheld[key] = "; ".join(dict.fromkeys(gaps))
        else:
            measured[key] = max(one[key] for one in of_flanks.values())
    if runout is None or runout.withheld is not None:
        withheld["F_r"] = "no two spaces have readings on both flanks" if runout is None else str(runout.withheld)
    elif runout.of_noise[0] >= runout.total > 0:
        withheld["F_r"] = (
            f"noise of the points alone gives F_r {runout.of_noise[0] * 1000:.2f} um, and {runout.total * 1000:.2f} um "
            "were read"
        )
    else:
        measured["F_r"] = runout.total
    verdict = judge(member, measured, withheld, of_flanks)
    grade, drift = verdict.grades.get("F_p"), closing.arc * 1000
    if closing.kind == "steady" and grade is not None and drift > (limit := _tolerance(verdict, "F_p", grade)):
        why = f"the drift of {drift:.1f} um that was taken out is larger than F_p {limit:g} um of grade {grade}"
        return judge(member, {}, dict.fromkeys(("f_pt", "F_p", "F_r"), why))
    of_pitch = max((value for value in uncertainties.values() if math.isfinite(value)), default=math.nan)
    unsure = {"f_pt": of_pitch, "F_p": of_pitch, "F_r": math.nan if runout is None else runout.uncertainty}
    # of a parabola over all teeth, the steepest part lies between two of them
    of_drift = {"F_p": closing.curved, "f_pt": closing.curved * 4 / member.teeth}
    for key in tuple(measured):
        if why := (
            _too_unsure(verdict, key, unsure[key] * 1000)
            or _too_coarse(verdict, key, rounded * 1000)
            or _left_by_drift(verdict, key, of_drift.get(key, 0.0) * 1000)
        ):
            withheld[key] = why
            del measured[key]
            of_flanks = {flank: {k: v for k, v in one.items() if k != key} for flank, one in of_flanks.items()}
    return judge(member, measured, withheld, of_flanks)


def _too_unsure(verdict: Verdict, key: str, u: float) -> str:
    """Why a figure of standard uncertainty ``u`` [um] has no grade; nothing where it has one, or u is not known."""
    words, step = _next_grade(verdict, key)
    return f"its standard uncertainty of {u:.1f} um is larger than {words}" if u > step else ""


def _too_coarse(verdict: Verdict, key: str, rounded: float) -> str:
    """Why a figure of a file that is rounded to so much [um] has no grade; nothing where it has one."""
    words, step = _next_grade(verdict, key)
    return f"the file is rounded to {rounded:g} um, more than {words}" if rounded > step else ""


def _left_by_drift(verdict: Verdict, key: str, left: float) -> str:
    """Why a figure has no grade in which a drift may have left so much [um]; nothing where it has one."""
    words, step = _next_grade(verdict, key)
    return (
        f"a drift that slowed down or sped up may have left {left:.1f} um in it, more than {words}"
        if left > step
        else ""
    )


def _next_grade(verdict: Verdict, key: str) -> tuple[str, float]:
    """The step [um] from the grade of a figure to the next coarser one, in words too; infinite where it has none."""
    grade = verdict.grades.get(key)
    if grade is None:
        return "", math.inf
    fine, coarse = (grade, grade + 1) if grade < GRADES[-1] else (grade - 1, grade)
    step = _tolerance(verdict, key, coarse) - _tolerance(verdict, key, fine)
    return f"the step of {step:g} um from grade {fine} to {coarse}", step


def _tolerance(verdict: Verdict, key: str, grade: int) -> float:
    return iso17485(verdict.data.mean_normal_module, verdict.data.tolerance_diameter, grade).rounded[key]

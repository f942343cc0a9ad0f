"""What a whole measurement looks like that is no error of the gear: said before any figure and any correction.

A wrong radius of the tip, or a wrong zero, moves all points of both flanks out alike; work that is clamped off
along its axis moves them as one setting does; an uncertainty far below the scatter of the points is not that
of this measurement; teeth or flanks that agree to the last digit, where points scatter, were copied. Most of this
cannot be told from an error of the gear by points alone, so it is said, and nothing is taken out.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from gearmath.bevel.check_blank import transverse_module
from gearmath.bevel.check_mates import BACKLASH
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.quality.evaluation.axial import TWIN, axial_shift, explained_by
from gearmath.quality.evaluation.digits import no_measurement, said_of_digits
from gearmath.quality.evaluation.exchanged import exchanged_lines
from gearmath.quality.evaluation.nominal import nominal_rows
from gearmath.quality.evaluation.registration import Registration, stated_noise
from gearmath.quality.evaluation.rivals import rival_columns
from gearmath.quality.evaluation.topography import Topography
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.flank_csv import FlankFile

#: All points out by so much [mm] are worth a word where they are even: so much of it is the most that they differ by.
_LEAST_OFFSET, _EVEN = 0.05, 0.2
#: An axial shift is worth a word from here on [mm], from so many standard uncertainties, and where it explains so much
#: of the squares of the form.
_LEAST_AXIAL, _SIGNIFICANT, _EXPLAINS = 0.02, 3.0, 0.8
#: ... or where form and thickness, which other settings change in other proportions, agree on it to this part, the form
#: by so many standard uncertainties.
_AGREE, _SURE = 0.3, 4.0
#: ... and where no error of another setting, and no even offset, explains it as well; those that leave less than so
#: many times its squares are named.
_NEARLY = 1.5
#: Points of a grid that tell fifteen terms of a surface of fourth degree and the noise beside them.
_LEAST_POINTS = 30
#: So many times the stated uncertainty is no chance, and less than so much [mm] is rounding of the file.
_FAR, _ROUNDED = 3.0, 2e-5
#: Teeth that scatter by less [mm] are alike; less scatter on a grid [mm] is none of a probe.
_LEAST_UNLIKE, _SCATTERS = 3e-3, 5e-5
#: So much of the values of a tooth are different ones, or they are rounded too coarsely to tell copies.
_FINE = 0.3
#: Points that agree to the last digit by no chance, and pairs of teeth that are named.
_LEAST_SAME, _MOST_NAMED = 2, 4


@dataclass(frozen=True)
class Suspicions:
    """Sentences on a measurement, and why it has no grade; None where nothing of it stands against one."""

    said: tuple[str, ...]
    no_grade: str | None


def suspicions(
    raw: FlankFile,
    file: FlankFile,
    member: Member,
    flanks: dict[str, tuple[Topography, ...]],
    seat: Registration | None,
) -> Suspicions:
    """What a measurement looks like: ``raw`` as read, ``file`` without clamping and rotation, ``flanks`` in full."""
    axial = tuple(_axial(_in_full(file, flanks), member))
    too_far = None if axial else _beyond_backlash(file, member, flanks)
    offset = () if axial else tuple(_offset(flanks, too_far))
    scatter = min((_noise(each[0]) for each in flanks.values() if each), default=math.nan)
    lines = [line for each in flanks.values() if each for line in exchanged_lines(raw, each[0])]
    of_points = (*said_of_digits(raw), *lines, *_scatter(file, scatter, seat), *_copies(raw, scatter))
    return Suspicions((*axial, *offset, *of_points), no_measurement(raw) or too_far)


def _offset(flanks: dict[str, tuple[Topography, ...]], too_far: str | None) -> Iterator[str]:
    """Whether all points of both flanks are out alike, and whether ``too_far``."""
    found = _even_offset(flanks)
    if found is not None:
        also = f"; {too_far}" if too_far else ""
        yield (
            f"all points of both flanks stand {found[0] * 1000:+.0f} um out, evenly within {found[1] * 1000:.0f} um: a "
            "wrong tip radius or zero of the probe does that, a depth of cut, or even stock; check it before a setting "
            f"is corrected for it{also}"
        )


def _even_offset(flanks: dict[str, tuple[Topography, ...]]) -> tuple[float, float] | None:
    """Offset of all points of both flanks, and how even it is [mm]; None where there is none."""
    firsts = [each[0].deviation for each in flanks.values() if each]
    if len(firsts) != len(FLANKS):
        return None
    means = [float(np.nanmean(one)) for one in firsts]
    spread = max(float(np.nanstd(one)) for one in firsts)
    spread = max(spread, abs(means[0] - means[1]) / 2)
    mean = sum(means) / len(means)
    return (mean, spread) if abs(mean) >= _LEAST_OFFSET and spread <= _EVEN * abs(mean) else None


def _beyond_backlash(file: FlankFile, member: Member, flanks: dict[str, tuple[Topography, ...]]) -> str | None:
    """Why an even offset is more than a finished pair can have; None where it is not."""
    found = _even_offset(flanks)
    if found is None:
        return None
    (_, lever) = kernel("flank_turning")(1.0, file.point, file.normal)
    arcs = [float(np.median(np.abs(lever[file.flank == flank]))) for flank in FLANKS]
    change, limit = sum(arcs) * abs(found[0]), BACKLASH[1] * transverse_module(member)
    if change <= limit:
        return None
    return (
        f"it changes the tooth thickness by {change:.3g} mm, more than the backlash of any finished pair, "
        f"{limit:.3g} mm, {BACKLASH[1]:g} of the module"
    )


def _in_full(file: FlankFile, flanks: dict[str, tuple[Topography, ...]]) -> FlankFile:
    """The first tooth of each flank that was measured in full: how uneven the teeth are does not count."""
    keep = np.zeros(len(file), dtype=bool)
    for flank, found in flanks.items():
        if found:
            keep |= (file.flank == flank) & (file.tooth == found[0].tooth)
    return file.pick(keep)


def _axial(file: FlankFile, member: Member) -> Iterator[str]:
    """Whether most of the form is what a shift along the axis of the work does."""
    rows = nominal_rows(file, member)
    used = np.isfinite(file.deviation)
    if any((used & (file.flank == flank)).sum() < _LEAST_POINTS for flank in FLANKS):
        return
    columns = kernel("motion_sensitivity")(rows.point, rows.normal)[0]
    found = axial_shift(file, member, rows, columns)
    sure = abs(found.shift) / found.uncertainty if found.uncertainty > 0 else math.inf
    if not (abs(found.shift) >= _LEAST_AXIAL and sure >= _SIGNIFICANT):
        return
    apart = abs(found.together - found.shift)
    if found.explains >= _EXPLAINS:
        why = f"which explains {100 * found.explains:.0f} % of the form (sum of squares)"
    elif sure >= _SURE and apart <= min(_SIGNIFICANT * found.uncertainty, _AGREE * abs(found.together)):
        why = (
            f"as both form and tooth thickness ask for ({found.shift * 1000:+.0f} and {found.together * 1000:+.0f} um)"
        )
    else:
        return
    rivals = _rivals(file, member, columns, found.explains >= _EXPLAINS)
    if rivals is None:
        return
    also = f", and one of {' or '.join(rivals)} nearly so" if rivals else ""
    yield (
        f"the work may be clamped {found.shift * 1000:+.0f} um off along its axis, {why}; an error of {TWIN} looks "
        f"the same{also}: check the clamping before a setting is corrected for it"
    )


def _rivals(file: FlankFile, member: Member, columns: np.ndarray, by_form: bool) -> list[str] | None:
    """What explains a file nearly as well as an axial shift, column 2 of (18.2); None where something does better.

    ``by_form``, of the form; else of form and thickness together, where its own sizes agree on both.
    """
    axial = explained_by(columns[:, 2], file, columns)
    near: dict[str, float] = {}
    try:
        others = list(rival_columns(file, member))
    except InputError:
        return None
    for key, column in others:
        rival = explained_by(column, file, columns)
        if by_form:
            left = rival.left_of_form / axial.left_of_form
        elif abs(rival.together - rival.of_form) <= _AGREE * abs(rival.together):
            left = rival.left / axial.left
        else:
            continue
        if left <= 1:
            return None
        near[key] = min(left, near.get(key, math.inf))
    return sorted((key for key, left in near.items() if left <= _NEARLY), key=lambda key: near[key])[:_MOST_NAMED]


def _scatter(file: FlankFile, on_grid: float, seat: Registration | None) -> Iterator[str]:
    """Whether the points scatter far more than their uncertainty says, or those of many teeth than those of one."""
    stated, of_teeth = stated_noise(file), math.nan if seat is None else seat.noise
    scatter = np.nanmin([on_grid, of_teeth, math.inf])
    if math.isfinite(scatter) and scatter > _FAR * max(stated, _ROUNDED):
        yield (
            f"u_um of the file, {stated * 1000:.3g} um, is far below the scatter of its points, {scatter * 1000:.2f} "
            "um: all uncertainties that follow from it are too small"
        )
    if of_teeth > max(_FAR * on_grid, _LEAST_UNLIKE):
        yield (
            f"points scatter by {of_teeth * 1000:.1f} um from tooth to tooth, and by {on_grid * 1000:.2f} um on the "
            "grid of a tooth: form that differs between the teeth, dirt, or a part of the run that was disturbed"
        )


def _copies(file: FlankFile, scatter: float) -> Iterator[str]:
    """Teeth, flanks or points touched again that agree to the last digit, where the points scatter."""
    exact = np.round(file.deviation, 6)
    numbers, counts = np.unique(file.tooth[np.isfinite(exact)], return_counts=True)
    fullest = exact[np.isfinite(exact) & (file.tooth == numbers[np.argmax(counts)])]
    if not scatter > _SCATTERS or len(np.unique(fullest)) < _FINE * len(fullest):
        return
    places = zip(file.flank.tolist(), file.tooth.tolist(), file.row.tolist(), file.col.tolist(), strict=True)
    at = {place: value for place, value in zip(places, exact.tolist(), strict=True) if math.isfinite(value)}
    teeth = sorted({tooth for _, tooth, _, _ in at})
    of = {tooth: {(f, r, c): value for (f, t, r, c), value in at.items() if t == tooth} for tooth in teeth}
    copied = [(one, two) for k, one in enumerate(teeth) for two in teeth[k + 1 :] if _is_copy(of[one], of[two])]
    if copied:
        words = ", ".join(f"{one} and {two}" for one, two in copied[:_MOST_NAMED])
        yield f"teeth {words} have the same deviations to the last digit, which no measurement gives: were they copied?"
    concave, convex = ({(t, r, c): value for (f, t, r, c), value in at.items() if f == flank} for flank in FLANKS)
    if _is_copy(concave, convex):
        yield "both flanks have the same deviations to the last digit, which no measurement gives: was one copied?"


def _is_copy(one: dict[tuple, float], two: dict[tuple, float]) -> bool:
    """Whether the deviations at all common places, two or more, are the same."""
    common = one.keys() & two.keys()
    return len(common) >= _LEAST_SAME and all(one[place] == two[place] for place in common)


def _noise(topography: Topography) -> float:
    """What a surface of fourth degree leaves of a flank, for each spare point [mm]; NaN where they are too few."""
    known = np.isfinite(topography.deviation)
    values = topography.deviation[known]
    if len(values) < _LEAST_POINTS:
        return math.nan
    x, y = (each[known] / np.abs(each).max() for each in (topography.along, topography.upward))
    surface = np.stack([x**i * y**j for i in range(5) for j in range(5 - i)], axis=1)
    left = values - surface @ np.linalg.lstsq(surface, values, rcond=None)[0]
    return float(np.sqrt(left @ left / (len(values) - surface.shape[1])))

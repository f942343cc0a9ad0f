"""What a whole measurement looks like that is no error of the gear: said before any figure and any correction.

A wrong radius of the tip, or a wrong zero, moves all points of both flanks out alike; work that stands off its seat
along its axis moves them as one setting does; an uncertainty far below the scatter of the points is not that of this
measurement. None of them can be told from an error of the gear by points alone, so they are said, and nothing is taken
out.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from gearmath.kernels import kernel
from gearmath.quality.evaluation.axial import TWIN, axial_shift
from gearmath.quality.evaluation.nominal import nominal_rows
from gearmath.quality.evaluation.registration import Registration, stated_noise
from gearmath.quality.evaluation.topography import Topography
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.flank_csv import FlankFile

#: All points out by so much [mm] are worth a word where they are even: so much of it is the most that they differ by.
_LEAST_OFFSET, _EVEN = 0.05, 0.2
#: An axial shift is worth a word from here on [mm], from so many standard uncertainties, and where it explains so much
#: of the squares of the form.
_LEAST_AXIAL, _SIGNIFICANT, _EXPLAINS = 0.02, 3.0, 0.8
#: Points of a grid that tell fifteen terms of a surface of fourth degree and the noise beside them.
_LEAST_POINTS = 30
#: So many times the stated uncertainty is no chance, and less than so much [mm] is rounding of the file.
_FAR, _ROUNDED = 3.0, 2e-5


def suspicions(
    file: FlankFile, member: Member, name: str, flanks: dict[str, tuple[Topography, ...]], seat: Registration | None
) -> tuple[str, ...]:
    """Sentences on a measurement; ``file`` is without clamping and rotation, ``flanks`` its teeth in full."""
    offset = tuple(_offset(flanks))
    return (*offset, *([] if offset else _axial(_in_full(file, flanks), member, name)), *_scatter(file, flanks, seat))


def _offset(flanks: dict[str, tuple[Topography, ...]]) -> Iterator[str]:
    """Whether all points of both flanks are out alike."""
    firsts = [each[0].deviation for each in flanks.values() if each]
    if len(firsts) != len(FLANKS):
        return
    means = [float(np.nanmean(one)) for one in firsts]
    spread = max(float(np.nanstd(one)) for one in firsts)
    spread = max(spread, abs(means[0] - means[1]) / 2)
    mean = sum(means) / len(means)
    if abs(mean) >= _LEAST_OFFSET and spread <= _EVEN * abs(mean):
        yield (
            f"all points of both flanks stand {mean * 1000:+.0f} um out, evenly within {spread * 1000:.0f} um: a wrong "
            "tip radius or zero of the probe does that, or even stock; check it before a setting is corrected for it"
        )


def _in_full(file: FlankFile, flanks: dict[str, tuple[Topography, ...]]) -> FlankFile:
    """The first tooth of each flank that was measured in full: how uneven the teeth are does not count."""
    keep = np.zeros(len(file), dtype=bool)
    for flank, found in flanks.items():
        if found:
            keep |= (file.flank == flank) & (file.tooth == found[0].tooth)
    return file.pick(keep)


def _axial(file: FlankFile, member: Member, name: str) -> Iterator[str]:
    """Whether most of the form is what a shift along the axis of the work does."""
    rows = nominal_rows(file, member, name)
    used = np.isfinite(file.deviation)
    if any((used & (file.flank == flank)).sum() < _LEAST_POINTS for flank in FLANKS):
        return
    columns = kernel("motion_sensitivity")(rows.point, rows.normal)[0]
    found = axial_shift(file, member, name, rows, columns)
    if not abs(found.shift) >= max(_LEAST_AXIAL, _SIGNIFICANT * np.nan_to_num(found.uncertainty)):
        return
    if found.explains >= _EXPLAINS:
        yield (
            f"the work may stand {found.shift * 1000:+.0f} um off its seat along the axis, which explains "
            f"{100 * found.explains:.0f} % of the form (sum of squares); an error of {TWIN} looks the same: check the "
            "seat before a setting is corrected for it"
        )


def _scatter(file: FlankFile, flanks: dict[str, tuple[Topography, ...]], seat: Registration | None) -> Iterator[str]:
    """Whether the points scatter far more than their uncertainty says."""
    stated = stated_noise(file)
    found = [_noise(each[0]) for each in flanks.values() if each]
    if seat is not None:
        found.append(seat.noise)
    scatter = min((one for one in found if math.isfinite(one)), default=math.nan)
    if scatter > _FAR * max(stated, _ROUNDED):
        yield (
            f"u_um of the file, {stated * 1000:.3g} um, is far below the scatter of its points, {scatter * 1000:.2f} "
            "um: all uncertainties that follow from it are too small"
        )


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

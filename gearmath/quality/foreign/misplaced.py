"""Whether points of another measuring machine stand as their options say, and what else would explain them.

A flank that was cut right has a form of some micrometres. Where points are farther off than that once they are turned,
and a tip radius, a shift or a tilt of the axis takes most of that away, it is named. One flank does not tell these from
its form; both flanks of a tooth do. A scale of the lengths is named beside the form, too, where either flank by itself
asks for about the same size: by chance two flanks hardly do; another radial distance makes flanks nearly like it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearmath.bevel.turning import turned
from gearmath.errors import InputError
from gearmath.quality.foreign.points import LARGEST_FORM, SAME_TOOTH, Frame, PointPart, lay
from gearmath.specs.bevel_set import FLANKS, Member

#: Points that are farther off than this, in RMS, are said to be; those of both flanks from the smaller one on, where a
#: cause explains them. [mm]
LARGEST_RMS, _LEAST_RMS = 0.01, 0.004
#: A cause is named where it leaves this part of the RMS, with both flanks also at most so many times what the best one
#: leaves, as the form of the flanks does not tell those apart. Less than a form does is explained where no more than
#: so much is left of it. No tip is smaller than the last [mm].
_LEAVES, _NEARLY_BEST, _EXPLAINED, _LEAST_TIP = 0.6, 1.5, 0.4, 0.1
#: A scale is named beside the form of the flanks where it leaves this part of the RMS, and at most so many times what
#: another cause leaves; where either flank by itself asks for at least this part of what the other does; and from this
#: size on: no temperature of a shop makes so much.
_SCALE_LEAVES, _SCALE_NEARLY_BEST, _SCALE_ALIKE, _LEAST_SCALE = 0.75, 1.2, 0.4, 5e-4
#: No tooth is measured with so much stock on both flanks: the radius of the tip was forgotten. [mm]
_LARGEST_STOCK = 0.5
#: Fits of a cause, and least-squares steps within each to least absolute values.
_FITS, _STEPS = 4, 8
#: Columns of the motion, shifts [mm] and turns [rad] about x y z, then the radius of the tip [mm], and a scale less 1.
_APEX, _TURN, _TIP, _SCALE = 2, 5, 6, 7
_CAUSES = {"tip": (_TIP,), "apex": (_APEX,), "shift": (0, 1), "tilt": (3, 4), "scale": (_SCALE,)}


@dataclass(frozen=True)
class _Fit:
    """The motion (8,) that a cause takes out, and how far off the points then lie, in RMS [mm]."""

    motion: np.ndarray
    rms: float


def check_placed(parts: Sequence[PointPart], turns: Sequence[float], frame: Frame, member: Member) -> str:
    """What to say of parts that lie farther off their flanks than a form does, and the likeliest causes; or nothing.

    The parts share one turning. Raises InputError where both flanks lie so far out that the radius of the tip is wrong.
    """
    before = _fit(parts, turns, frame, member, ())
    both = len({part.flank for part in parts}) > 1
    if before.rms <= (_LEAST_RMS if both else LARGEST_RMS):
        return ""
    fits = {cause: _fit(parts, turns, frame, member, columns) for cause, columns in _CAUSES.items()}
    if frame.tip_radius + fits["tip"].motion[_TIP] < _LEAST_TIP:
        del fits["tip"]
    best = min(one.rms for one in fits.values())
    most = min(_NEARLY_BEST * best, _LEAVES * before.rms) if both else _LEAVES * before.rms
    named = sorted((cause for cause in fits if fits[cause].rms <= most), key=lambda cause: fits[cause].rms)
    whose = parts[0].name if len(parts) == 1 else f"{parts[0].name} and {len(parts) - 1} more"
    far = f"{whose}: after turning, points lie {before.rms * 1000:.1f} um RMS off the nominal flank"
    if both and "tip" in named and abs(fits["tip"].motion[_TIP]) > _LARGEST_STOCK:
        raise InputError(
            f"{far}, {fits['tip'].rms * 1000:.1f} um with {_words('tip', fits['tip'], frame)}: are the points contact "
            "points, or centers of the probe tip?"
        )
    # a form of few micrometres, and teeth that are too thick by so little, are none of the clamping
    if before.rms <= LARGEST_RMS and (best > _EXPLAINED * before.rms or set(named) <= {"tip"}):
        return _scale_words(parts, turns, frame, member, before, fits) if both else ""
    if not named:
        return f"{far}: is it of this set, and does it stand on the axis of the file?"
    words = " or ".join(_words(cause, fits[cause], frame) for cause in named)
    why = "how was the work clamped?" if both else "one flank does not tell this from its form, both flanks do"
    return f"{far}; {words} would leave {fits[named[0]].rms * 1000:.1f} um: {why}"


def _scale_words(
    parts: Sequence[PointPart],
    turns: Sequence[float],
    frame: Frame,
    member: Member,
    before: _Fit,
    fits: dict[str, _Fit],
) -> str:
    """What to say of a scale that both flanks ask for beside their form; nothing where another cause leaves less."""
    scale = fits["scale"]
    others = min(one.rms for cause, one in fits.items() if cause != "tip")
    if scale.rms > min(_SCALE_LEAVES * before.rms, _SCALE_NEARLY_BEST * others):
        return ""
    sizes = []
    for flank in FLANKS:
        mine = [k for k, part in enumerate(parts) if part.flank == flank]
        fit = _fit([parts[k] for k in mine], [turns[k] for k in mine], frame, member, _CAUSES["scale"])
        sizes.append(float(fit.motion[_SCALE]))
    least, most = sorted(sizes, key=abs)
    if abs(scale.motion[_SCALE]) < _LEAST_SCALE or least / most < _SCALE_ALIKE:
        return ""
    by_flank = " and ".join(f"the {flank} one {size * 100:+.2f} %" for flank, size in zip(FLANKS, sizes, strict=True))
    return (
        f"{parts[0].name} and {len(parts) - 1} more: after turning, points lie {before.rms * 1000:.1f} um RMS off the "
        f"nominal flank, {scale.rms * 1000:.1f} um with points that are too far from the origin by "
        f"{scale.motion[_SCALE] * 100:+.2f} %; either flank says so by itself, {by_flank}: are the lengths of the file "
        "true, or was the work cut with other settings?"
    )


def _words(cause: str, fit: _Fit, frame: Frame) -> str:
    across, tilt = float(np.hypot(*fit.motion[:2])), float(np.degrees(np.hypot(*fit.motion[3:5])))
    return {
        "tip": f"--tip-radius {frame.tip_radius + fit.motion[_TIP]:.2f}",
        "apex": f"--apex-offset {frame.apex_offset - fit.motion[_APEX]:.2f}",
        "shift": f"work that stands {across:.2f} mm beside the axis",
        "tilt": f"work that is tilted by {tilt:.2f} degrees",
        "scale": f"points that are too far from the origin by {fit.motion[_SCALE] * 100:+.2f} %",
    }[cause]


def _fit(
    parts: Sequence[PointPart], turns: Sequence[float], frame: Frame, member: Member, columns: tuple[int, ...]
) -> _Fit:
    """Least absolute distances from the flank, with the rotation about the axis free, too."""
    free = [_TURN, *columns]
    motion, rms = np.zeros(_SCALE + 1), []
    placed, origin = [frame.placed(part.point) for part in parts], np.array([0.0, 0.0, frame.apex_offset])
    for _ in range(_FITS):
        tried = Frame(tip_radius=frame.tip_radius + motion[_TIP])
        terms, off = [], []
        for part, point, turn in zip(parts, placed, turns, strict=True):
            laid = lay(replace(part, point=point, normal=None), tried, member, turn)
            angle = turn + 2 * np.pi * part.tooth / member.teeth
            foot, normal = turned(laid.foot, angle), turned(laid.normal, angle)
            # what a motion of the points adds to their distances along the normal
            scale = np.sum((foot - origin) * normal, axis=1)
            terms.append(np.column_stack([normal, np.cross(foot, normal), np.ones(len(foot)), scale]))
            off.append(laid.deviation)
        if not sum(map(len, off)):  # moved off the flank altogether
            return _Fit(motion, np.inf)
        change, left = _least_absolute(np.concatenate(terms)[:, free], np.concatenate(off))
        rms.append(float(np.sqrt(np.mean(left**2))))
        step = np.zeros(_SCALE + 1)
        step[free] = change
        motion += step
        placed = [point - step[:3] - np.cross(step[3:6], point) - step[_SCALE] * (point - origin) for point in placed]
    return _Fit(motion, rms[-1])


def _least_absolute(terms: np.ndarray, off: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients and what they leave (n,): single bad points do not count."""
    scale, weight = np.linalg.norm(terms, axis=0), np.ones(len(off))
    for _ in range(_STEPS):
        change = np.linalg.lstsq(terms / scale * weight[:, None], off * weight, rcond=None)[0] / scale
        left = off - terms @ change
        weight = 1 / np.sqrt(np.maximum(np.abs(left), 1e-6))
    return change, left


def kept_words(part: PointPart, turn: float, frame: Frame, member: Member) -> str:
    """What to say of a part that is kept as it stands, but turned against the set by more than a tooth is off.

    Raises InputError where it would be of another tooth.
    """
    against = (
        f"{part.name}: its {part.flank} flank is turned by {np.degrees(turn):.3f} degrees against tooth {part.tooth} "
        "of the set"
    )
    if abs(turn) > SAME_TOOTH * 2 * np.pi / member.teeth:
        raise InputError(f"{against}: --phase kept needs points that stand as the set has them")
    off = float(np.median(np.abs(turn * lay(part, frame, member, turn).lever)))
    if off < LARGEST_FORM:
        return ""
    return f"{against}, by {off * 1000:.0f} um on the flank: it is kept so; --phase common takes the rotation out"

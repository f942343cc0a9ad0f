"""Crownings and bias that a designed flank has over all that its mate reaches, and what is to be said where it misses.

At the vertex point, normal and curvature are those that were asked for. What the settings cannot follow beyond there
changes the crownings of the whole flank, or stays beside them.
"""

from __future__ import annotations

import numpy as np

from gearmath.bevel.design.request import Request, face_and_depth
from gearmath.bevel.ease_off import ease_off
from gearmath.bevel.flank import Grid
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import BevelSet
from gearmath.specs.design import CROWNINGS, ContactRequest

#: So much is no miss yet [um], nor is this part of the smaller crowning: half of it makes another shape of pattern.
_OFF, _PART = 5.0, 0.5


def crownings(pair: BevelSet, flank: str, where: Request, asked: ContactRequest) -> dict[str, dict[str, float]] | None:
    """Lengthwise crowning, profile crowning and bias of a flank, asked and found [um], by name; None if none is asked.

    Found by least squares over the whole flank, in the terms of (27.7) beside slopes and a constant.
    """
    if asked.lengthwise_crowning is None:
        return None
    pinion, gear = pair.member("pinion"), pair.member("gear")
    axial, radial = where.places
    gap = ease_off(pinion, gear, pair.rad("shaft_angle"), flank, Grid(axial[:, None], radial[:, None])).ravel()
    size = face_and_depth(gear.blank)
    terms = [kernel("crowned_gap")(*where.from_vertex, *size, *unit)[0] for unit in np.eye(len(CROWNINGS))]
    matrix = np.column_stack([*terms, *where.from_vertex, np.ones(len(gap))])
    kept = np.isfinite(gap)
    found, *_ = np.linalg.lstsq(matrix[kept], 1000 * gap[kept], rcond=None)
    return {
        name: {"asked": getattr(asked, name), "found": float(value)}
        for name, value in zip(CROWNINGS, found, strict=False)
    }


def miss(rms: float, found: dict[str, dict[str, float]] | None) -> str:
    """What to say of a flank that is off its crownings by ``rms`` [um], or whose own are others; empty where it is as
    asked."""
    if found is None:
        return ""
    least = min(found[name]["asked"] for name in CROWNINGS[:2])
    most = max(_OFF, _PART * least)
    others = [name for name, one in found.items() if abs(one["found"] - one["asked"]) > most]
    if rms <= most and not others:
        return ""
    shown = ", ".join(f"{name} {found[name]['found']:.3g} um, asked {found[name]['asked']:g}" for name in others)
    return (
        f"the flank misses what was asked by {rms:.3g} um RMS, where {most:.3g} um are no miss"
        + (f" ({shown})" if shown else "")
        + ": away from the vertex the pattern is another one; more settings in pinion.free, or other crownings and "
        "bias, bring it nearer"
    )

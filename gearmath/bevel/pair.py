"""A set file as one physical pair: the only way in for a command.

Checked from what is cheap to what is dear: the blanks by their figures, the blades, then what the settings cut. The
nominal flanks are checked strictly, those of corrected settings by how far they may be off the nominal ones.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from gearmath.bevel.check_blade import check_blades, check_methods, check_offset
from gearmath.bevel.check_blank import check_blank, check_blanks, check_cones, check_mate, transverse_module
from gearmath.bevel.check_ease_off import check_ease_off
from gearmath.bevel.check_flank import CutFlank, check_grid, cut_flank
from gearmath.bevel.check_index import check_index
from gearmath.bevel.check_mates import CutFlanks, check_mates, check_space
from gearmath.bevel.check_motion import check_motions
from gearmath.bevel.method import actual_cut, nominal_cut
from gearmath.bevel.misfit import Misfit
from gearmath.bevel.tooth import mean_pitch_radius
from gearmath.errors import ComputationError, InputError
from gearmath.files import read_text
from gearmath.specs.bevel_set import FLANKS, MEMBERS, BevelSet, Member, load_bevel_set

#: What corrected settings may change of a flank at the mean point: either angle [degree], the arc over the module.
_CORRECTED_ANGLE, _CORRECTED_ARC = 2.0, 0.15
#: A value is advised where mates use no more of their limits than this.
_WELL = 0.7


def load_pair(path: Path) -> BevelSet:
    """Read a gear set that is one physical pair.

    Raises InputError naming file, member, flank, key, value and limit of what cannot be, and the usual slip without
    which the file would be a pair, where there is one.
    """

    def slip(refusal: str) -> str:
        from gearmath.bevel.slips import likely_slip  # only for what is refused

        try:
            return likely_slip(tomllib.loads(read_text(path)), refusal, _file_passes)
        except (ValueError, RecursionError):  # no TOML, which the refusal says
            return ""

    try:
        pair = load_bevel_set(path)
    except InputError as error:
        raise InputError(f"{error}{slip(str(error))}") from error
    try:
        check_pair(pair, slip)
    except InputError as error:
        unit = tomllib.loads(read_text(path)).get("unit", "mm")
        raise InputError(
            f"{path}: {error}" + ("" if unit == "mm" else f" (lengths in mm, the file has {unit})")
        ) from error
    return pair


def check_pair(pair: BevelSet, slip: Callable[[str], str] = lambda _: "") -> None:
    """Refuse a set that is no physical pair. Raises InputError naming member, flank, key, value and limit.

    ``slip`` says of a refusal without which slip there would be none, where that is known.
    """
    cut: dict[str, CutFlanks] = {name: {} for name in pair.members}
    try:
        _check(pair.members, pair.shaft_angle, cut)
    except Misfit as misfit:
        from gearmath.bevel.blame import likely
        from gearmath.bevel.blame_method import likely_method

        cause = ""
        if len(pair.members) == len(MEMBERS) and all(len(flanks) == len(FLANKS) for flanks in cut.values()):
            cause = likely_method(pair.members, lambda members: _passes(members, pair.shaft_angle))
        if not cause:
            text = str(misfit)
            cause = likely(
                pair.members, misfit.where, cut, lambda one: _passes(one, pair.shaft_angle), lambda: slip(text)
            )
        raise InputError(f"{misfit}{cause}") from misfit
    except InputError as error:
        raise InputError(f"{error}{slip(str(error))}") from error


def check_computed(pair: BevelSet) -> None:
    """The same for settings that were computed: no single one of them is to blame. Raises InputError."""
    try:
        _check(pair.members, pair.shaft_angle, {name: {} for name in pair.members})
    except Misfit as misfit:
        raise InputError(str(misfit)) from misfit


def check_corrected(pair: BevelSet) -> None:
    """Raise ComputationError where corrected settings cut no pair: what was measured is not to blame."""
    try:
        check_pair(pair)
    except InputError as error:
        raise ComputationError(
            f"the corrected settings cut no pair, nothing is written: {error}; name fewer settings to change"
        ) from error


def _file_passes(values: dict[str, Any], share: float) -> bool:
    """Whether the values of a set file are those of a pair that uses this part of what mates may differ by."""
    try:
        pair = BevelSet.from_file(values)
        _check(pair.members, pair.shaft_angle, {name: {} for name in pair.members}, share)
    except (ValueError, Misfit, InputError, ComputationError):
        return False
    return True


def _passes(members: dict[str, Member], shaft_angle: float) -> bool:
    """Whether members are a pair, and not one at the limit of what mates may differ by."""
    try:
        _check(members, shaft_angle, {name: {} for name in members}, _WELL)
    except (Misfit, InputError, ComputationError):
        return False
    return True


def _check(members: dict[str, Member], shaft_angle: float, cut: dict[str, CutFlanks], share: float = 1.0) -> None:
    """Refuse what is no pair; ``cut`` is filled with the flanks that are found. Raises InputError or Misfit.

    ``share`` is the part of their limits that mates may use.
    """
    pinion, gear = (members.get(name) for name in MEMBERS)
    if pinion is not None and gear is not None:
        check_cones(pinion, gear, shaft_angle)
    else:
        for member in members.values():
            check_mate(member, shaft_angle)
    for member in members.values():
        check_blank(member)
    if pinion is not None and gear is not None:
        check_blanks(pinion, gear, shaft_angle)
        check_methods(pinion, gear)
    for member in members.values():
        check_blades(member)
        check_motions(member)
    _check_cut(members, cut, share)
    if pinion is not None and gear is not None:
        check_ease_off(pinion, gear, math.radians(shaft_angle), share)


def _check_cut(members: dict[str, Member], cut: dict[str, CutFlanks], share: float) -> None:
    """Check what the settings cut; ``cut`` is filled with the flanks that are found."""
    spaces: dict[str, float] = {}
    for name, member in members.items():
        for flank in FLANKS:
            cut[name][flank] = cut_flank(member, flank, nominal_cut(member, flank))
        spaces[name] = check_space(member, cut[name])
        check_offset(member, sum(found.spiral_angle for found in cut[name].values()) / len(FLANKS))
    if len(members) == len(MEMBERS):
        check_mates(members, cut, spaces, share)
    gear = members.get("gear")
    pitch = 2 * math.pi * mean_pitch_radius(gear) / gear.teeth if gear is not None else math.nan
    backlash = sum(spaces.values()) - pitch if len(members) == len(MEMBERS) else None
    for member in members.values():
        check_index(member, backlash)
    for name, member in members.items():
        for flank in FLANKS:
            check_grid(member, flank)
            if member.flank(flank).design is not None:
                _check_corrected(member, flank, cut[name][flank])


def _check_corrected(member: Member, flank: str, nominal: CutFlank) -> None:
    """Corrected settings cut the nominal flank but for what a correction may need."""
    spec = member.flank(flank).model_copy(update={"design": None})
    corrected = member.model_copy(update={flank: spec})
    try:
        found = cut_flank(corrected, flank, actual_cut(member, flank), True)
        _check_change(member, flank, nominal, found)
    except Misfit as misfit:
        from gearmath.bevel.blame import most_changed

        raise InputError(f"{misfit}; the setting changed most is {most_changed(member, flank)}") from misfit


def _check_change(member: Member, flank: str, nominal: CutFlank, found: CutFlank) -> None:
    """How far a corrected flank is off the nominal one at the mean point. Raises Misfit."""
    for what in ("pressure_angle", "spiral_angle"):
        change = math.degrees(getattr(found, what) - getattr(nominal, what))
        if not abs(change) <= _CORRECTED_ANGLE:
            raise Misfit.of(
                member.name,
                flank,
                f"the corrected settings change its {what.replace('_', ' ')} by {change:.3g} degrees against those "
                f"under design, which must be at most {_CORRECTED_ANGLE:g}",
            )
    arc = mean_pitch_radius(member) * math.remainder(found.azimuth - nominal.azimuth, 2 * math.pi)
    limit = _CORRECTED_ARC * transverse_module(member)
    if not abs(arc) <= limit:
        raise Misfit.of(
            member.name,
            flank,
            f"the corrected settings move it by {arc:.3g} mm at the mean point against those under design, which must "
            f"be at most {limit:.3g} mm",
        )

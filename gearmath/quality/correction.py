"""A measured member in, its corrected settings out: which flanks share settings, and when nothing may be written."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearmath.errors import ComputationError, InputError
from gearmath.quality.analysis import Analysis, analyse
from gearmath.quality.compensation import FlankTarget, Run, as_it_stands, identify, located
from gearmath.quality.identification import RANK, Identification
from gearmath.quality.pitch import evaluate_pitch, index_correction
from gearmath.quality.target import flank_target
from gearmath.quality.variables import NAMES, free_settings, parts, whole
from gearmath.specs.bevel_set import FLANKS, Member, design_sha256
from gearmath.specs.flank_csv import FlankFile

#: What a correction may add to the RMS of a flank that is as good as perfect: rounding. [mm]
_ROUNDING = 1e-6
#: Trials of the noise, each at most half of the one before.
_NOISE_TRIALS = 6
#: A point that was left out must be predicted this well: the variance of the prediction against that of one point.
_LEVERAGE = 4.0
#: How far a correction may move the root line at toe and heel [mm]. Peers hold 0.025 mm when they design; a machine
#: whose root angle or base is off by as much as the bundled shop's needs more.
ROOT_LIMIT = 0.15


@dataclass(frozen=True)
class Correction:
    """Corrected settings (12,) of each flank, what was identified for each group of flanks, and index corrections.

    ``motions`` (10,7) of each flank, without the modified roll, is empty where no motion was corrected. ``expected`` is
    the largest deviation [mm] that the model expects to remain, per flank; ``root`` how much higher or deeper (+) the
    root line at toe and heel (2,) [mm] will be than it was cut. ``analysis`` was made before anything was corrected,
    ``left_out`` says per flank how many points of the grid were not used. ``index`` (z,) [rad] is None where pitch was
    not measured.
    """

    settings: dict[str, np.ndarray]
    identified: dict[tuple[str, ...], Identification]
    expected: dict[str, float]
    index: np.ndarray | None
    motions: dict[str, np.ndarray]
    analysis: dict[tuple[str, ...], Analysis]
    root: dict[str, np.ndarray]
    left_out: dict[str, int]


def correct(
    member: Member, name: str, measured: FlankFile, free: Sequence[str] | None = None, *, objective: str = "points",
    higher_order: bool = False, few: bool = False, root_limit: float | None = ROOT_LIMIT,
    noise: float | None = None, added: dict[str, np.ndarray] | None = None, excluded: np.ndarray | None = None,
    run: Run = as_it_stands,
) -> Correction:  # fmt: skip
    """The settings that make up for what was measured on a member.

    Flanks of a completing cut share their correction. ``free`` names what may change, by default the settings that suit
    the cutting method and, with ``higher_order``, motions; ``few`` takes of them the fewest that lose little.
    ``noise`` [mm] is the standard deviation of a measured deviation, by default what all of the settings leave: weak
    directions are not moved for its sake. ``excluded`` (points of the file,) marks points that are not to be used;
    ``added`` gives for each flank deviations [mm] on the grid that are corrected besides, such as those of the mate.

    Raises InputError if the file is not of this member or does not determine the settings, and ComputationError if the
    correction would make a flank worse.
    """
    check_belongs(member, name, measured)
    names = tuple(free) if free is not None else free_settings(member, higher_order)
    groups = [FLANKS] if member.cutting == "completing" else [(flank,) for flank in FLANKS]
    found = Correction({}, {}, {}, _index(member, measured), {}, {}, {}, {})
    for group in groups:
        targets = [flank_target(member, name, flank, measured, excluded=excluded) for flank in group]
        found.left_out.update({f: t.grid_points - len(t.deviation) for f, t in zip(group, targets, strict=True)})
        _check_determined(name, group, targets, names)
        if added:
            targets = [target.plus(added[flank]) for flank, target in zip(group, targets, strict=True)]
        analysis = analyse(targets, names, run=run)
        if few:
            analysis = analyse(targets, analysis.choose().names, run=run)
        found.analysis[group] = analysis
        result = _identify(targets, analysis.names, objective, root_limit, noise, run)
        _refuse_worse(name, group, targets, result)
        found.identified[group] = result
        for k, (flank, target) in enumerate(zip(group, targets, strict=True)):
            _settle(found, member, flank, target, result, k)
    return found


def _identify(
    targets: Sequence[FlankTarget], names: Sequence[str], objective: str, root_limit: float | None,
    noise: float | None, run: Run,
) -> Identification:  # fmt: skip
    """The identification at the given noise, or at the noise that it leaves itself: at first what no setting shows."""
    given = {"objective": objective, "root_limit": root_limit, "run": run}
    if noise is not None:
        return identify(targets, names, noise=noise, **given)  # type: ignore[arg-type]
    level = analyse(targets, names, run=run).noise
    for _ in range(_NOISE_TRIALS):
        found = identify(targets, names, noise=level, **given)  # type: ignore[arg-type]
        free = max(len(found.residual) - found.corrected_parameters, 1.0)
        left = float(np.sqrt(found.residual @ found.residual / free))
        if left > level / 2 or left <= _ROUNDING:
            break
        level = left
    return found


def _check_determined(name: str, group: Sequence[str], targets: Sequence[FlankTarget], names: Sequence[str]) -> None:
    """Raise InputError where the points that are left do not tell what the settings do at those left out."""
    if all(target.left_out is None for target in targets):
        return
    known = analyse(targets, names).jacobian
    whole_grid = analyse([target.left_out or target for target in targets], names).jacobian
    spread = np.linalg.pinv(known, rcond=RANK)
    worst = float(np.max(np.sum((whole_grid @ spread) ** 2, axis=1)))
    if len(known) < known.shape[1] or worst > _LEVERAGE:
        raise InputError(
            f"{name} {' and '.join(group)}: {len(known)} points are left of "
            f"{sum(target.grid_points for target in targets)}: too few to tell what {len(names)} settings do at the "
            "others; measure them, or free fewer settings"
        )


def _refuse_worse(name: str, group: Sequence[str], targets: Sequence[FlankTarget], result: Identification) -> None:
    """Raise ComputationError where a correction makes its flanks worse, together or one of them for the other."""
    ends = np.cumsum([len(target.deviation) for target in targets])[:-1]
    pieces = np.split(result.residual, ends)
    before = [np.sqrt(np.mean(target.deviation**2)) for target in targets]
    after = [np.sqrt(np.mean(piece**2)) for piece in pieces]
    worse = result.rms_after > result.rms_before + _ROUNDING
    if worse:
        figures = ", ".join(f"{b * 1000:.3f} to {a * 1000:.3f} um" for b, a in zip(before, after, strict=True))
        raise ComputationError(
            f"{name} {' and '.join(group)}: no correction makes the flank better (RMS {figures}); nothing is written"
        )


def _settle(found: Correction, member: Member, flank: str, target: FlankTarget, result: Identification, k: int) -> None:
    """Enter the corrected settings of one flank, and what is expected of it."""
    spec, change = member.flank(flank), result.change(k)
    errors, moved = parts(change)
    found.settings[flank] = spec.nominal.vector - errors
    if moved.any() or spec.nominal_motion != spec.motion:
        found.motions[flank] = spec.nominal_motion.matrix - moved
    deviation, _, _ = located(target, target.vector + change)
    found.expected[flank] = float(np.abs(target.deviation - deviation).max())
    if target.root is not None:
        found.root[flank] = -target.root.sunk(target.vector, target.vector + change)[0]


def check_belongs(member: Member, name: str, measured: FlankFile) -> None:
    """Raise InputError unless the file is a measurement of this member of this set."""
    if measured.member != name:
        raise InputError(f"member = {measured.member!r} in the measured file: must be {name!r}")
    if measured.header["member_teeth"] != str(member.teeth):
        raise InputError(f"member_teeth = {measured.header['member_teeth']}: the {name} of the set has {member.teeth}")
    if measured.header["settings_sha256"] != design_sha256(member):
        raise InputError(
            f"settings_sha256 = {measured.header['settings_sha256'][:12]}...: the file was measured against other "
            f"nominal settings than those of the set ({design_sha256(member)[:12]}...)"
        )


def _index(member: Member, measured: FlankFile) -> np.ndarray | None:
    pitches = [evaluate_pitch(measured, member.teeth, flank) for flank in FLANKS]
    found = [pitch for pitch in pitches if pitch is not None and pitch.nearly_whole]
    if not found:
        return None
    before = np.radians(member.index_correction) if member.index_correction else np.zeros(member.teeth)
    return before + index_correction(found)


def setting_changes(member: Member, correction: Correction) -> list[tuple[str, str, float, float]]:
    """(flank, setting, old, new) of every setting and coefficient of a motion that changes, mm and rad."""
    changes = []
    for flank, vector in correction.settings.items():
        spec = member.flank(flank)
        motion = spec.motion.matrix
        pairs = whole(spec.vector, motion), whole(vector, correction.motions.get(flank, motion))
        changes += [
            (flank, name, float(old), float(new)) for name, old, new in zip(NAMES, *pairs, strict=True) if old != new
        ]
    return changes

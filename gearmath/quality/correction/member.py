"""A measured member in, its corrected settings out: which flanks share settings, and when nothing may be written.

A flank was cut with settings x and measured: d at its nominal points. Cut with x + c it will have the deviations

    d + t(x + c) - t(x)                                                                                      (A)

t of :mod:`gearmath.bevel.identify.flank_target`, on the exact surface: whatever else is wrong with the machine moves
the flank as before. c makes (A) least within its bounds, and (A) is what is expected to remain. So c is found as the
change of settings that explains the wanted deviations t(x) - d.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearmath.bevel.identify.blade import blade_curve, nominal_curvature
from gearmath.bevel.identify.compensation import identify
from gearmath.bevel.identify.flank_target import FlankTarget, located
from gearmath.bevel.identify.identification import Identification
from gearmath.bevel.identify.variables import NAMES, Bounds, free_settings, parts, whole
from gearmath.quality.correction.analysis import LOSS, LOSS_PART, Analysis
from gearmath.quality.correction.checks import check_determined, made_worse, refuse_worse, rms_of_flanks
from gearmath.quality.correction.fit import CorrectionFit, changed_settings, without_shift
from gearmath.quality.correction.own_index import LEAST_OFF, near_the_median, teeth_as_indexed_on_average
from gearmath.quality.correction.representative import representative_tooth
from gearmath.quality.correction.target import flank_target
from gearmath.quality.correction.unknown_rotation import UnknownRotation, rotation_columns
from gearmath.quality.evaluation.file_checks import check_belongs
from gearmath.quality.evaluation.pitch import evaluate_pitch, index_correction
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.flank_csv import FlankFile

#: How far a correction may move the root line at toe and heel [mm]. Peers hold 0.025 mm when they design; a machine
#: whose root angle or base is off by as much as the bundled shop's needs more.
ROOT_LIMIT = 0.15
#: What is said of the pitch of a hobbed member; a set with index corrections of one is refused.
_ENDLESS = "no index corrections: face hobbing indexes without end, and no space can be turned by itself"
#: How often ``correct`` tells its progress.
STAGES = 2


@dataclass(frozen=True)
class MemberCorrection:
    """Corrected settings (12,) of each flank, the change of settings of each group of flanks, and index corrections.

    ``motions`` (10,7) of each flank, without the modified roll, is empty where no motion was corrected; ``curvatures``
    [1/mm] holds those of blades that were. ``rms`` [mm] of each flank is as measured and as expected to remain,
    ``expected`` the largest deviation [mm] that is expected to remain; ``root`` how much higher or deeper (+) the root
    line at toe and heel (2,) [mm] will be than it was cut. ``analysis`` is of all settings that were free, and
    ``reachable`` the RMS [mm] that they leave at best: the optimum on the exact surface within bounds and root limit,
    never above what is expected to remain. ``identified`` has the change of each group, and as its residual what is
    expected to remain, (A). ``rotation`` is what was left open of how the work stood, taken off before.
    ``left_out`` says per flank how many points of the grid were not used. ``index`` (z,) [rad] is None where pitch was
    not measured, and in face hobbing. ``remarks`` say what the measurement does not tell.
    """

    settings: dict[str, np.ndarray]
    identified: dict[tuple[str, ...], Identification]
    expected: dict[str, float]
    index: np.ndarray | None
    motions: dict[str, np.ndarray]
    analysis: dict[tuple[str, ...], Analysis]
    root: dict[str, np.ndarray]
    left_out: dict[str, int]
    reachable: dict[tuple[str, ...], float]
    rotation: UnknownRotation
    curvatures: dict[str, float]
    rms: dict[str, tuple[float, float]]
    remarks: tuple[str, ...] = ()

    def measured_rms(self, group: Sequence[str]) -> float:
        """RMS [mm] of what was measured on the flanks of a group."""
        return float(np.sqrt(np.mean([self.rms[flank][0] ** 2 for flank in group])))


def correct(
    member: Member,
    measured: FlankFile,
    free: Sequence[str] | None = None,
    *,
    objective: str = "points",
    higher_order: bool = False,
    few: bool = False,
    root_limit: float | None = ROOT_LIMIT,
    noise: float | None = None,
    added: dict[str, np.ndarray] | None = None,
    excluded: np.ndarray | None = None,
    bounds: Bounds = "machine",
    progress: Callable[[int], object] = lambda _: None,
    indexed: bool = True,
) -> MemberCorrection:
    """The settings that make up for what was measured on a member.

    Flanks of a completing cut share their correction. ``free`` names what may change, by default the settings that suit
    the cutting method and, with ``higher_order``, motions; ``few`` takes of them the fewest that lose little, and none
    where there is nothing to gain. ``noise`` [mm] is the standard deviation of a measured deviation, by default what
    all of the settings leave: weak directions are not moved for its sake. ``excluded`` (points of the file,) marks
    points that are not to be used; ``added`` gives for each flank deviations [mm] on the grid that are corrected
    besides, such as those of the mate. ``bounds`` are those of errors of a machine, or of a design. There are no index
    corrections where the pitch is not known, not ``indexed``, and none in face hobbing, which turns no space by itself.

    A tooth that is indexed otherwise than the others is moved to where they are on average: see
    :mod:`gearmath.quality.correction.own_index`.
    Where the rotation of the work was taken out of the file (``phase_zeroed``), it stays open: see
    :mod:`gearmath.quality.correction.unknown_rotation`.

    Raises InputError if the file is not of this member or does not determine the settings, and ComputationError if the
    correction would make one of the flanks worse.
    """
    check_belongs(member, measured)
    names = tuple(free) if free is not None else free_settings(member, higher_order)
    groups: list[tuple[str, ...]] = [FLANKS] if member.cutting == "completing" else [(flank,) for flank in FLANKS]
    targets = {flank: flank_target(member, flank, measured, excluded=excluded) for flank in FLANKS}
    at_mean, remarks = teeth_as_indexed_on_average(member, measured)
    if at_mean is not measured:
        targets = {flank: flank_target(member, flank, at_mean, excluded=excluded) for flank in FLANKS}
    for group in groups:
        check_determined(member.name, group, [targets[flank] for flank in group], names)
    if added:
        targets = {flank: target.plus(added[flank]) for flank, target in targets.items()}
    columns = rotation_columns(list(targets.values()), measured)
    how = {"objective": objective, "root_limit": root_limit, "bounds": bounds}
    fit = CorrectionFit({flank: _wanted(target) for flank, target in targets.items()}, groups, names, columns, how)
    identified, rotation = fit.solve_few(noise) if few else fit.solve(dict.fromkeys(groups, names), noise)
    wanted, of_work = fit.turned(rotation.shift), replace(rotation, angles=-rotation.angles)
    judged, as_measured = without_shift(targets, of_work.shift), _turned_best(targets, columns)
    progress(1)
    index = _index(member, measured) if indexed else None
    if index is not None and member.process == "face_hobbing":
        index, remarks = None, (*remarks, _ENDLESS)
    found = MemberCorrection({}, identified, {}, index, {}, {}, {}, {}, {}, of_work, {}, {}, remarks)
    for group, analysis in zip(groups, fit.analysis, strict=True):
        mine, before = [wanted[flank] for flank in group], [as_measured[flank].deviation for flank in group]
        found.left_out.update({f: t.grid_points - len(t.deviation) for f, t in zip(group, mine, strict=True)})
        found.analysis[group] = replace(
            analysis,
            deviation=np.concatenate([judged[flank].deviation for flank in group]),
            measured=np.concatenate([targets[flank].deviation for flank in group]),
        )
        best = identify(mine, names, root_limit=root_limit, bounds=bounds)
        held_back = bool(identified[group].active) and not _as_good(identified[group], best)
        if few and (held_back or made_worse(group, before, identified[group], noise or 0.0)):
            identified[group] = changed_settings(mine, names, noise, how)  # all of them may do what the few do not
        result = identified[group]
        found.reachable[group] = min(best.rms_after, result.rms_after)
        refuse_worse(member.name, group, before, result, noise or 0.0)
        remaining = np.split(result.residual, np.cumsum([len(one) for one in before])[:-1])
        for k, (flank, target) in enumerate(zip(group, mine, strict=True)):
            _settle(found, member, flank, target, result.change(k))
            found.expected[flank] = float(np.abs(remaining[k]).max())
            found.rms[flank] = rms_of_flanks(before, result)[k]
    progress(1)
    return found


def _wanted(target: FlankTarget) -> FlankTarget:
    """The target whose deviations are those that the changed settings must leave, t(x) - d of (A)."""
    now, _, _ = located(target, target.vector, moving=False)
    return replace(target, deviation=now - target.deviation)


def _turned_best(targets: dict[str, FlankTarget], columns: np.ndarray) -> dict[str, FlankTarget]:
    """The targets as measured, turned so that least is left if no setting is changed."""
    measured = np.concatenate([target.deviation for target in targets.values()])
    return without_shift(targets, columns @ (np.linalg.pinv(columns) @ measured))


def _as_good(found: Identification, best: Identification) -> bool:
    """Whether settings that a limit holds back leave next to nothing more than all of them."""
    return found.rms_after <= max(best.rms_after * (1 + LOSS_PART), best.rms_after + LOSS)


def _settle(found: MemberCorrection, member: Member, flank: str, target: FlankTarget, change: np.ndarray) -> None:
    """Enter the corrected settings of one flank: those that the machine was set to, and the change (83,)."""
    spec, (settings, motion) = member.flank(flank), parts(change)
    curvature, _ = blade_curve(spec)
    if change[-1] or curvature != nominal_curvature(spec):
        found.curvatures[flank] = curvature + float(change[-1])
    found.settings[flank] = spec.vector + settings
    if motion.any() or spec.nominal_motion != spec.motion:
        found.motions[flank] = spec.motion.matrix + motion
    if target.root is not None:
        found.root[flank] = target.root.sunk(target.vector, target.vector + change)[0]


def _index(member: Member, measured: FlankFile) -> np.ndarray | None:
    pitches = [evaluate_pitch(measured, member.teeth, flank) for flank in FLANKS]
    found = [pitch for pitch in pitches if pitch is not None and pitch.nearly_whole]
    if not found:
        return None
    before = member.rad("index_correction") if member.index_correction else np.zeros(member.teeth)
    turn = index_correction(found)
    full = representative_tooth(measured, found[0].flank)
    # the settings put right where the others stand, not the tooth that was measured in full
    others = np.delete(turn, full % member.teeth)
    radius = member.blank.mean_cone_distance * np.sin(member.blank.delta)
    return before + turn - others[near_the_median(others, LEAST_OFF / radius)].mean()


def setting_changes(member: Member, correction: MemberCorrection) -> list[tuple[str, str, float, float]]:
    """(flank, setting, old, new) of what changes: settings, coefficients of a motion, curvature; mm and rad."""
    changes = []
    for flank, vector in correction.settings.items():
        spec = member.flank(flank)
        motion = spec.motion.matrix
        bent, _ = blade_curve(spec)
        pairs = (
            whole(spec.vector, motion, bent),
            whole(vector, correction.motions.get(flank, motion), correction.curvatures.get(flank, bent)),
        )
        changes += [
            (flank, name, float(old), float(new)) for name, old, new in zip(NAMES, *pairs, strict=True) if old != new
        ]
    return changes

"""A measured member in, its corrected settings out: which flanks share settings, and when nothing may be written."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from gearmath.errors import ComputationError, InputError
from gearmath.quality.analysis import LOSS, LOSS_PART, Analysis, analyse, fewest
from gearmath.quality.compensation import FlankTarget, identify, located, nothing_identified
from gearmath.quality.identification import RANK, Identification
from gearmath.quality.on_line import Run, as_it_stands
from gearmath.quality.pitch import evaluate_pitch, index_correction
from gearmath.quality.target import blade_curve, flank_target, nominal_curvature
from gearmath.quality.unknown_rotation import UnknownRotation, rotation_columns, rotation_step, step_of
from gearmath.quality.variables import NAMES, Bounds, free_settings, parts, whole
from gearmath.specs.bevel_set import FLANKS, Member, design_sha256
from gearmath.specs.flank_csv import FlankFile

#: What is left is rounding. [mm]
_ROUNDING = 1e-6
#: What a correction may add to the RMS of a flank that is as good as perfect: no probe shows it. [mm]
_WORSE = 5e-5
#: The open rotation and the settings are found in so many turns, until it moves no point by more than this [mm].
_TURNS, _AT_REST = 6, 1e-7
#: Trials of the noise, each at most half of the one before.
_NOISE_TRIALS = 6
#: A rotation that is left open moves the points by at most so many times the largest deviation measured.
_ROTATION_PART = 3.0
#: A change can be taken back where its opposite does the opposite, but for this part of what it does, and so much. [mm]
_BENT, _BENT_LEAST = 0.1, 2e-4
#: Else the noise is raised by this factor, from at least this noise on, so often at most. [mm]
_TAMING, _LEAST_NOISE, _TAMING_TRIALS = 3.0, 1e-4, 12
#: A point that was left out must be predicted this well: the variance of the prediction against that of one point.
_LEVERAGE = 4.0
#: How far a correction may move the root line at toe and heel [mm]. Peers hold 0.025 mm when they design; a machine
#: whose root angle or base is off by as much as the bundled shop's needs more.
ROOT_LIMIT = 0.15


#: How often ``correct`` tells its progress.
STAGES = 2


@dataclass(frozen=True)
class Correction:
    """Corrected settings (12,) of each flank, what was identified for each group of flanks, and index corrections.

    ``motions`` (10,7) of each flank, without the modified roll, is empty where no motion was corrected; ``curvatures``
    [1/mm] holds those of blades that were. ``rms`` [mm] of each flank is as measured and as expected to remain,
    ``expected`` the largest deviation [mm] that is expected to remain; ``root`` how much higher or deeper (+) the root
    line at toe and heel (2,) [mm] will be than it was cut. ``analysis`` is of all settings that were free, and
    ``reachable`` the RMS [mm] that they leave at best: the optimum on the exact surface within bounds and root limit,
    never above what was identified. ``rotation`` is what was left open of how the work stood, taken off before.
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
    reachable: dict[tuple[str, ...], float]
    rotation: UnknownRotation
    curvatures: dict[str, float]
    rms: dict[str, tuple[float, float]]

    def measured_rms(self, group: Sequence[str]) -> float:
        """RMS [mm] of what was measured on the flanks of a group."""
        return float(np.sqrt(np.mean([self.rms[flank][0] ** 2 for flank in group])))


def correct(
    member: Member, name: str, measured: FlankFile, free: Sequence[str] | None = None, *, objective: str = "points",
    higher_order: bool = False, few: bool = False, root_limit: float | None = ROOT_LIMIT,
    noise: float | None = None, added: dict[str, np.ndarray] | None = None, excluded: np.ndarray | None = None,
    bounds: Bounds = "machine", run: Run = as_it_stands, progress: Callable[[int], object] = lambda _: None,
) -> Correction:  # fmt: skip
    """The settings that make up for what was measured on a member.

    Flanks of a completing cut share their correction. ``free`` names what may change, by default the settings that suit
    the cutting method and, with ``higher_order``, motions; ``few`` takes of them the fewest that lose little, and none
    where there is nothing to gain. ``noise`` [mm] is the standard deviation of a measured deviation, by default what
    all of the settings leave: weak directions are not moved for its sake. ``excluded`` (points of the file,) marks
    points that are not to be used; ``added`` gives for each flank deviations [mm] on the grid that are corrected
    besides, such as those of the mate. ``bounds`` are those of errors of a machine, or of a design.

    Where the rotation of the work was taken out of the file (``phase_zeroed``), it stays open: see
    :mod:`gearmath.quality.unknown_rotation`.

    Raises InputError if the file is not of this member or does not determine the settings, and ComputationError if the
    correction would make one of the flanks worse.
    """
    check_belongs(member, name, measured)
    names = tuple(free) if free is not None else free_settings(member, higher_order)
    groups: list[tuple[str, ...]] = [FLANKS] if member.cutting == "completing" else [(flank,) for flank in FLANKS]
    targets = {flank: flank_target(member, name, flank, measured, excluded=excluded) for flank in FLANKS}
    for group in groups:
        _check_determined(name, group, [targets[flank] for flank in group], names)
    if added:
        targets = {flank: target.plus(added[flank]) for flank, target in targets.items()}
    fit = _Fit(targets, groups, names, rotation_columns(list(targets.values()), measured), {
        "objective": objective, "root_limit": root_limit, "bounds": bounds, "run": run
    })  # fmt: skip
    identified, rotation = fit.solve(fit.chosen(noise) if few else dict.fromkeys(groups, names), noise)
    as_measured, targets = fit.without_rotation(), fit.turned(rotation.shift)
    progress(1)
    found = Correction({}, identified, {}, _index(member, measured), {}, {}, {}, {}, {}, rotation, {}, {})
    for group, analysis in zip(groups, fit.analysis, strict=True):
        mine, measured_there = ([each[flank] for flank in group] for each in (targets, as_measured))
        before = [target.deviation for target in measured_there]
        found.left_out.update({f: t.grid_points - len(t.deviation) for f, t in zip(group, mine, strict=True)})
        found.analysis[group] = replace(analysis, deviation=np.concatenate([target.deviation for target in mine]))
        best = identify(mine, names, root_limit=root_limit, bounds=bounds, run=run)
        held_back = bool(identified[group].active) and not _as_good(identified[group], best)
        if few and (held_back or _made_worse(group, before, identified[group], noise or 0.0)):
            identified[group] = _identify(mine, names, noise, fit.how)  # all of them may do what the few do not
        result = identified[group]
        found.reachable[group] = min(best.rms_after, result.rms_after)
        _refuse_worse(name, group, before, result, noise or 0.0)
        for k, (flank, target) in enumerate(zip(group, mine, strict=True)):
            _settle(found, member, flank, target, result, k)
            found.rms[flank] = _rms(before, result)[k]
    progress(1)
    return found


def _as_good(found: Identification, best: Identification) -> bool:
    """Whether settings that a limit holds back leave next to nothing more than all of them."""
    return found.rms_after <= max(best.rms_after * (1 + LOSS_PART), best.rms_after + LOSS)


@dataclass(frozen=True)
class _Fit:
    """Both flanks of a member, the groups of them that share settings, and the rotation that is open."""

    targets: dict[str, FlankTarget]
    groups: Sequence[tuple[str, ...]]
    names: tuple[str, ...]
    columns: np.ndarray
    how: dict[str, Any]

    @cached_property
    def analysis(self) -> list[Analysis]:
        return [
            analyse([self.targets[flank] for flank in group], self.names, self.how["bounds"], self.how["run"])
            for group in self.groups
        ]

    def chosen(self, noise: float | None) -> dict[tuple[str, ...], tuple[str, ...]]:
        """The fewest settings of all groups together that explain both flanks, with the rotation for nothing."""
        ends = np.cumsum([0, *(len(one.deviation) for one in self.analysis)])
        columns = {}
        for k, (group, one) in enumerate(zip(self.groups, self.analysis, strict=True)):
            for name in self.names:
                block = one.jacobian[:, [variable.name == name for variable in one.variables]]
                whole_block = np.zeros((ends[-1], block.shape[1]))
                whole_block[ends[k] : ends[k + 1]] = block
                columns[group, name] = whole_block
        measured = np.concatenate([one.deviation for one in self.analysis])
        taken, _ = fewest(columns, measured, self.columns, noise)
        return {group: tuple(name for one, name in taken if one == group) for group in self.groups}

    def turned(self, shift: np.ndarray) -> dict[str, FlankTarget]:
        """The targets without what a rotation makes of their points (m,) [mm]."""
        parts = np.split(shift, np.cumsum([len(target.deviation) for target in self.targets.values()])[:-1])
        return {
            flank: replace(target, deviation=target.deviation - part)
            for (flank, target), part in zip(self.targets.items(), parts, strict=True)
        }

    def without_rotation(self) -> dict[str, FlankTarget]:
        """The targets as measured, turned so that least is left if no setting is changed."""
        measured = np.concatenate([target.deviation for target in self.targets.values()])
        return self.turned(self.columns @ (np.linalg.pinv(self.columns) @ measured))

    def solve(
        self, names: dict[tuple[str, ...], tuple[str, ...]], noise: float | None
    ) -> tuple[dict[tuple[str, ...], Identification], UnknownRotation]:
        """Every group by its settings, and the rotation, found in turns until it rests."""
        rotation = self._first(names, noise)
        for _ in range(_TURNS):
            now = self.turned(rotation.shift)
            found = {
                group: _identify([now[flank] for flank in group], names[group], noise, self.how)
                for group in self.groups
            }
            step, gain = step_of(self.columns, list(found.values()))
            before, rotation = rotation, self._limited(rotation.angles + step, gain)
            if np.abs(rotation.shift - before.shift).max(initial=0.0) <= _AT_REST:
                break
        return found, rotation

    def _first(self, names: dict[tuple[str, ...], tuple[str, ...]], noise: float | None) -> UnknownRotation:
        """The rotation to first order, before any setting is moved: what settings could do as well is left to it."""
        jacobians = [
            one.jacobian[:, [variable.name in names[group] for variable in one.variables]]
            for group, one in zip(self.groups, self.analysis, strict=True)
        ]
        levels = [one.noise if noise is None else noise for one in self.analysis]
        weights = np.repeat(levels, [jacobian.shape[1] for jacobian in jacobians])
        measured = np.concatenate([one.deviation for one in self.analysis])
        angles, gain = rotation_step(self.columns, jacobians, -measured, np.zeros(len(weights)), weights)
        return self._limited(angles, gain)

    def _limited(self, angles: np.ndarray, gain: np.ndarray) -> UnknownRotation:
        """A rotation that moves no point by much more than was measured: weak settings would turn the work for nothing.

        Errors that shift a flank as a whole change its form by about as much.
        """
        measured = np.concatenate([target.deviation for target in self.targets.values()])
        moved = float(np.abs(self.columns @ angles).max(initial=0.0))
        most = _ROTATION_PART * float(np.abs(measured).max())
        if moved <= most:
            return UnknownRotation(angles, self.columns, gain)
        return UnknownRotation(angles * most / moved, self.columns, np.zeros_like(gain))


def _identify(
    targets: Sequence[FlankTarget], names: Sequence[str], noise: float | None, how: dict[str, Any]
) -> Identification:
    """The identification at the given noise, or at the noise that it leaves itself: at first what no setting shows.

    What is identified is taken back by the opposite change. Where the change is so large that the opposite one does not
    take it back, weak directions are moved less, as if there were more noise.
    """
    if not names:
        return nothing_identified(targets, how["run"])
    found = _at_its_noise(targets, names, noise, how)
    level = max(found.noise, _LEAST_NOISE)
    for _ in range(_TAMING_TRIALS):
        if how["bounds"] == "design" or _can_be_taken_back(targets, found, how["run"]):
            break
        level *= _TAMING
        found = identify(targets, names, noise=level, **how)
    return found


def _can_be_taken_back(targets: Sequence[FlankTarget], found: Identification, run: Run) -> bool:
    """Whether a change and its opposite move the exact flanks alike: t(x + e) + t(x - e) = 2 t(x)."""
    for k, target in enumerate(targets):
        change = found.change(k)
        there, here, back = (located(target, target.vector + part * change, run) for part in (1.0, 0.0, -1.0))
        if there[2].any() or back[2].any():
            return False
        bent, moved = there[0] + back[0] - 2 * here[0], there[0] - here[0]
        if np.sqrt(np.mean(bent**2)) > _BENT * np.sqrt(np.mean(moved**2)) + _BENT_LEAST:
            return False
    return True


def _at_its_noise(
    targets: Sequence[FlankTarget], names: Sequence[str], noise: float | None, how: dict[str, Any]
) -> Identification:
    if noise is not None:
        return identify(targets, names, noise=noise, **how)
    level = analyse(targets, names, how["bounds"], how["run"]).noise
    for _ in range(_NOISE_TRIALS):
        found = identify(targets, names, noise=level, **how)
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


def _rms(measured: Sequence[np.ndarray], result: Identification) -> list[tuple[float, float]]:
    """RMS [mm] of the deviations of every flank as they were measured, and as they are expected to remain."""
    pieces = np.split(result.residual, np.cumsum([len(one) for one in measured])[:-1])
    return [
        (float(np.sqrt(np.mean(one**2))), float(np.sqrt(np.mean(piece**2))))
        for one, piece in zip(measured, pieces, strict=True)
    ]


def _made_worse(
    group: Sequence[str], measured: Sequence[np.ndarray], result: Identification, noise: float
) -> list[str]:
    """The flanks that a correction makes worse, by more than the noise of a point."""
    pairs = zip(group, _rms(measured, result), strict=True)
    return [flank for flank, (before, after) in pairs if after > before + max(_WORSE, noise)]


def _refuse_worse(
    name: str, group: Sequence[str], measured: Sequence[np.ndarray], result: Identification, noise: float
) -> None:
    """Raise ComputationError where a correction makes one of its flanks worse."""
    if worse := _made_worse(group, measured, result, noise):
        figures = ", ".join(
            f"{flank} {before * 1000:.3f} to {after * 1000:.3f} um"
            for flank, (before, after) in zip(group, _rms(measured, result), strict=True)
        )
        names = ", ".join(variable.label for variable in result.variables) or "no setting"
        raise ComputationError(
            f"{name}: the correction by {names} makes the {' and '.join(worse)} flank worse (RMS {figures}); nothing "
            "is written; free other settings"
        )


def _settle(found: Correction, member: Member, flank: str, target: FlankTarget, result: Identification, k: int) -> None:
    """Enter the corrected settings of one flank, and what is expected of it."""
    spec, change = member.flank(flank), result.change(k)
    errors, moved = parts(change)
    if change[-1] or blade_curve(spec)[0] != nominal_curvature(spec):
        found.curvatures[flank] = nominal_curvature(spec) - float(change[-1])
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

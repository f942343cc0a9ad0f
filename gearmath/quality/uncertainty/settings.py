"""How sure corrected settings are, and what is expected to remain: the exact derivative of the identification.

The solution v of the bounded fit, in variables scaled by their bounds, has no gradient left where no bound holds it:

    J'W (t(v) - d) + ν² v = 0

With W = w'w the weighting, t(v) - d = r the residual, and ν the noise that damps weak directions. Differentiated,

    (J'W J + ν² I + Σ_i (W r)_i ∇²t_i) dv = J'W dd                                             (A)

∇²t_i, the curvature of the re-solved flank, is the derivative by CasADi of the gradient through the last Newton step.
It counts where much is left that no setting explains, half a percent of u for 4 um on the NASA pinion, and decides
whether the solution is a minimum at all. A variable that a bound holds stays there: dv = 0, until it comes off. A root
line at its limit pulls with the weight of its gradient; its own curvature is left out, as it hardly bends within that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from gearmath.bevel.identify.blade import blade_curve
from gearmath.bevel.identify.flank_target import FlankTarget
from gearmath.bevel.identify.identification import RANK, Identification
from gearmath.bevel.identify.on_line import flank_on_line
from gearmath.bevel.identify.problem import ROOT_WEIGHT, Problem
from gearmath.bevel.identify.variables import SIZE, Variable, reading, whole
from gearmath.errors import ComputationError
from gearmath.kernels import kernel
from gearmath.quality.correction.member import ROOT_LIMIT, MemberCorrection
from gearmath.quality.correction.representative import representative_tooth
from gearmath.quality.correction.target import flank_target
from gearmath.quality.evaluation.topography import grid_shape
from gearmath.quality.uncertainty.covariance import Covariance, coverage_factor
from gearmath.quality.uncertainty.figures import Figure
from gearmath.quality.uncertainty.propagation import PROBABILITY, Uncertain
from gearmath.specs.bevel_set import FLANKS, SETTINGS, Member
from gearmath.specs.flank_csv import FlankFile


@dataclass(frozen=True)
class SettingUncertainty:
    """Covariance (p,p) [mm, rad] of identified values, and so of the settings corrected by them; where it is from.

    ``gain`` (p,m) is the derivative of the values by the measured deviations; ``remaining`` (m,) [mm] the standard
    uncertainty of the deviations expected to remain, and ``caused`` (m,) [mm] of those that the errors of measurement
    will leave on the next flank. ``held`` names the variables that a bound holds.
    """

    covariance: np.ndarray
    gain: np.ndarray
    remaining: np.ndarray
    caused: np.ndarray
    held: tuple[str, ...]

    @property
    def standard(self) -> np.ndarray:
        """Standard uncertainties (p,) [mm, rad]; zero for what a bound holds."""
        return np.sqrt(np.diag(self.covariance))


@dataclass(frozen=True)
class Effect:
    """What errors of measurement do to one flank, in the RMS over its points [mm].

    ``caused`` is what they will leave on the next flank by the settings corrected from them; ``expected`` the standard
    uncertainty of the deviations that are expected to remain, as far as they were measured.
    """

    caused: float
    expected: float


def setting_uncertainty(
    targets: Sequence[FlankTarget], found: Identification, measured: Covariance, root_limit: float | None = None
) -> SettingUncertainty:
    """Uncertainty of what was identified from the points (m,) of some targets, whose covariance is ``measured``.

    ``root_limit`` [mm] is that of the identification. Raises ComputationError where the flanks do not determine the
    settings: the solution is no strict minimum.
    """
    if not found.variables:
        return _nothing(len(found.residual), measured)
    gain = exact_gain(targets, found, root_limit)
    passed = found.jacobian @ (gain / found.scale[:, None])
    return SettingUncertainty(
        measured.through(gain),
        gain,
        measured.standard_uncertainty(passed - np.eye(len(passed))),
        measured.standard_uncertainty(passed),
        _held(found),
    )


def _nothing(points: int, measured: Covariance) -> SettingUncertainty:
    """Where no setting was corrected, what was measured remains as uncertain as it is."""
    remaining = measured.standard_uncertainty(np.eye(points))
    return SettingUncertainty(np.zeros((0, 0)), np.zeros((0, points)), remaining, np.zeros(points), ())


def exact_gain(targets: Sequence[FlankTarget], found: Identification, root_limit: float | None = None) -> np.ndarray:
    """Derivative (p,m) [mm or rad per mm] of identified values by the measured deviations, by (A).

    Raises ComputationError where the matrix of (A) is not positive definite beyond rounding.
    """
    weighting = np.eye(len(found.residual)) if found.weighting is None else found.weighting.T @ found.weighting
    pull = weighting @ found.residual
    matrix = found.jacobian.T @ weighting @ found.jacobian + found.noise**2 * np.eye(len(found.values))
    ends = np.cumsum([len(target.deviation) for target in targets])[:-1]
    for k, (target, part) in enumerate(zip(targets, np.split(pull, ends), strict=True)):
        matrix = matrix + curvature(target, found, k, part)
    if root_limit is not None:
        matrix = matrix + _root_pull(targets, found, root_limit)
    held = _held(found)
    loose = np.array([variable.label not in held for variable in found.variables])
    free = matrix[np.ix_(loose, loose)]
    sizes = np.linalg.eigvalsh(free) if loose.any() else np.ones(1)
    if sizes[0] <= RANK**2 * sizes[-1]:
        raise ComputationError(
            "the flanks do not determine the settings: free fewer of them, or say how well the points were measured"
        )
    gain = np.zeros_like(found.jacobian.T)
    gain[loose] = np.linalg.solve(free, (found.jacobian.T @ weighting)[loose])
    return found.scale[:, None] * gain


def _root_pull(targets: Sequence[FlankTarget], found: Identification, limit: float) -> np.ndarray:
    """What root lines beyond their limit add to the matrix (p,p) of the fit."""
    problem = Problem(targets, found.variables, None, limit)
    matrix = np.zeros((len(found.values), len(found.values)))
    for sunk, gradient in problem.root(found.values / found.scale):
        beyond = ROOT_WEIGHT * gradient[np.abs(sunk) > limit]
        matrix += beyond.T @ beyond
    return matrix


def _held(found: Identification) -> tuple[str, ...]:
    labels = {variable.label for variable in found.variables}
    return tuple(name for name in found.active if name in labels)


def curvature(target: FlankTarget, found: Identification, k: int, pull: np.ndarray) -> np.ndarray:
    """Σ_i pull_i ∇²t_i (p,p) of the points (n,) of target k, by the scaled variables, at the solution."""
    mine = np.array([variable.target in (None, k) for variable in found.variables])
    moving = bool(((found.index >= len(SETTINGS)) & (found.index < SIZE - 1)).any())
    bending = bool((found.index == SIZE - 1).any())
    kind = target.kind_of(target.vector + found.change(k), bending)
    kind = "straight" if kind == "plain" and moving else kind
    spread = np.zeros((SIZE, len(mine)))
    spread[found.index, np.arange(len(mine))] = found.scale * mine
    change = ca.MX.sym("change", len(mine))
    vector = ca.DM(target.vector + found.change(k)) + ca.DM(spread) @ change
    given = list(target.given(target.vector, kind))
    given[0] = vector[: len(SETTINGS)]
    if kind != "plain":
        given[1] = ca.reshape(vector[len(SETTINGS) : SIZE - 1], given[1].shape[1], given[1].shape[0]).T
    if kind == "curved":
        given[4] = vector[SIZE - 1]
    n, at = len(pull), target.nominal
    shared = [ca.repmat(ca.MX(value), 1, n) for value in given]
    solved = flank_on_line(kind).function.map(n)(at.contact.T, *shared, at.point.T, at.normal.T)
    contact, _, by_settings, _ = solved
    by_settings, by_curvature = by_settings[: len(SETTINGS), :], by_settings[len(SETTINGS) :, :]
    gradient = ca.mtimes(by_settings, ca.DM(pull))
    if moving:
        by_motion = kernel("coefficient_sensitivity").function.map(n)(contact[2, :], by_settings)
        width = by_motion.shape[1] // n
        summed = ca.mtimes(by_motion, ca.DM(np.kron(pull[:, None], np.eye(width))))
        gradient = ca.vertcat(gradient, ca.vec(summed.T))
    if bending:
        gradient = ca.vertcat(gradient, ca.MX(SIZE - 1 - gradient.shape[0], 1), ca.mtimes(by_curvature, ca.DM(pull)))
    by_change = ca.mtimes(ca.DM(spread[: gradient.shape[0]]).T, gradient)
    slope = ca.Function("curvature", [change], [ca.jacobian(by_change, change)])
    return np.array(slope(np.zeros(len(mine))))


def uncertain_settings(
    member: Member,
    file: FlankFile,
    correction: MemberCorrection,
    measured: Covariance,
    root_limit: float | None = ROOT_LIMIT,
) -> tuple[list[Uncertain], dict[str, Effect]]:
    """Every corrected setting, and per flank what the errors of measurement do to it.

    ``measured`` is the covariance of the file that was corrected. Raises ComputationError where the flanks do not
    determine the settings.
    """
    settings: list[Uncertain] = []
    effects: dict[str, Effect] = {}
    every = {flank: flank_target(member, flank, file) for flank in FLANKS}
    places = {flank: rows_of(file, flank, target) for flank, target in every.items()}
    own = measured.pick(np.concatenate(list(places.values())))
    if correction.rotation.angles.size:  # it was found from both flanks
        own = own.carried(correction.rotation.projector)
    start = dict(zip(FLANKS, (0, len(places[FLANKS[0]])), strict=True))
    for group, found in correction.identified.items():
        targets, rows = [every[flank] for flank in group], [places[flank] for flank in group]
        at = np.concatenate([start[flank] + np.arange(len(places[flank])) for flank in group])
        known = setting_uncertainty(targets, found, own.pick(at), root_limit)
        ends = np.cumsum([len(part) for part in rows])[:-1]
        pieces = zip(np.split(known.caused, ends), np.split(known.remaining, ends), strict=True)
        for k, (flank, piece) in enumerate(zip(group, pieces, strict=True)):
            effects[flank] = Effect(*(float(np.sqrt(np.mean(u**2))) for u in piece))
            spec = member.flank(flank)
            corrected = whole(
                correction.settings[flank],
                correction.motions.get(flank, spec.motion.matrix),
                correction.curvatures.get(flank, blade_curve(spec)[0]),
            )
            settings += [
                _setting(flank, variable, float(corrected[variable.index]), float(u))
                for variable, u in zip(found.variables, known.standard, strict=True)
                if variable.target in (None, k)
            ]
    return settings, effects


def noise_of(member: Member, file: FlankFile, measured: Covariance) -> float:
    """Noise [mm] of the points of a file from which settings are corrected: what differs from point to point."""
    rows = [rows_of(file, flank, flank_target(member, flank, file)) for flank in FLANKS]
    return measured.pick(np.concatenate(rows)).noise


def _setting(flank: str, variable: Variable, value: float, u: float) -> Uncertain:
    factor, unit = reading(variable.name)
    k = coverage_factor(PROBABILITY)
    figure = Figure(flank, variable.name, unit, factor=factor)
    return Uncertain(figure, value, u, (value - k * u, value + k * u), None)


def rows_of(file: FlankFile, flank: str, target: FlankTarget) -> np.ndarray:
    """The rows of a file whose points make up a target of ``flank_target``, in its order."""
    (rows,) = np.nonzero((file.flank == flank) & (file.tooth == representative_tooth(file, flank)))
    columns = grid_shape(file)[1]
    place = file.row[rows] * columns + file.col[rows]
    if target.used is not None:
        rows = rows[target.used[place]]
        place = file.row[rows] * columns + file.col[rows]
    return rows[np.argsort(place)]

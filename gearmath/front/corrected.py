"""Corrected settings of a measured member: fitted, written, and how sure they are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from gearmath.arguments.call import checked_call
from gearmath.bevel.identify.variables import NAMES, reading, variables_of
from gearmath.bevel.pair import check_corrected
from gearmath.errors import ComputationError, InputError, about
from gearmath.front.evaluated import Evaluation
from gearmath.front.measured import Measurement, measurement_in
from gearmath.front.member import Member
from gearmath.front.progress import Begin, silent
from gearmath.front.sets import GearSet, load_set
from gearmath.quality.correction import member as correcting
from gearmath.quality.correction.ease_off import moved_to_mate
from gearmath.quality.correction.member import ROOT_LIMIT
from gearmath.quality.correction.member import MemberCorrection as Corrected
from gearmath.quality.correction.thickness import with_thickness
from gearmath.quality.correction.values import correction_values
from gearmath.quality.evaluation.member import STAGES
from gearmath.quality.uncertainty.corrected import noise_of_points, point_covariance
from gearmath.quality.uncertainty.judged import judged_by_measured
from gearmath.quality.uncertainty.settings import uncertain_settings
from gearmath.shown import Shown, Shows, html_table
from gearmath.specs.bevel_set import MACHINE_SETTINGS, SETTINGS
from gearmath.specs.set_text import save_corrected

if TYPE_CHECKING:
    from gearmath.bevel.identify.variables import Bounds
    from gearmath.quality.correction.thickness import By
    from gearmath.quality.uncertainty.settings import Effect


@dataclass(frozen=True, repr=False)
class Correction(Shown):
    """Corrected settings of a measured member: ``found`` has settings (12,) of each flank in mm and rad.

    ``evaluation`` is what they correct; ``noise_um`` and ``root_limit`` [mm] as they were asked for.
    """

    evaluation: Evaluation
    found: Corrected
    noise_um: float | None = None
    root_limit: float = ROOT_LIMIT

    @property
    def measurement(self) -> Measurement:
        """The measurement that they correct."""
        return self.evaluation.measurement

    @property
    def changes(self) -> list[tuple[str, str, float]]:
        """Flank, setting, and by how much it is changed [mm, degrees, 1]."""
        member = self.measurement.member.spec
        return [
            (flank, name, (new - old) * reading(name)[0])
            for flank, name, old, new in correcting.setting_changes(member, self.found)
        ]

    @property
    def rms(self) -> dict[str, tuple[float, float]]:
        """By flank: RMS of the deviation [mm] as measured, and what is expected to remain."""
        return self.found.rms

    @property
    def gear_set(self) -> GearSet:
        """The set with corrected settings, motions, blades and index corrections; the nominal flanks stay."""
        with TemporaryDirectory() as folder:
            written = load_set(self.save(Path(folder) / "corrected.toml"))
        return GearSet(written.spec)  # which no file has yet

    @property
    def member(self) -> Member:
        """The member with the corrected settings; its nominal flanks stay what they were."""
        return self.gear_set.member(self.measurement.member.name)

    @checked_call
    def save(self, path: str | Path) -> Path:
        """Write the corrected set as TOML, the nominal settings under ``design``. Raises ComputationError for no pair.

        The rest of the file that the set was read from stays as it is, if that still holds the set.
        """
        measured, found = self.measurement, self.found
        pair = measured.member.gear_set
        spec = pair.spec.model_copy(update={measured.member.name: measured.member.spec})
        with TemporaryDirectory() as folder:
            save_corrected(
                _file_of(replace(pair, spec=spec), Path(folder)),
                Path(path),
                measured.member.name,
                found.settings,
                found.index,
                found.motions,
                found.curvatures,
                check=check_corrected,
                origin=f"{measured.source.name if measured.source else 'a measurement'} and "
                f"{pair.source.name if pair.source else pair.title}",
            )
        return Path(path)

    def figures(self) -> dict[str, Any]:
        """As ``gearmath compensate --json`` prints it: old and new, what remains, which limit binds, how sure it is."""
        remarks = {"remarks": [*self.evaluation.remarks, *self.found.remarks]}
        return correction_values(self.measurement.member.spec, self.found) | remarks | self._uncertainties()

    def _uncertainties(self) -> dict[str, Any]:
        """Standard uncertainties of the corrected settings, and what errors of measurement do to the flanks."""
        file, member, found = self.measurement.file, self.measurement.member.spec, self.evaluation.found
        covariance = point_covariance(file, self.noise_um or None)
        if covariance is None:
            return {}
        judged = covariance.carried(judged_by_measured(file, member, found))
        try:
            settings, effects = uncertain_settings(member, found.file, self.found, judged, self.root_limit)
        except ComputationError as error:
            return {"no_uncertainties": str(error)}
        known: dict[str, dict[str, float]] = {}
        for one in settings:
            known.setdefault(one.figure.flank, {})[one.figure.name] = one.uncertainty * one.figure.factor
        return {"u": known, **effects_um(effects)}

    def to_dict(self) -> dict[str, Any]:
        """Changes by flank and setting [mm, degrees]; RMS [µm] by flank, as measured and as expected."""
        changes: dict[str, dict[str, float]] = {}
        for flank, name, change in self.changes:
            changes.setdefault(flank, {})[name] = change
        return {
            "changes": changes,
            "rms_um": {
                flank: {"measured": 1000 * before, "expected": 1000 * after}
                for flank, (before, after) in self.rms.items()
            },
        }

    def _shown(self) -> tuple[str, list[Shows]]:
        figures: list[Shows] = [(f"{flank} {name}", change, reading(name)[1]) for flank, name, change in self.changes]
        rms = ", ".join(f"{flank} {1000 * a:.4g} of {1000 * b:.4g}" for flank, (b, a) in self.rms.items())
        figures.insert(0, ("RMS expected to remain", rms, "um"))
        return f"correction of the {self.measurement.member.name}", figures

    def _repr_html_(self) -> str:
        rows = [[flank, name, change] for flank, name, change in self.changes]
        remains = ", ".join(f"{f} {1000 * a:.2f} of {1000 * b:.2f} um" for f, (b, a) in self.rms.items())
        return html_table(f"expected to remain: {remains}", ["flank", "setting", "change (mm, degree)"], rows)


def _file_of(pair: GearSet, folder: Path) -> Path:
    """The file that a set was read from, for its comments, where it still holds that set; else one in the folder."""
    with suppress(InputError):
        if pair.source is not None and load_set(pair.source).spec == pair.spec:
            return pair.source
    return pair.save(folder / "before.toml")


@checked_call
def compensate(
    measured: Measurement,
    settings: str | Sequence[str] = "few",
    *,
    registered: bool = True,
    rotated: bool = True,
    objective: Literal["points", "surface"] = "points",
    higher_order: bool = False,
    bounds: Bounds = "machine",
    root_limit: float = ROOT_LIMIT,
    noise_um: float | None = None,
    mate: Measurement | str | Path | None = None,
    thickness: float = 0.0,
    thickness_by: By = "work_rotation_offset",
    begin: Begin = silent,
) -> Correction:
    """Corrected settings of what was measured; see :meth:`Measurement.compensate`."""
    member, name = measured.member.spec, measured.member.name
    moved = None
    with about(measured.source):
        chosen = _free(settings)
    if mate is not None:
        other = measurement_in(mate, measured.member.gear_set)
        if other.member.name == name:
            raise InputError(f"mate: is a measurement of the {name} too: that of the other member is wanted")
        moved = _moved(measured, other, registered)
    progress = begin(STAGES + correcting.STAGES, "stage")
    evaluation = measured.evaluate(registered, rotated, progress)
    found = evaluation.found
    with about(measured.source):
        found.closing.check_topography()
        corrected = correcting.correct(
            member,
            found.file,
            chosen,
            objective=objective,
            higher_order=higher_order,
            few=isinstance(settings, str) and settings == "few",
            root_limit=root_limit,
            noise=noise_of_points(measured.file, member, found, noise_um),
            added=moved,
            bounds=bounds,
            progress=progress,
            indexed=found.closing.withheld is None,
        )
    if thickness:
        corrected.settings.update(with_thickness(member, corrected.settings, thickness, thickness_by))
    return Correction(evaluation, corrected, noise_um, root_limit)


def _moved(measured: Measurement, mate: Measurement, registered: bool) -> dict[str, np.ndarray]:
    """Deviations of the mate's flanks, by flank of the measured member on its grid [mm]."""
    found = mate.evaluate(registered).found
    with about(mate.source):
        found.closing.check_topography()
        return moved_to_mate(measured.member.gear_set.spec, mate.member.name, found.file, measured.file)


#: Names of several settings; None where they suit the cutting method.
_CHOICES = {"few": None, "standard": None, "all": MACHINE_SETTINGS}


def _free(settings: str | Sequence[str]) -> tuple[str, ...] | None:
    """The settings that may change; None for those that suit the cutting method."""
    if isinstance(settings, str):
        if settings in _CHOICES:
            return _CHOICES[settings]
        if settings not in NAMES:
            known = ", ".join((*_CHOICES, *SETTINGS, NAMES[-1]))
            raise InputError(f"settings = {settings!r}: must be one of {known}, or a coefficient of a motion")
        return (settings,)
    variables_of(settings, 1)  # refuses what is no setting, before any work
    return tuple(settings)


def effects_um(effects: Mapping[str, Effect]) -> dict[str, Any]:
    """What errors of measurement do to each flank [um], by name."""
    return {
        "caused_rms_um": {flank: effect.caused * 1000 for flank, effect in effects.items()},
        "expected_u_um": {flank: effect.expected * 1000 for flank, effect in effects.items()},
    }

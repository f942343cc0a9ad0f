"""Measured members: evaluate, correct, and look."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from gearmath.bevel.pair import check_pair
from gearmath.errors import InputError
from gearmath.front.sets import GearSet, Member, load_set
from gearmath.front.tables import html_table
from gearmath.quality.correction.member import MemberCorrection as Corrected
from gearmath.quality.correction.member import correct, setting_changes
from gearmath.quality.evaluation.member import MemberEvaluation as Found
from gearmath.quality.evaluation.member import evaluate_member
from gearmath.specs.flank_csv import FlankFile, join, read_flank_csv, write_flank_csv
from gearmath.specs.set_text import save_corrected

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gearmath.front.judged import Uncertainty
    from gearmath.quality.correction.stock import Stock


@dataclass(frozen=True)
class Measurement:
    """The measured flanks of a member: ``file`` has points (n,3), normals, deviations (n,) [mm]; docs/files.md."""

    member: Member
    file: FlankFile

    @property
    def deviation(self) -> np.ndarray:
        """Deviations (n,) [mm] along the outward normals, positive where metal is left on."""
        return self.file.deviation

    def evaluate(self, registered: bool = True, rotated: bool = True) -> Evaluation:
        """Pitch, runout, thickness and topography, clamping and rotation of the work taken out.

        ``registered=False`` and ``rotated=False`` leave them in. Raises InputError where the points are not those of
        the member.
        """
        found = evaluate_member(self.file, self.member.spec, self.member.name, registered, rotated=rotated)
        return Evaluation(self, found)

    def compensate(self, settings: str | tuple[str, ...] = "few", **options: Any) -> Correction:
        """Corrected settings: the few that tell, "standard", or those named. Options as of :func:`correct`.

        Raises InputError where the measurement does not determine them, ComputationError where no correction helps.
        """
        found = self.evaluate().found
        found.closing.check_topography()
        free = None if settings in ("few", "standard") else tuple(settings)
        corrected = correct(self.member.spec, self.member.name, found.file, free, few=settings == "few", **options)
        return Correction(self, corrected)

    def uncertainty(self, sigma_um: float | None = None, model: str | None = None, draws: int = 20_000) -> Uncertainty:
        """How sure every figure of the evaluation and every corrected setting is.

        ``sigma_um`` is the standard uncertainty of every point, ``model`` a file of how the machine measures; where
        neither is given it is u_um of the file, or else the bundled model. Raises InputError where both are given.
        """
        from gearmath.front.judged import uncertainty

        return uncertainty(self, sigma_um, model, draws)

    def share_stock(self, advance: bool = False, least: float = 0.0) -> Stock:
        """How the precut blank that was measured must stand so that both flanks share its stock [rad, mm].

        With ``advance`` it may also be moved along its axis; ``least`` [mm] must remain everywhere. Raises InputError.
        """
        from gearmath.quality.correction.stock import share_stock

        return share_stock(self.member.spec, self.member.name, self.file, advance, least)

    def report(self, path: str | Path, *mate: Measurement, **head: str) -> Path:
        """Write the inspection sheet, HTML that prints on A4, of this member or with its ``mate``'s on the same sheet.

        ``head``: part_number, date, operator, machine, probe. Raises InputError where the mate is of the same member.
        """
        from gearmath.front.judged import report

        return report((self, *mate), Path(path), head)

    def to_csv(self, path: str | Path) -> Path:
        """Write the flank CSV of docs/files.md."""
        write_flank_csv(Path(path), self.file)
        return Path(path)

    def plot(self) -> Figure:
        """Topography of both flanks, pitch and runout as far as they were measured."""
        return self.evaluate().plot()


def load_measurement(path: str | Path, member: Member | GearSet) -> Measurement:
    """Read a measured flank CSV of a member, or of the member of a set that the file names. Raises InputError."""
    file = read_flank_csv(Path(path))
    one = member.member(file.member) if isinstance(member, GearSet) else member
    if file.member != one.name:
        raise InputError(f"{path}: member = {file.member}: the measurement of the {one.name} is wanted")
    return Measurement(one, file)


@dataclass(frozen=True)
class Evaluation:
    """The figures of a measured member: ``found`` has all in mm, :meth:`to_dict` in µm, as the command's JSON."""

    measurement: Measurement
    found: Found

    @property
    def remarks(self) -> tuple[str, ...]:
        """What was left out or taken out, and what should be looked at."""
        return self.found.remarks

    def to_dict(self) -> dict[str, Any]:
        """As ``gearmath evaluate --json`` prints it; lengths in µm where the name says so."""
        return self.found.as_dict()

    def plot(self) -> Figure:
        """Topography of both flanks, pitch and runout as far as they were measured."""
        from gearmath.plot import evaluation_figure

        return evaluation_figure(self.measurement.member.name, self.found)

    def _repr_html_(self) -> str:
        flanks = self.to_dict()["flanks"]
        names = [
            name
            for name in ("max_deviation_um", "rms_um", "F_p_um", "max_f_pt_um")
            if any(name in row for row in flanks.values())
        ]
        rows = [
            [flank, *("withheld" if row.get(name) is None else row[name] for name in names)]
            for flank, row in flanks.items()
        ]
        return html_table(f"{self.measurement.member.name}, as measured", ["flank", *names], rows)


@dataclass(frozen=True)
class Correction:
    """Corrected settings of a measured member: ``found`` has settings (12,) of each flank in mm and rad."""

    measurement: Measurement
    found: Corrected

    @property
    def changes(self) -> list[tuple[str, str, float]]:
        """Flank, setting, and by how much it is changed [mm, degrees, 1]."""
        from gearmath.specs.cut import ANGULAR

        member = self.measurement.member.spec
        return [
            (flank, name, math.degrees(new - old) if name in ANGULAR else new - old)
            for flank, name, old, new in setting_changes(member, self.found)
        ]

    @property
    def rms(self) -> dict[str, tuple[float, float]]:
        """By flank: RMS of the deviation [mm] as measured, and what is expected to remain."""
        return self.found.rms

    @property
    def gear_set(self) -> GearSet:
        """The set with corrected settings, motions, blades and index corrections; the nominal flanks stay."""
        with TemporaryDirectory() as folder:
            return load_set(self.save(Path(folder) / "corrected.toml"))

    @property
    def member(self) -> Member:
        """The member with the corrected settings; its nominal flanks stay what they were."""
        return self.gear_set.member(self.measurement.member.name)

    def save(self, path: str | Path) -> Path:
        """Write the corrected set as TOML, the nominal settings under ``design``. Raises InputError for no pair."""
        member, found = self.measurement.member, self.found
        with TemporaryDirectory() as folder:
            before = member.gear_set.save(Path(folder) / "before.toml")
            save_corrected(
                before,
                Path(path),
                member.name,
                found.settings,
                found.index,
                found.motions,
                found.curvatures,
                check=check_pair,
                origin=f"a measurement, and {member.gear_set.title}",
            )
        return Path(path)

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

    def _repr_html_(self) -> str:
        rows = [[flank, name, change] for flank, name, change in self.changes]
        remains = ", ".join(f"{f} {1000 * a:.2f} of {1000 * b:.2f} um" for f, (b, a) in self.rms.items())
        return html_table(f"expected to remain: {remains}", ["flank", "setting", "change (mm, degree)"], rows)


def deviations(member: Member, grid: tuple[int, int], margin: float) -> Measurement:
    """The flanks that the settings of a member cut, as deviations from the nominal ones."""
    from gearmath.bevel.flank import blank_grid, solve_flank
    from gearmath.bevel.identify.flank_target import predicted
    from gearmath.bevel.nominal_file import flank_header
    from gearmath.quality.correction.target import target_of
    from gearmath.specs.bevel_set import FLANKS
    from gearmath.specs.flank_csv import flank_file

    places = blank_grid(member.spec, *grid, margin)
    header = flank_header(member.spec, member.name, grid, margin)
    row, col = (index.ravel() for index in np.indices(grid))
    files = []
    for flank in FLANKS:
        nominal = solve_flank(member.spec, member.name, flank, places)
        target = target_of(member.spec, flank, nominal)
        deviation, _ = predicted(target, target.vector)
        point = nominal.point + deviation[:, None] * nominal.normal
        files.append(flank_file(header, member.name, flank, 0, row, col, point, nominal.normal, deviation))
    return Measurement(member, join(files))

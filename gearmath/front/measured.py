"""Measured members: evaluate, correct, and look."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gearmath.arguments.call import checked_call
from gearmath.arguments.composed import Either
from gearmath.arguments.kinds import Record, Text
from gearmath.arguments.known import MEMBER, ORIGIN, SET
from gearmath.errors import InputError, about
from gearmath.files import write_text
from gearmath.front.member import Member
from gearmath.front.progress import Begin, Progress, silent, unheard
from gearmath.front.sets import GearSet, set_of
from gearmath.quality.evaluation.file_checks import check_belongs
from gearmath.quality.evaluation.member import evaluate_member
from gearmath.shown import Shown, Shows
from gearmath.specs.bevel_set import FLANKS, MEMBERS
from gearmath.specs.flank_csv import FlankFile, check_made, join, read_flank_csv, write_flank_csv

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gearmath.front.corrected import Correction
    from gearmath.front.evaluated import Evaluation
    from gearmath.front.judged import Uncertainty
    from gearmath.front.machines import Machine
    from gearmath.quality.correction.stock import Stock
    from gearmath.quality.foreign.member import Phase
    from gearmath.quality.foreign.points import Frame
    from gearmath.specs.calibration import Calibration


@checked_call(file=Record("gearmath.specs.flank_csv", "FlankFile", "a flank file"), source=ORIGIN)
@dataclass(frozen=True, repr=False)
class Measurement(Shown):
    """The measured flanks of a member: ``file`` has points (n,3), normals, deviations (n,) [mm]; docs/files.md.

    ``source`` is where it was read, for sentences.
    """

    member: Member
    file: FlankFile
    source: Path | None = None

    def __post_init__(self) -> None:
        check_made(self.file)

    @staticmethod
    @checked_call
    def from_touches(
        path: str | Path,
        pair: GearSet | str | Path,
        machine: Machine | str | Path | None = None,
        probe: Calibration | str | Path | None = None,
        run: int | None = None,
    ) -> Measurement:
        """Raw touches of a probing program as corrected contact points and deviations [mm].

        By default those of the last run, which must be whole. Raises InputError naming file and point.
        """
        from gearmath.front.machines import machine_of, probe_of
        from gearmath.quality.evaluation.measured_run import measured_run

        pair = set_of(pair)
        made = measured_run(Path(path), pair.spec, machine_of(machine).spec, probe_of(probe), run)
        return Measurement(pair.member(made.touches.member), made.file)

    @staticmethod
    @checked_call
    def from_points(
        paths: Mapping[tuple[str, int], str | Path],
        member: Member,
        unit: str = "mm",
        frame: Frame | None = None,
        phase: Phase = "common",
        leave_out: bool = False,
    ) -> Measurement:
        """Points of another measuring machine, as plain text, by flank and tooth: ``{("concave", 0): "points.txt"}``.

        ``frame`` says how the axes of the files lie, by default z from the apex to the back, ``phase`` whether they are
        turned in common, each, or kept; ``leave_out`` takes files with gaps; docs/files.md. Raises InputError naming
        file and line.
        """
        from gearmath.front.judged import foreign_points
        from gearmath.specs.point_text import read_point_text

        texts = {where: read_point_text(Path(path), unit) for where, path in paths.items()}
        made = foreign_points(texts, member, frame, phase, leave_out)
        if made.found.gaps and not leave_out:
            raise InputError(f"{made.found.gaps[0]}; leave_out takes the other points")
        return made.measurement

    @property
    def deviation(self) -> np.ndarray:
        """Deviations (n,) [mm] along the outward normals, positive where metal is left on."""
        return self.file.deviation

    @checked_call
    def evaluate(self, registered: bool = True, rotated: bool = True, progress: Progress = unheard) -> Evaluation:
        """Pitch, runout, thickness and topography, clamping and rotation of the work taken out.

        ``registered=False`` and ``rotated=False`` leave them in; ``progress`` hears of every stage, of ``STAGES``.
        Raises InputError where the points are not those of the member.
        """
        from gearmath.front.evaluated import Evaluation

        with about(self.source):
            found = evaluate_member(self.file, self.member.spec, registered, progress, rotated)
        return Evaluation(self, found)

    def compensate(self, settings: str | Sequence[str] = "few", **options: Any) -> Correction:
        """Corrected settings: the "few" that tell, "standard", "all", or those named.

        ``options``: registered and rotated as of :meth:`evaluate`; objective ("points", or "surface": cubic ones);
        higher_order, to correct motions too; bounds ("machine" or "design"); root_limit [mm], the most that the root
        line may move; noise_um of one deviation, else that of the file, else what is left; mate, a measurement whose
        deviations are corrected here; thickness [mm] by which teeth become thicker, thickness_by what makes them.
        Raises InputError where the measurement does not determine them, ComputationError where no correction helps.
        """
        from gearmath.front.corrected import compensate

        return compensate(self, settings, **options)

    def uncertainty(
        self, sigma_um: float | None = None, model: str | None = None, draws: int = 20_000, **options: Any
    ) -> Uncertainty:
        """How sure every figure of the evaluation and every corrected setting is.

        ``sigma_um`` is the standard uncertainty of every point, ``model`` a file of how the machine measures; where
        neither is given it is u_um of the file, or else the bundled model. ``options``: registered and rotated as of
        :meth:`evaluate`; machine and probe, files of the model; seed, workers, executor and resume of the draws.
        Raises InputError where both are given.
        """
        from gearmath.front.judged import uncertainty

        return uncertainty(self, sigma_um, model, draws, **options)

    @checked_call
    def share_stock(self, advance: bool = False, least: float = 0.0) -> Stock:
        """How the precut blank that was measured must stand so that both flanks share its stock [rad, mm].

        With ``advance`` it may also be moved along its axis; ``least`` [mm] must remain everywhere. Returns ``turn``
        [rad], ``advance`` [mm], and by flank ``least``, ``mean`` and ``most`` of the stock then, and ``least_before``
        [mm]. Raises InputError.
        """
        from gearmath.quality.correction.stock import share_stock

        with about(self.source):
            return share_stock(self.member.spec, self.file, advance, least)

    @checked_call(**dict.fromkeys(("part_number", "date", "operator", "machine", "probe"), Text()))
    def report(
        self,
        path: str | Path,
        *mate: Measurement | str | Path,
        again: Sequence[Measurement | str | Path] = (),
        part_number: str | None = None,
        date: str | None = None,
        operator: str | None = None,
        machine: str | None = None,
        probe: str | None = None,
        begin: Begin = silent,
    ) -> Path:
        """Write the inspection sheet, HTML that prints on A4, of this member or with its ``mate``'s on the same sheet.

        ``again``: members measured again after the correction. Its head has part number, date, operator, machine and
        probe, or those that the file states. Returns the path. Raises InputError where the mate is of the same member,
        or ``again`` is of another.
        """
        from gearmath.front.judged import inspection

        mates, seconds = ([measurement_in(one, self.member.gear_set) for one in each] for each in (mate, again))
        said = {"part_number": part_number, "date": date, "operator": operator, "machine": machine, "probe": probe}
        head = {key: text for key, text in said.items() if text is not None}
        sheet = inspection((self, *mates), [head] * (1 + len(mates)), seconds, begin=begin)
        write_text(Path(path), sheet.html)
        return Path(path)

    @checked_call
    def to_csv(self, path: str | Path) -> Path:
        """Write the flank CSV of docs/files.md."""
        write_flank_csv(Path(path), self.file)
        return Path(path)

    def to_dict(self) -> dict[str, Any]:
        """Header and columns of the flank CSV; what it does not say is None."""
        columns = {name: getattr(self.file, name) for name in ("flank", "tooth", "row", "col", "point", "normal")}
        silent = {"deviation": self.file.deviation, "u": self.file.uncertainty}
        return {
            "member": self.member.name,
            "header": dict(self.file.header),
            **{name: values.tolist() for name, values in columns.items()},
            **{name: [None if np.isnan(one) else float(one) for one in values] for name, values in silent.items()},
        }

    def plot(self) -> Figure:
        """Topography of both flanks, pitch and runout as far as they were measured."""
        return self.evaluate().plot()

    def _shown(self) -> tuple[str, list[Shows]]:
        file, known = self.file, self.deviation[~np.isnan(self.deviation)]
        figures: list[Shows] = [("points", len(file), "")]
        if len(known):
            largest, rms = float(known[abs(known).argmax()]), float(np.sqrt(np.mean(known**2)))
            figures += [("largest deviation", 1000 * largest, "um"), ("RMS", 1000 * rms, "um")]
        figures.append(("teeth", len(set(file.tooth.tolist()) - {self.member.teeth}), f"of {self.member.teeth}"))
        where = "" if self.source is None else f", {self.source.name}"
        return f"measured {self.member.name}{where}", figures


def measurement_of(path: str | Path, pair: GearSet, member: str | None) -> Measurement:
    """A measured flank CSV, of the ``member`` that was asked for or else of the one that the file names.

    Whether it is of that member is told where it is evaluated. Raises InputError.
    """
    file = read_flank_csv(Path(path))
    return Measurement(pair.member(member or file.member), file, Path(path))


@checked_call(member=Either((MEMBER, SET), "must be a member, a gear set, or the file of a set"))
def load_measurement(path: str | Path, member: Member | GearSet | str | Path) -> Measurement:
    """Read a measured flank CSV of a member, or of the member of a set that the file names.

    Raises InputError, also where it was measured against other nominal flanks.
    """
    if isinstance(member, str) and member in MEMBERS:
        raise InputError(f"member = {member!r}: must be the member itself, such as load_set(...).{member}, or its set")
    file = read_flank_csv(Path(path))
    one = member if isinstance(member, Member) else set_of(member).member(file.member)
    if file.member != one.name:
        raise InputError(f"{path}: member = {file.member}: the measurement of the {one.name} is wanted")
    with about(Path(path)):
        check_belongs(one.spec, file)
    return Measurement(one, file, Path(path))


def measurement_in(given: Measurement | str | Path, pair: GearSet) -> Measurement:
    """A measurement, or that of a file, of the member of a pair that the file names.

    Raises InputError, also where it counts from other nominal flanks than those of the pair.
    """
    if not isinstance(given, Measurement):
        return load_measurement(given, pair)
    own, member = given.member, pair.member(given.member.name)
    with about(given.source):
        if own.teeth != member.teeth:
            raise InputError(f"member_teeth = {own.teeth}: the {own.name} of the set has {member.teeth}")
        for flank in FLANKS:
            counted_from, wanted = (one.spec.flank(flank).nominal.vector for one in (own, member))
            if not np.allclose(counted_from, wanted, rtol=0, atol=1e-8):  # a set may be of a file with nine decimals
                raise InputError(
                    f"{own.name}.{flank}: was measured against other nominal settings than those of the pair"
                )
    return given


def deviations(member: Member, grid: tuple[int, int], margin: float) -> Measurement:
    """The flanks that the settings of a member cut, as deviations from the nominal ones."""
    from gearmath.bevel.flank import blank_grid, solve_flank
    from gearmath.bevel.identify.flank_target import predicted
    from gearmath.bevel.nominal_file import flank_header
    from gearmath.quality.correction.target import target_of
    from gearmath.specs.flank_csv import flank_file

    places = blank_grid(member.spec, *grid, margin)
    header = flank_header(member.spec, grid, margin)
    row, col = (index.ravel() for index in np.indices(grid))
    files = []
    for flank in FLANKS:
        nominal = solve_flank(member.spec, flank, places)
        target = target_of(member.spec, flank, nominal)
        deviation, _ = predicted(target, target.vector)
        point = nominal.point + deviation[:, None] * nominal.normal
        files.append(flank_file(header, member.name, flank, 0, row, col, point, nominal.normal, deviation))
    return Measurement(member, join(files))

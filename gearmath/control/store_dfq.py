"""The figures of stored runs as quality data: a run is a part, and the tolerances are those of a grade."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime

from gearmath.control.run_start import MACHINE
from gearmath.control.store_compare import BOTH, side_by_side
from gearmath.control.store_evaluation import EvaluatedRun
from gearmath.control.store_summary import summary
from gearmath.exchange.dfq import Characteristic, DfqPart, Measured, dfq
from gearmath.quality.evaluation.tolerance import gear_data, iso17485
from gearmath.specs.bevel_set import design_sha256
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.toml import parse

#: Figures that a grade limits, by their names in the JSON of ``evaluate``.
_LIMITED = {"max_f_pt_um": "f_pt", "F_p_um": "F_p", "F_r_um": "F_r"}


def runs_dfq(runs: Sequence[EvaluatedRun], grade: int | None = None) -> bytes:
    """A DFQ file of the figures of runs of one member, with the tolerances of a grade where one is given.

    The time of a part is that of its last touch, in the time zone of this computer. Raises InputError for runs that
    cannot be compared, and for a grade that there is not.
    """
    first, member = runs[0], runs[0].member
    limits: dict[str, float] = {}
    if grade is not None:
        data = gear_data(member)
        limits = iso17485(data.mean_normal_module, data.tolerance_diameter, grade).rounded
    figures = side_by_side(runs)
    characteristics = [
        Characteristic(
            f"{flank} {name.removesuffix('_um')}",
            _said(flank, name),
            "µm",
            upper=limits.get(_LIMITED.get(name, "")),
        )
        for flank, name in figures
    ]
    machine = parse(first.run.start.files[MACHINE].decode("utf-8-sig"), MillingMachine, MACHINE)
    part = DfqPart(
        f"{first.name} {design_sha256(member)[:12]}",
        f"{first.gear_set.title}, {first.name}, {member.teeth} teeth",
        machine.name,
        f"probing, {first.run.start.program}",
    )
    of_runs = zip(*figures.values(), strict=True)
    measured = [Measured(_measured_at(run), values) for run, values in zip(runs, of_runs, strict=True)]
    return dfq(part, characteristics, measured)


def _said(flank: str, name: str) -> str:
    words = name.removesuffix("_um").replace("max_", "largest ").replace("_deviation", " deviation")
    words = words.replace("_crowning", " crowning").replace("_angle", " angle")
    return f"{words}, both flanks" if flank == BOTH else f"{words}, {flank} flank"


def _measured_at(run: EvaluatedRun) -> datetime:
    found = summary(run.run)
    return datetime.fromisoformat(found.last_touch or found.begun).astimezone()

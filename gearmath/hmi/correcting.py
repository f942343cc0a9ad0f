"""A correction from a stored run: what it would change and leave, then accepted into new files, or rejected."""

from __future__ import annotations

import hashlib
import json
import re
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from gearmath.bevel.pair import check_corrected, load_pair
from gearmath.control.run_start import MACHINE, SET
from gearmath.control.store_evaluation import EvaluatedRun
from gearmath.control.store_run import noted, now
from gearmath.errors import ComputationError, InputError
from gearmath.files import write_text
from gearmath.front.machines import Machine
from gearmath.front.programs import cutting
from gearmath.front.sets import GearSet
from gearmath.hmi.drawing import drawn
from gearmath.hmi.judged_runs import JudgedRuns, stored_files
from gearmath.machine.judging.dialects import named
from gearmath.plot.sheet import topography_chart
from gearmath.plot.topography import um_per_row
from gearmath.quality.correction.member import MemberCorrection, correct
from gearmath.quality.correction.values import correction_values
from gearmath.quality.evaluation.topography import Topography, zeroed
from gearmath.quality.uncertainty.corrected import noise_of_points
from gearmath.report.charts import expected_topographies, first
from gearmath.specs.bevel_set import MACHINE_SETTINGS
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.set_text import save_corrected

#: Which settings a correction may change; the first one is the default.
WHICH = ("few", "standard", "all")
#: How the store calls what the operator decided.
DECISION = "decision.json"
_ONE_AT_A_TIME = threading.Lock()


@dataclass(frozen=True)
class Proposal:
    """A correction of a run that nobody has accepted yet."""

    evaluated: EvaluatedRun
    which: str
    correction: MemberCorrection

    @cached_property
    def values(self) -> dict[str, Any]:
        """As ``gearmath compensate --json`` prints it."""
        return correction_values(self.evaluated.member, self.correction)

    @property
    def changes_nothing(self) -> bool:
        """Whether neither a setting nor the index of a tooth would be another."""
        return not self.values["changes"] and not any(self.values["index_correction_deg"])

    @cached_property
    def after(self) -> dict[str, Topography]:
        """What is expected to remain of it [mm]."""
        return expected_topographies(self.evaluated.member, self.evaluated.found, self.correction)

    def charts(self, drawn_before: dict[tuple[str, float], str]) -> dict[str, tuple[str, str]]:
        """Each flank before and after as SVG, all at one scale, the reference point of each turned to zero.

        ``drawn_before`` keeps the charts before by flank and scale: they are those of every correction of the run.
        """
        file = self.evaluated.found.file
        later = {flank: (zeroed(form, file), form.at_reference) for flank, form in self.after.items()}
        scale = max(um_per_row(form for form, _ in later.values()), scale_before(self.evaluated))
        before = charts_before(self.evaluated, scale, drawn_before)
        return {
            flank: (before[flank], drawn(lambda form=form, taken=taken: topography_chart(form, scale, taken)))  # type: ignore[misc]
            for flank, (form, taken) in later.items()
        }


def scale_before(evaluated: EvaluatedRun) -> float:
    """The scale [µm] that suits the first tooth of each flank as it was measured."""
    found = evaluated.found
    return um_per_row(zeroed(form, found.file) for form in first(found).values())


def charts_before(evaluated: EvaluatedRun, scale: float, kept: dict[tuple[str, float], str]) -> dict[str, str]:
    """The first tooth of each flank as it was measured, as SVG; those that are ``kept`` are not drawn again."""
    file = evaluated.found.file
    for flank, form in first(evaluated.found).items():
        if (flank, scale) not in kept:
            shown = zeroed(form, file)
            kept[flank, scale] = drawn(lambda s=shown, f=form: topography_chart(s, scale, f.at_reference))  # type: ignore[misc]
    return {flank: kept[flank, scale] for flank in first(evaluated.found)}


def propose(evaluated: EvaluatedRun, which: str = WHICH[0]) -> Proposal:
    """The correction as ``gearmath compensate`` makes it. Raises InputError, ComputationError where there is none."""
    found, member = evaluated.found, evaluated.member
    found.closing.check_topography()
    correction = correct(
        member,
        found.file,
        MACHINE_SETTINGS if which == "all" else None,
        few=which == "few",
        noise=noise_of_points(evaluated.file, member, found, None),
        indexed=found.closing.withheld is None,
    )
    return Proposal(evaluated, which, correction)


@dataclass(frozen=True)
class Accepted:
    """The files of a correction that was accepted."""

    gear_set: Path
    program: Path
    blocks: int


def accept(runs: JudgedRuns, proposal: Proposal, folder: Path) -> Accepted:
    """Write the corrected set and its cutting program as new files of ``folder``; the run keeps the decision.

    No file is written over. Raises ComputationError where the corrected set is no pair, InputError where the machine of
    the run cannot cut it: then nothing is written.
    """
    evaluated = proposal.evaluated
    name, number = evaluated.name, evaluated.run.id
    with _ONE_AT_A_TIME, stored_files(evaluated) as stored:
        was_called = evaluated.run.start.settings.get(SET, "set.toml")
        gear_set = free_file(folder, f"{_stem(was_called)}_run{number}", ".toml")
        machine = Machine(load_milling_machine(stored / MACHINE))
        suffix = named(machine.spec.control.dialect(None)).suffix
        program = free_file(folder, f"{name.upper()}_R{number}", suffix)
        new = stored / gear_set.name
        _write_set(proposal, stored / SET, new)
        made = cutting(GearSet(load_pair(new)).member(name), machine, program.stem)
        write_text(gear_set, new.read_text("utf-8"))
        try:
            made.save(program)
        except InputError:
            gear_set.unlink()
            raise
        _decide(runs, number, "accepted", {"set": gear_set, "program": program})
    return Accepted(gear_set, program, made.blocks)


def reject(runs: JudgedRuns, proposal: Proposal, note: str) -> None:
    """Keep with the run that its correction was not wanted, and why.

    Raises InputError for a note that is missing or too long.
    """
    _decide(runs, proposal.evaluated.run.id, "rejected", {}, noted(note))


def free_file(folder: Path, stem: str, suffix: str) -> Path:
    """A file of a folder that is not there yet: the stem, or with the first number behind it that is free."""
    names = (f"{stem}{suffix}", *(f"{stem}_{k}{suffix}" for k in range(2, 1000)))
    for name in names:
        if not (folder / name).exists():
            return folder / name
    raise ComputationError(f"{folder / names[0]}: there are a thousand files of this name")


def _write_set(proposal: Proposal, source: Path, target: Path) -> None:
    found, run = proposal.correction, proposal.evaluated.run
    save_corrected(
        source,
        target,
        proposal.evaluated.name,
        found.settings,
        found.index,
        found.motions,
        found.curvatures,
        check=check_corrected,
        origin=f"run {run.id} of {run.store.path.name}, and {_stem(run.start.settings.get(SET, SET))}.toml",
    )


def _stem(name: str) -> str:
    """The name of a set without its folder and ending, as far as it can be that of a file anywhere."""
    plain = re.sub(r"[^A-Za-z0-9_-]+", "_", Path(name).stem)[:60].strip("_-")
    return re.sub(r"(_run\d+)+(_\d+)?$", "", plain) or "set"


def _decide(runs: JudgedRuns, run: int, decision: str, files: Mapping[str, Path], note: str = "") -> None:
    """Keep a decision with the run; later ones are added, none is removed."""
    written = {
        what: {"name": path.name, "sha256": hashlib.sha256(path.read_bytes()).hexdigest()}
        for what, path in files.items()
    }
    content = {"decision": decision, "at": now(), "note": note, "files": written}
    with runs.opened() as store:
        store.run(run).add_result(DECISION, json.dumps(content, indent=2).encode())

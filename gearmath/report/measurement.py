"""What an inspection sheet is made of."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from gearmath.quality.correction.member import MemberCorrection
from gearmath.quality.evaluation.member import MemberEvaluation
from gearmath.quality.uncertainty.propagation import Uncertain
from gearmath.specs.bevel_set import Member
from gearmath.specs.flank_csv import FlankFile

#: What people write at the head of a sheet: header key of the file, and its label.
FIELDS = {
    "part_number": "Part number",
    "date": "Date",
    "operator": "Operator",
    "machine": "Machine",
    "probe": "Probe",
}


@dataclass(frozen=True)
class ReportedMeasurement:
    """One member on the sheet.

    ``title`` names the set, ``source`` the file; ``head`` has a text for each of ``FIELDS`` that is known; ``figures``
    and ``settings`` are those with uncertainties, which come from ``how_sure``; ``caused`` is the RMS [mm] that errors
    of measurement will leave on each flank after the correction; ``again`` is the member measured after it was cut with
    corrected settings, if it was.
    """

    title: str
    source: str
    member: Member
    evaluation: MemberEvaluation
    correction: MemberCorrection | None
    head: Mapping[str, str] = field(default_factory=dict)
    figures: Sequence[Uncertain] = ()
    settings: Sequence[Uncertain] = ()
    caused: Mapping[str, float] = field(default_factory=dict)
    how_sure: str = ""
    again: MemberEvaluation | None = None
    remarks: Sequence[str] = ()

    def uncertain(self, flank: str, name: str) -> Uncertain | None:
        """A figure with its uncertainty, None where it is not known."""
        return next((one for one in self.figures if (one.figure.flank, one.figure.name) == (flank, name)), None)


@dataclass(frozen=True)
class Report:
    """The page, and its pictures by name (PNG)."""

    html: str
    pictures: dict[str, bytes] = field(default_factory=dict)


def head_of(file: FlankFile, given: Mapping[str, str]) -> dict[str, str]:
    """What is known for the head of the sheet: as ``given``, or else as a header comment of the file says."""
    said = {re.sub(r"[\s-]+", "_", key.lower()): value for key, value in file.header.items()}
    return {key: given.get(key) or said.get(key, "") for key in FIELDS}


def counted(found: MemberEvaluation) -> str:
    """How many of the points the figures come from."""
    used = int(np.isfinite(found.file.deviation).sum())
    left_out = "" if used == len(found.file) else f", {len(found.file) - used} left out"
    return f"{used} of {len(found.file)} used{left_out}"


def in_words(text: str) -> str:
    """A sentence or a unit as people read it: the rest of the program writes um for µm."""
    return re.sub(r"(?<![-\w])um\b", "µm", text)  # not in the name of an option


def micro(value: float) -> str:
    """mm as µm, empty for what is not known; less than a nanometre is nothing."""
    if not np.isfinite(value):
        return ""
    return f"{0.0 if abs(value) < 1e-6 else value * 1000:.2f}"


def unsure(value: float) -> str:
    """A standard uncertainty in mm as µm: none is zero."""
    return "< 0.01" if 0 < value < 5e-6 else micro(value)


def taken_out(found: MemberEvaluation) -> str:
    """What was taken out of the deviations before they were judged, in words."""
    parts = ["drift"] * bool(found.drifts) + ["clamping"] * (found.taken_out is not None)
    parts += ["the rotation that both flanks have in common"] * (found.rotation is not None)
    return (
        f"{' and '.join([', '.join(parts[:-1]), parts[-1]] if parts[1:] else parts)} taken out"
        if parts
        else ("nothing taken out")
    )

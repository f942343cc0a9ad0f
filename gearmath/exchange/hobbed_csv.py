"""The measured points of a virtual gear as CSV: where, and how far off along the normal."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from gearmath.files import write_text
from gearmath.gearbox.hobbed.inspection import SIDES, Inspection, MeasuredTrace
from gearmath.gearbox.hobbed.job import HobbingJob
from gearmath.gearbox.kernels import kernel

HEAD = "trace,flank,tooth,roll_length,height,x,y,z,nx,ny,nz,deviation_um"


def write_traces(path: Path, job: HobbingJob, found: Inspection) -> None:
    """Write every traced point of a gear, mm; the point is the nominal one, the normal points out of the metal."""
    head = [
        "# frame: gear, z its axis from the lower face",
        "# unit: mm",
        f"# teeth: {job.gear.teeth}",
        f"# module: {job.gear.module:.9g}",
    ]
    write_text(path, "\n".join([*head, HEAD, *_rows(job, found)]) + "\n")


def _rows(job: HobbingJob, found: Inspection) -> Iterator[str]:
    for kind, traces in (("profile", found.profiles), ("helix", found.helices)):
        for trace in traces:
            for values in _points(job, kind, trace):
                numbers = ",".join(f"{value:.6f}" for value in values)
                yield f"{kind},{trace.side},{trace.tooth},{numbers}"


def _points(job: HobbingJob, kind: str, trace: MeasuredTrace) -> np.ndarray:
    """Roll length, height, point, normal, deviation [µm] of every point (n, 9)."""
    size = len(trace.place)
    other = np.full(size, trace.across)
    length, height = (trace.place, other) if kind == "profile" else (other, trace.place)
    side, gear = SIDES[trace.side], job.gear
    space = trace.tooth if side == 1 else trace.tooth + 1
    shape = (gear.teeth, gear.module, gear.alpha, gear.beta, gear.shift)
    point, normal = kernel("involute_flank")(length, height, space, side, job.helix_sign, *shape)
    return np.column_stack([length, height, point, normal, trace.deviation * 1000])

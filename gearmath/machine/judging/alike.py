"""Spaces that a program cuts alike: what one of them is, all of them are, but for the rounding of the positions."""

from __future__ import annotations

import numpy as np

from gearmath.machine.milling.run import CuttingRun
from gearmath.machine.planning.passes import tooth_angles
from gearmath.specs.bevel_set import Member
from gearmath.specs.milling_machine import MillingMachine


def alike(runs: list[CuttingRun], member: Member, machine: MillingMachine) -> dict[int, list[int]]:
    """The spaces cut by ``runs``, by the first of those whose passes are the same within the increments of the control.

    A pass begins where its first block does, at the end of the rapid motion to it.
    """
    found: dict[int, list[int]] = {}
    passes = {space: _passes(runs, space, member) for space in sorted({k for run in runs for k in run.spaces})}
    near = 2.0 * machine.control.half_increments + 1e-12
    for space, own in passes.items():
        for first in found:
            if _same(own, passes[first], near):
                found[first].append(space)
                break
        else:
            found[space] = [space]
    return found


def _passes(runs: list[CuttingRun], space: int, member: Member) -> list[np.ndarray]:
    """Positions (n,6) of the passes through a space as they are in space 0, with whether the block to them cuts."""
    angle = tooth_angles(member.teeth, member.rad("index_correction"))[space]
    found = []
    for run in runs:
        cut = run.cutting & (run.space == space)
        rows = np.flatnonzero(cut | np.append(cut[1:], False))
        found.append(np.column_stack([run.axes[rows] - np.array([0.0, 0.0, 0.0, angle, 0.0]), cut[rows]]))
    return found


def _same(one: list[np.ndarray], other: list[np.ndarray], near: np.ndarray) -> bool:
    """Whether passes are the same within ``near`` (5,), A by whole turns."""
    for a, b in zip(one, other, strict=True):
        if a.shape != b.shape:
            return False
        off = a - b
        off[:, 3] = np.remainder(off[:, 3] + np.pi, 2 * np.pi) - np.pi
        if (np.abs(off[:, :5]) > near).any() or off[:, 5].any():
            return False
    return True

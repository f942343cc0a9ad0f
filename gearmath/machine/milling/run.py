"""An executed program tool by tool: where its axes really stand, with what cutter, and which space each pass cuts."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from gearmath.bevel.method import motion_of
from gearmath.bevel.tooth import ToothSpace
from gearmath.errors import InputError
from gearmath.machine.bodies.blades import Blades, blades_of
from gearmath.machine.bodies.cutter import Cutter, cutter_of
from gearmath.machine.control.executor import MachinePath
from gearmath.machine.milling.axis_errors import (
    divisions,
    index_errors,
    pitch_divisions,
    with_axis_errors,
    with_backlash,
    with_running_index_errors,
    with_setting_errors,
)
from gearmath.machine.planning.path import Cut, axis_positions, roll_range
from gearmath.shown import Shown, Shows
from gearmath.specs.bevel_set import Member
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.simulated_machine import SimulatedMachine

#: Positions of the nominal path that a pass is compared with, to see which space it is indexed to.
_NOMINAL_POSITIONS = 201


@dataclass(frozen=True, repr=False)
class CuttingRun(Shown):
    """The blocks of one tool: real axis positions (n,5), which of them cut (n,), and the space (n,) of each, or -1.

    ``line`` (n,) is the number of the line in the program text; ``inner`` (n,) says which rows end within a block of
    POLY, whose straight parts these rows are. In face hobbing, ``blades`` cut one by one at the
    positions ``turned`` (n,) of C, and every block cuts in all spaces.
    """

    cut: Cut
    cutter: Cutter
    axes: np.ndarray
    cutting: np.ndarray
    space: np.ndarray
    line: np.ndarray
    blades: Blades | None = None
    turned: np.ndarray = field(default_factory=lambda: np.zeros(0))
    inner: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=bool))

    @property
    def at_ends(self) -> np.ndarray:
        """Whether the rows (n,) are ends of blocks as they are written."""
        return ~self.inner if len(self.inner) else np.ones(len(self.axes), dtype=bool)

    @property
    def spaces(self) -> list[int]:
        """The tooth spaces in the order in which they are cut."""
        if self.blades is not None:
            return list(range(self.blades.teeth))
        return list(dict.fromkeys(self.space[self.space >= 0].tolist()))

    def _shown(self) -> tuple[str, list[Shows]]:
        return f"blocks of one tool, {' and '.join(self.cut.flanks)} flank", [
            ("rows", len(self.axes), ""),
            ("cutting", int(self.cutting.sum()), ""),
            ("spaces", len(self.spaces), ""),
        ]


def runs_of(
    path: MachinePath,
    member: Member,
    machine: MillingMachine,
    errors: SimulatedMachine | None,
    space: ToothSpace | None = None,
    edge_radius: float = 0.0,
) -> list[CuttingRun]:
    """The program's tools in their order. Raises InputError if one of them is not of this member."""
    cuts = {cut.tool: cut for cut in Cut.of(member)}
    for tool in path.tools:
        if tool not in cuts:
            raise InputError(f'the program cuts with T="{tool}"; the {member.name} is cut with {" and ".join(cuts)}')
    if member.process == "face_hobbing":
        return [_hobbing_run(path, member, cuts[path.tools[0]], machine, errors, edge_radius)]
    if np.isfinite(path.cutter).any():
        raise InputError(f"the program turns the cutter as axis C; the {member.name} is face milled")
    runs = []
    for index, tool in enumerate(path.tools):
        here = path.tool == index
        axes, cutting, cut, line = path.axes[here], ~path.rapid[here], cuts[tool], path.line[here]
        inner = path.inner[here] if len(path.inner) else np.zeros(len(axes), dtype=bool)
        indexed = _spaces(axes, cutting, member, cut, machine)
        if errors is not None:
            settings, setting_errors = member.flank(cut.flanks[0]).nominal.vector, errors.setting_errors(member.name)
            axes, own = _divided(axes, np.where(cutting[1:], divisions(axes, errors), 1))
            cutting, indexed, line, inner = cutting[own], indexed[own], line[own], inner[own]
            motion = motion_of(member.flank(cut.flanks[0]))
            axes = with_setting_errors(axes, settings, setting_errors, machine.pivot, motion)
            turned = np.where(indexed >= 0, index_errors(errors.work_axis, member.teeth, errors.seed)[indexed], 0.0)
            axes = with_backlash(axes, errors) + turned[:, None] * np.array([0, 0, 0, 1, 0])
            axes = with_axis_errors(axes, errors)
        cutter = cutter_of(member, cut.flanks, space, edge_radius)
        runs.append(CuttingRun(cut, cutter, axes, cutting, indexed, line, inner=inner))
    return runs


def _divided(axes: np.ndarray, parts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions (m,5) with every block in so many equal parts (n-1,), and the block (m,) that each one belongs to."""
    own = np.repeat(np.arange(1, len(axes)), parts)
    last = np.cumsum(parts)
    share = (np.arange(1, len(own) + 1) - (last - parts)[own - 1]) / parts[own - 1]
    between = axes[own] - (1.0 - share)[:, None] * (axes[own] - axes[own - 1])
    return np.concatenate([axes[:1], between]), np.concatenate([[0], own])


def _hobbing_run(
    path: MachinePath,
    member: Member,
    cut: Cut,
    machine: MillingMachine,
    errors: SimulatedMachine | None,
    edge_radius: float,
) -> CuttingRun:
    """The run of a face hobbing program. Raises InputError where it cuts without C."""
    cutting = ~path.rapid
    still = cutting & ~np.isfinite(path.cutter)
    if still.any():
        line = int(path.line[np.argmax(still)])
        raise InputError(f"line {line} cuts while the spindle is no axis C; the {member.name} is face hobbed")
    axes, turned, lines, inner = path.axes, path.cutter, path.line, path.inner
    if errors is not None:
        spec, index = member.flank(cut.flanks[0]), index_errors(errors.work_axis, member.teeth, errors.seed)
        settings, given = spec.nominal.vector, (machine.pivot, motion_of(spec))
        parts = np.maximum(divisions(axes, errors), pitch_divisions(axes, index))
        six, own = _divided(np.column_stack([axes, turned]), np.where(cutting[1:], parts, 1))
        six = with_running_index_errors(six, settings, index, *given)
        six = with_setting_errors(six, settings, errors.setting_errors(member.name), *given)
        axes = with_axis_errors(with_backlash(six[:, :5], errors), errors)
        turned, cutting, lines = six[:, 5], cutting[own], lines[own]
        inner = inner[own] if len(inner) else inner
    cutter = cutter_of(member, cut.flanks, None, edge_radius)
    spaces = np.full(len(cutting), -1)
    return CuttingRun(cut, cutter, axes, cutting, spaces, lines, blades_of(member, edge_radius), turned, inner)


def _spaces(axes: np.ndarray, cutting: np.ndarray, member: Member, cut: Cut, machine: MillingMachine) -> np.ndarray:
    """The space (n,) that A is indexed to in every pass: what A shows beyond the roll, in pitches."""
    theta = (
        np.linspace(*roll_range(member, cut), _NOMINAL_POSITIONS) if member.generation == "generated" else np.zeros(2)
    )
    nominal = axis_positions(member.flank(cut.flanks[0]), theta, machine.pivot_height, machine.pivot)
    number = np.cumsum(~cutting)  # a rapid block begins a new pass
    space = np.full(len(number), -1)
    for k in np.unique(number[cutting]):
        rows = np.flatnonzero((number == k) & cutting)
        middle = axes[rows[len(rows) // 2]]
        away = np.hypot(nominal[:, 0] - middle[0], nominal[:, 1] - middle[1])
        pitches = (middle[3] - nominal[int(away.argmin()), 3]) * member.teeth / (2 * math.pi)
        space[rows] = round(pitches) % member.teeth
    return space

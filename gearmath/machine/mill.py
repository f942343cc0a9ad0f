"""The simulated machine end to end: an executed program in, the flanks it leaves out, as a measured flank file."""

from __future__ import annotations

import math
import zlib
from collections.abc import Callable

import numpy as np

from gearmath.bevel.flank import Grid, blank_grid, solve_flank
from gearmath.bevel.kernels import kernel
from gearmath.bevel.method import require_plain
from gearmath.errors import InputError
from gearmath.machine.milling import Blade, remaining
from gearmath.machine.path import Cut
from gearmath.machine.reader import MachinePath
from gearmath.machine.simulation import index_errors, roll_position, with_setting_errors
from gearmath.specs.bevel_set import FLANKS, SIDES, Member, design_sha256
from gearmath.specs.flank_csv import FlankFile, flank_file, join
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.simulated_machine import SimulatedMachine

MARGIN = 0.1


def flank_header(member: Member, name: str, grid: Grid, margin: float = MARGIN) -> dict[str, str]:
    """The header of a flank file of a member."""
    rows, columns = grid.shape
    return {
        "member": name,
        "member_teeth": str(member.teeth),
        "frame": "w",
        "unit": "mm",
        "grid": f"{rows}x{columns}",
        "margins": f"{margin:g},{margin:g}",
        "reference_point": f"{rows // 2},{columns // 2}",
        "phase_zeroed": "false",
        "tip_radius_mm": "0",
        "settings_sha256": design_sha256(member),
    }


def nominal_flank(
    member: Member, name: str, flank: str, grid: Grid, margin: float = MARGIN, tooth: int = 0
) -> FlankFile:
    """The nominal points of one flank of one tooth as a flank file."""
    points = solve_flank(member, name, flank, grid)
    row, col = (index.ravel() for index in np.indices(grid.shape))
    turn = _about_axis(2 * math.pi * tooth / member.teeth)
    header = flank_header(member, name, grid, margin)
    return flank_file(header, name, flank, tooth, row, col, points.point @ turn.T, points.normal @ turn.T)


def mill_member(
    path: MachinePath,
    member: Member,
    name: str,
    machine: MillingMachine,
    errors: SimulatedMachine | None = None,
    progress: Callable[[int], object] = lambda _: None,
) -> FlankFile:
    """What a program leaves on a member: the whole grid of the first space cut, the reference point of the others.

    Deviations are against the nominal flanks. ``errors`` makes machine, work axis and probe those of a simulated
    shop; without it they are perfect. Raises InputError if the program cuts with a tool that is not of this member, or
    leaves a flank uncut.
    """
    require_plain(member, name, "virtual milling")
    cuts = {cut.tool: cut for cut in Cut.of(member, name)}
    for tool in path.tools:
        if tool not in cuts:
            raise InputError(f'the program cuts with T="{tool}"; the {name} is cut with {" and ".join(cuts)}')
    grid = blank_grid(member, margin=MARGIN)
    files = []
    for index, tool in enumerate(path.tools):
        run = _Run(path, index, member, cuts[tool], machine, errors, name)
        for flank in cuts[tool].flanks:
            nominal = nominal_flank(member, name, flank, grid)
            for space in run.spaces:
                wanted = nominal if space == run.spaces[0] else _reference_only(nominal)
                files.append(run.measure(wanted, flank, space))
                progress(1)
    missing = [flank for flank in FLANKS if not any(file.flank[0] == flank for file in files)]
    if missing:
        raise InputError(f"the program does not cut the {missing[0]} flank of the {name}")
    return _probed(join(files), name, errors)


class _Run:
    """The blocks of one tool with the machine's errors, and which tooth space each of its passes cuts."""

    def __init__(
        self, path: MachinePath, tool: int, member: Member, cut: Cut, machine: MillingMachine,
        errors: SimulatedMachine | None, name: str,
    ) -> None:  # fmt: skip
        here = path.tool == tool
        self._member, self._cut, self._machine = member, cut, machine
        self.axes = path.axes[here]
        self.cutting = ~path.rapid[here]
        settings = member.flank(cut.flanks[0]).nominal.vector
        number = np.cumsum(~self.cutting)  # a rapid block begins a new pass
        self.space = np.full(len(number), -1)
        for k in np.unique(number[self.cutting]):
            rows = np.flatnonzero((number == k) & self.cutting)
            middle = rows[len(rows) // 2]
            self.space[rows] = self._space_at(settings, self.axes[middle])
        self.spaces: list[int] = list(dict.fromkeys(self.space[self.space >= 0].tolist()))
        if errors is not None:
            self.axes = self._really(settings, errors, name)

    def _space_at(self, settings: np.ndarray, position: np.ndarray) -> int:
        """The space that A is indexed to: what A shows beyond the roll, in pitches."""
        theta, _ = roll_position()(settings, position[0], position[1])
        (unindexed,) = kernel("axis_transform")(settings, theta, self._machine.pivot_height)
        pitches = (position[3] - unindexed[3]) * self._member.teeth / (2 * math.pi)
        return round(pitches) % self._member.teeth

    def _really(self, settings: np.ndarray, errors: SimulatedMachine, name: str) -> np.ndarray:
        axes = with_setting_errors(self.axes, settings, errors.setting_errors(name))
        index = index_errors(errors.work_axis, self._member.teeth, errors.seed)
        turned = np.where(self.space >= 0, index[self.space], 0.0)
        return axes + turned[:, None] * np.array([0, 0, 0, 1, 0])

    def measure(self, nominal: FlankFile, flank: str, space: int) -> FlankFile:
        """The deviations that the passes of a space leave at nominal points, which are given for tooth 0.

        The swept cone has no inner edge, so that only the passes of the space itself can be asked.
        """
        spec = self._member.flank(flank)
        turn = _about_axis(2 * math.pi * space / self._member.teeth)
        point, normal = nominal.point @ turn.T, nominal.normal @ turn.T
        blade = Blade(spec.blade_point_radius, math.radians(spec.blade_pressure_angle), SIDES[flank])
        deviation = remaining(
            self.axes, self.cutting & (self.space == space), blade, self._machine.pivot_height, point, normal
        )
        if np.isnan(deviation).any():
            k = int(np.argmax(np.isnan(deviation)))
            place = f"row {nominal.row[k]}, col {nominal.col[k]}"
            raise InputError(f"the program leaves the {flank} flank of space {space} uncut at {place}")
        return flank_file(
            nominal.header, nominal.member, flank, space, nominal.row, nominal.col,
            point + deviation[:, None] * normal, normal, deviation,
        )  # fmt: skip


def _reference_only(file: FlankFile) -> FlankFile:
    row, col = (int(part) for part in file.header["reference_point"].split(","))
    k = np.flatnonzero((file.row == row) & (file.col == col))
    return flank_file(
        file.header, file.member, file.flank[0], 0, file.row[k], file.col[k], file.point[k], file.normal[k]
    )


def _probed(file: FlankFile, name: str, errors: SimulatedMachine | None) -> FlankFile:
    """The file with seeded probe noise on every deviation, and its standard uncertainty."""
    sigma = errors.probe.sigma_um / 1000 if errors is not None else 0.0
    if sigma == 0.0 or errors is None:
        return file
    noise = sigma * np.random.default_rng([errors.seed, zlib.crc32(name.encode())]).standard_normal(len(file))
    return FlankFile(
        file.header, file.member, file.flank, file.tooth, file.row, file.col,
        file.point + noise[:, None] * file.normal, file.normal, file.deviation + noise, np.full(len(file), sigma),
    )  # fmt: skip


def _about_axis(angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])

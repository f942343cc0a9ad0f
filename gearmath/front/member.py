"""A member of a gear set: change its settings, look at flanks and teeth, write its programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from gearmath.arguments.call import checked_call
from gearmath.arguments.kinds import OneOf, Record, grid_of
from gearmath.bevel.flank import blank_grid
from gearmath.bevel.grid import listed_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.errors import about
from gearmath.front.changed import changed, check_keys
from gearmath.front.flanks import FlankSurface, Tooth
from gearmath.front.progress import Begin, silent
from gearmath.shown import Shown, Shows, html_table
from gearmath.specs.bevel_set import FLANKS, MEMBERS, SETTINGS, BevelSet
from gearmath.specs.bevel_set import Member as MemberSpec
from gearmath.specs.margins import Margins
from gearmath.specs.places import read_places
from gearmath.specs.toml import checked, given, rechecked

if TYPE_CHECKING:
    from gearmath.exchange.step import WrittenSolid
    from gearmath.front.machines import Machine
    from gearmath.front.measured import Measurement
    from gearmath.front.probing import ProbingProgram
    from gearmath.front.programs import Program
    from gearmath.front.sets import GearSet


@checked_call(
    gear_set=Record("gearmath.front.sets", "GearSet", "a gear set"),
    name=OneOf(MEMBERS),
    spec=Record("gearmath.specs.bevel_set", "Member", "the part of a set file that is of a member"),
)
@dataclass(frozen=True, repr=False)
class Member(Shown):
    """One member of a set: ``name`` is "pinion" or "gear", ``spec`` its part of the file, mm and degrees."""

    gear_set: GearSet
    name: str
    spec: MemberSpec

    def __post_init__(self) -> None:
        if self.gear_set.spec.members.get(self.name) is not self.spec:  # by hand: never checked, of no name yet
            spec = rechecked(self.spec, f"{self.name} of {self.gear_set.title}")
            object.__setattr__(self, "spec", spec.named(self.name))

    @property
    def teeth(self) -> int:
        """How many."""
        return self.spec.teeth

    @checked_call
    def with_settings(
        self, concave: Mapping[str, float] | None = None, convex: Mapping[str, float] | None = None
    ) -> Member:
        """The member with settings changed by so much [mm, degrees], by the keys of the set file.

        The flanks as they were stay the nominal ones, so that :meth:`deviations` tells what the change does;
        :meth:`flank`, and files of nominal points of a set that is saved so, are of them, until :meth:`as_nominal` is
        asked for. Raises InputError for a key that is no setting, and where the change makes the member no part of the
        pair.

        >>> import gearmath as gm
        >>> pinion = gm.load_set("nasa_tp3096_12x36.toml").pinion
        >>> changed = pinion.with_settings(concave={"radial_distance": +0.05})
        >>> round(changed.spec.concave.radial_distance - pinion.spec.concave.radial_distance, 6)
        0.05
        """
        values = {}
        for flank, by in (("concave", concave or {}), ("convex", convex or {})):
            check_keys(self.name, flank, by)
            values[flank] = {key: getattr(self.spec.flank(flank), key) + change for key, change in by.items()}
        return self.with_values(**values)

    @checked_call
    def with_values(
        self, concave: Mapping[str, float] | None = None, convex: Mapping[str, float] | None = None
    ) -> Member:
        """The member with settings of these values [mm, degrees], as :meth:`with_settings` changes them."""
        flanks = {}
        for flank, to in (("concave", concave or {}), ("convex", convex or {})):
            check_keys(self.name, flank, to)
            if to:
                flanks[flank] = changed(self.spec.flank(flank), to)
        members = {**given(self.gear_set.spec), self.name: {**given(self.spec), **flanks}}
        return self.gear_set.with_spec(checked(members, BevelSet, self.gear_set.title)).member(self.name)

    def as_nominal(self) -> Member:
        """The member whose nominal flanks are those that its settings cut, as of a new design: nothing is changed then.

        Raises InputError where they are no part of the pair.

        >>> import gearmath as gm
        >>> pinion = gm.load_set("nasa_tp3096_12x36.toml").pinion.with_settings(concave={"radial_distance": +0.05})
        >>> bool(abs(pinion.as_nominal().flank("concave").point - pinion.flank("concave").point).max() > 0.001)
        True
        """
        flanks = {name: self.spec.flank(name).model_copy(update={"design": None}) for name in FLANKS}
        spec = self.spec.model_copy(update=flanks)
        return self.gear_set.with_member(replace(self, spec=spec)).member(self.name)

    @checked_call
    def flank(
        self,
        flank: str,
        grid: tuple[int, int] | str | None = None,
        margin: float | Margins = 0.1,
        places: tuple[np.ndarray, np.ndarray] | str | Path | None = None,
    ) -> FlankSurface:
        """Nominal points and outward normals of a flank on a grid, rows root to tip and columns toe to heel.

        ``grid`` is (5, 9), or "5x9", if not given; ``margin`` is the part of working depth and face width left out on
        each side.
        ``places`` are listed ones in their stead: z_w and radius (n,) [mm] from the pitch apex, or a file of such
        lines; one column where ``grid`` is not given. Raises InputError naming flank, row and column of a point that
        the cutter does not make.

        >>> import gearmath as gm
        >>> gm.load_set("nasa_tp3096_12x36.toml").pinion.flank("concave").point.shape
        (5, 9, 3)
        """

        size = None if grid is None else grid_of(grid)
        if places is None:
            at = blank_grid(self.spec, *(size or (5, 9)), margin)
            return FlankSurface.of(self, flank, nominal_flank(self.spec, flank, at, margin))
        axial, radial = read_places(Path(places)) if isinstance(places, str | Path) else map(np.asarray, places)
        with about(Path(places) if isinstance(places, str | Path) else None):
            at = listed_grid(self.spec, axial, radial, size or (len(axial), 1))
        return FlankSurface.of(self, flank, nominal_flank(self.spec, flank, at, None))

    @checked_call
    def tooth(self, columns: int = 25) -> Tooth:
        """The whole tooth space, root and fillets too. Raises InputError where the cutter does not make it."""
        from gearmath.bevel.tooth import space_figures, tooth_space

        space = tooth_space(self.spec, columns)
        return Tooth(self, space, space_figures(self.spec, space))

    @checked_call
    def to_step(self, path: str | Path, begin: Begin = silent) -> dict[str, WrittenSolid]:
        """Write the closed solid of the member in its work frame for CAD; by its name, what was written.

        Raises InputError where the kernel of CAD is not installed: pip install '.[cad]'.
        """
        from gearmath.exchange.body import member_patches
        from gearmath.exchange.step import require_kernel, write_step

        require_kernel()
        progress = begin(4, "stage")
        bodies = [(self.name, member_patches(self.spec))]
        progress(2)
        return write_step(Path(path), bodies, progress)

    @checked_call
    def deviations(self, grid: tuple[int, int] | str = (5, 9), margin: float = 0.1) -> Measurement:
        """The flanks that the settings cut as deviations [mm] from the nominal ones, on the exact surface.

        As a measurement of one tooth without noise. Raises ComputationError where a flank is too far off.
        """
        from gearmath.front.measured import deviations

        return deviations(self, grid_of(grid), margin)

    @checked_call
    def program(
        self,
        machine: Machine | str | Path | None = None,
        name: str = "GEAR",
        spaces: Sequence[int] | None = None,
        tolerance: float = 1e-4,
        feed: float = 300.0,
        spindle_rpm: float = 120.0,
        roughing_stock: float = 0.0,
        finishing_stock: float = 0.0,
        dry_run: bool = False,
        blocks: Literal["g1", "poly"] = "g1",
        control: str | None = None,
    ) -> Program:
        """The cutting program of the member for a machine, by default the bundled vertical one; all spaces by default.

        ``tolerance`` of the flank and stocks [mm], ``feed`` past the tooth [mm/min]; ``control`` "sinumerik" or
        "linuxcnc", by default that of the machine. The program is run before it is returned. Raises InputError naming
        what the machine cannot do.
        """
        from gearmath.front.machines import machine_of
        from gearmath.front.programs import cutting
        from gearmath.machine.planning.cut_plan import CuttingJob

        chosen = list(range(self.teeth) if spaces is None else spaces)
        stocks = roughing_stock, finishing_stock
        job = CuttingJob(chosen, tolerance, feed, spindle_rpm, *stocks, dry_run, blocks)
        return cutting(self, machine_of(machine), name, job, control)

    def probing(
        self, machine: Machine | str | Path | None = None, name: str = "PROBE", **options: Any
    ) -> ProbingProgram:
        """The program that probes the member: a grid of both flanks, and the reference point of every tooth.

        ``options``: probe, as of :func:`gearmath.load_probe`; topography, the teeth with a grid, by default (0,); pitch
        and registration, whether every tooth and the corners on eight teeth around are touched; repeat, how often each;
        shop, whose fixture and spindle it must clear; control. Raises InputError naming what the probe would meet.

        >>> import gearmath as gm
        >>> program = gm.load_set("nasa_tp3096_12x36.toml").pinion.probing(topography=(), registration=False)
        >>> program.name, "MEAS=" in program.text
        ('PROBE', True)
        """
        from gearmath.front.probing import probing

        return probing(self, machine, name=name, **options)

    def _shown(self) -> tuple[str, list[Shows]]:
        spec = self.spec
        figures: list[Shows] = [("teeth", spec.teeth, ""), ("hand", spec.hand, ""), ("cutting", spec.cutting, "")]
        return f"{self.name} of {self.gear_set.title}", figures

    def _repr_html_(self) -> str:
        rows = [[key, *(getattr(self.spec.flank(flank), key) for flank in FLANKS)] for key in SETTINGS]
        return html_table(f"{self.name} of {self.gear_set.title}", ["setting (mm, degree)", *FLANKS], rows)

"""Gear sets and their members: load, change a setting, look at flanks and teeth, write programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.grid import listed_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.bevel.pair import check_pair, load_pair
from gearmath.errors import InputError, about
from gearmath.files import write_text
from gearmath.front.changed import changed, check_keys, shallow
from gearmath.front.flanks import FlankSurface, Tooth
from gearmath.front.progress import Begin, silent
from gearmath.front.tables import html_table
from gearmath.specs.bevel_set import FLANKS, MEMBERS, SETTINGS, BevelSet
from gearmath.specs.bevel_set import Member as MemberSpec
from gearmath.specs.cut import ANGULAR
from gearmath.specs.margins import Margins
from gearmath.specs.places import read_places
from gearmath.specs.toml import checked, find

if TYPE_CHECKING:
    from gearmath.exchange.step import WrittenSolid
    from gearmath.front.machines import Machine
    from gearmath.front.measured import Measurement
    from gearmath.front.programs import Program


@dataclass(frozen=True)
class GearSet:
    """A pinion and a gear, or one of them, that are one physical pair; ``spec`` is the checked content of the file.

    ``source`` is the file that it was read from, ``remarks`` what was left aside there.
    """

    spec: BevelSet
    source: Path | None = None
    remarks: tuple[str, ...] = ()

    @property
    def title(self) -> str:
        """What the file says it is."""
        return self.spec.title

    @property
    def pinion(self) -> Member:
        """The pinion. Raises InputError where the set has none."""
        return self.member("pinion")

    @property
    def gear(self) -> Member:
        """The gear. Raises InputError where the set has none."""
        return self.member("gear")

    def member(self, name: str) -> Member:
        """The member called ``name``, "pinion" or "gear". Raises InputError."""
        return Member(self, name, self.spec.member(name))

    def with_member(self, member: Member) -> GearSet:
        """The set with this member in place of the one of its name.

        Raises InputError where the two are no pair any more, naming member, flank, key, value and limit.
        """
        values = self.spec.model_copy(update={member.name: member.spec})
        check_pair(values)
        return GearSet(values)

    def save(self, path: str | Path) -> Path:
        """Write the set as TOML (mm, degrees), in one step. Raises InputError where the place cannot be written."""
        from gearmath.specs.set_text import set_text

        write_text(Path(path), set_text(self.spec))
        return Path(path)

    def to_dict(self) -> dict[str, Any]:
        """The set with the keys of its file, mm and degrees."""
        return self.spec.model_dump(exclude_defaults=True)

    def mates(self) -> dict[str, Any] | None:
        """Backlash [mm] at the mean point, and by the pinion's flank what it and its mate differ by [degrees, um].

        None where the set has one member. Raises InputError where flanks do not meet.
        """
        from gearmath.bevel.mates import pair_figures

        return pair_figures(self.spec)

    def edge_note(self) -> str:
        """What to say of a pair that runs on edges of its teeth, as a small slip in a file makes it; else empty.

        Raises InputError where flanks do not meet.
        """
        from gearmath.bevel.mates import edge_note

        return edge_note(self.spec)

    def to_step(self, path: str | Path, begin: Begin = silent) -> dict[str, WrittenSolid]:
        """Write the pair in mesh, or the only member, as closed solids for CAD; by member, what was written.

        Raises InputError where the kernel of CAD is not installed: pip install '.[cad]'.
        """
        if len(self.spec.members) == 1:
            return self.member(next(iter(self.spec.members))).to_step(path, begin)
        from gearmath.exchange.in_mesh import pair_patches
        from gearmath.exchange.step import require_kernel, write_step

        require_kernel()
        progress = begin(5, "stage")
        bodies = pair_patches(self.spec)
        progress(2)
        return write_step(Path(path), bodies, progress)

    def to_stl(self, path: str | Path, begin: Begin = silent) -> int:
        """Write the pair in mesh as triangles, touching on the drive side; how many. Of one member: ``tooth().to_stl``.

        Raises InputError where the set has one member.
        """
        from gearmath.bevel.solid import write_stl
        from gearmath.exchange.in_mesh import pair_triangles

        for name in MEMBERS:
            self.spec.member(name)
        progress = begin(2, "stage")
        triangles = pair_triangles(self.spec)
        progress(1)
        write_stl(Path(path), triangles, "pair in mesh")
        progress(1)
        return len(triangles)

    def to_rexs(self, path: str | Path) -> int:
        """Write the set as REXS 2.0.0; the number of its components."""
        from gearmath.exchange.rexs import write_rexs

        return write_rexs(Path(path), self.spec)

    def to_summary(self, path: str | Path) -> Path:
        """Write the summary sheet, HTML that prints on A4: blank, settings and cutter build, in mm and inches."""
        from gearmath.setup_sheet.summary import summary_sheet

        write_text(Path(path), summary_sheet(self.spec))
        return Path(path)

    def _repr_html_(self) -> str:
        flanks = [(name, flank) for name in self.spec.members for flank in FLANKS]
        rows = [
            [
                key,
                "degree" if key in ANGULAR else "1" if key == "ratio_of_roll" else "mm",
                *(getattr(self.spec.member(name).flank(flank), key) for name, flank in flanks),
            ]
            for key in SETTINGS
        ]
        return html_table(self.title, ["setting", "unit", *(f"{name} {flank}" for name, flank in flanks)], rows)


def load_set(path: str | Path) -> GearSet:
    """Read a gear set: a TOML file, or the name of a bundled one. See docs/set_file.md.

    Raises InputError naming file, member, flank, key, value and limit of what is no physical pair.

    >>> import gearmath as gm
    >>> gm.load_set("nasa_tp3096_12x36.toml").pinion.teeth
    12
    """
    source = find(str(path))
    return GearSet(load_pair(source), source)


@dataclass(frozen=True)
class Member:
    """One member of a set: ``name`` is "pinion" or "gear", ``spec`` its part of the file, mm and degrees."""

    gear_set: GearSet
    name: str
    spec: MemberSpec

    @property
    def teeth(self) -> int:
        """How many."""
        return self.spec.teeth

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

    def with_values(
        self, concave: Mapping[str, float] | None = None, convex: Mapping[str, float] | None = None
    ) -> Member:
        """The member with settings of these values [mm, degrees], as :meth:`with_settings` changes them."""
        flanks = {}
        for flank, to in (("concave", concave or {}), ("convex", convex or {})):
            check_keys(self.name, flank, to)
            if to:
                flanks[flank] = changed(self.spec.flank(flank), to)
        members = {**shallow(self.gear_set.spec), self.name: {**shallow(self.spec), **flanks}}
        found = checked(members, BevelSet, self.gear_set.title)
        check_pair(found)
        return GearSet(found).member(self.name)

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

    def flank(
        self,
        flank: str,
        grid: tuple[int, int] | None = None,
        margin: float | Margins = 0.1,
        places: tuple[np.ndarray, np.ndarray] | str | Path | None = None,
    ) -> FlankSurface:
        """Nominal points and outward normals of a flank on a grid, rows root to tip and columns toe to heel.

        ``grid`` is (5, 9) if not given; ``margin`` is the part of working depth and face width left out on each side.
        ``places`` are listed ones in their stead: z_w and radius (n,) [mm] from the pitch apex, or a file of such
        lines; one column where ``grid`` is not given. Raises InputError naming flank, row and column of a point that
        the cutter does not make.

        >>> import gearmath as gm
        >>> gm.load_set("nasa_tp3096_12x36.toml").pinion.flank("concave").point.shape
        (5, 9, 3)
        """
        _check_flank(flank)
        if places is None:
            at = blank_grid(self.spec, *(grid or (5, 9)), margin)
            return FlankSurface.of(self, flank, nominal_flank(self.spec, self.name, flank, at, margin))
        axial, radial = read_places(Path(places)) if isinstance(places, str | Path) else places
        with about(Path(places) if isinstance(places, str | Path) else None):
            at = listed_grid(self.spec, axial, radial, grid or (len(axial), 1))
        return FlankSurface.of(self, flank, nominal_flank(self.spec, self.name, flank, at, None))

    def tooth(self, columns: int = 25) -> Tooth:
        """The whole tooth space, root and fillets too. Raises InputError where the cutter does not make it."""
        from gearmath.bevel.tooth import space_figures, tooth_space

        space = tooth_space(self.spec, self.name, columns)
        return Tooth(self, space, space_figures(self.spec, space))

    def to_step(self, path: str | Path, begin: Begin = silent) -> dict[str, WrittenSolid]:
        """Write the closed solid of the member in its work frame for CAD; by its name, what was written.

        Raises InputError where the kernel of CAD is not installed: pip install '.[cad]'.
        """
        from gearmath.exchange.body import member_patches
        from gearmath.exchange.step import require_kernel, write_step

        require_kernel()
        progress = begin(4, "stage")
        bodies = [(self.name, member_patches(self.spec, self.name))]
        progress(2)
        return write_step(Path(path), bodies, progress)

    def deviations(self, grid: tuple[int, int] = (5, 9), margin: float = 0.1) -> Measurement:
        """The flanks that the settings cut as deviations [mm] from the nominal ones, on the exact surface.

        As a measurement of one tooth without noise. Raises ComputationError where a flank is too far off.
        """
        from gearmath.front.measured import deviations

        return deviations(self, grid, margin)

    def program(
        self,
        machine: Machine | None = None,
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
        from gearmath.front.programs import cutting
        from gearmath.machine.planning.cut_plan import CuttingJob

        chosen = list(range(self.teeth) if spaces is None else spaces)
        stocks = roughing_stock, finishing_stock
        job = CuttingJob(chosen, tolerance, feed, spindle_rpm, *stocks, dry_run, blocks)
        return cutting(self, machine, name, job, control)

    def _repr_html_(self) -> str:
        rows = [[key, *(getattr(self.spec.flank(flank), key) for flank in FLANKS)] for key in SETTINGS]
        return html_table(f"{self.name} of {self.gear_set.title}", ["setting (mm, degree)", *FLANKS], rows)


def _check_flank(flank: str) -> None:
    if flank not in FLANKS:
        raise InputError(f"flank = {flank!r}: must be {' or '.join(FLANKS)}")

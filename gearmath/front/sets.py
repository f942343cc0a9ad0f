"""Gear sets and their members: load, change a setting, look at flanks and teeth, write programs."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gearmath.bevel.pair import check_pair, load_pair
from gearmath.errors import InputError
from gearmath.front.tables import html_table
from gearmath.specs.bevel_set import FLANKS, MEMBERS, SETTINGS, BevelSet, Design, Flank
from gearmath.specs.bevel_set import Member as MemberSpec
from gearmath.specs.cut import ANGULAR
from gearmath.specs.toml import checked, find

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gearmath.front.machines import Machine
    from gearmath.front.measured import Measurement
    from gearmath.front.programs import Program


@dataclass(frozen=True)
class GearSet:
    """A pinion and a gear, or one of them, that are one physical pair; ``spec`` is the checked content of the file."""

    spec: BevelSet

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
        from gearmath.files import write_text
        from gearmath.specs.set_text import set_text

        write_text(Path(path), set_text(self.spec))
        return Path(path)

    def to_dict(self) -> dict[str, Any]:
        """The set with the keys of its file, mm and degrees."""
        return self.spec.model_dump(exclude_defaults=True)

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
    return GearSet(load_pair(find(str(path))))


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
            _check_keys(self.name, flank, by)
            values[flank] = {key: getattr(self.spec.flank(flank), key) + change for key, change in by.items()}
        return self.with_values(**values)

    def with_values(
        self, concave: Mapping[str, float] | None = None, convex: Mapping[str, float] | None = None
    ) -> Member:
        """The member with settings of these values [mm, degrees], as :meth:`with_settings` changes them."""
        changed = {}
        for flank, to in (("concave", concave or {}), ("convex", convex or {})):
            _check_keys(self.name, flank, to)
            if to:
                changed[flank] = _changed(self.spec.flank(flank), to)
        members = {**_shallow(self.gear_set.spec), self.name: {**_shallow(self.spec), **changed}}
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

    def flank(self, flank: str, grid: tuple[int, int] = (5, 9), margin: float = 0.1) -> FlankSurface:
        """Nominal points and outward normals of a flank on a grid, rows root to tip and columns toe to heel.

        ``margin`` is the part of working depth and face width left out on each side. Raises InputError naming flank,
        row and column of a point that the cutter does not make.

        >>> import gearmath as gm
        >>> gm.load_set("nasa_tp3096_12x36.toml").pinion.flank("concave").point.shape
        (5, 9, 3)
        """
        from gearmath.bevel.flank import blank_grid, solve_flank
        from gearmath.bevel.nominal_file import nominal_flank

        _check_flank(flank)
        places = blank_grid(self.spec, *grid, margin)
        points = solve_flank(self.spec, self.name, flank, places)
        file = nominal_flank(self.spec, self.name, flank, places, margin)
        return FlankSurface(self, flank, points.point.reshape(*grid, 3), points.normal.reshape(*grid, 3), file)

    def tooth(self, columns: int = 25) -> Tooth:
        """The whole tooth space, root and fillets too. Raises InputError where the cutter does not make it."""
        from gearmath.bevel.tooth import space_figures, tooth_space

        space = tooth_space(self.spec, self.name, columns)
        return Tooth(self, space, space_figures(self.spec, space))

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
    ) -> Program:
        """The cutting program of the member for a machine, by default the bundled vertical one; all spaces by default.

        ``tolerance`` of the flank and stocks [mm], ``feed`` past the tooth [mm/min]. The program is run before it is
        returned. Raises InputError naming what the machine cannot do.
        """
        from gearmath.front.programs import cutting

        job = {"feed": feed, "spindle_rpm": spindle_rpm, "roughing_stock": roughing_stock}
        return cutting(self, machine, name, spaces, tolerance=tolerance, finishing_stock=finishing_stock, **job)

    def _repr_html_(self) -> str:
        rows = [[key, *(getattr(self.spec.flank(flank), key) for flank in FLANKS)] for key in SETTINGS]
        return html_table(f"{self.name} of {self.gear_set.title}", ["setting (mm, degree)", *FLANKS], rows)


@dataclass(frozen=True)
class FlankSurface:
    """Points (rows, columns, 3) [mm] and outward unit normals of one flank, in the work frame; ``file`` is its CSV."""

    member: Member
    flank: str
    point: np.ndarray
    normal: np.ndarray
    file: Any

    def to_csv(self, path: str | Path) -> Path:
        """Write the flank CSV of docs/files.md."""
        from gearmath.specs.flank_csv import write_flank_csv

        write_flank_csv(Path(path), self.file)
        return Path(path)

    def to_dict(self) -> dict[str, Any]:
        """Points and normals as nested lists."""
        return {"flank": self.flank, "point": self.point.tolist(), "normal": self.normal.tolist()}

    def plot(self) -> Figure:
        """The flank in space, seen along the normal of its middle."""
        from matplotlib.figure import Figure

        figure = Figure(figsize=(6, 5), layout="constrained")
        axes: Any = figure.add_subplot(projection="3d")
        axes.plot_surface(*np.moveaxis(self.point, -1, 0), edgecolor="0.4", linewidth=0.5, alpha=0.6)
        middle = self.normal[self.normal.shape[0] // 2, self.normal.shape[1] // 2]
        azimuth, elevation = math.atan2(middle[1], middle[0]), math.asin(middle[2])
        axes.view_init(math.degrees(elevation), math.degrees(azimuth))
        axes.set(xlabel="x / mm", ylabel="y / mm", zlabel="z / mm", aspect="equal")
        axes.set_title(f"{self.member.name}, {self.flank} flank")
        return figure


@dataclass(frozen=True)
class Tooth:
    """A whole tooth space; ``figures`` are thickness, top land and so on [mm] by name."""

    member: Member
    space: Any
    figures: dict[str, float]

    def to_stl(self, path: str | Path, whole_member: bool = True) -> Path:
        """Write the closed solid of the member, or the surface of one space, as binary STL in mm."""
        from gearmath.bevel.solid import member_triangles, space_triangles, write_stl

        triangles = member_triangles(self.member.spec, self.space) if whole_member else space_triangles(self.space)
        write_stl(Path(path), triangles, self.member.name)
        return Path(path)

    def to_dict(self) -> dict[str, float]:
        """The figures [mm] by name."""
        return dict(self.figures)

    def _repr_html_(self) -> str:
        return html_table(f"tooth of the {self.member.name}", ["figure", "mm"], list(self.figures.items()))


def _check_keys(name: str, flank: str, values: Mapping[str, float]) -> None:
    for key, value in values.items():
        if key not in SETTINGS:
            raise InputError(f"{name}.{flank}.{key}: is no setting; there are {', '.join(SETTINGS)}")
        if not isinstance(value, Real) or isinstance(value, bool) or not math.isfinite(value):
            raise InputError(f"{name}.{flank}.{key} = {value!r}: must be a finite number of mm or degrees")


def _changed(spec: Flank, to: Mapping[str, float]) -> dict[str, Any]:
    """The table of a flank with changed settings, the nominal ones under ``design``."""
    design = spec.design or Design(**{key: getattr(spec, key) for key in SETTINGS})
    return {**_shallow(spec), **to, "design": design}


def _shallow(spec: BevelSet | MemberSpec | Flank) -> dict[str, Any]:
    """What was given for a model, its tables as they are."""
    return {key: getattr(spec, key) for key in type(spec).model_fields if key in spec.model_fields_set}


def _check_flank(flank: str) -> None:
    if flank not in FLANKS:
        raise InputError(f"flank = {flank!r}: must be {' or '.join(FLANKS)}")


__all__ = ["MEMBERS", "FlankSurface", "GearSet", "Member", "Tooth", "load_set"]

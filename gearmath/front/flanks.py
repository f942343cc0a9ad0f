"""Flanks and whole teeth of a member: look at them, and write them for other programs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gearmath.arguments.call import checked_call
from gearmath.arguments.kinds import Record
from gearmath.shown import Shown, Shows
from gearmath.specs.flank_csv import FlankFile, write_flank_csv

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gearmath.bevel.tooth import ToothSpace
    from gearmath.front.member import Member


@dataclass(frozen=True, repr=False)
class FlankSurface(Shown):
    """Points (rows, columns, 3) [mm] and outward unit normals of one flank, in the work frame; ``file`` is its CSV."""

    member: Member
    flank: str
    point: np.ndarray
    normal: np.ndarray
    file: FlankFile

    @classmethod
    @checked_call(file=Record("gearmath.specs.flank_csv", "FlankFile", "a flank file"))
    def of(cls, member: Member, flank: str, file: FlankFile) -> FlankSurface:
        """The nominal points of a flank file as a grid."""
        rows, columns = (int(part) for part in file.header["grid"].split("x"))
        point, normal = (values.reshape(rows, columns, 3) for values in (file.point, file.normal))
        return cls(member, flank, point, normal, file)

    @checked_call
    def to_csv(self, path: str | Path) -> Path:
        """Write the flank CSV of docs/files.md."""
        write_flank_csv(Path(path), self.file)
        return Path(path)

    @checked_call
    def to_text(self, path: str | Path) -> Path:
        """Write points and normals as plain text for other programs, a row ``x y z i j k`` each [mm]."""
        from gearmath.exchange.point_lines import write_points

        write_points(Path(path), self.member.name, self.flank, self.file.point, self.file.normal)
        return Path(path)

    def to_dict(self) -> dict[str, Any]:
        """Points and normals as nested lists."""
        return {"flank": self.flank, "point": self.point.tolist(), "normal": self.normal.tolist()}

    def plot(self) -> Figure:
        """The flank in space, seen along the normal of its middle."""
        from matplotlib.ticker import MaxNLocator

        from gearmath.plot.figure import Figure

        figure = Figure(figsize=(6, 5), layout="constrained")
        axes: Any = figure.add_subplot(projection="3d")
        axes.plot_surface(*np.moveaxis(self.point, -1, 0), edgecolor="0.4", linewidth=0.5, alpha=0.6)
        middle = self.normal[self.normal.shape[0] // 2, self.normal.shape[1] // 2]
        azimuth, elevation = math.atan2(middle[1], middle[0]), math.asin(middle[2])
        axes.view_init(math.degrees(elevation), math.degrees(azimuth))
        axes.set(xlabel="x / mm", ylabel="y / mm", zlabel="z / mm")
        for axis, name in ((axes.xaxis, "x"), (axes.yaxis, "y"), (axes.zaxis, "z")):
            axis.set_major_locator(MaxNLocator(4))
            axes.tick_params(name, labelsize=8)
        axes.set_box_aspect(np.ptp(self.point, axis=(0, 1)), zoom=0.85)  # one scale on all axes
        # beside the axes, wherever they end
        figure.suptitle(f"{self.member.name}, {self.flank} flank", x=0.02, ha="left")
        return figure

    def _shown(self) -> tuple[str, list[Shows]]:
        rows, columns, _ = self.point.shape
        figures: list[Shows] = [("rows", rows, ""), ("columns", columns, "")]
        radius = np.hypot(self.point[..., 0], self.point[..., 1])
        for name, values in (("z_w", self.point[..., 2]), ("radius", radius)):
            figures.append((name, f"{values.min():.6g} to {values.max():.6g}", "mm"))
        return f"{self.flank} flank of the {self.member.name}", figures


@dataclass(frozen=True, repr=False)
class Tooth(Shown):
    """A whole tooth space; ``figures`` are thickness, top land and so on [mm] by name."""

    member: Member
    space: ToothSpace
    figures: dict[str, float]

    @property
    def note(self) -> str:
        """What to say of cutters for one flank whose far side cuts into the other one; else empty."""
        from gearmath.bevel.design.point_widths import far_sides_note

        return far_sides_note(self.member.spec, self.space)

    @checked_call
    def to_stl(self, path: str | Path, whole_member: bool = True) -> int:
        """Write the closed solid of the member, or the surface of one space, as binary STL in mm; its triangles."""
        from gearmath.bevel.solid import member_triangles, space_triangles, write_stl

        triangles = member_triangles(self.member.spec, self.space) if whole_member else space_triangles(self.space)
        write_stl(Path(path), triangles, f"{self.member.name} {'member' if whole_member else 'space'}")
        return len(triangles)

    def to_dict(self) -> dict[str, float]:
        """The figures [mm] by name."""
        return dict(self.figures)

    def _shown(self) -> tuple[str, list[Shows]]:
        figures: list[Shows] = [
            (name.removesuffix("_mm").replace("_", " "), value, "mm")
            if name.endswith("_mm")
            else (name.replace("_", " "), round(value), "")
            for name, value in self.figures.items()
        ]
        return f"tooth space of the {self.member.name}", figures

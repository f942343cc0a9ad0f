"""Files for other programs: C of kernels, of the gearbox and of the post-processor; solids, points, REXS, sheets."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from derivations.expression import Expression
from gearmath.engine.kernel import Kernel
from gearmath.export.c import contract_files, double_kernel, integer_kernel
from gearmath.export.cnc import export_cnc as _export_cnc
from gearmath.export.folder import write_folder
from gearmath.export.teensy import export_teensy as _export_teensy
from gearmath.files import write_text
from gearmath.front.sets import FlankSurface, GearSet, Member
from gearmath.lowering import lower
from gearmath.specs.hobbing import HobbingMachine


def export_c(
    what: Kernel | Expression | Iterable[Kernel | Expression], folder: str | Path, bits: int = 0
) -> list[Path]:
    """Write the C of kernels or expressions into a folder: ``gm_<name>.h`` and ``gm_<name>.c`` of each.

    In double precision, beside them what they share (``gm_status.h``), or with ``bits`` = 32 or
    64 in whole numbers of that size. Raises ExportError (a ComputationError) naming what cannot become such C,
    InputError where the folder holds other files.
    """
    each = [what] if isinstance(what, Kernel | Expression) else list(what)
    made = [lower(one) if isinstance(one, Expression) else one for one in each]
    files: dict[str, str] = {}
    for one in made:
        files |= (integer_kernel(one, bits) if bits else double_kernel(one)).files
    write_folder(Path(folder), files if bits else contract_files() | files)
    return [Path(folder) / name for name in files]


def export_teensy(machine: HobbingMachine, folder: str | Path) -> list[str]:
    """Write the whole Teensy sketch of a hobbing machine or lathe; the names of its files. Raises InputError."""
    return list(_export_teensy(machine, Path(folder)))


def export_cnc(folder: str | Path) -> list[str]:
    """Write the C library for a CNC post-processor; the names of its files. Raises InputError."""
    return list(_export_cnc(Path(folder)))


def export_step(what: GearSet | Member, path: str | Path) -> list[float]:
    """Write closed solids for CAD: a member in its work frame, or a set in mesh; their volumes [mm³].

    Raises InputError where the kernel of CAD is not installed: pip install '.[cad]'.
    """
    from gearmath.exchange.body import member_patches
    from gearmath.exchange.in_mesh import pair_patches
    from gearmath.exchange.step import require_kernel, write_step

    require_kernel()
    if isinstance(what, Member):
        bodies = [(what.name, member_patches(what.spec, what.name))]
    else:
        bodies = pair_patches(what.spec)
    return write_step(Path(path), bodies)


def export_stl(pair: GearSet, path: str | Path) -> int:
    """Write the pair in mesh as triangles, touching on the drive side; how many. Of one member: ``.tooth().to_stl``."""
    from gearmath.bevel.solid import write_stl
    from gearmath.exchange.in_mesh import pair_triangles

    triangles = pair_triangles(pair.spec)
    write_stl(Path(path), triangles, "pair in mesh")
    return len(triangles)


def export_points(surface: FlankSurface, path: str | Path) -> int:
    """Write points and outward normals of a flank as plain text, a row ``x y z i j k`` each [mm]; how many."""
    from gearmath.exchange.point_lines import write_points

    point, normal = surface.point.reshape(-1, 3), surface.normal.reshape(-1, 3)
    write_points(Path(path), surface.member.name, surface.flank, point, normal)
    return len(point)


def export_rexs(pair: GearSet, path: str | Path) -> int:
    """Write the set as REXS 2.0.0; the number of its components."""
    from gearmath.exchange.rexs import write_rexs

    return write_rexs(Path(path), pair.spec)


def export_summary(pair: GearSet, path: str | Path) -> Path:
    """Write the summary sheet of a set, HTML that prints on A4: blank, settings and cutter build, in mm and inches."""
    from gearmath.setup_sheet.summary import summary_sheet

    write_text(Path(path), summary_sheet(pair.spec))
    return Path(path)

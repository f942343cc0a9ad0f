"""The C library for a CNC post-processor: double kernels under one contract, and what builds, tests and shows it.

What is written by hand stands in ``library/`` and goes out as it is; generated are the kernels, their table in the
README, and the vectors of the self-test.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from types import MappingProxyType

from gearmath.bevel.flank import flank_point
from gearmath.bevel.identify.bounded_step import compensation_step
from gearmath.bevel.identify.on_line import flank_on_line
from gearmath.engine.kernel import Kernel
from gearmath.export.c import contract_files, double_kernel
from gearmath.export.folder import write_folder
from gearmath.export.header import comment, plain, versions
from gearmath.export.vectors import selftest_vectors
from gearmath.kernels import kernel
from gearmath.machine.planning.curves import CUBIC, QUINTIC, axes_by_roll, pace_in_block
from gearmath.specs.bevel_set import SETTINGS


@cache
def cnc_kernels() -> tuple[Kernel, ...]:
    """The kernels of the library, in the order of the chapters, derived and lowered once per process."""
    lowered = (
        kernel(name)
        for name in (
            "cutter_surface",
            "cradle_pose",
            "flank_family",
            "meshing",
            "axis_transform",
            "tool_pose",
            "point_deviation",
            "setting_sensitivity",
            "deviation_surface",
            "line_entry",
            "moved_settings",
            "seen_from_tool",
            "cubic_block",
            "quintic_block",
        )
    )
    polynomials = (axes_by_roll(), pace_in_block(CUBIC), pace_in_block(QUINTIC))
    return (*lowered, *polynomials, flank_point(), flank_on_line(), compensation_step(len(SETTINGS)))


def cnc_files() -> dict[str, str]:
    """File name to text of the library."""
    kernels = cnc_kernels()
    files = by_hand() | contract_files()
    for one in kernels:
        files |= double_kernel(one).files
    files["gearmath.h"] = _umbrella([f"gm_{one.name}" for one in kernels])
    files["selftest_vectors.h"] = selftest_vectors(kernels)
    table = "\n".join(f"| `gm_{kernel.name}` | {plain(kernel.description)} |" for kernel in kernels)
    files["README.md"] = files["README.md"].replace("@VERSIONS@", versions()).replace("@TABLE@", table)
    return files


def by_hand() -> dict[str, str]:
    """File name to text of what comes with the package."""
    folder = resources.files("gearmath") / "export" / "library"
    return dict(sorted(_texts(folder, "")))


def _texts(folder: Traversable, inside: str) -> Iterator[tuple[str, str]]:
    for entry in folder.iterdir():
        if entry.is_dir():
            yield from _texts(entry, f"{inside}{entry.name}/")
        elif not entry.name.endswith((".pyc", "~")):
            yield inside + entry.name, entry.read_text("utf-8")


def export_cnc(folder: Path, settings: Mapping[str, str] = MappingProxyType({})) -> tuple[str, ...]:
    """Write the folder and return the names of its files. Raises InputError where it holds other files.

    ``settings`` are settings files for ``gm-post``: name to text, as ``post.post_file`` makes them.
    """
    files = {**cnc_files(), **settings}
    write_folder(folder, files)
    return tuple(sorted(files))


def _umbrella(names: Sequence[str]) -> str:
    includes = '#include "gm_status.h"\n' + "\n".join(f'#include "{name}.h"' for name in names)
    head = comment(["gearmath.h: generated, do not edit.", "", f"written by {versions()}"])
    return f"{head}#ifndef GEARMATH_H\n#define GEARMATH_H\n\n{includes}\n\n#endif\n"

"""C of kernels, of the gearbox and of the post-processor."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from derivations.expression import Expression
from gearmath.engine.kernel import Kernel
from gearmath.errors import InputError, about
from gearmath.export.c import contract_files, double_kernel, integer_kernel
from gearmath.export.cnc import export_cnc as _export_cnc
from gearmath.export.folder import write_folder
from gearmath.export.post import post_file
from gearmath.export.teensy import export_teensy as _export_teensy
from gearmath.front.machines import Machine, load_machine
from gearmath.front.programs import cutting
from gearmath.front.progress import Begin, silent
from gearmath.front.sets import GearSet
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


def export_cnc(
    folder: str | Path,
    pair: GearSet | None = None,
    machine: Machine | None = None,
    control: str | None = None,
    begin: Begin = silent,
) -> list[str]:
    """Write the C library for a CNC post-processor; the names of its files.

    With a ``pair`` also a settings file of each face milled member, from which ``gm-post``, a C program of the folder,
    writes the program of :meth:`Member.program`. Raises InputError.
    """
    settings = {} if pair is None else _settings(pair, machine or load_machine(), control, begin)
    return list(_export_cnc(Path(folder), settings))


def _settings(pair: GearSet, machine: Machine, control: str | None, begin: Begin) -> dict[str, str]:
    """Settings files of the face milled members of a set, by name; their programs are run first."""
    milled = [pair.member(name) for name, spec in pair.spec.members.items() if spec.process == "face_milling"]
    if not milled:
        where = "" if pair.source is None else f"{pair.source}: "
        raise InputError(f"{where}process = face_hobbing: gm-post writes the cuts of face milled members")
    dialect, files = machine.spec.control.dialect(control), {}
    for one in milled:
        file = f"{one.name}.settings"
        with about(pair.source):
            made = cutting(one, machine, one.name.upper(), None, dialect, file, begin)
            if made.made is not None:
                files[file] = post_file(made.made.plan, dialect)
    return files

"""C of kernels and of the post-processor."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from gearmath.arguments.call import checked_call
from gearmath.arguments.composed import Each, Either
from gearmath.arguments.known import EXPRESSION, KERNEL
from gearmath.engine.kernel import Kernel
from gearmath.errors import InputError, about
from gearmath.export.c import contract_files, double_kernel, integer_kernel
from gearmath.export.cnc import export_cnc as _export_cnc
from gearmath.export.folder import write_folder
from gearmath.export.post import post_file
from gearmath.front.machines import Machine, machine_of
from gearmath.front.programs import cutting
from gearmath.front.progress import Begin, silent
from gearmath.front.sets import GearSet, set_of
from gearmath.machine.judging.dialects import named
from gearmath.machine.planning.cut_plan import CuttingJob

if TYPE_CHECKING:
    from derivations.expression import Expression

_WHATS = "must be a kernel or an Expression, or a list of them"
_WHAT = Either((KERNEL, EXPRESSION, Each(Either((KERNEL, EXPRESSION), _WHATS), _WHATS, 1)), _WHATS)


@checked_call(what=_WHAT)
def export_c(
    what: Kernel | Expression | Sequence[Kernel | Expression], folder: str | Path, bits: int = 0
) -> list[Path]:
    """Write the C of kernels or expressions into a folder: ``gm_<name>.h`` and ``gm_<name>.c`` of each.

    In double precision, beside them what they share (``gm_status.h``), or with ``bits`` = 32 or
    64 in whole numbers of that size. Raises ExportError (a ComputationError) naming what cannot become such C,
    InputError where the folder holds other files.
    """
    each = list(what) if isinstance(what, Sequence) else [what]
    made = [one if isinstance(one, Kernel) else _lowered(one) for one in each]
    _check_apart([one.name for one in made])
    files: dict[str, str] = {}
    for one in made:
        files |= (integer_kernel(one, bits) if bits else double_kernel(one)).files
    write_folder(Path(folder), files if bits else contract_files() | files)
    return [Path(folder) / name for name in files]


def _check_apart(names: Sequence[str]) -> None:
    """Raise InputError where kernels would make the same file or function, as names of one spelling in capitals do."""
    taken: dict[str, str] = {}
    for name in names:
        for made in (name.lower(), f"{name}_batch".lower()):
            if made in taken:
                raise InputError(f"what: {name} and {taken[made]} would both become gm_{made}: rename one of them")
            taken[made] = name


def _lowered(expression: Expression) -> Kernel:
    from gearmath.lowering import lower  # loads SymPy

    return lower(expression)


@checked_call
def export_cnc(
    folder: str | Path,
    pair: GearSet | str | Path | None = None,
    machine: Machine | str | Path | None = None,
    control: str | None = None,
    blocks: Literal["g1", "poly"] = "g1",
    begin: Begin = silent,
) -> list[str]:
    """Write the C library for a CNC post-processor; the names of its files.

    With a ``pair`` also a settings file of each member, from which ``gm-post``, a C program of the folder, writes the
    program of :meth:`Member.program`; ``control`` and ``blocks`` as there. Raises InputError.
    """
    settings = {} if pair is None else _settings(set_of(pair), machine_of(machine), control, blocks, begin)
    return list(_export_cnc(Path(folder), settings))


def _settings(
    pair: GearSet, machine: Machine, control: str | None, blocks: Literal["g1", "poly"], begin: Begin
) -> dict[str, str]:
    """Settings files of the members of a set, by name; their programs are run first."""
    dialect, files = named(machine.spec.control.dialect(control)), {}
    for name in pair.spec.members:
        one, file = pair.member(name), f"{name}.settings"
        with about(pair.source):
            job = CuttingJob(range(one.teeth), blocks=blocks)
            made = cutting(one, machine, name.upper(), job, dialect.name, file, begin).made
            if made is not None:
                files[file] = post_file(made.plan, dialect)
    return files

"""The controls that programs are written for, each as one record: writers, names, counts, words, and how it is read.

A dialect of another control is a record too, and ``register`` makes every command know it. What nobody can read back is
not written: a program of a new dialect is translated line by line into words of a known one, and judged so.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

from gearmath.errors import InputError
from gearmath.machine.control.file_names import control_name, linuxcnc_name
from gearmath.machine.control.text import LINUXCNC_MARK
from gearmath.machine.planning.cut_plan import CuttingPlan
from gearmath.machine.writing import cutting, words
from gearmath.machine.writing.linuxcnc import cutting as linuxcnc_cutting
from gearmath.machine.writing.linuxcnc import probing as linuxcnc_probing
from gearmath.machine.writing.linuxcnc.configuration import SUFFIXES, configuration
from gearmath.machine.writing.linuxcnc.dialect import Dialect, block_count
from gearmath.machine.writing.linuxcnc.probe_words import LinuxCncBlocks
from gearmath.machine.writing.linuxcnc.sheet_words import LINUXCNC_WORDS
from gearmath.machine.writing.probe_words import Blocks
from gearmath.machine.writing.probing import SINUMERIK as SINUMERIK_TOUCHES
from gearmath.machine.writing.probing import TouchWriter
from gearmath.machine.writing.sheet_words import SINUMERIK_WORDS, SheetWords
from gearmath.machine.writing.words import Positions
from gearmath.specs.control import CONTROLS, Control
from gearmath.specs.milling_machine import MillingMachine

__all__ = ["LINUXCNC", "SINUMERIK", "ControlDialect", "known", "named", "of_text", "register", "relative_of_linuxcnc"]


@dataclass(frozen=True)
class Examples:
    """Files that a control needs beside a program, as examples: their suffixes, and their texts by suffix.

    ``texts`` gets the name of the program, the machine, and number and length [mm] of the tools by name.
    """

    suffixes: tuple[str, ...]
    texts: Callable[[str, MillingMachine, dict[str, tuple[int, float]]], dict[str, str]]


@dataclass(frozen=True, kw_only=True)
class ControlDialect(Control):
    """How programs for one control are written, named, counted, explained and read."""

    suffix: str
    """Of a program's file, with its dot."""
    cutting: Callable[[CuttingPlan, str], str]
    """The text of a planned cutting program of a name."""
    probing: TouchWriter
    blocks: type[Blocks]
    """The blocks of calibration programs."""
    positions: Callable[[MillingMachine], Positions]
    """How positions of cutting programs stand in the text."""
    block_count: Callable[[str], int]
    sheet: SheetWords
    file_name: Callable[[str], str]
    """The name of a file as the control keeps it. Raises InputError for one that it does not take."""
    examples: Examples | None = None

    def read(self, text: str) -> str:
        """A text of this dialect as it is judged."""
        return text if self.as_read is None else self.as_read(text)


def _cutter_positions(machine: MillingMachine) -> Positions:
    return Positions.of(machine, machine.tool_length)


SINUMERIK = ControlDialect(
    name="sinumerik",
    suffix=".MPF",
    cutting=cutting.program_of,
    probing=SINUMERIK_TOUCHES,
    blocks=Blocks,
    positions=_cutter_positions,
    block_count=words.block_count,
    sheet=SINUMERIK_WORDS,
    file_name=control_name,
)
LINUXCNC = ControlDialect(
    name="linuxcnc",
    suffix=".ngc",
    cutting=linuxcnc_cutting.program_of,
    probing=linuxcnc_probing.LINUXCNC,
    blocks=LinuxCncBlocks,
    positions=lambda machine: replace(
        _cutter_positions(machine), modulo=False, turning_cutter=False
    ),  # A and C count on
    block_count=block_count,
    sheet=LINUXCNC_WORDS,
    file_name=linuxcnc_name,
    examples=Examples(SUFFIXES, configuration),
    mark=LINUXCNC_MARK,
)
CONTROLS.update({one.name: one for one in (SINUMERIK, LINUXCNC)})


def known() -> tuple[ControlDialect, ...]:
    """All dialects, in the order in which they were registered."""
    return tuple(one for one in CONTROLS.values() if isinstance(one, ControlDialect))


def named(name: str) -> ControlDialect:
    """The dialect of a name. Raises InputError for one that nobody has registered."""
    found = next((one for one in known() if one.name == name), None)
    if found is None:
        raise InputError(f"control {name}: must be {' or '.join(CONTROLS)}")
    return found


def of_text(text: str) -> ControlDialect:
    """The dialect that a program says it has; that of a SINUMERIK says nothing."""
    return next((one for one in known() if one.mark and one.mark in text), SINUMERIK)


def register(dialect: ControlDialect) -> ControlDialect:
    """Make a dialect known: to ``--control``, to machine files, and to all that read programs.

    Raises ValueError for a name that is taken, and for a dialect without mark or translation.
    """
    if dialect.name in CONTROLS:
        raise ValueError(f"control {dialect.name}: is registered already")
    if not dialect.mark or dialect.as_read is None:
        raise ValueError(f"control {dialect.name}: needs a mark in its programs and as_read, so that they are judged")
    CONTROLS[dialect.name] = dialect
    return dialect


def relative_of_linuxcnc(
    name: str, suffix: str, own: type[Dialect], mark: str, as_read: Callable[[str], str]
) -> ControlDialect:
    """A dialect of RS-274 that differs from LinuxCNC's by its ``own`` words.

    ``as_read`` turns a program, line for line, into one of LinuxCNC's own words.
    """
    kind = type(f"{own.__name__}Blocks", (LinuxCncBlocks,), {"words": own})
    return replace(
        LINUXCNC,
        name=name,
        suffix=suffix,
        cutting=partial(linuxcnc_cutting.program_of, words=own),
        probing=linuxcnc_probing.touch_writer(kind),
        blocks=kind,
        file_name=partial(_stem_checked, suffix),
        examples=None,
        mark=mark,
        as_read=as_read,
    )


def _stem_checked(suffix: str, name: str) -> str:
    words.check_name(name.removesuffix(suffix))
    return name

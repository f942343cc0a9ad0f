"""Options of ``gearmath nc`` that say for which control a program is written."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gearmath.errors import InputError

if TYPE_CHECKING:
    from gearmath.specs.milling_machine import MillingMachine

LINUXCNC = "linuxcnc"
CONTROL = click.option(
    "--control",
    type=click.Choice(["sinumerik", LINUXCNC]),
    help="Control that the program is for.  [default: that of the machine file, or sinumerik]",
)
CONFIGURATION = click.option(
    "--configuration",
    is_flag=True,
    help="LinuxCNC: also write an example of its INI, HAL, tool and parameter files beside the program.",
)


def dialect_of(machine: MillingMachine, control: str | None, beside: Path | None, sheet: Path | None) -> str:
    """The control that a program is for.

    Raises InputError where options do not go with it, the machine has another, or its configuration cannot be written
    ``beside`` a program.
    """
    from gearmath.files import check_place
    from gearmath.machine.writing.linuxcnc.configuration import SUFFIXES

    dialect = machine.control.dialect(control)
    if dialect == LINUXCNC and sheet is not None:
        raise InputError("--sheet: set-up sheets describe programs for a SINUMERIK, not for LinuxCNC")
    if dialect != LINUXCNC and beside is not None:
        raise InputError("--configuration goes with --control linuxcnc")
    if beside is not None:
        if beside.suffix.lower() in SUFFIXES:
            raise InputError(f"--output {beside}: --configuration writes that file, name the program .ngc")
        for place in map(beside.with_suffix, SUFFIXES):
            check_place(place)
            if place.is_dir():
                raise InputError(f"{place}: cannot be written: Is a directory")
    return dialect


def write_configuration(program: Path, machine: MillingMachine, tools: dict[str, tuple[int, float]]) -> None:
    """The example files beside a program, for ``tools``: number and length in the tool table by name.

    What is there already stays: drives may have been connected in it, and LinuxCNC keeps the number of the run there.
    """
    from gearmath.files import write_text
    from gearmath.machine.writing.linuxcnc.configuration import configuration

    for suffix, text in configuration(program.stem, machine, tools).items():
        target = program.with_suffix(suffix)
        if target.exists():
            click.echo(f"{target}: is there already, left as it is")
            continue
        write_text(target, text)
        click.echo(f"{target}: example, written")


def both(*options: Any) -> Any:
    """Several options as one decorator."""

    def decorate(command: Any) -> Any:
        for option in reversed(options):
            command = option(command)
        return command

    return decorate


TARGET = both(CONTROL, CONFIGURATION)

"""Options of ``gearmath nc`` that say for which control a program is written."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gearmath.errors import InputError
from gearmath.specs.control import CONTROLS

if TYPE_CHECKING:
    from gearmath.machine.judging.dialects import ControlDialect
    from gearmath.specs.milling_machine import MillingMachine


class _KnownControl(click.ParamType):
    """The name of a control for which there is a dialect, registered ones too."""

    name = "control"

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        return f"[{'|'.join(CONTROLS)}]"

    def convert(self, value: str, param: click.Parameter | None, ctx: click.Context | None) -> str:
        if value not in CONTROLS:
            self.fail(f"{value!r} is not one of {', '.join(map(repr, CONTROLS))}.", param, ctx)
        return value


CONTROL = click.option(
    "--control",
    type=_KnownControl(),
    help="Control that the program is for.  [default: that of the machine file, or sinumerik]",
)
CONFIGURATION = click.option(
    "--configuration",
    is_flag=True,
    help="LinuxCNC: also write an example of its INI, HAL, tool and parameter files beside the program.",
)


def dialect_of(machine: MillingMachine, control: str | None, beside: Path | None = None) -> ControlDialect:
    """The dialect of the control that a program is for.

    Raises InputError where options do not go with it, the machine has another, or its configuration cannot be written
    ``beside`` a program.
    """
    from gearmath.files import check_place
    from gearmath.machine.judging.dialects import LINUXCNC, named

    dialect = named(machine.control.dialect(control))
    if beside is not None:
        if dialect.examples is None:
            raise InputError(f"--configuration goes with --control {LINUXCNC.name}")
        if beside.suffix.lower() in dialect.examples.suffixes:
            raise InputError(f"--output {beside}: --configuration writes that file, name the program {dialect.suffix}")
        for place in map(beside.with_suffix, dialect.examples.suffixes):
            check_place(place)
            if place.is_dir():
                raise InputError(f"{place}: cannot be written: is a folder, name a file")
    return dialect


def write_configuration(
    program: Path, dialect: ControlDialect, machine: MillingMachine, tools: dict[str, tuple[int, float]]
) -> None:
    """The example files beside a program, for ``tools``: number and length in the tool table by name.

    What is there already stays: drives may have been connected in it, and LinuxCNC keeps the number of the run there.
    """
    from gearmath.files import write_text

    if dialect.examples is None:
        return
    for suffix, text in dialect.examples.texts(program.stem, machine, tools).items():
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

"""``gearmath export``: C for the microcontroller and for the CNC post-processor."""

from __future__ import annotations

from pathlib import Path

import click

_FOLDER = click.option(
    "-o", "--output", "folder", type=click.Path(path_type=Path), required=True, help="Folder to write or to replace."
)


@click.group()
def export() -> None:
    """C for the microcontroller and for the CNC post-processor."""


@export.command()
@click.argument("machine")
@_FOLDER
def teensy(machine: str, folder: Path) -> None:
    """Arduino sketch folder of the electronic gearbox for MACHINE (a TOML file, or a bundled one).

    Firmware, the machine's constants, wiring diagram and README. The folder's name becomes the sketch's name.
    """
    from gearmath.export.teensy import export_teensy
    from gearmath.specs.hobbing import load_hobbing_machine
    from gearmath.specs.toml import find

    names = export_teensy(load_hobbing_machine(find(machine)), folder)
    click.echo(f"{folder}: {len(names)} files")


@export.command()
@_FOLDER
def cnc(folder: Path) -> None:
    """C library of the bevel gear kernels for a CNC post-processor."""
    from gearmath.export.cnc import export_cnc

    names = export_cnc(folder)
    click.echo(f"{folder}: {len(names)} files")

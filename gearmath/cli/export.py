"""``gearmath export``: C for the microcontroller and the post-processor; solids, REXS and points for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import click

from gearmath.cli.common import (
    HTML,
    JSON,
    MACHINE,
    MEMBER,
    SET,
    about,
    bars,
    echo_json,
    grid_of,
    member_of,
    nominal_words,
    of,
    output,
)
from gearmath.cli.dialect import CONTROL
from gearmath.errors import InputError, counted

_FOLDER = click.option(
    "-o", "--output", "folder", type=click.Path(path_type=Path), required=True, help="Folder to write or to replace."
)


@click.group()
def export() -> None:
    """C for the microcontroller and the CNC post-processor; solids, REXS and points for other programs."""


@export.command()
@click.argument("machine")
@_FOLDER
def teensy(machine: str, folder: Path) -> None:
    """Arduino sketch folder of the electronic gearbox for MACHINE (a TOML file, or a bundled one).

    Firmware, the machine's constants, wiring diagram and README. The folder's name becomes the sketch's name.
    """
    from gearmath.export.reservations import reservations
    from gearmath.export.teensy import machine_of
    from gearmath.front.hobbing import export_teensy
    from gearmath.front.machines import load_hobber

    hobber, before = load_hobber(machine), machine_of(folder)
    names = export_teensy(hobber, folder)
    click.echo(f"{folder}: {len(names)} files")
    if before is not None and before != hobber.name:
        click.echo(f"  they replace those of {before!r}")
    for said in reservations(hobber):
        click.echo(f"  {said.replace('`', '')}")


@export.command()
@click.argument("gear_set", metavar="[SET]", required=False)
@MACHINE
@CONTROL
@click.option(
    "--blocks",
    type=of("blocks"),
    default="g1",
    show_default=True,
    help="Straight blocks, or polynomials where the cutter rolls, in the programs of gm-post.",
)
@_FOLDER
def cnc(gear_set: str | None, machine: str, control: str | None, blocks: Literal["g1", "poly"], folder: Path) -> None:
    """C library of the bevel gear kernels for a CNC post-processor; with SET also settings files for its gm-post.

    Of every member of SET (a TOML file, or a bundled one) the folder gets MEMBER.settings, from which gm-post, a C
    program of the folder, writes the program of 'gearmath nc cut' without Python.
    """
    from gearmath.front.exports import export_cnc
    from gearmath.front.machines import load_machine
    from gearmath.front.sets import load_set

    pair = None if gear_set is None else load_set(gear_set)
    with bars() as begin:
        names = export_cnc(folder, pair, load_machine(machine), control, blocks, begin)
    click.echo(f"{folder}: {len(names)} files")
    for name in () if pair is None else pair.spec.members:
        click.echo(f"{folder / f'{name}.settings'}: {name}, for gm-post")


@export.command()
@SET
@MEMBER
@JSON
@output("STEP, mm", ".step", ".stp")
def step(gear_set: str, member: str | None, as_json: bool, target: Path) -> None:
    """Closed solids for CAD: a member in its work frame, or, without --member, the pair in mesh.

    Flanks, fillets, roots and lands are B-splines: flanks within 0.05 um, fillets within 1 um of what the cutter
    leaves. Needs the extra cad: pip install '.[cad]'.
    """
    from gearmath.front.sets import load_set

    pair = load_set(gear_set)
    what = pair if member is None else pair.member(member)
    with bars(quiet=as_json) as begin, about(pair.source):
        written = what.to_step(target, begin)
    if as_json:
        echo_json({name: {"volume_mm3": one.volume} for name, one in written.items()})
        return
    for name, one in written.items():
        click.echo(f"{target}: {name}, closed solid of {one.faces} faces, {one.volume:.2f} mm^3")


@export.command()
@SET
@output("binary STL, mm", ".stl")
def stl(gear_set: str, target: Path) -> None:
    """Triangles of the pair in mesh, both members whole, touching on the drive side; of one: 'gearmath tooth'."""
    from gearmath.front.sets import load_set

    pair = load_set(gear_set)
    with bars() as begin, about(pair.source):
        triangles = pair.to_stl(target, begin)
    click.echo(f"{target}: {triangles} triangles, pinion axis Z, gear axis in the plane of Z and X")


@export.command()
@SET
@MEMBER
@click.option("--flank", type=of("flank"), required=True)
@click.option("--grid", default="5x9", show_default=True, help="Rows (root to tip) x columns (toe to heel).")
@click.option(
    "--margin", type=float, default=0.1, show_default=True, help="Part of depth and width left out all round."
)
@output("plain text, mm")
def points(gear_set: str, member: str | None, flank: str, grid: str, margin: float, target: Path) -> None:
    """Nominal points and outward normals of one flank as plain text, a row 'x y z i j k' each.

    For measuring machines that take such lists; row by row, root to tip, toe to heel. 'gearmath points' reads them.
    """
    from gearmath.front.sets import load_set

    pair = load_set(gear_set)
    one = member_of(pair, member)
    shape = grid_of(grid)
    if not 0 <= margin < 0.5:
        raise InputError(f"--margin {margin:g}: must be at least 0 and less than 0.5")
    with about(pair.source):
        found = one.flank(flank, shape, margin)
    found.to_text(target)
    click.echo(f"{target}: {counted(len(found.file), 'point')}{nominal_words(one, flank)}")


@export.command()
@SET
@output("REXS 2.0.0: XML", ".rexs", ".xml")
def rexs(gear_set: str, target: Path) -> None:
    """The set as REXS 2.0.0; what REXS has no name for stays in attributes of its own (docs/exchange.md)."""
    from gearmath.front.sets import load_set

    pair = load_set(gear_set)
    with about(pair.source):
        count = pair.to_rexs(target)
    click.echo(f"{target}: {count} components")


@export.command()
@SET
@output("HTML that prints on A4", *HTML)
def summary(gear_set: str, target: Path) -> None:
    """The summary sheet of a set: blank, machine settings and cutter build of its members, in mm and in inches."""
    from gearmath.front.sets import load_set

    click.echo(f"{load_set(gear_set).to_summary(target)}: summary sheet, prints on A4")

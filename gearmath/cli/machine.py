"""``gearmath nc``: programs for the vertical machine."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from gearmath.cli.common import MACHINE, MEMBER, SET, SHEET, bars, member_of, of, output
from gearmath.cli.dialect import TARGET, dialect_of, write_configuration
from gearmath.cli.probe import nc_calibrate, probe
from gearmath.cli.program_time import program_time
from gearmath.errors import InputError

if TYPE_CHECKING:
    pass


@click.group()
def nc() -> None:
    """NC programs for the vertical 5-axis machine (SINUMERIK 840D sl, or LinuxCNC)."""


nc.add_command(probe)
nc.add_command(nc_calibrate)
nc.add_command(program_time)


@nc.command()
@SET
@MEMBER
@MACHINE
@click.option(
    "--spaces",
    default="all",
    show_default=True,
    help="Tooth spaces to cut: all, or numbers such as 0,1,2; face hobbing cuts all.",
)
@click.option(
    "--tolerance-um",
    type=float,
    default=0.1,
    show_default=True,
    help="Flank deviation by straight blocks, and by the scallops of face hobbing.",
)
@click.option("--feed", type=float, default=300.0, show_default=True, help="Feed of the cutter past the tooth, mm/min.")
@click.option("--rpm", type=float, default=120.0, show_default=True, help="Spindle speed.")
@click.option("--roughing-stock", type=float, default=0.0, help="Rough first and leave this much, mm; 0 for none.")
@click.option("--finishing-stock", type=float, default=0.0, help="Stock that stays on the finished flanks, mm.")
@click.option(
    "--blocks",
    type=of("blocks"),
    default="g1",
    show_default=True,
    help="Straight blocks, or polynomials where the cutter rolls (an option of the control).",
)
@click.option("--dry-run", is_flag=True, help="Cut air: everything above the work, without coolant.")
@TARGET
@SHEET
@output(".MPF, or .ngc for LinuxCNC; its name becomes the program name")
def cut(
    gear_set: str,
    member: str | None,
    machine: str,
    spaces: str,
    tolerance_um: float,
    feed: float,
    rpm: float,
    roughing_stock: float,
    finishing_stock: float,
    blocks: Literal["g1", "poly"],
    dry_run: bool,
    control: str | None,
    configuration: bool,
    sheet: Path | None,
    target: Path,
) -> None:
    """The cutting program of a member.

    Before it is written it is run: it must keep the limits of the machine, collide with nothing, and leave both flanks
    within the tolerance.
    """
    from gearmath.files import write_text
    from gearmath.front.machines import load_machine
    from gearmath.front.programs import cutting
    from gearmath.front.sets import load_set
    from gearmath.machine.planning.cut_plan import CuttingJob
    from gearmath.machine.planning.limits import check_spindle_speed
    from gearmath.machine.writing.linuxcnc.cutting import tools_of
    from gearmath.machine.writing.words import check_target

    check_target(target)
    job = CuttingJob((0,), tolerance_um / 1000, feed, rpm, roughing_stock, finishing_stock, dry_run, blocks)
    on = load_machine(machine)
    dialect = dialect_of(on.spec, control, target if configuration else None)
    check_spindle_speed(target.stem, on.spec, rpm)
    one = member_of(load_set(gear_set), member)
    job = replace(job, spaces=_spaces(spaces, one.teeth))
    with bars() as begin:
        made = cutting(one, on, target.stem, job, dialect.name, target, begin)
    page = None if sheet is None else made.sheet(target.name)
    if note := one.gear_set.edge_note():
        click.echo(f"note: {note}")
    click.echo(f"{made.save(target)}: {len(job.spaces)} of {one.teeth} spaces, {made.blocks} blocks")
    if one.spec.process == "face_hobbing":
        click.echo("note: the tolerance holds for the flanks; fillets keep more, which `gearmath mill --report` gives")
    if configuration and made.made is not None:
        write_configuration(target, dialect, on.spec, tools_of(made.made.plan))
    if sheet is not None and page is not None:
        write_text(sheet, page)
        click.echo(f"{sheet}: set-up sheet, prints on A4")


def _spaces(text: str, teeth: int) -> list[int]:
    if text == "all":
        return list(range(teeth))
    numbers = [int(part) if part.strip().isdecimal() else -1 for part in text.split(",")]
    if not all(0 <= number < teeth for number in numbers):
        raise InputError(f"--spaces {text}: must be all, or numbers from 0 to {teeth - 1} with commas between them")
    return list(dict.fromkeys(numbers))

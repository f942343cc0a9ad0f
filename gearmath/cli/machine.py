"""``gearmath nc`` and ``gearmath mill``: programs for the vertical machine, and what they would cut."""

from __future__ import annotations

from pathlib import Path

import click

from gearmath.cli.common import MACHINE, MEMBER, SET, about, bar, output
from gearmath.errors import InputError


@click.group()
def nc() -> None:
    """NC programs for the vertical 5-axis machine (SINUMERIK 840D sl)."""


@nc.command()
@SET
@MEMBER
@MACHINE
@click.option("--spaces", default="all", show_default=True, help="Tooth spaces to cut: all, or numbers such as 0,1,2.")
@click.option("--tolerance-um", type=float, default=0.1, show_default=True, help="Flank deviation by straight blocks.")
@click.option(
    "--feed", type=float, default=300.0, show_default=True, help="Generating feed of the cutter centre, mm/min."
)
@click.option("--rpm", type=float, default=120.0, show_default=True, help="Spindle speed.")
@output(".MPF; its name becomes the program name")
def cut(
    gear_set: str, member: str, machine: str, spaces: str, tolerance_um: float, feed: float, rpm: float, target: Path
) -> None:  # fmt: skip
    """The cutting program of a member."""
    from gearmath.files import write_text
    from gearmath.machine.cutting import cutting_program
    from gearmath.specs.bevel_set import load_bevel_set
    from gearmath.specs.milling_machine import load_milling_machine
    from gearmath.specs.toml import find

    bevel_set = load_bevel_set(find(gear_set))
    wanted = _spaces(spaces, bevel_set.member(member).teeth)
    text = cutting_program(
        bevel_set, member, load_milling_machine(find(machine)), target.stem, wanted, tolerance_um / 1000, feed, rpm
    )
    write_text(target, text)
    click.echo(f"{target}: {len(wanted)} of {bevel_set.member(member).teeth} spaces, {text.count(chr(10))} blocks")


@click.command()
@SET
@MEMBER
@MACHINE
@click.option("--program", required=True, type=click.Path(path_type=Path), help="NC program to run.")
@click.option("--errors", help="What is wrong with the machine: a TOML file, or the bundled simulated_shop.toml.")
@output("flank CSV")
def mill(gear_set: str, member: str, machine: str, program: Path, errors: str | None, target: Path) -> None:
    """Virtual milling from the program text: the deviations it leaves, as a measured flank CSV."""
    from gearmath.files import read_text
    from gearmath.machine.mill import mill_member
    from gearmath.machine.reader import execute
    from gearmath.specs.bevel_set import load_bevel_set
    from gearmath.specs.flank_csv import write_flank_csv
    from gearmath.specs.milling_machine import load_milling_machine
    from gearmath.specs.simulated_machine import load_simulated_machine
    from gearmath.specs.toml import find

    spec = load_bevel_set(find(gear_set)).member(member)
    milling_machine = load_milling_machine(find(machine))
    simulated = load_simulated_machine(find(errors)) if errors else None
    path = execute(read_text(program), str(program))
    with bar(2 * spec.teeth, "flank") as progress, about(program):
        measured = mill_member(path, spec, member, milling_machine, simulated, progress)
    write_flank_csv(target, measured)
    worst = float(abs(measured.deviation).max()) * 1000
    click.echo(f"{target}: {len(measured)} points, largest deviation {worst:.3f} um")


def _spaces(text: str, teeth: int) -> list[int]:
    if text == "all":
        return list(range(teeth))
    numbers = [int(part) if part.strip().isdecimal() else -1 for part in text.split(",")]
    if not all(0 <= number < teeth for number in numbers):
        raise InputError(f"--spaces {text}: must be all, or numbers from 0 to {teeth - 1} with commas between them")
    return list(dict.fromkeys(numbers))

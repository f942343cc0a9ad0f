"""``gearmath nc`` and ``gearmath mill``: programs for the vertical machine, and what they would cut."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from gearmath.cli.common import (
    FLANK_CSV,
    MACHINE,
    MEMBER,
    SET,
    SHEET,
    NewFile,
    Number,
    about,
    bar,
    bars,
    member_of,
    output,
)
from gearmath.cli.dialect import TARGET, dialect_of, write_configuration
from gearmath.cli.probe import nc_calibrate, probe
from gearmath.cli.program_time import program_time
from gearmath.errors import ComputationError, InputError, counted

if TYPE_CHECKING:
    from gearmath.front.programs import Program
    from gearmath.machine.judging.cut import MetalLeft
    from gearmath.specs.simulated_machine import SimulatedMachine


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
    type=click.Choice(["g1", "poly"]),
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
    from gearmath.machine.writing.words import check_name

    check_name(target.stem)
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
    if configuration and made.made is not None:
        write_configuration(target, dialect, on.spec, tools_of(made.made.plan))
    if sheet is not None and page is not None:
        write_text(sheet, page)
        click.echo(f"{sheet}: set-up sheet, prints on A4")


@click.command(epilog=FLANK_CSV)
@SET
@MEMBER
@MACHINE
@click.option("--program", required=True, type=click.Path(path_type=Path), help="NC program to run.")
@click.option("--errors", help="What is wrong with the machine: a TOML file, or the bundled simulated_shop.toml.")
@click.option(
    "--report",
    type=NewFile(),
    help="Also write a JSON file of gouges, uncut stock, collisions, axis speeds and time.",
)
@click.option(
    "--report-tolerance-um",
    type=Number(0.01, 1000, "um"),
    default=1.0,
    show_default=True,
    help="Deviation on flank, fillet or root that the report counts as a fault.",
)
@click.option("--measured", is_flag=True, help="Clamp the member anew and measure it as the machine of --errors does.")
@click.option(
    "--run",
    type=click.IntRange(min=1),
    default=1,
    show_default=True,
    help="Number of the measurement of --measured: each has its own noise.",
)
@output("flank CSV")
def mill(
    gear_set: str,
    member: str | None,
    machine: str,
    program: Path,
    errors: str | None,
    report: Path | None,
    report_tolerance_um: float,
    measured: bool,
    run: int,
    target: Path,
) -> None:
    """Virtual milling from the program text: the deviations it leaves, as a measured flank CSV.

    With --measured they are those of a measuring machine, with the clamping, drift and probe of the file of --errors:
    tooth 0 in full, the corners of the grid on eight teeth around, and tooth 0 again at the end.

    Every block is checked on a machine without errors. The status is 1, and the last line says why with figure and
    limit, where flanks, fillets or root are gouged or keep stock by more than the program states (1 um where it states
    nothing), where spaces are left out, blocks end off the path of the settings, anything collides, rapid motion comes
    near the work, or the machine must not run it: travel, speed, acceleration, feed, spindle, modes. With --report,
    without --errors, it is so too where a surface is off by more than --report-tolerance-um from what the settings of
    the set cut, corrected or not; what corrected settings are off their design is said beside it. Of face hobbed
    members flanks alone are judged, fillets and root with --report only.
    """
    from gearmath.front.machines import load_machine, load_shop
    from gearmath.front.programs import Program
    from gearmath.front.sets import load_set
    from gearmath.machine.control.text import program_text, skip_blocks
    from gearmath.machine.judging.stated import Stated, stated_member

    pair, text = load_set(gear_set), program_text(program)
    one, on = member_of(pair, member, stated_member(text)), load_machine(machine)
    shop = load_shop(errors) if errors else None
    made = Program(one, on, str(program), text)
    _ = made.path  # what the control refuses is said first
    if skipped := skip_blocks(text):
        click.echo(f"{program}: {counted(skipped, 'block')} with / in front, judged as not skipped")
    if measured and shop is None:
        raise InputError("--measured needs --errors: the file that says how the member sits and what the probe does")
    with about(program), bar(2 * one.teeth, "flank") as progress:
        found = made.mill(shop, progress, run if measured else None)
    found.to_csv(target)
    worst = float(abs(found.deviation).max())
    click.echo(f"{target}: {counted(len(found.file), 'point')}, largest deviation {worst * 1000:.3f} um")
    with about(program), bars() as begin:
        _say_ridge(made)
        judged = made.judge(found if shop is None else None, begin)
    _say_metal(judged.left)
    faults = list(judged.faults)
    if report is not None:
        told = _write_report(report, made, shop, report_tolerance_um / 1000)
        faults += told if shop is None else []
    if faults:
        raise ComputationError(f"{program}: {'; '.join(faults)}: refused")
    if shop is not None:
        click.echo(f"the flanks are not compared with a tolerance: the machine has the errors of {errors}")
    else:
        cut, left = sorted({number for each in made.runs for number in each.spaces}), judged.left
        stated = Stated.of(text)
        within = f"within {1000 * left.tolerance:.4g} um"
        if stated.tolerance is None:
            within += ", as none is stated"
        elif left.tolerance < stated.tolerance:
            within += f", which its blocks are made for, of the {1000 * stated.tolerance:g} um that it states"
        if not stated.is_ours:
            click.echo(f"{program}: not judged: whether it looks at tool, offsets and units before it moves")
        click.echo(
            f"{program}: passed: {len(cut)} of {one.teeth} spaces {within}, nothing collides, {on.spec.name} "
            "keeps its limits; run from its start, with the control set up as the machine file says"
        )


def _say_ridge(made: Program) -> None:
    """Print what of the root stays between the two sides of a space."""
    from gearmath.bevel.ridge import RIDGE, ridge, ridge_words
    from gearmath.machine.judging.cut import as_cut

    space = made.space
    if space is not None and (between := ridge(as_cut(made.member.spec, space), space)) > RIDGE:
        click.echo(f"the root: {ridge_words(between)}")


def _say_metal(left: MetalLeft) -> None:
    """Print what the blocks leave on a machine without errors."""
    if (found := left.watch) is not None and math.isfinite(found.lowest):
        _, (number, flank, line) = found.worst
        click.echo(
            f"every block checked on {found.lines} normals of the flanks of these settings: {found.lowest * 1000:.3f} "
            f"to {found.highest * 1000:.3f} um, the largest by line {line} of the program (space {number}, {flank} "
            "flank)"
        )


def _write_report(target: Path, made: Program, shop: SimulatedMachine | None, tolerance: float) -> list[str]:
    """Write and print the report; a sentence for each kind of fault in it."""
    import json

    from gearmath.files import write_text
    from gearmath.machine.judging.report import largest

    with bars() as begin:
        found = made.report(tolerance, shop, begin)
    write_text(target, json.dumps(found.as_dict(), indent=2) + "\n")
    seconds = found.timing.feed_seconds + found.timing.rapid_seconds
    click.echo(
        f"{target}: {seconds:.0f} s, {len(found.gouges)} surfaces gouged, {len(found.uncut)} with stock, "
        f"{len(found.collisions)} collisions"
    )
    if own := found.surfaces_of_settings:
        click.echo(
            f"  corrected settings: the flanks deviate by up to {largest(own, 'flank') * 1000:.3f} um from those of "
            f"these settings, and by {largest(found.surfaces, 'flank') * 1000:.3f} um from the design"
        )
    for state in found.gouges[:5]:
        click.echo(f"  space {state.space}, {state.surface}: {state.lowest * 1000:.3f} um, line {state.line}")
    for state in found.uncut[:5]:
        click.echo(
            f"  space {state.space}, {state.surface}: stock at {state.uncut} of {state.points} points, "
            f"up to {state.highest * 1000:+.3f} um where a tool comes near"
        )
    for one in found.collisions[:5]:
        click.echo(f"  {one.cutter} and {one.work}: {one.depth:.3f} mm deep, line {one.lines[0]}")
    kinds = (
        (found.gouges, f"surfaces are gouged by more than {tolerance * 1000:g} um"),
        (found.uncut, f"surfaces keep more than {tolerance * 1000:g} um of stock"),
        (found.collisions, "collisions"),
    )
    return [f"{len(those)} {what}" for those, what in kinds if those]


def _spaces(text: str, teeth: int) -> list[int]:
    if text == "all":
        return list(range(teeth))
    numbers = [int(part) if part.strip().isdecimal() else -1 for part in text.split(",")]
    if not all(0 <= number < teeth for number in numbers):
        raise InputError(f"--spaces {text}: must be all, or numbers from 0 to {teeth - 1} with commas between them")
    return list(dict.fromkeys(numbers))

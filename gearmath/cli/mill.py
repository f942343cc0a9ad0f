"""``gearmath mill``: what a program for the vertical machine would cut, and whether the machine may run it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gearmath.cli.common import FLANK_CSV, MACHINE, MEMBER, SET, NewFile, about, bar, bars, member_of, of, output
from gearmath.errors import ComputationError, InputError, counted

if TYPE_CHECKING:
    from gearmath.front.programs import Program
    from gearmath.machine.judging.cut import MetalLeft
    from gearmath.machine.judging.stated import Stated
    from gearmath.machine.milling.surfaces import SurfaceState
    from gearmath.specs.simulated_machine import SimulatedMachine


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
    type=of("report_tolerance", um=True),
    help="Deviation on flank, fillet or root that the report counts as a fault. Left out: on flanks what the program "
    "states, on fillets and roots that or 1 um, whichever is more; 1 um where it states nothing.",
)
@click.option("--measured", is_flag=True, help="Clamp the member anew and measure it as the machine of --errors does.")
@click.option(
    "--run",
    type=of("number"),
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
    report_tolerance_um: float | None,
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
    without --errors, it is so too where a surface is off by more than --report-tolerance-um, or else a flank by more
    than the program states and a fillet or root by more than 1 um, from what the settings of the set cut, corrected or
    not; what corrected settings are off their design is said beside it. Of face hobbed members flanks alone are judged,
    fillets and root with --report only.
    """
    from gearmath.front.machines import load_machine, load_shop
    from gearmath.front.programs import Program
    from gearmath.front.sets import load_set
    from gearmath.machine.control.text import check_moves, program_text, skip_blocks
    from gearmath.machine.judging.stated import Stated, stated_member

    pair, text = load_set(gear_set), program_text(program)
    if member is None and stated_member(text) is None:
        check_moves(text, str(program))  # said before what is asked of a set with both members
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
    for remark in judged.remarks:
        click.echo(f"note: {program}: {remark}")
    faults = list(judged.faults)
    if report is not None:
        told = _write_report(report, made, shop, _Limits.of(report_tolerance_um, Stated.of(text), judged.left))
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


@dataclass(frozen=True)
class _Limits:
    """What a report counts as a fault [mm], and the words that say why: on flanks, and on fillets and roots."""

    flank: float
    elsewhere: float
    flank_words: str
    words: str

    @staticmethod
    def of(asked_um: float | None, stated: Stated, left: MetalLeft) -> _Limits:
        from gearmath.machine.judging.cut import says
        from gearmath.machine.milling.surfaces import DEFAULT_TOLERANCE

        if asked_um is not None:
            words = f"--report-tolerance-um allows {asked_um:g} um"
            return _Limits(asked_um / 1000, asked_um / 1000, words, words)
        on_flanks, elsewhere = left.tolerance, max(left.tolerance, DEFAULT_TOLERANCE)
        words = f"{says(stated, on_flanks)} {on_flanks * 1000:.4g} um"
        return _Limits(on_flanks, elsewhere, words, f"allowed are {elsewhere * 1000:.4g} um")


def _write_report(target: Path, made: Program, shop: SimulatedMachine | None, limits: _Limits) -> list[str]:
    """Write and print the report; a sentence for each kind of fault in it."""
    import json

    from gearmath.files import write_text
    from gearmath.machine.judging.report import largest

    with bars() as begin:
        found = made.report(limits.elsewhere, shop, begin, limits.flank)
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
    met = [counted(len(found.collisions), "collision")] if found.collisions else []
    return [*_beyond(found.gouges, limits, True), *_beyond(found.uncut, limits, False), *met]


def _beyond(states: Sequence[SurfaceState], limits: _Limits, gouged: bool) -> Iterator[str]:
    """Sentences of surfaces that are cut too deep, or keep too much: how many, the worst figure, and the limit."""
    for on_flank, limit, words in ((True, limits.flank, limits.flank_words), (False, limits.elsewhere, limits.words)):
        those = [state for state in states if state.surface.endswith("flank") == on_flank]
        name = counted(len(those), "flank" if on_flank else "surface") + ("" if on_flank else " of fillets and root")
        worst = min((state.lowest for state in those), default=0.0)
        if gouged and those:
            yield f"{name} gouged by up to {worst * 1000:.3f} um, {words}"
            continue
        worst = max((state.highest for state in those), default=0.0)
        if worst > limit:
            yield f"stock on {name}, up to {worst * 1000:+.3f} um, {words}"
        if unmet := sum(state.unmet for state in those):
            yield f"{counted(unmet, 'point')} on {name} not cut at all"

"""``gearmath probe``: a probing or calibration program run on the machine model."""

from __future__ import annotations

from pathlib import Path

import click

from gearmath.cli.common import MACHINE, MEMBER, bars, member_of, of, output
from gearmath.cli.probe import CALIBRATION
from gearmath.errors import InputError, counted


@click.command()
@click.argument("program", type=click.Path(path_type=Path), metavar="PROGRAM.MPF")
@click.option("--set", "gear_set", metavar="SET.toml", help="Gear set of the member that is probed.")
@MEMBER
@MACHINE
@CALIBRATION
@click.option(
    "--errors",
    help="What is wrong with the machine, the clamping and the probe: a file, or a bundled one such as "
    "simulated_shop.toml.",
)
@click.option(
    "--measured",
    type=click.Path(path_type=Path),
    metavar="M.csv",
    help="Flank CSV of the metal that is probed, such as 'gearmath mill' writes.  [default: nominal flanks]",
)
@click.option(
    "--run",
    type=of("number"),
    default=1,
    show_default=True,
    help="Number of the run in the file; each has its own noise.",
)
@output("raw touches, CSV")
def probe(
    program: Path,
    gear_set: str | None,
    member: str | None,
    machine: str,
    calibration: str,
    errors: str | None,
    measured: Path | None,
    run: int,
    target: Path,
) -> None:
    """Run a program that 'gearmath nc probe' or 'gearmath nc calibrate' wrote, and write the raw touches.

    The tip of --calibration is moved as the text says, against the flanks of a member or, in a calibration program,
    against ring and spheres; the touches are those that the program writes on the control. With --measured the flanks
    are as that file says, and what was noise there is metal here: take what 'gearmath mill' wrote; splines between
    the points of its grids, teeth without a grid as the nearest one that has one, turned to their reference point.
    With --errors axes, probe and work err as the file says: [axes], [probe], and the clamping and
    drift of [measuring].

    A program that collides with a nominal member, as 'gearmath nc probe' watches for it, is refused. So is one that
    touches too fast, moves the probe without MEAS where it could meet something, does not stop where the probe is
    deflected or touches nothing, writes something else than it touches, or whose parts R90 and R91 do not choose.
    'gearmath touches' and 'gearmath calibrate' read what is written here.
    """
    from gearmath.front.machines import load_machine, load_probe, load_shop
    from gearmath.front.measured import load_measurement
    from gearmath.front.probing import ProbingProgram
    from gearmath.front.sets import load_set
    from gearmath.machine.control.text import program_text
    from gearmath.machine.judging.stated import stated_member
    from gearmath.machine.measuring.probe_run import touches_artefacts, writes_touches

    text = program_text(program)
    if not writes_touches(text):
        raise InputError(f"{program}: writes no touches: it is no probing or calibration program of gearmath")
    on, known = load_machine(machine), load_probe(calibration)
    shop = load_shop(errors) if errors else None
    one = metal = None
    if touches_artefacts(text):
        if measured is not None:
            raise InputError(f"--measured {measured}: {program} touches ring and spheres, not a member")
    elif gear_set is None:
        raise InputError(f"--set is missing: {program} probes a member")
    else:
        one = member_of(load_set(gear_set), member, stated_member(text))
        metal = None if measured is None else load_measurement(measured, one)
    made = ProbingProgram(one, on, known, str(program), text, shop=shop)
    with bars() as begin:
        made.check(begin)
        made.run(target, metal, shop, run, begin)
    rows = [line for line in target.read_text("utf-8").splitlines() if line[:1].isdigit()]
    click.echo(f"{target}: {counted(len(rows), 'touch')} of run {run}")

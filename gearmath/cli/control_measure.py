"""``gearmath control measure``: a measuring run with the handshake, into the measurement store."""

from __future__ import annotations

import asyncio
from pathlib import Path

import click

from gearmath.cli.common import bar
from gearmath.cli.control_connect import CONNECTION, INSECURE, connector, name_of
from gearmath.cli.runs import store_option
from gearmath.errors import counted


@click.command()
@CONNECTION
@INSECURE
@click.argument("program", type=click.Path(path_type=Path), metavar="PROGRAM.MPF", required=False)
@store_option("The measurement store; made where there is none.")
@click.option("--set", "gear_set", metavar="SET.toml", help="Gear set of the member, to be kept with the run.")
@click.option("--machine", show_default="vertical_5axis.toml", help="Milling machine, to be kept too.")
@click.option("--calibration", show_default="probe.toml", help="Calibrated probe, to be kept too.")
@click.option(
    "--acknowledge",
    is_flag=True,
    help="Acknowledge the touches: this lets the waiting program move on. It must be given.",
)
@click.option("--resume", type=click.IntRange(1), metavar="RUN", help="Go on with a run of the store.")
@click.option(
    "--points",
    metavar="POINTS",
    help="Touch these points only, as a new run: numbers and stretches, 3,17-20. Where they do not follow each other, "
    "the program is started once for each stretch.",
)
@click.option(
    "--again-of",
    type=click.IntRange(1),
    metavar="RUN",
    help="With --points: the run that they belong to. Set, machine and "
    "calibration that are not given are those of this run.",
)
def measure(
    connection: Path,
    insecure: bool,
    program: Path | None,
    store_file: Path,
    gear_set: str | None,
    machine: str | None,
    calibration: str | None,
    acknowledge: bool,
    resume: int | None,
    points: str | None,
    again_of: int | None,
) -> None:
    """Keep every touch of a probing or calibration program in the store, before the program goes on.

    PROGRAM.MPF lies on the control and is selected there, the channel is in reset. This command sets R104, R90 and R91,
    waits until the operator starts the program, and acknowledges each touch when it is on the disk. After a loss of the
    connection it goes on by itself; after a reset, with --resume.
    """
    from gearmath.control import sinumerik
    from gearmath.control.measuring import Measuring, check_ready
    from gearmath.control.run_start import begun, files_of, resumed
    from gearmath.control.store import MeasurementStore

    if not acknowledge:
        raise click.UsageError(
            "--acknowledge is missing: it lets the program that the operator started move on after each touch"
        )
    if (program is None) == (resume is None):
        raise click.UsageError("either PROGRAM.MPF or --resume RUN must be given")
    if again_of is not None and points is None:
        raise click.UsageError("--again-of goes with --points")
    connect = connector(
        connection, insecure, sinumerik.READ_STATE, sinumerik.WRITE_STATE, sinumerik.READ_ALARMS, sinumerik.READ_FILES
    )
    with MeasurementStore.open(store_file) as store:
        if resume is not None:
            run = store.resume_run(resume)
            stretches = resumed(run)
        else:
            assert program is not None
            old = store.run(again_of).start if again_of is not None else None
            with files_of(old, gear_set, machine, calibration) as files:
                start, stretches = begun(name_of(connection, insecure), program, *files, points, again_of)
            asyncio.run(check_ready(connect, start))
            run = store.begin_run(start)
        with bar(len(run.missing()), "touch") as progress:
            asyncio.run(Measuring(connect, run, progress=progress, say=_say).to_the_end(*stretches))
        click.echo(f"{store_file}: run {run.id} is complete: {counted(len(run.start.points), 'touch')}")


def _say(sentence: str) -> None:
    click.echo(sentence, err=True)

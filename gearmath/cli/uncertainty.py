"""``gearmath uncertainty``: how sure the figures of a measured member are."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click

from gearmath.cli.common import (
    FLANK_CSV,
    JSON,
    MACHINE,
    MEMBER,
    REGISTER,
    SET_OPTION,
    bars,
    echo_json,
    of,
    plot,
    save_plot,
    table,
)
from gearmath.cli.probe import CALIBRATION
from gearmath.errors import ComputationError, InputError

SIGMA = click.option(
    "--sigma-um",
    type=of("sigma_um"),
    help="Standard uncertainty of every point, nothing in common, in place of u_um of the file.",
)
_BUNDLED = "measurement.toml"
MODEL = click.option(
    "--model",
    help=f"How well the machine measures: a file, or a bundled one.  [default: u_um of the file, or else {_BUNDLED}]",
)


@click.command(epilog=FLANK_CSV)
@click.argument("measured", type=click.Path(path_type=Path), metavar="M.csv")
@SET_OPTION
@MEMBER
@REGISTER
@click.option("--rotation/--no-rotation", "rotated", default=True, show_default=True, help="As in 'evaluate'.")
@SIGMA
@MODEL
@MACHINE
@CALIBRATION
@click.option("--draws", default=20_000, show_default=True, type=of("draws"), help="Monte Carlo.")
@click.option("--seed", default=0, show_default=True, type=of("seed"), help="Of the draws.")
@click.option("--workers", type=of("workers"), help="Threads, or workers of the cluster.  [default: all]")
@click.option("--cluster", metavar="ADDRESS", help="Scheduler of a dask cluster that draws; needs the extra 'cluster'.")
@click.option("--resume", type=click.Path(path_type=Path, dir_okay=False), help="Results file to keep and continue.")
@plot("every figure in µm with its interval")
@JSON
def uncertainty(
    measured: Path,
    gear_set: str,
    member: str | None,
    registered: bool,
    rotated: bool,
    sigma_um: float | None,
    model: str | None,
    machine: str,
    calibration: str,
    draws: int,
    seed: int,
    workers: int | None,
    cluster: str | None,
    resume: Path | None,
    picture: Path | None,
    as_json: bool,
) -> None:
    """Standard uncertainties and 95 % intervals of everything that a measurement says."""

    from gearmath.front.judged import uncertainty as judged
    from gearmath.front.measured import measurement_of
    from gearmath.front.sets import load_set

    check_one_source(sigma_um, model)
    made = measurement_of(measured, load_set(gear_set), member)
    with bars() as begin, _executor(cluster) as executor:
        found = judged(
            made,
            sigma_um,
            model,
            draws,
            registered=registered,
            rotated=rotated,
            machine=machine,
            probe=calibration,
            seed=seed,
            workers=workers,
            executor=executor,
            resume=resume,
            begin=begin,
        )
    if picture:
        save_plot(found.plot(), picture, as_json)
    values = found.to_dict()
    if as_json:
        echo_json(values)
        return
    first = found.evaluation.found.first
    for remark in first:
        click.echo(remark)
    click.echo(f"standard uncertainties from {found.source}; {draws} draws")
    click.echo(
        table(
            ["flank", "figure", "value", "u", "from", "to", "unit", "method"],
            [
                [
                    row["flank"],
                    row["figure"],
                    *(_number(row[name], row["unit"]) for name in ("value", "u", "from", "to")),
                    row["unit"],
                    row["method"],
                ]
                for row in values["figures"]
            ],
        )
    )
    for line in effects_text(values):
        click.echo(line)
    for remark in found.remarks:
        click.echo(remark)


def _number(value: float, unit: str) -> str:
    """Four decimals for micrometres, six for what the machine is set to."""
    return f"{value:.4f}" if unit.startswith("um") else f"{value:.6f}"


def effects_text(values: dict[str, Any]) -> Iterator[str]:
    """The same for people, a line a flank."""
    for flank, caused in values.get("caused_rms_um", {}).items():
        yield (
            f"{flank} flank: errors of measurement will leave {caused:.3f} um (RMS) after the correction; "
            f"what is expected to remain of this one is known to {values['expected_u_um'][flank]:.3f} um"
        )


def check_one_source(sigma_um: float | None, model: str | None) -> None:
    """Raises InputError where two options say how well the points were measured."""
    if sigma_um is not None and model is not None:
        raise InputError("--sigma-um and --model: only one can say how well the points were measured")


@contextmanager
def _executor(address: str | None) -> Iterator[Executor | None]:
    """The executor of a dask cluster, if one is named."""
    if address is None:
        yield None
        return
    try:
        from distributed import Client
    except ImportError as error:
        raise InputError("--cluster: needs dask: pip install '.[cluster]'") from error
    try:
        client = Client(address, timeout="10s")
    except (OSError, ValueError, TypeError) as error:
        raise ComputationError(f"--cluster = {address}: no scheduler answers: {error}") from error
    with client, client.get_executor() as executor:
        yield executor

"""``gearmath uncertainty``: how sure the figures of a measured member are."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gearmath.cli.common import (
    FLANK_CSV,
    JSON,
    MACHINE,
    MEMBER,
    REGISTER,
    SET_OPTION,
    Number,
    about,
    bar,
    echo_json,
    member_of,
    plot,
    save_plot,
    table,
)
from gearmath.cli.probe import CALIBRATION
from gearmath.errors import ComputationError, InputError

if TYPE_CHECKING:
    from gearmath.quality.evaluation.member import MemberEvaluation
    from gearmath.quality.uncertainty.propagation import Uncertain
    from gearmath.quality.uncertainty.settings import Effect
    from gearmath.specs.bevel_set import Member
    from gearmath.specs.flank_csv import FlankFile

SIGMA = click.option(
    "--sigma-um",
    type=Number(0, 1000, "um", above=True),
    help="Standard uncertainty of every point, nothing in common, in place of u_um of the file.",
)
_BUNDLED = "measurement.toml"
MODEL = click.option(
    "--model",
    help=f"How well the machine measures: a file, or a bundled one.  [default: u_um of the file, or else {_BUNDLED}]",
)
#: Enough for the spread of a maximum to 2 %.
_FEW_DRAWS = 2000


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
@click.option("--draws", default=20_000, show_default=True, type=click.IntRange(1000, 10_000_000), help="Monte Carlo.")
@click.option("--seed", default=0, show_default=True, type=click.IntRange(min=0), help="Of the draws.")
@click.option("--workers", type=click.IntRange(1, 1024), help="Threads, or workers of the cluster.  [default: all]")
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

    from gearmath.bevel.pair import load_pair
    from gearmath.quality.evaluation.member import evaluate_member
    from gearmath.quality.uncertainty.corrected import uncertain_correction
    from gearmath.quality.uncertainty.figures import figures_of
    from gearmath.quality.uncertainty.propagation import uncertain_figures
    from gearmath.quality.uncertainty.source import covariance_of
    from gearmath.specs.flank_csv import read_flank_csv
    from gearmath.specs.toml import find

    check_one_source(sigma_um, model)
    file = read_flank_csv(measured)
    pair = load_pair(find(gear_set))
    from gearmath.front.sets import GearSet

    one = member_of(GearSet(pair), member, file.member)
    member, spec = one.name, one.spec
    with about(measured):
        evaluation = evaluate_member(file, spec, member, registered, rotated=rotated)
        figures = figures_of(file, spec, evaluation)
        covariance, source = covariance_of(file, spec, sigma_um, model, machine, calibration)
    with bar(draws, "draw") as progress, _executor(cluster) as executor:
        found = uncertain_figures(figures, covariance, draws, seed, executor, workers, resume, progress)
    _, settings, effects, remarks = uncertain_correction(spec, file, evaluation, covariance, sigma_um)
    found += settings
    if picture:
        from gearmath.plot import uncertainty_figure

        save_plot(uncertainty_figure(f"{member}, {measured.name}", found), picture, as_json)
    if as_json:
        echo_json(
            {
                "member": member,
                "source": source,
                "draws": draws,
                "seed": seed,
                "figures": shown(found),
                **effects_um(effects),
                "remarks": [*evaluation.first, *remarks],
            }
        )
        return
    for remark in evaluation.first:
        click.echo(remark)
    click.echo(f"standard uncertainties from {source}; {draws} draws")
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
                for row in shown(found)
            ],
        )
    )
    for line in effects_text(effects_um(effects)):
        click.echo(line)
    for remark in remarks:
        click.echo(remark)


def _number(value: float, unit: str) -> str:
    """Four decimals for micrometres, six for what the machine is set to."""
    return f"{value:.4f}" if unit.startswith("um") else f"{value:.6f}"


def effects_um(effects: dict[str, Effect]) -> dict[str, Any]:
    """What errors of measurement do to each flank, for programs."""
    return {
        "caused_rms_um": {flank: effect.caused * 1000 for flank, effect in effects.items()},
        "expected_u_um": {flank: effect.expected * 1000 for flank, effect in effects.items()},
    }


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


def quick_figures(file: FlankFile, member: Member, found: MemberEvaluation, sigma_um: float | None) -> list[Uncertain]:
    """The figures of an evaluation with their uncertainties, from few draws; none where the points have none."""
    from gearmath.quality.uncertainty.corrected import point_covariance

    covariance = point_covariance(file, sigma_um)
    if covariance is None:
        return []
    from gearmath.quality.uncertainty.figures import figures_of
    from gearmath.quality.uncertainty.propagation import uncertain_figures

    return uncertain_figures(figures_of(file, member, found), covariance, _FEW_DRAWS)


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


def shown(found: list[Uncertain]) -> list[dict[str, Any]]:
    """Figures with their uncertainties as people and programs read them."""
    return [
        {
            "flank": one.figure.flank,
            "figure": one.figure.name,
            "value": one.value * one.figure.factor,
            "u": one.uncertainty * one.figure.factor,
            "from": one.interval[0] * one.figure.factor,
            "to": one.interval[1] * one.figure.factor,
            "u_monte_carlo": None if one.drawn is None else one.drawn * one.figure.factor,
            "unit": one.figure.unit,
            "method": one.method,
        }
        for one in found
    ]

"""``gearmath report``: one measurement as a page for people."""

from __future__ import annotations

from pathlib import Path

import click

from gearmath.cli.common import FLANK_CSV, MACHINE, about, bar, output
from gearmath.cli.probe import CALIBRATION
from gearmath.cli.uncertainty import MODEL, SIGMA, covariance_of, uncertain_correction

#: Of the Monte Carlo for maxima and ranges: their intervals to about one part in a hundred.
_DRAWS, _SEED = 20_000, 0


@click.command(epilog=FLANK_CSV)
@click.argument("measured", type=click.Path(path_type=Path), metavar="M.csv")
@click.option("--set", "gear_set", required=True, help="The gear set the member belongs to.")
@click.option(
    "--again", type=click.Path(path_type=Path), metavar="M2.csv",
    help="The member measured again after the correction; shown in place of what is expected.",
)  # fmt: skip
@SIGMA
@MODEL
@MACHINE
@CALIBRATION
@output("HTML; the pictures are written beside it as PNG")
def report(
    measured: Path, gear_set: str, again: Path | None, sigma_um: float | None, model: str | None, machine: str,
    calibration: str, target: Path,
) -> None:  # fmt: skip
    """The report of a measurement: flanks, pitch, figures with uncertainty, settings, and what they cannot mend."""
    from gearmath.bevel.pair import load_pair
    from gearmath.files import write_bytes, write_text
    from gearmath.quality.evaluation import evaluate_member
    from gearmath.quality.figures import figures_of
    from gearmath.quality.uncertainty import uncertain_figures
    from gearmath.report import Measurement, measurement_report
    from gearmath.specs.flank_csv import read_flank_csv
    from gearmath.specs.toml import find

    pair, file = load_pair(find(gear_set)), read_flank_csv(measured)
    member = pair.member(file.member)
    with about(measured):
        found = evaluate_member(file, member, file.member)
        figures = figures_of(file, member, found)
        covariance, source = covariance_of(file, member, sigma_um, model, machine, calibration)
    with bar(_DRAWS, "draw") as progress:
        sure = uncertain_figures(figures, covariance, _DRAWS, _SEED, progress=progress)
    correction, settings, effects, remarks = uncertain_correction(member, file, found, covariance)
    caused = {flank: effect.caused for flank, effect in effects.items()}
    second = None
    if again is not None:
        with about(again):
            second = evaluate_member(read_flank_csv(again), member, file.member)
    made = measurement_report(
        Measurement(
            pair.title, measured.name, member, found, correction, sure, settings, caused, source, second, remarks
        )
    )
    for name, picture in made.pictures.items():
        write_bytes(target.with_name(f"{target.stem}_{name}.png"), picture)
    write_text(target, made.html)
    click.echo(f"{target}: {len(made.pictures)} pictures, also beside it as PNG")

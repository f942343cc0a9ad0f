"""``gearmath evaluate``: pitch and topography of a measured member."""

from __future__ import annotations

from pathlib import Path

import click

from gearmath.cli.common import FLANK_CSV, JSON, REGISTER, SET_OPTION, bar, echo_json, plot, save_plot
from gearmath.cli.uncertainty import SIGMA


@click.command(epilog=FLANK_CSV)
@click.argument("measured", type=click.Path(path_type=Path), metavar="M.csv")
@SET_OPTION
@REGISTER
@click.option(
    "--rotation/--no-rotation",
    "rotated",
    default=True,
    show_default=True,
    help="Take out the rotation of the work that both flanks have in common.",
)
@SIGMA
@plot("topography, pitch and runout")
@JSON
def evaluate(
    measured: Path,
    gear_set: str,
    registered: bool,
    rotated: bool,
    sigma_um: float | None,
    picture: Path | None,
    as_json: bool,
) -> None:
    """Pitch, profile and topography of a measured member; clamping, rotation, runout, tooth thickness, drift and grade.

    What was left out is said first. A maximum or a grade over data with a gap is withheld, with the reason; all other
    figures are given. In JSON it is null, and 'withheld' beside it says why.

    With --sigma-um, or u_um in the file, figures have standard uncertainties; 'gearmath uncertainty' says more of them.
    Grades are by formulas that are not confirmed against ISO 17485: no conformity is claimed.
    """
    from gearmath.front.measured import load_measurement
    from gearmath.front.sets import load_set
    from gearmath.quality.evaluation.member import STAGES

    with bar(STAGES, "stage") as progress:
        made = load_measurement(measured, load_set(gear_set)).evaluate(registered, rotated, progress)
    if picture:
        save_plot(made.plot(), picture, as_json)
    sure = made.uncertainties(sigma_um)
    if as_json:
        echo_json(made.to_dict() | ({"uncertainty": [one.as_dict() for one in sure]} if sure else {}))
        return
    from gearmath.cli.quality_text import evaluation_text

    click.echo(evaluation_text(made.found, sure))

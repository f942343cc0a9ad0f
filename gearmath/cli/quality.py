"""``gearmath evaluate`` and ``gearmath compensate``: from a measured member to corrected settings."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gearmath.cli.common import JSON, MEMBER, SET, about, bar, echo_json, output, table

if TYPE_CHECKING:
    from gearmath.quality.correction import Correction
    from gearmath.specs.bevel_set import Member


@click.command()
@click.argument("measured", type=click.Path(path_type=Path), metavar="M.csv")
@click.option("--set", "gear_set", required=True, help="The gear set the member belongs to.")
@click.option(
    "--register/--no-register", "registered", default=True, show_default=True,
    help="Take out how the work sat (eccentricity, tilt), where the points tell it.",
)  # fmt: skip
@click.option("--plot", "picture", type=click.Path(path_type=Path, dir_okay=False), help="Topography and pitch as PNG.")
@JSON
def evaluate(measured: Path, gear_set: str, registered: bool, picture: Path | None, as_json: bool) -> None:
    """Pitch, profile and topography of a measured member; how it sat, runout, tooth thickness, drift and grade.

    Grades are by formulas that are not confirmed against ISO 17485: no conformity is claimed.
    """
    from gearmath.quality.evaluation import STAGES, evaluate_member
    from gearmath.specs.bevel_set import load_bevel_set
    from gearmath.specs.flank_csv import read_flank_csv
    from gearmath.specs.toml import find

    file = read_flank_csv(measured)
    member = load_bevel_set(find(gear_set)).member(file.member)
    with about(measured), bar(STAGES, "stage") as progress:
        found = evaluate_member(file, member, file.member, registered, progress)
    if picture:
        from gearmath.plot import evaluation_figure, save

        save(evaluation_figure(f"{file.member}, {measured.name}", found), picture)
    if as_json:
        echo_json(found.as_dict())
        return
    from gearmath.cli.quality_text import evaluation_text

    click.echo(evaluation_text(found))


@click.command()
@SET
@MEMBER
@click.option("--measured", required=True, type=click.Path(path_type=Path), help="Measured flank CSV of the member.")
@JSON
@output("corrected set, TOML")
def compensate(gear_set: str, member: str, measured: Path, as_json: bool, target: Path) -> None:
    """Corrected machine settings from a measurement; the nominal settings stay in the file under 'design'."""
    from gearmath.quality.correction import correct
    from gearmath.specs.bevel_set import load_bevel_set, save_corrected
    from gearmath.specs.flank_csv import read_flank_csv
    from gearmath.specs.toml import find

    source = find(gear_set)
    spec = load_bevel_set(source).member(member)
    file = read_flank_csv(measured)
    with about(measured):
        correction = correct(spec, member, file)
    save_corrected(source, target, member, correction.settings, correction.index)
    if as_json:
        echo_json(_correction_values(spec, correction))
        return
    rows = [
        [change["flank"], change["setting"], f"{change['old']:.6f}", f"{change['new']:.6f}", change["unit"]]
        for change in _correction_values(spec, correction)["changes"]
    ]
    click.echo(table(["flank", "setting", "old", "new", "unit"], rows) if rows else "nothing to correct")
    for group, found in correction.identified.items():
        click.echo(
            f"{' and '.join(group)}: RMS {found.rms_before * 1000:.3f} um, expected to remain "
            f"{found.rms_after * 1000:.3f} um ({found.iterations} iterations)"
        )
    click.echo(f"{target}: written" + ("" if correction.index is None else ", with index corrections for every tooth"))


def _correction_values(member: Member, correction: Correction) -> dict[str, Any]:
    from derivations import notation
    from gearmath.quality.correction import setting_changes

    angular = {component.name for component in notation.settings.components if component.unit == "rad"}
    plain = {component.name for component in notation.settings.components if component.unit == "1"}
    changes = [
        {
            "flank": flank,
            "setting": name,
            "old": math.degrees(old) if name in angular else old,
            "new": math.degrees(new) if name in angular else new,
            "unit": "deg" if name in angular else "1" if name in plain else "mm",
        }
        for flank, name, old, new in setting_changes(member, correction)
    ]
    return {
        "changes": changes,
        "expected_max_um": {flank: value * 1000 for flank, value in correction.expected.items()},
        "index_correction_deg": [] if correction.index is None else [math.degrees(v) for v in correction.index],
    }

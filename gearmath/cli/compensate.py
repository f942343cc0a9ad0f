"""``gearmath compensate`` and ``gearmath stock``: corrected settings of a measured member, and how its blank stands."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from gearmath.cli.common import (
    FLANK_CSV,
    JSON,
    MEMBER,
    REGISTER,
    SET,
    SET_OPTION,
    about,
    bars,
    echo_json,
    of,
    output,
    table,
)
from gearmath.errors import InputError, counted

if TYPE_CHECKING:
    from gearmath.bevel.identify.variables import Bounds
    from gearmath.front.member import Member
    from gearmath.front.sets import GearSet
    from gearmath.quality.correction.thickness import By


@click.command(epilog=FLANK_CSV)
@SET
@MEMBER
@click.option("--measured", required=True, type=click.Path(path_type=Path), help="Measured flank CSV of the member.")
@click.option(
    "--settings",
    "names",
    default="few",
    show_default=True,
    help="few (the fewest of the standard ones that lose little), standard, all, or names with commas between them.",
)
@click.option("--higher-order", is_flag=True, help="Correct motions as well: modified roll, helical motion, ...")
@click.option(
    "--objective",
    type=of("objective"),
    default="points",
    show_default=True,
    help="Fit the points, or the coefficients of their cubic surfaces.",
)
@click.option(
    "--from-mate",
    type=click.Path(path_type=Path),
    metavar="CSV",
    help="Correct here what the mate shows there: its measured flank CSV, moved through the ease-off.",
)
@REGISTER
@click.option(
    "--rotation/--no-rotation",
    "rotated",
    default=True,
    show_default=True,
    help="Leave open how the work stood about its axis: what turns both flanks alike is no error of a setting.",
)
@click.option(
    "--bounds",
    type=of("bounds"),
    default="machine",
    show_default=True,
    help="How far settings may change: as a machine may be off, or as a new design may want it.",
)
@click.option("--root-limit", type=of("root_limit"), metavar="MM", help="Most that the root line may move.")
@click.option(
    "--noise",
    "--sigma-um",
    "noise",
    type=of("noise_um"),
    metavar="UM",
    help="Noise of one deviation; else what is left. With it, or with u_um in the file, settings have uncertainties.",
)
@click.option(
    "--thickness", type=of("thickness", um=True), default=0.0, metavar="UM", help="Leave the teeth thicker by so much."
)
@click.option(
    "--thickness-by",
    type=of("thickness_by"),
    default="work_rotation_offset",
    show_default=True,
    help="What makes them thicker.",
)
@click.option("--verbose", is_flag=True, help="All tables: settings old and new, sensitivities, what is alike or weak.")
@JSON
@output("corrected set, TOML")
def compensate(
    gear_set: str,
    member: str | None,
    measured: Path,
    names: str,
    higher_order: bool,
    objective: Literal["points", "surface"],
    from_mate: Path | None,
    registered: bool,
    rotated: bool,
    bounds: Bounds,
    root_limit: float | None,
    noise: float | None,
    thickness: float,
    thickness_by: By,
    verbose: bool,
    as_json: bool,
    target: Path,
) -> None:
    """Corrected machine settings from a measurement; the nominal settings stay in the file under 'design'.

    Points that missed, drift and clamping are taken out first, as 'evaluate' does. Says in two lines what remains of
    what, and which limit binds.
    """
    from gearmath.cli.compensate_text import say_analysis, say_changes, say_result, verdict
    from gearmath.front.measured import load_measurement, measurement_of
    from gearmath.front.sets import load_set
    from gearmath.quality.correction.member import ROOT_LIMIT

    pair = load_set(gear_set)
    made = measurement_of(measured, pair, member)
    one = made.member
    with bars(quiet=as_json) as begin:
        found = made.compensate(
            _free(names),
            registered=registered,
            rotated=rotated,
            objective=objective,
            higher_order=higher_order,
            bounds=bounds,
            root_limit=root_limit or ROOT_LIMIT,
            noise_um=noise,
            mate=None if from_mate is None else load_measurement(from_mate, _mate(pair, one)),
            thickness=thickness / 1000,
            thickness_by=thickness_by,
            begin=begin,
        )
    found.save(target)
    spec, correction, evaluation = one.spec, found.found, found.evaluation.found
    values = found.figures()
    if as_json:
        echo_json(values)
        return
    for remark in evaluation.first:
        click.echo(remark)
    if evaluation.closing.withheld:
        click.echo(f"no index corrections: {evaluation.closing.withheld}")
    for flank, count in correction.left_out.items():
        if count:
            click.echo(f"{flank}: {counted(count, 'point')} of the grid {'was' if count == 1 else 'were'} left out")
    for line in verdict(spec, correction):
        click.echo(line)
    if verbose:
        for group, analysis in correction.analysis.items():
            click.echo("\n".join(say_analysis(" and ".join(group), analysis)))
        click.echo("\n".join([*say_changes(values), *say_result(correction)]))
    for remark in (*evaluation.remarks, *correction.remarks):
        if remark not in evaluation.first:
            click.echo(remark)
    click.echo(f"{target}: written" + ("" if correction.index is None else ", with index corrections for every tooth"))


def _free(names: str) -> str | tuple[str, ...]:
    if names in ("standard", "few", "all"):
        return names
    if not names.strip(" ,"):
        raise InputError("--settings: at least one must be named")
    return tuple(name.strip() for name in names.split(","))


def _mate(pair: GearSet, member: Member) -> Member:
    from gearmath.specs.bevel_set import MEMBERS

    with about(Path("--from-mate")):
        return pair.member(MEMBERS[1 - MEMBERS.index(member.name)])


@click.command(epilog=FLANK_CSV)
@click.argument("measured", type=click.Path(path_type=Path), metavar="M.csv")
@SET_OPTION
@MEMBER
@click.option("--advance", is_flag=True, help="Find an axial shift too, not only the rotation.")
@click.option(
    "--least",
    type=of("least", um=True),
    default=0.0,
    show_default=True,
    metavar="UM",
    help="Stock that must remain everywhere.",
)
@JSON
def stock(measured: Path, gear_set: str, member: str | None, advance: bool, least: float, as_json: bool) -> None:
    """How a precut blank must stand so that both flanks share its stock: probe it, then turn it by this."""
    from gearmath.front.measured import measurement_of
    from gearmath.front.sets import load_set
    from gearmath.quality.evaluation.completeness import missing_points

    made = measurement_of(measured, load_set(gear_set), member)
    found, file, spec = made.share_stock(advance, least / 1000), made.file, made.member.spec
    remarks = list(missing_points(file, spec.teeth))
    if as_json:
        echo_json(
            {
                "turn_deg": math.degrees(found.turn),
                "advance_mm": found.advance,
                "remarks": remarks,
                **{
                    f"{name}_um": {flank: value * 1000 for flank, value in getattr(found, name).items()}
                    for name in ("least", "mean", "most", "least_before")
                },
            }
        )
        return
    click.echo(f"turn the work by {math.degrees(found.turn):+.5f} deg about its axis (A, or work_rotation_offset)")
    if advance:
        click.echo(f"advance it by {found.advance:+.4f} mm along its axis, from toe to heel")
    click.echo(
        table(
            ["flank", "least_um", "mean_um", "most_um", "least_as_clamped_um"],
            [
                [
                    flank,
                    *(
                        f"{values[flank] * 1000:.1f}"
                        for values in (found.least, found.mean, found.most, found.least_before)
                    ),
                ]
                for flank in found.least
            ],
        )
    )
    for remark in remarks:
        click.echo(remark)

"""``gearmath compensate`` and ``gearmath stock``: corrected settings of a measured member, and how its blank stands."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import click

from gearmath.cli.common import (
    FLANK_CSV,
    JSON,
    MEMBER,
    REGISTER,
    SET,
    SET_OPTION,
    Number,
    about,
    bar,
    echo_json,
    member_of,
    output,
    table,
)
from gearmath.errors import ComputationError, InputError, counted

if TYPE_CHECKING:
    from gearmath.bevel.identify.variables import Bounds
    from gearmath.quality.correction.member import MemberCorrection
    from gearmath.quality.correction.thickness import By
    from gearmath.quality.evaluation.member import MemberEvaluation
    from gearmath.specs.bevel_set import BevelSet, Member
    from gearmath.specs.flank_csv import FlankFile


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
    type=click.Choice(["points", "surface"]),
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
    type=click.Choice(["machine", "design"]),
    default="machine",
    show_default=True,
    help="How far settings may change: as a machine may be off, or as a new design may want it.",
)
@click.option("--root-limit", type=Number(0.001, 2, "mm"), metavar="MM", help="Most that the root line may move.")
@click.option(
    "--noise",
    "--sigma-um",
    "noise",
    type=Number(0, 100, "um"),
    metavar="UM",
    help="Noise of one deviation; else what is left. With it, or with u_um in the file, settings have uncertainties.",
)
@click.option(
    "--thickness", type=Number(-500, 500, "um"), default=0.0, metavar="UM", help="Leave the teeth thicker by so much."
)
@click.option(
    "--thickness-by",
    type=click.Choice(["work_rotation_offset", "sliding_base"]),
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
    objective: str,
    from_mate: Path | None,
    registered: bool,
    rotated: bool,
    bounds: Bounds,
    root_limit: float | None,
    noise: float | None,
    thickness: float,
    thickness_by: str,
    verbose: bool,
    as_json: bool,
    target: Path,
) -> None:
    """Corrected machine settings from a measurement; the nominal settings stay in the file under 'design'.

    Points that missed, drift and clamping are taken out first, as 'evaluate' does. Says in two lines what remains of
    what, and which limit binds.
    """
    from gearmath.bevel.pair import check_pair, load_pair
    from gearmath.cli.compensate_text import say_analysis, say_changes, say_result, verdict
    from gearmath.quality.correction import member as correcting
    from gearmath.quality.correction.member import ROOT_LIMIT, correct
    from gearmath.quality.correction.thickness import with_thickness
    from gearmath.quality.correction.values import correction_values
    from gearmath.quality.evaluation.member import STAGES, evaluate_member
    from gearmath.quality.uncertainty.corrected import noise_of_points
    from gearmath.specs.flank_csv import read_flank_csv
    from gearmath.specs.set_text import save_corrected
    from gearmath.specs.toml import find

    source = find(gear_set)
    pair = load_pair(source)
    file = read_flank_csv(measured)
    from gearmath.front.sets import GearSet

    one = member_of(GearSet(pair), member, file.member)
    member, spec = one.name, one.spec
    moved = _from_mate(pair, member, from_mate, measured, registered) if from_mate else None
    with about(measured), bar(STAGES + correcting.STAGES, "stage", as_json) as progress:
        evaluation = evaluate_member(file, spec, member, registered, progress, rotated)
        evaluation.closing.check_topography()
        level = noise_of_points(file, spec, evaluation, noise)
        correction = correct(
            spec,
            member,
            evaluation.file,
            _free(names),
            objective=objective,
            higher_order=higher_order,
            few=names == "few",
            root_limit=root_limit or ROOT_LIMIT,
            noise=level,
            added=moved,
            bounds=bounds,
            progress=progress,
            indexed=evaluation.closing.withheld is None,
        )
    if thickness:
        by = cast("By", thickness_by)
        correction.settings.update(with_thickness(spec, member, correction.settings, thickness / 1000, by))
    save_corrected(
        source,
        target,
        member,
        correction.settings,
        correction.index,
        correction.motions,
        correction.curvatures,
        check=check_pair,
        origin=f"{measured.name} and {source.name}",
    )
    values = correction_values(spec, correction) | {"remarks": [*evaluation.remarks, *correction.remarks]}
    values |= _uncertainty(spec, file, evaluation, correction, noise, root_limit or ROOT_LIMIT)
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


def _uncertainty(
    member: Member,
    file: FlankFile,
    found: MemberEvaluation,
    correction: MemberCorrection,
    noise_um: float | None,
    root_limit: float,
) -> dict[str, Any]:
    """Standard uncertainties of the corrected settings, and what errors of measurement do to the flanks."""
    from gearmath.cli.uncertainty import effects_um
    from gearmath.quality.uncertainty.corrected import point_covariance
    from gearmath.quality.uncertainty.judged import judged_by_measured
    from gearmath.quality.uncertainty.settings import uncertain_settings

    covariance = point_covariance(file, noise_um or None)
    if covariance is None:
        return {}
    judged = covariance.carried(judged_by_measured(file, member, found))
    try:
        settings, effects = uncertain_settings(member, found.member, found.file, correction, judged, root_limit)
    except ComputationError as error:
        return {"no_uncertainties": str(error)}
    known: dict[str, dict[str, float]] = {}
    for one in settings:
        known.setdefault(one.figure.flank, {})[one.figure.name] = one.uncertainty * one.figure.factor
    return {"u": known, **effects_um(effects)}


def _free(names: str) -> tuple[str, ...] | None:
    from gearmath.specs.bevel_set import MACHINE_SETTINGS

    if names in ("standard", "few"):
        return None
    if not names.strip(" ,"):
        raise InputError("--settings: at least one must be named")
    return MACHINE_SETTINGS if names == "all" else tuple(name.strip() for name in names.split(","))


def _from_mate(pair: BevelSet, member: str, path: Path, measured: Path, registered: bool) -> dict[str, Any]:
    from gearmath.quality.correction.ease_off import moved_to_mate
    from gearmath.quality.evaluation.member import evaluate_member
    from gearmath.specs.bevel_set import MEMBERS
    from gearmath.specs.flank_csv import read_flank_csv

    mate = MEMBERS[1 - MEMBERS.index(member)]
    with about(Path("--from-mate")):
        other = pair.member(mate)
    with about(path):
        judged = evaluate_member(read_flank_csv(path), other, mate, registered)
        judged.closing.check_topography()
        return moved_to_mate(pair, mate, judged.file, read_flank_csv(measured))


@click.command(epilog=FLANK_CSV)
@click.argument("measured", type=click.Path(path_type=Path), metavar="M.csv")
@SET_OPTION
@MEMBER
@click.option("--advance", is_flag=True, help="Find an axial shift too, not only the rotation.")
@click.option(
    "--least",
    type=Number(0, 2000, "um"),
    default=0.0,
    show_default=True,
    metavar="UM",
    help="Stock that must remain everywhere.",
)
@JSON
def stock(measured: Path, gear_set: str, member: str | None, advance: bool, least: float, as_json: bool) -> None:
    """How a precut blank must stand so that both flanks share its stock: probe it, then turn it by this."""
    from gearmath.bevel.pair import load_pair
    from gearmath.quality.correction.stock import share_stock
    from gearmath.quality.evaluation.completeness import missing_points
    from gearmath.specs.flank_csv import read_flank_csv
    from gearmath.specs.toml import find

    pair, file = load_pair(find(gear_set)), read_flank_csv(measured)
    from gearmath.front.sets import GearSet

    one = member_of(GearSet(pair), member, file.member)
    member, spec = one.name, one.spec
    with about(measured):
        found = share_stock(spec, member, file, advance, least / 1000)
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

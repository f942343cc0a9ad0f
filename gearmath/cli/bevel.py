"""``gearmath flank`` and ``gearmath tooth``: nominal points and normals, and whole teeth."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gearmath.cli.common import (
    FLANK_CSV,
    JSON,
    MEMBER,
    SET,
    about,
    echo_json,
    grid_of,
    member_of,
    nominal_words,
    of,
    output,
    table,
)
from gearmath.errors import InputError, counted

if TYPE_CHECKING:
    from gearmath.specs.margins import Margins


@click.command(epilog=FLANK_CSV)
@SET
@MEMBER
@click.option("--flank", "side", type=of("flank"), required=True, help="Flank of the member.")
@click.option("--grid", "size", show_default="5x9", help="Rows (root to tip) x columns (toe to heel).")
@click.option("--margin", type=float, show_default="0.1", help="Part of face and depth left out at each end.")
@click.option("--margin-root", "root", type=float, help="Part of the working depth left out at the root.")
@click.option("--margin-tip", "tip", type=float, help="The same at the tip.")
@click.option("--margin-toe", "toe", type=float, help="Part of the face width left out at the toe.")
@click.option("--margin-heel", "heel", type=float, help="The same at the heel.")
@click.option(
    "--places",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Listed places in place of an even grid: z_w and r_w in mm a line, from the pitch apex; row by row where "
    "--grid is given, else one column, for other programs.",
)
@output("flank CSV")
def flank(
    gear_set: str,
    member: str | None,
    side: str,
    size: str | None,
    margin: float | None,
    root: float | None,
    tip: float | None,
    toe: float | None,
    heel: float | None,
    places: Path | None,
    target: Path,
) -> None:
    """Nominal points and outward normals of one flank, as a flank CSV."""
    from gearmath.front.sets import load_set

    given = {"": margin, "-root": root, "-tip": tip, "-toe": toe, "-heel": heel}
    margins, shape = _margins(given), None if size is None else grid_of(size)
    if places is not None:
        for name, value in given.items():
            if value is not None:
                raise InputError(f"--margin{name} {value:g}: listed places (--places) have no margins")
    pair = load_set(gear_set)
    one = member_of(pair, member)
    with about(pair.source if places is None else None):  # what is wrong with places is said of their file
        found = one.flank(side, shape, margins, places)
    found.to_csv(target)
    click.echo(
        f"{target}: {counted(len(found.file), 'point')} of the {one.name}'s {side} flank{nominal_words(one, side)}"
    )


@click.command()
@SET
@MEMBER
@click.option("--columns", type=of("columns"), default=25, show_default=True, help="Columns toe to heel.")
@click.option("--space", is_flag=True, help="Write the surface of one tooth space, not the closed solid of the member.")
@JSON
@output("STL", ".stl")
def tooth(gear_set: str, member: str | None, columns: int, space: bool, as_json: bool, target: Path) -> None:
    """Whole teeth of a member: thickness, top land, undercut; backlash and ease-off of the pair; and an STL."""
    from gearmath.front.sets import load_set

    pair = load_set(gear_set)
    one = member_of(pair, member)
    with about(pair.source):
        made = one.tooth(columns)
        mates, notes = pair.mates(), [made.note, pair.edge_note()]
    triangles, figures = made.to_stl(target, whole_member=not space), made.figures
    if as_json:
        echo_json({"triangles": triangles, **figures} | ({} if mates is None else {"pair": mates}))
        return
    click.echo(table(["figure", "value"], [[name, f"{value:.4f}"] for name, value in figures.items()]))
    click.echo(
        "thicknesses, top lands and root widths are transverse arcs ('gearmath design' and the summary sheet have the"
    )
    click.echo(
        "normal top land): mean_ at the mean point of the pitch cone, reference_ at the middle of the grid of flank"
    )
    click.echo("files, where 'gearmath evaluate' measures")
    if mates is not None:
        _echo_pair(mates)
    for note in filter(None, notes):
        click.echo(f"note: {note}")
    click.echo(f"{target}: {triangles} triangles")


def _echo_pair(mates: dict[str, Any]) -> None:
    """Backlash, and what each pair of mating flanks differs by."""
    for kind in ("normal", "transverse"):
        click.echo(f"pair, {kind} backlash at the mean point: {mates[f'mean_{kind}_backlash_mm']:.4f} mm")
    rows = []
    for flank in ("concave", "convex"):
        one = mates[flank]
        angles = (f"{one[f'{angle}_angle_difference_deg']:+.3f}" for angle in ("pressure", "spiral"))
        rows.append([f"pinion {flank}", *angles, *(f"{value:+.1f}" for value in one["ease_off_um"].values())])
    head = [name.replace("_", " ") for name in mates["concave"]["ease_off_um"]]
    click.echo(table(["mates", "pressure angle deg", "spiral angle deg", *head], rows))
    click.echo(
        "ease-off in um at the edges of the grid, positive where there is a gap; hollow: how far its second order"
    )
    click.echo("falls below the middle")


def _margins(given: dict[str, float | None]) -> Margins:
    """The margins of the options by the end of their names; that without one holds where no other does."""
    from gearmath.specs.margins import Margins

    for name, value in given.items():
        if value is not None and not 0 <= value < 0.5:
            raise InputError(
                f"--margin{name} {value:g}: must be at least 0 and less than 0.5, or the grid leaves the blank"
            )
    common = 0.1 if given[""] is None else given[""]
    sides = (given[f"-{side}"] for side in ("root", "tip", "toe", "heel"))
    return Margins(*(common if value is None else value for value in sides))

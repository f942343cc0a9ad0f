"""``gearmath flank`` and ``gearmath tooth``: nominal points and normals, and whole teeth."""

from __future__ import annotations

import re
from pathlib import Path

import click

from gearmath.cli.common import JSON, MEMBER, SET, about, echo_json, output, table
from gearmath.errors import InputError

_MOST_POINTS = 1_000_000


@click.command()
@SET
@MEMBER
@click.option("--flank", "side", type=click.Choice(["concave", "convex"]), required=True, help="Flank of the member.")
@click.option("--grid", "size", default="5x9", show_default=True, help="Rows (root to tip) x columns (toe to heel).")
@click.option(
    "--margin", type=float, default=0.1, show_default=True, help="Part of face and depth left out at each end."
)
@output("flank CSV")
def flank(gear_set: str, member: str, side: str, size: str, margin: float, target: Path) -> None:
    """Nominal points and outward normals of one flank, as a flank CSV."""
    from gearmath.bevel.flank import blank_grid
    from gearmath.bevel.pair import load_pair
    from gearmath.machine.mill import nominal_flank
    from gearmath.specs.flank_csv import write_flank_csv
    from gearmath.specs.toml import find

    source = find(gear_set)
    spec = load_pair(source).member(member)
    rows, columns = _grid(size)
    if not 0 <= margin < 0.5:
        raise InputError(f"--margin {margin:g}: must be at least 0 and less than 0.5, or the grid leaves the blank")
    grid = blank_grid(spec, rows, columns, margin)
    with about(source):
        points = nominal_flank(spec, member, side, grid, margin)
    write_flank_csv(target, points)
    click.echo(f"{target}: {rows * columns} points of the {member}'s {side} flank")


@click.command()
@SET
@MEMBER
@click.option("--columns", type=click.IntRange(3, 400), default=25, show_default=True, help="Columns toe to heel.")
@click.option("--space", is_flag=True, help="Write the surface of one tooth space, not the closed solid of the member.")
@JSON
@output("STL")
def tooth(gear_set: str, member: str, columns: int, space: bool, as_json: bool, target: Path) -> None:
    """Whole teeth of a member: thickness, top land, undercut; and an STL."""
    from gearmath.bevel.pair import load_pair
    from gearmath.bevel.solid import member_triangles, space_triangles, write_stl
    from gearmath.bevel.tooth import space_figures, tooth_space
    from gearmath.specs.toml import find

    source = find(gear_set)
    spec = load_pair(source).member(member)
    with about(source):
        surface = tooth_space(spec, member, columns)
    triangles = space_triangles(surface) if space else member_triangles(spec, surface)
    write_stl(target, triangles, f"{member} {'space' if space else 'member'}")
    figures = space_figures(spec, surface)
    if as_json:
        echo_json({"triangles": len(triangles), **figures})
        return
    click.echo(table(["figure", "value"], [[name, f"{value:.4f}"] for name, value in figures.items()]))
    click.echo(f"{target}: {len(triangles)} triangles")


def _grid(size: str) -> tuple[int, int]:
    match = re.fullmatch(r"(\d{1,6})x(\d{1,6})", size)
    rows, columns = (int(part) for part in match.groups()) if match else (0, 0)
    if not (rows >= 2 and columns >= 2 and rows * columns <= _MOST_POINTS):
        raise InputError(f"--grid {size}: must read like 5x9, two or more each way, at most {_MOST_POINTS} points")
    return rows, columns

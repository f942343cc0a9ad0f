"""``gearmath blank``: the blank of a pair from its design data."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from gearmath.cli.common import JSON, NewFile, about, table

if TYPE_CHECKING:
    from gearmath.bevel.blank_table import TableRow


@click.command()
@click.argument("data", metavar="FILE.toml")
@JSON
@click.option(
    "--fragment", "as_set", is_flag=True, help="Print the blanks as a gear set has them ([pinion.blank], ...)."
)
@click.option("-o", "--output", "target", type=NewFile(), help="File to write instead (text).")
def blank(data: str, as_json: bool, as_set: bool, target: Path | None) -> None:
    """The blank of a spiral bevel pair from its design data: ISO 23509 method 0, slot widths to AGMA 929.

    FILE.toml is a file of design data, or a bundled one such as blank_iso23509_sample1.toml. Lengths are in mm, angles
    in degrees. Edge radii are for a blade with a flat of 0.2 mm, and for a mutilation of 0.05 mm.
    """
    import json

    from gearmath.errors import InputError
    from gearmath.files import write_text
    from gearmath.front.design import load_blank
    from gearmath.specs.toml import find

    if as_json and as_set:
        raise InputError("--json and --fragment: only one of them may be given")
    path, made = find(data), load_blank(data)
    with about(path):
        if as_set:
            text = made.fragment()
        elif as_json:
            text = json.dumps(made.to_dict(), indent=2) + "\n"
        else:
            text = f"{made.title}\n\n{_text(made.rows)}\n"
    if target is None:
        click.echo(text, nl=False)
        return
    write_text(target, text)
    click.echo(f"{target}: written")


def _text(found: list[TableRow]) -> str:
    """The figures of the pair, then those of pinion and wheel; what changes along the tooth in three lines."""
    from gearmath.bevel.blank_table import PLACES

    pair, members = [], []
    for row in found:
        name = row.name.replace("_", " ")
        if len(row.values) == 1:
            pair.append([name, row.symbol, row.unit, _number(row.values[0])])
        elif isinstance(row.values[0], tuple):
            for place, *values in zip(PLACES, *row.values, strict=True):
                members.append([f"{name}, {place}", row.symbol, row.unit, *map(_number, values)])
        else:
            members.append([name, row.symbol, row.unit, *map(_number, row.values)])
    return "\n\n".join(
        (
            table(["pair", "symbol", "unit", "value"], pair),
            table(["member", "symbol", "unit", "pinion", "wheel"], members),
        )
    )


def _number(value: float) -> str:
    return str(value) if isinstance(value, int) else f"{value:.4f}"

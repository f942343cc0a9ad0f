"""``gearmath rexs``: a gear set out of a REXS file."""

from __future__ import annotations

from pathlib import Path

import click

from gearmath.cli.common import output


@click.command()
@click.argument("file", type=click.Path(path_type=Path), metavar="FILE.rexs")
@output("gear set, TOML")
def rexs(file: Path, target: Path) -> None:
    """The set of the bevel stage in a REXS 2.0.0 file (XML), as 'gearmath export rexs' or another program writes it.

    Lists what of the file a set cannot hold; that is not read. The names: docs/exchange.md.
    """
    from gearmath.front.sets import GearSet

    pair = GearSet.from_rexs(file)
    pair.save(target)
    for text in pair.remarks:
        click.echo(f"left aside: {text}")
    click.echo(f"{target}: {pair.title}")

"""``gearmath hmi``: the operator's page."""

from __future__ import annotations

from pathlib import Path

import click

from gearmath.cli.runs import store_option
from gearmath.errors import InputError


@click.command()
@store_option("The measurement store; sets and programs are written to its folder.")
@click.option("--host", default="127.0.0.1", show_default=True, help="Address to serve on: this computer only.")
@click.option("--port", type=click.IntRange(0, 65535), default=8080, show_default=True, help="0: any that is free.")
def hmi(store_file: Path, host: str, port: int) -> None:
    """The operator's page, in a browser: open the address that it shows. Ctrl-C ends it."""
    try:
        from gearmath.hmi.app import serve
    except ImportError as error:
        raise InputError("nicegui is missing: install it with pip install '.[hmi]'") from error
    from gearmath.hmi.state import Shared

    serve(Shared(store_file), host, port, lambda address: click.echo(f"open {address}"))

"""``gearmath demo``: the main job on bundled data."""

from __future__ import annotations

from pathlib import Path

import click


@click.command()
@click.option(
    "-o", "--output", "folder", type=click.Path(path_type=Path), default=Path("gearmath-demo"), show_default=True,
    help="Folder for programs, measurements, corrected sets, pictures and C.",
)  # fmt: skip
def demo(folder: Path) -> None:
    """The whole closed loop on a bundled real gear set and a bundled hobbing machine."""
    from gearmath.demo import run_demo

    run_demo(folder, click.echo)

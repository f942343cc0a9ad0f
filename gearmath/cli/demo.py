"""``gearmath demo``: the main job on bundled data."""

from __future__ import annotations

from pathlib import Path

import click


@click.command()
@click.option(
    "-o",
    "--output",
    "folder",
    type=click.Path(path_type=Path),
    default=Path("gearmath-demo"),
    show_default=True,
    help="Folder for programs, measurements, corrected sets, pictures and C.",
)
@click.option(
    "--control",
    is_flag=True,
    help="Over a simulated machine control instead: put, cut, measure with a store, correct, cut and measure again.",
)
def demo(folder: Path, control: bool) -> None:
    """The whole closed loop on a bundled real gear set and a bundled hobbing machine."""
    if control:
        from gearmath.cli.control_connect import quiet

        quiet()
        from gearmath.control_demo import run_control_demo

        run_control_demo(folder, click.echo)
        return
    from gearmath.demo import run_demo

    run_demo(folder, click.echo)

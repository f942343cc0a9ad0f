"""``gearmath nc time``: a program as the control moves the axes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from gearmath.cli.common import JSON, MACHINE, about, bar, echo_json, plot, save_plot, table
from gearmath.cli.probe import CALIBRATION

if TYPE_CHECKING:
    from gearmath.machine.judging.trajectory import Trajectory
    from gearmath.specs.milling_machine import MillingMachine


@click.command("time")
@click.argument("program", type=click.Path(path_type=Path), metavar="PROGRAM.MPF")
@MACHINE
@CALIBRATION
@JSON
@plot("the speed of the first pass, as asked and as the axes can")
def program_time(program: Path, machine: str, calibration: str, as_json: bool, picture: Path | None) -> None:
    """How long a program takes: a model of the control with the limits of the machine file.

    Speed, acceleration and jerk of every axis bound the motion, the tolerance of the path mode the speed at corners.
    Programs for LinuxCNC, and others where [control] kind is linuxcnc, are blended as LinuxCNC does it. Dwells take
    their time, tool changes none. In a program that probes every touch of a member counts to the end of its way, the
    longest that it can be, those of ring and spheres to where they are; no host is waited for. --calibration, the
    probe, is for such programs alone.
    """
    from gearmath.front.machines import load_machine, load_probe
    from gearmath.front.timing import timed
    from gearmath.machine.control.text import program_text
    from gearmath.machine.measuring.probe_run import writes_touches

    on, text = load_machine(machine), program_text(program)
    with about(program), bar(1, "program", as_json) as progress:
        found = timed(text, str(program), on, load_probe(calibration) if writes_touches(text) else None)
        progress(1)
    if as_json:
        echo_json(found.to_dict())
    else:
        click.echo(_table(program, on.spec, found.trajectory))
        if found.touches:
            click.echo(f"touches counted to {found.touches}; no host is waited for")
    if picture is not None:
        save_plot(found.plot(), picture, as_json)


def _table(program: Path, machine: MillingMachine, found: Trajectory) -> str:
    share = f"{100 * found.slowest_speed_share:.0f} %"
    lines = [
        f"{program}: {found.blocks} feed blocks, {found.polynomial_blocks} of them POLY, on {machine.name}",
        table(
            ["", "s"],
            [
                ["feed blocks as programmed", f"{found.asked_seconds:.1f}"],
                ["feed blocks as moved", f"{found.feed_seconds:.1f}"],
                ["rapid motion", f"{found.rapid_seconds:.1f}"],
                ["dwells", f"{found.dwell_seconds:.1f}"],
                ["together", f"{found.total_seconds:.1f}"],
            ],
        ),
        f"corners: {found.slow_corners} of {found.corners} at less than half of the programmed speed"
        + (f", the slowest at {share} of it in line {found.slowest_line}" if found.slow_corners else ""),
        f"path left by up to {found.contour_error_um:.3f} um in X Y Z and {found.orientation_error_arcsec:.3f} arcsec "
        "in A B" + (f", most in line {found.worst_line}" if found.path_error_um > 0.0 else ""),
    ]
    return "\n".join(lines)

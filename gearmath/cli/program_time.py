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
    from gearmath.machine.control.executor import execute
    from gearmath.machine.control.state import Setup
    from gearmath.machine.control.text import is_for_linuxcnc, program_text
    from gearmath.machine.judging.trajectory import trajectory
    from gearmath.machine.measuring.probe_run import probing_path, touches_artefacts, writes_touches
    from gearmath.specs.calibration import load_calibration
    from gearmath.specs.milling_machine import load_milling_machine
    from gearmath.specs.toml import find

    milling_machine, text = load_milling_machine(find(machine)), program_text(program)
    if is_for_linuxcnc(text):
        control = milling_machine.control.model_copy(update={"kind": "linuxcnc"})
        milling_machine = milling_machine.model_copy(update={"control": control})
    with about(program), bar(1, "program", as_json) as progress:
        if probes := writes_touches(text):
            known = load_calibration(find(calibration))
            path = probing_path(text, str(program), milling_machine, known)
        else:
            path = execute(text, str(program), Setup.of(milling_machine))
        found = trajectory(path, milling_machine)
        progress(1)
    touches = None if not probes else "where they are met" if touches_artefacts(text) else "the end of their ways"
    if as_json:
        kind = milling_machine.control.kind or "sinumerik"
        said = {
            "program": program.name,
            "machine": milling_machine.name,
            "control": kind,
            "touches_counted_to": touches,
        }
        echo_json(said | found.as_dict())
    else:
        click.echo(_table(program, milling_machine, found))
        if touches:
            click.echo(f"touches counted to {touches}; no host is waited for")
    if picture is not None:
        from gearmath.plot.trajectory import speed_figure

        save_plot(speed_figure(path, found, milling_machine), picture, as_json)


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

"""The touch probe: ``gearmath nc probe``, ``gearmath nc calibrate``, ``gearmath touches``, ``gearmath calibrate``."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from gearmath.cli.common import (
    CALIBRATION_CSV,
    FLANK_CSV,
    MACHINE,
    MEMBER,
    SET,
    SET_OPTION,
    SHEET,
    TOUCH_CSV,
    bars,
    member_of,
    of,
    output,
)
from gearmath.cli.dialect import TARGET, dialect_of, write_configuration
from gearmath.errors import InputError, counted

if TYPE_CHECKING:
    from gearmath.front.probing import ProbingProgram
    from gearmath.machine.judging.dialects import ControlDialect
    from gearmath.quality.calibration.axes import AxisCalibration
    from gearmath.quality.calibration.tip import Fit, Tip
    from gearmath.specs.calibration import Calibration
    from gearmath.specs.milling_machine import MillingMachine

_PROGRAM = ".MPF, or .ngc for LinuxCNC; its name becomes the program name"
CALIBRATION = click.option(
    "--calibration", default="probe.toml", show_default=True, help="Calibrated probe: a file, or a bundled one."
)
_RUN = click.option(
    "--run", type=int, help="Run of the touch file to take, whole or not.  [default: the last one, which must be whole]"
)
_RAW = click.argument("raw", type=click.Path(path_type=Path), metavar="RAW.csv")


@click.command()
@SET
@MEMBER
@MACHINE
@CALIBRATION
@click.option(
    "--topography", default="0", show_default=True, help="Teeth whose whole flanks are probed: all, none, or numbers."
)
@click.option("--pitch/--no-pitch", default=True, show_default=True, help="Probe the reference point of every tooth.")
@click.option(
    "--registration/--no-registration",
    default=True,
    show_default=True,
    help="With the pitch, probe the corners on eight teeth around: they determine the clamping.",
)
@click.option("--repeat", type=of("repeat"), default=1, show_default=True, help="Touches of every point.")
@click.option("--errors", help="Simulated machine whose [fixture] and spindle the probe must clear.")
@TARGET
@SHEET
@output(_PROGRAM)
def probe(
    gear_set: str,
    member: str | None,
    machine: str,
    calibration: str,
    topography: str,
    pitch: bool,
    registration: bool,
    repeat: int,
    errors: str | None,
    control: str | None,
    configuration: bool,
    sheet: Path | None,
    target: Path,
) -> None:
    """Write the probing program of a member; 'gearmath probe' runs it on the machine model.

    Before it is written it is run: tip, stylus and spindle must stay clear of teeth, hub, shank and fixture.
    """
    from gearmath.front.machines import load_machine, load_probe, load_shop
    from gearmath.front.probing import probing
    from gearmath.front.sets import load_set

    one = member_of(load_set(gear_set), member)
    teeth = _teeth(topography, one.teeth)
    on, known = load_machine(machine), load_probe(calibration)
    dialect = dialect_of(on.spec, control, target if configuration else None)
    shop = load_shop(errors) if errors else None
    what = teeth, pitch, registration, repeat
    with bars() as begin:
        made = probing(one, on, known, target.stem, *what, shop, dialect.name, target, begin)
    _write(made, target, dialect if configuration else None, sheet)


def _write(made: ProbingProgram, target: Path, configured: ControlDialect | None, sheet: Path | None) -> None:
    """Write a program of the probe with what belongs to it, and say so; ``configured`` wants examples beside it."""
    from gearmath.files import write_text

    page = None if sheet is None else made.sheet(target.name)
    clear = f"; {made.clearance}" if made.clearance else ""
    click.echo(f"{made.save(target)}: {counted(made.touches, 'touch')}, {counted(made.blocks, 'block')}{clear}")
    if configured is not None:
        machine = made.machine.spec
        write_configuration(target, configured, machine, probe_in_table(machine, made.probe))
    if sheet is not None and page is not None:
        write_text(sheet, page)
        click.echo(f"{sheet}: set-up sheet, prints on A4")


def probe_in_table(machine: MillingMachine, calibration: Calibration) -> dict[str, tuple[int, float]]:
    """Number and length of the probe in the tool table of LinuxCNC, by its name."""
    from gearmath.machine.writing.linuxcnc.probe_words import probe_number
    from gearmath.specs.control import PROBE

    length = calibration.length if machine.z_reference == "tip" else 0.0
    return {PROBE: (probe_number(machine), length)}


@click.command("calibrate")
@MACHINE
@CALIBRATION
@click.option(
    "--cycle",
    type=of("cycle"),
    default="tip",
    show_default=True,
    help="Ring and sphere on the table for the tip, or the sphere on the work side for the rotary axes.",
)
@TARGET
@SHEET
@output(_PROGRAM)
def nc_calibrate(
    machine: str,
    calibration: str,
    cycle: Literal["tip", "axes"],
    control: str | None,
    configuration: bool,
    sheet: Path | None,
    target: Path,
) -> None:
    """Write the program that calibrates the probe on ring and sphere, or the rotary axes on a sphere on the work side.

    'gearmath probe' runs it on the machine model, 'gearmath calibrate' reads its touches.
    """
    from gearmath.front.machines import load_machine, load_probe
    from gearmath.front.probing import calibrating
    from gearmath.machine.writing.words import check_target
    from gearmath.specs.toml import find

    on, known = load_machine(machine), load_probe(calibration)
    dialect = dialect_of(on.spec, control, target if configuration else None)
    check_target(target)
    with bars() as begin:
        made = calibrating(on, known, cycle, target.stem, dialect.name, target, find(calibration), begin)
    _write(made, target, dialect if configuration else None, sheet)


@click.command(epilog=f"{TOUCH_CSV} {FLANK_CSV}")
@_RAW
@SET_OPTION
@MACHINE
@CALIBRATION
@_RUN
@output("measured flank CSV")
def touches(raw: Path, gear_set: str, machine: str, calibration: str, run: int | None, target: Path) -> None:
    """Raw touches of a probe to measured points: corrected contact points and their deviations."""
    import numpy as np

    from gearmath.bevel.pair import load_pair
    from gearmath.quality.evaluation.completeness import taken_for
    from gearmath.quality.evaluation.measured_run import measured_run
    from gearmath.specs.calibration import load_calibration
    from gearmath.specs.flank_csv import write_flank_csv
    from gearmath.specs.milling_machine import load_milling_machine
    from gearmath.specs.toml import find

    pair = load_pair(find(gear_set))
    made = measured_run(raw, pair, load_milling_machine(find(machine)), load_calibration(find(calibration)), run)
    found, measured, missing, missed = made.touches, made.file, made.missing, made.missed
    write_flank_csv(target, measured)
    if made.doubt:
        click.echo(f"{raw}: {made.doubt}", err=True)
    for one in missed:
        click.echo(one)
    known = measured.deviation[np.isfinite(measured.deviation)]
    largest = f"{float(abs(known).max()) * 1000:.3f} um" + (" of those that were met" if missed else "")
    click.echo(f"{target}: {counted(len(measured), 'point')} of run {found.run}, largest deviation {largest}")
    if found.joined:
        click.echo(f"run {found.run}: {found.joined}")
    for one in missing:
        click.echo(f"run {found.run} is not whole: {one}")
    if found.planned is None and not missing:
        click.echo(f"run {found.run}: {taken_for(found, made.grid.shape)}", err=True)


@click.command(epilog=CALIBRATION_CSV)
@_RAW
@CALIBRATION
@MACHINE
@click.option("--lobing", is_flag=True, help="Also find the lobes of the pre-travel, from the touches on the sphere.")
@_RUN
@output("calibration, TOML; a machine file for touches of --cycle axes")
def calibrate(raw: Path, calibration: str, machine: str, lobing: bool, run: int | None, target: Path) -> None:
    """The tip of the probe from its touches on the sphere or, where there are none, in the ring; or the rotary axes.

    Touches of ``nc calibrate --cycle axes`` make a new machine file of that of --machine.
    """
    from gearmath.quality.calibration.axes import AxisCalibration
    from gearmath.quality.evaluation.calibrated_run import calibrated_run
    from gearmath.specs.calibration import load_calibration, save_calibration
    from gearmath.specs.milling_machine import load_milling_machine, save_axes
    from gearmath.specs.toml import find

    source, of_axes = find(calibration), find(machine)
    known = load_calibration(source)
    made = calibrated_run(raw, load_milling_machine(of_axes), known, run, lobing, str(source))
    found = made.found
    if isinstance(found, AxisCalibration):
        save_axes(of_axes, target, found.pivot_offset, found.gauge_line_height)
        lines = axis_lines(found, known)
    else:
        save_calibration(source, target, found.radius, found.offset, found.lobes)
        lines = tip_lines(found)
    if made.touches.joined:
        click.echo(f"run {made.touches.run}: {made.touches.joined}")
    for line in lines:
        click.echo(line)
    for one in made.missing:
        click.echo(f"run {made.touches.run} is not whole: {one}")
    click.echo(f"{target}: written")


def axis_lines(axes: AxisCalibration, probe: Calibration) -> Iterator[str]:
    """What the machine file gets, what the zero offsets of the control should get, and what the touches do not fit."""
    u = axes.fit.uncertainty
    for name, value, unsure in zip("xyz", axes.pivot_offset, u[:3], strict=True):
        yield f"pivot offset {name} {value:.5f} mm, u {_um(unsure)}"
    yield f"gauge line height {axes.gauge_line_height:.5f} mm, u {_um(u[4])}"
    yield f"axis B lies at X {axes.x_zero:.5f} mm, u {_um(u[3])}: the zero offset of X should have it"
    yield f"B stands {math.degrees(axes.b_zero):.6f} degrees beyond its reading, u {math.degrees(u[5]):.6f}"
    if probe.work_sphere is not None:
        ahead = math.remainder(probe.work_sphere.rad("azimuth") - axes.azimuth, 2 * math.pi)
        sure = math.degrees(axes.azimuth_uncertainty)
        yield f"A stands {math.degrees(ahead):.6f} degrees beyond its reading if azimuth is exact, u {sure:.6f}"
    yield f"{counted(len(axes.fit.residuals), 'touch')}: {_residual_words(axes.fit)}"


def _residual_words(fit: Fit) -> str:
    return f"noise {_um(fit.noise)}, largest residual {float(abs(fit.residuals).max()) * 1000:.3f} um"


def tip_lines(tip: Tip) -> Iterator[str]:
    """Every value with its standard uncertainty, then what the touches do not fit."""
    yield f"tip radius {tip.radius:.5f} mm, u {_um(tip.radius_uncertainty)}"
    for axis, value, u in zip("XYZ", tip.offset, tip.offset_uncertainty, strict=True):
        yield f"offset {axis} {value:.5f} mm, " + ("kept" if math.isnan(u) and axis == "Z" else f"u {_um(u)}")
    if tip.lobes[0] > 0.0:
        known = "kept" if math.isnan(tip.amplitude_uncertainty) else f"u {_um(tip.amplitude_uncertainty)}"
        yield f"lobes {tip.lobes[0] * 1000:.3f} um at {math.degrees(tip.lobes[1]):.2f} degrees, {known}"
    yield f"{counted(len(tip.fit.residuals), 'touch')}: {_residual_words(tip.fit)}"


def _um(value: float) -> str:
    return "not known" if math.isnan(value) else f"{value * 1000:.3f} um"


def _teeth(text: str, teeth: int) -> list[int]:
    if text in ("all", "none"):
        return list(range(teeth)) if text == "all" else []
    numbers = [int(part) if part.strip().isdecimal() else -1 for part in text.split(",")]
    if not all(0 <= number < teeth for number in numbers):
        raise InputError(f"--topography {text}: must be all, none, or numbers from 0 to {teeth - 1} with commas")
    return list(dict.fromkeys(numbers))

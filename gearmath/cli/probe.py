"""The touch probe: ``gearmath nc probe``, ``gearmath nc calibrate``, ``gearmath touches``, ``gearmath calibrate``."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gearmath.cli.common import MACHINE, MEMBER, SET, about, output
from gearmath.errors import InputError

if TYPE_CHECKING:
    from gearmath.quality.calibration import Tip

_PROGRAM = ".MPF; its name becomes the program name"
CALIBRATION = click.option(
    "--calibration", default="probe.toml", show_default=True, help="Calibrated probe: a file, or a bundled one."
)
_RUN = click.option("--run", type=int, help="Run of the touch file to take.  [default: the last one]")
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
@click.option("--repeat", type=click.IntRange(1, 100), default=1, show_default=True, help="Touches of every point.")
@output(_PROGRAM)
def probe(
    gear_set: str, member: str, machine: str, calibration: str, topography: str, pitch: bool, repeat: int, target: Path
) -> None:  # fmt: skip
    """The probing program of a member."""
    from gearmath.files import write_text
    from gearmath.machine.probing import probing_program
    from gearmath.specs.bevel_set import load_bevel_set
    from gearmath.specs.calibration import load_calibration
    from gearmath.specs.milling_machine import load_milling_machine
    from gearmath.specs.toml import find

    bevel_set = load_bevel_set(find(gear_set))
    teeth = _teeth(topography, bevel_set.member(member).teeth)
    text = probing_program(
        bevel_set, member, load_milling_machine(find(machine)), load_calibration(find(calibration)), target.stem,
        teeth, pitch, repeat,
    )  # fmt: skip
    write_text(target, text)
    click.echo(f"{target}: {repeat * text.count('R205=$')} touches, {text.count(chr(10))} blocks")


@click.command("calibrate")
@MACHINE
@CALIBRATION
@output(_PROGRAM)
def nc_calibrate(machine: str, calibration: str, target: Path) -> None:
    """The program that calibrates the probe on ring and sphere."""
    from gearmath.files import write_text
    from gearmath.machine.calibrating import calibration_program
    from gearmath.specs.calibration import load_calibration
    from gearmath.specs.milling_machine import load_milling_machine
    from gearmath.specs.toml import find

    source = find(calibration)
    with about(source):
        text = calibration_program(load_milling_machine(find(machine)), load_calibration(source), target.stem)
    write_text(target, text)
    click.echo(f"{target}: {text.count(chr(10))} blocks")


@click.command()
@_RAW
@click.option("--set", "gear_set", required=True, help="The gear set the member belongs to.")
@MACHINE
@CALIBRATION
@_RUN
@output("measured flank CSV")
def touches(raw: Path, gear_set: str, machine: str, calibration: str, run: int | None, target: Path) -> None:
    """Raw touches of a probe to measured points: corrected contact points and their deviations."""
    from gearmath.quality.touches import measured_member
    from gearmath.specs.bevel_set import load_bevel_set
    from gearmath.specs.calibration import load_calibration
    from gearmath.specs.flank_csv import write_flank_csv
    from gearmath.specs.milling_machine import load_milling_machine
    from gearmath.specs.toml import find
    from gearmath.specs.touch_csv import read_touch_csv

    found = read_touch_csv(raw, run)
    member = load_bevel_set(find(gear_set)).member(found.member)
    with about(raw):
        measured = measured_member(
            found, member, found.member, load_milling_machine(find(machine)), load_calibration(find(calibration))
        )
    write_flank_csv(target, measured)
    worst = float(abs(measured.deviation).max()) * 1000
    click.echo(f"{target}: {len(measured)} points of run {found.run}, largest deviation {worst:.3f} um")


@click.command()
@_RAW
@CALIBRATION
@click.option("--lobing", is_flag=True, help="Also find the lobes of the pre-travel, from the touches on the sphere.")
@_RUN
@output("calibration, TOML")
def calibrate(raw: Path, calibration: str, lobing: bool, run: int | None, target: Path) -> None:
    """The tip of the probe from its touches on the sphere or, where there are none, in the ring."""
    from gearmath.quality.calibration import calibrate_on_ring, calibrate_on_sphere
    from gearmath.specs.calibration import load_calibration, save_calibration
    from gearmath.specs.toml import find
    from gearmath.specs.touch_csv import SPHERE, read_calibration_csv

    source = find(calibration)
    before, found = load_calibration(source), read_calibration_csv(raw, run)
    with about(raw):
        if before.sphere is not None and (found.target == SPHERE).any():
            tip = calibrate_on_sphere(found, before.sphere, before, lobing)
        elif lobing:
            raise InputError("--lobing needs touches on the sphere; there are none")
        elif before.ring is not None:
            tip = calibrate_on_ring(found, before.ring, before)
        else:
            raise InputError(f"{source} has neither the ring nor the sphere that was touched")
    save_calibration(source, target, tip.radius, tip.offset, tip.lobes)
    for line in _tip_lines(tip):
        click.echo(line)
    click.echo(f"{target}: written")


def _tip_lines(tip: Tip) -> Iterator[str]:
    """Every value with its standard uncertainty, then what the touches do not fit."""
    yield f"tip radius {tip.radius:.5f} mm, u {_um(tip.radius_uncertainty)}"
    for axis, value, u in zip("XYZ", tip.offset, tip.offset_uncertainty, strict=True):
        yield f"offset {axis} {value:.5f} mm, " + ("kept" if math.isnan(u) and axis == "Z" else f"u {_um(u)}")
    if tip.lobes[0] > 0.0:
        yield f"lobes {tip.lobes[0] * 1000:.3f} um, at {math.degrees(tip.lobes[1]):.2f} degrees"
    yield (
        f"{len(tip.fit.residuals)} touches: noise {_um(tip.fit.noise)}, largest residual {tip.residual * 1000:.3f} um"
    )


def _um(value: float) -> str:
    return "not known" if math.isnan(value) else f"{value * 1000:.3f} um"


def _teeth(text: str, teeth: int) -> list[int]:
    if text in ("all", "none"):
        return list(range(teeth)) if text == "all" else []
    numbers = [int(part) if part.strip().isdecimal() else -1 for part in text.split(",")]
    if not all(0 <= number < teeth for number in numbers):
        raise InputError(f"--topography {text}: must be all, none, or numbers from 0 to {teeth - 1} with commas")
    return list(dict.fromkeys(numbers))

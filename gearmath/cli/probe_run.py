"""``gearmath probe``: a probing or calibration program run on the machine model."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from gearmath.cli.common import MACHINE, MEMBER, about, bar, member_of, output
from gearmath.cli.probe import CALIBRATION
from gearmath.errors import InputError, counted

if TYPE_CHECKING:
    from gearmath.machine.control.state import Probe
    from gearmath.machine.measuring.probe import ProbeMachine
    from gearmath.specs.bevel_set import Member
    from gearmath.specs.calibration import Calibration
    from gearmath.specs.milling_machine import MillingMachine
    from gearmath.specs.simulated_machine import SimulatedMachine


@click.command()
@click.argument("program", type=click.Path(path_type=Path), metavar="PROGRAM.MPF")
@click.option("--set", "gear_set", metavar="SET.toml", help="Gear set of the member that is probed.")
@MEMBER
@MACHINE
@CALIBRATION
@click.option(
    "--errors",
    help="What is wrong with the machine, the clamping and the probe: a file, or a bundled one such as "
    "simulated_shop.toml.",
)
@click.option(
    "--measured",
    type=click.Path(path_type=Path),
    metavar="M.csv",
    help="Flank CSV of the metal that is probed, such as 'gearmath mill' writes.  [default: nominal flanks]",
)
@click.option(
    "--run",
    type=click.IntRange(1, 99_999),
    default=1,
    show_default=True,
    help="Number of the run in the file; each has its own noise.",
)
@output("raw touches, CSV")
def probe(
    program: Path,
    gear_set: str | None,
    member: str | None,
    machine: str,
    calibration: str,
    errors: str | None,
    measured: Path | None,
    run: int,
    target: Path,
) -> None:
    """Run a program that 'gearmath nc probe' or 'gearmath nc calibrate' wrote, and write the raw touches.

    The tip of --calibration is moved as the text says, against the flanks of a member or, in a calibration program,
    against ring and spheres; the touches are those that the program writes on the control. With --measured the flanks
    are as that file says, and what was noise there is metal here: take what 'gearmath mill' wrote; splines between
    the points of its grids, teeth without a grid as the nearest one that has one, turned to their reference point.
    With --errors axes, probe and work err as the file says: [axes], [probe], and the clamping and
    drift of [measuring].

    A program that collides with a nominal member, as 'gearmath nc probe' watches for it, is refused. So is one that
    touches too fast, moves the probe without MEAS where it could meet something, does not stop where the probe is
    deflected or touches nothing, writes something else than it touches, or whose parts R90 and R91 do not choose.
    'gearmath touches' and 'gearmath calibrate' read what is written here.
    """
    from gearmath.bevel.pair import load_pair
    from gearmath.files import write_text
    from gearmath.machine.control.state import Setup
    from gearmath.machine.control.text import program_text
    from gearmath.machine.judging.stated import stated_member
    from gearmath.machine.measuring.artefacts import Artefacts
    from gearmath.machine.measuring.checked import refuse_faults
    from gearmath.machine.measuring.judge import judge_calibration, judge_probing
    from gearmath.machine.measuring.probe_run import run_touches, touch_count, touches_artefacts, writes_touches
    from gearmath.specs.calibration import load_calibration
    from gearmath.specs.milling_machine import load_milling_machine
    from gearmath.specs.simulated_machine import load_simulated_machine
    from gearmath.specs.toml import find

    text = program_text(program)
    if not writes_touches(text):
        raise InputError(f"{program}: writes no touches: it is no probing or calibration program of gearmath")
    milling_machine, known = load_milling_machine(find(machine)), load_calibration(find(calibration))
    shop = load_simulated_machine(find(errors)) if errors else None
    setup = Setup.of(milling_machine, known.length)
    there: Probe
    count: int | None
    if touches_artefacts(text):
        if measured is not None:
            raise InputError(f"--measured {measured}: {program} touches ring and spheres, not a member")
        count, there = None, Artefacts(milling_machine, known)
        with bar(text.count("MEAS=1"), "block") as progress:
            faults = judge_calibration(text, str(program), milling_machine, known, progress)
        refuse_faults(faults, str(program))
    else:
        if gear_set is None:
            raise InputError(f"--set is missing: {program} probes a member")
        pair = load_pair(find(gear_set))
        from gearmath.front.sets import GearSet

        one = member_of(GearSet(pair), member, stated_member(text))
        name, spec = one.name, one.spec
        there = at_member = _member_machine(spec, name, measured, milling_machine, known, shop)
        count = touch_count(text, str(program), setup)
        if not count:
            raise InputError(f"{program}: touches nothing of the member: no touch is measured before its end")
        _check_clear(text, program, at_member, milling_machine, shop, 3 * count + text.count("\n"))
        with bar(text.count("MEAS=1"), "block") as progress:
            faults = judge_probing(text, str(program), spec, name, milling_machine, known, progress)
        refuse_faults(faults, str(program))
    blocks = 3 * count if count is not None else text.count("MEAS=1")
    with bar(blocks, "block") as progress:
        raw = run_touches(text, str(program), there, shop, count, run, progress, setup)
    write_text(target, raw)
    rows = [line for line in raw.splitlines() if line[:1].isdigit()]
    click.echo(f"{target}: {counted(len(rows), 'touch')} of run {run}")


def _check_clear(
    text: str, program: Path, there: ProbeMachine, machine: MillingMachine, shop: SimulatedMachine | None, steps: int
) -> None:
    """Raise InputError where the program moves the probe into a nominal member, or touches what it does not have."""
    from gearmath.machine.bodies.profiles import obstacles
    from gearmath.machine.measuring.checked import clearances
    from gearmath.machine.measuring.collision_check import approaches

    head, fixture = obstacles(machine, shop)
    with bar(steps, "step") as progress:
        found = approaches(
            text,
            str(program),
            there.member,
            there.name,
            machine,
            there.calibration,
            fixture,
            head.spindle_radius,
            progress,
        )
    clearances(found, str(program), "it is not run")


def _member_machine(
    spec: Member,
    member: str,
    measured: Path | None,
    machine: MillingMachine,
    calibration: Calibration,
    shop: SimulatedMachine | None,
) -> ProbeMachine:
    """The machine with the member on it, nominal or as ``measured`` says, clamped as the shop does."""
    from gearmath.machine.measuring.probe import ProbeMachine
    from gearmath.machine.milling.milled_surface import MilledSurface
    from gearmath.quality.evaluation.file_checks import check_belongs, check_points
    from gearmath.quality.evaluation.nominal import nominal_rows
    from gearmath.specs.flank_csv import read_flank_csv

    seat = shop.measuring_clamp(member) if shop else None
    if measured is None:
        return ProbeMachine(spec, member, machine, calibration, seat=seat)
    file = read_flank_csv(measured)
    with about(measured):
        check_belongs(spec, member, file)
        check_points(file, nominal_rows(file, spec, member), spec, member)
        metal = MilledSurface(file, spec, member, str(measured))
    return ProbeMachine(spec, member, machine, calibration, metal, metal.lowest, seat)

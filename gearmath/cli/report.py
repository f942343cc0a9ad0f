"""``gearmath report``: the inspection sheet of a member, or of both."""

from __future__ import annotations

from pathlib import Path

import click

from gearmath.cli.common import FLANK_CSV, HTML, MACHINE, SET_OPTION, bars, output
from gearmath.cli.probe import CALIBRATION
from gearmath.cli.uncertainty import MODEL, SIGMA, check_one_source
from gearmath.errors import InputError


@click.command(epilog=FLANK_CSV)
@click.argument("measured", type=click.Path(path_type=Path), metavar="M.csv")
@SET_OPTION
@click.option(
    "--mate", type=click.Path(path_type=Path), metavar="M2.csv", help="The mate as measured; both stand on one sheet."
)
@click.option(
    "--again",
    type=click.Path(path_type=Path),
    multiple=True,
    metavar="M3.csv",
    help="A member measured again after the correction, shown in place of what is expected; once for each member.",
)
@click.option(
    "--part-number",
    multiple=True,
    metavar="TEXT",
    help="Of M.csv; given twice, of M.csv and of its mate, in this order.",
)
@click.option("--date", metavar="TEXT", help="When it was measured.")
@click.option("--operator", metavar="TEXT", help="Who measured it.")
@click.option("--measured-on", "measured_on", metavar="TEXT", help="The machine that it was measured on.")
@click.option("--probe", metavar="TEXT", help="The probe.")
@SIGMA
@MODEL
@MACHINE
@CALIBRATION
@output("HTML; two pictures are written beside it as PNG", *HTML)
def report(
    measured: Path,
    gear_set: str,
    mate: Path | None,
    again: tuple[Path, ...],
    part_number: tuple[str, ...],
    date: str | None,
    operator: str | None,
    measured_on: str | None,
    probe: str | None,
    sigma_um: float | None,
    model: str | None,
    machine: str,
    calibration: str,
    target: Path,
) -> None:
    """The inspection sheet of a measured member: one HTML page that prints on A4.

    What was left out stands first; then topography, pitch, figures with tolerance, grade and uncertainty, settings old
    and new, and what they cannot correct. Part number, date, operator, machine and probe come from the options, or from
    header comments of the file such as '# part_number: 4711'; what neither says is left blank, to be filled in by hand.
    Grades are by formulas that are not confirmed against ISO 17485: no conformity is claimed.
    """
    from gearmath.files import write_bytes, write_text
    from gearmath.front.judged import inspection
    from gearmath.front.measured import load_measurement
    from gearmath.front.sets import load_set

    check_one_source(sigma_um, model)
    paths = (measured,) if mate is None else (measured, mate)
    if len(part_number) > len(paths):
        raise InputError(f"--part-number: given {len(part_number)} times, for {len(paths)} measured file(s)")
    pair = load_set(gear_set)
    first, *second = files = [load_measurement(path, pair) for path in paths]
    if second and second[0].member.name == first.member.name:
        name = first.member.name
        raise InputError(f"{mate}: member = {name!r}: --mate must be of the other member than {measured}")
    given = {"date": date, "operator": operator, "machine": measured_on, "probe": probe}
    numbers = (*part_number, "", "")
    heads = [{"part_number": number, **given} for _, number in zip(files, numbers, strict=False)]
    known = [{key: text for key, text in head.items() if text} for head in heads]
    seconds = [load_measurement(path, pair) for path in again]
    with bars() as begin:
        made = inspection(files, known, seconds, sigma_um, model, machine, calibration, begin)
    for name, picture in made.pictures.items():
        write_bytes(target.with_name(f"{target.stem}_{name}.png"), picture)
    write_text(target, made.html)
    names = ", ".join(f"{target.stem}_{name}.png" for name in made.pictures)
    click.echo(f"{target}: inspection sheet, prints on A4; beside it {names}")

"""``gearmath report``: the inspection sheet of a member, or of both."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gearmath.cli.common import FLANK_CSV, HTML, MACHINE, SET_OPTION, about, bar, output
from gearmath.cli.probe import CALIBRATION
from gearmath.cli.uncertainty import MODEL, SIGMA, check_one_source
from gearmath.errors import InputError

if TYPE_CHECKING:
    from gearmath.quality.evaluation.member import MemberEvaluation
    from gearmath.report import ReportedMeasurement
    from gearmath.specs.bevel_set import BevelSet
    from gearmath.specs.flank_csv import FlankFile

#: Steps of the progress bar for them and for the correction.
_DRAWING, _CORRECTING = 8, 2

Progress = Callable[[int], object]


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
    from gearmath.bevel.pair import load_pair
    from gearmath.files import write_bytes, write_text
    from gearmath.quality.evaluation.member import STAGES
    from gearmath.report import STEPS, inspection_sheet
    from gearmath.specs.flank_csv import read_flank_csv
    from gearmath.specs.toml import find

    check_one_source(sigma_um, model)
    measurements = 1 if mate is None else 2
    if len(part_number) > measurements:
        raise InputError(f"--part-number: given {len(part_number)} times, for {measurements} measured file(s)")
    pair = load_pair(find(gear_set))
    files = {path: read_flank_csv(path) for path in (measured, *([mate] if mate else []))}
    if mate is not None and files[mate].member == files[measured].member:
        raise InputError(f"{mate}: member = {files[mate].member!r}: --mate must be of the other member than {measured}")
    given = {"date": date, "operator": operator, "machine": measured_on, "probe": probe}
    sure = (sigma_um, model, machine, calibration)
    members = []
    with bar(len(again) * STAGES + len(files) * (STAGES + _DRAWING + _CORRECTING + STEPS), "step") as progress:
        seconds = _again(again, pair, {file.member for file in files.values()}, progress)
        for k, (path, file) in enumerate(files.items()):
            known = {"part_number": part_number[k] if k < len(part_number) else "", **given}
            head = {key: text for key, text in known.items() if text}
            members.append(_measurement(path, file, pair, head, seconds.get(file.member), sure, progress))
        made = inspection_sheet(members, progress)
    for name, picture in made.pictures.items():
        write_bytes(target.with_name(f"{target.stem}_{name}.png"), picture)
    write_text(target, made.html)
    names = ", ".join(f"{target.stem}_{name}.png" for name in made.pictures)
    click.echo(f"{target}: inspection sheet, prints on A4; beside it {names}")


def _measurement(
    path: Path,
    file: FlankFile,
    pair: BevelSet,
    head: dict[str, str],
    again: MemberEvaluation | None,
    sure: tuple[float | None, str | None, str, str],
    progress: Progress,
) -> ReportedMeasurement:
    """One member evaluated, with its uncertainties and its correction."""
    from gearmath.quality.evaluation.member import evaluate_member
    from gearmath.quality.uncertainty.source import covariance_of
    from gearmath.report.judged import DRAWS, reported

    member = pair.member(file.member)
    with about(path):
        found = evaluate_member(file, member, file.member, progress=progress)
        covariance, source = covariance_of(file, member, *sure)
        share = _share(progress, DRAWS)
        made = reported(
            pair, path.name, file, found, covariance, source, head, sigma_um=sure[0], again=again, drawn=share
        )
    progress(_CORRECTING)
    return made


def _share(progress: Progress, draws: int) -> Progress:
    """Progress of the draws, as their share of the steps of a bar."""
    done = 0

    def drawn(count: int) -> None:
        nonlocal done
        before, done = done, done + count
        progress(done * _DRAWING // draws - before * _DRAWING // draws)

    return drawn


def _again(
    paths: tuple[Path, ...], pair: BevelSet, wanted: set[str], progress: Progress
) -> dict[str, MemberEvaluation]:
    """Second measurements by member."""
    from gearmath.quality.evaluation.member import evaluate_member
    from gearmath.specs.flank_csv import read_flank_csv

    found: dict[str, MemberEvaluation] = {}
    for path in paths:
        file = read_flank_csv(path)
        if file.member not in wanted or file.member in found:
            why = "is there twice" if file.member in found else "has no first measurement on the sheet"
            raise InputError(f"{path}: member = {file.member!r}: {why}")
        with about(path):
            found[file.member] = evaluate_member(file, pair.member(file.member), file.member, progress=progress)
    return found

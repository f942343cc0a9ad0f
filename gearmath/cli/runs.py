"""``gearmath runs``: what the measurement store keeps, shown, exported, compared, and gone on with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gearmath.cli.common import JSON, NewFile, bar, echo_json, plot, save_plot
from gearmath.errors import InputError

if TYPE_CHECKING:
    from gearmath.control.store import MeasurementStore
    from gearmath.control.store_evaluation import EvaluatedRun
    from gearmath.control.store_run import StoredRun


def store_option(words: str = "The measurement store.") -> Callable[[Callable[..., None]], Callable[..., None]]:
    """``--store``, the same file for all verbs that read or write runs."""
    return click.option(
        "--store",
        "store_file",
        type=click.Path(path_type=Path),
        callback=_named,
        default="runs.db",
        show_default=True,
        envvar="GEARMATH_STORE",
        show_envvar=True,
        help=words,
    )


def _named(_context: click.Context, _option: click.Parameter, path: Path) -> Path:
    if path == Path():  # an empty name too
        raise InputError("--store: must name a file, such as runs.db, not be empty or '.'")
    return path


STORE = store_option()
_RUN = click.argument("run", type=click.IntRange(1), metavar="RUN")
_RUNS = click.argument("numbers", type=click.IntRange(1), metavar="RUN...", nargs=-1, required=True)
#: What --format gives, by the ending of the file where it is not said.
_FORMATS = {".csv": "csv", ".dfq": "dfq", "": "files"}


@click.group()
def runs() -> None:
    """The measurement store: every run on the machine, touch by touch."""


@runs.command("list")
@STORE
@JSON
def list_(store_file: Path, as_json: bool) -> None:
    """All runs, the oldest first: when, who, what, how far."""
    from gearmath.cli.runs_text import list_text
    from gearmath.control.store_summary import summaries

    with _opened(store_file) as store:
        found = summaries(store)
    if as_json:
        echo_json([vars(each) for each in found])
    else:
        click.echo(list_text(store_file, found))


@runs.command()
@_RUN
@STORE
@click.option(
    "--evaluate",
    is_flag=True,
    help="Evaluate the run by set, machine and probe as stored, and keep the result; of a run on ring and spheres the "
    "new calibration or machine file.",
)
@plot("the evaluation of the run")
@JSON
def show(run: int, store_file: Path, evaluate: bool, picture: Path | None, as_json: bool) -> None:
    """One run: what it was begun with, who went on with it, alarms, results, and the points without a touch."""
    from gearmath.cli.runs_text import show_text, show_values

    with _opened(store_file) as store:
        kept, figures = store.run(run), ""
        of_member = kept.start.columns[2] == "member"
        if picture and not of_member:
            raise InputError(f"--plot: run {run} touches ring and spheres; there is a picture of runs of a member only")
        if evaluate and not of_member:
            figures = _calibrated(kept)
        elif picture or evaluate:
            (evaluated,) = _evaluated(store, (run,))
        if evaluate and not figures:
            from gearmath.cli.quality_text import evaluation_text
            from gearmath.control.store_evaluation import keep_results

            keep_results(evaluated)
            figures = evaluation_text(evaluated.found)
        if picture:
            from gearmath.plot import evaluation_figure

            save_plot(evaluation_figure(f"{evaluated.name}, run {run}", evaluated.found), picture, as_json)
        values = show_values(kept)
    if as_json:
        echo_json(values)
    else:
        click.echo("\n\n".join([show_text(values), figures]).rstrip())


@runs.command()
@_RUNS
@STORE
@click.option(
    "--format",
    "wanted",
    type=click.Choice(["csv", "dfq", "files"]),
    help="csv: the raw touches, as 'gearmath touches' reads them. dfq: figures as quality data, a part a run. files: a "
    "new folder with all that is stored of the run.  [default: by the ending of the output]",
)
@click.option("--grade", type=click.IntRange(2, 11), help="With dfq: the grade whose tolerances the figures get.")
@click.option("-o", "--output", "target", type=click.Path(path_type=Path), required=True, help="File or folder.")
def export(numbers: tuple[int, ...], store_file: Path, wanted: str | None, grade: int | None, target: Path) -> None:
    """Write a run, or with dfq several runs of one member, for other programs.

    Points that were probed again stand in the touches in place of the old ones.
    """
    from gearmath.files import check_place, write_bytes, write_text

    kind = wanted or _FORMATS.get(target.suffix.lower())
    if kind is None:
        raise InputError(f"{target}: --format is missing: the name must end in .csv or .dfq, or --format must say it")
    if grade is not None and kind != "dfq":
        raise InputError(f"--grade {grade}: is for dfq; {target} is written as {kind}")
    if len(numbers) > 1 and kind != "dfq":
        raise InputError(f"runs {', '.join(map(str, numbers))}: {kind} takes one run, dfq several")
    check_place(target)
    with _opened(store_file) as store:
        if kind == "files":
            from gearmath.control.store_files import write_run

            click.echo(f"{target}: {len(write_run(store.run(numbers[0]), target))} files of run {numbers[0]}")
        elif kind == "csv":
            from gearmath.control.store_touches import touch_csv

            run = store.run(numbers[0])
            write_text(target, touch_csv(run))
            lacking = run.missing()
            whole = f"; {len(lacking)} of its points have no touch, the first is {lacking[0]}" if lacking else ""
            click.echo(f"{target}: touches of run {run.id}{whole}")
        else:
            from gearmath.control.store_dfq import runs_dfq

            write_bytes(target, runs_dfq(_evaluated(store, numbers), grade))
            click.echo(f"{target}: figures of {len(numbers)} run{'s' if len(numbers) > 1 else ''}")


@runs.command()
@_RUNS
@STORE
@plot("flanks and pitch of two runs; of more, the course of their figures with bars of 2 u")
@JSON
def compare(numbers: tuple[int, ...], store_file: Path, picture: Path | None, as_json: bool) -> None:
    """Runs of one member side by side: figures and their change, and what was not the same when they were measured.

    Each run is evaluated by the set, machine and probe that are stored with it, clamping and rotation taken out.
    """
    from gearmath.cli.runs_text import compare_text
    from gearmath.control import store_compare

    if len(set(numbers)) < 2 or len(set(numbers)) < len(numbers):
        raise InputError(f"runs {', '.join(map(str, numbers))}: must be two different runs, or more")
    with _opened(store_file) as store:
        found = store_compare.compare(_evaluated(store, numbers))
        values, text = found.as_dict(), compare_text(found)
    if picture:
        from gearmath.control.store_picture import runs_figure

        save_plot(runs_figure(found), picture, as_json)
    if as_json:
        echo_json(values)
    else:
        click.echo(text)


@runs.command()
@_RUN
@STORE
@click.option(
    "--again",
    metavar="POINTS",
    help="Begin a new run that refers to this one, of points to be probed again: numbers and stretches, 3,17-20.",
)
@click.option("-o", "--output", "target", type=NewFile(), help="Also write the program as it was run.")
@JSON
def resume(run: int, store_file: Path, again: str | None, target: Path | None, as_json: bool) -> None:
    """Say how a run goes on at its first missing point: program, and R90 and R91 for each NC start.

    'gearmath control measure --resume RUN' does it with the control.
    """
    from gearmath.cli.runs_text import resume_text, resume_values
    from gearmath.control.parts import chosen_points
    from gearmath.files import write_bytes

    with _opened(store_file) as store:
        kept = store.run(run)
        if again is not None:
            old = kept.start
            points = {point: old.points[point] for point in chosen_points("--again", again, old.points)}
            kept = store.begin_run(replace(old, points=points, refers_to=run, operator=""))
        elif kept.is_complete:
            raise InputError(f"{store_file}: run {run} is complete: --again probes points of it once more")
        values = resume_values(kept)
        if target is not None:
            write_bytes(target, kept.start.program_text)
    if as_json:
        echo_json(values)
    else:
        click.echo(resume_text(values))


def _calibrated(run: StoredRun) -> str:
    """A calibration run evaluated, its file kept with it."""
    from gearmath.cli.probe import axis_lines, tip_lines
    from gearmath.control.store_calibration import calibrate_run
    from gearmath.quality.calibration.tip import Tip

    made = calibrate_run(run)
    run.add_result(made.role, made.file)
    found = made.found
    return "\n".join(tip_lines(found) if isinstance(found, Tip) else axis_lines(found, made.known))


def _opened(path: Path) -> MeasurementStore:
    from gearmath.control.store import MeasurementStore

    return MeasurementStore.open(path, create=False)


def _evaluated(store: MeasurementStore, numbers: tuple[int, ...]) -> list[EvaluatedRun]:
    from gearmath.control.store_evaluation import evaluate_run
    from gearmath.quality.evaluation.member import STAGES

    kept = [store.run(number) for number in numbers]
    with bar(STAGES * len(kept), "stage") as progress:
        return [evaluate_run(run, progress) for run in kept]

"""``gearmath gearbox cut`` and ``choose``: the gear that the gearbox would cut, and the parts that reach a class."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click
from click.core import ParameterSource

from gearmath.cli.common import JSON, NewFile, Number, bars, echo_json, of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from gearmath.cli.gearbox_cut_text import Part
    from gearmath.gearbox.hobbed.drive import Rule
    from gearmath.specs.hobbing import HobbingMachine

#: Suffixes of a chart.
CHARTS = (".png", ".svg", ".html")
#: Options that have no meaning on the machines of a profile, by parameter.
_MEANINGLESS = {
    "hobbing": {"pitch": "--pitch", "length": "--length"},
    "lathe": {
        "teeth": "--teeth",
        "hob": "--hob",
        "helix": "--helix",
        "way": "--cut",
        "shift": "--shift",
        "feed": "--feed",
        "width": "--width",
        "hob_shift": "--hob-shift",
        "points": "--csv",
        "flanks": "--stl",
    },
}


@click.command()
@click.argument("machine")
@click.option("--teeth", type=click.IntRange(min=1), help="Teeth of the gear (hobbing machine).")
@click.option("--pitch", help="Pitch of the thread or worm, such as 1.25mm or 8tpi (lathe).")
@click.option("--hob", help="A hob of the machine file, such as m1; the first if left out.")
@click.option("--starts", type=int, help="Starts of the hob, instead of the machine file's; of the thread.")
@click.option("--helix", type=float, help="Helix angle in degrees.")
@click.option("--hand", type=of("hand"), help="Hand of helix or thread; right if left out.")
@click.option(
    "--cut",
    "way",
    type=of("cut"),
    default="climb",
    show_default=True,
    help="Sense of the feed: climb hobbing or conventional.",
)
@click.option("--shift", type=float, default=0.0, show_default=True, help="Profile shift in modules.")
@click.option(
    "--feed",
    type=Number(0.01, 10.0, "mm per turn of the table"),
    default=0.5,
    show_default=True,
    help="Axial feed, in mm per turn of the table.",
)
@click.option("--width", type=of("face_width"), help="Face width in mm; ten modules if left out.")
@click.option(
    "--hob-shift",
    type=of("hob_shift"),
    default=0.0,
    show_default=True,
    help="The hob's middle from the pitch point, in mm, to the right as seen from the hob towards the gear.",
)
@click.option("--length", type=of("length"), default=100.0, show_default=True, help="Of a thread, in mm.")
@click.option("--rpm", type=float, help="Speed of hob or spindle in rpm; the highest within the limits if left out.")
@click.option(
    "--seconds",
    type=of("seconds"),
    default=0.0,
    show_default=True,
    help="How long the hob has run before the cut, in s.",
)
@click.option("--rule", type=of("rule"), default="exact", show_default=True)
@click.option("--compare", type=of("compare"), help="Another rule beside it.")
@click.option("--plot", "chart", type=NewFile(), metavar="CHART", help="Inspection chart to write: PNG, SVG or HTML.")
@click.option("--csv", "points", type=NewFile(), metavar="POINTS.csv", help="Measured points to write.")
@click.option(
    "--stl",
    "flanks",
    type=NewFile(".stl"),
    metavar="GEAR.stl",
    help="The gear to write, a closed solid with its flanks as cut.",
)
@JSON
def cut(machine: str, as_json: bool, chart: Path | None, points: Path | None, compare: Rule | None, **job: Any) -> None:
    """Cut a gear virtually, inspect it, give it classes, and tell which part of the machine is to blame.

    The machine's errors are the section [errors] of MACHINE; without it, only gashes, feed and steps are seen. On a
    lathe: the pitch error of a thread over its length.
    """
    from gearmath.front.machines import load_hobber

    if chart is not None and chart.suffix.lower() not in CHARTS:
        raise click.UsageError(f"--plot {chart}: must end in .png, .svg or .html")
    loaded = load_hobber(machine)
    _refuse_meaningless(loaded)
    if loaded.profile == "lathe":
        _cut_thread(loaded, as_json, chart, compare, job)
    else:
        _cut_gear(loaded, as_json, chart, points, compare, job)


def _refuse_meaningless(machine: HobbingMachine) -> None:
    """Raise UsageError for an option that would be given in vain."""
    context = click.get_current_context()
    for parameter, option in _MEANINGLESS[machine.profile].items():
        if context.get_parameter_source(parameter) is ParameterSource.COMMANDLINE:
            made = "thread, which a lathe cuts" if machine.profile == "lathe" else "gear, which a hobbing machine cuts"
            raise click.UsageError(f"{machine.name}: {option} has no meaning for a {made}")


def _cut_gear(
    machine: HobbingMachine,
    as_json: bool,
    chart: Path | None,
    points: Path | None,
    compare: Rule | None,
    job: dict[str, Any],
) -> None:
    from gearmath.cli.gearbox_cut_text import as_text, cut_parts
    from gearmath.front.hobbing import hob

    if job["teeth"] is None:
        raise click.UsageError(f"{machine.name} is a hobbing machine: give --teeth")
    if job["hand"] is not None and job["helix"] is None:
        raise click.UsageError("--hand has no meaning without --helix")
    options = {
        key: job[key]
        for key in ("hob", "starts", "helix", "hand", "shift", "feed", "rpm", "seconds", "rule", "hob_shift")
    }
    with bars(quiet=as_json) as begin:
        made = hob(
            machine, job["teeth"], compare, begin, face_width=job["width"], climb=job["way"] == "climb", **options
        )
    parts = cut_parts(made.setup, made.gears, made.shares)
    if chart is not None:
        _save(chart, made.plot(), made.title, parts, as_json)
    if points is not None:
        click.echo(f"points: {made.to_csv(points)}", err=as_json)
    if job["flanks"] is not None:
        with bars(quiet=as_json) as begin:
            made.to_stl(job["flanks"], begin)
        click.echo(f"gear: {job['flanks']}", err=as_json)
    if as_json:
        echo_json(made.to_dict())
    else:
        click.echo(as_text(parts))


def _save(path: Path, figure: Figure, title: str, parts: Sequence[Part], as_json: bool) -> None:
    """A chart by the suffix of its name; HTML has the text above it."""
    from gearmath.cli.gearbox_cut_text import Columns
    from gearmath.files import write_text
    from gearmath.page import Page
    from gearmath.plot.saving import save, save_svg, svg

    if path.suffix.lower() == ".html":
        page = Page(title)
        for part in parts:
            if isinstance(part, Columns):
                page.table("", part.head, part.rows)
            elif part:
                page.paragraph(part)
        page.chart(svg(figure), "Inspection chart")
        write_text(path, page.html)
    elif path.suffix.lower() == ".svg":
        save_svg(figure, path)
    else:
        save(figure, path)
    click.echo(f"chart: {path}", err=as_json)


def _cut_thread(
    machine: HobbingMachine,
    as_json: bool,
    chart: Path | None,
    compare: Rule | None,
    job: dict[str, Any],
) -> None:
    from gearmath.cli.gearbox_cut_text import as_text, thread_parts
    from gearmath.front.hobbing import plan

    if job["pitch"] is None:
        raise click.UsageError(f"{machine.name} is a lathe: give --pitch")
    given = {key: job[key] for key in ("starts", "hand", "rpm") if job[key] is not None}
    made = plan(machine, pitch=job["pitch"], **given).thread(job["length"], job["rule"], job["seconds"], compare)
    parts = thread_parts(made.plan, made.traces)
    if chart is not None:
        _save(chart, made.plot(), machine.name, parts, as_json)
    if as_json:
        echo_json(made.to_dict())
    else:
        click.echo(as_text(parts))


@click.command()
@click.argument("machine", default="hobbing_default.toml")
@click.option("--class", "wanted", type=int, required=True, help="Class of ISO 1328-1 to reach, 1 to 11.")
@click.option("--module", type=of("module"), required=True, help="Normal module in mm.")
@click.option("--teeth", type=click.IntRange(min=1), required=True, help="Teeth of the gear.")
@click.option("--width", type=of("face_width"), help="Face width in mm; ten modules if left out.")
@click.option("--helix", type=float, help="Helix angle in degrees; a spur gear if left out.")
@click.option("--hand", type=of("hand"), help="Hand of the helix; right if left out.")
@JSON
def choose(
    machine: str,
    wanted: int,
    module: float,
    teeth: int,
    width: float | None,
    helix: float | None,
    hand: Literal["right", "left"] | None,
    as_json: bool,
) -> None:
    """The least microsteps, encoder lines and gashes, and the coarsest feed, that reach a class.

    The rest is that of MACHINE, hobbing_default.toml if left out, with its section [errors].
    """
    from gearmath.cli.gearbox_cut_text import choice_text
    from gearmath.front.hobbing import choose as search

    if helix is None and hand is not None:
        raise click.UsageError("--hand has no meaning without --helix")
    with bars(quiet=as_json) as begin:
        found = search(machine, wanted, module, teeth, begin, face_width=width, helix=helix, hand=hand)
    if as_json:
        echo_json(found.as_dict())
    else:
        click.echo(choice_text(found))

"""Page result: what a stored run says of the member, as the inspection sheet does, and the sheet to print."""

from __future__ import annotations

from collections.abc import Callable

from nicegui import ui

from gearmath.hmi import blocks, widgets
from gearmath.hmi.drawing import named
from gearmath.hmi.messages import Text
from gearmath.hmi.result_view import ResultView, result_of
from gearmath.hmi.state import Shared
from gearmath.hmi.work import Progress


def build(shared: Shared, text: Text) -> None:
    """The content of the page."""
    desk = shared.desk
    with widgets.panel(text("result.run"), wide=True):
        blocks.run_choice(shared, text)

    def compute() -> Callable[[Progress], ResultView]:
        run = desk.shown_run()
        assert run is not None  # without a run nothing is computed
        return lambda progress: result_of(desk.runs, run, progress)

    with ui.element("div").classes("gm-wide gm-follow"):
        blocks.kept(
            text,
            desk.of("result"),
            desk.shown_run,
            text("result.judging"),
            compute,
            lambda found: _show(text, found),
        )


def _show(text: Text, found: ResultView) -> None:
    names = blocks.flank_names(text)
    with widgets.panel(text("result.first"), wide=True):
        for sentence in found.first:
            widgets.Message(sentence, "warning")
        for sentence in found.others:
            widgets.note(sentence)
        if not (found.first or found.others):
            widgets.note(text("result.nothing"))
        _sheet(text, found)
    with widgets.panel(text("result.topography"), wide=True):
        if found.topographies:
            widgets.note(text("result.zero"))
        else:
            widgets.Message(text("result.no_topography"), "warning")
        with ui.element("div").classes("gm-charts"):
            for flank, svg in found.topographies.items():
                blocks.chart(text, named(svg), f"{text('result.topography')}, {names[flank]}")
        _forms(text, found, names)
    with widgets.panel(text("result.spacing"), wide=True):
        if not found.pitches:
            widgets.Message(text("result.no_pitch"), "warning")
        with ui.element("div").classes("gm-charts"):
            for flank, svg in found.pitches.items():
                what = text("result.runout") if flank == "both" else f"{text('result.pitch')}, {names[flank]}"
                blocks.chart(text, named(svg), what)
        _spacing(text, found, names)
    with widgets.panel(text("result.uncertainty"), wide=True):
        _uncertainty(text, found, names)


def _sheet(text: Text, found: ResultView) -> None:
    sheet, name = found.judged.sheet, f"inspection_run_{found.judged.evaluated.run.id}.html"
    with ui.element("iframe").classes("gm-sheet") as frame:
        frame.props["srcdoc"] = sheet
        frame.props["title"] = text("result.sheet")
        frame.props["tabindex"] = "-1"

    def printed() -> None:
        ui.run_javascript(f"document.getElementById('c{frame.id}').contentWindow.print()")

    with widgets.row():
        widgets.button(text("result.print"), printed, "print", primary=True)
        widgets.button(text("result.save"), lambda: ui.download.content(sheet, name, "text/html"), "download")


def _forms(text: Text, found: ResultView, names: dict[str, str]) -> None:
    flanks = list(found.topographies)
    values = {(row.name, row.flank): row.cells[0] for row in found.forms}
    rows = [
        [text(f"result.{name}"), *(_word(text, values.get((name, flank), "")) for flank in flanks)]
        for name in dict.fromkeys(row.name for row in found.forms)
    ]
    if rows:
        blocks.plain_table(text("result.forms"), [f"{text('result.figure')} / µm", *(names[f] for f in flanks)], rows)


def _spacing(text: Text, found: ResultView, names: dict[str, str]) -> None:
    rows = []
    for row in found.spacing:
        value, interval, grade, tolerance = row.cells
        spread = interval.replace(" to ", " … ")
        rows.append([f"{row.name}, {names[row.flank]}", _word(text, value), spread, _word(text, grade), tolerance])
    if rows:
        head = [
            text("result.figure"),
            f"{text('result.value')} / µm",
            f"{text('result.interval')} / µm",
            f"{text('result.grade')} / 1",
            f"{text('result.tolerance')} / µm",
        ]
        blocks.plain_table(text("result.spacing"), head, rows)
    if found.caveat:
        widgets.Message(found.caveat, "warning")
    if found.thickness:
        rows = [[text(f"result.{row.name}"), *row.cells] for row in found.thickness]
        head = [text("result.figure"), f"{text('result.nominal')} / mm", f"{text('result.deviation')} / µm"]
        blocks.plain_table(text("result.thickness"), head, rows)


def _uncertainty(text: Text, found: ResultView, names: dict[str, str]) -> None:
    if not found.sure:
        widgets.note(text("result.not_known"))
        return
    widgets.note(f"{text('result.how_sure')}: {found.how_sure}")
    head = [text(f"result.{key}") for key in ("figure", "value", "u", "from", "to", "unit", "method")]
    rows = [[f"{row.name.replace('_', ' ')}, {names[row.flank]}", *row.cells] for row in found.sure]
    blocks.plain_table(text("result.uncertainty"), head, rows)


def _word(text: Text, cell: str) -> str:
    """A cell of the sheet, its words in the language of the page."""
    return cell.replace("withheld", text("result.withheld")).replace("beyond 11", text("result.beyond"))

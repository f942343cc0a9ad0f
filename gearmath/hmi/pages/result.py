"""Page result: what a stored run says of the member, as the inspection sheet does, and the sheet to print."""

from __future__ import annotations

from collections.abc import Callable

from nicegui import ui

from gearmath.hmi import blocks, widgets, words
from gearmath.hmi.drawing import named
from gearmath.hmi.messages import Text
from gearmath.hmi.result_view import ResultRow, ResultView, SureView, result_of, sure_of
from gearmath.hmi.state import Shared
from gearmath.hmi.work import Progress
from gearmath.quality.evaluation.tolerance import CAVEAT


def build(shared: Shared, text: Text) -> None:
    """The content of the page."""
    desk = shared.desk
    with widgets.panel(text("result.run"), wide=True):
        blocks.run_choice(shared, text, text("blocks.no_run"))

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
            lambda found: _show(shared, text, found),
        )


def _show(shared: Shared, text: Text, found: ResultView) -> None:
    names = blocks.flank_names(text)
    with widgets.panel(text("result.first"), wide=True):
        for sentence in found.first:
            widgets.Message(text.quoted(sentence), "warning")
        for sentence in found.others:
            widgets.note(text.quoted(sentence))
        if not (found.first or found.others):
            widgets.note(text("result.nothing"))
        _sheet(shared, text, found.run)
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
        place = ui.element("div").classes("gm-follow")
        with place:
            _spacing(text, found.spacing, names)
        if found.caveat:
            known = found.caveat == CAVEAT
            widgets.Message(text("result.caveat") if known else text.quoted(found.caveat), "warning")
        _thickness(text, found)
    with widgets.panel(text("result.uncertainty"), wide=True):

        def sure(known: SureView) -> None:
            place.clear()
            with place:
                _spacing(text, known.spacing, names)
            _uncertainty(text, known, names)

        def compute() -> Callable[[Progress], SureView]:
            return lambda progress: sure_of(shared.desk.runs, found.run, progress)

        blocks.kept(text, shared.desk.of("result.sure"), lambda: found.run, text("result.computing"), compute, sure)


def _sheet(shared: Shared, text: Text, run: int) -> None:
    """The inspection sheet to print or to keep, made when somebody asks."""
    work, asked = shared.works["result.sheet"], [""]

    def ask(what: str) -> None:
        work.start(f"run {run}", lambda progress: shared.desk.runs.sheet(run, progress))
        asked[0] = what

    def ended() -> None:
        what, asked[0] = asked[0], ""  # the page that asked, and no other
        if not what or work.result is None:
            return
        frame.props["srcdoc"] = work.result
        frame.update()
        if what == "print":
            ui.run_javascript(f"setTimeout(() => document.getElementById('c{frame.id}').contentWindow.print(), 500)")
        else:
            ui.download.content(work.result, f"inspection_run_{run}.html", "text/html")

    with widgets.row():
        widgets.button(text("result.print"), lambda: ask("print"), "print", primary=True)
        widgets.button(text("result.save"), lambda: ask("save"), "download")
    widgets.progress(text, work, lambda: text("result.sheet"), ended)
    frame = ui.element("iframe").classes("gm-sheet")
    frame.props["title"], frame.props["tabindex"] = text("result.sheet"), "-1"


def _forms(text: Text, found: ResultView, names: dict[str, str]) -> None:
    flanks = list(found.topographies)
    values = {(row.name, row.flank): row.cells[0] for row in found.forms}
    rows = [
        [text(f"result.{name}"), *(_word(text, values.get((name, flank), "")) for flank in flanks)]
        for name in dict.fromkeys(row.name for row in found.forms)
    ]
    if rows:
        blocks.plain_table(text("result.forms"), [f"{text('result.figure')} / µm", *(names[f] for f in flanks)], rows)


def _spacing(text: Text, found: tuple[ResultRow, ...], names: dict[str, str]) -> None:
    rows = []
    for row in found:
        value, interval, grade, tolerance = row.cells
        spread, grade = (cell.replace(" to ", " … ") for cell in (interval, grade))
        rows.append([f"{row.name}, {names[row.flank]}", _word(text, value), spread, _word(text, grade), tolerance])
    if rows:
        keys = {"value": "µm", "interval": "µm", "grade": "1", "tolerance": "µm"}
        head = [text("result.figure"), *(f"{text(f'result.{key}')} / {unit}" for key, unit in keys.items())]
        blocks.plain_table(text("result.spacing"), head, rows)


def _thickness(text: Text, found: ResultView) -> None:
    if found.thickness:
        rows = [[text(f"result.{row.name}"), *row.cells] for row in found.thickness]
        head = [text("result.figure"), f"{text('result.nominal')} / mm", f"{text('result.deviation')} / µm"]
        blocks.plain_table(text("result.thickness"), head, rows)


def _uncertainty(text: Text, found: SureView, names: dict[str, str]) -> None:
    if not found.figures:
        widgets.note(text("result.not_known"))
        return
    widgets.note(f"{text('result.how_sure')}: {text.quoted(found.source)}")
    head = [text(f"result.{key}") for key in ("figure", "value", "u", "from", "to", "unit", "method")]
    rows = []
    for row in found.figures:
        *numbers, unit, method = row.cells
        name = f"{blocks.figure_name(text, row.name)}, {names[row.flank]}"
        rows.append([name, *numbers, words.unit(text, unit), method])
    blocks.plain_table(text("result.uncertainty"), head, rows)


def _word(text: Text, cell: str) -> str:
    """A cell of the sheet, its words in the language of the page."""
    return cell.replace("withheld", text("result.withheld")).replace("beyond 11", text("result.beyond"))

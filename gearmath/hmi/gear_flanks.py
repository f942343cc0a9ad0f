"""Both flanks of a tooth on page gear, in space or flat: what the settings change of them, or what was measured."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import ui

from gearmath.hmi import blocks, widgets
from gearmath.hmi.desk import SOURCES, Draft
from gearmath.hmi.drawing import drawn
from gearmath.hmi.flank_view import flat_figures, space_figure
from gearmath.hmi.gear_draft import GearDraft
from gearmath.hmi.work import Progress


class GearFlanks:
    """The part of one browser."""

    def __init__(self, page: GearDraft) -> None:
        self.page, self.text, self.desk, self.names = page, page.text, page.desk, page.names
        self.look = ""
        """How flanks are drawn, space or flat; nothing until the browser has said what it can."""
        self.plot: ui.plotly | None = None

    def show(self) -> None:
        """Both flanks of a tooth in space, or flat."""
        text, desk = self.text, self.desk

        def source(name: str) -> None:
            desk.source = name

        def draw_as(kind: str) -> None:
            self.look = kind
            if seen:
                show(seen[0], anew=True)

        sources = {name: text(f"gear.of_{name}") for name in SOURCES}
        kinds = {"space": text("gear.space"), "flat": text("gear.flat")}
        with widgets.row():
            blocks.follow(
                lambda: desk.source, lambda: widgets.choice(text("gear.deviations"), sources, desk.source, source)
            )
            blocks.run_choice(self.page.shared, text)
            look = widgets.choice(text("gear.look"), kinds, "space", draw_as)
        blocks.marked(lambda: self.page.no_run() or self.page.without())
        words = widgets.note("")
        no_webgl = widgets.Message()
        drawing = ui.element("div").classes("gm-follow")
        seen: list[Draft] = []

        def show(found: Draft, anew: bool = False) -> None:
            seen[:], words.text = [found], self._words(found)
            if self.plot is not None and found.view is not None and not anew and not self.page.no_run():
                self.plot.update_figure(self._space(found))  # the operator has turned it
                return
            self.plot = None
            drawing.clear()
            with drawing:
                self._flanks(found)

        self.page.kept(show)

        def answered(there: bool) -> None:
            if not there:
                no_webgl.show(text("gear.no_webgl"))
                look.value = "flat"  # which draws
            elif not self.look:
                draw_as("space")

        blocks.has_webgl(answered)

    def _flanks(self, found: Draft) -> None:
        text, view = self.text, found.view
        if self.page.no_run():
            return
        if view is None:
            widgets.Message(text.quoted(found.no_view), "warning")
        elif self.look == "flat":

            def compute() -> Callable[[Progress], dict[str, str]]:
                return lambda progress: {flank: drawn(lambda f=f: f) for flank, f in flat_figures(view).items()}  # type: ignore[misc]

            blocks.kept(text, self.desk.of("gear.flat"), lambda: found, text("gear.drawing"), compute, self._flat)
        elif self.look == "space":
            self.plot = widgets.figure(self._space(found), text("gear.flanks")).classes("gm-space")

    def _flat(self, found: dict[str, str]) -> None:
        with ui.element("div").classes("gm-charts"):
            for flank, svg in found.items():
                blocks.chart(self.text, svg, self.names[flank])

    def _space(self, found: Draft) -> dict[str, Any]:
        assert found.view is not None  # asked before
        return space_figure(found.view, found.member.name, self.names, bool(ui.context.client.page.dark))

    def _words(self, found: Draft) -> str:
        """What is shown, its largest deviation, and how many times it is enlarged."""
        if found.view is None or self.page.no_run():
            return ""
        member, largest = self.text(f"blocks.{found.member.name}"), f"{found.view.largest_um:z.1f}"
        if float(largest) == 0.0:
            return self.text("gear.no_deviation", member=member)
        return self.text("gear.view", member=member, largest=largest, times=f"{found.view.times:g}")

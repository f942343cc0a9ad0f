"""Page gearbox: a job of the electronic gearbox planned, its error over time, and the firmware to take."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from nicegui import ui

from gearmath.front.hobbing import Job
from gearmath.front.machines import load_hobber
from gearmath.gearbox.hobbed.classes import FigureClass
from gearmath.gearbox.job import GearboxJob, ThreadPlan
from gearmath.hmi import acting, blocks, widgets, words
from gearmath.hmi.catalog import changed_at, check, files_of, unreadable
from gearmath.hmi.drawing import drawn
from gearmath.hmi.hobbing_job import (
    EDGES,
    START,
    HobbingWish,
    PlanLine,
    blank_lines,
    figure_symbol,
    firmware_zip,
    limits,
    plan_lines,
    planned,
    predicted,
    rpm_limits,
    sketch_name,
)
from gearmath.hmi.messages import Text
from gearmath.hmi.number_field import NumberField
from gearmath.hmi.numbers import Limits
from gearmath.hmi.state import Shared
from gearmath.hmi.work import Progress
from gearmath.specs.hobbing import HobbingMachine
from gearmath.specs.toml import find

#: Edges of a simulation at first.
_EDGES = 1_000_000
_EVERY = "-"


def build(shared: Shared, text: Text) -> None:
    """The content of the page."""
    page = _GearboxPage(shared, text)
    with widgets.panel(text("gearbox.machine")):
        page.machine()
    with widgets.panel(text("gearbox.plan")):
        page.plan()
    with widgets.panel(text("gearbox.blanks"), wide=True):
        page.blanks()
    with widgets.panel(text("gearbox.quality"), wide=True):
        page.quality()
    with widgets.panel(text("gearbox.error"), wide=True):
        page.error()


class _GearboxPage:
    """The page of one browser; machine and wish are of the server."""

    def __init__(self, shared: Shared, text: Text) -> None:
        self.shared, self.text, self.desk = shared, text, shared.desk
        self.fields: list[NumberField] = []
        """What is to be cut, as it is typed on this page."""

    def outdated(self) -> str:
        """Which fields are refused: what is planned is not what stands there."""
        return blocks.refused(self.text, self.fields)

    def no_plan(self, of_gear: bool = False) -> str:
        """Why nothing can be made of the plan."""
        work = self.desk.of("gearbox").work
        if said := self.outdated():
            return said
        if of_gear and work.result is not None and isinstance(work.result[1].plan, ThreadPlan):
            return self.text("gearbox.no_class")
        return "" if work.result is not None else self.text("gearbox.no_plan")

    def key(self) -> Any:
        """What is planned: machine, the file as it is, and the wish."""
        return self.desk.hobber, changed_at(self.desk.hobber), self.desk.wish

    def compute(self) -> Callable[[Progress], tuple[HobbingMachine, Job]]:
        """The plan of now."""
        name, wish = self.desk.hobber, self.desk.wish
        return lambda progress: _planned(name, wish)

    def kept(self, draw: Callable[[tuple[HobbingMachine, Job]], object]) -> None:
        """A part that shows the plan, or why there is none."""
        found, name = self.desk.of("gearbox"), self.text("gearbox.planning")
        blocks.kept(self.text, found, self.key, name, self.compute, draw, outdated=self.outdated)

    def wish(self, **changes: Any) -> None:
        """Ask for something else."""
        self.desk.wish = replace(self.desk.wish, **changes)

    def machine(self) -> None:
        """The machine file, what is to be cut, and the firmware."""
        text, desk = self.text, self.desk

        def choose(name: str) -> None:
            if name != desk.hobber:
                check("hobber", name)
                self.desk.wish = HobbingWish(teeth=desk.wish.teeth or 17, pitch=desk.wish.pitch or "1.25mm")
                desk.hobber = name

        options = files_of("hobber", self.shared.folder)
        options = options if desk.hobber in options else {desk.hobber: desk.hobber, **options}
        widgets.choice(text("gearbox.file"), options, desk.hobber, choose)
        for why in unreadable(self.shared.folder):
            widgets.Message(text("gear.unreadable", why=widgets.words_of(why)), "warning")
        blocks.follow(lambda: (desk.hobber, changed_at(desk.hobber)), self._wish)

    def _wish(self) -> None:
        """The fields that this machine has."""
        text, wish = self.text, self.desk.wish
        self.fields.clear()
        machine = load_hobber(find(self.desk.hobber))
        within, hands = limits(machine), {hand: text(f"gear.{hand}") for hand in ("right", "left")}
        starts = wish.starts or (1 if machine.profile == "lathe" else machine.hob_starts)
        if machine.profile == "lathe":
            pitch = widgets.word(text("gearbox.pitch"), wish.pitch or "", text("gearbox.pitch_like"))
            pitch.on("change", lambda: self.wish(pitch=pitch.value))
            self._number("starts", starts, "", 0, within["starts"])
            widgets.choice(text("gearbox.hand"), hands, wish.hand, lambda hand: self.wish(hand=hand))
        else:
            self._number("teeth", wish.teeth, "", 0, within["teeth"])
            every = {_EVERY: text("gearbox.every"), **{hob.name: hob.name for hob in machine.hobs}}
            chosen = wish.hob or _EVERY
            widgets.choice(
                text("gearbox.hob"), every, chosen, lambda hob: self.wish(hob=None if hob == _EVERY else hob)
            )
            self._number("starts", starts, "", 0, within["starts"])
            self._number("helix", wish.helix, "°", 4, within["helix"])
            widgets.choice(text("gearbox.helix_hand"), hands, wish.hand, lambda hand: self.wish(hand=hand))
            cuts = {cut: text(f"gearbox.{cut}") for cut in ("climb", "conventional")}
            widgets.choice(text("gearbox.cut"), cuts, wish.cut, lambda cut: self.wish(cut=cut))
            if machine.feed is None:
                feed = widgets.word(text("gearbox.feed"), wish.feed, text("gearbox.feed_like")).props('suffix="mm"')
                feed.on("change", lambda: self.wish(feed=feed.value))
        label = text("gearbox.rpm")  # left out, it is what the plan proposes
        rpm = NumberField(
            text, label, wish.rpm, "1/min", within["rpm"], lambda rpm: self.wish(rpm=rpm), 2, optional=True
        )
        self.fields.append(rpm)
        blocks.follow(self._job, lambda: rpm.limit(within["rpm"] if (job := self._job()) is None else rpm_limits(job)))

    def _job(self) -> GearboxJob | None:
        """The plan of the job that stands in the fields, where there is one."""
        found = self.desk.of("gearbox")
        return found.work.result[1].plan if found.has(self.key()) else None

    def _number(self, key: str, value: float | None, unit: str, digits: int, within: Limits) -> None:
        def changed(number: float) -> None:
            self.wish(**{key: int(number) if digits == 0 else number})

        label = self.text(f"gearbox.{key}")
        self.fields.append(NumberField(self.text, label, value, unit, within, changed, digits))

    def plan(self) -> None:
        """Ratio and rates against their limits, and the firmware."""

        def draw(found: tuple[HobbingMachine, Job]) -> None:
            machine, job = found
            self._lines(plan_lines(job.plan))
            if not job.plan.carried_at_every_speed and not isinstance(job.plan, ThreadPlan):
                highest = int(job.plan.highest_rpm)
                widgets.Message(self.text("gearbox.refused_by_firmware", rpm=highest), "warning")
            name = sketch_name(machine)
            widgets.button(
                self.text("gearbox.firmware"),
                lambda: ui.download.content(firmware_zip(machine, name), f"{name}.zip", "application/zip"),
                "download",
            )

        self.kept(draw)

    def blanks(self) -> None:
        """What to turn, set and measure, a column a hob."""

        def draw(found: tuple[HobbingMachine, Job]) -> None:
            _, job = found
            if isinstance(job.plan, ThreadPlan):
                widgets.note(self.text("gearbox.thread"))
                return
            lines = [blank_lines(blank) for blank in job.plan.blanks]
            head = [blank.hob for blank in job.plan.blanks]
            by_hob = [{line.key: line for line in each} for each in lines]
            rows = []
            for key in dict.fromkeys(line.key for each in lines for line in each):
                unit = next(each[key].unit for each in by_hob if key in each)
                cells = [each[key].value if key in each else "–" for each in by_hob]
                rows.append([f"{self.text(f'gearbox.{key}')} / {words.unit(self.text, unit)}", *cells])
            blocks.plain_table("", [self.text("gearbox.hob"), *head], rows)
            rules = dict.fromkeys(blank.depth_rule for blank in job.plan.blanks)
            widgets.note(f"{self.text('gearbox.depth_rule')}: {', '.join(rules)}")

        self.kept(draw)

    def _lines(self, lines: list[PlanLine]) -> None:
        for line in lines:
            share = "" if line.percent is None else self.text("gearbox.of_limit", percent=f"{line.percent:z.1f}")
            widgets.fact(
                self.text(f"gearbox.{line.key}"), line.value, f"{words.unit(self.text, line.unit)} {share}".rstrip()
            )

    def quality(self) -> None:
        """Figures and classes of the gear that would be cut, when somebody asks."""
        text, desk = self.text, self.desk

        def begin() -> None:
            desk.wanted["quality"] = self.key()

        def compute() -> Callable[[Progress], Any]:
            name, _, wish = self.key()
            return lambda progress: predicted(load_hobber(find(name)), wish, progress)

        def show(found: tuple[tuple[FigureClass, ...], int | None]) -> None:
            rows, whole = found
            cells = [
                [
                    figure_symbol(row.figure),
                    f"{row.value_um:z.2f}",
                    "–" if row.accuracy_class is None else str(row.accuracy_class),
                    "–" if row.tolerance_um is None else f"{row.tolerance_um:z.2f}",
                ]
                for row in rows
            ]
            head = [text("result.figure"), f"{text('result.value')} / µm", f"{text('gearbox.class')} / 1"]
            blocks.plain_table("", [*head, f"{text('gearbox.tolerance')} / µm"], cells)
            widgets.note(f"{text('gearbox.whole_class')}: {'–' if whole is None else whole}")
            widgets.Message(text("gearbox.unconfirmed"), "warning")

        with acting.buttons() as button:
            button(lambda: self.no_plan(of_gear=True), text("gearbox.predict"), begin, "play_arrow", primary=True)
        blocks.kept(
            text,
            desk.of("gearbox.quality"),
            lambda: self.key() if desk.wanted.get("quality") == self.key() and not self.outdated() else None,
            text("gearbox.cutting"),
            compute,
            show,
        )

    def error(self) -> None:
        """The error of the exact rule and of the floating one, when somebody asks."""
        text, desk = self.text, self.desk
        widgets.note(text("gearbox.rules"))
        with widgets.row():
            edges = NumberField(text, text("gearbox.edges"), _EDGES, "", EDGES, digits=0)
            start = NumberField(text, text("gearbox.start"), 0, "", START, digits=0)

        def missing() -> str:
            return self.no_plan() or blocks.refused(text, (edges, start))

        def begin() -> None:
            assert edges.value is not None
            assert start.value is not None
            desk.wanted["gearbox"] = (self.key(), int(edges.value), int(start.value))

        def key() -> Any:
            wanted: Any = desk.wanted.get("gearbox")
            return wanted if wanted is not None and wanted[0] == self.key() and not missing() else None

        def compute() -> Callable[[Progress], str]:
            wanted: Any = desk.wanted["gearbox"]
            (name, _, wish), count, first = wanted
            return lambda progress: _error(name, wish, count, first, progress)

        with acting.buttons() as button:
            button(missing, text("gearbox.simulate"), begin, "play_arrow", primary=True)
        blocks.kept(
            text,
            desk.of("gearbox.error"),
            key,
            text("gearbox.simulating"),
            compute,
            lambda svg: blocks.chart(text, svg, text("gearbox.error")),
        )


def _planned(name: str, wish: HobbingWish) -> tuple[HobbingMachine, Job]:
    machine = load_hobber(find(name))
    return machine, planned(machine, wish)


def _error(name: str, wish: HobbingWish, edges: int, start: int, progress: Progress) -> str:
    _, job = _planned(name, wish)
    progress.total = edges
    figure = job.plot(edges=edges, start=start, progress=progress)
    return drawn(lambda: figure)

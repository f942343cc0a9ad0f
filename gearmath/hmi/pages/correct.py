"""Page correct: what a correction of a run would change and leave; accepted into new files, or rejected with a note."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, field

from nicegui import ui

from gearmath.control.store_evaluation import EvaluatedRun
from gearmath.hmi import acting, blocks, widgets
from gearmath.hmi.correcting import (
    NOTE,
    WHICH,
    Accepted,
    Proposal,
    accept,
    charts_before,
    propose,
    reject,
    scale_before,
)
from gearmath.hmi.desk import Desk
from gearmath.hmi.messages import Text
from gearmath.hmi.run_history import past_runs
from gearmath.hmi.state import Shared
from gearmath.hmi.work import Progress


@dataclass(frozen=True)
class _Measured:
    """The run before any correction, and its charts by flank and scale."""

    evaluated: EvaluatedRun
    charts: dict[str, str]
    kept: dict[tuple[str, float], str] = field(default_factory=dict)


def build(shared: Shared, text: Text) -> None:
    """The content of the page."""
    page = _CorrectPage(shared, text)
    with widgets.panel(text("correct.run"), wide=True):
        blocks.run_choice(shared, text)
        page.options()
    with ui.element("div").classes("gm-wide gm-follow"):
        page.measured()
    with ui.element("div").classes("gm-wide gm-follow"):
        page.proposal()
    with widgets.panel(text("correct.decision"), wide=True):
        page.decision()


class _CorrectPage:
    """The page of one browser; all that it shows is of the server."""

    def __init__(self, shared: Shared, text: Text) -> None:
        self.shared, self.text, self.desk = shared, text, shared.desk
        self.names = blocks.flank_names(text)

    def key(self) -> Hashable:
        """Run and settings of the correction that is asked for; None where there is no run."""
        run = self.desk.shown_run()
        return None if run is None else (run, self.desk.which)

    def no_run(self) -> str:
        """That there is nothing to correct, where there is not."""
        return "" if self.key() is not None else self.text("blocks.no_run")

    def wanted(self) -> Hashable:
        """The same, once somebody has asked."""
        return self.key() if self.desk.wanted.get("correct") == self.key() else None

    def options(self) -> None:
        """Which settings may change, and the button."""
        text, desk = self.text, self.desk

        def choose(which: str) -> None:
            desk.which = which

        kinds = {which: text(f"correct.{which}") for which in WHICH}
        blocks.follow(lambda: desk.which, lambda: widgets.choice(text("correct.which"), kinds, desk.which, choose))

        def begin() -> None:
            desk.of("correct").forget()
            desk.wanted["correct"] = self.key()

        with acting.buttons() as button:
            button(self.no_run, text("correct.compute"), begin, "tune", primary=True)

    def measured(self) -> None:
        """The run before any correction."""
        desk, text = self.desk, self.text

        def compute() -> Callable[[Progress], _Measured]:
            run = desk.shown_run()
            assert run is not None  # without a run nothing is computed
            return lambda progress: _measured(desk, run, progress)

        def show(found: _Measured) -> None:
            blocks.follow(self.wanted, lambda: self._before(found) if self.wanted() is None else None)

        found = desk.of("correct.measured")
        blocks.kept(text, found, desk.shown_run, text("correct.judging"), compute, show)

    def _before(self, found: _Measured) -> None:
        with widgets.panel(self.text("correct.measured"), wide=True), ui.element("div").classes("gm-charts"):
            for flank, svg in found.charts.items():
                blocks.chart(self.text, svg, f"{self.names[flank]}, {self.text('correct.before')}")

    def proposal(self) -> None:
        """Before and after at one scale, what changes, what remains, and what holds it back."""
        desk, text = self.desk, self.text

        def compute() -> Callable[[Progress], tuple[Proposal, dict[str, tuple[str, str]]]]:
            run, which = desk.shown_run(), desk.which
            assert run is not None  # without a run nothing is computed
            return lambda progress: _proposed(desk, run, which, progress)

        blocks.kept(text, desk.of("correct"), self.wanted, text("correct.computing"), compute, self._proposal)

    def _proposal(self, found: tuple[Proposal, dict[str, tuple[str, str]]]) -> None:
        text, (proposal, charts) = self.text, found
        with widgets.panel(text("correct.title"), wide=True):
            with ui.element("div").classes("gm-charts gm-pairs"):
                for flank, (before, after) in charts.items():
                    blocks.chart(text, before, f"{self.names[flank]}, {text('correct.before')}")
                    blocks.chart(text, after, f"{self.names[flank]}, {text('correct.after')}")
            self._limits(proposal)
            self._changes(proposal)
            for sentence in proposal.correction.remarks:
                widgets.note(text.quoted(sentence))

    def _limits(self, proposal: Proposal) -> None:
        """RMS measured, expected and at best, and what binds."""
        text, rows = self.text, []
        for fit in proposal.values["fits"]:
            flanks = self._flanks(fit["flanks"])
            numbers = (fit["rms_um"], fit["remaining_rms_um"], fit["reachable_rms_um"])
            binds = ", ".join(
                text(f"gear.{name}") if text.has(f"gear.{name}") else name for name in fit["held_back_by"]
            )
            state = binds or text("correct.nothing_binds")
            rows.append([flanks, *(f"{number:z.2f}" for number in numbers), state])
            if not fit["converged"]:
                widgets.Message(f"{flanks}: {text('correct.not_converged')}", "warning")
        head = [f"{text(f'correct.{key}')} / µm" for key in ("rms", "expected", "reachable")]
        blocks.plain_table(text("correct.limits"), [text("correct.flank"), *head, text("correct.binds")], rows)
        for flank, (toe, heel) in proposal.values["root_line_um"].items():
            widgets.note(text("correct.root", flank=self.names[flank], toe=f"{toe:+z.1f}", heel=f"{heel:+z.1f}"))

    def _changes(self, proposal: Proposal) -> None:
        text, changes = self.text, proposal.values["changes"]
        if not changes:
            widgets.Message(text("correct.nothing"), "info")
            return
        rows = []
        for one in changes:
            name = blocks.setting_name(text, one["setting"])
            unit = one["unit"].replace("deg", "°")
            numbers = (f"{one['old']:z.6f}", f"{one['new']:z.6f}", f"{one['new'] - one['old']:+z.6f}")
            rows.append([f"{name}, {self.names[one['flank']]}", *numbers, unit])
        head = [text(key) for key in ("gear.setting", "correct.old", "correct.new", "gear.change", "gear.unit")]
        blocks.plain_table(text("correct.changes"), head, rows)
        index = proposal.values["index_correction_deg"]
        if index:
            spread = f"{3600 * (max(index) - min(index)):z.1f}"
            widgets.note(text("correct.index", spread=spread))

    def _flanks(self, flanks: list[str]) -> str:
        return self.names[flanks[0]] if len(flanks) == 1 else self.names["both"]

    def decision(self) -> None:
        """Accept or reject, and what was decided before."""
        text, desk = self.text, self.desk
        work = self.shared.works["correct.accept"]

        def proposal() -> Proposal | None:
            kept = desk.of("correct")
            wanted = self.wanted()
            return kept.work.result[0] if wanted is not None and kept.has(wanted) else None

        def missing() -> str:
            if work.running:
                return text("correct.writing")
            return self.no_run() or ("" if proposal() is not None else text("correct.none"))

        def nothing() -> str:
            found = proposal()
            return text("correct.nothing_written") if found is not None and found.changes_nothing else ""

        def accepted() -> None:
            found = proposal()
            assert found is not None  # else something is missing
            desk.wanted["correct.accept"] = self.key()
            work.start(f"run {found.evaluated.run.id}", lambda progress: accept(desk.runs, found, self.shared.folder))

        def rejected() -> None:
            found = proposal()
            assert found is not None  # else something is missing
            reject(desk.runs, found, note.value or "")
            desk.wanted.pop("correct", None)
            desk.decisions += 1
            widgets.say(text("correct.kept"), "good")

        note = ui.input(text("correct.note")).classes("gm-text").props("outlined dense counter")
        note.props["maxlength"] = NOTE
        with acting.buttons() as button:
            button(lambda: missing() or nothing(), text("correct.accept"), accepted, "check", primary=True)
            button(missing, text("correct.reject"), rejected, "close")

        def outcome() -> None:
            """What became of the correction that is shown, not of another one."""
            if desk.wanted.get("correct.accept") != self.key():
                return
            done = widgets.Message()

            def ended() -> None:
                if isinstance(work.result, Accepted):
                    made: Accepted = work.result
                    names = {"set": made.gear_set.name, "program": made.program.name, "blocks": made.blocks}
                    done.show(text("correct.written", **names), "good")
                    desk.decisions += 1
                else:
                    done.show("")

            widgets.progress(text, work, lambda: text("correct.writing"), ended)

        blocks.follow(lambda: desk.wanted.get("correct.accept") == self.key(), outcome)
        blocks.follow(lambda: (desk.shown_run(), desk.decisions), self._decided)

    def _decided(self) -> None:
        run = self.desk.shown_run()
        found = next((one for one in past_runs(self.desk.runs) if one.summary.run == run and one.decision), None)
        if found is not None:
            said = self.text(f"correct.was_{found.decision}")
            words = ", ".join(part for part in (found.note, *found.files) if part)
            widgets.note(f"{said}: {words}" if words else said)


def _measured(desk: Desk, run: int, progress: Progress) -> _Measured:
    evaluated = desk.runs.evaluated(run, progress)
    kept: dict[tuple[str, float], str] = {}
    return _Measured(evaluated, charts_before(evaluated, scale_before(evaluated), kept), kept)


def _proposed(desk: Desk, run: int, which: str, progress: Progress) -> tuple[Proposal, dict[str, tuple[str, str]]]:
    found = propose(desk.runs.evaluated(run, progress), which)
    measured = desk.of("correct.measured").work.result
    same = isinstance(measured, _Measured) and measured.evaluated.run.id == run
    return found, found.charts(measured.kept if same else {})

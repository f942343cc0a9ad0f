"""Page gear: set, member and machine; settings with unit and limits; flanks in space, and how the pair runs."""

from __future__ import annotations

import functools
from collections.abc import Callable, Hashable
from pathlib import Path
from typing import Any

from nicegui import ui

from gearmath.arguments.known import MOST_MM
from gearmath.errors import InputError
from gearmath.front.contact import Contact, contact
from gearmath.front.measured import Measurement
from gearmath.front.sets import GearSet
from gearmath.hmi import blocks, widgets
from gearmath.hmi.catalog import files_of
from gearmath.hmi.correcting import free_file
from gearmath.hmi.desk import SOURCES, Desk, Draft, draft
from gearmath.hmi.drawing import drawn
from gearmath.hmi.flank_view import flat_figures, space_figure
from gearmath.hmi.gear_settings import DECIMALS, Place, SettingField, save_edited, setting_fields
from gearmath.hmi.messages import Text
from gearmath.hmi.state import Shared
from gearmath.hmi.work import Progress
from gearmath.specs.bevel_set import MEMBERS, Blank
from gearmath.specs.sheet import unit_of
from gearmath.specs.toml import find


def build(shared: Shared, text: Text) -> None:
    """The content of the page."""
    page = _GearPage(shared, text)
    with widgets.panel(text("gear.choice")):
        blocks.follow(lambda: shared.choice, page.choices)
    with widgets.panel(text("gear.blank")):
        page.kept(page.blank)
    with widgets.panel(text("gear.settings"), wide=True):
        page.settings()
    with widgets.panel(text("gear.flanks"), wide=True):
        page.flanks()
    with widgets.panel(text("gear.contact"), wide=True):
        page.contact()


class _GearPage:
    """The page of one browser; all that it shows is of the server."""

    def __init__(self, shared: Shared, text: Text) -> None:
        self.shared, self.text, self.desk = shared, text, shared.desk
        self.names = blocks.flank_names(text)
        self.look = ""
        """How flanks are drawn, space or flat; nothing until the browser has said what it can."""
        self.mine: dict[Place, float] = {}
        """What this page has typed, or has shown as typed."""
        self.fields: dict[Place, widgets.NumberField] = {}
        self.plot: ui.plotly | None = None

    # what is computed

    def key(self) -> Hashable:
        """By what a draft is known: the file as it is, the member, what was typed and what is shown."""
        choice, desk = self.shared.choice, self.desk
        run = desk.shown_run() if desk.source == "run" else None
        typed = tuple(desk.typed.items())
        return choice.gear_set, _changed_at(choice.gear_set), choice.member, typed, desk.source, run

    def compute(self) -> Callable[[Progress], Draft]:
        """The draft of the settings that are typed."""
        choice, desk = self.shared.choice, self.desk
        typed, run = dict(desk.typed), desk.shown_run() if desk.source == "run" else None
        return lambda progress: draft(find(choice.gear_set), choice.member, typed, desk.runs, run)

    def kept(self, draw: Callable[[Draft], object]) -> None:
        """A part that shows the draft."""
        text = self.text
        blocks.kept(text, self.desk.of("gear.draft"), self.key, text("gear.judging"), self.compute, draw)

    def without(self) -> str:
        """Which settings are refused, and are not in what is shown."""
        return blocks.refused(self.text, self.fields.values(), "gear.without")

    def no_run(self) -> str:
        """That there is no run to show, where one is asked for."""
        is_there = self.desk.source != "run" or self.desk.shown_run() is not None
        return "" if is_there else self.text("blocks.no_run")

    # what is shown

    def choices(self) -> None:
        """Set, member, machine and probe. What was typed belongs to the member, and goes with it."""
        text, shared = self.text, self.shared
        for kind in ("gear_set", "machine", "calibration"):
            options = files_of(kind, shared.folder)
            value = getattr(shared.choice, kind)
            options = options if value in options else {value: Path(value).name, **options}
            widgets.choice(text(f"gear.{kind}"), options, value, lambda name, kind=kind: self._choose(**{kind: name}))  # type: ignore[misc]
            if kind == "gear_set":
                members = {name: text(f"blocks.{name}") for name in MEMBERS}
                chosen = shared.choice.member
                widgets.choice(text("gear.member"), members, chosen, lambda name: self._choose(member=name))
        widgets.note(text("gear.bundled"))

    def blank(self, found: Draft) -> None:
        """What the set is, and the blank of the member."""
        text, spec = self.text, found.member.spec
        ui.label(found.member.gear_set.title).classes("gm-value gm-start")
        blocks.facts([(text("gear.teeth"), str(spec.teeth), ""), (text("gear.hand"), text(f"gear.{spec.hand}"), "")])
        method = f"{text(f'gear.{spec.process}')}, {text(f'gear.{spec.cutting}')}, {text(f'gear.{spec.generation}')}"
        blocks.facts([(text("gear.method"), method, "")])
        for key in Blank.model_fields:
            value = getattr(spec.blank, key)
            blocks.facts([(text(f"gear.{key}"), f"{value:z.4f}", "°" if unit_of(Blank, key) == "degree" else "mm")])

    def settings(self) -> None:
        """A field for each setting, then what is changed against the file."""
        fields = self.fields
        of_file: list[Hashable] = []

        def draw(found: Draft) -> None:
            own = (found.path, found.member.name, found.member.spec)
            # only then: a field that is drawn anew loses the cursor, and what is typed into it just now
            if of_file != [own]:
                of_file[:], self.mine = [own], self.desk.typed
                place.clear()
                fields.clear()
                with place:
                    self._fields(found, fields)
            before, self.mine = self.mine, self.desk.typed
            self._show(found, fields, {at for at in fields if before.get(at) != self.mine.get(at)})  # typed elsewhere
            for at, field in fields.items():
                if at in found.refused:
                    field.refuse(self.text.quoted(found.refused[at]))
            self._changes(found, lambda: discard(found))

        def discard(found: Draft) -> None:
            self.mine = self.desk.typed = {}
            self._show(found, fields, set(fields))

        place = ui.element("div").classes("gm-follow")
        blocks.marked(self.without)
        self.kept(draw)

    def _fields(self, found: Draft, fields: dict[Place, widgets.NumberField]) -> None:
        text = self.text
        with ui.element("div").classes("gm-settings"):
            for one in setting_fields(found.member):
                label = f"{text(f'gear.{one.key}')}, {self.names[one.flanks[0] if len(one.flanks) == 1 else 'both']}"
                shown = self.desk.typed.get(one.place, one.value)
                fields[one.place] = widgets.NumberField(
                    text, label, shown, one.unit, one.low, one.high, self._typed(one), DECIMALS
                )

    def _show(self, found: Draft, fields: dict[Place, widgets.NumberField], places: set[Place]) -> None:
        """In these fields the values that hold now."""
        for one in setting_fields(found.member):
            if one.place in places:
                fields[one.place].show(self.desk.typed.get(one.place, one.value))

    def _typed(self, one: SettingField) -> Callable[[float], None]:
        def typed(value: float) -> None:
            others = {place: old for place, old in self.desk.typed.items() if place != one.place}
            is_new = round(value - one.value, DECIMALS) != 0
            self.mine = self.desk.typed = {**others, one.place: value} if is_new else others

        return typed

    def _changes(self, found: Draft, discard: Callable[[], None]) -> None:
        """What was typed against the file, and what may be done with it; a refused field says why itself."""
        text = self.text
        if not found.accepted:
            if not found.refused:
                widgets.note(text("gear.unchanged"))
        else:
            in_file = {one.place: one for one in setting_fields(found.member)}
            rows = [
                [
                    self._name(place),
                    f"{in_file[place].value:z.{DECIMALS}f}",
                    f"{value:z.{DECIMALS}f}",
                    f"{value - in_file[place].value:+z.{DECIMALS}f}",
                    in_file[place].unit,
                ]
                for place, value in found.accepted.items()
            ]
            head = [text(f"gear.{key}") for key in ("setting", "in_file", "now", "change", "unit")]
            blocks.plain_table(text("gear.changed"), head, rows)

        def missing() -> str:
            return self.without() or ("" if self.desk.typed else text("gear.unchanged"))

        with blocks.buttons() as button:
            if found.accepted:
                button(missing, text("gear.save"), lambda: self._save(found), "save", primary=True)
            if self.desk.typed:
                button(str, text("gear.discard"), discard, "undo")

    def _name(self, place: Place) -> str:
        flanks, key = place
        return f"{self.text(f'gear.{key}')}, {self.names[flanks[0] if len(flanks) == 1 else 'both']}"

    def _save(self, found: Draft) -> None:
        target = free_file(self.shared.folder, f"{found.path.stem}_{found.member.name}", ".toml")
        save_edited(found.path, target, found.member, found.edited)
        self._choose(gear_set=str(target))
        widgets.say(self.text("gear.saved", name=target.name), "good")

    def _choose(self, **changes: str) -> None:
        if any(getattr(self.shared.choice, key) != value for key, value in changes.items()):
            if {"gear_set", "member"} & changes.keys():
                self.desk.typed = {}
            self.shared.choose(**changes)

    def flanks(self) -> None:
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
            blocks.run_choice(self.shared, text)
            look = widgets.choice(text("gear.look"), kinds, "space", draw_as)
        blocks.marked(lambda: self.no_run() or self.without())
        words = widgets.note("")
        no_webgl = widgets.Message()
        drawing = ui.element("div").classes("gm-follow")
        seen: list[Draft] = []

        def show(found: Draft, anew: bool = False) -> None:
            seen[:], words.text = [found], self._words(found)
            if self.plot is not None and found.view is not None and not anew and not self.no_run():
                self.plot.update_figure(self._space(found))  # the operator has turned it
                return
            self.plot = None
            drawing.clear()
            with drawing:
                self._flanks(found)

        self.kept(show)

        def answered(there: bool) -> None:
            if not there:
                no_webgl.show(text("gear.no_webgl"))
                look.value = "flat"  # which draws
            elif not self.look:
                draw_as("space")

        blocks.has_webgl(answered)

    def _flanks(self, found: Draft) -> None:
        text, view = self.text, found.view
        if self.no_run():
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
        if found.view is None or self.no_run():
            return ""
        member, largest = self.text(f"blocks.{found.member.name}"), f"{found.view.largest_um:z.1f}"
        if float(largest) == 0.0:
            return self.text("gear.no_deviation", member=member)
        return self.text("gear.view", member=member, largest=largest, times=f"{found.view.times:g}")

    def contact(self) -> None:
        """Pattern and transmission error of the pair: of the settings as they are typed, or of the run."""
        text, desk = self.text, self.desk

        fields: dict[str, widgets.NumberField] = {}

        def of_now() -> Hashable:
            return self.key(), desk.assembly

        def missing() -> str:
            return self.no_run() or self.without() or blocks.refused(text, fields.values())

        def begin() -> None:
            desk.wanted["contact"] = of_now()

        def key() -> Hashable:
            now, is_there = of_now(), desk.of("gear.draft").has(self.key()) and not missing()
            return now if desk.wanted.get("contact") == now and is_there else None

        def compute() -> Callable[[Progress], Any]:
            found: Draft = desk.of("gear.draft").work.result
            run = desk.shown_run() if desk.source == "run" else None
            assembly = desk.assembly
            return lambda progress: _run(found, desk, run, assembly)

        widgets.note(text("gear.contact_of"))
        self._assembly(fields)
        widgets.note(text("gear.nominal"))
        with blocks.buttons() as button:
            button(missing, text("gear.compute"), begin, "play_arrow", primary=True)
        blocks.kept(
            text,
            desk.of("gear.contact"),
            key,
            text("gear.contact"),
            compute,
            self._contact,
            text("gear.no_contact"),
        )

    def _assembly(self, fields: dict[str, widgets.NumberField]) -> None:
        """V, H and J; drawn anew only when another page has typed, for a field that is drawn anew loses the cursor."""
        text, desk = self.text, self.desk
        mine, others = [desk.assembly], [0]

        def typed(k: int, value: float) -> None:
            v, h, j = (value if i == k else old for i, old in enumerate(desk.assembly))
            mine[0] = desk.assembly = (v, h, j)

        def by_others() -> int:
            if mine[0] != desk.assembly:
                mine[0], others[0] = desk.assembly, others[0] + 1
            return others[0]

        def draw() -> None:
            with widgets.fields():
                for k, name in enumerate(("v", "h", "j")):
                    changed = functools.partial(typed, k)
                    fields[name] = widgets.NumberField(
                        text, text(f"gear.{name}"), desk.assembly[k], "mm", -MOST_MM, MOST_MM, changed
                    )

        blocks.follow(by_others, draw)

    def _contact(self, found: tuple[Contact, str]) -> None:
        text, (runs, svg) = self.text, found
        rows, words = [], blocks.words_of_charts(text)
        for side, one in runs.to_dict(step=15.0).items():
            numbers = (one["contact_ratio"], one["peak_to_peak_arcsec"], 100 * one["pattern"]["share"])
            shown = ("–" if value is None else f"{value:z.2f}" for value in numbers)
            rows.append([text(f"gear.{side}"), *shown, words.get(one["outcome"], one["outcome"])])
        head = [text("gear.side"), f"{text('gear.ratio')} / 1", f"{text('gear.error')} / {text('units.arcsec')}"]
        at = "V {:z.10g}, H {:z.10g}, J {:z.10g} mm".format(*self.desk.assembly)  # a field may hold what is refused
        blocks.plain_table(at, [*head, f"{text('gear.share')} / %", text("gear.outcome")], rows)
        blocks.chart(text, svg, text("gear.contact"), across=True)


def _run(found: Draft, desk: Desk, run: int | None, assembly: tuple[float, float, float]) -> tuple[Contact, str]:
    """The contact of the edited pair, or on the flanks that a run measured, at V, H, J [mm], and its picture."""
    v, h, j = assembly
    if run is None:
        made = contact(_whole(found.edited.gear_set), v=v, h=h, j=j)
    else:
        evaluated = desk.runs.evaluated(run)
        pair = GearSet(evaluated.gear_set)
        made = contact(_whole(pair), Measurement(pair.member(evaluated.name), evaluated.file), v=v, h=h, j=j)
    return made, drawn(made.plot)


def _whole(pair: GearSet) -> GearSet:
    if len(pair.spec.members) < len(MEMBERS):
        raise InputError(f"{pair.title}: holds one member only; contact needs the pair")
    return pair


def _changed_at(name: str) -> int:
    """When a file was written last; 0 where it is not there."""
    try:
        return find(name).stat().st_mtime_ns
    except (InputError, OSError):
        return 0

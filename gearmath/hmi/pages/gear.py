"""Page gear: set, member and machine; settings with unit and limits; flanks in space, and how the pair runs."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from pathlib import Path

from nicegui import ui

from gearmath.hmi import acting, blocks, widgets
from gearmath.hmi.catalog import check, files_of, unreadable
from gearmath.hmi.correcting import free_file
from gearmath.hmi.desk import Draft
from gearmath.hmi.gear_contact import GearContact
from gearmath.hmi.gear_draft import GearDraft
from gearmath.hmi.gear_flanks import GearFlanks
from gearmath.hmi.gear_settings import DECIMALS, Place, SettingField, save_edited, setting_fields
from gearmath.hmi.messages import Text
from gearmath.hmi.number_field import NumberField
from gearmath.hmi.state import Shared
from gearmath.specs.bevel_set import MEMBERS, Blank
from gearmath.specs.sheet import unit_of


def build(shared: Shared, text: Text) -> None:
    """The content of the page."""
    page = _GearPage(GearDraft(shared, text))
    with widgets.panel(text("gear.choice")):
        blocks.follow(lambda: shared.choice, page.choices)
        blocks.marked(page.unsaved)
    with widgets.panel(text("gear.blank")):
        page.draft.kept(page.blank)
    with widgets.panel(text("gear.settings"), wide=True):
        page.settings()
    with widgets.panel(text("gear.flanks"), wide=True):
        GearFlanks(page.draft).show()
    with widgets.panel(text("gear.contact"), wide=True):
        GearContact(page.draft).show()


class _GearPage:
    """Choice and settings of one browser."""

    def __init__(self, draft: GearDraft) -> None:
        self.draft, self.fields = draft, draft.fields
        self.shared, self.text, self.desk, self.names = draft.shared, draft.text, draft.desk, draft.names
        self.mine: dict[Place, float] = {}
        """What this page has typed, or has shown as typed."""

    def choices(self) -> None:
        """Set, member, machine and probe. What was typed belongs to the member, and comes back with it."""
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
        for why in unreadable(shared.folder):
            widgets.Message(text("gear.unreadable", why=widgets.words_of(why)), "warning")

    def unsaved(self) -> str:
        """For which other members something was typed that is not saved, whoever chose another one."""
        typed = [key for key, values in self.shared.unsaved.items() if values]
        names = (f"{Path(gear_set).name}, {self.text(f'blocks.{member}')}" for gear_set, member in typed)
        return self.text("gear.unsaved", members="; ".join(names)) if typed else ""

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
        blocks.marked(self.draft.without)
        self.draft.kept(draw)

    def _fields(self, found: Draft, fields: dict[Place, NumberField]) -> None:
        text = self.text
        with ui.element("div").classes("gm-settings"):
            for one in setting_fields(found.member):
                label = f"{text(f'gear.{one.key}')}, {self.names[one.flanks[0] if len(one.flanks) == 1 else 'both']}"
                shown = self.desk.typed.get(one.place, one.value)
                fields[one.place] = NumberField(text, label, shown, one.unit, one.limits, self._typed(one), DECIMALS)

    def _show(self, found: Draft, fields: dict[Place, NumberField], places: set[Place]) -> None:
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
            return self.draft.without() or ("" if self.desk.typed else text("gear.unchanged"))

        with acting.buttons() as button:
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
        self.desk.typed = {}
        self._choose(gear_set=str(target))
        widgets.say(self.text("gear.saved", name=target.name), "good")

    def _choose(self, **changes: str) -> None:
        if any(getattr(self.shared.choice, key) != value for key, value in changes.items()):
            for kind in ("gear_set", "machine", "calibration"):
                if kind in changes:
                    check(kind, changes[kind])
            self.shared.choose(**changes)

"""What the parts of page gear share: the draft of the settings that are typed, and why something is not in it."""

from __future__ import annotations

from collections.abc import Callable, Hashable

from gearmath.hmi import blocks
from gearmath.hmi.catalog import changed_at
from gearmath.hmi.desk import Draft, draft
from gearmath.hmi.gear_settings import Place
from gearmath.hmi.messages import Text
from gearmath.hmi.number_field import NumberField
from gearmath.hmi.state import Shared
from gearmath.hmi.work import Progress
from gearmath.specs.toml import find


class GearDraft:
    """The draft as the page of one browser sees it; all that it shows is of the server."""

    def __init__(self, shared: Shared, text: Text) -> None:
        self.shared, self.text, self.desk = shared, text, shared.desk
        self.names = blocks.flank_names(text)
        self.fields: dict[Place, NumberField] = {}
        """The settings of this page as they are typed."""

    def key(self) -> Hashable:
        """By what a draft is known: the file as it is, the member, what was typed and what is shown."""
        choice, desk = self.shared.choice, self.desk
        run = desk.shown_run() if desk.source == "run" else None
        typed = tuple(desk.typed.items())
        return choice.gear_set, changed_at(choice.gear_set), choice.member, typed, desk.source, run

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

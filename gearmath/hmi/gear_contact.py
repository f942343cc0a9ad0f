"""How the pair runs, on page gear: contact pattern and transmission error at the assembly that is typed."""

from __future__ import annotations

import functools
from collections.abc import Callable, Hashable
from typing import Any

from gearmath.arguments.known import MOST_MM
from gearmath.errors import InputError
from gearmath.front.contact import Contact, contact
from gearmath.front.measured import Measurement
from gearmath.front.sets import GearSet
from gearmath.hmi import acting, blocks, widgets
from gearmath.hmi.desk import Desk, Draft
from gearmath.hmi.drawing import drawn
from gearmath.hmi.gear_draft import GearDraft
from gearmath.hmi.number_field import NumberField
from gearmath.hmi.numbers import Limits
from gearmath.hmi.work import Progress
from gearmath.specs.bevel_set import MEMBERS


class GearContact:
    """The part of one browser."""

    def __init__(self, page: GearDraft) -> None:
        self.page, self.text, self.desk = page, page.text, page.desk

    def show(self) -> None:
        """Pattern and transmission error of the pair: of the settings as they are typed, or of the run."""
        text, desk = self.text, self.desk

        fields: dict[str, NumberField] = {}

        def of_now() -> Hashable:
            return self.page.key(), desk.assembly

        def missing() -> str:
            return self.page.no_run() or self.page.without() or blocks.refused(text, fields.values())

        def begin() -> None:
            desk.wanted["contact"] = of_now()

        def key() -> Hashable:
            now, is_there = of_now(), desk.of("gear.draft").has(self.page.key()) and not missing()
            return now if desk.wanted.get("contact") == now and is_there else None

        def compute() -> Callable[[Progress], Any]:
            found: Draft = desk.of("gear.draft").work.result
            run = desk.shown_run() if desk.source == "run" else None
            assembly = desk.assembly
            return lambda progress: _run(found, desk, run, assembly)

        widgets.note(text("gear.contact_of"))
        self._assembly(fields)
        widgets.note(text("gear.nominal"))
        with acting.buttons() as button:
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

    def _assembly(self, fields: dict[str, NumberField]) -> None:
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
                    fields[name] = NumberField(
                        text, text(f"gear.{name}"), desk.assembly[k], "mm", Limits(-MOST_MM, MOST_MM), changed
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

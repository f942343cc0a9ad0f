"""A page as the server builds it, without a browser: what it would look at again and again is looked at when asked."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import pytest
from nicegui import Client, ui
from nicegui.page import page

from gearmath.hmi.messages import Text
from gearmath.hmi.number_field import NumberField
from gearmath.hmi.state import Shared


@dataclass
class Built:
    """A page: its fields of numbers by label, and what it says."""

    shared: Shared
    client: Client
    looks: list[Any] = field(default_factory=list)
    made: list[NumberField] = field(default_factory=list)

    def look(self, wait: bool = True) -> None:
        """As after a while: all computations have ended, and every part has seen it. Without ``wait``: at once."""
        for _ in range(4 if wait else 1):
            for kept in [*self.shared.desk.kept.values()]:
                kept.work.wait(60 if wait else 0)
            with self.client:
                for one in [one for one in self.looks if not one.is_deleted]:
                    one.callback()

    @property
    def fields(self) -> dict[str, NumberField]:
        """Those that are on the page now."""
        return {one.label: one for one in self.made if not one.field.is_deleted}

    def select(self, label: str) -> Any:
        """A list to choose from, by its label."""
        (found,) = [
            one for one in self.client.elements.values() if isinstance(one, ui.select) and one.props["label"] == label
        ]
        return found

    def over(self) -> list[str]:
        """What is said over the page."""
        return [one.message for one in self.client.elements.values() if isinstance(one, ui.notification)]

    def dismiss(self) -> None:
        """As when somebody has read it."""
        for one in [one for one in self.client.elements.values() if isinstance(one, ui.notification)]:
            one.delete()

    def says(self) -> list[str]:
        """All words that are shown."""
        found = (one for one in self.client.elements.values() if isinstance(one, ui.label))
        return [one.text for one in found if one.text and _is_shown(one)]


def _is_shown(one: Any) -> bool:
    while one is not None:
        if not one.visible:
            return False
        one = one.parent_slot.parent if one.parent_slot else None
    return True


@pytest.fixture
def build(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Built]]:
    """``build(shared, name, language="en", wait=True)``: a page by its name."""
    now: list[Built] = []

    class Timer(ui.element):
        def __init__(self, seconds: float, callback: Callable[[], Any], once: bool = False) -> None:
            super().__init__()
            self.callback = callback
            if not once:  # what is asked of a browser is not
                now[-1].looks.append(self)

    begin = NumberField.__init__

    def init(self: NumberField, *args: Any, **options: Any) -> None:
        begin(self, *args, **options)
        now[-1].made.append(self)

    monkeypatch.setattr(ui, "timer", Timer)
    monkeypatch.setattr(NumberField, "__init__", init)

    def start(shared: Shared, name: str, language: str = "en", wait: bool = True) -> Built:
        now.append(Built(shared, Client(page(f"/{name}"))))
        with now[-1].client:
            importlib.import_module(f"gearmath.hmi.pages.{name}").build(shared, Text(language))
        now[-1].look(wait)
        return now[-1]

    yield start
    for one in now:
        one.client.delete()

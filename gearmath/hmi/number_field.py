"""A field of a number with its unit and limits: what is out of range is refused with the reason, and never changed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from nicegui import ui

from gearmath.hmi.messages import Text
from gearmath.hmi.numbers import Limits, parsed
from gearmath.hmi.widgets import Refusal


class NumberField:
    """A number with unit and limits, a whole one where ``digits`` is 0. What is out of range stays as it was typed and
    is refused with the reason.

    ``value`` is the accepted number, None while what stands in the field is refused. ``changed`` hears of each
    accepted one, when the field is left or Enter is pressed; an ``optional`` field may be left empty, which is None.
    """

    def __init__(
        self,
        text: Text,
        label: str,
        value: float | None,
        unit: str,
        limits: Limits,
        changed: Callable[[Any], object] = lambda value: None,
        digits: int = 6,
        optional: bool = False,
    ) -> None:
        self._text, self._unit, self.limits = text, unit, limits
        self._changed, self._digits, self._optional = changed, digits, optional
        self.label = label
        typed = "" if value is None else self._words(value)
        self.field = ui.input(label, value=typed, validation=self._refusal).classes("gm-number")
        self.field.props('outlined dense hide-bottom-space inputmode="decimal" autocomplete="off"')
        self.field.props["suffix"] = unit
        self._hint()
        self.value, self._why = self._parsed(typed)
        self.field.on("change", lambda: self._leave())

    def limit(self, limits: Limits) -> None:
        """Other limits, by which what stands in the field is judged anew; ``changed`` hears of what counts only now."""
        if limits == self.limits:
            return
        was_refused, self.limits = self.is_refused, limits
        self._hint()
        self.field.validate()
        if was_refused:
            self._leave()

    def _hint(self) -> None:
        self.field.props["hint"] = self.limits.hint(self._text, self._unit)

    def show(self, value: float) -> None:
        """Another number than was typed; nothing where it stands there already."""
        if self.value != value:
            self.field.value = self._words(value)
            self.value = value

    def _words(self, value: float) -> str:
        return f"{value:z.{self._digits}f}".rstrip("0").rstrip(".") if self._digits else f"{value:z.0f}"

    def refuse(self, why: str) -> None:
        """Show a reason that is known only when the whole is judged."""
        self.value, self._why, self.field.error = None, why, why

    @property
    def is_refused(self) -> bool:
        """Whether what stands in the field does not count."""
        return self._why is not None

    def _parsed(self, typed: str | None) -> tuple[float | None, str | None]:
        if self._optional and not (typed or "").strip():
            return None, None
        return parsed(self._text, typed or "", self.limits, self._unit, not self._digits)

    def _refusal(self, typed: str | None) -> str | None:
        self.value, self._why = self._parsed(typed)
        return self._why

    def _leave(self) -> None:
        if not self.is_refused:
            self._changed(self.value)


def numbers(fields: Mapping[str, NumberField]) -> dict[str, float]:
    """The values of fields by name. Raises InputError naming the first that is refused."""
    found = {}
    for name, one in fields.items():
        if one.value is None:
            one.field.validate()
            raise Refusal(f"{one.field.props['label']}: {one.field.error}")
        found[name] = one.value
    return found

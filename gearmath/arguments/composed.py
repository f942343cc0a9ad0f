"""Kinds of arguments that are made of others: one of several, lists, tables, columns, pairs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from gearmath.arguments.kinds import Kind, Number, Plain, stated


@dataclass(frozen=True)
class Either:
    """Whatever one of several kinds can be; ``words`` say it of all."""

    kinds: tuple[Kind, ...]
    words: str

    def refusal(self, name: str, value: object) -> str | None:
        if any(kind.refusal(name, value) is None for kind in self.kinds):
            return None
        return stated(name, value, self.words)


@dataclass(frozen=True)
class Each:
    """A list or tuple, of so many at least, each of a kind, and where asked none twice."""

    kind: Kind
    words: str
    least: int = 0
    once: bool = False

    def refusal(self, name: str, value: object) -> str | None:
        items = _items(value)
        if items is None or len(items) < self.least:
            return stated(name, value, self.words)
        refused = (self.kind.refusal(name, item) for item in items)
        for why in filter(None, refused):
            return why.replace(f"{name} = ", f"{name}: ", 1)
        twice = next((item for k, item in enumerate(items) if self.once and item in items[:k]), None)
        return None if twice is None else f"{name}: {twice} stands there twice"


def _items(value: Any) -> Sequence[object] | None:
    """What a list, a tuple or an array holds; None for what is none, as a text is."""
    listed = isinstance(value, Sequence) or getattr(value, "ndim", 0) > 0
    return list(value) if listed and not isinstance(value, str | bytes) else None


@dataclass(frozen=True)
class Keyed(Plain):
    """A table by keys, of so many at least; keys and values are of their kinds where these are given."""

    words: str
    key: Kind | None = None
    value: Kind | None = None
    least: int = 0

    def fits(self, value: Any) -> bool:
        if not isinstance(value, Mapping) or len(value) < self.least:
            return False
        pairs = ((self.key, value), (self.value, value.values()))
        return all(kind is None or kind.refusal("", one) is None for kind, ones in pairs for one in ones)


@dataclass(frozen=True)
class Columns(Plain):
    """So many columns of numbers, all equally long and not empty."""

    count: int
    words: str

    def fits(self, value: Any) -> bool:
        if not isinstance(value, Sequence) or len(value) != self.count:
            return False
        if any(Each(Number(), "", 1).refusal("", column) for column in value):
            return False
        return len({len(column) for column in value}) == 1


@dataclass(frozen=True)
class Pair(Plain):
    """Two values, each of its kind."""

    first: Kind
    second: Kind
    words: str

    def fits(self, value: Any) -> bool:
        kinds = self.first, self.second
        if not isinstance(value, tuple) or len(value) != len(kinds):
            return False
        return all(kind.refusal("", one) is None for kind, one in zip(kinds, value, strict=True))

"""Results that are kept for the next call with the same arguments, which nobody can change from outside."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import fields, is_dataclass
from functools import lru_cache, wraps
from typing import Any, ParamSpec, TypeVar

import numpy as np

P = ParamSpec("P")
R = TypeVar("R")


def remembered(most: int) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Keep so many results, as :func:`functools.lru_cache`; the arrays within them can be read only.

    All who ask for a result get the same one: what one of them wrote into it would be everybody's.
    """

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        @lru_cache(maxsize=most)
        def made(*arguments: Hashable, **options: Hashable) -> Any:
            found: Any = function(*arguments, **options)  # type: ignore[arg-type]
            _lock(found)
            return found

        @wraps(function)
        def asked(*arguments: P.args, **options: P.kwargs) -> R:
            return made(*arguments, **options)  # type: ignore[no-any-return, arg-type]

        return asked

    return decorate


def _lock(value: Any) -> None:
    """Make the arrays of records, tables and lists read-only."""
    if isinstance(value, np.ndarray):
        value.flags.writeable = False
    elif is_dataclass(value) and not isinstance(value, type):
        for one in fields(value):
            _lock(getattr(value, one.name))
    elif isinstance(value, Mapping | tuple | list):
        for part in value.values() if isinstance(value, Mapping) else value:
            _lock(part)

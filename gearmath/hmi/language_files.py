"""The files with what the page says: ``messages.toml`` in both languages, ``reasons.toml`` from English to German."""

from __future__ import annotations

import functools
import tomllib
from importlib import resources
from typing import Any


@functools.cache
def language_file(name: str) -> dict[str, Any]:
    """The tables of one of them, read once."""
    return tomllib.loads(resources.files("gearmath.hmi").joinpath(name).read_text("utf-8"))

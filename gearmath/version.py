"""The version of the installed package."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as _installed


def version() -> str:
    """The version, or that there is none: a bare source tree."""
    try:
        return _installed("gearmath")
    except PackageNotFoundError:
        return "0+unknown"


__version__ = version()

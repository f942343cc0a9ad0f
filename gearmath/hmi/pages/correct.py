"""Page correct."""

from __future__ import annotations

from gearmath.hmi import widgets
from gearmath.hmi.messages import Text
from gearmath.hmi.state import Shared


def build(shared: Shared, text: Text) -> None:
    """The content of the page."""
    with widgets.panel(text("correct.title")):
        widgets.note(text("shell.empty"))

"""Questions that are answered once: a click that is sent again, or comes late, does nothing a second time."""

from __future__ import annotations

import secrets
import time

#: How long a question may be answered. [s]
_SECONDS = 60.0
_MOST = 200


class Tickets:
    """One-use permissions, each drawn when a question is shown."""

    def __init__(self, seconds: float = _SECONDS) -> None:
        self._seconds = seconds
        self._open: dict[str, float] = {}

    def draw(self) -> str:
        """A new one; the oldest go when there are too many."""
        ticket = secrets.token_hex(8)
        self._open[ticket] = time.monotonic() + self._seconds
        while len(self._open) > _MOST:
            self._open.pop(next(iter(self._open)))
        return ticket

    def take(self, ticket: str) -> bool:
        """Whether it is valid; it is not any more after this."""
        until = self._open.pop(ticket, None)
        return until is not None and time.monotonic() <= until

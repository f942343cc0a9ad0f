"""Whether the probe works: its signal must come and go again under the operator's hand before a run begins."""

from __future__ import annotations


class ProbeCheck:
    """``state`` is ask, deflected, done, or unknown where the control does not tell the signal.

    What was seen counts on after a silence: a busy control does not undo what the operator did.
    """

    def __init__(self) -> None:
        self.state = "unknown"
        self._was_free = self._came = False

    @property
    def is_done(self) -> bool:
        """Whether the signal came and went."""
        return self.state == "done"

    def begin(self) -> None:
        """From the beginning; whether the control tells the signal is known."""
        self._was_free = self._came = False
        if self.state != "unknown":
            self.state = "ask"

    def look(self, signal: bool | None) -> None:
        """What the control tells now; None where it does not."""
        if self.state == "done":
            return
        if signal is None:
            self.state = "unknown"
        elif signal:
            # a probe that signals from the beginning may be one that always does
            self._came = self._was_free
            self.state = "deflected" if self._came else "ask"
        elif self._came:
            self.state = "done"
        else:
            self.state, self._was_free = "ask", True

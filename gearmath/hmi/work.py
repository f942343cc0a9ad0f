"""Long computations of the server: any page shows them, no page owns them."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from typing import Any

from gearmath.errors import ComputationError, InputError

#: The sentence of a failure that has none of its own.
BROKEN = "the server failed at this: what happened is written in the window in which 'gearmath hmi' runs"


class _Cancelled(Exception):
    """The operator does not want the result any more."""


@dataclass
class Progress:
    """How far a computation is. It calls this with the steps that it has done, and sets ``total`` when it knows it."""

    total: int = 0
    done: int = 0
    cancelled: bool = False

    def begin(self, steps: int, unit: str) -> Progress:
        """A further part of the computation, of so many steps."""
        self.total += steps
        return self

    def __call__(self, steps: int = 1) -> None:
        self.done += steps
        if self.cancelled:
            raise _Cancelled


@dataclass
class Work:
    """One kind of long computation, one at a time, in a thread: what it is of, how far it is, and what came out.

    ``name`` is one that is the same in every language, such as that of a program, or nothing.

    ``result`` is what the last one returned, ``error`` the sentence of its failure; both None while it runs.
    """

    name: str = ""
    result: Any = None
    error: str | None = None
    running: bool = False
    asked: Hashable = None
    """What the last one was asked for: a page tells by it whether the outcome is that of its fields."""
    progress: Progress = field(default_factory=Progress)
    count: int = 0
    """Counts the computations that have ended: a page draws anew when it has changed."""
    _begin: float = 0.0
    _thread: threading.Thread | None = None

    def start(self, name: str, compute: Callable[[Progress], Any], asked: Hashable = None) -> None:
        """Begin. Raises InputError where one runs already."""
        if self.running:
            raise InputError(f"{self.name}: runs already")
        self.name, self.result, self.error, self.running, self.asked = name, None, None, True, asked
        self.progress, self._begin = Progress(), time.monotonic()
        self._thread = threading.Thread(target=self._run, args=(compute,), name=name, daemon=True)
        self._thread.start()

    def cancel(self) -> None:
        """End it at its next step; there is no result."""
        self.progress.cancelled = True

    def wait(self, seconds: float | None = None) -> None:
        """Until it has ended."""
        if self._thread is not None:
            self._thread.join(seconds)

    @property
    def seconds(self) -> float:
        """How long it runs [s]."""
        return time.monotonic() - self._begin

    @property
    def share(self) -> float | None:
        """The part that is done, 0 to 1; None where that is not known."""
        return min(1.0, self.progress.done / self.progress.total) if self.progress.total else None

    @property
    def remaining(self) -> float | None:
        """About how long it still takes [s]; None where that is not known."""
        share = self.share
        return self.seconds * (1.0 - share) / share if share and self.seconds > 1.0 else None

    def _run(self, compute: Callable[[Progress], Any]) -> None:
        try:
            self.result = compute(self.progress)
        except (InputError, ComputationError) as error:
            self.error = str(error)
        except _Cancelled:
            pass
        except Exception:  # it goes on to the log of the server
            self.error = BROKEN
            raise
        finally:
            self.running = False
            self.count += 1

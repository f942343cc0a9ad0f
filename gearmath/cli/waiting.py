"""A sign of life on a terminal from the first moment on: what runs, and for how long, where no progress bar shows."""

from __future__ import annotations

import io
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TextIO

#: How often the line is written anew, and how long the mark takes from one end to the other [s].
_EVERY, _SWEEP = 0.2, 2.0
_WIDTH = 20
_CLEAR = "\r\x1b[K"


class _Waiting:
    """The line on ``stream``, written by a thread of its own; ``lock`` keeps other output from running into it."""

    def __init__(self, name: str, stream: TextIO) -> None:
        self.name, self.stream, self.begin = name, stream, time.monotonic()
        self.ended, self.hidden, self.lock = threading.Event(), False, threading.Lock()
        self.thread = threading.Thread(target=self._run, daemon=True)
        self.thread.start()

    def _run(self) -> None:
        while not self.ended.wait(_EVERY):
            with self.lock:
                if not self.hidden:
                    seconds = time.monotonic() - self.begin
                    self.stream.write(f"\r{self.name} {_mark(seconds)} {seconds:.0f} s")
                    self.stream.flush()

    def clear(self) -> None:
        """Take the line away; with ``lock`` held."""
        if not self.hidden:
            self.stream.write(_CLEAR)
            self.stream.flush()


class _Output(io.TextIOBase):
    """Standard output as it is, before which the line is taken away."""

    def __init__(self, stream: TextIO, line: _Waiting) -> None:
        self.stream, self.line = stream, line

    def write(self, text: str) -> int:
        with self.line.lock:
            self.line.clear()
            count = self.stream.write(text)
            self.stream.flush()
        return count

    def flush(self) -> None:
        self.stream.flush()

    def isatty(self) -> bool:
        return self.stream.isatty()

    def fileno(self) -> int:
        return self.stream.fileno()

    @property
    def encoding(self) -> str:  # type: ignore[override]
        return self.stream.encoding


_current: _Waiting | None = None


def _mark(seconds: float) -> str:
    """A mark that goes to and fro between two walls."""
    part = seconds / _SWEEP % 2.0
    at = round((part if part <= 1.0 else 2.0 - part) * (_WIDTH - 3))
    return f"|{' ' * at}<=>{' ' * (_WIDTH - 3 - at)}|"


@contextmanager
def waiting(name: str) -> Iterator[None]:
    """Show on standard error, if it is a terminal, that ``name`` is at work."""
    global _current
    if not sys.stderr.isatty():
        yield
        return
    line, before = _Waiting(name, sys.stderr), sys.stdout
    _current, sys.stdout = line, _Output(before, line)
    try:
        yield
    finally:
        line.ended.set()
        line.thread.join()
        line.clear()
        sys.stdout, _current = before, None


@contextmanager
def hidden() -> Iterator[None]:
    """Without that line, while a progress bar tells more."""
    line = _current
    if line is None:
        yield
        return
    with line.lock:
        line.clear()
        line.hidden = True
    try:
        yield
    finally:
        line.hidden = False

"""Alarms of the control as the operator must see them: each once, with time and text, until it was seen and is gone."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from datetime import datetime
from pathlib import Path

from gearmath.control.interface import Alarm
from gearmath.errors import InputError
from gearmath.files import read_text, write_text

#: More are not kept; the oldest that were seen go first. A control that repeats itself must not fill the memory.
MOST = 500


@dataclass(frozen=True)
class AlarmEntry:
    """One alarm: when this server heard of it and when it was gone (ISO 8601, local time), and whether it was seen."""

    number: int
    key: str
    alarm: str
    text: str
    severity: int
    came: str
    gone: str = ""
    seen: bool = False


class AlarmBook:
    """The alarms of one control. A file keeps them over a restart of the server. Safe in threads."""

    def __init__(self, file: Path | None = None) -> None:
        self._file, self._lock = file, threading.Lock()
        self._entries = _kept(file) if file is not None and file.exists() else []
        # beside the entries: of a flood not all are kept, and none comes twice
        self._active = {one.key for one in self._entries if not one.gone}

    def entries(self) -> list[AlarmEntry]:
        """Those that are active or were not seen yet, the newest first."""
        with self._lock:
            return [one for one in reversed(self._entries) if not (one.seen and one.gone)]

    def unseen(self) -> int:
        """How many were not seen yet."""
        with self._lock:
            return sum(not one.seen for one in self._entries)

    def hear(self, active: Iterable[Alarm]) -> None:
        """What is active now: the new ones are added, those that are not named any more are gone."""
        now = {alarm.key: alarm for alarm in active}
        with self._lock:
            before, known = list(self._entries), self._active
            self._active = set(now)
            for k, one in enumerate(before):
                if not one.gone and one.key not in now:
                    self._entries[k] = replace(one, gone=_time())
            for key, alarm in now.items():
                if key not in known:
                    number = 1 + (self._entries[-1].number if self._entries else 0)
                    words = (alarm.number[:40], alarm.text[:300], alarm.severity)
                    self._entries.append(AlarmEntry(number, key, *words, _time()))
            if self._entries != before:
                self._shorten()
                self._keep()

    def see(self, numbers: Iterable[int]) -> None:
        """The operator has seen these entries, by their ``number``."""
        chosen = set(numbers)
        with self._lock:
            before = list(self._entries)
            self._entries = [replace(one, seen=True) if one.number in chosen else one for one in before]
            if self._entries != before:
                self._keep()

    def _shorten(self) -> None:
        while len(self._entries) > MOST:
            done = (k for k, one in enumerate(self._entries) if one.seen and one.gone)
            gone = (k for k, one in enumerate(self._entries) if one.gone)
            self._entries.pop(next(done, next(gone, 0)))

    def _keep(self) -> None:
        if self._file is not None:
            with suppress(InputError):  # a full disk must not end the watch over the control
                write_text(self._file, json.dumps([asdict(one) for one in self._entries], indent=1) + "\n")


def _kept(file: Path) -> list[AlarmEntry]:
    """What a file keeps; a damaged one keeps nothing."""
    try:
        return [AlarmEntry(**values) for values in json.loads(read_text(file))][-MOST:]
    except (InputError, ValueError, TypeError):
        return []


def _time() -> str:
    return datetime.now().astimezone().isoformat(timespec="seconds")

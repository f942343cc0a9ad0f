"""What a cutting program states in its header, for whoever has to judge it."""

from __future__ import annotations

import re
from dataclasses import dataclass

#: Any of these says that gearmath wrote the program: one that lost some of its lines is judged by the others.
_OURS = re.compile(
    r"^; (gearmath \S+ cutting program|machine settings sha256: |flank tolerance: .* along the tooth normal)",
    re.MULTILINE,
)
_DRY_RUN = re.compile(r"^; dry run: Z raised by ([0-9.]+) mm", re.MULTILINE)
_TOLERANCE = re.compile(r"^; flank tolerance: ([0-9.]+) um", re.MULTILINE)
_MEMBER = re.compile(r"^; member: (pinion|gear)\b", re.MULTILINE)
_FINISH = re.compile(r"^; finish: stock ([0-9.]+) mm", re.MULTILINE)
_SPACES = re.compile(r"^; spaces: ([0-9,]+)", re.MULTILINE)
_FEED = re.compile(r"^; feed: ([0-9.]+) mm/min at the tooth", re.MULTILINE)
_SPINDLE = re.compile(r"^; spindle: ([0-9.]+) rpm(?:.*plunge: ([0-9.]+) mm/min)?", re.MULTILINE)
#: What a program of ours must say: without it, less is judged.
_JUDGED_BY = {"flank tolerance": _TOLERANCE, "finish": _FINISH, "feed": _FEED, "spindle": _SPINDLE, "spaces": _SPACES}
#: What no program says twice; spaces may take several lines.
_SAID_ONCE = {
    "flank tolerance": _TOLERANCE,
    "finish": _FINISH,
    "feed": _FEED,
    "spindle": _SPINDLE,
    "member": _MEMBER,
    "dry run": _DRY_RUN,
}


@dataclass(frozen=True)
class Stated:
    """Header of a program: lengths in mm, feeds in mm/min, None for what it does not say."""

    tolerance: float | None
    """How far the flanks may deviate along their normals, whatever stock they keep."""
    stock: float
    """What stays on the finished flanks."""
    spaces: tuple[int, ...]
    feed: float | None
    plunge: float | None
    rpm: float | None
    is_ours: bool = False
    """Whether the header says that gearmath wrote it: then it looks at the control before it moves."""
    coolant: bool = False
    """Whether it must cut with coolant: it is ours, and no dry run."""
    raised: float = 0.0
    """How far above its cut a dry run stays."""
    unsaid: tuple[str, ...] = ()
    """What a program of ours is judged by, and does not say."""
    doubled: tuple[str, ...] = ()
    """What it says more than once: which of them holds, nobody knows."""

    @staticmethod
    def of(text: str) -> Stated:
        """Read the header of a program."""
        tolerance, finish = _TOLERANCE.search(text), _FINISH.search(text)
        feed, spindle, dry = _FEED.search(text), _SPINDLE.search(text), _DRY_RUN.search(text)
        ours = _OURS.search(text) is not None
        listed = {int(part) for line in _SPACES.findall(text) for part in line.split(",") if part}
        return Stated(
            float(tolerance[1]) / 1000 if tolerance else None,
            float(finish[1]) if finish else 0.0,
            tuple(sorted(listed)),
            float(feed[1]) if feed else None,
            float(spindle[2]) if spindle and spindle[2] else None,
            float(spindle[1]) if spindle else None,
            ours,
            ours and dry is None,
            float(dry[1]) if dry else 0.0,
            tuple(what for what, one in _JUDGED_BY.items() if ours and not one.search(text)),
            tuple(what for what, one in _SAID_ONCE.items() if len(one.findall(text)) > 1),
        )


def stated_tolerance(text: str) -> float | None:
    """The tolerance [mm] that a cutting program promises in its head; None if it leaves stock, or says nothing."""
    stated = Stated.of(text)
    return stated.tolerance if stated.stock == 0.0 and _FINISH.search(text) else None


def stated_member(text: str) -> str | None:
    """The member that a program says in its head it is for; None if it says nothing."""
    found = _MEMBER.search(text)
    return found[1] if found else None

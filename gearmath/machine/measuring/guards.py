"""What a probing or calibration program must not do with its probe: move it unwatched, blindly or too fast."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from gearmath.machine.control.state import PROBE_TOOL
from gearmath.machine.judging.faults import Fault
from gearmath.machine.judging.motion import blind_motion, states, travel
from gearmath.machine.measuring.ways import Watched, Way
from gearmath.machine.planning.targets import APPROACH_FEED, MEASURING_FEED, POSITIONING_FEED
from gearmath.specs.milling_machine import MillingMachine

#: Feeds and speeds may pass their limits by this part: decimals of the text. Positions are the same within mm or rad.
_SLACK, _SAME = 1e-3, 1e-6
#: Ways back along which the axes may go unwatched: those made last.
_BACK = 8


def guard_faults(seen: Watched, machine: MillingMachine, clear: float, free: float) -> Iterator[Fault]:
    """All of it for one run; ``clear`` is the Z [mm] that must be reached before all else, from ``free`` on nothing is
    in the way of the probe."""
    path = seen.run.path
    yield from states(path, machine)
    yield from blind_motion(path, clear)
    ends = path.axes.copy()
    ends[seen.measuring] = [way.end for way in seen.ways]
    yield from travel(replace(path, axes=ends), machine)
    for tool in path.tools:
        if tool != PROBE_TOOL:
            yield Fault(f'moves the tool "{tool}", the probe is "{PROBE_TOOL}"', kind="tool")
    yield from _asked(seen)
    yield from _unwatched(seen, free)
    yield from _feeds(seen, machine)


def _asked(seen: Watched) -> Iterator[Fault]:
    """Before every MEAS block the program asks whether the probe is deflected, where it stands then."""
    before = 0
    for row, way in zip(seen.measuring, seen.ways, strict=True):
        if way.looked == before or way.since:
            line = int(seen.run.path.line[row])
            yield Fault("measures without a look at $A_PROBE[1] right before it", line, "asked")
        before = way.looked


def _unwatched(seen: Watched, free: float) -> Iterator[Fault]:
    """Blocks without MEAS: straight up, above everything, or back along a way that was made with MEAS."""
    path, measuring = seen.run.path, seen.run.path.measuring
    done = -1
    for row in range(len(path.line)):
        done += bool(measuring[row])
        if measuring[row] or not row:
            continue
        first, last = path.axes[row - 1], path.axes[row]
        step = last - first
        if step[2] >= 0.0 and not (np.abs(np.delete(step, 2)) > _SAME).any():
            continue
        if min(first[2], last[2]) >= free - _SAME:
            continue
        back = seen.ways[max(done + 1 - _BACK, 0) : done + 1]
        if not path.rapid[row] and any(_along(way, first) and _along(way, last) for way in back):
            continue
        how = "in rapid" if path.rapid[row] else "without MEAS"
        yield Fault(f"moves {how} where the probe could meet something", int(path.line[row]), "unwatched")


def _along(way: Way, place: np.ndarray) -> bool:
    """Whether a position lies on the way that the probe has made."""
    step = (way.end if way.met is None else way.met) - way.start
    share = float(np.clip(step @ (place - way.start) / max(float(step @ step), 1e-30), 0.0, 1.0))
    return bool((np.abs(way.start + share * step - place) < _SAME).all())


def _feeds(seen: Watched, machine: MillingMachine) -> Iterator[Fault]:
    """Feeds [mm/min, a degree counts as a mm] of touches, of the way before them, and of all others; axis speeds."""
    path, touches = seen.run.path, set(seen.touches)
    number = -1
    for row in range(1, len(path.line)):
        number += bool(path.measuring[row])
        if path.rapid[row] or path.seconds[row] <= 0.0:
            continue
        if path.measuring[row]:
            first, last = seen.ways[number].start, seen.ways[number].end
            limit = POSITIONING_FEED
            if number in touches:
                limit = MEASURING_FEED
            elif number + 1 in touches:
                limit = APPROACH_FEED
        else:
            first, last, limit = path.axes[row - 1], path.axes[row], APPROACH_FEED
        step = np.abs(last - first)
        feed = 60.0 * float(np.linalg.norm([*step[:3], *np.degrees(step[3:])])) / path.seconds[row]
        line = int(path.line[row])
        if feed > limit * (1.0 + _SLACK):
            what = "touches" if number in touches and path.measuring[row] else "moves the probe"
            yield Fault(f"{what} at {feed:.0f} mm/min, at most {limit:g} are allowed", line, f"feed {limit:g}")
        if (step / path.seconds[row] > machine.max_speed * (1.0 + _SLACK)).any():
            yield Fault(f"moves an axis faster than {machine.name} can", line, "speed")

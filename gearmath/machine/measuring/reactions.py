"""What a probing or calibration program does where something goes wrong: tried at every MEAS block of its text.

The probe is deflected before it is moved; it meets something on a way on which it should meet nothing; it meets nothing
where it should. Each time the program must set an alarm and end, without a further MEAS block. A host that does not
answer must keep it waiting.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Mapping

import numpy as np

from gearmath.errors import InputError
from gearmath.machine.control.executor import run_program
from gearmath.machine.control.state import Probe, Setup
from gearmath.machine.judging.faults import Fault
from gearmath.machine.measuring.collision_check import enough_steps
from gearmath.machine.measuring.records import touch_lines
from gearmath.machine.measuring.ways import Watched, Way, acknowledged, replayed

#: Where a way ends that should not have met anything.
_EARLY = 0.4
#: How often a host lets the program ask, and the R parameter that says there is one.
_PATIENCE, _HOST = 5, 104


class _GoesOn(Exception):
    """The program makes a further MEAS block, or a host has lost its patience."""


def reaction_faults(
    text: str,
    name: str,
    seen: Watched,
    setup: Setup,
    given: Mapping[int, float],
    done: set[int],
    progress: Callable[[int], object] = lambda ways: None,
) -> Iterator[Fault]:
    """Where the program, with R parameters ``given``, goes on although it must not.

    Every line is tried once, but for those that were ``done`` before; ``progress`` hears of every way that is tried.
    """
    touches = set(seen.touches)
    for number, row in enumerate(seen.measuring.tolist()):
        line = int(seen.run.path.line[row])
        if line in done:
            continue
        done.add(line)
        again, before = replayed(seen.ways, -1, _missed), sum(k < number for k in touches)
        if _goes_on(text, name, setup, given, again, number, seen.ways[number].looked, before):
            yield Fault("is reached although the probe is deflected", line, "deflected")
        met, what = (_missed, "nothing is touched") if number in touches else (_early, "something is touched too early")
        if _goes_on(text, name, setup, given, replayed(seen.ways, number, met), number + 1, None, before):
            yield Fault(f"does not stop the program where {what}", line, "missed")
        progress(1)


def _early(way: Way) -> np.ndarray:
    return way.start + _EARLY * (way.end - way.start)


def _missed(way: Way) -> None:
    return None


def _goes_on(
    text: str,
    name: str,
    setup: Setup,
    given: Mapping[int, float],
    probe: Probe,
    last: int,
    deflected: int | None,
    written: int,
) -> bool:
    """Whether a program gets to the way of number ``last``, writes more touches than ``written``, or sets no alarm.

    The probe is ``deflected`` from that look at $A_PROBE on, counted from 1.
    """
    count = looked = 0

    def watch(start: np.ndarray, end: np.ndarray) -> np.ndarray | None:
        nonlocal count
        if count == last:
            raise _GoesOn
        count += 1
        return probe(start, end)

    def is_deflected(position: np.ndarray) -> bool:
        nonlocal looked
        looked += 1
        return deflected is not None and looked >= deflected

    try:
        run = run_program(text, name, watch, acknowledged, given, enough_steps(text), setup, deflected=is_deflected)
    except _GoesOn:
        return True
    except InputError:  # the control stops it
        return False
    return run.alarm is None or sum(len(touch_lines(content)) for content in run.files.values()) > written


def host_faults(text: str, name: str, seen: Watched, setup: Setup) -> Iterator[Fault]:
    """A host is asked after every touch, and where it does not answer the program waits."""
    asked: list[int] = []

    def waits(parameters: Mapping[int, float]) -> bool:
        return parameters.get(101, 0.0) != parameters.get(103, 0.0)

    def silent(parameters: Mapping[int, float]) -> dict[int, float]:
        if not waits(parameters):  # a dwell of another kind
            return {}
        if len(asked) == _PATIENCE:
            raise _GoesOn
        asked.append(int(parameters.get(101, 0.0)))
        return {}

    def answers(parameters: Mapping[int, float]) -> dict[int, float]:
        if not waits(parameters):
            return {}
        asked.append(int(parameters.get(101, 0.0)))
        return {103: parameters.get(101, 0.0)}

    def run(host: Callable[[Mapping[int, float]], dict[int, float]]) -> None:
        probe = replayed(seen.ways, -1, _missed)
        run_program(text, name, probe, host, {_HOST: 1.0}, enough_steps(text), setup)

    with contextlib.suppress(_GoesOn):
        run(silent)
    if asked != [1] * _PATIENCE:
        yield Fault("does not wait for a host that does not answer", kind="host")
        return
    asked.clear()
    run(answers)
    if asked != list(range(1, len(seen.touches) + 1)):
        yield Fault(f"does not offer every touch once to a host with R{_HOST}=1", kind="host")

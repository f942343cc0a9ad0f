"""The state of control and run in words of the operator's language."""

from __future__ import annotations

import re

from gearmath.hmi.link import ControlLink, View
from gearmath.hmi.measuring_task import MeasuringTask, RunState
from gearmath.hmi.messages import Text
from gearmath.hmi.state import Shared

_WORD = re.compile("[a-z]+")
_GOING_ON = {
    RunState.PREPARING,
    RunState.READY,
    RunState.RUNNING,
    RunState.INTERRUPTED,
    RunState.HOLDING,
    RunState.HELD,
    RunState.LOST,
}


def control_name(text: Text, shared: Shared) -> str:
    """What the control is called."""
    assert shared.link is not None
    return shared.link.name if shared.simulated is None else text("machine.simulated_name")


def unit(text: Text, written: str) -> str:
    """A unit whose words are those of the page."""
    return _WORD.sub(lambda word: text(f"units.{word[0]}") if text.has(f"units.{word[0]}") else word[0], written)


def duration(text: Text, seconds: float) -> str:
    """A time as people say it: 12 s, 3 min, 2 h."""
    if seconds < 100:
        return text("machine.seconds", n=f"{seconds:.0f}")
    if seconds < 6000:
        return text("machine.minutes", n=f"{seconds / 60:.0f}")
    return text("machine.hours", n=f"{seconds / 3600:.0f}")


def connection(text: Text, link: ControlLink | None) -> tuple[str, str]:
    """The connection in words, and the kind of message that it is."""
    if link is None:
        return text("machine.none"), "warning"
    view = link.view
    if view.connected and not view.is_stale:
        return text("machine.connected"), "good"
    if view.age is None:
        return (text("machine.never"), "error") if view.problem else (text("machine.connecting"), "info")
    return text("machine.silent" if view.connected else "machine.lost", age=duration(text, view.age)), "error"


def facts(text: Text, view: View) -> dict[str, str]:
    """Mode, channel, program, message and probe, by the name of their message."""
    status = view.status
    if status is None:
        return dict.fromkeys(("mode", "channel", "program", "message", "probe"), "–")
    probe = "unknown" if view.probe is None else "deflected" if view.probe else "free"
    return {
        "mode": text(f"machine.mode_{status.mode}"),
        "channel": text(f"machine.channel_{status.channel}"),
        "program": status.selected or text("machine.no_program"),
        "message": status.message or text("machine.no_message"),
        "probe": text(f"machine.probe_{probe}"),
    }


def run_state(text: Text, task: MeasuringTask) -> tuple[str, str]:
    """How the run stands in words, and the kind of message that it is."""
    state = task.state
    program = task.run.start.program if task.run is not None else ""
    begun = state is not RunState.ENDED or task.run is not None
    words = text(f"measure.state_{state}" if begun else "measure.state_refused").format(
        program=program, point=task.held_at
    )
    if state is RunState.HELD and task.was_lost:  # why it is held
        words = f"{text('measure.state_lost')}. {words}"
    kinds = {
        RunState.INTERRUPTED: "warning",
        RunState.HOLDING: "warning",
        RunState.HELD: "warning",
        RunState.LOST: "error",
        RunState.COMPLETE: "good",
        RunState.ENDED: "error",
    }
    if state is RunState.ENDED:
        words += f": {text.quoted(task.reason) or text('measure.by_operator')}"
    return words, kinds.get(state, "info")


def run_strip(text: Text, task: MeasuringTask | None) -> str:
    """The run in a few words, for the head of every page."""
    if task is None or task.run is None or task.state not in _GOING_ON:
        return text("measure.strip_none")
    values = {"run": task.run.id, "kept": len(task.touches), "total": task.total}
    return text("measure.strip", **values, state=text(f"measure.short_{task.state}"))

"""Which part of the machine is to blame: every source of error alone, and its share of the squares."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearmath.gearbox.hobbed.drive import DriveTrain
from gearmath.gearbox.hobbed.envelope import Envelope
from gearmath.gearbox.hobbed.inspection import Inspection, Layout, inspect
from gearmath.specs.cutting_errors import CuttingErrors

#: Sources in the words of the shop, and what to do about each first.
SOURCES = {
    "gashes": ("gashes and feed of the hob", "a hob of more gashes, or a finer feed"),
    "steps": ("motor steps and encoder counts", "more microsteps or reduction, or an encoder of more lines"),
    "worm": ("worm, once a turn of it", "the worm: its runout and its bearings"),
    "wheel": ("worm wheel, once a turn of the table", "the worm wheel: its eccentricity on the table"),
    "encoder": ("lines of the encoder", "the coupling of the encoder, or a better encoder"),
    "speed_ripple": ("ripple of the hob's speed behind the motor's lag", "a stiffer drive of the table"),
    "stop_in_cut_mm": ("stop of the hob within the cut", "no stop within the cut, or a stiffer drive of the table"),
    "microstep_percent": ("microsteps that are not equal", "a better driver, or more reduction behind the motor"),
    "hob_eccentricity_um": ("eccentricity of the hob", "the runout of the hob on its arbor"),
    "hob_axial_runout_um": ("wobble of the hob along its axis", "the faces of the hob and its spacers"),
    "hob_lead_um_per_turn": ("lead of the hob", "the hob, or its grinding"),
    "hob_starts_um": ("spacing of the hob's starts", "the hob: a single start, or tooth numbers that hunt"),
    "feed": ("screw of the feed", "the screw of the feed, or a scale"),
    "blank_eccentricity_um": ("eccentricity of the blank", "the clamping of the blank: true it with an indicator"),
    "blank_tilt_um_per_100mm": ("tilt of the blank", "the faces of the blank and of the arbor"),
    "backlash_taken_by_cut": ("play of the table", "a brake on the table, or less play of the worm"),
}
#: Keys that only say how another one lies, or matter only with it.
_WITH = {
    "stop_in_cut_mm": ("run_up_seconds",),
    "hob_eccentricity_um": ("hob_eccentricity_phase",),
    "hob_axial_runout_um": ("hob_axial_runout_phase",),
    "feed": ("feed_screw_pitch",),
    "blank_eccentricity_um": ("blank_eccentricity_phase",),
    "blank_tilt_um_per_100mm": ("blank_tilt_phase",),
}
#: Sources that show only in what steps do. The motor's lag evens out steps, so that these and the steps alone have it.
_BEHIND_STEPS = ("speed_ripple", "stop_in_cut_mm", "microstep_percent", "encoder")


@dataclass(frozen=True)
class Contribution:
    """One source: its share of the squares of profile, helix and pitch [percent], and what to change."""

    source: str
    words: str
    profile_percent: float
    helix_percent: float
    pitch_percent: float
    change: str


def sources(train: DriveTrain) -> list[str]:
    """Sources that are there: gashes always, steps unless the train is ideal, and what the machine file has."""
    found = ["gashes"] + ["steps"] * (train.rule != "ideal")
    values = train.errors.model_dump()
    return found + [key for key in SOURCES if values.get(key)]


def alone(train: DriveTrain, source: str) -> DriveTrain:
    """The train with this source only."""
    given = train.errors.model_dump()
    kept: dict[str, Any] = {}
    if source in given:
        kept = {key: given[key] for key in (source, *_WITH.get(source, ()))}
    stepping = source in ("steps", *_BEHIND_STEPS)
    if stepping:
        kept["motor_time_constant_ms"] = train.errors.motor_time_constant_ms
    machine = train.machine.model_copy(update={"errors": CuttingErrors.model_validate(kept)})
    return replace(train, machine=machine, rule=train.rule if stepping else "ideal")


def contributions(
    train: DriveTrain, where: Layout, whole: Inspection, progress: Callable[[int], object] = lambda done: None
) -> tuple[Contribution, ...]:
    """Shares of every source that is there, largest first by the mean of the three; ``whole`` is the train's gear."""
    names = sources(train)
    found = {}
    for name in names:
        single = alone(train, name)
        found[name] = whole if single == train else inspect(Envelope(train.job, single), where, progress)
    ideal = found["gashes"]
    with_steps = found.get("steps", ideal)
    squares = {}
    for name, seen in found.items():
        before = {"gashes": None, "steps": ideal}.get(name, ideal)
        if name in _BEHIND_STEPS and train.rule != "ideal":
            before = with_steps
        squares[name] = np.array([_mean_square(seen, before, kind) for kind in ("profiles", "helices", "pitch")])
    total = sum(squares.values())
    shares = {name: 100 * np.divide(each, total, where=total > 0, out=np.zeros(3)) for name, each in squares.items()}
    rows = [_row(name, shares[name]) for name in names]
    return tuple(sorted(rows, key=lambda row: -(row.profile_percent + row.helix_percent + row.pitch_percent)))


def _row(name: str, shares: np.ndarray) -> Contribution:
    profile, helix, pitch = map(float, shares)
    words, change = SOURCES[name]
    return Contribution(name, words, profile, helix, pitch, change)


def _mean_square(found: Inspection, before: Inspection | None, kind: str) -> float:
    """Mean square of what a source does to the traces of a kind, or to the positions of the teeth, [mm²]."""
    values = _values(found, kind)
    if before is not None:
        values = values - _values(before, kind)
    return float(np.mean((values - values.mean(axis=1, keepdims=True)) ** 2))


def _values(found: Inspection, kind: str) -> np.ndarray:
    if kind == "pitch":
        return np.array([row.position for row in found.pitches])
    return np.array([trace.deviation for trace in getattr(found, kind)])

"""Probing and calibration programs for LinuxCNC, run by LinuxCNC's own interpreter.

It has no probe: every touch ends where it was commanded to end, and so it does here for the other dialect.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import pytest

from gearmath.machine.control.executor import MachinePath, run_program
from gearmath.machine.control.state import Setup
from gearmath.machine.measuring.artefacts import Artefacts
from gearmath.machine.measuring.collision_check import enough_steps, is_touch
from gearmath.machine.writing.axis_cycle import axis_program
from gearmath.machine.writing.calibrating import calibration_program
from gearmath.machine.writing.linuxcnc.probe_words import LinuxCncBlocks
from gearmath.machine.writing.linuxcnc.probing import LINUXCNC
from gearmath.machine.writing.probing import probing_program
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.calibration import Calibration, load_calibration
from gearmath.specs.milling_machine import MillingMachine, load_milling_machine
from gearmath.specs.toml import bundled

if TYPE_CHECKING:
    from conftest import Interpreted, Interpreter

#: The interpreter counts in inches: a position in mm goes through two roundings of doubles.
ROUNDING = 1e-9
#: A of a point: the other dialect adds two angles and rounds the sum, which may be the next increment. [degrees]
INCREMENT = 1.000001e-6
PROBE = {99: 0.0}


@pytest.fixture(scope="module")
def machine() -> MillingMachine:
    return load_milling_machine(bundled("vertical_5axis.toml"))


@pytest.fixture(scope="module")
def calibration() -> Calibration:
    return load_calibration(bundled("probe.toml"))


def path_of(text: str, machine: MillingMachine, calibration: Calibration, on_artefacts: bool = False) -> MachinePath:
    """The path that our reader finds in a program of the other dialect; ring and spheres may stand in its way."""
    there = Artefacts(machine, calibration)

    def trigger(start: np.ndarray, end: np.ndarray) -> np.ndarray | None:
        return end if is_touch(start, end) or (on_artefacts and there(start, end) is not None) else None

    setup = Setup.of(machine, calibration.length)
    return run_program(text, "PROBE", trigger, step_limit=enough_steps(text), setup=setup).path


def assert_same_path(theirs: Interpreted, ours: MachinePath, machine: MillingMachine) -> None:
    assert theirs.error == ""
    kinds = np.where(ours.measuring, "probe", np.where(ours.rapid, "rapid", "feed"))
    # at home our reader does not know where the axes stand after a tool change
    here, there = theirs.position[:, 2] != machine.home, ours.axes[:, 2] != machine.home
    kind, position = np.array(theirs.kind)[here], theirs.position[here]
    # sideways the work turns first, by itself: it has the feed of X Y Z otherwise
    step = np.abs(np.diff(position, axis=0)) > 0.0
    turned, moved = ~step[:-1, :3].any(axis=1), ~step[1:, 2:].any(axis=1)
    probing = kind == "probe"
    kept = np.append(np.append(True, ~(turned & moved & probing[1:-1] & probing[2:])), True)
    assert kind[kept].tolist() == kinds[there].tolist()
    position = position[kept]
    np.testing.assert_allclose(position[:, :3], ours.axes[there, :3], rtol=0, atol=ROUNDING)
    turned = position[:, 3:5] - np.degrees(ours.axes[there, 3:])
    np.testing.assert_allclose(turned[:, 0], 360 * np.round(turned[:, 0] / 360), rtol=0, atol=INCREMENT)
    np.testing.assert_allclose(turned[:, 1], 0, rtol=0, atol=ROUNDING)


@pytest.mark.parametrize(
    ("gear_set", "name", "topography", "repeat", "around"),
    [
        ("nasa_tp3096_12x36", "pinion", (0,), 2, (0, 3)),
        ("nasa_tp3096_12x36", "gear", (0,), 1, ()),
        ("spiral_7x43", "pinion", (0,), 1, ()),
        ("spiral_7x43", "gear", (), 1, ()),
        ("crown_gear_formate_14x39", "pinion", (), 1, ()),
        ("crown_gear_formate_14x39", "gear", (), 1, ()),
        ("crown_gear_universal_14x39", "pinion", (), 1, ()),
        ("crown_gear_universal_14x39", "gear", (), 1, ()),
        ("crown_gear_hobbed_14x39", "pinion", (0,), 1, ()),
        ("crown_gear_hobbed_14x39", "gear", (), 1, ()),
    ],
)
def test_the_interpreter_of_linuxcnc_moves_the_probe_as_our_reader_does(
    gear_set: str,
    name: str,
    topography: tuple[int, ...],
    repeat: int,
    around: tuple[int, ...],
    machine: MillingMachine,
    calibration: Calibration,
    interpreted: Interpreter,
) -> None:
    bevel_set = load_bevel_set(bundled(f"{gear_set}.toml"))
    arguments = bevel_set, name, machine, calibration, "PROBE", topography, True, repeat, around
    ours = path_of(probing_program(*arguments), machine, calibration)
    assert_same_path(interpreted(probing_program(*arguments, writer=LINUXCNC), PROBE), ours, machine)


@pytest.mark.parametrize("make", [calibration_program, axis_program])
def test_it_does_so_on_ring_and_spheres(
    make: Callable[..., str], machine: MillingMachine, calibration: Calibration, interpreted: Interpreter
) -> None:
    ours = path_of(make(machine, calibration, "PROBE"), machine, calibration, on_artefacts=True)
    assert_same_path(interpreted(make(machine, calibration, "PROBE", LinuxCncBlocks), PROBE), ours, machine)


def test_an_axis_with_backlash_turns_forwards_before_every_touch(
    machine: MillingMachine, calibration: Calibration, interpreted: Interpreter
) -> None:
    turning = machine.axes.A.model_copy(update={"one_sided_approach": 2.0})
    loose = machine.model_copy(update={"axes": machine.axes.model_copy(update={"A": turning})})
    bevel_set = load_bevel_set(bundled("nasa_tp3096_12x36.toml"))
    arguments = bevel_set, "pinion", loose, calibration, "PROBE", (), True
    ours = path_of(probing_program(*arguments), loose, calibration)
    assert_same_path(interpreted(probing_program(*arguments, writer=LINUXCNC), PROBE), ours, loose)


def test_only_the_chosen_points_are_touched(
    machine: MillingMachine, calibration: Calibration, interpreted: Interpreter
) -> None:
    bevel_set = load_bevel_set(bundled("nasa_tp3096_12x36.toml"))
    text = probing_program(bevel_set, "pinion", machine, calibration, "PROBE", (), True, writer=LINUXCNC)
    whole, part = interpreted(text, PROBE), interpreted(text, PROBE, {3090: 4, 3091: 6})
    assert [said.strip().split(":")[0] for said in part.said] == [f"point {k} of 26" for k in (4, 5, 6)]
    first = whole.line.tolist().index(part.line[5])  # after home, the way down, and the turn to the first point
    rest = slice(first, first + len(part.line) - 6)
    np.testing.assert_array_equal(part.position[5:-1], whole.position[rest])

"""The operator of the simulated control is told the one cause that holds, not a list of those that may."""

from __future__ import annotations

import re
from typing import Any

import pytest

from gearmath.control.simulated.nc import Nc
from gearmath.errors import InputError
from gearmath.hmi.messages import Text

PATH = "Part Program/TEN.MPF"


@pytest.fixture
def nc() -> Nc:
    machine: Any = None  # no program of these tests runs
    found = Nc(machine)
    found.files[PATH] = b"M30\n"
    return found


def _refused(act: Any, said: str, german: str) -> None:
    with pytest.raises(InputError, match=f"^{re.escape(said)}$") as refused:
        act()
    assert Text("de").quoted(refused.value) == german


def test_what_keeps_a_program_from_its_start_is_named_alone(nc: Nc) -> None:
    cannot, german = "the program cannot be started: ", "das Programm kann nicht gestartet werden: "
    _refused(nc.start, f"{cannot}none is selected", f"{german}keines ist angewählt")
    nc.select(PATH)
    nc.emergency_stop()
    _refused(
        nc.start,
        f"{cannot}after an emergency stop RESET comes first",
        f"{german}nach einem Not-Halt ist zuerst RESET zu drücken",
    )
    nc.reset()
    nc.channel = 1
    _refused(nc.start, f"{cannot}TEN.MPF runs", f"{german}TEN.MPF läuft")
    nc.emergency_stop()
    _refused(
        nc.start,
        f"{cannot}TEN.MPF is interrupted, and RESET comes first",
        f"{german}TEN.MPF ist unterbrochen, zuerst ist RESET zu drücken",
    )


def test_what_keeps_a_program_from_being_selected_is_named_alone(nc: Nc) -> None:
    _refused(
        lambda: nc.select("Part Program/NONE.MPF"),
        "NONE.MPF: cannot be selected: there is no such program on the control",
        "NONE.MPF: kann nicht angewählt werden: das Programm gibt es auf der Steuerung nicht",
    )
    nc.select(PATH)
    nc.channel = 1
    _refused(
        lambda: nc.select(PATH),
        "TEN.MPF: cannot be selected: TEN.MPF runs",
        "TEN.MPF: kann nicht angewählt werden: TEN.MPF läuft",
    )


def test_the_emergency_stop_that_is_pressed_twice_is_one_alarm(nc: Nc) -> None:
    nc.emergency_stop()
    nc.emergency_stop()
    assert [alarm.number for alarm in nc.alarms.values()] == ["3000"]

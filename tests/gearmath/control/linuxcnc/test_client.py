"""The client of LinuxCNC without LinuxCNC: a stand-in answers as the process beside it does."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest

from gearmath.control.interface import ChannelState, ConnectionLost, Handshake, RunStart, Touch
from gearmath.control.linuxcnc_client import LinuxCncControl
from gearmath.control.measuring import Measuring
from gearmath.control.plan import planned
from gearmath.control.store import MeasurementStore
from gearmath.errors import ComputationError, InputError
from gearmath.machine.control.file_names import linuxcnc_name
from gearmath.machine.control.state import Setup
from gearmath.specs.touch_csv import COLUMNS

STAND_IN = (sys.executable, str(Path(__file__).with_name("stand_in.py")))
POINTS = {k: ("gear", "concave", str(k), "2", "4") for k in (1, 2, 3)}


@pytest.fixture
def ini(tmp_path: Path) -> Path:
    (tmp_path / "P.ngc").write_bytes(b"; P\nM2\n")
    path = tmp_path / "machine.ini"
    path.write_text("[DISPLAY]\nDISPLAY = axis\n[HAL]\nHALFILE = one.hal\nHALFILE = two.hal\n")
    return path


def ask(ini: Path, work: Callable[[LinuxCncControl], Awaitable[Any]]) -> Any:
    async def once() -> Any:
        control = await LinuxCncControl.connect(ini, STAND_IN)
        try:
            return await work(control)
        finally:
            await control.close()

    return asyncio.run(once())


def test_a_run_is_kept_and_every_point_is_acknowledged_with_the_number_of_its_run(ini: Path, tmp_path: Path) -> None:
    with MeasurementStore.open(tmp_path / "runs.db") as store:
        run = store.begin_run(RunStart("LinuxCNC", "P.ngc", b"; P\nM2\n", COLUMNS, POINTS))
        measuring = Measuring(lambda: LinuxCncControl.connect(ini, STAND_IN), run)
        asyncio.run(asyncio.wait_for(measuring.to_the_end((1, 3)), 30))
        assert run.touches() == {k: Touch(4, 10.0 + k, 20.0, 30.0, 40.0, 50.0, 1.0) for k in POINTS}
        assert [alarm.text for alarm in run.alarms()] == ["the lamp is out"]
    told = (tmp_path / "told").read_text().splitlines()
    assert told[:3] == ["gearmath-first 1", "gearmath-last 3", "gearmath-host 1"]
    said = [line for line in dict.fromkeys(told) if "acknowledged" in line]
    assert said == [f"gearmath-acknowledged {4_000_000 + k}" for k in POINTS]
    assert told[-3:] == ["gearmath-host 0", "gearmath-first 0", "gearmath-last 0"]


@pytest.mark.parametrize(("points", "kept"), [((2, 3), 0), ((3,), 0), ((1, 2, 3), 2)])
def test_a_run_need_not_begin_at_the_first_point(ini: Path, tmp_path: Path, points: tuple[int, ...], kept: int) -> None:
    """Chosen points, and a run that goes on where it was left."""
    with MeasurementStore.open(tmp_path / "runs.db") as store:
        run = store.begin_run(RunStart("LinuxCNC", "P.ngc", b"; P\nM2\n", COLUMNS, {k: POINTS[k] for k in points}))
        for point in points[:kept]:
            run.commit_touch(point, Touch(3, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0))
        measuring = Measuring(lambda: LinuxCncControl.connect(ini, STAND_IN), run)
        asyncio.run(asyncio.wait_for(measuring.to_the_end((points[kept], 3)), 30))
        assert [touch.number for touch in run.touches().values()] == [3] * kept + [4] * (len(points) - kept)
    said = [line for line in dict.fromkeys((tmp_path / "told").read_text().splitlines()) if "acknowledged" in line]
    assert said == [f"gearmath-acknowledged {4_000_000 + k}" for k in points[kept:]]


def test_an_answer_to_an_earlier_run_acknowledges_nothing(ini: Path) -> None:
    assert ask(ini, lambda one: one.handshake()) == Handshake(0, 3, 2, False)

    async def later(one: LinuxCncControl) -> Handshake:
        await one.prepare(0, 0)
        while (found := await one.handshake()).number == 3:
            pass
        return found

    assert ask(ini, later).acknowledged == 0


def test_only_the_point_that_is_offered_is_acknowledged(ini: Path, tmp_path: Path) -> None:
    with pytest.raises(ComputationError, match="point 0 is offered, not 2: nothing is acknowledged"):
        ask(ini, lambda one: one.acknowledge(2))
    assert not (tmp_path / "told").exists()


def test_status_is_in_words_of_every_control(ini: Path) -> None:
    found = ask(ini, lambda one: one.status())
    assert (found.channel, found.mode, found.selected) == (ChannelState.RESET, "automatic", "P.ngc")
    assert found.position == (1.0, 2.0, 3.0, 4.0, 5.0)


@pytest.mark.parametrize("mood", ["gone", "refuses"])
def test_a_control_that_is_lost_is_said_to_be(mood: str, ini: Path, tmp_path: Path) -> None:
    (tmp_path / "mood").write_text(mood)
    with pytest.raises(ConnectionLost, match="no status" if mood == "refuses" else "does not answer"):
        ask(ini, lambda one: one.status())


def test_a_control_that_is_not_there_is_said_to_be(ini: Path, tmp_path: Path) -> None:
    (tmp_path / "mood").write_text("absent")
    with pytest.raises(ConnectionLost, match="no LinuxCNC runs here with this file"):
        ask(ini, lambda one: one.status())
    with pytest.raises(InputError, match="is LinuxCNC installed"):
        asyncio.run(LinuxCncControl.connect(ini, (str(tmp_path / "no python"),)))


def test_programs_are_written_beside_the_selected_one_and_not_over_others(ini: Path, tmp_path: Path) -> None:
    ask(ini, lambda one: one.put("Q.ngc", b"M2\n"))
    assert ask(ini, lambda one: one.get("Q.ngc")) == b"M2\n"
    with pytest.raises(ComputationError, match="is there already"):
        ask(ini, lambda one: one.put("Q.ngc", b"M30\n"))
    ask(ini, lambda one: one.put("Q.ngc", b"M30\n", replace=True))
    assert (tmp_path / "Q.ngc").read_bytes() == b"M30\n"
    with pytest.raises(ComputationError, match="it is selected"):
        ask(ini, lambda one: one.put("P.ngc", b"M30\n", replace=True))
    with pytest.raises(ComputationError, match=r"there is no R\.ngc"):
        ask(ini, lambda one: one.get("R.ngc"))


@pytest.mark.parametrize("name", ["../P.ngc", "/etc/passwd", "P.MPF", ".P.ngc", "a b.ngc", "P.ngc\n"])
def test_names_lead_out_of_no_folder(name: str) -> None:
    with pytest.raises(InputError, match=r"must be like PROBE\.ngc"):
        linuxcnc_name(name)


def test_the_touches_of_a_program_stand_in_its_text() -> None:
    lines = ["; control: LinuxCNC", "(LOG,run,point,member,flank,tooth,row,col,X,Y,Z,A,B,triggered)"]
    for k in (1, 2, 3):
        lines += [f"; point {k} of 3: concave", f"(LOG,%d#3102,{k},gear,concave,{k},2,4,%.7f#3200,%d#3205)"]
    text = "\n".join(lines)
    assert planned(text, "P", Setup()).points == POINTS
    assert list(planned(text, "P", Setup(), 2, 3).points) == [2, 3]
    with pytest.raises(InputError, match="has parts 1 to 3, not 4 to 4"):
        planned(text, "P", Setup(), 4, 4)
    with pytest.raises(InputError, match="offers no touches to a host"):
        planned("; control: LinuxCNC\nM2\n", "P", Setup())

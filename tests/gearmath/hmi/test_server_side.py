"""What the server holds, without a browser: alarms, questions, long computations, the check of the probe."""

from __future__ import annotations

import asyncio
import re
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from gearmath.control.interface import Alarm
from gearmath.control.run_start import begun
from gearmath.errors import InputError
from gearmath.hmi.alarm_book import MOST, AlarmBook
from gearmath.hmi.messages import Text
from gearmath.hmi.plain_page import PlainErrors
from gearmath.hmi.probe_check import ProbeCheck
from gearmath.hmi.programs_work import limits, programs, read, write_cutting, write_probing
from gearmath.hmi.state import Choice
from gearmath.hmi.tickets import Tickets
from gearmath.hmi.work import BROKEN, Progress, Work
from gearmath.machine.control.text import is_for_linuxcnc
from gearmath.machine.measuring.checked import ProbingChoice
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled


def _alarm(number: int, text: str = "text") -> Alarm:
    return Alarm(f"{number}-1", str(number), text, 1000, True)


def test_an_alarm_stays_until_it_was_seen_and_is_gone() -> None:
    book = AlarmBook()
    book.hear([_alarm(3000)])
    book.hear([_alarm(3000)])
    assert [one.alarm for one in book.entries()] == ["3000"]
    book.hear([])
    (gone,) = book.entries()
    assert gone.gone
    assert not gone.seen
    book.see([gone.number])
    assert book.entries() == []
    book.hear([_alarm(3000)])
    (again,) = book.entries()
    book.see([again.number])
    assert [one.seen for one in book.entries()] == [True], "what is active is shown, seen or not"
    assert book.unseen() == 0


def test_alarms_outlive_the_server_and_a_damaged_file_keeps_nothing(tmp_path: Path) -> None:
    file = tmp_path / "alarms.json"
    AlarmBook(file).hear([_alarm(1), _alarm(2)])
    book = AlarmBook(file)
    book.hear([_alarm(2)])
    assert [(one.alarm, bool(one.gone)) for one in book.entries()] == [("2", False), ("1", True)]
    file.write_text('[{"number": 1}]', "utf-8")
    assert AlarmBook(file).entries() == []


def test_a_flood_of_alarms_is_bounded_and_comes_once() -> None:
    book = AlarmBook()
    flood = [_alarm(number) for number in range(3 * MOST)]
    book.hear(flood)
    newest = book.entries()[0].number
    book.hear(flood)
    assert len(book.entries()) == MOST
    assert book.entries()[0].number == newest


def test_a_question_is_answered_once_and_in_time() -> None:
    tickets = Tickets()
    ticket = tickets.draw()
    assert tickets.take(ticket)
    assert not tickets.take(ticket)
    assert not tickets.take("guessed")
    late = Tickets(seconds=-1.0)
    assert not late.take(late.draw())


def test_a_probe_passes_only_when_its_signal_comes_and_goes() -> None:
    check = ProbeCheck()
    for signal, state in ((None, "unknown"), (True, "ask"), (True, "ask"), (False, "ask"), (True, "deflected")):
        check.look(signal)
        assert check.state == state
        assert not check.is_done
    check.look(None)
    assert check.state == "unknown"
    for signal in (False, True, False, True):
        check.look(signal)
    assert check.is_done


def test_a_silent_control_does_not_undo_the_check_of_the_probe() -> None:
    """Free, then deflected, then free was seen, whatever was not seen between them."""
    check = ProbeCheck()
    for signal in (None, False, None, True, None, None):
        check.look(signal)
    assert check.state == "unknown"
    check.look(False)
    assert check.is_done
    stuck = ProbeCheck()
    for signal in (True, None, True, None, True):
        stuck.look(signal)
    assert stuck.state == "ask"


def test_a_computation_tells_how_far_it_is_and_ends_when_it_is_cancelled() -> None:
    work, go_on = Work(), threading.Event()

    def compute(progress: Progress) -> str:
        progress.begin(4, "step")
        progress(1)
        go_on.wait(10)
        progress(1)
        return "done"

    work.start("first", compute)
    with pytest.raises(InputError, match="first: runs already"):
        work.start("second", compute)
    work.cancel()
    go_on.set()
    work.wait(10)
    assert (work.result, work.error, work.running, work.count) == (None, None, False, 1)
    assert work.share == 0.5
    work.start("third", compute)
    work.wait(10)
    assert work.result == "done"


def test_what_fails_is_told_in_its_sentence() -> None:
    def compute(progress: Progress) -> None:
        raise InputError("set.toml: teeth = 0: must be at least 5")

    work = Work()
    work.start("work", compute)
    work.wait(10)
    assert work.error == "set.toml: teeth = 0: must be at least 5"


def test_a_failure_without_a_sentence_of_its_own_is_said_and_not_hidden(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    logged: list[object] = []
    monkeypatch.setattr(threading, "excepthook", logged.append)

    def compute(progress: Progress) -> None:
        raise KeyError("inside")

    work = Work()
    work.start("work", compute)
    work.wait(10)
    assert work.error == BROKEN
    assert "inside" not in BROKEN
    assert len(logged) == 1
    assert Text("de").quoted(BROKEN).startswith("der Server ist daran gescheitert: was geschehen ist")


def test_an_application_that_fails_answers_one_plain_page_and_tells_its_log() -> None:
    sent: list[dict[str, object]] = []

    async def fails(scope: object, receive: object, send: object) -> None:
        raise KeyError("inside")

    async def send(message: object) -> None:
        sent.append(message)  # type: ignore[arg-type]

    headers = [(b"accept", b"text/html"), (b"accept-language", b"de")]
    scope = {"type": "http", "method": "GET", "path": "/machine", "query_string": b"", "headers": headers}
    with pytest.raises(KeyError):
        asyncio.run(PlainErrors(fails)(scope, None, send))  # type: ignore[arg-type]
    assert sent[0]["status"] == 500
    body = bytes(sent[1]["body"]).decode()  # type: ignore[call-overload]
    assert "Der Server ist daran gescheitert; ein Messlauf geht weiter." in body
    assert "KeyError" not in body
    assert "inside" not in body


def test_a_set_that_is_refused_has_no_limits(tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.toml"
    wrong.write_text("[pinion]\nteeth = 0\n", "utf-8")
    with pytest.raises(InputError, match=r"wrong\.toml"):
        limits(Choice(gear_set=str(wrong)), False)


def test_programs_are_for_the_control_of_the_machine_file(tmp_path: Path) -> None:
    """LinuxCNC in the machine file: its own text, under its own name, which the plan of a measuring run can read."""
    text = bundled("vertical_5axis.toml").read_text("utf-8")
    machine = tmp_path / "mill.toml"
    machine.write_text(re.sub(r"^\[control\]", '[control]\nkind = "linuxcnc"  ', text, flags=re.M), "utf-8")
    assert load_milling_machine(machine).control.kind == "linuxcnc"
    choice, chosen = Choice(machine=str(machine)), ProbingChoice((), True, False, 1)
    made = write_probing(tmp_path, choice, "probe_one.mpf", chosen, Progress())
    assert made.file == tmp_path / "PROBE_ONE.ngc"
    assert [one.name for one in programs(tmp_path)] == ["PROBE_ONE.ngc"]
    start, _ = begun("LinuxCNC", made.file, choice.gear_set, choice.machine, choice.calibration)
    assert len(start.points) == made.touches == 26
    cut = write_cutting(tmp_path, choice, "CUT", CuttingJob(tolerance=0.01), Progress())
    assert cut.file == tmp_path / "CUT.ngc"
    assert is_for_linuxcnc(cut.file.read_text("utf-8"))


def test_the_missing_extra_is_one_sentence_with_its_remedy(tmp_path: Path) -> None:
    """As where only 'pip install gearmath' was done: nicegui cannot be imported."""
    hide = (
        "import sys\n"
        "class Hidden:\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        "        if name.partition('.')[0] == 'nicegui':\n"
        "            raise ModuleNotFoundError(f'No module named {name!r}', name=name)\n"
        "sys.meta_path.insert(0, Hidden())\n"
        "from gearmath.cli import main; main()\n"
    )
    done = subprocess.run([sys.executable, "-c", hide, "hmi"], capture_output=True, text=True, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert "nicegui is missing: install it with pip install '.[hmi]'" in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


def test_only_programs_whose_names_a_control_takes_are_listed_and_read(tmp_path: Path) -> None:
    for name in ("CUT.MPF", "SUB.SPF", "a b.MPF", "<b>.MPF", "CON.MPF", "runs.db"):
        (tmp_path / name).write_text("M30\n", "utf-8")
    assert sorted(one.name for one in programs(tmp_path)) == ["CUT.MPF", "SUB.SPF"]
    assert read(tmp_path, "CUT.MPF") == b"M30\n"
    for name in ("../CUT.MPF", "..\\CUT.MPF", "/etc/passwd", "CUT.MPF\0", "runs.db"):
        with pytest.raises(InputError):
            read(tmp_path, name)

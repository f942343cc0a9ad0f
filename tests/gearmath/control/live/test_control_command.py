"""``gearmath control`` as it is typed: what it prints, and one sentence with its status for what it refuses."""

from __future__ import annotations

import json
import os
import re
import select
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import click
import pytest

from gearmath import cli
from gearmath.control import sinumerik
from gearmath.control.simulated.nc import NcAlarm
from gearmath.control.store import MeasurementStore

Typed = Callable[..., tuple[int, str, str]]


@pytest.fixture
def typed(live: Any, capsys: Any, monkeypatch: pytest.MonkeyPatch) -> Typed:
    """``typed("status", "--json")``: status, output and errors of a verb on the simulated control."""
    monkeypatch.setenv("GEARMATH_CONTROL_PASSWORD", live.PASSWORD)
    file = live.folder / "control.toml"
    text = file.read_text()
    file.write_text("\n".join(f'url = "{live.control.url}"' if "url =" in line else line for line in text.splitlines()))

    def run(verb: str, *arguments: str) -> tuple[int, str, str]:
        code = 0
        try:
            cli.main(["control", verb, str(file), *arguments])
        except SystemExit as end:
            code = int(end.code or 0)
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run


def test_status_as_json_has_channel_program_position_and_rights(live: Any, typed: Typed) -> None:
    live.load()
    status, out, _ = typed("status", "--json")
    values = json.loads(out)
    assert status == 0
    assert values["channel"] == "reset"
    assert values["selected"] == "TEN.MPF"
    assert list(values["position"]) == ["X", "Y", "Z", "A", "B"]
    assert sinumerik.WRITE_STATE in values["rights"]


def test_parameters_are_read_and_set(live: Any, typed: Typed) -> None:
    assert typed("rparam", "R30=1.5", "R29-R31", "--json")[:2] == (
        0,
        '{\n  "R30": 1.5,\n  "R29": 0.0,\n  "R31": 0.0\n}\n',
    )
    assert live.nc.parameters[30] == 1.5


def test_positions_and_parameters_are_watched_with_their_units(live: Any, typed: Typed) -> None:
    live.load()
    live.nc.parameters[30] = 1.5
    status, out, said = typed("watch", "--seconds", "0.1")
    assert (status, bool(out)) == (0, True), said
    line = r" +\d\.\d\d s( +[XYZ] +-?\d+\.\d{5} mm){3}( +[AB] +-?\d+\.\d{5} degrees){2}"
    assert all(re.fullmatch(line, one) for one in out.splitlines()), out
    status, out, _ = typed("watch", "R30", "R29", "--seconds", "0.1", "--json")
    assert (status, bool(out)) == (0, True)
    assert all(json.loads(one)["parameters"] == {"R30": 1.5, "R29": 0.0} for one in out.splitlines())
    for word, sentence in (("X", "'X': must be like R10 or R20-R25"), ("R30=1", "watch sets nothing")):
        status, _, said = typed("watch", word)
        assert status == 2
        assert sentence in said


def test_programs_go_there_and_back(live: Any, typed: Typed, tmp_path: Path) -> None:
    program = tmp_path / "CUT.MPF"
    program.write_bytes("; Prüfung\r\nM30\n".encode("cp1252"))
    assert typed("put", str(program))[0] == 0
    assert typed("get", "cut.mpf", "-o", str(tmp_path / "back.mpf"))[0] == 0
    assert (tmp_path / "back.mpf").read_bytes() == program.read_bytes()
    status, _, said = typed("put", str(program))
    assert (status, said.count("\n")) == (1, 1)
    assert "such a file already" in said
    assert typed("put", str(program), "--replace")[0] == 0


def test_alarms_are_listed(live: Any, typed: Typed) -> None:
    assert typed("alarms")[1] == "no alarm is active\n"
    live.nc.raise_alarm(NcAlarm("65001", "touched nothing"))
    (alarm,) = json.loads(typed("alarms", "--json")[1])
    assert (alarm["number"], alarm["text"], alarm["active"]) == ("65001", "touched nothing", True)


def test_a_run_that_an_alarm_ended_is_resumed_as_its_sentence_says(live: Any, typed: Typed, tmp_path: Path) -> None:
    program, store = tmp_path / "TEN.MPF", str(tmp_path / "runs.db")
    program.write_text(live.TEN)
    live.load()
    live.nc.parameters[105] = 4.0  # the program sets its alarm after this point
    ended = threading.Event()

    def operator() -> None:
        """Starts the selected program whenever it has been prepared and stands still."""
        while not ended.wait(0.02):
            if live.nc.parameters.get(104) == 1.0 and not live.nc.channel and not live.nc.alarms:
                time.sleep(0.3)
                live.nc.start()
                while live.nc.channel and not ended.wait(0.02):
                    pass
                live.nc.parameters[104] = 0.0

    person = threading.Thread(target=operator)
    person.start()
    try:
        first = ("measure", str(program), "--set", "nasa_tp3096_12x36.toml", "--store", store, "--acknowledge")
        status, _, said = typed(*first)
        assert status == 1
        sentence = said.splitlines()[-1]
        assert "(alarm 65001: point 4); 4 of 10 touches are kept in run 1: go on with --resume 1" in sentence
        live.nc.reset()
        live.nc.parameters[105] = 0.0
        status, out, _ = typed("measure", "--resume", "1", "--store", store, "--acknowledge")
    finally:
        ended.set()
        person.join()
    assert (status, out) == (0, f"{store}: run 1 is complete: 10 touches\n")
    with MeasurementStore.open(Path(store), create=False) as kept:
        touches = kept.run(1).touches()
    assert list(touches) == list(range(1, 11))
    assert [touch.number - touches[1].number for touch in touches.values()] == [0] * 4 + [1] * 6


@pytest.mark.parametrize(
    ("arguments", "status", "said"),
    [
        (("rparam", "R103=4"), 2, "belongs to the handshake"),
        (("rparam", "R1=one"), 2, "must be a number"),
        (("rparam", "Q1"), 2, "must be like R10"),
        (("rparam", "R9-R2"), 2, "comes before the first"),
        (("rparam", "R5000"), 2, "0 to 999"),
        (("get", "../AB.MPF"), 2, "file name"),
        (("get", "NONE.MPF"), 1, "there is no such file"),
        (("put", "missing.MPF"), 2, "cannot be read"),
        (("measure", "TEN.MPF"), 2, "--acknowledge is missing"),
        (("measure", "--acknowledge"), 2, "either PROGRAM.MPF or --resume"),
        (("measure", "--resume", "1", "--again-of", "2", "--acknowledge"), 2, "goes with --points"),
        (("trust",), 2, "is there already"),
    ],
)
def test_refusals_are_one_sentence(live: Any, typed: Typed, arguments: tuple, status: int, said: str) -> None:
    found, out, error = typed(*arguments)
    assert (found, out) == (status, "")
    assert said in error
    assert error.startswith("gearmath: ")
    assert error.count("\n") == 1


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ('url = "http://x"', "must be like opc.tcp"),
        ('url = "opc.tcp://me:secret@x:4840"', "neither user nor password"),
        ('url = "http://me:secret@x"', "neither user nor password"),
        ('url = "opc.tcp://x:99999"', "must be like opc.tcp"),
        ("channel = 0", "channel"),
        ("axes = [1, 2, 3, 4, 4]", "five different"),
        ('password = "secret"', "password"),
        ('security = "none"', "must be 'Basic256Sha256', or --insecure given"),
        ('key = "none.pem"', "there is no such file"),
        ('certificate = ""', "certificate is missing"),
    ],
)
def test_a_connection_file_that_is_wrong_says_where(
    live: Any, tmp_path: Path, capsys: Any, change: str, said: str
) -> None:
    key = change.split(" ")[0]
    lines = [one for one in (live.folder / "control.toml").read_text().splitlines() if not one.startswith(f"{key} ")]
    for name in ("client.der", "client_key.pem"):
        (tmp_path / name).write_bytes((live.folder / name).read_bytes())
    file = tmp_path / "cell.toml"
    file.write_text("\n".join([*lines, change]))
    with pytest.raises(SystemExit) as end:
        cli.main(["control", "status", str(file)])
    error = capsys.readouterr().err
    assert end.value.code == 2
    assert str(file) in error
    assert said in error
    assert "secret" not in error


def test_no_command_takes_a_password_where_others_see_it() -> None:
    from gearmath.cli.control import control

    for name, command in control.commands.items():
        for option in command.params:
            assert not any("pass" in one for one in option.opts), name
        assert isinstance(command, click.Command)


@pytest.fixture
def console(tmp_path: Path) -> Iterator[Callable[[str], str]]:
    """A simulated control of its own process; ``console("start")`` types a command and gives the answer."""
    command = [
        sys.executable,
        "-c",
        "from gearmath.cli import main; main()",
        "control",
        "simulate",
        "--folder",
        "cell",
        "--port",
        "0",
        "--speed",
        "0",
    ]
    environment = os.environ | {"GEARMATH_CONTROL_PASSWORD": "x1"}
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, cwd=tmp_path, env=environment, bufsize=0
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None

        def answer() -> str:
            ready, _, _ = select.select([process.stdout], [], [], 60)
            assert ready, "no answer"
            return process.stdout.readline().decode()  # type: ignore[union-attr]

        assert "ready" in answer()
        assert answer().startswith("select NAME.MPF")

        def typed(line: str) -> str:
            process.stdin.write(f"{line}\n".encode())  # type: ignore[union-attr]
            process.stdin.flush()  # type: ignore[union-attr]
            return answer()

        yield typed
        process.stdin.write(b"quit\n")
        process.stdin.flush()
        begin = time.monotonic()
        while process.poll() is None and time.monotonic() - begin < 20:
            time.sleep(0.05)
        assert process.poll() == 0


def test_the_console_of_the_simulated_control_says_what_it_did_and_what_not(console: Callable[[str], str]) -> None:
    assert console("files") == "none\n"
    assert "cannot be selected" in console("select NONE.MPF")
    assert "file name" in console("select ../x")
    assert "cannot be started" in console("start")
    assert console("alarm 700016 oil is low") == "done\n"
    assert console("slow 0.1") == "done\n"
    assert console("slow much").startswith("not done")
    assert console("nonsense").startswith("select NAME.MPF")
    assert console("reset") == "done\n"

"""What a person sees on a terminal while a command works: a pseudo-terminal, read as a terminal would show it."""

from __future__ import annotations

import os
import re
import subprocess
import sys

import pytest

pty = pytest.importorskip("pty", reason="a pseudo-terminal needs a Unix")
termios = pytest.importorskip("termios", reason="a pseudo-terminal needs a Unix")

SLOW_VERB = """
import sys, time, types
import click
from gearmath import cli
from gearmath.cli.common import bar

@click.command("slow")
def slow():
    time.sleep(0.7)
    with bar(2, "pass") as progress:
        progress(1)
        time.sleep(0.3)
        progress(1)
    time.sleep(0.5)
    click.echo("F.csv: done")
    {end}

module = types.ModuleType("gearmath.cli.slow")
module.slow = slow
sys.modules[module.__name__] = module
cli.VERBS["slow"] = ("slow", "A verb of this test.")
cli.main(["slow"])
"""


def on_a_terminal(code: str, both: bool = True) -> tuple[int, str]:
    """Status, and all that came to a terminal to which standard error, and output if ``both``, go."""
    master, slave = pty.openpty()
    termios.tcsetwinsize(slave, (24, 80))
    process = subprocess.Popen(
        [sys.executable, "-c", code],
        stdout=slave if both else subprocess.PIPE,
        stderr=slave,
        stdin=slave,
        env={**os.environ, "TERM": "xterm"},
    )
    os.close(slave)
    pieces = []
    while True:
        try:
            piece = os.read(master, 4096)
        except OSError:  # how Linux says that the other side is closed
            break
        if not piece:
            break
        pieces.append(piece)
    os.close(master)
    return process.wait(), b"".join(pieces).decode()


def shown(text: str) -> list[str]:
    """What stays on the lines of a terminal: a carriage return starts a line anew, ESC[K clears it."""
    lines = []
    for line in text.replace("\r\n", "\n").split("\n"):
        last = re.split(r"\r", line)[-1]
        lines.append(last.removeprefix("\x1b[K"))
    return [line.rstrip() for line in lines]


def test_something_moves_before_the_bar_and_after_it_and_only_the_result_stays() -> None:
    status, text = on_a_terminal(SLOW_VERB.format(end=""))
    assert status == 0
    before, after = text.split("0/2", 1)
    assert re.search(r"gearmath \|.*<=>.*\| 0 s", before)
    assert re.search(r"gearmath \|.*<=>.*\| 1 s", after)
    assert [line for line in shown(text) if line] == ["F.csv: done"]


def test_an_error_stays_alone_on_its_line() -> None:
    status, text = on_a_terminal(SLOW_VERB.format(end='raise click.ClickException("no such flank")'))
    assert status == 2
    assert [line for line in shown(text) if line] == ["F.csv: done", "gearmath: no such flank"]


def test_nothing_moves_where_nobody_looks() -> None:
    result = subprocess.run(
        [sys.executable, "-c", SLOW_VERB.format(end="")], capture_output=True, text=True, check=True
    )
    assert (result.stdout, result.stderr) == ("F.csv: done\n", "")

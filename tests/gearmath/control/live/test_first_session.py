"""The first session of docs/control.md does what the page says; a run that cannot begin leaves nothing in the store."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

PAGE = (Path(__file__).parents[4] / "docs" / "control.md").read_text("utf-8")
SECTION = PAGE.split("## A first session")[1].split("\n## ")[0]
GEARMATH = [sys.executable, "-c", "from gearmath.cli import main; main()"]
ENVIRONMENT = os.environ | {"GEARMATH_CONTROL_PASSWORD": "first"}


def lines(block: int) -> list[str]:
    return re.findall(r"```sh\n(.*?)```", SECTION, re.DOTALL)[block].strip().splitlines()


def words(line: str) -> list[str]:
    assert line.startswith("gearmath ")
    return [*GEARMATH, *shlex.split(line)[1:]]


def typed(control: subprocess.Popen[str], line: str) -> None:
    assert control.stdin is not None
    control.stdin.write(f"{line.removeprefix('# console: ')}\n")
    control.stdin.flush()


@pytest.fixture
def simulated(tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """The control of the first block, on any port that is free."""
    command = [*words(lines(0)[1]), "--port", "0"]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, cwd=tmp_path, env=ENVIRONMENT, text=True) as control:
        assert control.stdout is not None
        assert "ready" in control.stdout.readline()
        yield control
        typed(control, "quit")


@pytest.mark.slow
def test_first_session_of_the_page_ends_with_an_evaluation(tmp_path: Path, simulated: subprocess.Popen[str]) -> None:
    answers: list[str] = []
    steps = lines(1)
    for step, after in zip(steps, [*steps[1:], ""], strict=True):
        if step.startswith("# console:"):
            if "start" not in step:
                typed(simulated, step)
            continue
        with subprocess.Popen(
            words(step), cwd=tmp_path, env=ENVIRONMENT, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
        ) as process:
            assert process.stderr is not None
            if after == "# console: start":
                # the answers to what was typed before, and what the command says
                assert "ready for FIRST.MPF, 26 touches" in process.stderr.readline()
                typed(simulated, after)
            out, error = process.communicate(timeout=120)
            assert process.returncode == 0, error
            answers.append(out)
        if "control put" in step:
            measure = words(next(line for line in steps if " measure " in line))
            none = subprocess.run(measure, cwd=tmp_path, env=ENVIRONMENT, capture_output=True, text=True, check=False)
            assert none.returncode == 1
            assert "no program is selected, must be FIRST.MPF: select it at the machine" in none.stderr
    assert "run 1 is complete: 26 touches" in answers[2]  # the refused run before is not in the store
    assert "F_p" in answers[-1]

"""The closed loop from the shell: ``tests/loop.sh`` with the command of this environment."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

LOOP = Path(__file__).parents[2] / "loop.sh"


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="needs a POSIX shell")
def test_cut_mill_probe_and_compensate_from_the_shell_end_with_a_smaller_error(tmp_path):
    """The script itself compares: RMS, largest deviation and cumulative pitch become less than half of what they were.

    What is left is the noise of two touches, 0.7 um of 20 um, and what seven settings cannot correct.
    """
    command = Path(sys.executable).with_name("gearmath")
    done = subprocess.run(
        ["sh", str(LOOP), str(tmp_path)], env={**os.environ, "GEARMATH": str(command)}, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stderr == ""
    lines = done.stdout.splitlines()[-3:]
    assert [line.split(":")[0] for line in lines] == ["rms_um", "max_deviation_um", "F_p_um"]
    assert not [path for path in tmp_path.iterdir() if path.name.startswith(".")]  # no temporary file is left


def test_loop_fails_where_a_command_does(tmp_path):
    done = subprocess.run(
        ["sh", str(LOOP), str(tmp_path), "no_such_set.toml"],
        env={**os.environ, "GEARMATH": "false"},
        capture_output=True,
        text=True,
    )
    assert done.returncode != 0

"""LinuxCNC's own interpreter, as a process of the Python that it was installed for."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

PYTHON = Path("/usr/bin/python3")


@dataclass(frozen=True)
class Interpreted:
    """What the interpreter commands: kind, line, tool, F and position X Y Z A B C (n, 6) in mm and degrees."""

    kind: list[str]
    line: np.ndarray
    tool: np.ndarray
    feed: np.ndarray
    position: np.ndarray
    said: list[str]
    error: str


Interpreter = Callable[..., Interpreted]


@pytest.fixture
def interpreted(tmp_path: Path) -> Interpreter:
    """Runs a program text with the numbers and lengths of its tools, and parameters."""
    if shutil.which("rs274") is None:
        pytest.skip("needs LinuxCNC")

    def run(text: str, tools: Mapping[int, float], parameters: Mapping[int, float] | None = None) -> Interpreted:
        program, variables, table = (tmp_path / f"program.{end}" for end in ("ngc", "var", "tbl"))
        program.write_text(text, "ascii")
        variables.write_text("".join(f"{k}\t{v:.6f}\n" for k, v in sorted((parameters or {}).items())))
        table.write_text("".join(f"T{k} P{k} Z{length:.6f}\n" for k, length in sorted(tools.items())))
        # rs274 leaves the tool table in the memory file of this home, where the Python module looks for it
        environment = {**os.environ, "HOME": str(tmp_path)}
        (tmp_path / "none.ngc").write_text("M2\n")
        none = ["rs274", "-g", "-t", str(table), "-v", str(tmp_path / "none.var"), str(tmp_path / "none.ngc")]
        subprocess.run(none, env=environment, check=True, capture_output=True, timeout=60)
        script = Path(__file__).with_name("interpret.py")
        command = [str(PYTHON), str(script), str(program), str(variables), *(f"{k}={v}" for k, v in tools.items())]
        done = subprocess.run(command, env=environment, check=True, capture_output=True, timeout=60)
        found = json.loads(done.stdout)
        moves = found["moves"]
        values = np.array([one[1:] for one in moves], dtype=float).reshape(-1, 9)
        kind = [one[0] for one in moves]
        return Interpreted(kind, values[:, 0], values[:, 1], values[:, 2], values[:, 3:], found["said"], found["error"])

    return run

"""What is released works by itself: the wheel, made from the source archive, in an empty environment elsewhere."""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.slow


def run(folder: Path, *command: str | Path) -> str:
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    environment["MPLBACKEND"] = "agg"
    done = subprocess.run(
        [str(part) for part in command], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, f"{command}:\n{done.stdout}\n{done.stderr}"
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    run(ROOT, sys.executable, "-m", "build", "--no-isolation", "--outdir", folder)  # the archive, and the wheel from it
    (built,) = folder.glob("gearmath-*-py3-none-any.whl")
    return built


@pytest.fixture(scope="module")
def programs(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the programs of an environment that holds the wheel and its dependencies, nothing else."""
    home = tmp_path_factory.mktemp("environment")
    run(home, sys.executable, "-m", "venv", "--without-pip", home / "venv")
    python = home / "venv" / "bin" / "python"
    run(
        home,
        sys.executable,
        "-m",
        "pip",
        "--python",
        python,
        "install",
        "--quiet",
        "--disable-pip-version-check",
        "--no-compile",
        wheel,
    )
    return python.parent


def test_wheel_holds_both_packages_with_all_their_files_and_nothing_else(wheel: Path) -> None:
    names = {name for name in zipfile.ZipFile(wheel).namelist() if ".dist-info/" not in name}
    ours = {
        path.relative_to(ROOT).as_posix()
        for package in ("derivations", "gearmath")
        for path in (ROOT / package).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert names == ours


def test_packages_are_imported_from_the_wheel(programs: Path, tmp_path: Path) -> None:
    code = "import gearmath, derivations; print(gearmath.__file__); print(derivations.__file__)"
    for line in run(tmp_path, programs / "python", "-c", code).splitlines():
        assert Path(line).is_relative_to(programs.parent)


def test_command_shows_its_help(programs: Path, tmp_path: Path) -> None:
    assert "demo" in run(tmp_path, programs / "gearmath", "--help")


def test_demo_runs_outside_the_repository(programs: Path, tmp_path: Path) -> None:
    run(tmp_path, programs / "gearmath", "demo", "-o", tmp_path / "shown")
    assert list((tmp_path / "shown").rglob("*.png"))

"""What all tests share: the update of the golden files, and the compilers that some tests need."""

from __future__ import annotations

import os
import shutil

import pytest

from gearmath.errors import ComputationError
from gearmath.export.host import find_compiler


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update-golden", action="store_true", help="rewrite tests/golden with the text of today")


def _missing(tool: str) -> None:
    """Skip by name where a newcomer lacks a tool; in CI its absence is a failure."""
    if os.environ.get("CI") == "true":
        pytest.fail(f"{tool} is missing in CI")
    pytest.skip(f"needs {tool}")


@pytest.fixture(scope="session")
def host_compiler() -> tuple[str, ...]:
    """The command that compiles C for this computer."""
    try:
        return find_compiler()
    except ComputationError:
        _missing("a C compiler")
        raise


@pytest.fixture(scope="session")
def gcc() -> str:
    """GCC itself, for the flags that only it has."""
    path = shutil.which("gcc")
    if path is None:
        _missing("gcc")
    return str(path)

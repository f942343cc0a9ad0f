"""What all tests share: the update of the golden files, and the compilers that some tests need."""

from __future__ import annotations

import os
import shutil
from collections import Counter
from collections.abc import Generator

# before NumPy is loaded, and for the commands that tests start: products of small matrices on several threads of the
# BLAS cost more in waiting than they save, and the processes of a run take all cores already
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import pytest
from hypothesis import settings

from gearmath.engine.compiler import find_compiler
from gearmath.errors import ComputationError

# how long an example takes says nothing on a machine that does other things as well
settings.register_profile("gearmath", deadline=None)
settings.load_profile("gearmath")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update-golden", action="store_true", help="rewrite tests/golden with the text of today")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files with slow tests come first: all processes of a run, which take whole files, then end together."""
    slow = Counter(item.path for item in items if item.get_closest_marker("slow"))
    items.sort(key=lambda item: -slow[item.path])


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """What a newcomer lacks is skipped by name; in CI, which installs everything, a skip is a failure."""
    report = yield
    if report.skipped and os.environ.get("CI") == "true" and not hasattr(report, "wasxfail"):
        report.outcome = "failed"
        report.longrepr = f"{item.nodeid} was skipped in CI: {report.longrepr}"
    return report


@pytest.fixture(scope="session")
def host_compiler() -> tuple[str, ...]:
    """The command that compiles C for this computer."""
    try:
        return find_compiler()
    except ComputationError:
        pytest.skip("needs a C compiler")


@pytest.fixture(scope="session")
def gcc() -> str:
    """GCC itself, for the flags that only it has."""
    path = shutil.which("gcc")
    if path is None:
        pytest.skip("needs gcc")
    return str(path)

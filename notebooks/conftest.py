"""The notebooks as nbval ran them are kept in build/notebooks, with their outputs, so that the site runs none again."""

from __future__ import annotations

from pathlib import Path

import nbformat
import pytest

EXECUTED = Path(__file__).parents[1] / "build" / "notebooks"


@pytest.hookimpl(trylast=True)
def pytest_runtest_teardown(item: pytest.Item, nextitem: pytest.Item | None) -> None:
    outputs = getattr(item, "test_outputs", None)
    if outputs is None:
        return
    item.cell.outputs = outputs  # type: ignore[attr-defined]
    if nextitem is None or nextitem.parent is not item.parent:
        EXECUTED.mkdir(parents=True, exist_ok=True)
        nbformat.write(item.parent.nb, EXECUTED / item.path.name)  # type: ignore[union-attr]

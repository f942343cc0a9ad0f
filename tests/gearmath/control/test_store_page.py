"""The page on the store names the tables, the version and the commands that there are."""

from __future__ import annotations

import re
from pathlib import Path

from gearmath.cli.runs import runs
from gearmath.control.store import MeasurementStore
from gearmath.control.store_schema import VERSION

PAGE = (Path(__file__).parents[3] / "docs" / "measurement_store.md").read_text("utf-8")


def test_every_table_of_a_store_is_on_its_page(store: MeasurementStore) -> None:
    tables = {name for (name,) in store.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
    section = PAGE.split("## What is in the file")[1].split("## What may go wrong")[0]
    named = {
        name for row in re.findall(r"^\| (`.*?) \|", section, re.MULTILINE) for name in re.findall(r"`(\w+)`", row)
    }
    assert named == {name for name in tables if not name.startswith("sqlite_")}
    assert f"`user_version` the version of the tables, {VERSION} at present" in section


def test_every_command_is_on_the_page() -> None:
    assert set(re.findall(r"^\| `runs (\w+)", PAGE, re.MULTILINE)) == set(runs.commands)

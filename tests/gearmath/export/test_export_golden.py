"""Golden copies of everything that is exported: a change of the C shows as a diff that someone owns up to.

``pytest --update-golden`` rewrites them.
"""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from pathlib import Path

import pytest

from gearmath.export import teensy
from gearmath.export.cnc import by_hand, cnc_files
from gearmath.export.folder import MANIFEST, manifest, write_folder
from gearmath.specs.hobbing import load_hobbing_machine
from gearmath.specs.toml import bundled

GOLDEN = Path(__file__).parents[2] / "golden"


def _exports() -> dict[str, dict[str, str]]:
    """What is generated; C that is written by hand goes out as it stands, and needs no second copy."""
    machine = load_hobbing_machine(bundled("hobbing_plewes.toml"))
    firmware = {path.read_text("utf-8") for path in Path(teensy.__file__).with_name("firmware").iterdir()}
    sketch = {name: text for name, text in teensy.teensy_files(machine, "teensy").items() if text not in firmware}
    # the last bit of a vector depends on the C library: its sine is not the same everywhere
    kept = by_hand().keys() - {"README.md"} | {"selftest_vectors.h"}
    library = {name: text for name, text in cnc_files().items() if name not in kept}
    return {"teensy": sketch, "cnc": library}


@pytest.mark.parametrize("folder", ["teensy", "cnc"])
def test_exported_text_equals_the_golden_copy(folder: str, request: pytest.FixtureRequest) -> None:
    files = _exports()[folder]
    if request.config.getoption("--update-golden"):
        write_folder(GOLDEN / folder, files)
    assert _difference(GOLDEN / folder, {**files, MANIFEST: manifest(files)}) == ""


def _difference(folder: Path, files: Mapping[str, str]) -> str:
    stored = {path.name: path.read_text("utf-8") for path in folder.glob("*") if path.is_file()}
    lines: list[str] = []
    for name in sorted(stored.keys() | files.keys()):
        old, new = stored.get(name, ""), files.get(name, "")
        lines += difflib.unified_diff(
            old.splitlines(keepends=True),
            new.splitlines(keepends=True),
            f"golden/{folder.name}/{name}",
            f"exported {name}",
        )
    return "".join(lines)

"""The files of a run as a folder: program, set, machine and probe as they were, touches, alarms and results."""

from __future__ import annotations

import json
from pathlib import Path

from gearmath.control.store_place import inside
from gearmath.control.store_run import StoredRun
from gearmath.control.store_summary import summary
from gearmath.control.store_touches import touch_csv
from gearmath.errors import InputError
from gearmath.files import write_bytes


def write_run(run: StoredRun, folder: Path) -> list[Path]:
    """Write all that is stored of a run into a new folder; ``run.json`` lists it with its hashes.

    A file whose name, as a control gave it, could lead elsewhere is written under its role and number, a new
    calibration or machine file as ``new_calibration.toml`` or ``new_machine.toml`` beside the one that the run was
    begun with. Raises InputError where the folder is there already.
    """
    try:
        folder.mkdir()
    except OSError as error:
        raise InputError(f"{folder}: cannot be made: {error.strerror}") from error
    contents: dict[str, bytes] = {"touches.csv": touch_csv(run).encode("utf-8")}
    listed = [{"file": "touches.csv", "role": "touches", "name": "touches.csv"}]
    for role, name, content, sha256 in run.store.files(run.id):
        free = _free(folder, name, f"{role}_{len(listed)}", contents)
        contents[free] = content
        listed.append({"file": free, "role": role, "name": name, "sha256": sha256})
    for kind, content in run.results().items():
        # the file of a calibration run is a new state of one that it was begun with, and is called the same
        name = f"new_{kind}" if kind in contents else kind
        free = _free(folder, name, f"result_{len(listed)}", contents)
        contents[free] = content
        listed.append({"file": free, "role": "result", "name": kind})
    known = {
        **vars(summary(run)),
        "settings": dict(run.start.settings),
        "sessions": run.sessions(),
        "endings": run.endings(),
        "alarms": [vars(alarm) for alarm in run.alarms()],
        "files": listed,
    }
    contents["run.json"] = (json.dumps(known, indent=2) + "\n").encode("utf-8")
    paths = []
    for name, content in contents.items():
        paths.append(inside(folder, name))
        write_bytes(paths[-1], content)
    return paths


def _free(folder: Path, name: str, other: str, taken: dict[str, bytes]) -> str:
    """A name that may be written: the stored one, or the ``other`` where that leads elsewhere or is taken."""
    try:
        name = inside(folder, name).name
    except InputError:
        return other
    return other if name.lower() in {"run.json", *(each.lower() for each in taken)} else name

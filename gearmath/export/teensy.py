"""The Arduino sketch folder of one machine: portable firmware, generated kernels and constants, wiring and README.

The folder's name is the sketch's name, as the Arduino tools ask for: ``gear/gear.ino``.
"""

from __future__ import annotations

import os
import re
from importlib import resources
from pathlib import Path

from gearmath.errors import InputError
from gearmath.export.c import integer_kernel
from gearmath.export.folder import write_folder
from gearmath.export.guide import guide
from gearmath.export.machine_header import machine_header
from gearmath.export.wiring import wiring_svg
from gearmath.kernels import kernel
from gearmath.specs.hobbing import HobbingMachine

_SKETCH = "sketch.ino"


def teensy_files(machine: HobbingMachine, sketch: str = "gearbox") -> dict[str, str]:
    """File name to text of the sketch called ``sketch``.

    Raises InputError where the name cannot be a sketch's, or a number of the machine is beyond the kernels' domain.
    """
    if not re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,62}", sketch):
        raise InputError(
            f"output = {sketch!r}: the folder's name becomes the sketch's name, which takes 1 to 63 plain letters, "
            "digits, _, - and ., the first of them no - and no ."
        )
    files = _firmware()
    files[f"{sketch}.ino"] = files.pop(_SKETCH)
    files |= integer_kernel(kernel("gearbox_edge"), bits=64 if machine.wide else 32, inline=True).files
    files |= integer_kernel(kernel("encoder_hysteresis"), inline=True).files
    files |= integer_kernel(kernel("counter_motion"), inline=True).files
    files["gm_machine.h"] = machine_header(machine)
    files["wiring.svg"] = wiring_svg(machine)
    files["README.md"] = guide(machine, sketch)
    return files


def machine_of(folder: Path) -> str | None:
    """The name of the machine that a sketch folder was written for, or None where there is none."""
    try:
        found = re.search(r'^#define GM_NAME "(.*)"$', (folder / "gm_machine.h").read_text("utf-8"), re.MULTILINE)
    except (OSError, UnicodeDecodeError):
        return None
    return None if found is None else found[1]


def export_teensy(machine: HobbingMachine, folder: Path) -> tuple[str, ...]:
    """Write the folder and return the names of its files. Raises InputError where it holds other files."""
    files = teensy_files(machine, Path(os.path.abspath(folder)).name)
    write_folder(folder, files)
    return tuple(sorted(files))


def _firmware() -> dict[str, str]:
    """The hand-written files that come with the package."""
    folder = resources.files("gearmath") / "export" / "firmware"
    return {
        entry.name: entry.read_text("utf-8")
        for entry in sorted(folder.iterdir(), key=lambda entry: entry.name)
        if entry.name.endswith((".c", ".h", ".ino"))
    }

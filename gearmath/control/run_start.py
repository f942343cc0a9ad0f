"""What a measuring run begins with: the program, its points, and the files that it was made from."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from gearmath.control.interface import RunStart
from gearmath.control.parts import chosen_points
from gearmath.control.plan import WHOLE, choosing, planned, triggers
from gearmath.control.store_run import StoredRun
from gearmath.control.store_summary import parts
from gearmath.errors import InputError
from gearmath.files import read_bytes
from gearmath.machine.control.file_names import control_name, linuxcnc_name
from gearmath.machine.control.state import Setup
from gearmath.machine.control.text import decoded, is_for_linuxcnc
from gearmath.machine.measuring.artefacts import Artefacts
from gearmath.machine.measuring.probe_run import touches_artefacts
from gearmath.specs.calibration import load_calibration
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import find

#: Names under which the store keeps the files.
SET, MACHINE, CALIBRATION = "set.toml", "machine.toml", "calibration.toml"
#: Bundled files that a run takes where none is named.
BUNDLED = {MACHINE: "vertical_5axis.toml", CALIBRATION: "probe.toml"}


def begun(
    control: str,
    program: Path,
    gear_set: str | None,
    machine: str,
    calibration: str,
    points: str | None = None,
    refers_to: int | None = None,
) -> tuple[RunStart, list[tuple[int, int]]]:
    """A new run of a program, and R90 and R91 of each start with which it makes these ``points`` (such as ``3,17-20``;
    None: all).

    Raises InputError where the program offers no touches, or has not these points.
    """
    content = read_bytes(program)
    text = decoded(content, str(program))
    name = linuxcnc_name(program.name) if is_for_linuxcnc(text) else control_name(program.name)
    paths = {MACHINE: find(machine), CALIBRATION: find(calibration)}
    if gear_set is not None:
        paths[SET] = find(gear_set)
    elif not touches_artefacts(text):
        raise InputError(f"--set is missing: {program} probes a member")
    at, known = load_milling_machine(paths[MACHINE]), load_calibration(paths[CALIBRATION])
    setup = Setup.of(at, known.length)
    probe = Artefacts(at, known) if touches_artefacts(text) else triggers
    plan, stretches = planned(text, str(program), setup, probe=probe), [WHOLE]
    if points is not None:
        wanted = chosen_points("--points", points, plan.points)
        plan, stretches = choosing(text, str(program), setup, plan, wanted, probe)
    files = {key: read_bytes(path) for key, path in paths.items()}
    settings = {key: path.name for key, path in paths.items()}
    return RunStart(control, name, content, plan.columns, plan.points, files, settings, refers_to=refers_to), stretches


@contextmanager
def files_of(
    old: RunStart | None, gear_set: str | None, machine: str | None, calibration: str | None
) -> Iterator[tuple[str | None, str, str]]:
    """Set, machine and calibration of a new run: as given, else those of the run whose points it touches again, which
    lie in a folder for the time of this context, else the bundled ones."""
    with TemporaryDirectory() as folder:

        def of(role: str, given: str | None) -> str | None:
            if given is not None or old is None or role not in old.files:
                return given
            path = Path(folder, role, Path(old.settings.get(role, role)).name)
            path.parent.mkdir()
            path.write_bytes(old.files[role])
            return str(path)

        yield (
            of(SET, gear_set),
            of(MACHINE, machine) or BUNDLED[MACHINE],
            of(CALIBRATION, calibration) or BUNDLED[CALIBRATION],
        )


def resumed(run: StoredRun) -> list[tuple[int, int]]:
    """R90 and R91 of each start with which the program of a run makes what is missing."""
    missing = run.missing()
    return parts(run, missing) if missing else [WHOLE]

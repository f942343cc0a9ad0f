"""Ten points probed by LinuxCNC on a surface of our own generated C, which runs in the servo thread beside the planner.

The surface has metal that is known: what the touches say of it may be late by the way of one servo cycle, and no more.
"""

from __future__ import annotations

import asyncio
import os
import shutil
import sqlite3
import subprocess
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

from gearmath import cli
from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.turning import turned
from gearmath.control.linuxcnc_client import PYTHON, LinuxCncControl
from gearmath.control.measuring import Measuring
from gearmath.control.run_start import begun, resumed
from gearmath.control.store import MeasurementStore
from gearmath.control.store_run import StoredRun
from gearmath.control.store_touches import touch_csv
from gearmath.errors import ComputationError
from gearmath.kernels import kernel
from gearmath.machine.bodies.probe_tip import probe_height
from gearmath.machine.planning.pattern import Targets
from gearmath.machine.planning.targets import MEASURING_FEED
from gearmath.machine.writing.linuxcnc.probing import write_touches
from gearmath.machine.writing.probing import probed, probing_notes
from gearmath.specs.bevel_set import FLANKS, BevelSet, load_bevel_set
from gearmath.specs.calibration import Calibration, load_calibration
from gearmath.specs.flank_csv import read_flank_csv
from gearmath.specs.milling_machine import MillingMachine, load_milling_machine
from gearmath.specs.toml import bundled

if TYPE_CHECKING:
    from conftest import LiveLinuxCnc, Start

SET, MEMBER = "nasa_tp3096_12x36.toml", "pinion"
MODULES = Path("/usr/lib/linuxcnc/modules")
SURFACE = "gearmath_surface"
#: LinuxCNC runs as an ordinary user, and so does what speaks with it.
ORDINARY = ("setpriv", "--reuid=nobody", "--regid=nogroup", "--clear-groups") if os.geteuid() == 0 else ()
#: Metal too much on the flanks of a tooth. [mm]
STOCK = {"concave": 0.012, "convex": -0.007}
#: The operator aborts the run after this point.
STOP = 4
#: The way of the tip in one servo cycle of 1 ms. [mm]
CYCLE = MEASURING_FEED / 60_000


@pytest.fixture
def machine() -> MillingMachine:
    return load_milling_machine(bundled("vertical_5axis.toml"))


@pytest.fixture
def calibration() -> Calibration:
    return load_calibration(bundled("probe.toml"))


def some_points(
    teeth: int, bevel_set: BevelSet, machine: MillingMachine, calibration: Calibration
) -> tuple[str, Targets]:
    """A program that touches the reference points of both flanks of some teeth."""
    member = bevel_set.member(MEMBER)
    targets, level, room = probed(member, machine, calibration, "POINTS", (), True, ())
    targets = targets.pick(targets.tooth < teeth)
    notes = (*probing_notes(bevel_set, MEMBER, machine, calibration, len(targets), 1),)
    text = write_touches("POINTS", notes, targets, MEMBER, member.teeth, machine, calibration, level, room)
    return text, targets


COMPONENT = """component gearmath_surface "A flank that a probe touches";
pin in float x;
pin in float y;
pin in float z;
pin in float a;
pin in float b;
pin out bit touched;
function _ fp;
license "GPL";
include "{header}";
;;
FUNCTION(_) {{
    double at[5] = {{x, y, z, a, b}};
    touched = gearmath_touched(at);
}}
"""


async def measured(
    control: LiveLinuxCnc, run: StoredRun, parts: list[tuple[int, int]], database: Path, stop_after: int = 0
) -> list[tuple[int, int]]:
    """The run to its end; how many touches another look at the file finds when a point is acknowledged.

    The operator aborts it after a point, and raises Z.
    """
    seen = []

    class Watched(LinuxCncControl):
        async def acknowledge(self, point: int) -> None:
            with closing(sqlite3.connect(f"file:{database}?mode=ro", uri=True)) as other:
                seen.append((point, other.execute("select count(*) from touch").fetchone()[0]))
            await super().acknowledge(point)
            if point == stop_after:
                (control.folder / "abort.part").write_text("900")
                (control.folder / "abort.part").rename(control.folder / "abort")

    async def connect() -> LinuxCncControl:
        return await Watched.connect(control.ini, (*ORDINARY, "env", f"HOME={control.folder}", *PYTHON))

    def say(sentence: str) -> None:
        if "start it" in sentence:
            control.start()

    try:
        await asyncio.wait_for(Measuring(connect, run, say=say).to_the_end(*parts), 120)
    except ComputationError:
        print((control.folder / "log").read_text(errors="replace")[-3000:])  # pytest shows it where a test fails
        raise
    return seen


def flanks_in_c(
    bevel_set: BevelSet,
    targets: Targets,
    machine: MillingMachine,
    calibration: Calibration,
    sources: Mapping[str, Path],
) -> str:
    """C that tells whether the tip of the probe touches: it does within the metal at one of the tangent planes."""
    member = bevel_set.member(MEMBER)
    grid = blank_grid(member)
    found = {flank: solve_flank(member, flank, grid) for flank in FLANKS}
    shape = grid.shape
    rows = []
    for k in range(len(targets)):
        flank, row, col = targets.place(k)
        points, at = found[flank], row * shape[1] + col
        angle = 2 * np.pi * targets.tooth[k] / member.teeth
        point, normal = (turned(one[at], angle) for one in (points.point, points.normal))
        rows.append("{" + ", ".join(f"{value!r}" for value in (*point.tolist(), *normal.tolist(), STOCK[flank])) + "}")
    pivot, zero = (
        ", ".join(f"{value!r}" for value in one) for one in (machine.pivot.tolist(), machine.work_offset_values)
    )
    return f"""
#undef CASADI_PREFIX
#include "{sources["gm_tool_pose"]}"
#undef CASADI_PREFIX
#include "{sources["gm_point_deviation"]}"

static const double surface[{len(rows)}][7] = {{
    {", ".join(rows)}
}};

static int gearmath_touched(const double at[5])
{{
    const double pivot[3] = {{{pivot}}};
    const double zero[5] = {{{zero}}};
    const double radian = 0.017453292519943295;
    const double axes[5] = {{
        at[0] - zero[0], at[1] - zero[1], at[2] - zero[2], (at[3] - zero[3]) * radian, (at[4] - zero[4]) * radian
    }};
    double tip[3], direction[3], deviation, away;
    int k, i;
    gm_tool_pose(axes, {probe_height(machine, calibration)!r}, pivot, tip, direction);
    for (k = 0; k < {len(rows)}; ++k) {{
        gm_point_deviation(tip, {calibration.tip_radius!r}, surface[k], surface[k] + 3, &deviation);
        away = 0.0;
        for (i = 0; i < 3; ++i)
            away += (tip[i] - surface[k][i]) * (tip[i] - surface[k][i]);
        if (deviation < surface[k][6] && away < 4.0)
            return 1;
    }}
    return 0;
}}
"""


@pytest.fixture
def surface(tmp_path: Path) -> Iterator[Callable[[str], str]]:
    """Compiles C of a surface for the servo thread, installs it while a test runs, and says what HAL must load."""
    if shutil.which("halcompile") is None:
        pytest.skip("needs LinuxCNC and its dev package")
    if not os.access(MODULES, os.W_OK):
        pytest.skip("needs the right to install a realtime component")

    def install(text: str) -> str:
        (tmp_path / "surface.h").write_text(text)
        (tmp_path / f"{SURFACE}.comp").write_text(COMPONENT.format(header=tmp_path / "surface.h"))
        command = ["halcompile", "--install", f"{SURFACE}.comp"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120)
        assert done.returncode == 0, done.stdout + done.stderr
        name = SURFACE.replace("_", "-")
        pins = "".join(f"net place-{k} joint.{k}.pos-cmd {name}.0.{axis}\n" for k, axis in enumerate("xyzab"))
        return f"loadrt {SURFACE}\naddf {name}.0 servo-thread\n{pins}net probe {name}.0.touched\n"

    try:
        yield install
    finally:
        (MODULES / f"{SURFACE}.so").unlink(missing_ok=True)


def set_up(
    folder: Path,
    live: Start,
    surface: Callable[[str], str],
    text: str,
    bevel_set: BevelSet,
    there: Targets,
    machine: MillingMachine,
    calibration: Calibration,
) -> LiveLinuxCnc:
    """A LinuxCNC with a program selected, and metal where the probe is to find it; a host will hear its errors."""
    cli.main(["export", "cnc", "-o", str(folder / "c")])
    sources = {name: next((folder / "c").rglob(f"{name}.c")) for name in ("gm_tool_pose", "gm_point_deviation")}
    hal = surface(flanks_in_c(bevel_set, there, machine, calibration, sources))
    length = calibration.length if machine.z_reference == "tip" else 0.0
    control = live("POINTS", text, machine, {"PROBE": (99, length)}, hal)
    (control.folder / "host").touch()
    return control


@pytest.mark.slow
def test_touches_are_stored_before_they_are_acknowledged_and_an_aborted_run_goes_on_at_the_first_missing_point(
    live: Start, surface: Callable[[str], str], machine: MillingMachine, calibration: Calibration, tmp_path: Path
) -> None:
    bevel_set = load_bevel_set(bundled(SET))
    text, targets = some_points(5, bevel_set, machine, calibration)
    assert len(targets) == 10
    control = set_up(tmp_path, live, surface, text, bevel_set, targets, machine, calibration)

    database = tmp_path / "runs.db"
    with MeasurementStore.open(database) as store:
        start, parts = begun("LinuxCNC", control.folder / "POINTS.ngc", SET, "vertical_5axis.toml", "probe.toml")
        run = store.begin_run(start)
        with pytest.raises(ComputationError, match=rf"{STOP} of 10 touches.*--resume {run.id}"):
            asyncio.run(measured(control, run, parts, database, STOP))
        control.wait("ended", 120)
        run = store.resume_run(run.id)
        assert resumed(run) == [(STOP + 1, 10)]
        again = asyncio.run(measured(control, run, resumed(run), database))
    control.wait("ended", 120)
    result = (control.folder / "POINTS_T.csv").read_text()
    control.leave()

    # on a busy computer the answer is seen late, and given again: to the same point
    assert list(dict.fromkeys(again)) == [(point, point) for point in range(STOP + 1, 11)]
    touches = tmp_path / "touches.csv"
    with MeasurementStore.open(database) as store:
        touches.write_text(touch_csv(store.run(run.id)))
    kept, logged = (
        np.loadtxt([line for line in text.splitlines() if line[0].isdigit()], delimiter=",", usecols=range(7, 12))
        for text in (touches.read_text(), result)
    )
    assert len(kept) == 10
    np.testing.assert_allclose(kept, logged, rtol=0, atol=1e-7)  # the log has seven decimals

    cli.main(["touches", str(touches), "--set", SET, "--run", str(run.id), "-o", str(tmp_path / "measured.csv")])
    found = read_flank_csv(tmp_path / "measured.csv")
    stock = np.array([STOCK[flank] for flank in found.flank])
    late = stock - found.deviation
    assert late.min() > -1e-6
    assert late.max() < CYCLE + 1e-6


@pytest.mark.slow
def test_offsets_and_tool_lengths_are_in_the_touches_and_a_point_that_is_not_there_ends_the_run_with_its_alarm(
    live: Start, surface: Callable[[str], str], machine: MillingMachine, calibration: Calibration, tmp_path: Path
) -> None:
    zero = {"z_reference": "tip", "work_offset": "G55", "work_offset_values": (5.0, -3.0, 40.0, 12.0, 0.5)}
    shifted = machine.model_copy(update=zero)
    bevel_set = load_bevel_set(bundled(SET))
    text, targets = some_points(2, bevel_set, shifted, calibration)
    control = set_up(tmp_path, live, surface, text, bevel_set, targets.pick(np.arange(4) < 3), shifted, calibration)

    database = tmp_path / "runs.db"
    with MeasurementStore.open(database) as store:
        start, parts = begun("LinuxCNC", control.folder / "POINTS.ngc", SET, "vertical_5axis.toml", "probe.toml")
        run = store.begin_run(start)
        with pytest.raises(ComputationError, match=r"before point 4 \(alarm 1: point 4: touched nothing\); 3 of 4"):
            asyncio.run(measured(control, run, parts, database))
        control.wait("ended", 120)
        control.leave()
        assert [alarm.text for alarm in run.alarms()] == ["point 4: touched nothing"]
        touches = np.array([touch[1:6] for touch in run.touches().values()])

    touches[:, 3:] = np.radians(touches[:, 3:])
    offset, height = calibration.tip_offset, probe_height(shifted, calibration)
    tip, _ = kernel("probe_tip")(touches, height, offset, shifted.pivot)
    member = bevel_set.member(MEMBER)
    for k, (flank, tooth) in enumerate(zip(targets.flank[:3], targets.tooth[:3], strict=True)):
        points = solve_flank(member, flank, blank_grid(member))
        at = len(points.point) // 2  # the reference point
        angle = 2 * np.pi * tooth / member.teeth
        away = (tip[k] - turned(points.point[at], angle)) @ turned(points.normal[at], angle)
        late = STOCK[flank] - (away - calibration.tip_radius)
        assert -1e-6 < late < CYCLE + 1e-6

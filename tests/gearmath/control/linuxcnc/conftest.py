"""A LinuxCNC of its own for a test: started without display, as an ordinary user, from the example configuration."""

from __future__ import annotations

import fcntl
import json
import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import pytest

from gearmath.machine.writing.linuxcnc.configuration import configuration
from gearmath.specs.milling_machine import MillingMachine

#: LinuxCNC refuses to run as root.
ORDINARY = ("setpriv", "--reuid=nobody", "--regid=nogroup", "--clear-groups") if os.geteuid() == 0 else ()
#: Positions of all joints and the line of the program, in every servo cycle.
SAMPLER = "".join(
    (
        "loadrt sampler depth=20000 cfg=fffffs\n",
        "addf sampler.0 servo-thread\n",
        *(f"net place-{k} joint.{k}.pos-fb sampler.0.pin.{k}\n" for k in range(5)),
        "net line motion.program-line sampler.0.pin.5\n",
        "loadusr halsampler -t samples.txt\n",
    )
)


@dataclass(frozen=True)
class LiveLinuxCnc:
    """A LinuxCNC that runs: its folder, and what its operator does."""

    folder: Path
    ini: Path
    process: subprocess.Popen[bytes]

    def state(self) -> dict:
        try:
            return json.loads((self.folder / "state").read_text())
        except FileNotFoundError:
            return {"state": "starting"}

    def wait(self, state: str, seconds: float) -> dict:
        end = time.monotonic() + seconds
        while (now := self.state())["state"] != state:
            log = (self.folder / "log").read_text(errors="replace")[-2000:]
            assert self.process.poll() is None, log
            assert time.monotonic() < end, f"{now}\n{log}"
            time.sleep(0.02)
        return now

    def start(self) -> None:
        (self.folder / "start").touch()

    def leave(self) -> None:
        (self.folder / "leave").touch()
        self.process.wait(30)


Start = Callable[..., LiveLinuxCnc]


@pytest.fixture
def live() -> Iterator[Start]:
    """``live(text, machine, tools, hal)``: LinuxCNC with a program selected, and more lines for its HAL file."""
    if shutil.which("linuxcnc") is None:
        pytest.skip("needs LinuxCNC")
    folder = Path(tempfile.mkdtemp(prefix="gearmath-linuxcnc-"))
    running: list[LiveLinuxCnc] = []

    def run(
        name: str, text: str, machine: MillingMachine, tools: Mapping[str, tuple[int, float]], hal: str = SAMPLER
    ) -> LiveLinuxCnc:
        (folder / f"{name}.ngc").write_text(text, "ascii")
        files = configuration(name, machine, dict(tools))
        files[".ini"] = files[".ini"].replace("DISPLAY = axis", "DISPLAY = ./screen.py")
        # on a busy computer without a realtime kernel the servo thread may stand still for a while
        files[".ini"] = files[".ini"].replace("COMM_TIMEOUT = 1.0", "COMM_TIMEOUT = 60.0")
        files[".hal"] += hal
        for suffix, content in files.items():
            (folder / f"{name}{suffix}").write_text(content)
        shutil.copy(Path(__file__).with_name("screen.py"), folder)
        (folder / "screen.py").chmod(0o755)
        if ORDINARY:
            for path in (folder, *folder.iterdir()):
                shutil.chown(path, "nobody", "nogroup")
        with open(folder / "log", "wb") as log:
            process = subprocess.Popen(
                [*ORDINARY, "linuxcnc", "-r", f"{name}.ini"],
                cwd=folder,
                env={**os.environ, "HOME": str(folder)},
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
            )
        running.append(LiveLinuxCnc(folder, folder / f"{name}.ini", process))
        running[-1].wait("ready", 120)
        return running[-1]

    # there is one realtime memory on a computer: tests that run side by side take turns
    with open(Path(tempfile.gettempdir()) / "gearmath-linuxcnc.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        try:
            yield run
        finally:
            for one in running:
                if one.process.poll() is None:
                    one.leave()
            shutil.rmtree(folder, ignore_errors=True)

"""Runs beside LinuxCNC, in the Python that has its modules, and answers one JSON line for every line that it reads.

It knows nothing of this package: ``python3 linuxcnc_bridge.py MACHINE.ini``. It reads what the control shows, sets the
signals of the handshake, and never starts, stops or moves anything.
"""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

import linuxcnc

ERRORS = {linuxcnc.NML_ERROR, linuxcnc.OPERATOR_ERROR}


class Bridge:
    """One connection to a LinuxCNC that runs on this computer."""

    def __init__(self, ini: str) -> None:
        linuxcnc.nmlfile = linuxcnc.ini(ini).find("EMC", "NML_FILE") or linuxcnc.nmlfile
        self.stat, self.errors = linuxcnc.stat(), linuxcnc.error_channel()
        self.message = ""
        self.stat.poll()

    def status(self) -> dict[str, Any]:
        """How the control stands, and the errors since the last look."""
        self.stat.poll()
        heard = []
        while (one := self.errors.poll()) is not None:
            kind, text = one
            if kind in ERRORS:
                heard.append(text.strip())
            else:
                self.message = text.strip()
        return {
            "interpreter": self.stat.interp_state,
            "mode": self.stat.task_mode,
            "paused": bool(self.stat.paused),
            "file": self.stat.file,
            "position": list(self.stat.actual_position[:5]),
            "message": self.message,
            "errors": heard,
            "out": list(self.stat.aout[:8]),
            "in": self.stat.ain[0],
            "host": bool(self.stat.din[0]),
            "probe": bool(self.stat.probe_val),
            "idle": linuxcnc.INTERP_IDLE,
            "modes": [linuxcnc.MODE_MANUAL, linuxcnc.MODE_MDI, linuxcnc.MODE_AUTO],
        }

    def set(self, signal: str, value: float) -> dict[str, Any]:
        """Set a signal that nothing else drives; it keeps its value when this process has gone."""
        done = subprocess.run(["halcmd", "sets", signal, str(value)], capture_output=True, text=True, timeout=5)
        return {"refused": f"halcmd sets {signal}: {done.stderr.strip()}"} if done.returncode else {}


def main() -> None:
    bridge = Bridge(sys.argv[1])
    print(json.dumps({"ready": True}), flush=True)
    for line in sys.stdin:
        asked = json.loads(line)
        try:
            answer = getattr(bridge, asked.pop("do"))(**asked)
        except (linuxcnc.error, subprocess.SubprocessError, OSError, SystemError) as error:
            answer = {"refused": str(error)}
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()

"""Answers as the process beside LinuxCNC does, for a program of three points that begins when a host is there.

python stand_in.py BRIDGE MACHINE.ini: keeps what it is told in ``told`` beside the INI file; ``mood`` spoils it.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

folder = Path(sys.argv[2]).parent
told = folder / "told"
mood = (folder / "mood").read_text() if (folder / "mood").exists() else ""
if mood == "absent":
    raise SystemExit(1)
print("words of its own")
print(json.dumps({"ready": True}), flush=True)
# the answer of an earlier run, to its second point, still stands
run, point, answer, host, looks, first = 3, 0, 3_000_002, False, 0, 1


def status() -> dict:
    global run, point, looks
    looks += 1
    if host and run == 3 and looks > 3:
        run, point = 4, 0
    elif run == 4 and (point == 0 or answer == 4_000_000 + point) and point < 3:
        point = point + 1 if point else first
    over = run == 4 and point == 3 and answer == 4_000_003
    return {
        "interpreter": 1 if not host or over or run == 3 else 2,
        "mode": 2,
        "paused": False,
        "probe": False,
        "file": "/somewhere/P.ngc",
        "position": [1.0, 2.0, 3.0, 4.0, 5.0],
        "message": "point",
        "errors": ["the lamp is out"] if looks == 5 else [],
        "out": [point, run, 10.0 + point, 20.0, 30.0, 40.0, 50.0, 1.0],
        "in": answer,
        "host": host,
        "idle": 1,
        "modes": [1, 3, 2],
    }


for line in sys.stdin:
    asked = json.loads(line)
    if mood == "gone":
        raise SystemExit(1)
    if mood == "refuses":
        print(json.dumps({"refused": "no status"}), flush=True)
        continue
    if asked["do"] == "set":
        with told.open("a") as file:
            file.write(f"{asked['signal']} {asked['value']:.0f}\n")
        if asked["signal"] == "gearmath-first":
            first = max(1, int(asked["value"]))
        elif asked["signal"] == "gearmath-host":
            host = bool(asked["value"])
        elif asked["signal"] == "gearmath-acknowledged":
            answer = asked["value"]
        print("{}", flush=True)
    else:
        print(json.dumps(status()), flush=True)

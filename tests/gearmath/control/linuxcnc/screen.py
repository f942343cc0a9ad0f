#!/usr/bin/python3
"""The screen of a LinuxCNC without a display: homes the machine, and starts a program when the file ``start`` appears.

It is the operator: it says in ``state`` how the program stands, aborts it when the file ``abort`` appears and raises Z
by hand to what stands in that file, and goes when the file ``leave`` appears.
"""

from __future__ import annotations

import json
import os
import time

import linuxcnc

stat, command, errors = linuxcnc.stat(), linuxcnc.command(), linuxcnc.error_channel()


def say(state: str, **more: object) -> None:
    stat.poll()
    with open("state.part", "w") as file:
        json.dump({"state": state, "line": stat.motion_line, **more}, file)
    os.replace("state.part", "state")


def aborted() -> bool:
    """Whether the program was to be aborted: then Z is where it was wanted, and a program can be started."""
    if not os.path.exists("abort"):
        return False
    with open("abort") as file:
        height = file.read()
    command.abort()
    command.wait_complete()
    os.unlink("abort")
    until(lambda: stat.interp_state == linuxcnc.INTERP_IDLE, 10)
    command.mode(linuxcnc.MODE_MDI)
    command.wait_complete()
    command.mdi(f"G49 G53 G0 Z{height}")
    command.wait_complete(20)
    command.mode(linuxcnc.MODE_AUTO)
    command.wait_complete()
    return True


def ended() -> bool:
    """Whether the program has ended; where it waits for the operator, who reads what it says, it goes on."""
    if stat.interp_state == linuxcnc.INTERP_PAUSED:
        command.auto(linuxcnc.AUTO_RESUME)
        command.wait_complete()
    return aborted() or stat.interp_state == linuxcnc.INTERP_IDLE


def until(test, seconds: float) -> None:
    end = time.monotonic() + seconds
    while not test():
        if time.monotonic() > end or os.path.exists("leave"):
            say("given up", seconds=seconds)
            raise SystemExit(1)
        time.sleep(0.01)
        stat.poll()


time.sleep(0.3)
for step in (linuxcnc.STATE_ESTOP_RESET, linuxcnc.STATE_ON):
    command.state(step)
    command.wait_complete()
command.mode(linuxcnc.MODE_MANUAL)
command.wait_complete()
command.home(-1)
until(lambda: all(stat.homed[: stat.joints]), 60)
command.mode(linuxcnc.MODE_AUTO)
command.wait_complete()
program = next(name for name in sorted(os.listdir(".")) if name.endswith(".ngc"))
command.program_open(os.path.abspath(program))
command.wait_complete()
say("ready")
while not os.path.exists("leave"):
    if os.path.exists("start"):
        os.unlink("start")
        begin = time.monotonic()
        command.auto(linuxcnc.AUTO_RUN, 0)
        until(lambda: stat.interp_state != linuxcnc.INTERP_IDLE, 10)
        say("running")
        until(ended, 600)
        heard = []
        while not os.path.exists("host") and (one := errors.poll()) is not None:
            heard.append(one[1].strip())
        say("ended", seconds=time.monotonic() - begin, heard=heard)
    time.sleep(0.05)

"""``gearmath control simulate``: a control to try things on, with an operator's console on standard input."""

from __future__ import annotations

import asyncio
import os
import secrets
import socket
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gearmath.cli.control_connect import PASSWORD, quiet
from gearmath.errors import InputError

if TYPE_CHECKING:
    from gearmath.control.simulated.server import SimulatedControl

_HELP = (
    "select NAME.MPF, start, reset, stop (emergency stop), alarm NUMBER TEXT, cut, dead, slow SECONDS, restart, "
    "sessions COUNT, deny RIGHT, grant RIGHT, clock HOURS, files, log, quit"
)


@click.command()
@click.option(
    "--folder",
    type=click.Path(path_type=Path),
    default=Path("gearmath-control"),
    show_default=True,
    help="Where certificates of both sides and CONTROL.toml are kept; made where it is missing.",
)
@click.option(
    "--set",
    "gear_sets",
    multiple=True,
    metavar="SET.toml",
    help="Gear set whose programs it cuts and probes; several times, for corrected ones.",
)
@click.option("--machine", default="vertical_5axis.toml", show_default=True, help="Milling machine.")
@click.option("--calibration", default="probe.toml", show_default=True, help="Calibrated probe.")
@click.option("--errors", help="What is wrong with machine, clamping and probe, such as simulated_shop.toml.")
@click.option(
    "--port",
    type=click.IntRange(0, 65535),
    default=4840,
    show_default=True,
    help="Port on this computer; 0: any that is free.",
)
@click.option(
    "--speed",
    type=click.FloatRange(0.0, 1e6),
    default=1.0,
    show_default=True,
    help="1 is real time, 10 ten times as fast, 0 as fast as it is computed.",
)
@click.option("--unencrypted", is_flag=True, help="Take clients without encryption besides.")
def simulate(
    folder: Path,
    gear_sets: tuple[str, ...],
    machine: str,
    calibration: str,
    errors: str | None,
    port: int,
    speed: float,
    unencrypted: bool,
) -> None:
    """A simulated SINUMERIK 840D sl on this computer: programs are run on the machine model, with its errors.

    It has the node names, rights and limits of the control. Its console takes one command a line until 'quit'; 'help'
    lists them. What a client must not do, select and start, is done here. User 'operator' has the password of the
    environment variable GEARMATH_CONTROL_PASSWORD, or one that is drawn and shown.
    """
    quiet()
    from gearmath.control.simulated.access import Access, Account
    from gearmath.control.simulated.identity import prepared
    from gearmath.control.simulated.nc import Nc
    from gearmath.control.simulated.server import Appearance, SimulatedControl
    from gearmath.control.simulated.workshop import Workshop
    from gearmath.front.machines import load_machine, load_probe, load_shop
    from gearmath.specs.toml import find

    shop = load_shop(errors) if errors else None
    workshop = Workshop(load_machine(machine).spec, load_probe(calibration), shop)
    for gear_set in gear_sets:
        workshop.load(find(gear_set))
    password = os.environ.get(PASSWORD)
    port = port or _free_port()  # CONTROL.toml has it
    access = Access({"operator": Account(password or secrets.token_urlsafe(9))})
    control = SimulatedControl(Nc(workshop, speed), access, None, Appearance(unencrypted=unencrypted), port)

    async def serve() -> None:
        control.identity = await prepared(folder, f"opc.tcp://127.0.0.1:{port}")
        async with control:
            click.echo(f"{control.url}: ready; connect with {folder / 'control.toml'}")
            if password is None:
                click.echo(f"user operator, password {access.accounts['operator'].password}")
            click.echo(_HELP)
            await _console(control)

    try:
        asyncio.run(serve())
    except OSError as error:
        raise InputError(f"--port {port}: cannot be used: {error.strerror}") from error


def _free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


async def _console(control: SimulatedControl) -> None:
    """One command a line, until ``quit``; where the input has an end, on without it until the process is ended."""
    while line := await asyncio.to_thread(sys.stdin.readline):
        words = line.split()
        if words == ["quit"]:
            return
        if words:
            try:
                click.echo(await _command(control, words[0].lower(), words[1:]))
            except (InputError, IndexError, ValueError) as error:
                click.echo(f"not done: {error or 'see help'}")
    await asyncio.Event().wait()


async def _command(control: SimulatedControl, word: str, rest: list[str]) -> str:
    from datetime import timedelta

    from gearmath.control.simulated.nc import NcAlarm
    from gearmath.control.sinumerik import FOLDERS
    from gearmath.machine.control.file_names import control_name

    nc = control.nc
    if word == "select":
        name = control_name(rest[0])
        nc.select(f"{FOLDERS[name.rsplit('.', 1)[-1]].text}/{name}")
    elif word == "start":
        nc.start()
    elif word == "reset":
        await asyncio.to_thread(nc.reset)
    elif word == "stop":
        nc.emergency_stop()
    elif word == "alarm":
        nc.raise_alarm(NcAlarm(str(int(rest[0])), " ".join(rest[1:]) or "alarm"))
    elif word == "cut":
        control.line.cut()
    elif word == "dead":
        control.line.die()
    elif word == "slow":
        control.answer_slowly(float(rest[0]))
    elif word == "restart":
        await control.restart()
    elif word == "sessions":
        control.fill_sessions(int(rest[0]))
    elif word in ("deny", "grant"):
        account = control.access.accounts["operator"]
        account.rights = account.rights - {rest[0]} if word == "deny" else account.rights | {rest[0]}
    elif word == "clock":
        control.set_clock(timedelta(hours=float(rest[0])))
    elif word == "files":
        return "\n".join(f"{path}: {len(content)} bytes" for path, content in sorted(nc.files.items())) or "none"
    elif word == "log":
        return "\n".join(f"run {one.number} point {one.point} {one.what}" for one in nc.log[-20:]) or "empty"
    else:
        return _HELP
    return "done"

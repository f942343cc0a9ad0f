"""How a verb of ``gearmath control`` comes to its control: connection file, password, one session."""

from __future__ import annotations

import asyncio
import logging
import os
import sys
from collections.abc import Awaitable, Callable, Coroutine
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gearmath.errors import InputError

if TYPE_CHECKING:
    from gearmath.control.linuxcnc_client import LinuxCncControl
    from gearmath.control.opcua import OpcUaControl
    from gearmath.specs.control_connection import ControlConnection

PASSWORD = "GEARMATH_CONTROL_PASSWORD"
#: Where the group keeps that its control is a LinuxCNC on this computer.
_LINUXCNC = "gearmath.control.linuxcnc"
_Work = Callable[[Any], Awaitable[Any]]
CONNECTION = click.argument("connection", type=click.Path(path_type=Path), metavar="CONTROL.toml")
INSECURE = click.option(
    "--insecure", is_flag=True, help="Allow what CONTROL.toml says of an older security policy, or of none."
)


def quiet() -> None:
    """Only our own sentences: asyncua would log tracebacks. Raises InputError where it is not installed."""
    try:
        import asyncua  # noqa: F401
    except ImportError as error:
        raise InputError("asyncua is missing: install it with pip install '.[control]'") from error
    logging.getLogger("asyncua").setLevel(logging.CRITICAL + 1)
    logging.getLogger("asyncio").setLevel(logging.CRITICAL + 1)


def choose_linuxcnc(wanted: bool) -> None:
    """Keep, for the verb that follows, whether its file is the INI file of a LinuxCNC."""
    click.get_current_context().meta[_LINUXCNC] = wanted


def is_linuxcnc() -> bool:
    """Whether the control is a LinuxCNC on this computer."""
    return bool(click.get_current_context().meta.get(_LINUXCNC))


def name_of(path: Path, insecure: bool) -> str:
    """The name of the control of a file."""
    return f"LinuxCNC, {path.name}" if is_linuxcnc() else connection_of(path, insecure).name


def file_name(name: str) -> str:
    """A name as the control keeps it. Raises InputError for what it would not, or what names a path."""
    from gearmath.machine.control.file_names import control_name, linuxcnc_name

    return linuxcnc_name(name) if is_linuxcnc() else control_name(name)


def connector(
    path: Path, insecure: bool, *needed: str, seconds: float | None = None
) -> Callable[[], Coroutine[Any, Any, OpcUaControl | LinuxCncControl]]:
    """What connects to the control of a file, each time anew, with the rights that are needed.

    ``seconds`` is how long an answer over OPC UA may take, by default as long as a command line waits.
    """
    if is_linuxcnc():
        from gearmath.control.linuxcnc_client import LinuxCncControl

        return lambda: LinuxCncControl.connect(path)
    from gearmath.control.opcua import PATIENCE, OpcUaControl

    known = connection_of(path, insecure)
    password = _password(known)
    return lambda: OpcUaControl.connect(known, password, needed, seconds or PATIENCE)


def connection_of(path: Path, insecure: bool) -> ControlConnection:
    """The file, checked. Raises InputError for a security that must be asked for by --insecure, and was not."""
    from gearmath.specs.control_connection import load_control_connection

    if is_linuxcnc():
        raise InputError("a LinuxCNC has no connection file: this verb is for a control with OPC UA")
    quiet()
    known = load_control_connection(path)
    if known.security != "Basic256Sha256" and not insecure:
        raise InputError(f"{path}: security = {known.security!r}: must be 'Basic256Sha256', or --insecure given")
    return known


def _password(known: ControlConnection) -> str:
    if not known.user:
        return ""
    if (password := os.environ.get(PASSWORD)) is not None:
        return password
    if not sys.stdin.isatty():
        raise InputError(f"the password of {known.user!r} is missing: set the environment variable {PASSWORD}")
    return click.prompt(f"password of {known.user}", hide_input=True, err=True)


def ask(path: Path, insecure: bool, needed: tuple[str, ...], work: _Work) -> Any:
    """Connect, do one thing, and give the session back."""
    connect = connector(path, insecure, *needed)

    async def once() -> Any:
        one = await connect()
        try:
            return await work(one)
        finally:
            await one.close()

    return asyncio.run(once())

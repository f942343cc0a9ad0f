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
    from gearmath.control.opcua import OpcUaControl
    from gearmath.specs.control_connection import ControlConnection

PASSWORD = "GEARMATH_CONTROL_PASSWORD"
_Work = Callable[["OpcUaControl"], Awaitable[Any]]
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


def connector(path: Path, insecure: bool, *needed: str) -> Callable[[], Coroutine[Any, Any, OpcUaControl]]:
    """What connects to the control of a file, each time anew, with the rights that are needed."""
    from gearmath.control.opcua import OpcUaControl

    known = connection_of(path, insecure)
    password = _password(known)
    return lambda: OpcUaControl.connect(known, password, needed)


def connection_of(path: Path, insecure: bool) -> ControlConnection:
    """The file, checked. Raises InputError for a security that must be asked for by --insecure, and was not."""
    from gearmath.specs.control_connection import load_control_connection

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

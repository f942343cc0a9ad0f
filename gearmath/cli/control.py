"""``gearmath control``: the machine control over OPC UA. It never selects or starts a program."""

from __future__ import annotations

import asyncio
import functools
import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gearmath.cli.common import JSON, NewFile, echo_json, table
from gearmath.cli.control_connect import CONNECTION, INSECURE, ask, choose_linuxcnc, connection_of, file_name
from gearmath.cli.control_measure import measure
from gearmath.cli.control_simulate import simulate
from gearmath.errors import InputError

if TYPE_CHECKING:
    from gearmath.control.interface import Control
    from gearmath.control.linuxcnc_client import LinuxCncControl
    from gearmath.control.opcua import OpcUaControl


@click.group()
@click.option(
    "--linuxcnc",
    is_flag=True,
    help="The control is a LinuxCNC on this computer: its INI file in place of CONTROL.toml.",
)
def control(linuxcnc: bool) -> None:
    """The machine control over OPC UA: a SINUMERIK 840D sl, or the simulated one; or a LinuxCNC.

    CONTROL.toml says where it is and who logs in: docs/control.md. The password is asked for, or read from the
    environment variable GEARMATH_CONTROL_PASSWORD. No command selects or starts a program.
    """
    choose_linuxcnc(linuxcnc)


def verb(name: str | None = None) -> Callable[[Callable[..., Any]], click.Command]:
    """A verb whose first argument is the connection file."""

    def decorate(function: Callable[..., Any]) -> click.Command:
        @functools.wraps(function)
        def command(**values: Any) -> Any:
            return function(**values)

        return control.command(name)(CONNECTION(INSECURE(command)))

    return decorate


@verb()
@JSON
def status(connection: Path, insecure: bool, as_json: bool) -> None:
    """Channel, mode, selected program, message, position, rights of the user."""
    from gearmath.control.interface import AXES
    from gearmath.control.sinumerik import READ_STATE

    async def work(one: OpcUaControl | LinuxCncControl) -> tuple[Any, list[str]]:
        return await one.status(), sorted(one.rights)

    found, rights = ask(connection, insecure, (READ_STATE,), work)
    position = dict(zip(AXES, found.position, strict=True))
    values = {
        "channel": str(found.channel),
        "mode": found.mode,
        "selected": found.selected,
        "message": found.message,
        "position": position,
        "rights": rights,
    }
    if as_json:
        echo_json(values)
        return
    click.echo(f"channel   {found.channel}\nmode      {found.mode}\nselected  {found.selected or 'none'}")
    click.echo(f"message   {found.message or 'none'}")
    unit = {"A": "degrees", "B": "degrees"}
    click.echo("\n".join(f"{axis}         {value:.5f} {unit.get(axis, 'mm')}" for axis, value in position.items()))
    click.echo(f"rights    {', '.join(rights) or 'none'}")


@verb()
@click.option("--interval", type=click.FloatRange(0.1, 5.0), default=0.1, show_default=True, help="Seconds.")
@click.option("--seconds", type=click.FloatRange(0.1, 86_400.0), help="How long.  [default: until Ctrl-C]")
@click.argument("parameters", nargs=-1, metavar="[R10 R20-R25 ...]")
@JSON
def watch(
    connection: Path,
    insecure: bool,
    interval: float,
    seconds: float | None,
    parameters: tuple[str, ...],
    as_json: bool,
) -> None:
    """Positions X Y Z (mm) and A B (degrees) as they change, or the R parameters that are named, a line each time.

    With --json a JSON object a line.
    """
    from contextlib import aclosing

    from gearmath.control.interface import AXES
    from gearmath.control.sinumerik import READ_STATE

    reading, writing = _parameters(parameters, "R10 or R20-R25")
    if writing:
        raise InputError(f"R{next(iter(writing))}=...: watch sets nothing: 'gearmath control rparam' does")
    numbers = [*dict.fromkeys(reading)]
    names, what = ([f"R{number}" for number in numbers], "parameters") if numbers else (AXES, "position")
    units = dict.fromkeys("XYZ", " mm") | dict.fromkeys("AB", " degrees")

    async def work(one: Control) -> None:
        begin: float | None = None
        stream = one.watch_parameters(numbers, interval) if numbers else one.watch(interval)
        async with aclosing(stream):  # what is left open stays on the control
            async for at, found in stream:
                begin = at if begin is None else begin
                values = dict(zip(names, found, strict=True))
                if as_json:
                    click.echo(json.dumps({"seconds": round(at - begin, 3), what: values}))
                else:
                    shown = (f"{name} {value:11.5f}{units.get(name, '')}" for name, value in values.items())
                    click.echo(f"{at - begin:9.2f} s  {'  '.join(shown)}")
                if seconds is not None and at - begin >= seconds:
                    return

    ask(connection, insecure, (READ_STATE,), work)


@verb()
@click.argument("program", type=click.Path(path_type=Path), metavar="PROGRAM.MPF")
@click.option("--replace", is_flag=True, help="Write over a program of this name.")
def put(connection: Path, insecure: bool, program: Path, replace: bool) -> None:
    """Write a program to the control and read it back.

    Refused while the channel is active, and for the program that is selected.
    """
    from gearmath.control.delivery import RIGHTS, deliver
    from gearmath.files import read_bytes

    content, name = read_bytes(program), file_name(program.name)
    ask(connection, insecure, RIGHTS, lambda one: deliver(one, name, content, replace))
    click.echo(f"{name}: {len(content)} bytes on the control, read back alike")


@verb()
@click.argument("name", metavar="NAME.MPF")
@click.option("-o", "--output", "target", type=NewFile(), help="File to write.  [default: NAME.MPF here]")
def get(connection: Path, insecure: bool, name: str, target: Path | None) -> None:
    """Read a program or result file from the control."""
    from gearmath.control.sinumerik import READ_FILES
    from gearmath.files import check_place, write_bytes

    name = file_name(name)
    target = target or Path(name)
    check_place(target)
    content = ask(connection, insecure, (READ_FILES,), lambda one: one.get(name))
    write_bytes(target, content)
    click.echo(f"{target}: {len(content)} bytes of {name}")


@verb()
@click.argument("parameters", nargs=-1, required=True, metavar="R10 R20-R25 R30=1.5 ...")
@JSON
def rparam(connection: Path, insecure: bool, parameters: tuple[str, ...], as_json: bool) -> None:
    """Read R parameters, or set those that are written with a value.

    Those of the handshake (R101 to R103) are not set: only a measuring run acknowledges.
    """
    from gearmath.control.sinumerik import READ_STATE, WRITE_STATE

    reading, writing = _parameters(parameters, "R10, R20-R25 or R30=1.5")
    numbers = [*dict.fromkeys([*writing, *reading])]

    async def work(one: Control) -> list[float]:
        if writing:
            await one.write_parameters(writing)
        return await one.read_parameters(numbers)

    found = ask(connection, insecure, (READ_STATE, *((WRITE_STATE,) if writing else ())), work)
    if as_json:
        echo_json({f"R{number}": value for number, value in zip(numbers, found, strict=True)})
        return
    click.echo("\n".join(f"R{number} = {value:.10g}" for number, value in zip(numbers, found, strict=True)))


def _parameters(words: tuple[str, ...], examples: str) -> tuple[list[int], dict[int, float]]:
    """Numbers to read, and values to write; a word that is neither is told the ``examples``."""
    import re

    reading: list[int] = []
    writing: dict[int, float] = {}
    for word in words:
        match = re.fullmatch(r"[Rr]?(\d{1,4})(?:-[Rr]?(\d{1,4})|=(\S+))?", word, re.ASCII)
        if match is None:
            raise InputError(f"{word!r}: must be like {examples}")
        first, last = int(match[1]), int(match[2] or match[1])
        if match[3] is None:
            if last < first:
                raise InputError(f"{word!r}: the last R parameter comes before the first")
            reading += range(first, last + 1)
            continue
        try:
            writing[first] = float(match[3])
        except ValueError:
            raise InputError(f"{word!r}: {match[3]!r} must be a number") from None
    return reading, writing


@verb()
@JSON
def alarms(connection: Path, insecure: bool, as_json: bool) -> None:
    """The alarms that are active now, each once."""
    from dataclasses import asdict

    from gearmath.control.sinumerik import READ_ALARMS

    found = ask(connection, insecure, (READ_ALARMS,), lambda one: one.alarms())
    if as_json:
        echo_json([asdict(alarm) for alarm in found])
    elif found:
        rows = [(alarm.number, alarm.severity, alarm.time, alarm.text) for alarm in found]
        click.echo(table(("alarm", "severity", "since", "text"), rows))
    else:
        click.echo("no alarm is active")


@verb()
def trust(connection: Path, insecure: bool) -> None:
    """Store the control's own certificate, once, where CONTROL.toml names it; compare its fingerprint there.

    From then on only this control is talked to.
    """
    from gearmath.control.login import server_certificate
    from gearmath.control.opcua import PATIENCE
    from gearmath.files import write_bytes

    known = connection_of(connection, insecure)
    if not known.server_certificate:
        raise InputError(f"{connection}: server_certificate is missing: it names the file to write")
    target = Path(known.server_certificate)
    if target.exists():
        raise InputError(f"{target}: is there already: delete it first if the control has a new certificate")
    certificate, fingerprint = asyncio.run(server_certificate(known, PATIENCE))
    write_bytes(target, certificate)
    click.echo(f"{target}: the certificate of {known.url}; compare its SHA-256 with that which the control shows:")
    click.echo(" ".join(fingerprint[k : k + 4] for k in range(0, len(fingerprint), 4)))


control.add_command(measure)
control.add_command(simulate)

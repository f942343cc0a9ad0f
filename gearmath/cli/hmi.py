"""``gearmath hmi``: the operator's page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from gearmath.cli.control_connect import INSECURE, choose_linuxcnc, connector, name_of, quiet
from gearmath.cli.runs import store_option
from gearmath.errors import InputError

if TYPE_CHECKING:
    from gearmath.hmi.state import Shared

_SIMULATED = "simulated"


@click.command()
@click.option(
    "--control",
    metavar="CONTROL.toml|LINUXCNC.ini|simulated",
    help="The machine control: its connection file, the INI file of a LinuxCNC on this computer, or a simulated one "
    "inside the server.  [default: none]",
)
@INSECURE
@store_option("The measurement store; sets and programs are written to its folder.")
@click.option("--host", default="127.0.0.1", show_default=True, help="Address to serve on; by default this computer.")
@click.option("--port", type=click.IntRange(0, 65535), default=8080, show_default=True, help="0: any that is free.")
def hmi(control: str | None, insecure: bool, store_file: Path, host: str, port: int) -> None:
    """The operator's page, in a browser: open the address that it shows. Ctrl-C ends it.

    It never selects and never starts a program. A measuring run goes on when pages are closed.
    """
    try:
        from gearmath.hmi.app import serve
    except ImportError as error:
        raise InputError(f"{error.name} is missing: install it with pip install '.[hmi]'") from error
    from gearmath.control.store import MeasurementStore
    from gearmath.files import check_place, check_writable
    from gearmath.hmi.alarm_book import AlarmBook
    from gearmath.hmi.state import Shared

    check_place(store_file)
    if store_file.exists():
        is_empty = store_file.is_file() and not store_file.stat().st_size
        if store_file.is_file():
            check_writable(store_file)  # a run would find out when the machine stands ready
        MeasurementStore.open(store_file, create=False).close()
        if is_empty:
            click.echo(f"{store_file}: was empty, and is a new measurement store now")
    alarms = store_file.with_name(f"{store_file.stem}_alarms.json")
    shared = Shared(store_file, book=AlarmBook(alarms))
    if control is not None:
        _connect(shared, control, insecure)
    try:
        serve(shared, host, port, lambda address: click.echo(f"open {address}"))
    finally:
        shared.close()


def _connect(shared: Shared, control: str, insecure: bool) -> None:
    """Begin to watch the control."""
    from gearmath.control import sinumerik
    from gearmath.files import read_text
    from gearmath.hmi.link import ANSWER, ControlLink
    from gearmath.hmi.measuring_task import MeasuringTask

    quiet()
    if control == _SIMULATED:
        from gearmath.hmi.simulated import NAME, SimulatedMachine

        shared.simulated = SimulatedMachine(shared.folder / "gearmath-control", shared.choice)
        shared.link = ControlLink(NAME, shared.simulated.connect, shared.book)
    else:
        path = Path(control)
        choose_linuxcnc(path.suffix.lower() == ".ini")
        read_text(path)  # refuses a file that is not there at once
        needed = (sinumerik.READ_STATE, sinumerik.READ_ALARMS)
        connect = connector(path, insecure, *needed, seconds=ANSWER)
        shared.link = ControlLink(name_of(path, insecure), connect, shared.book)
    shared.link.open()
    shared.measuring = MeasuringTask(shared.link, shared.store)

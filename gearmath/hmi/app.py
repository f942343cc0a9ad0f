"""The server of the page: NiceGUI behind the gate, on one port."""

from __future__ import annotations

import importlib
import secrets
import signal
import socket
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from copy import copy
from types import FrameType

import uvicorn
from fastapi import FastAPI, Request
from fastapi.responses import RedirectResponse
from nicegui import ui

from gearmath.errors import InputError
from gearmath.hmi import shell
from gearmath.hmi.gate import LOGIN, LOOPBACK, Gate
from gearmath.hmi.plain_page import PlainErrors
from gearmath.hmi.shell import PAGES
from gearmath.hmi.state import Shared
from gearmath.hmi.visitor import is_dark, language_of

#: How long the server keeps a page whose browser is gone. [s]
_RECONNECT = 30.0
#: How long what is under way may take when the server ends. [s]
_LAST_WORDS = 5


def application(shared: Shared) -> FastAPI:
    """Every page, without the gate. One a process: NiceGUI has one application."""
    app = FastAPI(docs_url=None, redoc_url=None, openapi_url=None)

    @app.get("/", include_in_schema=False)
    def first() -> RedirectResponse:
        return RedirectResponse(f"/{next(iter(PAGES))}", 303)

    for name in PAGES:
        _register(shared, name)
    ui.run_with(
        app,
        title="gearmath",
        tailwind=False,
        reconnect_timeout=_RECONNECT,
        binding_refresh_interval=None,
        show_welcome_message=False,
        favicon=_FAVICON,
    )
    return app


def _register(shared: Shared, name: str) -> None:
    build = importlib.import_module(f"gearmath.hmi.pages.{name}").build

    @ui.page(f"/{name}")
    def page(request: Request) -> None:
        # language and look belong to one browser, the page of NiceGUI to all of them
        client = ui.context.client
        client.page = copy(client.page)
        client.page.language = "de" if language_of(request) == "de" else "en-US"
        client.page.dark = is_dark(request)
        shell.show(shared, name, build, request)


def serve(shared: Shared, host: str, port: int, show: Callable[[str], object]) -> None:
    """Serve until Ctrl-C. ``show`` gets the address with the token as soon as it answers.

    Raises KeyboardInterrupt where Ctrl-C has ended it, InputError where the port cannot be used, and for an address
    that is none of this computer alone.
    """
    if host in ("0.0.0.0", "::", ""):
        raise InputError(f"--host {host}: must be one address of this computer: it is the name that browsers may use")
    listening = _listen(host, port)
    port = listening.getsockname()[1]
    token = secrets.token_urlsafe(24)
    names = dict.fromkeys((*LOOPBACK, f"[{host}]" if ":" in host else host))
    gate = Gate(PlainErrors(application(shared)), token, [f"{name}:{port}" for name in names], f"gearmath_{port}")
    # its own lines would show addresses, and with them the token
    config = uvicorn.Config(
        gate, log_level="warning", access_log=False, ws="websockets-sansio", timeout_graceful_shutdown=_LAST_WORDS
    )
    server = _Server(config)
    show(f"http://{f'[{host}]' if ':' in host else host}:{port}{LOGIN}?token={token}")
    server.run(sockets=[listening])
    if server.was_asked:
        raise KeyboardInterrupt


class _Server(uvicorn.Server):
    """Ended by the first Ctrl-C. Further ones, until the process is over, disturb nothing that is still to be kept."""

    was_asked = False

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        for sign in (signal.SIGINT, signal.SIGTERM):
            signal.signal(sign, self.handle_exit)
        yield

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        self.was_asked = self.should_exit = True


def _listen(host: str, port: int) -> socket.socket:
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        listening = socket.socket(family, socket.SOCK_STREAM)
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind((host, port))
        listening.listen(100)
    except OSError as error:
        raise InputError(f"--host {host} --port {port}: cannot be used: {error.strerror or error}") from error
    return listening


_FAVICON = (
    '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 32 32"><path fill="#0b6478" d="M14 2h4l1 4 3 1 4-2 3 3-2 4 1 '
    '3 4 1v4l-4 1-1 3 2 4-3 3-4-2-3 1-1 4h-4l-1-4-3-1-4 2-3-3 2-4-1-3-4-1v-4l4-1 1-3-2-4 3-3 4 2 3-1z"/>'
    '<circle cx="16" cy="16" r="5" fill="#fff"/></svg>'
)

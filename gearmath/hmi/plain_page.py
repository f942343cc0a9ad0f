"""What is answered where a page cannot be shown: one sentence in the language of the browser, and a way back.

It stands inside the gate around all that NiceGUI serves, whose own pages of errors name classes of Python.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable, MutableMapping
from html import escape
from importlib import resources
from typing import Any

from starlette.requests import HTTPConnection

from gearmath.hmi.messages import Text
from gearmath.hmi.visitor import is_dark, language_of

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
AsgiApp = Callable[[Scope, Receive, Send], Awaitable[None]]

_PAGE = """<!doctype html>
<html lang="{language}"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>{title} · gearmath</title><style>{style}</style></head>
<body class="gm-body gm-alone {look}"><main class="gm-panel"><h1 class="gm-title">{title}</h1>
<p>{sentence}</p><a class="gm-back" href="/">{back}</a></main></body></html>
"""


def answer(scope: Scope, key: str) -> tuple[bytes, bytes]:
    """Kind and body of an answer by the key of its message: a page where a page is asked for, or else its sentence."""
    request = HTTPConnection(scope)
    text = Text(language_of(request))
    sentence = text(key)
    if not _wants_page(request):
        return b"text/plain; charset=utf-8", f"gearmath: {sentence}\n".encode()
    page = _PAGE.format(
        language=text.language,
        look="body--dark" if is_dark(request) else "",
        style=resources.files("gearmath.hmi").joinpath("static", "style.css").read_text("utf-8"),
        title=escape(text("plain.title")),
        sentence=escape(sentence),
        back=escape(text("plain.back")),
    )
    return b"text/html; charset=utf-8", page.encode()


def _wants_page(request: HTTPConnection) -> bool:
    return "text/html" in request.headers.get("accept", "")


class PlainErrors:
    """The application ``app``, with plain pages where it answers a browser that something is wrong."""

    def __init__(self, app: AsgiApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http" or not _wants_page(HTTPConnection(scope)):
            await self.app(scope, receive, send)
            return
        sent = {"status": 0}

        async def plain(message: MutableMapping[str, Any]) -> None:
            if message["type"] == "http.response.start":
                sent["status"] = message["status"]
                if message["status"] >= 400:
                    await _send_page(scope, send, message["status"])
            if sent["status"] < 400:
                await send(message)

        try:
            await self.app(scope, receive, plain)
        except Exception:  # it goes on to the log of the server
            if not sent["status"]:
                await _send_page(scope, send, 500)
            raise


async def _send_page(scope: Scope, send: Send, status: int) -> None:
    key = "shell.broken" if status >= 500 else "plain.missing" if status == 404 else "plain.unfit"
    kind, body = answer(scope, key)
    headers = [(b"content-type", kind), (b"cache-control", b"no-store")]
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": body})

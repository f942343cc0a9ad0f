"""The gate before everything that the page serves, for requests and websockets alike.

Let in is who names this server as host (a page elsewhere that rebinds its name to this computer does not), comes from
no page or from one of this server, and has the token in a cookie. ``/login?token=...`` sets the cookie.
"""

from __future__ import annotations

import hmac
from collections.abc import Iterable, MutableMapping
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qs, unquote

from gearmath.hmi.plain_page import AsgiApp, Receive, Scope, Send, answer

LOOPBACK = ("127.0.0.1", "localhost", "[::1]")
LOGIN = "/login"
#: Nothing is loaded from elsewhere, and no other page may show this one. Vue compiles its templates in the browser.
_POLICY = (
    "default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; font-src 'self' data:; connect-src 'self'; worker-src 'self' blob:; "
    "object-src 'none'; base-uri 'self'; form-action 'self'; frame-ancestors 'none'"
)
_HEADERS = (
    (b"content-security-policy", _POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-opener-policy", b"same-origin"),
    (b"cross-origin-resource-policy", b"same-origin"),
)
#: A page of our own that goes on, not a redirect: a browser sends a strict cookie only where its own site leads.
_WELCOME = b'<!doctype html><meta charset="utf-8"><meta http-equiv="refresh" content="0;url=/"><title>gearmath</title>'


class Gate:
    """Outermost ASGI layer. ``app`` is what it guards, ``hosts`` the names (with port) under which it is reached."""

    def __init__(self, app: AsgiApp, token: str, hosts: Iterable[str], cookie: str) -> None:
        self.app = app
        self._token, self._cookie = token, cookie
        self._hosts = frozenset(host.lower() for host in hosts)
        self._origins = frozenset(f"http://{host}" for host in self._hosts)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await self.app(scope, receive, send)
            return
        headers: list[tuple[bytes, bytes]] = list(scope["headers"])
        why = self._refusal(scope, headers)
        if why is None and scope["type"] == "http" and scope["path"] == LOGIN:
            await self._log_in(scope, send)
            return
        if why is None and not self._is_known(headers):
            why = "plain.no_token"
        if why is None and self._names_token(scope):
            why = "plain.token_in_address"
        if why is None:
            await self.app(scope, receive, _guarded(send) if scope["type"] == "http" else send)
        else:
            await _refuse(scope, receive, send, why)

    def _refusal(self, scope: Scope, headers: list[tuple[bytes, bytes]]) -> str | None:
        """The key of the sentence that says why; None where nothing speaks against it."""
        if scope["type"] not in ("http", "websocket"):
            return "plain.unfit"
        hosts = [value.decode("latin-1").lower() for name, value in headers if name == b"host"]
        if len(hosts) != 1 or hosts[0] not in self._hosts:
            return "plain.foreign_host"
        origins = [value.decode("latin-1").lower() for name, value in headers if name == b"origin"]
        if any(origin not in self._origins for origin in origins):
            return "plain.foreign_origin"
        if any(ord(letter) < 0x20 or ord(letter) == 0x7F for letter in scope["path"]):
            return "plain.control_characters"
        return None

    def _names_token(self, scope: Scope) -> bool:
        """Whether an address has the token, of which a log would tell."""
        return self._token in scope["path"] + unquote(scope["query_string"].decode("latin-1"))

    def _is_known(self, headers: list[tuple[bytes, bytes]]) -> bool:
        for name, value in headers:
            if name == b"cookie":
                try:
                    found = SimpleCookie(value.decode("latin-1")).get(self._cookie)
                except CookieError:
                    continue
                if found is not None and self._is_token(found.value):
                    return True
        return False

    def _is_token(self, given: str) -> bool:
        return hmac.compare_digest(given.encode("utf-8", "replace"), self._token.encode())

    async def _log_in(self, scope: Scope, send: Send) -> None:
        query = parse_qs(scope["query_string"].decode("latin-1"), max_num_fields=10) if _short(scope) else {}
        if scope["method"] != "GET" or not self._is_token(query.get("token", [""])[0]):
            await _answer(send, 403, *answer(scope, "plain.wrong_token"))
            return
        cookie = f"{self._cookie}={self._token}; HttpOnly; SameSite=Strict; Path=/"
        await _answer(send, 200, b"text/html; charset=utf-8", _WELCOME, (b"set-cookie", cookie.encode()))


def _short(scope: Scope) -> bool:
    return len(scope["query_string"]) < 1000


def _guarded(send: Send) -> Send:
    """``send`` with the headers that every answer has."""

    async def with_headers(message: MutableMapping[str, Any]) -> None:
        if message["type"] == "http.response.start":
            own = {name for name, _ in _HEADERS}
            kept = [(name, value) for name, value in message.get("headers", []) if name.lower() not in own]
            message["headers"] = [*kept, *_HEADERS]
        await send(message)

    return with_headers


async def _refuse(scope: Scope, receive: Receive, send: Send, why: str) -> None:
    if scope["type"] == "websocket":
        await receive()  # the request itself; closing before accepting is answered as 403
        await send({"type": "websocket.close", "code": 1008, "reason": why})
    else:
        await _answer(send, 403, *answer(scope, why))


async def _answer(send: Send, status: int, kind: bytes, body: bytes, *more: tuple[bytes, bytes]) -> None:
    headers = [(b"content-type", kind), (b"cache-control", b"no-store"), *more, *_HEADERS]
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": body})

"""The gate: every route that there is, asked without token, from elsewhere, and by names that lead elsewhere."""

from __future__ import annotations

import http.client
import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from gearmath.cli import main
from gearmath.control.store import MeasurementStore
from gearmath.control.store_schema import APPLICATION_ID
from gearmath.hmi import app
from tests.gearmath.hmi.conftest import Operator, Served

_ROUTES = """
import json, pathlib
from nicegui import core
from gearmath.hmi.app import application
from gearmath.hmi.state import Shared
app = application(Shared(pathlib.Path("runs.db")))
found = []
for routes in (app.routes, core.app.routes):
    for route in routes:
        found.append((getattr(route, "path", "/"), sorted(getattr(route, "methods", None) or ["GET"])))
print(json.dumps(found))
"""


#: Root may write everywhere; without this right it may write what its files say, as everybody else.
_RIGHT = "-dac_override,-dac_read_search"
BOUND = ("setpriv", f"--bounding-set={_RIGHT}", f"--inh-caps={_RIGHT}") if os.geteuid() == 0 else ()


_ONE_AFTER_THE_OTHER = """
import sys
from gearmath.cli import main
for store in sys.argv[1:]:
    try:
        main(["hmi", "--port", "0", "--store", store])
    except SystemExit as ended:
        print(ended.code)
"""


@pytest.fixture(scope="module")
def served(serve: Callable[..., Served]) -> Served:
    return serve()


@pytest.fixture(scope="module")
def routes() -> list[tuple[str, str]]:
    """Method and path of every route that the server has, its parameters filled in."""
    done = subprocess.run([sys.executable, "-c", _ROUTES], capture_output=True, text=True, check=True)
    found = {
        (method, re.sub(r"\{[^}]*\}", "x", path) or "/")
        for path, methods in json.loads(done.stdout.splitlines()[-1])
        for method in (*methods, "GET", "POST", "OPTIONS")
    }
    return sorted(found | {("GET", "/_nicegui_ws/socket.io/?EIO=4&transport=polling"), ("GET", "/nothing")})


def _ask(served: Served, method: str, path: str, **headers: str) -> tuple[int, str, dict[str, str]]:
    connection = http.client.HTTPConnection("127.0.0.1", served.port, timeout=20)
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    connection.putrequest(method, path, skip_host=True)
    for name, value in ({"Host": f"127.0.0.1:{served.port}"} | named).items():
        connection.putheader(name, value)
    connection.endheaders()
    answer = connection.getresponse()
    body = answer.read().decode("utf-8", "replace")
    connection.close()
    return answer.status, body, {name.lower(): value for name, value in answer.getheaders()}


def _cookie(served: Served) -> str:
    return f"gearmath_{served.port}={served.token}"


def test_there_are_routes_to_scan(routes: list[tuple[str, str]]) -> None:
    paths = {path for _, path in routes}
    assert {"/machine", "/measure", "/gearbox"} <= paths
    assert any(path.startswith("/_nicegui") for path in paths)


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"Cookie": "gearmath_{port}=wrong"},
        {"Cookie": "{cookie}", "Host": "evil.example:{port}"},
        {"Cookie": "{cookie}", "Host": "127.0.0.1.evil.example:{port}"},
        {"Cookie": "{cookie}", "Host": "127.0.0.1"},
        {"Cookie": "{cookie}", "Origin": "http://evil.example"},
        {"Cookie": "{cookie}", "Origin": "null"},
        {"Cookie": "{cookie}", "Origin": "https://127.0.0.1:{port}"},
        {"Cookie": "{cookie}", "Origin": "http://127.0.0.1:1"},
    ],
    ids=["no token", "wrong token", "rebinding", "longer name", "no port", "origin", "null", "https", "other port"],
)
def test_every_route_refuses_who_has_no_token_or_comes_from_elsewhere(
    served: Served, routes: list[tuple[str, str]], headers: dict[str, str]
) -> None:
    filled = {k: v.format(port=served.port, cookie=_cookie(served)) for k, v in headers.items()}
    let_in = [(method, path) for method, path in routes if _ask(served, method, path, **filled)[0] != 403]
    assert let_in == []


def test_who_has_the_token_is_let_in_and_told_to_load_nothing_from_elsewhere(served: Served) -> None:
    status, body, headers = _ask(served, "GET", "/machine", Cookie=_cookie(served))
    assert status == 200
    assert "gearmath" in body
    assert "default-src 'self'" in headers["content-security-policy"]
    assert "frame-ancestors 'none'" in headers["content-security-policy"]
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    assert served.token not in body


def test_login_sets_a_cookie_that_scripts_and_other_sites_do_not_get(served: Served) -> None:
    status, _, headers = _ask(served, "GET", f"/login?token={served.token}")
    assert status == 200
    assert set(headers["set-cookie"].split("; ")) == {_cookie(served), "HttpOnly", "SameSite=Strict", "Path=/"}
    assert headers["cache-control"] == "no-store"
    for wrong in ("", "?token=", "?token=x", f"?token={served.token}x", "?token=" + 2000 * "a", "?token=%ff%00"):
        assert _ask(served, "GET", f"/login{wrong}")[0] == 403
    assert _ask(served, "POST", f"/login?token={served.token}")[0] == 403
    assert _ask(served, "GET", f"/login?token={served.token}", Host=f"evil.example:{served.port}")[0] == 403


@pytest.mark.parametrize(
    ("cookie", "origin", "host"),
    [
        (False, None, None),
        (False, "own", None),
        (True, "http://evil.example", None),
        (True, "null", None),
        (True, "own", "evil.example"),
    ],
    ids=["nothing", "no token", "foreign origin", "null origin", "rebinding"],
)
def test_the_websocket_refuses_alike(served: Served, cookie: bool, origin: str | None, host: str | None) -> None:
    headers = {"Cookie": _cookie(served)} if cookie else {}
    if host is not None:
        headers["Host"] = f"{host}:{served.port}"
    own: str | None = served.base if origin == "own" else origin
    url = f"ws://127.0.0.1:{served.port}/_nicegui_ws/socket.io/?EIO=4&transport=websocket"
    with (
        pytest.raises(InvalidStatus) as refused,
        connect(url, additional_headers=headers, origin=own, proxy=None),  # type: ignore[arg-type]
    ):
        pass
    assert refused.value.response.status_code == 403


def test_the_websocket_of_a_page_is_let_in(served: Served) -> None:
    url = f"ws://127.0.0.1:{served.port}/_nicegui_ws/socket.io/?EIO=4&transport=websocket"
    headers = {"Cookie": _cookie(served)}
    with connect(url, additional_headers=headers, origin=served.base, proxy=None) as line:  # type: ignore[arg-type]
        assert str(line.recv(timeout=10)).startswith("0{")


@pytest.mark.parametrize(
    "path",
    [
        "/../../etc/passwd",
        "/machine/../../../../etc/passwd",
        "/%2e%2e/%2e%2e/%2e%2e/etc/passwd",
        "/..%5c..%5cwindows%5cwin.ini",
        "/_nicegui/static/../../../../../../../etc/passwd",
        "/_nicegui/x/static/%2e%2e/%2e%2e/%2e%2e/%2e%2e/%2e%2e/%2e%2e/%2e%2e/etc/passwd",
        "/_nicegui/x/components/..%2f..%2f..%2fetc%2fpasswd",
        "/_nicegui/x/resources/k/..%2f..%2f..%2f..%2fetc%2fpasswd",
    ],
)
def test_no_path_leads_out_of_what_is_served(served: Served, path: str) -> None:
    status, body, _ = _ask(served, "GET", path, Cookie=_cookie(served))
    assert "root:" not in body
    assert status in (400, 403, 404)


@pytest.mark.parametrize(
    ("language", "known", "status", "said", "back"),
    [
        ("en", True, 404, "There is no page at this address.", "To the page Machine"),
        ("de", True, 404, "Unter dieser Adresse gibt es keine Seite.", "Zur Seite Maschine"),
        ("de", False, 403, "Abgelehnt: ohne Schlüssel: die Adresse öffnen", "Zur Seite Maschine"),
    ],
)
def test_what_cannot_be_shown_is_one_plain_page_in_the_language_of_the_browser(
    served: Served, language: str, known: bool, status: int, said: str, back: str
) -> None:
    headers = {"Accept": "text/html", "Accept-Language": language} | ({"Cookie": _cookie(served)} if known else {})
    for method, path in (("GET", "/nothing"), ("GET", "/_nicegui/x/static/none.js"), ("GET", "/machine/<b>")):
        found, body, kept = _ask(served, method, path, **headers)
        assert found == status, path
        assert said in body, path
        assert f'<a class="gm-back" href="/">{back}</a>' in body
        assert "frame-ancestors 'none'" in kept["content-security-policy"]
        shown = body.rpartition("</style>")[2]
        assert not re.search(r"Exception|Traceback|nicegui|<b>", shown), path


@pytest.mark.parametrize("path", ["/a%0aforged%20line", "/%00", "/%1b[31m", "/%7f"])
def test_no_path_writes_control_characters_into_the_log(served: Served, path: str) -> None:
    status, body, _ = _ask(served, "GET", path, Cookie=_cookie(served))
    assert (status, "control characters" in body) == (403, True)


def _files_but_store(served: Served) -> set[Path]:
    """What lies in the folder of the server and beside it; SQLite makes and removes files of its own at any time."""
    return {path for path in served.folder.parent.rglob("*") if not path.name.startswith("runs.db")}


def test_program_names_that_lead_elsewhere_or_hold_a_script_are_refused_as_text(
    served: Served, operator: Callable[..., Operator]
) -> None:
    one = operator(served, "programs")
    before = _files_but_store(served)
    panel = one.panel("Cutting program")
    for name in ("../EVIL", "..\\EVIL", "/tmp/EVIL", "CON", "<b>AB</b>", "Ä"):
        panel.get_by_label("Program name", exact=True).fill(name)
        panel.get_by_role("button", name="Write cutting program").click()
        one.sees(
            re.compile(f"program name '{re.escape(repr(name.upper())[1:-1])}': (must be|is a reserved name)"), panel
        )
    assert _files_but_store(served) == before
    assert not Path("/tmp/EVIL").exists()
    assert not Path("/tmp/EVIL.MPF").exists()


def test_a_script_in_a_program_is_shown_as_text(served: Served, operator: Callable[..., Operator]) -> None:
    script = "; <img src=x onerror=\"document.title='broken'\"><script>document.title='broken'</script> `${1}`"
    (served.folder / "SCRIPT.MPF").write_text(f"{script}\nM30\n", "utf-8")
    one = operator(served, "programs")
    one.choose("Program", "SCRIPT.MPF")
    one.sees(script)
    assert one.page.title() == "Programs · gearmath"
    one.page.reload()
    one.sees("SCRIPT.MPF")
    assert one.page.title() == "Programs · gearmath"


def test_a_file_that_is_no_store_is_refused_at_the_start_and_stays_as_it_is(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "notes.db").write_text("not a store")
    (tmp_path / "folder.db").mkdir()
    for name in ("notes.db", "folder.db"):
        with pytest.raises(SystemExit) as ended:
            main(["hmi", "--port", "0", "--store", str(tmp_path / name)])
        said = capsys.readouterr().err.strip()
        assert ended.value.code == 2
        assert re.search(rf"{name}: .*measurement store", said)
        assert len(said.splitlines()) == 1
    assert (tmp_path / "notes.db").read_text() == "not a store"


def test_a_store_that_cannot_be_written_or_has_nothing_written_beside_it_is_refused_at_the_start(
    tmp_path: Path,
) -> None:
    """In a process without the right of root to write where nobody may."""
    stores = [tmp_path / name / "runs.db" for name in ("file", "folder")]
    for store in stores:
        store.parent.mkdir()
        MeasurementStore.open(store).close()
    stores[0].chmod(0o444)
    stores[1].parent.chmod(0o555)
    command = [*BOUND, sys.executable, "-c", _ONE_AFTER_THE_OTHER, *map(str, stores)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.stdout == "2\n2\n"
    assert done.stderr == "".join(f"gearmath: {store}: cannot be written: Permission denied\n" for store in stores)


def test_an_empty_file_becomes_a_store_and_that_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    store = tmp_path / "runs.db"
    store.touch()
    monkeypatch.setattr(app, "serve", lambda *_: None)
    for said in (f"{store}: was empty, and is a new measurement store now\n", ""):
        main(["hmi", "--store", str(store)])
        assert capsys.readouterr().out == said
    with MeasurementStore.open(store, create=False) as made:
        assert made.execute("PRAGMA application_id") == [(APPLICATION_ID,)]


@pytest.mark.parametrize(
    "arguments",
    [["--host", "256.1.1.1"], ["--host", "0.0.0.0"], ["--control", "missing.toml"], ["--store", "no/folder/runs.db"]],
)
def test_what_cannot_be_served_is_refused_in_one_sentence(
    arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["hmi", "--port", "0", *arguments])
    said = capsys.readouterr().err.strip()
    assert ended.value.code == 2
    assert len(said.splitlines()) == 1
    assert arguments[1].split("/")[0] in said


def test_the_token_is_printed_once_and_nowhere_else(served: Served) -> None:
    """The last one of this file: it ends the server."""
    cookie = _cookie(served)
    _ask(served, "GET", f"/login?token={served.token}")
    _ask(served, "GET", f"/login?token={served.token}&other=1", Host="evil.example")
    _ask(served, "GET", "/nothing", Cookie=cookie)
    for path in (
        f"/nothing?token={served.token}",
        f"/{served.token}",
        f"/nothing?a=%{ord(served.token[0]):02x}{served.token[1:]}",
    ):
        assert _ask(served, "GET", path, Cookie=cookie)[0] == 403
    _ask(served, "GET", "/machine", Cookie=cookie)
    said = served.stop()
    assert said.count(served.token) == 1
    kept = [path for path in served.folder.rglob("*") if path.is_file() and served.token in path.read_text("latin-1")]
    assert kept == []

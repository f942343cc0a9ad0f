"""What the tests of the operator's page share: the page served as it is shipped, a real browser, and the machine.

The server is the command in a process of its own; the control is the simulated one of the control's tests, whose log
says what was written to it. The operator works by visible labels and by keyboard.
"""

from __future__ import annotations

import os
import re
import select
import shutil
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Browser, BrowserContext, Locator, Page, TimeoutError, expect, sync_playwright

from tests.gearmath.control.live.conftest import PASSWORD, TEN, Live, _live, live  # noqa: F401
from tests.gearmath.hmi.stored import own_runs, stored_runs  # noqa: F401

#: Screenshots are left here, to be looked at.
PICTURES = Path(__file__).parents[3] / "build" / "screenshots"
_SHOWN = re.compile(r"open (http://\S+)")
#: What Chromium itself asks for, page or no page.
OF_THE_BROWSER = {
    "update.googleapis.com",
    "redirector.gvt1.com",
    "content-autofill.googleapis.com",
    "accounts.google.com",
    "www.google.com",
    "clients2.google.com",
}
#: What the cursor is on: the words of a button, the label of a field, nothing on the page as a whole. A dialog that has
#: just opened takes the cursor to itself, and is none of the buttons in it.
_ON = """() => { const on = document.activeElement;
  if (on === document.body) return "";
  const words = on.matches("button") ? on.querySelector(".q-btn__content .block") : null;
  const label = on.closest("label")?.querySelector(".q-field__label") ?? words;
  return (on.getAttribute("aria-label") ?? (label ?? on).innerText).trim(); }"""
#: Hear whether the next key does something to what the cursor is on: a button is clicked, a field hears the key. Where
#: the server falls silent between the key's way down and up, the cursor is away and a button is not clicked.
_LISTEN = f"""label => {{ window.struck = false;
  const on = document.activeElement, heard = on.closest("button") ? "click" : "keydown";
  if (({_ON})() === label) on.addEventListener(heard, () => {{ window.struck = true; }}, {{ once: true }}); }}"""
#: What a test waits for at most [ms], on a computer that does other things too.
PATIENCE = 180_000
#: What it waits for before it tries again [ms].
_SHORT = 10_000


@dataclass
class Served:
    """The page in a process: the address with its token, and the folder of its store."""

    folder: Path
    arguments: tuple[str, ...]
    before: str = ""
    """Python that the process runs before the command."""
    port: int = 0
    address: str = ""
    process: subprocess.Popen[str] | None = None
    said: str = ""

    def start(self) -> Served:
        """Start it, the second time on the same port."""
        command = [sys.executable, "-c", f"{self.before}\nfrom gearmath.cli import main; main()", "hmi"]
        command += ["--store", str(self.folder / "runs.db"), "--port", str(self.port), *self.arguments]
        environment = os.environ | {"GEARMATH_CONTROL_PASSWORD": PASSWORD, "PYTHONUNBUFFERED": "1"}
        environment.pop("PYTEST_CURRENT_TEST", None)  # NiceGUI serves otherwise in a test
        self.process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment, cwd=self.folder
        )
        assert self.process.stdout is not None
        until = time.monotonic() + 300
        while (match := _SHOWN.search(self.said)) is None:
            ready, _, _ = select.select([self.process.stdout], [], [], max(0.0, until - time.monotonic()))
            line = self.process.stdout.readline() if ready else ""
            assert line, f"the server did not start: {self.said}"
            self.said += line
        self.address = match[1]
        self.port = urlsplit(self.address).port or 0
        return self

    @property
    def base(self) -> str:
        """The address without the token."""
        return f"http://127.0.0.1:{self.port}"

    @property
    def token(self) -> str:
        return self.address.rsplit("=", 1)[-1]

    @property
    def pid(self) -> int:
        assert self.process is not None
        return self.process.pid

    def stop(self, kill: bool = False) -> str:
        """End it, and give what it has printed."""
        assert self.process is not None
        assert self.process.stdout is not None
        (self.process.kill if kill else self.process.terminate)()
        with suppress(ValueError):
            self.said += self.process.communicate(timeout=PATIENCE / 1000)[0]
        said, self.said = self.said, ""
        return said

    def memory(self) -> float:
        """What it has in memory [MB]."""
        status = Path(f"/proc/{self.pid}/status").read_text("utf-8")
        return int(re.search(r"VmRSS:\s+(\d+)", status)[1]) / 1000  # type: ignore[index]

    def busy(self) -> float:
        """How long it has computed [s]."""
        ticks = Path(f"/proc/{self.pid}/stat").read_text("utf-8").rpartition(")")[2].split()[11:13]
        return sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")

    @contextmanager
    def timed(self, what: str, asked: float) -> Iterator[None]:
        """Print how long something takes in the browser, and what the server computes for it [s]. Nothing is asserted:
        how long a loaded computer takes says nothing of the page."""
        begin, busy = time.monotonic(), self.busy()
        yield
        taken, computed = time.monotonic() - begin, self.busy() - busy
        print(f"\n{what}: {taken:.2f} s, at most {asked:g} s are asked for; the server computed {computed:.2f} s")


@pytest.fixture(scope="module")
def serve(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[..., Served]]:
    """``serve(*arguments)``: the page with these arguments, in a folder of its own."""
    made: list[Served] = []

    def start(*arguments: str, before: str = "") -> Served:
        folder = tmp_path_factory.mktemp("page") / "store"  # a test can look at what lies beside it, too
        folder.mkdir()
        made.append(Served(folder, arguments, before))
        return made[-1].start()

    yield start
    for one in made:
        if one.process is not None and one.process.poll() is None:
            one.stop()


class Elsewhere:
    """A proxy that lets nothing through, and knows what was asked of it: all that is not for this computer."""

    def __init__(self) -> None:
        self.asked: list[str] = []
        self._listening = socket.create_server(("127.0.0.1", 0))
        self.port = self._listening.getsockname()[1]
        threading.Thread(target=self._run, daemon=True).start()

    def _run(self) -> None:
        with suppress(OSError):
            while True:
                connection, _ = self._listening.accept()
                with connection, suppress(OSError):
                    connection.settimeout(5.0)
                    self.asked.append(connection.recv(500).decode("latin-1").split("\r\n")[0])
                    connection.sendall(b"HTTP/1.1 502 Bad Gateway\r\n\r\n")

    def close(self) -> None:
        self._listening.close()


@pytest.fixture(scope="session")
def elsewhere() -> Iterator[Elsewhere]:
    found = Elsewhere()
    yield found
    found.close()


@pytest.fixture(scope="module")  # for a file: beside Playwright's event loop no other test could run one
def chromium(elsewhere: Elsewhere) -> Iterator[Browser]:
    """One browser for all tests of a file; at the end it has asked nobody else than this computer."""
    path = shutil.which("chromium") or shutil.which("chromium-browser")
    if path is None:
        pytest.skip("needs chromium")
    arguments = [
        "--no-sandbox",
        # what is in space is drawn by SwiftShader; pages are not, which takes four times as long where there is no GPU
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
        "--disable-gpu-rasterization",
        "--disable-gpu-compositing",
        f"--proxy-server=http://127.0.0.1:{elsewhere.port}",
        "--disable-component-update",
        "--disable-background-networking",
    ]
    with sync_playwright() as playwright:
        found = playwright.chromium.launch(executable_path=path, args=arguments)
        yield found
        found.close()
    hosts = {re.sub(r"^\w+ (?:http://)?([^:/ ]+).*", r"\1", line) for line in elsewhere.asked if line}
    foreign = hosts - OF_THE_BROWSER
    assert foreign == set()


@dataclass
class Operator:
    """Somebody before a browser: ``page`` is what is seen, ``complaints`` what the browser reported as errors."""

    served: Served
    context: BrowserContext
    page: Page
    complaints: list[str] = field(default_factory=list)
    forgiven: tuple[str, ...] = ()
    """Parts of reports that a test causes itself, such as a server that is away."""

    def go(self, name: str) -> Operator:
        """Open a page by its name in the address."""
        self.page.goto(f"{self.served.base}/{name}")
        return self.is_heard()

    def is_heard(self) -> Operator:
        """Wait until the server hears what is pressed, as a look at the page tells an operator."""
        self.page.locator("body.gm-is-live .gm-main").wait_for()
        return self

    def key(self, label: str, key: str) -> None:
        """Press a key on a button that is reached by keyboard."""
        self.is_heard()
        one = self.page.get_by_role("button", name=label, exact=True)
        one.focus()
        expect(one).to_be_focused(timeout=PATIENCE)
        self.page.keyboard.press(key)

    def press(self, label: str) -> None:
        """Press a button."""
        self.page.get_by_role("button", name=label, exact=True).click()

    def press_until(self, label: str, sign: Locator) -> None:
        """Press a button until its sign is there: once more where the server fell silent just then."""
        for _ in range(10):
            self.press(label)
            with suppress(TimeoutError):
                return sign.wait_for(timeout=_SHORT)
        raise AssertionError(f"{label} is pressed and nothing comes of it; console: {self.complaints}")

    def tab_to(self, label: str) -> None:
        """Press Tab until the cursor is on the button or field of this label, and the server hears what comes next.

        It begins once that is there to be used: a busy server asks its questions late."""
        self.is_heard()
        button = self.page.get_by_role("button", name=label, exact=True)
        wanted = button.or_(self.page.get_by_role("combobox", name=label, exact=True)).first
        expect(wanted).to_be_enabled(timeout=PATIENCE)
        for _ in range(100):
            self.page.keyboard.press("Tab")
            self.is_heard()  # while the server is silent the cursor is nowhere
            if self.page.evaluate(_ON) == label:
                return
        raise AssertionError(f"{label} is not reached by Tab; at the end it was on {self.page.evaluate(_ON)!r}")

    def strike(self, label: str, key: str) -> None:
        """Press a key on the button or field of this label, reached by Tab; once more where the page has not taken it,
        because the server fell silent or a dialog took the cursor just then."""
        for _ in range(10):
            self.tab_to(label)
            self.page.evaluate(_LISTEN, label)
            self.page.keyboard.press(key)
            if self.page.evaluate("window.struck"):
                return
        raise AssertionError(f"{label} does not take {key}")

    def choose_by_keys(self, label: str, value: str) -> None:
        """Choose the first of a list by keyboard, once more where the server fell silent while it was open."""
        option = self.page.get_by_role("option", name=value, exact=True)
        for _ in range(10):
            self.strike(label, "Enter")
            with suppress(TimeoutError, AssertionError):
                option.wait_for(timeout=_SHORT)
                self.page.keyboard.press("ArrowDown")
                self.page.keyboard.press("Enter")
                field = self.page.get_by_role("combobox", name=label, exact=True)
                expect(field).to_have_value(value, timeout=_SHORT)
                return
            self.page.keyboard.press("Escape")
        raise AssertionError(f"{label} does not take {value} by keyboard")

    def fill(self, label: str, value: str) -> None:
        """Type into a field, and leave it."""
        one = self.page.get_by_label(label, exact=True)
        one.fill(value)
        one.press("Tab")

    def choose(self, label: str, value: str) -> None:
        """Choose from a list, which is opened again where it did not hold the value yet."""
        option = self.page.get_by_role("option", name=value, exact=True)
        until = time.monotonic() + PATIENCE / 1000
        while True:
            self.page.get_by_role("combobox", name=label, exact=True).click()
            try:
                option.click(timeout=_SHORT)
                return
            except TimeoutError:
                if time.monotonic() > until:
                    raise
                self.page.keyboard.press("Escape")

    def panel(self, title: str) -> Locator:
        """A part of the page by its title."""
        return self.page.get_by_role("region", name=title, exact=True)

    def sees(self, words: str | re.Pattern[str], where: Locator | None = None) -> Locator:
        """Wait until words are on the page."""
        found = (where or self.page).get_by_text(words).first
        try:
            found.wait_for(timeout=PATIENCE)
        except TimeoutError as error:
            shown = " | ".join(self.page.locator("body").inner_text().split("\n"))
            raise AssertionError(f"{words!r} is not on the page: {shown[:3000]}; console: {self.complaints}") from error
        return found

    def picture(self, name: str) -> Path:
        """Leave a screenshot."""
        PICTURES.mkdir(parents=True, exist_ok=True)
        self.page.screenshot(path=PICTURES / f"{name}.png", timeout=PATIENCE)
        return PICTURES / f"{name}.png"

    def sticks_out(self, width: int, height: int) -> list[str]:
        """What reaches over the edge of its panel when the screen has another size, such as a tablet that is turned."""
        self.page.set_viewport_size({"width": width, "height": height})
        look = """() => [...document.querySelectorAll('.gm-fact, .gm-figure, .gm-plain, .gm-chart, .gm-row')]
          .filter(e => e.getBoundingClientRect().right > e.closest('.gm-panel').getBoundingClientRect().right + 1)
          .map(e => e.textContent.slice(0, 60))"""
        found: list[str] = self.page.evaluate(look)
        for _ in range(50):  # until it is drawn anew
            if not found:
                break
            self.page.wait_for_timeout(100)
            found = self.page.evaluate(look)
        return found

    def axe(self) -> list[str]:
        """Serious and critical violations that axe-core finds, with the first place of each."""
        from axe_core_python.sync_playwright import Axe

        # of what passes, nothing is told: most of the time goes into the telling
        found: dict[str, Any] = Axe().run(self.page, options={"resultTypes": ["violations"]})
        return [
            f"{one['id']}: {one['nodes'][0]['html'][:200]}"
            for one in found["violations"]
            if one["impact"] in ("serious", "critical")
        ]


@pytest.fixture
def operator(chromium: Browser) -> Iterator[Callable[..., Operator]]:
    """``operator(served, page="machine", language="en", dark=False, size=(1280, 800))``, as many as wanted.

    At the end none of them has seen an error on the console.
    """
    made: list[Operator] = []

    def begin(
        served: Served,
        page: str = "machine",
        language: str = "en",
        dark: bool = False,
        size: tuple[int, int] = (1280, 800),
    ) -> Operator:
        context = chromium.new_context(
            viewport={"width": size[0], "height": size[1]}, locale=language, reduced_motion="reduce"
        )
        context.set_default_timeout(PATIENCE)
        look = {"name": "gearmath_look", "value": "dark" if dark else "light", "url": served.base}
        token = {"name": f"gearmath_{served.port}", "value": served.token, "url": served.base, "httpOnly": True}
        context.add_cookies([look, token])  # type: ignore[list-item]
        one = Operator(served, context, context.new_page())
        one.page.on("console", lambda said: _hear(one, said.type, said.text))
        one.context.on("request", lambda request: _follow(one, request.url))
        one.page.on("request", lambda asked: _stays(one, asked.url))
        one.page.on("pageerror", lambda error: one.complaints.append(str(error)))
        made.append(one)
        return one.go(page)

    yield begin
    for one in made:
        one.context.close()
    assert [said for one in made for said in one.complaints if not any(part in said for part in one.forgiven)] == []


def _stays(one: Operator, url: str) -> None:
    """What the page itself asks for is of this computer."""
    if urlsplit(url).hostname not in (None, "127.0.0.1"):
        one.complaints.append(f"asks for {url}")


def _hear(one: Operator, kind: str, text: str) -> None:
    """Errors, and the reason of a page that loads itself again: what was pressed then may be lost. Not where a busy
    server was waited for in vain: nothing can be pressed before it is heard."""
    if kind == "error" or (text.startswith("reloading because") and "connection timed out" not in text):
        one.complaints.append(text)


def _follow(one: Operator, url: str) -> None:
    if not url.startswith((one.served.base, "data:", "blob:")):
        one.complaints.append(f"asks for {url}")


@pytest.fixture(scope="module")
def page(serve: Callable[..., Served], _live: Live) -> Served:  # noqa: F811
    """The page on the simulated control of these tests, with the program of ten touches in its folder."""
    text = (_live.folder / "control.toml").read_text("utf-8")
    file = _live.folder / "page.toml"
    file.write_text(re.sub(r'url = ".*"', f'url = "{_live.control.url}"', text), "utf-8")
    served = serve("--control", str(file))
    (served.folder / Live.NAME).write_text(TEN, "utf-8")
    return served

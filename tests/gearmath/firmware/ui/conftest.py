"""The operator's part of the firmware with the real core, on this computer, for the bundled machines."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Callable
from importlib.resources import files as package_files
from pathlib import Path

import pytest

from derivations.gearbox import encoder_hysteresis, gearbox_edge
from gearmath.engine.compiler import find_compiler
from gearmath.errors import ComputationError
from gearmath.export.c import integer_kernel
from gearmath.export.machine_header import machine_header
from gearmath.lowering import lower
from gearmath.specs.hobbing import load_hobbing_machine
from gearmath.specs.toml import bundled

POLL, UP, DOWN, SHORT, LONG = range(5)
IDLE, RUN, MOVE, FAULT = range(4)
STRICT = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror")

#: A board without a board: the core's interrupts are played by calls, and nothing masks them but a count.
BOARD = """\
#include <string.h>
#include "gm_store.h"
#include "gm_ui.h"

static gm_core core;
static gm_ui ui;
static int masked, estop_open;

void gm_mask(void) { ++masked; }
void gm_unmask(void) { --masked; }
int board_masked(void) { return masked; }

static void status_of(gm_status *status) { gm_core_status(&core, status); }

void board_power_up(const gm_settings *restored)
{
  gm_status status;
  gm_core_init(&core);
  estop_open = 0;
  status_of(&status);
  gm_ui_init(&ui, &core, restored, &status);
}

unsigned board_event(int event, uint32_t now)
{
  gm_status status;
  status_of(&status);
  return gm_ui_event(&ui, event, &status, now);
}

void board_ticks(long n)
{
  gm_core_alive(&core);
  for (; n > 0; --n) gm_core_tick(&core, estop_open ? 0 : GM_IN_ESTOP_OK);
}

void board_edges(int axis, long n, int edge, long ticks)
{
  for (; n > 0; --n) {
    gm_core_edge(&core, axis, edge);
    board_ticks(ticks);
  }
}

void board_shoulder(int place) { gm_core_set_shoulder(&core, place); }
void board_estop(int open) { estop_open = open; }
void board_screen(char *text) { memcpy(text, ui.screen, sizeof ui.screen); }
int board_mode(void) { gm_status status; status_of(&status); return (int)status.mode; }
long board_position(void) { gm_status status; status_of(&status); return (long)status.position; }
void board_edit(gm_settings *settings) { *settings = ui.edit; }

void board_job(int64_t *denominator, int64_t *increments, int32_t *bases)
{
  int axis;
  *denominator = core.job.denominator;
  for (axis = 0; axis < GM_AXES; ++axis) {
    increments[axis] = core.job.increment[axis];
    bases[axis] = core.job.base[axis];
  }
}

/* The page of one hob for one tooth count, without turning the knob there. */
void board_hob_page(int hob, int teeth)
{
  gm_status status;
  status_of(&status);
  ui.page = GM_PAGE_HOB;
  ui.hob = hob;
  ui.edit.teeth = (uint16_t)teeth;
  gm_edit_turn(&ui, 0, 1);
  gm_screen_draw(&ui, &status);
}

/* What the core would report, drawn on one view of the page of the run. */
void board_run_page(int view, int teeth, uint32_t rate, int64_t edges, int64_t position, int32_t pending)
{
  gm_status status;
  status_of(&status);
  status.mode = GM_RUN;
  status.in_phase = 1;
  status.edge_rate = rate;
  status.edges[GM_HOB] = edges;
  status.position = position;
  status.pending = pending;
  ui.page = GM_PAGE_RUN;
  ui.choice = view;
  ui.loaded.teeth = (uint16_t)teeth;
  gm_screen_draw(&ui, &status);
}

/* The page of a fault as the core would report it, with and without the phase. */
void board_fault_page(int fault, int kept)
{
  gm_status status;
  status_of(&status);
  status.mode = GM_FAULT;
  status.fault = (gm_fault)fault;
  ui.page = GM_PAGE_FAULT;
  ui.phase = (uint8_t)kept;
  gm_screen_draw(&ui, &status);
}

int job_make(const gm_settings *settings, int64_t *denominator, int64_t *increments, int32_t *bases, uint32_t *rpm)
{
  gm_job job;
  gm_facts facts;
  int axis;
  gm_refusal refusal = gm_job_make(settings, &job, &facts);
  *rpm = facts.max_rpm;
  if (refusal != GM_JOB_OK) return (int)refusal;
  *denominator = job.denominator;
  for (axis = 0; axis < GM_AXES; ++axis) {
    increments[axis] = job.increment[axis];
    bases[axis] = job.base[axis];
  }
  return 0;
}

#ifdef BOARD_MAIN
#include <stdio.h>
/* Random events, for the sanitizers; the screen must always be 4 lines of 20 printable characters. */
int main(void)
{
  uint32_t random = 1, now = 0;
  uint8_t image[GM_STORE_BYTES];
  gm_settings last;
  uint32_t sequence;
  long k;
  int row, column;
  memset(image, 0xff, sizeof image);
  board_power_up(NULL);
  for (k = 0; k < 30000; ++k) {
    random = random * 1664525u + 1013904223u;
    now += (random >> 8) % 90;
    if (board_event((int)((random >> 16) % 5), now) & GM_UI_SAVE && gm_store_save(image, &ui.edit) < 0) return 1;
    board_ticks((random >> 20) % 200);
    if ((random >> 24) % 8 == 0) board_edges(GM_HOB, (random >> 10) % 30, random & 1 ? 1 : -1, 20);
    if ((random >> 22) % 600 == 0) board_estop(!estop_open);
    for (row = 0; row < GM_ROWS; ++row) {
      if (strlen(ui.screen[row]) != GM_COLUMNS) return 2;
      for (column = 0; column < GM_COLUMNS; ++column) {
        if (ui.screen[row][column] < 32 || ui.screen[row][column] > 126) return 3;
      }
    }
  }
  return gm_store_load(image, &last, &sequence) < 0 ? 4 : 0;
}
#endif
"""


class Settings(ctypes.Structure):
    """gm_settings."""

    _fields_ = [
        ("profile", ctypes.c_uint8),
        ("hob_unit", ctypes.c_uint8),
        ("depth_rule", ctypes.c_uint8),
        ("starts", ctypes.c_int8),
        ("left", ctypes.c_uint8),
        ("climb", ctypes.c_uint8),
        ("pitch_kind", ctypes.c_uint8),
        ("teeth", ctypes.c_uint16),
        ("helix", ctypes.c_uint16),
        ("hob_size", ctypes.c_int32),
        ("pitch", ctypes.c_int32),
        ("feed", ctypes.c_int32),
    ]

    def values(self) -> tuple[int, ...]:
        return tuple(getattr(self, name) for name, *_ in self._fields_)


def settings(**changes: int) -> Settings:
    """A spur gear of 24 teeth and module 1 with changes, or a thread of 1 mm where profile = 1."""
    usual = {"hob_unit": 1, "depth_rule": 3, "starts": 1, "teeth": 24, "hob_size": 10_000, "pitch": 1000, "feed": 250}
    return Settings(**usual | changes)


class Panel:
    """Knob, button and display; the hob and the seconds go by when told."""

    def __init__(self, library: ctypes.CDLL) -> None:
        self.library = library
        self.now = 0
        self.library.board_power_up(None)

    def power_up(self, restored: Settings | None) -> None:
        self.library.board_power_up(ctypes.byref(restored) if restored is not None else None)

    def event(self, event: int, after_ms: int = 200) -> int:
        self.now += after_ms
        requests = int(self.library.board_event(event, ctypes.c_uint32(self.now)))
        assert self.library.board_masked() == 0
        return requests

    def knob(self, detents: int, after_ms: int = 200) -> None:
        for _ in range(abs(detents)):
            self.event(UP if detents > 0 else DOWN, after_ms)

    def short(self) -> int:
        return self.event(SHORT)

    def long(self) -> int:
        return self.event(LONG)

    def ticks(self, n: int) -> None:
        self.library.board_ticks(ctypes.c_long(n))
        self.event(POLL)

    def edges(self, n: int, ticks: int = 100, axis: int = 0) -> None:
        self.library.board_edges(axis, ctypes.c_long(abs(n)), 1 if n > 0 else -1, ctypes.c_long(ticks))
        self.event(POLL)

    def estop(self, pressed: bool) -> None:
        self.library.board_estop(int(pressed))
        self.ticks(100)

    @property
    def screen(self) -> str:
        """The four lines, as they stand."""
        text = ctypes.create_string_buffer(4 * 21)
        self.library.board_screen(text)
        rows = [text.raw[k * 21 : k * 21 + 21] for k in range(4)]
        assert all(row[20] == 0 and all(32 <= letter <= 126 for letter in row[:20]) for row in rows), rows
        return "\n".join(row[:20].decode("ascii") for row in rows)

    @property
    def mode(self) -> int:
        return int(self.library.board_mode())

    @property
    def position(self) -> int:
        self.library.board_position.restype = ctypes.c_long
        return int(self.library.board_position())

    @property
    def job(self) -> tuple[int, ...]:
        """Denominator, increments and bases in the core."""
        return _job(lambda *fields: self.library.board_job(*fields))

    @property
    def edit(self) -> Settings:
        """What the pages would change."""
        shown = Settings()
        self.library.board_edit(ctypes.byref(shown))
        return shown


def _job(call: Callable[..., object]) -> tuple[int, ...]:
    denominator, increments, bases = ctypes.c_int64(), (ctypes.c_int64 * 2)(), (ctypes.c_int32 * 2)()
    call(ctypes.byref(denominator), increments, bases)
    return (denominator.value, *increments, *bases)


def firmware_files(machine: str, **macros: int) -> dict[str, str]:
    """All portable files, the kernels, the machine's constants (with changes) and the board of the tests."""
    folder = package_files("gearmath.export") / "firmware"
    files = {item.name: item.read_text("utf-8") for item in folder.iterdir() if item.name.endswith((".c", ".h"))}
    loaded = load_hobbing_machine(bundled(f"{machine}.toml"))
    files |= integer_kernel(lower(gearbox_edge()), 64 if loaded.wide else 32, inline=True).files
    files |= integer_kernel(lower(encoder_hysteresis()), inline=True).files
    header = machine_header(loaded)
    # the hob of these tests starts and stops at once: the motion within the acceleration has its own tests
    macros = {"GM_ACCELERATION": 10_000_000, **macros}
    for name, value in macros.items():
        lines = [line for line in header.splitlines() if line.startswith(f"#define {name} ")]
        assert len(lines) == 1, name
        header = header.replace(lines[0], f"#define {name} {value}")
    return files | {"gm_machine.h": header, "board.c": BOARD}


def build(folder: Path, files: dict[str, str], flags: tuple[str, ...], target: str) -> Path:
    """Compile all sources; raises ComputationError with the compiler's words."""
    for name, text in files.items():
        (folder / name).write_text(text, "utf-8", newline="\n")
    sources = sorted(name for name in files if name.endswith(".c"))
    command = [*find_compiler(), *flags, *sources, "-o", target]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode:
        raise ComputationError(done.stderr)
    return folder / target


@pytest.fixture(scope="session")
def firmware(tmp_path_factory) -> Callable[..., ctypes.CDLL]:
    """``firmware("hobbing_plewes", "-fsingle-precision-constant", GM_...=...)``: the library of one machine."""
    built: dict[tuple, ctypes.CDLL] = {}

    def make(machine: str, *flags: str, **macros: int) -> ctypes.CDLL:
        key = (machine, flags, *sorted(macros.items()))
        if key not in built:
            folder = tmp_path_factory.mktemp("firmware")
            files = firmware_files(machine, **macros)
            built[key] = ctypes.CDLL(str(build(folder, files, (*STRICT, "-O1", "-fPIC", "-shared", *flags), "lib.so")))
        return built[key]

    return make


@pytest.fixture(scope="session")
def make_job() -> Callable[..., tuple[int, tuple[int, ...], int]]:
    """``make_job(library, settings)``: the refusal (0: none), the job, and the highest rpm."""

    def make(library: ctypes.CDLL, wanted: Settings) -> tuple[int, tuple[int, ...], int]:
        rpm = ctypes.c_uint32()
        refusal: list[int] = []
        job = _job(lambda *fields: refusal.append(library.job_make(ctypes.byref(wanted), *fields, ctypes.byref(rpm))))
        return refusal[0], job, rpm.value

    return make


@pytest.fixture
def panel(firmware) -> Callable[..., Panel]:
    """``panel("hobbing_plewes")``: the operator's side of a machine after its first power-up."""
    return lambda machine, **macros: Panel(firmware(machine, **macros))


@pytest.fixture(scope="session")
def new_settings() -> Callable[..., Settings]:
    return settings


@pytest.fixture(scope="session")
def build_firmware(tmp_path_factory) -> Callable[..., Path]:
    """``build_firmware(machine, flags)``: the program of random events, compiled with other flags."""

    def make(machine: str, *flags: str) -> Path:
        folder = tmp_path_factory.mktemp("program")
        return build(folder, firmware_files(machine), (*flags, "-DBOARD_MAIN"), "program")

    return make

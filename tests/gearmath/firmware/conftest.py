"""The portable core on this computer and on an emulated Cortex-M4, for machines that the tests make up.

``machine_text`` writes the constants of a machine itself, so that the core is tested apart from the export.
"""

from __future__ import annotations

import ctypes
import shutil
import struct
import subprocess
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib.resources import files as package_files
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from capstone import CS_ARCH_ARM, CS_MODE_MCLASS, CS_MODE_THUMB, Cs
from elftools.elf.elffile import ELFFile
from unicorn import (
    UC_ARCH_ARM,
    UC_HOOK_BLOCK,
    UC_MODE_MCLASS,
    UC_MODE_THUMB,
    UC_PROT_EXEC,
    UC_PROT_READ,
    UC_PROT_WRITE,
    Uc,
)
from unicorn.arm_const import (
    UC_ARM_REG_LR,
    UC_ARM_REG_PC,
    UC_ARM_REG_R0,
    UC_ARM_REG_SP,
    UC_CPU_ARM_CORTEX_M4,
    UC_CPU_ARM_CORTEX_M7,
)

from derivations.gearbox import encoder_hysteresis, gearbox_edge, gearbox_step
from gearmath.engine.compiler import compile_library
from gearmath.export.c import integer_kernel
from gearmath.lowering import lower

#: A machine of the tests: the source text's train, and times that differ from each other.
MACHINE = {
    "GM_ENCODER_COUNTS": 4096,
    "GM_TICK_NS": 5000,
    "GM_STEP_HIGH_TICKS": 2,
    "GM_STEP_LOW_TICKS": 3,
    "GM_DIR_SETUP_TICKS": 4,
    "GM_DIR_HOLD_TICKS": 5,
    "GM_STEP_ACTIVE_LOW": 0,
    "GM_DIR_ACTIVE_LOW": 0,
    "GM_DIR_INVERT": 0,
    "GM_ENABLE_ACTIVE_LOW": 0,
    "GM_MAX_LAG": 100,
    "GM_MAX_EDGE_RATE": 54613,
    "GM_MOVE_MAX_RATE": 4000,
    "GM_MOVE_ACCELERATION": 8000,
    # edges of these tests start at full speed: a motor that follows at once, but where a test is about acceleration
    "GM_ACCELERATION": 10_000_000,
    "GM_HAS_INDEX": 0,
    "GM_HAS_ESTOP": 1,
    "GM_PROFILE_HOBBING": 1,
}


def machine_text(wide: bool, changes: Mapping[str, int | None]) -> str:
    """``gm_machine.h``; None takes a macro out."""
    macros = {**MACHINE, "GM_WIDE": int(wide), **changes}
    lines = "\n".join(f"#define {name} {value}" for name, value in macros.items() if value is not None)
    width = "int64_t" if wide else "int32_t"
    return (
        f"#ifndef GM_MACHINE_H\n#define GM_MACHINE_H\n#include <stdint.h>\ntypedef {width} gm_wide;\n{lines}\n#endif\n"
    )


def core_files(wide: bool, changes: Mapping[str, int | None]) -> dict[str, str]:
    """The core as text, with its kernels and the constants of a machine."""
    folder = package_files("gearmath.export") / "firmware"
    files = {name: (folder / name).read_text("utf-8") for name in ("gm_core.h", "gm_core.c")}
    files |= integer_kernel(lower(gearbox_edge()), 64 if wide else 32, inline=True).files
    files |= integer_kernel(lower(encoder_hysteresis()), inline=True).files
    return files | {"gm_machine.h": machine_text(wide, changes)}


#: Plays a script, tick by tick: the edges, then the index pulse, then the tick; notes what the pins and the core say.
PROBE = """\
#include <string.h>

#include "gm_core.h"

static gm_core core;

typedef struct {
  int32_t mode, fault, pending, index_error, waiting, in_phase, has_job;
  int64_t edges, feed, position;
  uint32_t edge_rate, index_turns;
} probe_status;

void probe_init(void) { gm_core_init(&core); }
int probe_run(void) { return gm_core_run(&core); }
void probe_stop(void) { gm_core_stop(&core); }
void probe_shoulder(int place) { gm_core_set_shoulder(&core, place); }
int probe_move(int32_t steps) { return gm_core_move(&core, steps); }
int probe_arm(void) { gm_core_alive(&core); return gm_core_arm(&core); }
int probe_acknowledge(void) { return gm_core_acknowledge(&core); }

int probe_job(int64_t denominator, const int64_t *increment, const int32_t *base, int32_t hysteresis)
{
  gm_job job;
  int axis;
  job.denominator = (gm_wide)denominator;
  for (axis = 0; axis < GM_AXES; ++axis) {
    job.increment[axis] = (gm_wide)increment[axis];
    job.base[axis] = base[axis];
  }
  job.hysteresis = hysteresis;
  return gm_core_set_job(&core, &job);
}

void probe_get(probe_status *to)
{
  gm_status status;
  gm_core_status(&core, &status);
  to->mode = (int32_t)status.mode;
  to->fault = (int32_t)status.fault;
  to->edges = status.edges[GM_HOB];
  to->feed = status.edges[GM_FEED];
  to->position = status.position;
  to->pending = status.pending;
  to->edge_rate = status.edge_rate;
  to->index_turns = status.index_turns;
  to->index_error = status.index_error;
  to->waiting = status.waiting;
  to->in_phase = status.in_phase;
  to->has_job = status.has_job;
}

/* From the next tick on, after each: does a reset, with the memory as it is, give the core of the first power-up? */
static int resets;
static long not_fresh;
void probe_resets(void)
{
  resets = 1;
  not_fresh = 0;
}
long probe_not_fresh(void) { return not_fresh; }

static void reset_here(void)
{
  static gm_core first, kept;
  memset(&first, 0, sizeof first);
  gm_core_init(&first);
  kept = core;
  gm_core_init(&core);
  not_fresh += memcmp(&core, &first, sizeof core) != 0;
  core = kept;
}

/* per tick: hob edges and feed edges (signed number), index pulses, inputs; levels, mode, position, lag, fault */
void probe_play(long ticks, const int8_t *hob, const int8_t *feed, const uint8_t *index, const uint8_t *inputs,
                uint8_t *levels, uint8_t *mode, int64_t *position, int32_t *pending, uint8_t *fault)
{
  long k;
  int n;
  for (k = 0; k < ticks; ++k) {
    for (n = hob[k]; n > 0; --n) gm_core_edge(&core, GM_HOB, 1);
    for (n = hob[k]; n < 0; ++n) gm_core_edge(&core, GM_HOB, -1);
    for (n = feed[k]; n > 0; --n) gm_core_edge(&core, GM_FEED, 1);
    for (n = feed[k]; n < 0; ++n) gm_core_edge(&core, GM_FEED, -1);
    if (index[k]) gm_core_index(&core);
    levels[k] = (uint8_t)gm_core_tick(&core, inputs[k]);
    mode[k] = (uint8_t)core.mode;
    position[k] = core.position;
    pending[k] = core.locked ? core.pending : core.pending + core.behind;
    fault[k] = (uint8_t)core.fault;
    if (resets) reset_here();
  }
}

/* How many ticks of a tape of hob edges give its steps. */
long probe_follow(long ticks, const int8_t *hob, const int8_t *steps)
{
  long k;
  int n;
  for (k = 0; k < ticks; ++k) {
    const int64_t before = core.position;
    for (n = hob[k]; n > 0; --n) gm_core_edge(&core, GM_HOB, 1);
    for (n = hob[k]; n < 0; ++n) gm_core_edge(&core, GM_HOB, -1);
    (void)gm_core_tick(&core, GM_IN_ESTOP_OK);
    if (core.position - before != steps[k]) break;
  }
  return k;
}
"""

IDLE, RUN, MOVE, FAULT = range(4)
NO_FAULT, ESTOP, LAG, OVERSPEED, ENCODER, HOB_MOVED = range(6)


class Status(ctypes.Structure):
    """gm_status."""

    _fields_ = [
        *(
            (name, ctypes.c_int32)
            for name in ("mode", "fault", "pending", "index_error", "waiting", "in_phase", "has_job")
        ),
        *((name, ctypes.c_int64) for name in ("edges", "feed", "position")),
        *((name, ctypes.c_uint32) for name in ("edge_rate", "index_turns")),
    ]


@dataclass(frozen=True)
class Record:
    """What one script gave, one entry a tick."""

    levels: np.ndarray
    mode: np.ndarray
    position: np.ndarray
    pending: np.ndarray
    fault: np.ndarray


@dataclass
class Core:
    """The core on this computer."""

    library: ctypes.CDLL = field(repr=False)
    macros: Mapping[str, int | None]

    def __post_init__(self) -> None:
        self.library.probe_init()

    def job(self, N: int, D: int, feed: int = 0, hysteresis: int = 0) -> int:
        """Set the ratios N/D of the hob and feed/D of the feed."""
        terms = [divmod(ratio, D) if D else (0, ratio) for ratio in (N, feed)]
        base = (ctypes.c_int32 * 2)(*(q for q, _ in terms))
        increment = (ctypes.c_int64 * 2)(*(rest for _, rest in terms))
        return int(self.library.probe_job(ctypes.c_int64(D), increment, base, ctypes.c_int32(hysteresis)))

    def run(self) -> int:
        return int(self.library.probe_run())

    def stop(self) -> None:
        self.library.probe_stop()

    def move(self, steps: int) -> int:
        return int(self.library.probe_move(ctypes.c_int32(steps)))

    def arm(self) -> int:
        """The operator's act, with a main program that works."""
        return int(self.library.probe_arm())

    def acknowledge(self) -> int:
        return int(self.library.probe_acknowledge())

    def play(self, hob=0, ticks: int | None = None, feed=0, index=0, inputs=1) -> Record:
        """Play arrays (or constants) of signed edges, index pulses and inputs, one entry a tick."""
        lengths = [len(values) for values in (hob, feed, index, inputs) if np.ndim(values)]
        n = ticks if ticks is not None else lengths[0]
        scripts = [
            np.ascontiguousarray(np.broadcast_to(np.asarray(values), (n,)).astype(kind))
            for values, kind in ((hob, np.int8), (feed, np.int8), (index, np.uint8), (inputs, np.uint8))
        ]
        record = Record(*(np.empty(n, kind) for kind in (np.uint8, np.uint8, np.int64, np.int32, np.uint8)))
        arrays = [*scripts, record.levels, record.mode, record.position, record.pending, record.fault]
        self.library.probe_play(ctypes.c_long(n), *(ctypes.c_void_p(array.ctypes.data) for array in arrays))
        return record

    @property
    def status(self) -> Status:
        status = Status()
        self.library.probe_get(ctypes.byref(status))
        return status


@pytest.fixture(scope="session")
def new_core(host_compiler) -> Callable[..., Core]:
    """``new_core(wide=False, GM_...=...)``: a core after power-up; None takes a macro out."""
    built: dict[tuple, ctypes.CDLL] = {}

    def make(wide: bool = False, **changes: int | None) -> Core:
        key = (wide, *sorted(changes.items()))
        if key not in built:
            built[key] = compile_library(core_files(wide, changes) | {"probe.c": PROBE})
        return Core(built[key], {**MACHINE, **changes})

    return make


@pytest.fixture(scope="session")
def core_text() -> Callable[..., dict[str, str]]:
    """``core_text(wide=False, GM_...=...)``: the files of the core and of the probe."""
    return lambda wide=False, **changes: core_files(wide, changes) | {"probe.c": PROBE}


# --- Cortex-M4 ----------------------------------------------------------------------------------------------------

CODE, DATA, STACK, HALT = 0x0001_0000, 0x2000_0000, 0x3000_0000, 0x000F_0000
PROCESSORS = {"cortex-m4": UC_CPU_ARM_CORTEX_M4, "cortex-m7": UC_CPU_ARM_CORTEX_M7}
FLAGS = [
    "-mthumb",
    "-mfloat-abi=soft",
    "-O2",
    "-std=c99",
    "-pedantic",
    "-Wall",
    "-Wextra",
    "-Werror",
]
LAYOUT = """\
SECTIONS {
  . = 0x10000;
  .text : { *(.text*) *(.rodata*) }
  .data 0x20100000 : { *(.data*) *(.bss*) *(COMMON) }
  /DISCARD/ : { *(.comment) *(.ARM.exidx*) *(.ARM.extab*) }
}
"""
#: What the compiler calls, where there is no library.
FREESTANDING = """\
#include <stddef.h>

void *memset(void *to, int value, size_t n);
void *memcpy(void *to, const void *from, size_t n);
int memcmp(const void *one, const void *other, size_t n);

void *memset(void *to, int value, size_t n)
{
  volatile unsigned char *byte = (volatile unsigned char *)to;
  while (n--) *byte++ = (unsigned char)value;
  return to;
}

void *memcpy(void *to, const void *from, size_t n)
{
  volatile unsigned char *byte = (volatile unsigned char *)to;
  const unsigned char *source = (const unsigned char *)from;
  while (n--) *byte++ = *source++;
  return to;
}

int memcmp(const void *one, const void *other, size_t n)
{
  const volatile unsigned char *a = (const volatile unsigned char *)one, *b = (const volatile unsigned char *)other;
  for (; n; n--, a++, b++) {
    if (*a != *b) return *a < *b ? -1 : 1;
  }
  return 0;
}
"""
TARGET = """\
#include "gm_core.h"

gm_core core;
gm_job job;

void start(void)
{
  gm_core_init(&core);
  gm_core_set_job(&core, &job);
  gm_core_run(&core);
}

void wait(int32_t ticks)
{
  while (ticks-- > 0) (void)gm_core_tick(&core, GM_IN_ESTOP_OK);
}

/* edges: +1 or -1 of the hob, +2 or -2 of the feed; then ticks until the driver could follow. */
void drive(const int8_t *edges, int32_t *reached, int32_t n, int32_t ticks)
{
  int32_t i, k;
  for (i = 0; i < n; ++i) {
    if (edges[i] & 1) {
      gm_core_edge(&core, GM_HOB, edges[i]);
    } else {
      gm_core_edge(&core, GM_FEED, edges[i] / 2);
    }
    for (k = 0; k < ticks; ++k) (void)gm_core_tick(&core, GM_IN_ESTOP_OK);
    reached[i] = (int32_t)(core.position + core.pending);
  }
}
"""


class Target:
    """A program on an emulated processor: functions called by name, and the instructions that they execute."""

    def __init__(self, elf: Path, processor: str) -> None:
        self._core = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
        self._core.ctl_set_cpu_model(PROCESSORS[processor])
        self._core.mem_map(CODE, 0x10_0000, UC_PROT_READ | UC_PROT_EXEC)
        for address, size in ((DATA, 0x200_0000), (STACK, 0x1_0000)):  # no code, so that writing is cheap
            self._core.mem_map(address, size, UC_PROT_READ | UC_PROT_WRITE)
        self.symbols: dict[str, int] = {}
        self._lengths: dict[tuple[int, int], int] = {}
        self._decoder = Cs(CS_ARCH_ARM, CS_MODE_THUMB | CS_MODE_MCLASS)
        with elf.open("rb") as stream:
            file = ELFFile(stream)
            table: Any = file.get_section_by_name(".symtab")
            self.symbols = {symbol.name: symbol["st_value"] for symbol in table.iter_symbols()}
            for segment in file.iter_segments("PT_LOAD"):
                if segment["p_filesz"] and segment["p_vaddr"] >= CODE:
                    self._core.mem_write(segment["p_vaddr"], segment.data())

    def write(self, address: int, data: bytes) -> None:
        self._core.mem_write(address, data)

    def read(self, address: int, size: int) -> bytes:
        return bytes(self._core.mem_read(address, size))

    def call(self, name: str, *arguments: bytes | int) -> int:
        """Call with words by the procedure call standard: four in registers, the rest on the stack. What it returns."""
        words = [int(word) & 0xFFFFFFFF for word in arguments]
        top = STACK + 0x1_0000 - 512
        for k, word in enumerate(words[:4]):
            self._core.reg_write(UC_ARM_REG_R0 + k, word)
        self.write(top, b"".join(word.to_bytes(4, "little") for word in words[4:]) or b"\0")
        self._core.reg_write(UC_ARM_REG_SP, top)
        self._core.reg_write(UC_ARM_REG_LR, HALT | 1)
        self._core.emu_start(self.symbols[name] | 1, HALT)
        assert self._core.reg_read(UC_ARM_REG_PC) == HALT
        return int(self._core.reg_read(UC_ARM_REG_R0))

    def instructions(self, name: str, *arguments: int) -> int:
        """Instructions executed by one call, its return included: every basic block that runs is disassembled."""
        blocks: Counter[tuple[int, int]] = Counter()
        hook = self._core.hook_add(UC_HOOK_BLOCK, lambda core, address, size, _: blocks.update([(address, size)]))
        self.call(name, *arguments)
        self._core.hook_del(hook)
        return sum(count * self._length(*block) for block, count in blocks.items() if block[0] != HALT)

    def _length(self, address: int, size: int) -> int:
        key = (address, size)
        if key not in self._lengths:
            listed = list(self._decoder.disasm(self.read(address, size), address))
            assert sum(instruction.size for instruction in listed) == size
            self._lengths[key] = len(listed)
        return self._lengths[key]


class EmulatedCore:
    """The core on an emulated processor, played like :class:`Core`."""

    _ARRAYS = DATA + 0x40_0000

    def __init__(self, target: Target) -> None:
        self._target = target
        self.init()

    def init(self) -> None:
        self._target.call("probe_init")

    def job(self, N: int, D: int) -> int:
        """Set the ratio N/D of the hob."""
        base, increment = divmod(N, D)
        self._target.write(self._ARRAYS, struct.pack("<2q2i", increment, 0, base, 0))
        return self._target.call("probe_job", D, D >> 32, self._ARRAYS, self._ARRAYS + 16, 0)

    def run(self) -> int:
        return self._target.call("probe_run")

    def stop(self) -> None:
        self._target.call("probe_stop")

    def move(self, steps: int) -> int:
        return self._target.call("probe_move", steps)

    def acknowledge(self) -> int:
        return self._target.call("probe_acknowledge")

    def play(self, hob: np.ndarray) -> Record:
        """Play signed edges of the hob, one entry a tick, with the emergency stop closed."""
        n, no = len(hob), np.zeros(len(hob), np.uint8)
        kinds = (np.uint8, np.uint8, np.int64, np.int32, np.uint8)
        scripts = (hob.astype(np.int8), no, no, no + 1)
        sizes = [n] * 4 + [n * np.dtype(kind).itemsize for kind in kinds]
        room = [-(-size // 8) * 8 for size in sizes]
        places = [self._ARRAYS + sum(room[:k]) for k in range(len(room))]
        for place, script in zip(places, scripts, strict=False):
            self._target.write(place, script.tobytes())
        self._target.call("probe_play", n, *places)
        read = zip(places[4:], sizes[4:], kinds, strict=True)
        return Record(*(np.frombuffer(self._target.read(place, size), kind) for place, size, kind in read))

    def follow(self, hob: np.ndarray, steps: np.ndarray) -> int:
        """How many ticks of a tape of hob edges give its steps; compared on the processor, which costs least."""
        tapes = [self._ARRAYS, self._ARRAYS + -(-len(hob) // 8) * 8]
        for place, tape in zip(tapes, (hob, steps), strict=True):
            self._target.write(place, tape.astype(np.int8).tobytes())
        return self._target.call("probe_follow", len(hob), *tapes)

    @property
    def status(self) -> Status:
        self._target.call("probe_get", self._ARRAYS)
        return Status.from_buffer_copy(self._target.read(self._ARRAYS, ctypes.sizeof(Status)))


def emulate(processor: str, wide: bool, changes: Mapping[str, int | None], folder: Path) -> EmulatedCore:
    """A core after power-up on "cortex-m4" or "cortex-m7", built in a folder."""
    files = core_files(wide, changes) | {"probe.c": PROBE}
    return EmulatedCore(_build(files, "probe_play", folder, processor))


def _build(files: Mapping[str, str], entry: str, folder: Path, processor: str = "cortex-m4") -> Target:
    files = {**files, "freestanding.c": FREESTANDING}
    for name, text in {**files, "link.ld": LAYOUT}.items():
        (folder / name).write_text(text, "utf-8")
    sources = sorted(name for name in files if name.endswith(".c"))
    link = ["-nostdlib", f"-Wl,-e,{entry}", "-T", "link.ld", "-lgcc", "-o", "program.elf"]
    command = [
        "arm-none-eabi-gcc",
        f"-mcpu={processor}",
        *FLAGS,
        "-ffreestanding",
        "-fno-tree-loop-distribute-patterns",
        *sources,
        *link,
    ]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return Target(folder / "program.elf", processor)


@pytest.fixture(scope="session")
def arm_gcc() -> None:
    """GCC for the Cortex-M4: the instruction counts are those of this compiler."""
    if shutil.which("arm-none-eabi-gcc") is None:
        pytest.skip("needs arm-none-eabi-gcc")


@pytest.fixture(scope="session")
def core_on_target(arm_gcc, tmp_path_factory) -> Callable[..., Target]:
    """``core_on_target(wide, GM_...=...)``: the core in emulation."""

    def make(wide: bool, **changes: int | None) -> Target:
        files = core_files(wide, changes) | {"target.c": TARGET}
        return _build(files, "drive", tmp_path_factory.mktemp("core"))

    return make


@pytest.fixture(scope="session")
def emulated_core(arm_gcc, tmp_path_factory) -> Callable[..., EmulatedCore]:
    """``emulated_core("cortex-m7", wide, GM_...=...)``: a core after power-up on "cortex-m4" or "cortex-m7"."""

    def make(processor: str, wide: bool, **changes: int | None) -> EmulatedCore:
        return emulate(processor, wide, changes, tmp_path_factory.mktemp("core"))

    return make


@pytest.fixture(scope="session")
def kernel_on_target(arm_gcc, tmp_path_factory) -> Callable[[str, int], Target]:
    """``kernel_on_target(name, bits)``: one generated kernel in emulation, called through its typed function."""
    expressions = {"gearbox_step": gearbox_step, "gearbox_edge": gearbox_edge, "encoder_hysteresis": encoder_hysteresis}

    def make(name: str, bits: int) -> Target:
        files = integer_kernel(lower(expressions[name]()), bits).files
        return _build(files, f"gm_{name}", tmp_path_factory.mktemp(name))

    return make

"""The step kernel, and a Cortex-M4 in emulation that runs its C: cross-compiled, linked, instruction by instruction.

The loop over the edges is target code too, so that a million calls take about a second.
"""

from __future__ import annotations

import shutil
import struct
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from elftools.elf.elffile import ELFFile
from unicorn import UC_ARCH_ARM, UC_MODE_MCLASS, UC_MODE_THUMB, Uc
from unicorn.arm_const import (
    UC_ARM_REG_LR,
    UC_ARM_REG_PC,
    UC_ARM_REG_R0,
    UC_ARM_REG_R1,
    UC_ARM_REG_R2,
    UC_ARM_REG_R3,
    UC_ARM_REG_SP,
    UC_CPU_ARM_CORTEX_M4,
)

from derivations.gearbox import gearbox_step
from gearmath.engine.kernel import Kernel
from gearmath.export.c import integer_kernel
from gearmath.lowering import lower

CODE, DATA, STACK = 0x0001_0000, 0x2000_0000, 0x3000_0000
CODE_SIZE = DATA_SIZE = 0x0040_0000
STACK_SIZE = 0x1_0000
CHUNK = 1 << 20  # edges in the data memory at once
HALT = 0x0003_0000  # inside the code memory, never executed

LOOP = """\
#include "gm_gearbox_step.h"

/* job: N, D, remainder (updated). */
void run(const int8_t *edges, int8_t *steps, int32_t n, int32_t *job)
{
  int32_t i, step;
  for (i = 0; i < n; ++i) {
    gm_gearbox_step(job[2], edges[i], job[0], job[1], &step, &job[2]);
    steps[i] = (int8_t)step;
  }
}
"""

FLAGS = ["-O2", "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-ffreestanding"]
LINK = ["-nostdlib", "-Wl,-e,run", "-T", "link.ld"]
LAYOUT = """\
SECTIONS {
  . = 0x10000;
  .text : { *(.text*) *(.rodata*) }
  /DISCARD/ : { *(.comment) *(.ARM.exidx*) *(.ARM.extab*) }
}
"""


def cross_compiler() -> list[str]:
    """arm-none-eabi-gcc where it is installed, else the clang of the ziglang wheel."""
    if gcc := shutil.which("arm-none-eabi-gcc"):
        return [gcc, "-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=soft"]
    zig = [sys.executable, "-m", "ziglang", "cc", "-target", "thumb-freestanding-eabi"]
    return [*zig, "-mcpu=cortex_m4", "-mfloat-abi=soft"]


def build(files: dict[str, str], folder: Path) -> Path:
    """Compile and link a step kernel with its loop; returns the ELF file."""
    for name, text in {**files, "loop.c": LOOP, "link.ld": LAYOUT}.items():
        (folder / name).write_text(text, "utf-8")
    sources = sorted(name for name in (*files, "loop.c") if name.endswith(".c"))
    elf = folder / "loop.elf"
    objects = [name.replace(".c", ".o") for name in sources]
    for source, target in zip(sources, objects, strict=True):
        _call([*FLAGS, "-c", source, "-o", target], folder)
    _call([*LINK, *objects, "-o", elf.name], folder)
    return elf


def _call(arguments: list[str], folder: Path) -> None:
    done = subprocess.run([*cross_compiler(), *arguments], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


class CortexM4:
    """An emulated core with one program; a Runner of gearmath.gearbox.simulation."""

    def __init__(self, elf: Path) -> None:
        self._core = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
        self._core.ctl_set_cpu_model(UC_CPU_ARM_CORTEX_M4)
        for address, size in ((CODE, CODE_SIZE), (DATA, DATA_SIZE), (STACK, STACK_SIZE)):
            self._core.mem_map(address, size)
        with elf.open("rb") as stream:
            file = ELFFile(stream)
            assert file["e_machine"] == "EM_ARM"
            symbols: Any = file.get_section_by_name(".symtab")
            (run,) = symbols.get_symbol_by_name("run")
            self._entry = run["st_value"] | 1  # Thumb
            for segment in file.iter_segments("PT_LOAD"):
                if segment["p_filesz"] and segment["p_vaddr"] >= CODE:
                    self._core.mem_write(segment["p_vaddr"], segment.data())

    def __call__(self, edges: np.ndarray, numerator: int, denominator: int, remainder: int) -> tuple[np.ndarray, int]:
        """The steps of up to CHUNK edges, and the remainder that the target code left."""
        n = len(edges)
        assert n <= CHUNK
        steps, job = DATA + CHUNK, DATA + 2 * CHUNK
        self._core.mem_write(DATA, edges.astype(np.int8).tobytes())
        self._core.mem_write(job, struct.pack("<3i", numerator, denominator, remainder))
        for register, value in (
            (UC_ARM_REG_R0, DATA),
            (UC_ARM_REG_R1, steps),
            (UC_ARM_REG_R2, n),
            (UC_ARM_REG_R3, job),
            (UC_ARM_REG_SP, STACK + STACK_SIZE),
            (UC_ARM_REG_LR, HALT | 1),
        ):
            self._core.reg_write(register, value)
        self._core.emu_start(self._entry, HALT)
        assert self._core.reg_read(UC_ARM_REG_PC) == HALT
        (left,) = struct.unpack("<i", self._core.mem_read(job + 8, 4))
        return np.frombuffer(bytes(self._core.mem_read(steps, n)), np.int8), left


@pytest.fixture(scope="session")
def step_kernel() -> Kernel:
    """(7.5) lowered."""
    return lower(gearbox_step())


@pytest.fixture(scope="session")
def cortex_m4(step_kernel, tmp_path_factory) -> CortexM4:
    """A core with the generated step rule."""
    return CortexM4(build(integer_kernel(step_kernel).files, tmp_path_factory.mktemp("cortex_m4")))

"""The exported folders as a compiler sees them: strict C99, sanitizers, the microcontroller."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from elftools.elf.elffile import ELFFile

from derivations import gearbox
from gearmath.export.c import double_kernel, integer_kernel
from gearmath.export.cnc import cnc_files, cnc_kernels
from gearmath.export.header import comment
from gearmath.lowering import lower

STRICT = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O2", "-ffp-contract=off")
ZIG = (sys.executable, "-m", "ziglang", "cc")
CORTEX_M4 = ("-target", "thumb-freestanding-eabi", "-mcpu=cortex_m4", "-mfloat-abi=soft", "-ffreestanding")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("exported")
    files = dict(cnc_files())
    for expression in (gearbox.gearbox_step(), gearbox.gearbox_terms()):
        files |= integer_kernel(lower(expression)).files
    for name, text in files.items():
        (place / name).write_text(text, "utf-8")
    return place


def run(*command: str, cwd: Path) -> None:
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def sources(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.glob("gm_*.c"))


def test_strict_c99_accepts_every_file(folder: Path, host_compiler: tuple[str, ...]) -> None:
    run(*host_compiler, *STRICT, "-c", *sources(folder), cwd=folder)


def test_strict_c99_of_clang_accepts_every_file(folder: Path) -> None:
    for name in sources(folder):
        run(*ZIG, *STRICT, "-c", name, "-o", "zig.o", cwd=folder)


def test_headers_serve_cpp(folder: Path, host_compiler: tuple[str, ...]) -> None:
    includes = '#include "gearmath.h"\n#include "gm_gearbox_step.h"\n#include "gm_gearbox_terms.h"\n'
    (folder / "all.cpp").write_text(includes)
    run(*host_compiler, "-x", "c++", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", "all.cpp", cwd=folder)


def test_makefile_builds_the_library(tmp_path: Path, gcc: str) -> None:
    for name, text in cnc_files().items():
        (tmp_path / name).write_text(text, "utf-8")
    run("make", "-s", f"CC={gcc}", "CFLAGS=-O0", cwd=tmp_path)
    assert (tmp_path / "libgearmath.a").is_file()


def test_integer_kernels_call_no_floating_runtime_on_the_cortex_m4(folder: Path) -> None:
    for name in ("gm_gearbox_step", "gm_gearbox_terms"):
        run(*ZIG, *CORTEX_M4, "-O2", "-std=c99", "-c", f"{name}.c", "-o", f"{name}.m4.o", cwd=folder)
        with (folder / f"{name}.m4.o").open("rb") as stream:
            table = ELFFile(stream).get_section_by_name(".symtab")
            undefined = [s.name for s in table.iter_symbols() if s.name and s["st_shndx"] == "SHN_UNDEF"]
        assert [symbol for symbol in undefined if not symbol.startswith("__aeabi_unwind")] == []


def test_double_kernel_refuses_single_precision_constants(folder: Path, gcc: str) -> None:
    command = [gcc, "-std=c99", "-fsyntax-only", "-fsingle-precision-constant", "gm_tool_pose.c"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert done.returncode != 0
    assert "gm_double_literals" in done.stderr
    run(gcc, "-std=c99", "-fsyntax-only", "-fsingle-precision-constant", "gm_gearbox_step.c", cwd=folder)


def test_comment_of_hostile_text_compiles(tmp_path: Path, gcc: str) -> None:
    text = comment(["*/ int x = ; /* ??/", "end with a backslash \\", "*\\\n/ int y;", "*??/\n/ \u202e"])
    (tmp_path / "hostile.c").write_text(f"{text}int fine(void);\n", "utf-8")
    run(gcc, *STRICT, "-Wtrigraphs", "-Wcomment", "-fsyntax-only", "hostile.c", cwd=tmp_path)


_STEPS = """\
  {
    static const int32_t D[] = {1, 2, 3, 1073741823, 1073741824};
    int i, j, edge;
    for (i = 0; i < 5; ++i) for (j = 0; j < 3; ++j) for (edge = -1; edge <= 1; edge += 2) {
      const int32_t N = j == 0 ? 1 : j == 1 ? (D[i] + 1) / 2 : D[i];
      const int32_t starts[] = {0, D[i] / 2, D[i] - 1};
      int32_t step, next, k;
      for (k = 0; k < 3; ++k) {
        gm_gearbox_step(starts[k], edge, N, D[i], &step, &next);
        if (next < 0 || next >= D[i]) return 1;
      }
    }
    gm_gearbox_terms(999, 10, 40000, 10000000, &N_, &D_);
    if (N_ != 100000000 || D_ != 39960000) return 1;
  }
"""


def _main(n: int, samples: Callable) -> str:
    """A program that calls every kernel on n samples, with arrays of exactly the documented size on the heap."""
    lines = ['#include <stdlib.h>\n#include "gearmath.h"\n#include "gm_gearbox_step.h"\n#include "gm_gearbox_terms.h"']
    body = ["int main(void)\n{\n  int32_t N_, D_;"]
    for kernel in cnc_kernels():
        name, given = kernel.name, []
        for quantity, array in zip(kernel.inputs, samples(name, n), strict=True):
            numbers = ", ".join(float(value).hex() for value in np.ravel(array))
            lines.append(f"static const double {name}_{quantity.name}[{n * quantity.size}] = {{{numbers}}};")
            given.append(f"{name}_{quantity.name}, {quantity.size}")
        results = [f"{name}_{quantity.name}_" for quantity in kernel.outputs]
        for quantity, result in zip(kernel.outputs, results, strict=True):
            body.append(f"  double *{result} = malloc({n * quantity.size} * sizeof(double));")
        body.append(f"  gm_{name}_batch({n}, {', '.join([*given, *results])});")
        body += [f"  free({result});" for result in results]
    return "\n".join([*lines, *body, _STEPS, "  return 0;\n}\n"])


def test_sanitizers_find_nothing(folder: Path, gcc: str, samples: Callable) -> None:
    (folder / "main.c").write_text(_main(20, samples))
    sanitize = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g", "-O1", "-std=c99", "-Werror")
    run(gcc, *sanitize, "main.c", *sources(folder), "-o", "sanitized", "-lm", cwd=folder)
    run("./sanitized", cwd=folder)


def test_every_public_name_starts_with_gm(folder: Path, gcc: str) -> None:
    for kernel in cnc_kernels():
        name = kernel.name
        run(gcc, "-std=c99", "-c", f"gm_{name}.c", "-o", "names.o", cwd=folder)
        with (folder / "names.o").open("rb") as stream:
            table = ELFFile(stream).get_section_by_name(".symtab")
            public = {
                s.name
                for s in table.iter_symbols()
                if s["st_info"]["bind"] == "STB_GLOBAL" and s["st_shndx"] != "SHN_UNDEF"
            }
        assert public == {f"gm_{name}", f"gm_{name}_batch"}
        assert set(double_kernel(kernel).files) == {f"gm_{name}.h", f"gm_{name}.c"}

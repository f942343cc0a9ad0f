"""The exported C as a compiler sees it: strict C99, C++, the microcontroller. The library as a whole: test_library."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from elftools.elf.elffile import ELFFile

from derivations import gearbox
from gearmath.export.c import double_kernel, integer_kernel
from gearmath.export.cnc import cnc_files, cnc_kernels
from gearmath.export.folder import write_folder
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
    write_folder(place / "lib", files)
    return place / "lib"


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
